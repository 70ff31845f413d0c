//! What the links of a body do at its particles, to be shown: over the box of a body that has one, as in a step.

use crate::math::{Real, Vector};
use crate::physics::forces::links::{for_each_link, is_damped};
use crate::physics::kernels::{InitialForce, Pass, add_forces, sum_magnitudes};
use crate::physics::model::plan::Plan;
use crate::physics::model::{BodyModel, Model};
use crate::physics::share::{Share, balanced_cut, shares};
use crate::physics::state::State;
use crate::physics::team::{self, DivisibleWork};

/// The sum of the forces of the links of every particle of the scene, N.
pub(super) fn link_forces<R: Real>(model: &Model<R>, plan: &Plan, state: &State<R>) -> Vec<R::Vec3> {
    sums(model, plan, state, Sum::Forces)
}

/// The mean magnitude of the forces of the links of every particle of the scene, N; zero where it has no links.
pub(super) fn mean_link_forces<R: Real>(model: &Model<R>, plan: &Plan, state: &State<R>) -> Vec<R> {
    let mean = |sums: R::Vec3| {
        let [magnitudes, count, _] = sums.components();
        if count > R::ZERO { magnitudes / count } else { R::ZERO }
    };
    sums(model, plan, state, Sum::Magnitudes).into_iter().map(mean).collect()
}

/// What is summed up over the links of a particle.
#[derive(Clone, Copy)]
enum Sum {
    /// Their forces, N.
    Forces,
    /// The magnitudes of their forces, N, as x, and their number, as y.
    Magnitudes,
}

fn sums<R: Real>(model: &Model<R>, plan: &Plan, state: &State<R>, what: Sum) -> Vec<R::Vec3> {
    let mut sums = vec![R::Vec3::ZERO; state.position.len()];
    let mut shares = shares(model, plan.threads);
    team::share(plan.threads, LinkSums { model, plan, state, what, shares: &mut shares, sums: &mut sums });
    sums
}

/// A job: sum up over the links of some shares.
struct LinkSums<'a, R: Real> {
    model: &'a Model<R>,
    plan: &'a Plan,
    state: &'a State<R>,
    what: Sum,
    shares: &'a mut [Share<R>],
    /// The sums at the particles of the shares; zero.
    sums: &'a mut [R::Vec3],
}

impl<R: Real> DivisibleWork for LinkSums<'_, R> {
    fn pieces(&self) -> usize {
        self.shares.len()
    }

    fn halve(self) -> [Self; 2] {
        let Self { shares, sums, .. } = self;
        let (low, high) = shares.split_at_mut(balanced_cut(shares, |_| true));
        let (of_low, of_high) = sums.split_at_mut(low.iter().map(|share| share.particles.len()).sum());
        [Self { shares: low, sums: of_low, ..self }, Self { shares: high, sums: of_high, ..self }]
    }

    fn work(self) {
        let Self { model, plan, state, what, shares, mut sums } = self;
        for share in shares {
            let own = sums.split_off_mut(..share.particles.len()).unwrap_or_default();
            let body = &model.bodies[share.body];
            let motion = [&state.position, &state.velocity].map(|of| &of[body.particles.clone()]);
            match (&body.boxed_links, &mut share.piece) {
                (Some(boxed), Some(piece)) => match what {
                    Sum::Forces => {
                        let is_damped = |family: usize| plan.families[family] && is_damped(plan, &body.links[family]);
                        let damped = [0, 1, 2].map(is_damped);
                        let pass = Pass { level: plan.simd, families: plan.families, damped };
                        let start = InitialForce::Alike(R::Vec3::ZERO);
                        add_forces(boxed, pass, motion, start, own, piece, &|| false, &mut |_, _| ());
                    }
                    Sum::Magnitudes => sum_magnitudes(boxed, (plan.simd, plan.families), motion, own, piece),
                },
                _ => sum_along_list(body, plan, motion, what, own),
            }
        }
    }
}

/// Adds the sums of a body, link by link.
fn sum_along_list<R: Real>(
    body: &BodyModel<R>,
    plan: &Plan,
    [position, velocity]: [&[R::Vec3]; 2],
    what: Sum,
    sums: &mut [R::Vec3],
) {
    for_each_link(body, plan, position, velocity, &|| false, |[i, j], on_i| {
        let [of_i, of_j] = match what {
            Sum::Forces => [on_i, -on_i],
            Sum::Magnitudes => [R::Vec3::new(on_i.length(), R::ONE, R::ZERO); 2],
        };
        sums[i] += of_i;
        sums[j] += of_j;
    });
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use glam::DVec3;

    use super::*;
    use crate::math::rng::Rng;
    use crate::physics::Simulation;
    use crate::physics::kernels::SimdLevel;
    use crate::physics::model::LinkConstants;
    use crate::scene::body::Inlay;
    use crate::scene::material::Spring;
    use crate::scene::presets::preset;
    use crate::scene::{Scene, Springs};

    /// The bodies of a scene, crumpled and in motion.
    fn crumpled(scene: &Scene) -> Simulation<f32> {
        let mut simulation = Simulation::<f32>::from_scene(scene, Path::new("")).expect("a sound scene");
        let (mut state, mut rng) = (simulation.state().clone(), Rng::new(5));
        for body in &simulation.model().bodies {
            let mut noise = |size: f64| DVec3::from([0; 3].map(|_| rng.between(-size, size))).as_vec3();
            for particle in body.particles.clone() {
                state.position[particle] += noise(0.2 * body.lattice.grid.cell_size);
                state.velocity[particle] += noise(f64::from(body.size));
            }
        }
        simulation.set_state(state);
        simulation
    }

    fn of(simulation: &Simulation<f32>, what: Sum) -> Vec<glam::Vec3> {
        sums(simulation.model(), simulation.plan(), simulation.state(), what)
    }

    /// The largest difference between sums and those along lists of links, over the largest of these.
    fn largest_difference(simulation: &Simulation<f32>, sums: &[glam::Vec3], listed_sum: Sum) -> f32 {
        let state = simulation.state();
        let (mut off, mut largest) = (0.0_f32, 0.0_f32);
        for body in &simulation.model().bodies {
            let own = body.particles.clone();
            let mut listed = vec![glam::Vec3::ZERO; own.len()];
            let motion = [&state.position, &state.velocity].map(|of| &of[own.clone()]);
            sum_along_list(body, simulation.plan(), motion, listed_sum, &mut listed);
            for (sum, listed) in sums[own].iter().zip(listed) {
                off = off.max((*sum - listed).length());
                largest = largest.max(listed.length());
            }
        }
        off / largest
    }

    #[test]
    fn sums_over_boxes_are_those_along_lists() {
        // One material, a model, with pins, several bodies, and one that fills little of its box.
        for name in ["cube-on-plane", "spot", "tree", "newton", "shell"] {
            let simulation = crumpled(&(preset(name).expect("a preset").build)());
            assert!(simulation.model().bodies.iter().any(|body| body.boxed_links.is_some()), "{name} has no box");
            for what in [Sum::Forces, Sum::Magnitudes] {
                let off = largest_difference(&simulation, &of(&simulation, what), what);
                assert!(off < 1e-5, "{name}: {off} of the largest");
            }
            let off = largest_difference(&simulation, &of(&simulation, Sum::Forces), Sum::Magnitudes);
            assert!(off > 0.1, "{name}: {off} between sums that have nothing to do with each other");
        }
    }

    #[test]
    fn a_body_of_several_materials_has_sums_of_its_own_links() {
        let mut scene = (preset("cube-on-plane").expect("a preset").build)();
        let springs = Springs { structural: Spring { stiffness: 3e3, damping: 1.0 }, ..Springs::default() };
        scene.bodies[0].inlays = vec![Inlay { max: [0.5, 2.0, 2.0], springs, ..Inlay::default() }];
        let simulation = crumpled(&scene);
        let constants = &simulation.model().bodies[0].links[0].constants;
        assert!(matches!(constants, LinkConstants::Classes { .. }), "there is one material");
        for what in [Sum::Forces, Sum::Magnitudes] {
            let off = largest_difference(&simulation, &of(&simulation, what), what);
            assert!(off < 1e-5, "{off} of the largest");
        }
    }

    #[test]
    fn threads_and_instructions_change_no_bit() {
        let mut simulation = crumpled(&(preset("coupler-20").expect("a preset").build)());
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().expect("threads");
        for what in [Sum::Forces, Sum::Magnitudes] {
            simulation.set_threads(1);
            simulation.plan_mut().simd = SimdLevel::Portable;
            let plain = of(&simulation, what);
            for level in SimdLevel::ALL.into_iter().filter(|level| level.is_available()) {
                for threads in [1, 2, 3] {
                    simulation.plan_mut().simd = level;
                    simulation.set_threads(threads);
                    let found = pool.install(|| of(&simulation, what));
                    assert!(found == plain, "{} with {threads} threads", level.name());
                }
            }
        }
    }
}
