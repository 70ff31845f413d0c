//! The load of springs on a step, and how far one of their values may go until the load is at its limit: from plane waves
//! where all cells are of one kind, from the links of each particle where springs differ by cell.

use std::sync::Arc;

use super::springs_by_cell::spring_cell;
use super::waves::{largest_share, waves};
use crate::geometry::Family;
use crate::math::Real;
use crate::physics::limits::particles::{AssumedKind, Constant, ParticleLoads};
use crate::physics::limits::{HOLDING_SHARE, LoadShare, angles_are_held, largest_over_waves};
use crate::physics::model::{BodyModel, CellKind, Composition};
use crate::scene::Springs;

/// The springs of a body, or of one of its parts or inlays, without their values.
#[derive(Clone, Debug)]
pub(super) struct SpringLoads {
    /// Families with links.
    pub(super) has_links: [bool; 3],
    cell_size: f64,
    mixed: Option<Mixed>,
}

/// Springs that differ by cell, and which kind of them is meant.
#[derive(Clone, Debug)]
struct Mixed {
    loads: Arc<ParticleLoads>,
    kind: u8,
}

impl Mixed {
    fn assumed<'a>(&self, values: &'a CellKind) -> AssumedKind<'a> {
        AssumedKind { kind: self.kind, values }
    }

    /// The largest load of these springs together with the others.
    fn largest_load(&self, springs: &Springs, of: Constant, weights: [f64; 3]) -> f64 {
        self.loads.largest_load(self.assumed(&spring_cell(springs)), of, weights)
    }
}

impl SpringLoads {
    /// The springs of a body itself.
    pub(super) fn of<R: Real>(model: &BodyModel<R>) -> Self {
        let mixed = match &model.composition {
            Composition::Springs { loads, .. } => Some(Mixed { loads: Arc::clone(loads), kind: 0 }),
            Composition::Alike | Composition::Solids { .. } => None,
        };
        Self {
            has_links: Family::ALL.map(|family| !model.lattice.links[family as usize].is_empty()),
            cell_size: model.lattice.grid.cell_size,
            mixed,
        }
    }

    /// The springs of the body's material of this number, see [`Composition::Springs`]. None where no cell is of it; where
    /// all cells are alike, only the body's own has any.
    pub(super) fn of_number<R: Real>(model: &BodyModel<R>, number: usize) -> Option<Self> {
        let mut of = Self::of(model);
        let (Some(mixed), Composition::Springs { numbers, .. }) = (&mut of.mixed, &model.composition) else {
            return (number == 0).then_some(of);
        };
        let mut kinds = (0..).zip(numbers);
        mixed.kind = kinds.find(|(_, known)| usize::from(**known) == number).map(|(kind, _)| kind)?;
        Some(of)
    }

    /// The factor from a constant of the body's own springs to the constant per unit mass of a particle and length of a
    /// link.
    pub(super) fn per_value(&self, springs: &Springs) -> f64 {
        1.0 / (springs.particle_mass * self.cell_size)
    }

    /// Whether links hold the angles of all cells.
    pub(super) fn angles_are_held(&self, springs: &Springs) -> bool {
        self.others_are_held() && angles_are_held(self.stiffness(springs))
    }

    /// The largest safe stiffness of a family, from the bounds for cells whose angles are free and for cells whose angles
    /// are held.
    pub(super) fn largest_held(&self, springs: &Springs, family: Family, [free, held]: [f64; 2]) -> f64 {
        let [structural, shear, bending] = self.stiffness(springs);
        let others_are_held = self.others_are_held();
        let up_to = |other: f64| {
            let are_held = others_are_held && shear > HOLDING_SHARE * other;
            // Somewhat less, so that single precision does not round it over the limit.
            let most = if are_held { (1.0 - 1e-6) * shear / HOLDING_SHARE } else { 0.0 };
            if free > most { free } else { held.min(most) }
        };
        match family {
            Family::Structural => up_to(bending),
            Family::Bending => up_to(structural),
            Family::Shear => {
                let least = if others_are_held { HOLDING_SHARE * structural.max(bending) } else { f64::INFINITY };
                if held > least { held } else { free }
            }
        }
    }

    fn others_are_held(&self) -> bool {
        self.mixed.as_ref().is_none_or(|mixed| {
            let mut others = (0..).zip(mixed.loads.kinds()).filter(|(kind, _)| *kind != mixed.kind);
            others.all(|(_, kind)| angles_are_held(kind.stiffness))
        })
    }

    /// Stiffness by family; zero without links.
    fn stiffness(&self, springs: &Springs) -> [f64; 3] {
        let of = |family: Family| if self.has_links[family as usize] { springs.family(family).stiffness } else { 0.0 };
        Family::ALL.map(of)
    }

    /// The load of all families.
    pub(super) fn all(&self, springs: &Springs, share: &LoadShare) -> f64 {
        match &self.mixed {
            None => largest_over_waves(&waves().tensors, self.of_families(springs, share)),
            Some(mixed) => {
                let stiffness = mixed.largest_load(springs, Constant::Stiffness, [share.stiffness; 3]);
                stiffness + mixed.largest_load(springs, Constant::Damping, share.damping)
            }
        }
    }

    /// The load of one family alone.
    pub(super) fn alone(&self, springs: &Springs, share: &LoadShare, family: Family) -> f64 {
        let only = |of: [f64; 3]| {
            let mut only = [0.0; 3];
            only[family as usize] = of[family as usize];
            only
        };
        match &self.mixed {
            None => largest_over_waves(&waves().tensors, only(self.of_families(springs, share))),
            Some(mixed) => {
                let stiffness = mixed.largest_load(springs, Constant::Stiffness, only([share.stiffness; 3]));
                stiffness + mixed.largest_load(springs, Constant::Damping, only(share.damping))
            }
        }
    }

    /// The largest load that a family's links of the body's own springs have for a constant of 1 per unit mass and length.
    pub(super) fn load_per_unit(&self, springs: &Springs, family: Family) -> f64 {
        let mut unit = [0.0; 3];
        unit[family as usize] = 1.0;
        match &self.mixed {
            None => largest_over_waves(&waves().tensors, unit),
            Some(mixed) => {
                mixed.loads.load_per_unit(mixed.assumed(&spring_cell(springs)), family) / self.per_value(springs)
            }
        }
    }

    /// The largest value of a constant with which the load is within a limit, the others as they are in `springs`. Zero
    /// where no value is, infinite where every value is.
    pub(super) fn largest(
        &self,
        springs: &Springs,
        (family, of): (Family, Constant),
        share: &LoadShare,
        limit: f64,
    ) -> f64 {
        let Some(mixed) = &self.mixed else { return self.largest_alike(springs, (family, of), share, limit) };
        let [own, other] = match of {
            Constant::Stiffness => [([share.stiffness; 3], of), (share.damping, Constant::Damping)],
            Constant::Damping => [(share.damping, of), ([share.stiffness; 3], Constant::Stiffness)],
        };
        let left = limit - mixed.largest_load(springs, other.1, other.0);
        let values = spring_cell(springs);
        if left < 0.0 { 0.0 } else { mixed.loads.largest_constant(mixed.assumed(&values), (family, of), own.0, left) }
    }

    fn largest_alike(&self, springs: &Springs, (family, of): (Family, Constant), share: &LoadShare, limit: f64) -> f64 {
        let (now, factor) = match of {
            Constant::Stiffness => (springs.family(family).stiffness, share.stiffness),
            Constant::Damping => (springs.family(family).damping, share.damping[family as usize]),
        };
        let factor = factor * self.per_value(springs);
        let mut rest = self.of_families(springs, share);
        rest[family as usize] -= factor * now;
        if factor > 0.0 {
            largest_share(waves(), rest, family, limit) / factor
        } else if largest_over_waves(&waves().tensors, rest) > limit {
            0.0
        } else {
            f64::INFINITY
        }
    }

    /// The loads of the families where all links of one are alike.
    fn of_families(&self, springs: &Springs, share: &LoadShare) -> [f64; 3] {
        let per_value = self.per_value(springs);
        Family::ALL.map(|family| {
            let load = per_value * share.of(family, springs.family(family));
            if self.has_links[family as usize] { load } else { 0.0 }
        })
    }

    /// The largest stiffness over damping among the other springs, 1/s.
    pub(super) fn others_per_damping(&self) -> f64 {
        self.mixed.as_ref().map_or(0.0, |mixed| mixed.loads.per_damping_of_others(mixed.kind))
    }

    /// The load as a function of how many times lighter the particles of these springs are; none unless springs differ by
    /// cell. It changes by less than in proportion, as the others keep their mass.
    pub(super) fn by_lightness<'a>(
        &'a self,
        springs: &Springs,
        share: &LoadShare,
    ) -> Option<impl Fn(f64) -> f64 + use<'a>> {
        let mixed = self.mixed.as_ref()?;
        let now = spring_cell(springs);
        let parts = [
            mixed.loads.resistances(mixed.assumed(&now), Constant::Stiffness, [share.stiffness; 3]),
            mixed.loads.resistances(mixed.assumed(&now), Constant::Damping, share.damping),
        ];
        Some(move |times: f64| {
            let lighter = CellKind { mass: now.mass / times, ..now };
            parts.iter().map(|part| mixed.loads.over_mass(part, mixed.assumed(&lighter))).sum()
        })
    }
}
