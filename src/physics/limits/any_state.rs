//! How large a step may be in any state of a body.
//!
//! The bound at rest holds for a lattice in which the links of a particle point everywhere. In a body that was torn through
//! an obstacle or crumpled at a hundred metres a second they may line up, and a link that is stretched far resists across
//! its direction as much as along it. A link between masses m and M adds at most `κ (1/m + 1/M)` in any one direction, so
//! that in any state
//!
//! ```text
//! λ(dt) ≤ max over particles Σ over its links κ (1/m + 1/M),   κ = dt² k/l0 + 2 dt d/l0
//! ```
//!
//! Below that limit the motion stays bounded as long as the stiffness does not change. In such a body it changes from
//! substep to substep, which pumps energy into the body near the limit, so only a share of it is taken.

use std::cmp::Ordering;
use std::sync::Arc;

use super::{LinkLoad, Margin};
use crate::math::Real;
use crate::physics::model::Scheme;
use crate::physics::model::{BodyModel, Link, LinkConstants, LinkFamily, Model, Values};

/// Parts of a substep stay below this share of the step that is bounded in any state.
pub(crate) const ANY_STATE_SAFETY: f64 = 0.4;

/// Returns into how many parts a substep of `dt_secs` is divided while a body is strained.
pub(in crate::physics) fn parts<R: Real>(model: &Model<R>, scheme: Scheme, dt_secs: f64) -> u32 {
    let loads = model.bodies.iter().flat_map(|body| loads(body));
    let loads: Vec<_> = loads.map(|[stiffness, damping]| LinkLoad { stiffness, damping }).collect();
    parts_for(&loads, scheme, dt_secs, Margin::alike(ANY_STATE_SAFETY))
}

/// Returns into how many parts a substep is divided so that each part bears all of these loads with a margin.
fn parts_for(loads: &[LinkLoad], scheme: Scheme, dt_secs: f64, margin: Margin) -> u32 {
    let bear = |parts: u32| loads.iter().all(|load| load.is_borne(scheme, dt_secs / f64::from(parts), margin));
    // A few are enough for the share of the step at rest that is taken.
    (1..MAX_PARTS).find(|&parts| bear(parts)).unwrap_or(MAX_PARTS)
}

/// Returns the largest rate of damping in any state of any body, 1/s.
pub(in crate::physics) fn damping_rate<R: Real>(model: &Model<R>) -> f64 {
    model.bodies.iter().flat_map(|body| loads(body)).fold(0.0, |most, [_, damping]| most.max(damping))
}

/// Returns the resistance of a particle's links over its mass while their other ends stand still: stiffness, 1/s², and
/// damping, 1/s, averaged over all directions, and the largest of any particle.
pub(in crate::physics) fn own_rates<R: Real>(body: &BodyModel<R>) -> [f64; 2] {
    // Half of the mobility in a load is that of the other end, and a direction has a third of the sum.
    loads(body).into_iter().fold([0.0; 2], |most: [f64; 2], load| std::array::from_fn(|i| most[i].max(load[i] / 6.0)))
}

/// The most parts a substep is divided into.
pub(in crate::physics) const MAX_PARTS: u32 = 16;

/// Returns the sums of the inverse rest lengths of a particle's links by family, 1/m, once for each different particle of a
/// lattice.
pub(in crate::physics) fn inverse_length_sums<R: Real>(
    particles: usize,
    links: &[Arc<[Link<R>]>; 3],
) -> Arc<[[f64; 3]]> {
    let mut sums = vec![[0.0; 3]; particles];
    for (family, links) in links.iter().enumerate() {
        for link in &**links {
            for end in link.ends {
                sums[end as usize][family] += link.inverse_rest_length.to_f64();
            }
        }
    }
    sums.sort_unstable_by(|a, b| a.partial_cmp(b).unwrap_or(Ordering::Equal));
    sums.dedup();
    sums.into()
}

/// Returns the most that the links of each particle add to the square of a frequency (1/s²) and to a rate of damping (1/s);
/// once for each different particle, if these are known.
fn loads<R: Real>(body: &BodyModel<R>) -> Vec<[f64; 2]> {
    let is_alike = |family: &LinkFamily<R>| matches!(family.constants, LinkConstants::Uniform(_));
    if matches!(body.masses, Values::Uniform(_)) && body.links.iter().all(is_alike) {
        let mobility = 2.0 / body.particle_mass.to_f64();
        let constants = body.links.each_ref().map(|family| [family.stiffness, family.damping].map(Real::to_f64));
        let load = |crowd: &[f64; 3], which: usize| {
            mobility * crowd.iter().zip(&constants).map(|(sum, constants)| sum * constants[which]).sum::<f64>()
        };
        return body.inverse_length_sums.iter().map(|crowd| [load(crowd, 0), load(crowd, 1)]).collect();
    }
    loads_of_each(body)
}

fn loads_of_each<R: Real>(body: &BodyModel<R>) -> Vec<[f64; 2]> {
    let mut loads = vec![[0.0; 2]; body.particles.len()];
    for family in &body.links {
        for (number, link) in family.links.iter().enumerate() {
            let ends = link.ends.map(|end| end as usize);
            let mobility: f64 = ends.iter().map(|&end| body.inverse_mass(end).to_f64()).sum();
            let constants = family.constants(number).map(Real::to_f64);
            for end in ends {
                for (load, constant) in loads[end].iter_mut().zip(constants) {
                    *load += constant * link.inverse_rest_length.to_f64() * mobility;
                }
            }
        }
    }
    loads
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{loads, loads_of_each};
    use crate::physics::compile::compile;
    use crate::scene::presets::preset;
    use crate::scene::resolve::resolve;

    #[test]
    fn different_particles_bear_what_the_most_loaded_of_all_bears() {
        for name in ["cube-on-plane", "tree", "u-on-sphere"] {
            let scene = (preset(name).expect("a preset").build)();
            let lattice = resolve(&scene.bodies[0].shape, Path::new("."), &()).expect("a sound shape").lattice;
            let (model, _) = compile::<f64>(&scene, &[lattice], &[], None);
            let most =
                |loads: Vec<[f64; 2]>| loads.iter().fold([0.0_f64; 2], |[k, d], load| [k.max(load[0]), d.max(load[1])]);
            let (few, each) = (loads(&model.bodies[0]), loads_of_each(&model.bodies[0]));
            assert!(few.len() < each.len(), "{name}: {} of {}", few.len(), each.len());
            for (few, each) in most(few).into_iter().zip(most(each)) {
                assert!((few / each - 1.0).abs() < 1e-12, "{name}: {few}, not {each}");
            }
        }
    }
}
