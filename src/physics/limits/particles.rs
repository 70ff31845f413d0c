//! The stability bound of bodies whose springs differ by cell.
//!
//! Plane waves know of one material, and cells that share out their links ([`super::cells`]) of masses that are shared out
//! with them. What holds of any links: one along the unit vector d̂, of constant k and rest length l, resists no more than if
//! each of its ends were tied to where it is by twice its stiffness,
//!
//! ```text
//! k/l (d̂·(a − b))² ≤ 2 k/l ((d̂·a)² + (d̂·b)²),   λ_max(M⁻¹ A) ≤ max over particles λ_max(Σ over its links 2 k/l d̂ d̂ᵀ)/m
//! ```
//!
//! Of each family alone this is what plane waves give inside a body; of all together up to a fifth more, as not every family
//! resists the same wave most.

use std::collections::BTreeSet;

use glam::{DMat3, DVec3};

use super::cells::CellLoads;
use super::eigenvalue::{Addition, largest_eigenvalue, largest_multiple};
use crate::geometry::{Family, Lattice};
use crate::physics::model::CellKind;

/// What a link, or the mass of a particle, is made of: a share of the body's own springs, and the rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::physics) struct Mixture {
    /// The share of the body's own.
    pub(in crate::physics) own: f64,
    /// What others add: stiffness (N) and damping (N·s) of a link, mass (kg) and nothing of a particle.
    pub(in crate::physics) others: [f64; 2],
}

/// The classes of a set of links or particles, by their places, and what each class is made of.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct MadeOf<'a> {
    pub(in crate::physics) class: &'a [u16],
    pub(in crate::physics) mixtures: &'a [Mixture],
}

/// One of the two constants of a family.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::physics) enum Constant {
    Stiffness,
    Damping,
}

/// What particles are held by, each sort of them once.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::physics) struct ParticleLoads {
    sorts: Vec<Sort>,
    /// The most stiffness over damping of other springs, 1/s: infinite where some have only stiffness.
    pub(in crate::physics) others_per_damping: f64,
}

/// Particles that are held and weigh alike.
#[derive(Clone, Debug, PartialEq)]
struct Sort {
    /// By family, of the body's own links for a constant of 1, 1/m.
    own: [DMat3; 3],
    /// By family, of the other links: stiffness (N/m), and damping (N·s/m).
    others: [[DMat3; 3]; 2],
    mass: Mixture,
}

impl Sort {
    fn mass_kg(&self, own: f64) -> f64 {
        self.mass.own * own + self.mass.others[0]
    }

    fn sum(&self, own: &CellKind, of: Constant, weights: [f64; 3]) -> DMat3 {
        let of_family = |family: Family| {
            let place = family as usize;
            let links = self.own[place] * of.of(own)[place] + self.others[of as usize][place];
            links * weights[place]
        };
        Family::ALL.into_iter().map(of_family).fold(DMat3::ZERO, |sum, links| sum + links)
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
    /// Of the particles of a lattice whose links (by family) and masses are mixtures.
    pub(in crate::physics) fn of(
        lattice: &Lattice,
        links: &[MadeOf<'_>; 3],
        masses: MadeOf<'_>,
        others_per_damping: f64,
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
            let mut sort = Sort {
                own: [DMat3::ZERO; 3],
                others: [[DMat3::ZERO; 3]; 2],
                mass: masses.mixtures[usize::from(slots[MASS])],
            };
            for (place, &class) in slots[..MASS].iter().enumerate().filter(|(_, class)| **class != NOTHING) {
                let (family, way) = family_and_way(place);
                let along = way / way.length();
                let outer = DMat3::from_cols(along * along.x, along * along.y, along * along.z);
                let tensor = outer * (2.0 / (way.length() * lattice.grid.cell_size));
                let mixture = links[family as usize].mixtures[usize::from(class)];
                sort.own[family as usize] += tensor * mixture.own;
                for (sum, constant) in sort.others.iter_mut().zip(mixture.others) {
                    sum[family as usize] += tensor * constant;
                }
            }
            sort
        };
        Self { sorts: held.iter().map(sort).collect(), others_per_damping }
    }

    /// The most that stiffness (1/s²) or damping (1/s) adds with these as the body's own springs, each family as much as its
    /// weight.
    pub(in crate::physics) fn most(&self, own: &CellKind, of: Constant, weights: [f64; 3]) -> f64 {
        self.over_mass(&self.resistances(own, of, weights), own.mass)
    }

    /// All that these as the body's own springs add.
    pub(in crate::physics) fn of_springs(&self, own: &CellKind) -> CellLoads {
        let alone = |of: Constant| {
            std::array::from_fn(|family| {
                let mut weights = [0.0; 3];
                weights[family] = 1.0;
                self.most(own, of, weights)
            })
        };
        let [stiffness, damping] = [Constant::Stiffness, Constant::Damping].map(|of| self.most(own, of, [1.0; 3]));
        CellLoads {
            stiffness_alone: alone(Constant::Stiffness),
            damping_alone: alone(Constant::Damping),
            stiffness,
            damping,
            stiffness_per_damping: self.per_damping(own),
        }
    }

    /// How many times its damping the stiffness of a link is, at most, 1/s.
    pub(in crate::physics) fn per_damping(&self, own: &CellKind) -> f64 {
        let of_family = |family: usize| {
            let has_links = self.sorts.iter().any(|sort| sort.own[family] != DMat3::ZERO);
            let (stiffness, damping) = (own.stiffness[family], own.damping[family]);
            if has_links && stiffness > 0.0 { stiffness / damping } else { 0.0 }
        };
        (0..3).map(of_family).fold(self.others_per_damping, f64::max)
    }

    /// The most that a family of the body's own links alone adds for a constant of 1, 1/(kg m).
    pub(in crate::physics) fn of_one(&self, own_kg: f64, family: Family) -> f64 {
        let of_sort = |sort: &Sort| largest_eigenvalue(sort.own[family as usize]) / sort.mass_kg(own_kg);
        self.sorts.iter().map(of_sort).fold(0.0, f64::max)
    }

    /// What each sort resists with, N/m or N·s/m.
    pub(in crate::physics) fn resistances(&self, own: &CellKind, of: Constant, weights: [f64; 3]) -> Vec<f64> {
        self.sorts.iter().map(|sort| largest_eigenvalue(sort.sum(own, of, weights))).collect()
    }

    /// The most of them over the mass, where the body's own particles weigh `own_kg`.
    pub(in crate::physics) fn over_mass(&self, resistances: &[f64], own_kg: f64) -> f64 {
        self.sorts.iter().zip(resistances).map(|(sort, resists)| resists / sort.mass_kg(own_kg)).fold(0.0, f64::max)
    }

    /// The largest value of one constant of a family of the body's own springs, whose other values are given, with which
    /// [`Self::most`] is no more than a limit. Zero where none is, infinite where the family has no such links or no weight.
    pub(in crate::physics) fn largest(
        &self,
        own: &CellKind,
        (family, of): (Family, Constant),
        weights: [f64; 3],
        limit: f64,
    ) -> f64 {
        let mut rest = *own;
        match of {
            Constant::Stiffness => rest.stiffness[family as usize] = 0.0,
            Constant::Damping => rest.damping[family as usize] = 0.0,
        }
        let weight = weights[family as usize];
        if weight <= 0.0 {
            return if self.most(&rest, of, weights) <= limit { f64::INFINITY } else { 0.0 };
        }
        let additions = self.sorts.iter().map(|sort| {
            let per_mass = 1.0 / sort.mass_kg(own.mass);
            let of_own = sort.own[family as usize] * per_mass;
            let to = sort.sum(&rest, of, weights) * (per_mass / weight);
            Addition { to, of: of_own, alone: largest_eigenvalue(of_own) }
        });
        largest_multiple(additions, limit / weight)
    }
}

/// The links that a particle may have, by where they lead: 27 places around it, those two cells away along each axis, and
/// what the particle weighs.
const SLOTS: usize = MASS + 1;
const MASS: usize = 27 + 6;
/// Stands where a particle has no such link.
const NOTHING: u16 = u16::MAX;

/// The slot of a link that leads so many cells away.
fn slot(way: [i64; 3]) -> usize {
    match way.iter().position(|cells| cells.abs() == 2) {
        Some(axis) => 27 + 2 * axis + usize::from(way[axis] > 0),
        None => usize::try_from((way[0] + 1) + 3 * (way[1] + 1) + 9 * (way[2] + 1)).unwrap_or(MASS),
    }
}

/// What [`slot`] is of, cells.
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

    /// A cube of this many cells an edge, each of its own springs or of one of two others.
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

    fn parts(simulation: &Simulation<f64>) -> (&ParticleLoads, &CellKind) {
        match &simulation.model().bodies[0].composition {
            Composition::Springs { loads, kinds } => (loads, &kinds[0]),
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
            let (loads, own) = match &simulation.model().bodies[0].composition {
                Composition::Springs { .. } => parts(&simulation),
                // The only cell is of the body's own, or all are of one other.
                _ => continue,
            };
            let bounds = [Constant::Stiffness, Constant::Damping].map(|of| loads.most(own, of, [1.0; 3]));
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
    fn the_largest_constant_is_the_one_at_which_the_limit_is_met() {
        let mut rng = Rng::new(14);
        for _ in 0..10 {
            let springs = std::array::from_fn(|_| random_springs(&mut rng));
            let simulation = mixed(3, springs, &mut rng);
            let (loads, own) = parts(&simulation);
            for of in [Constant::Stiffness, Constant::Damping] {
                let weights = [0; 3].map(|_| rng.between(0.5, 1.5));
                let limit = loads.most(own, of, weights) * rng.between(0.8, 2.0);
                for family in Family::ALL {
                    let largest = loads.largest(own, (family, of), weights, limit);
                    let mut there = *own;
                    match of {
                        Constant::Stiffness => there.stiffness[family as usize] = largest,
                        Constant::Damping => there.damping[family as usize] = largest,
                    }
                    let met = loads.most(&there, of, weights) / limit;
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
