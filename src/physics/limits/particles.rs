//! The stability bound of bodies whose springs differ by cell.
//!
//! Plane waves need one material, and the bound by cells ([`super::cells`]) needs masses that cells share out together with
//! their links. For any links the following holds: a link along the unit vector d̂, of constant k and rest length l, resists
//! no more than if each of its ends were tied to its place by twice the link's stiffness,
//!
//! ```text
//! k/l (d̂·(a − b))² ≤ 2 k/l ((d̂·a)² + (d̂·b)²),   λ_max(M⁻¹ A) ≤ max over particles λ_max(Σ over its links 2 k/l d̂ d̂ᵀ)/m
//! ```
//!
//! For each family alone this is what plane waves give inside a body; for all together up to a fifth more, as not every
//! family resists the same wave most.

use std::collections::BTreeSet;

use glam::{DMat3, DVec3};

use super::cells::CellLoads;
use super::eigenvalue::{Addition, largest_eigenvalue, largest_multiple};
use crate::geometry::{Family, Lattice};
use crate::physics::model::CellKind;

/// The kinds of cells whose mean a link or the mass of a particle is, with the share of each.
pub(in crate::physics) type Mixture = Vec<(u8, f64)>;

/// The class of each of a set of links or particles, and the mixture of each class.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct MadeOf<'a> {
    pub(in crate::physics) class: &'a [u16],
    pub(in crate::physics) mixtures: &'a [Mixture],
}

/// A kind of cells, and the values that are assumed for it.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct Taken<'a> {
    pub(in crate::physics) kind: u8,
    pub(in crate::physics) values: &'a CellKind,
}

/// One of the two constants of a family.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::physics) enum Constant {
    Stiffness,
    Damping,
}

/// The links and masses of a body's particles, once for each sort of particle.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::physics) struct ParticleLoads {
    kinds: Vec<CellKind>,
    sorts: Vec<Sort>,
}

/// Particles with equal links and masses: their parts by kind of cells.
#[derive(Clone, Debug, Default, PartialEq)]
struct Sort(Vec<OfKind>);

/// The part of a particle that belongs to one kind of cells.
#[derive(Clone, Debug, PartialEq)]
struct OfKind {
    kind: u8,
    /// The sum over its links of `2/l d̂ d̂ᵀ`, each times the kind's share, by family, 1/m.
    links: [DMat3; 3],
    /// The kind's share of its mass.
    mass: f64,
}

impl Sort {
    fn of_kind(&mut self, kind: u8) -> &mut OfKind {
        let place = self.0.iter().position(|of| of.kind == kind).unwrap_or_else(|| {
            self.0.push(OfKind { kind, links: [DMat3::ZERO; 3], mass: 0.0 });
            self.0.len() - 1
        });
        &mut self.0[place]
    }

    /// Returns the links of a family of one kind.
    fn links(&self, kind: u8, family: Family) -> DMat3 {
        self.0.iter().find(|of| of.kind == kind).map_or(DMat3::ZERO, |of| of.links[family as usize])
    }
}

impl Constant {
    fn of(self, kind: &CellKind) -> [f64; 3] {
        match self {
            Self::Stiffness => kind.stiffness,
            Self::Damping => kind.damping,
        }
    }
}

impl ParticleLoads {
    /// Returns the loads of the particles of a lattice whose links (by family) and masses are mixtures of these kinds.
    pub(in crate::physics) fn of(
        kinds: Vec<CellKind>,
        lattice: &Lattice,
        links: &[MadeOf<'_>; 3],
        masses: MadeOf<'_>,
    ) -> Self {
        let mut held: Vec<[u16; SLOTS]> = vec![[NOTHING; SLOTS]; lattice.corners.len()];
        for (held, &class) in held.iter_mut().zip(masses.class) {
            held[MASS] = class;
        }
        for (ends, &class) in lattice.links.iter().zip(links).flat_map(|(ends, of)| ends.iter().zip(of.class)) {
            let [low, high] = ends.map(|end| lattice.corners[end as usize].map(i64::from));
            let way = |from: [i64; 3], to: [i64; 3]| std::array::from_fn(|axis| to[axis] - from[axis]);
            held[ends[0] as usize][slot(way(low, high))] = class;
            held[ends[1] as usize][slot(way(high, low))] = class;
        }
        let held: BTreeSet<[u16; SLOTS]> = held.into_iter().collect();
        let sort = |slots: &[u16; SLOTS]| {
            let mut sort = Sort::default();
            for &(kind, share) in &masses.mixtures[usize::from(slots[MASS])] {
                sort.of_kind(kind).mass = share;
            }
            for (place, &class) in slots[..MASS].iter().enumerate().filter(|(_, class)| **class != NOTHING) {
                let (family, way) = family_and_way(place);
                let along = way / way.length();
                let outer = DMat3::from_cols(along * along.x, along * along.y, along * along.z);
                let tensor = outer * (2.0 / (way.length() * lattice.grid.cell_size));
                for &(kind, share) in &links[family as usize].mixtures[usize::from(class)] {
                    sort.of_kind(kind).links[family as usize] += tensor * share;
                }
            }
            sort
        };
        Self { kinds, sorts: held.iter().map(sort).collect() }
    }

    /// Returns the kinds of cells that occur, the body's own first.
    pub(in crate::physics) fn kinds(&self) -> &[CellKind] {
        &self.kinds
    }

    /// Returns the body's own springs with their present values.
    pub(in crate::physics) fn own(&self) -> Taken<'_> {
        Taken { kind: 0, values: &self.kinds[0] }
    }

    fn values<'a>(&'a self, taken: Taken<'a>, kind: u8) -> &'a CellKind {
        if kind == taken.kind { taken.values } else { &self.kinds[usize::from(kind)] }
    }

    fn mass_kg(&self, sort: &Sort, taken: Taken<'_>) -> f64 {
        sort.0.iter().map(|of| of.mass * self.values(taken, of.kind).mass).sum()
    }

    fn sum(&self, sort: &Sort, taken: Taken<'_>, of: Constant, weights: [f64; 3]) -> DMat3 {
        let mut sum = DMat3::ZERO;
        for of_kind in &sort.0 {
            let constants = of.of(self.values(taken, of_kind.kind));
            for ((links, constant), weight) in of_kind.links.iter().zip(constants).zip(weights) {
                sum += *links * (constant * weight);
            }
        }
        sum
    }

    /// Returns the most that stiffness (1/s²) or damping (1/s) adds, with each family times its weight.
    pub(in crate::physics) fn most(&self, taken: Taken<'_>, of: Constant, weights: [f64; 3]) -> f64 {
        self.over_mass(&self.resistances(taken, of, weights), taken)
    }

    /// Returns all loads of springs.
    pub(in crate::physics) fn of_springs(&self, taken: Taken<'_>) -> CellLoads {
        let alone = |of: Constant| {
            std::array::from_fn(|family| {
                let mut weights = [0.0; 3];
                weights[family] = 1.0;
                self.most(taken, of, weights)
            })
        };
        let [stiffness, damping] = [Constant::Stiffness, Constant::Damping].map(|of| self.most(taken, of, [1.0; 3]));
        CellLoads {
            stiffness_alone: alone(Constant::Stiffness),
            damping_alone: alone(Constant::Damping),
            stiffness,
            damping,
            stiffness_per_damping: self.per_damping(taken),
        }
    }

    /// Returns the largest ratio of stiffness to damping of any link, 1/s.
    pub(in crate::physics) fn per_damping(&self, taken: Taken<'_>) -> f64 {
        self.per_damping_of_kind(taken).max(self.per_damping_of_others(taken.kind))
    }

    /// Returns the same ratio over all kinds but this one: infinite if some have only stiffness.
    pub(in crate::physics) fn per_damping_of_others(&self, kind: u8) -> f64 {
        let others = self.kinds.iter().zip(0..).filter(|(_, other)| *other != kind);
        others.map(|(values, kind)| self.per_damping_of_kind(Taken { kind, values })).fold(0.0, f64::max)
    }

    fn per_damping_of_kind(&self, Taken { kind, values }: Taken<'_>) -> f64 {
        let of_family = |family: Family| {
            let has_links = self.sorts.iter().any(|sort| sort.links(kind, family) != DMat3::ZERO);
            let (stiffness, damping) = (values.stiffness[family as usize], values.damping[family as usize]);
            if has_links && stiffness > 0.0 { stiffness / damping } else { 0.0 }
        };
        Family::ALL.map(of_family).into_iter().fold(0.0, f64::max)
    }

    /// Returns the most that a family of the kind's links alone adds for a constant of 1, 1/(kg m).
    pub(in crate::physics) fn of_one(&self, taken: Taken<'_>, family: Family) -> f64 {
        let of_sort = |sort: &Sort| largest_eigenvalue(sort.links(taken.kind, family)) / self.mass_kg(sort, taken);
        self.sorts.iter().map(of_sort).fold(0.0, f64::max)
    }

    /// Returns the resistance of each sort of particle, N/m or N·s/m.
    pub(in crate::physics) fn resistances(&self, taken: Taken<'_>, of: Constant, weights: [f64; 3]) -> Vec<f64> {
        self.sorts.iter().map(|sort| largest_eigenvalue(self.sum(sort, taken, of, weights))).collect()
    }

    /// Returns the largest of these resistances over the mass.
    pub(in crate::physics) fn over_mass(&self, resistances: &[f64], taken: Taken<'_>) -> f64 {
        let sorts = self.sorts.iter().zip(resistances);
        sorts.map(|(sort, resists)| resists / self.mass_kg(sort, taken)).fold(0.0, f64::max)
    }

    /// Returns the largest value of one constant of a family of the kind for which [`Self::most`] is within a limit, all
    /// other values as given. Zero if there is none, infinite if the family has no such links or no weight.
    pub(in crate::physics) fn largest(
        &self,
        taken: Taken<'_>,
        (family, of): (Family, Constant),
        weights: [f64; 3],
        limit: f64,
    ) -> f64 {
        let mut rest = *taken.values;
        match of {
            Constant::Stiffness => rest.stiffness[family as usize] = 0.0,
            Constant::Damping => rest.damping[family as usize] = 0.0,
        }
        let rest = Taken { values: &rest, ..taken };
        let weight = weights[family as usize];
        if weight <= 0.0 {
            return if self.most(rest, of, weights) <= limit { f64::INFINITY } else { 0.0 };
        }
        let additions = self.sorts.iter().map(|sort| {
            let per_mass = 1.0 / self.mass_kg(sort, taken);
            let of_kind = sort.links(taken.kind, family) * per_mass;
            let to = self.sum(sort, rest, of, weights) * (per_mass / weight);
            Addition { to, of: of_kind, alone: largest_eigenvalue(of_kind) }
        });
        largest_multiple(additions, limit / weight)
    }
}

/// The slots of a particle: its links by where they lead, to 27 places around it and 6 that are two cells away along the
/// axes, and its mass.
const SLOTS: usize = MASS + 1;
const MASS: usize = 27 + 6;
/// Marks a slot without a link.
const NOTHING: u16 = u16::MAX;

/// Returns the slot of a link that leads `way` cells away.
fn slot(way: [i64; 3]) -> usize {
    match way.iter().position(|cells| cells.abs() == 2) {
        Some(axis) => 27 + 2 * axis + usize::from(way[axis] > 0),
        None => usize::try_from((way[0] + 1) + 3 * (way[1] + 1) + 9 * (way[2] + 1)).unwrap_or(MASS),
    }
}

/// Returns the family of a slot's link and where it leads, cells: the inverse of [`slot`].
fn family_and_way(slot: usize) -> (Family, DVec3) {
    if let Some(second) = slot.checked_sub(27) {
        let toward = if second % 2 == 1 { 2.0 } else { -2.0 };
        return (Family::Bending, DVec3::AXES[second / 2] * toward);
    }
    let along = |place: usize| place as f64 - 1.0;
    let way = DVec3::new(along(slot % 3), along(slot / 3 % 3), along(slot / 9));
    (if way.length_squared() < 1.5 { Family::Structural } else { Family::Shear }, way)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::math::rng::Rng;
    use crate::physics::Simulation;
    use crate::physics::limits::fastest_tests::fastest;
    use crate::physics::model::Composition;
    use crate::scene::body::{CubeShape, Inlay};
    use crate::scene::material::Spring;
    use crate::scene::resolve::resolve;
    use crate::scene::{Body, Material, Scene, Shape, Springs};

    /// Returns a cube of this many cells an edge, each cell with its own springs or one of two others.
    fn mixed(cells: u32, springs: [Springs; 3], rng: &mut Rng) -> Simulation<f64> {
        let inlay = |springs: Springs| Inlay { max: [-1.0; 3], springs, ..Inlay::default() };
        let mut inlays = vec![inlay(springs[1]), inlay(springs[2])];
        let edge = i32::try_from(cells).expect("a few");
        for cell in 0..edge.pow(3) {
            if let Some(inlay) = inlays.get_mut((rng.next_u64() % 3) as usize) {
                inlay.cells.push([cell % edge, cell / edge % edge, cell / edge / edge]);
            }
        }
        let shape = Shape::Cube(CubeShape { cells, size: 1.0 });
        let body = Body { shape, material: Material::Springs(springs[0]), inlays, ..Body::default() };
        let lattice = resolve(&body.shape, Path::new("."), &()).expect("a cube").lattice;
        Simulation::new(&Scene { bodies: vec![body], ..Scene::default() }, &[lattice])
    }

    fn loads_of(simulation: &Simulation<f64>) -> &ParticleLoads {
        match &simulation.model().bodies[0].composition {
            Composition::Springs { loads, .. } => loads,
            other => panic!("of several springs, not {other:?}"),
        }
    }

    fn random_springs(rng: &mut Rng) -> Springs {
        let mut decade = |low: f64, high: f64| 10f64.powf(rng.between(low, high));
        let mut spring = || Spring { stiffness: decade(0.0, 2.0), damping: decade(-3.0, 0.0) };
        let (structural, shear, bending) = (spring(), spring(), spring());
        Springs { structural, shear, bending, particle_mass: decade(-3.0, -1.0) }
    }

    #[test]
    fn no_vibration_of_mixed_springs_is_faster_than_the_bound_and_some_are_nearly_as_fast() {
        let mut rng = Rng::new(12);
        let mut nearest = [0.0_f64; 2];
        for cells in [1, 2, 3, 4, 4, 4] {
            let springs = std::array::from_fn(|_| random_springs(&mut rng));
            let simulation = mixed(cells, springs, &mut rng);
            // The only cell may have the body's own springs, or those of one inlay alone.
            let Composition::Springs { loads, .. } = &simulation.model().bodies[0].composition else { continue };
            let bounds = [Constant::Stiffness, Constant::Damping].map(|of| loads.most(loads.own(), of, [1.0; 3]));
            let found = fastest(&simulation.model().bodies[0], &simulation.state().position);
            for which in 0..2 {
                let share = found[which] / bounds[which];
                assert!((0.3..=1.0 + 1e-9).contains(&share), "{cells} cells: {found:?} of {bounds:?}");
                nearest[which] = nearest[which].max(share);
            }
        }
        assert!(nearest.iter().all(|share| *share > 0.6), "{nearest:?}");
    }

    #[test]
    fn springs_that_hardly_differ_are_borne_about_as_alike_ones() {
        let mut rng = Rng::new(13);
        let springs = Springs::default();
        let other = Springs { particle_mass: springs.particle_mass * (1.0 + 1e-9), ..springs };
        let simulation = mixed(6, [springs, other, other], &mut rng);
        let limits = &simulation.plan().limits;
        let body = Body { shape: Shape::Cube(CubeShape { cells: 6, size: 1.0 }), ..Body::default() };
        let lattice = resolve(&body.shape, Path::new("."), &()).expect("a cube").lattice;
        let alike = Simulation::<f64>::new(&Scene { bodies: vec![body], ..Scene::default() }, &[lattice]);
        let alike = &alike.plan().limits;
        let share = limits.dt_safe_secs.expect("limited") / alike.dt_safe_secs.expect("limited");
        assert!((0.8..1.0).contains(&share), "{share}");
        for ((term, alone), (_, by_waves)) in limits.terms.iter().zip(&alike.terms) {
            let ratio = alone.zip(*by_waves).map_or(1.0, |(alone, by_waves)| alone / by_waves);
            assert!((ratio - 1.0).abs() < 1e-6, "{term:?}: {alone:?} and {by_waves:?}");
        }
    }

    #[test]
    fn the_largest_constant_of_any_kind_is_the_one_at_which_the_limit_is_met() {
        let mut rng = Rng::new(14);
        for kind in [0, 1, 2].repeat(4) {
            let springs = std::array::from_fn(|_| random_springs(&mut rng));
            let simulation = mixed(3, springs, &mut rng);
            let loads = loads_of(&simulation);
            let taken = Taken { kind, values: &loads.kinds()[usize::from(kind)] };
            for of in [Constant::Stiffness, Constant::Damping] {
                let weights = [0; 3].map(|_| rng.between(0.5, 1.5));
                let limit = loads.most(taken, of, weights) * rng.between(0.8, 2.0);
                for family in Family::ALL {
                    let largest = loads.largest(taken, (family, of), weights, limit);
                    let mut there = *taken.values;
                    match of {
                        Constant::Stiffness => there.stiffness[family as usize] = largest,
                        Constant::Damping => there.damping[family as usize] = largest,
                    }
                    let met = loads.most(Taken { values: &there, ..taken }, of, weights) / limit;
                    assert!(if largest > 0.0 { (met - 1.0).abs() < 1e-6 } else { met >= 1.0 }, "{family:?}: {met}");
                }
            }
        }
    }

    #[test]
    fn a_slot_is_found_again_from_where_it_leads() {
        for slot_number in (0..MASS).filter(|slot| *slot != 13) {
            let (_, way) = family_and_way(slot_number);
            #[expect(clippy::cast_possible_truncation, reason = "whole numbers of cells")]
            let cells = way.to_array().map(|c| c as i64);
            assert_eq!(slot(cells), slot_number, "{way}");
        }
    }
}
