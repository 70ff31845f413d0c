//! Strained bodies: links far from their length make a body stiffer than it is at rest, so that steps that are safe at
//! rest give it energy.
//!
//! The bound of [`crate::physics::limits`] holds for a lattice at rest, in which the links of a particle point everywhere. In a
//! body that was torn through an obstacle or crumpled at a hundred metres a second they may line up, and a link that is
//! stretched far resists across its direction as much as along it. A link between masses m and M adds no more than
//! `κ (1/m + 1/M)` to what may be in one direction, so that in any state
//!
//! ```text
//! λ(dt) ≤ max over particles Σ over its links κ (1/m + 1/M),   κ = dt² k/l0 + 2 dt d/l0
//! ```
//!
//! Below the limit of that the motion stays bounded as long as the stiffness does not change; it changes from substep to
//! substep in such a body, which pumps energy into it near the limit. While any link is longer or shorter by far than at
//! rest a substep is therefore taken in parts that stay below [`SHARE`] of it. At rest this would be three times as dear
//! as it need be for nothing.

use std::cmp::Ordering;
use std::sync::Arc;

use crate::math::{Real, Vector};
use crate::physics::forces::recovery;
use crate::physics::limits::{LATTICE_LIMIT, load_shares};
use crate::physics::model::plan::Plan;
use crate::physics::model::{BodyModel, Link, LinkConstants, LinkFamily, Model, Values};
use crate::physics::state::State;
use crate::scene::settings::Integrator;

/// A body is strained from the larger of these strains of any link on, stretched or compressed, until all are below the
/// smaller: bodies that fall on the ground of their own weight are not.
pub(crate) const STRAINS: [f64; 2] = [0.5, 0.7];

/// Parts stay below this share of the step that is bounded in any state.
pub(crate) const SHARE: f64 = 0.4;

/// Into how many parts a substep of `dt_secs` is divided while a body is strained.
pub(in crate::physics) fn parts<R: Real>(model: &Model<R>, integrator: Integrator, dt_secs: f64) -> u32 {
    let loads: Vec<[f64; 2]> = model.bodies.iter().flat_map(|body| loads(body)).collect();
    let is_bearable = |parts: u32| {
        let shares = load_shares(integrator, dt_secs / (SHARE * f64::from(parts)));
        shares.iter().all(|share| {
            let bearable = |[k, d]: &[f64; 2]| k * share.stiffness + d * share.damping <= LATTICE_LIMIT;
            loads.iter().all(bearable)
        })
    };
    // The share of the step at rest that is taken needs a few at most.
    (1..MOST_PARTS).find(|&parts| is_bearable(parts)).unwrap_or(MOST_PARTS)
}

/// No substep is divided further.
const MOST_PARTS: u32 = 16;

/// For every different particle of a lattice the sums of its links' inverse rest lengths by family, 1/m.
pub(in crate::physics) fn crowds<R: Real>(particles: usize, links: &[Arc<[Link<R>]>; 3]) -> Arc<[[f64; 3]]> {
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

/// What the links of every particle add at most to the square of a frequency (1/s²) and to a rate of damping (1/s): of
/// every different one, where that is known.
fn loads<R: Real>(body: &BodyModel<R>) -> Vec<[f64; 2]> {
    let is_alike = |family: &LinkFamily<R>| matches!(family.constants, LinkConstants::Uniform(_));
    if matches!(body.masses, Values::Uniform(_)) && body.links.iter().all(is_alike) {
        let mobility = 2.0 / body.particle_mass.to_f64();
        let constants = body.links.each_ref().map(|family| [family.stiffness, family.damping].map(Real::to_f64));
        let load = |crowd: &[f64; 3], which: usize| {
            mobility * crowd.iter().zip(&constants).map(|(sum, constants)| sum * constants[which]).sum::<f64>()
        };
        return body.crowds.iter().map(|crowd| [load(crowd, 0), load(crowd, 1)]).collect();
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

/// Looks at the links where it is due, and tells into how many parts the coming substep is divided.
pub(in crate::physics) fn parts_now<R: Real>(model: &Model<R>, plan: &Plan, state: &mut State<R>) -> u32 {
    if plan.parts <= 1 {
        return 1;
    }
    if state.bodies.iter().any(|memory| memory.strained) || recovery::is_time_to_look(model, plan, state) {
        look(model, state);
    }
    let is_strained = state.bodies.iter().any(|memory| memory.strained && !memory.asleep);
    if is_strained { plan.parts } else { 1 }
}

fn look<R: Real>(model: &Model<R>, state: &mut State<R>) {
    for (body, memory) in model.bodies.iter().zip(&mut state.bodies).filter(|(_, memory)| !memory.asleep) {
        let strain = STRAINS[usize::from(!memory.strained)];
        let [shortest, longest] = [1.0 - strain, 1.0 + strain].map(R::from_f64);
        let position = &state.position[body.particles.clone()];
        // Links without a force, too: their length tells of the angles between others.
        memory.strained = body.links.iter().flat_map(|family| family.links.iter()).any(|link| {
            let [i, j] = link.ends.map(|end| end as usize);
            let d = (position[j] - position[i]) * link.inverse_rest_length;
            let squared = d.dot(d);
            squared > longest * longest || squared < shortest * shortest
        });
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::Arc;

    use glam::DVec3;

    use super::{loads, loads_of_each};
    use crate::geometry::Lattice;
    use crate::math::rng::Rng;
    use crate::physics::Simulation;
    use crate::physics::compile::compile;
    use crate::scene::body::CubeShape;
    use crate::scene::material::Spring;
    use crate::scene::presets::preset;
    use crate::scene::resolve::resolve;
    use crate::scene::{Body, Material, Scene, Shape, Springs};

    fn cube(dt: f64) -> (Scene, Vec<Arc<Lattice>>) {
        let mut scene = Scene { bodies: vec![Body::default()], ..Scene::default() };
        scene.settings.gravity = [0.0; 3];
        scene.settings.dt = dt;
        let lattice = resolve(&scene.bodies[0].shape, Path::new("."), &()).expect("a cube").lattice;
        (scene, vec![lattice])
    }

    /// Particles all over the place, as far apart as so many body sizes.
    fn crumpled(scene: &Scene, lattices: &[Arc<Lattice>], size: f64) -> Simulation<f64> {
        let mut simulation = Simulation::<f64>::new(scene, lattices);
        let mut rng = Rng::new(5);
        let mut state = simulation.state().clone();
        for x in &mut state.position {
            *x = DVec3::from([0; 3].map(|_| rng.between(-size, size)));
        }
        simulation.set_state(state);
        simulation
    }

    #[test]
    fn a_body_at_rest_takes_its_substeps_whole_and_one_in_shreds_in_parts() {
        let (scene, lattices) = cube(1e-3);
        let mut calm = Simulation::<f64>::new(&scene, &lattices);
        assert!(calm.plan().parts > 1, "the safe step at rest is too long for shreds: {}", calm.plan().parts);
        assert_eq!(calm.substep(&mut ()).counters.substeps, 1, "nothing is stretched");
        let mut shreds = crumpled(&scene, &lattices, 5.0);
        let parts = u64::from(shreds.plan().parts);
        assert_eq!(shreds.substep(&mut ()).counters.substeps, parts, "links many times their length");
        assert!((shreds.state().time_secs - calm.state().time_secs).abs() < 1e-15, "the same time has passed");
        let (small, _) = cube(1e-5);
        assert_eq!(Simulation::<f64>::new(&small, &lattices).plan().parts, 1, "a small step needs no parts");
    }

    /// The energy after a while over that at the start of an undamped body in shreds; without bound where it blew up.
    fn gain(with_parts: bool) -> f64 {
        let (mut scene, _) = cube(0.1);
        scene.settings.inversion_recovery = false;
        scene.settings.allow_implicit = false;
        scene.bodies[0].shape = Shape::Cube(CubeShape { cells: 2, size: 0.1 });
        let [structural, bending] = [24.0, 4.0].map(|stiffness| Spring { stiffness, damping: 0.0 });
        let shear = Spring { stiffness: 0.0, damping: 0.0 };
        scene.bodies[0].material = Material::Springs(Springs { structural, shear, bending, particle_mass: 3e-5 });
        let lattices = vec![resolve(&scene.bodies[0].shape, Path::new("."), &()).expect("a cube").lattice];
        let mut simulation = crumpled(&scene, &lattices, 0.3);
        if !with_parts {
            simulation.plan_mut().parts = 1;
        }
        let mean = |simulation: &mut Simulation<f64>| {
            let energies = (0..200).map(|_| {
                let diverged = simulation.substep(&mut ()).diverged;
                if diverged { f64::INFINITY } else { simulation.diagnostics().energy.total() }
            });
            energies.sum::<f64>() / 200.0
        };
        let begin = mean(&mut simulation);
        let is_finite = (0..1000).all(|_| !simulation.substep(&mut ()).diverged);
        if is_finite { mean(&mut simulation) / begin } else { f64::INFINITY }
    }

    #[test]
    fn shreds_gain_no_energy_and_would_without_parts() {
        let [with, without] = [true, false].map(gain);
        assert!(with < 1.05, "{with} of the energy");
        assert!(without > 1.3, "{without} of the energy: parts are for nothing");
    }

    #[test]
    fn different_particles_bear_what_the_most_loaded_of_all_bears() {
        for name in ["cube-on-plane", "tree", "u-on-sphere"] {
            let scene = (preset(name).expect("a preset").build)();
            let lattice = resolve(&scene.bodies[0].shape, Path::new("."), &()).expect("a sound shape").lattice;
            let (model, _) = compile::<f64>(&scene, &[lattice], None);
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
