//! Strained bodies: links far from their length make a body stiffer than it is at rest, so that steps that are safe at
//! rest give it energy.
//!
//! The stability limit at rest does not hold there. While any link is far longer or shorter than at rest, a substep is taken
//! in parts: as many as the directions of the links at the last check ask for ([`crate::physics::limits::present`]), and,
//! where links turn far within a substep, as many as are stable in any state ([`crate::physics::limits::any_state`]). At
//! rest that would cost three times as much for nothing.
//!
//! Each step length conserves an energy of its own, so a change of length adds or takes some. A body that swings across the
//! strain limit would change the length at the same place of every swing, and gain a little each time. So a body has to be
//! calm for a while before its substeps are whole again.

use crate::math::Real;
use crate::physics::forces::strain::{self, StraightMotion};
use crate::physics::forces::{ForceWorkspace, recovery};
use crate::physics::limits::any_state::MAX_PARTS;
use crate::physics::limits::{LinkLoad, present};
use crate::physics::model::plan::Plan;
use crate::physics::model::{BodyModel, Model, Scheme};
use crate::physics::state::{BodyMemory, State, Strain};
use crate::physics::stepping::checks;

/// The strain of a body becomes large when any link, stretched or compressed, exceeds the larger of these, and stays so
/// until all links are below the smaller. Bodies that fall on the ground by their own weight stay below. Where the plan's
/// scheme bears less, a body counts as taut above smaller strains ([`Plan::strains`]): the scheme of substeps in which it
/// meets others may bear more.
pub(crate) const STRAIN_THRESHOLDS: [f64; 2] = [0.5, 0.7];

/// How long all links have to be below the smaller strain until the body is calm, s, ...
const CALM_SECS: f64 = 0.25;

/// ... and for how many substeps at least.
const CALM_SUBSTEPS: u64 = 100;

/// From check to check the load of a strained body's links falls to no less than this share: it, too, sets the step length,
/// which must not change suddenly.
const LOAD_DECAY: f64 = 0.98;

/// How far the ends of a link in a strained body move relative to each other in a part at most, in its length: a link that
/// turns about or is turned inside out within a step is stiffer on the way than at either end.
const MAX_LINK_DISPLACEMENT: f64 = 0.5;

/// Into how many parts substeps are divided while a body is strained.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct StrainPolicy {
    /// The parts while no body is strained.
    pub(in crate::physics) parts_at_rest: u32,
    /// The parts while a body is strained.
    pub(in crate::physics) strained_parts: u32,
    /// The scheme that takes the parts.
    pub(in crate::physics) scheme: Scheme,
    /// The least strain of a body that counts as strained here.
    pub(in crate::physics) min_strain: Strain,
}

impl StrainPolicy {
    /// The division into these numbers of parts, taken by a scheme.
    pub(in crate::physics) fn new(scheme: Scheme, [parts_at_rest, strained_parts]: [u32; 2], plan: &Plan) -> Self {
        Self {
            parts_at_rest,
            strained_parts,
            scheme,
            min_strain: if scheme == plan.scheme { Strain::Taut } else { Strain::Large },
        }
    }

    /// The parts that the bodies need as they are strained now; none where none is.
    fn needed_parts<R: Real>(self, model: &Model<R>, plan: &Plan, state: &State<R>) -> Option<u32> {
        let secs = plan.substep_secs() / f64::from(self.parts_at_rest);
        let of = |(body, memory): (&BodyModel<R>, &BodyMemory)| {
            let is_strained = memory.strain >= self.min_strain;
            // The push on cells near inversion is not a link force. The longer substeps of the stabilised scheme bear little
            // of it, even where links need no shorter ones.
            let is_crushed =
                (is_strained || self.scheme == Scheme::Stabilised) && recovery::pushes(body, memory, state);
            let is_known = self.scheme == Scheme::SemiImplicit && memory.load != LinkLoad::default();
            match () {
                () if is_crushed || is_strained && !is_known => Some(self.strained_parts),
                () if is_strained => {
                    Some(self.parts_at_rest.saturating_mul(present::parts(memory.load, secs)).min(self.strained_parts))
                }
                () => None,
            }
        };
        let bodies = model.bodies.iter().zip(&state.bodies).filter(|(_, memory)| !memory.asleep);
        bodies.filter_map(of).max()
    }
}

/// Checks the links where that is due, as they are and as they would be after the substep. Returns into how many parts the
/// coming substep is divided: one, or at least as many as strained bodies need. `max_relative_speeds` bounds the relative
/// speeds of each body's particles, m/s.
pub(in crate::physics) fn parts_before_substep<R: Real>(
    model: &Model<R>,
    plan: &Plan,
    strain_policy: StrainPolicy,
    max_relative_speeds: &[f64],
    state: &mut State<R>,
    forces: &mut ForceWorkspace<R>,
) -> u32 {
    if strain_policy.strained_parts == 0 {
        return 1;
    }
    let mut parts_by_displacement = 1;
    let is_time = checks::is_check_due_at(model, plan, state, max_relative_speeds);
    if is_time || state.bodies.iter().any(|memory| memory.strain > Strain::Small) {
        let checked = if is_time { CheckedBodies::All } else { CheckedBodies::Strained };
        let State { position, velocity, bodies, .. } = state;
        let motion = StraightMotion { position, velocity, secs: R::from_f64(plan.substep_secs()) };
        parts_by_displacement = check_strain(model, plan, checked, motion, bodies, forces);
    }
    let needed = strain_policy.needed_parts(model, plan, state);
    // Where links turn far in the substep, their present directions do not matter.
    needed.map_or(parts_by_displacement, |needed| {
        if parts_by_displacement > 1 { parts_by_displacement.max(strain_policy.strained_parts) } else { needed }
    })
}

/// Checks the links between two parts of a substep that began without a strained body, where that is due: the last check
/// was `secs_since_check` (s) ago, and the next part is `secs` (s) long. Returns how many parts of the substep the bodies
/// need that are strained by now. Without this, a body that becomes strained in a long substep that is divided for contact
/// between bodies would go through its other parts as if it were at rest.
pub(in crate::physics) fn parts_within_substep<R: Real>(
    model: &Model<R>,
    plan: &Plan,
    state: &mut State<R>,
    strain_policy: StrainPolicy,
    secs_since_check: &mut f64,
    secs: f64,
    forces: &mut ForceWorkspace<R>,
) -> Option<u32> {
    if *secs_since_check + secs > checks::check_interval_secs(model, plan, state) {
        *secs_since_check = 0.0;
        let State { position, velocity, bodies, .. } = state;
        let motion = StraightMotion { position, velocity, secs: R::from_f64(secs) };
        check_strain(model, plan, CheckedBodies::AllWithinSubstep, motion, bodies, forces);
    }
    strain_policy.needed_parts(model, plan, state)
}

/// Whether links of a body that is awake and not strained would exceed the larger strain in this motion, as where contact
/// stops some particles and not others.
pub(in crate::physics) fn would_tear_bodies<R: Real>(
    model: &Model<R>,
    plan: &Plan,
    memories: &[BodyMemory],
    motion: StraightMotion<'_, R>,
    forces: &mut ForceWorkspace<R>,
) -> bool {
    forces.find_strained(model, memories, plan.simd, motion, |number| {
        let (body, memory) = (&model.bodies[number], &memories[number]);
        let is_due = !memory.asleep && memory.strain == Strain::Small && {
            let max_relative_speed = checks::max_relative_speed_of::<R>(plan, motion.of(body).velocity);
            checks::body_check_interval_secs(body, max_relative_speed) < motion.secs.to_f64()
        };
        is_due.then_some(plan.strain_thresholds[1])
    });
    (0..model.bodies.len()).any(|body| forces.is_strained(body))
}

/// The bodies whose links are checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::physics) enum CheckedBodies {
    /// Those of strained bodies.
    Strained,
    /// Those of all.
    All,
    /// Those of all, between two parts of a substep: it does not count as one more calm substep.
    AllWithinSubstep,
}

/// Checks the links in a motion and remembers which bodies are strained. Returns into how many parts the motion has to be
/// divided so that no link of a strained body goes too far in one.
pub(in crate::physics) fn check_strain<R: Real>(
    model: &Model<R>,
    plan: &Plan,
    checked: CheckedBodies,
    motion: StraightMotion<'_, R>,
    memories: &mut [BodyMemory],
    forces: &mut ForceWorkspace<R>,
) -> u32 {
    let calm_substeps = checks::substeps_in(plan, CALM_SECS, libm::ceil).max(CALM_SUBSTEPS);
    let is_checked =
        |memory: &BodyMemory| !memory.asleep && (checked != CheckedBodies::Strained || memory.strain > Strain::Small);
    forces.find_strained(model, memories, plan.simd, motion, |body| {
        let memory = &memories[body];
        is_checked(memory).then_some(match memory.strain {
            Strain::Small => plan.strain_thresholds[1],
            Strain::Taut => plan.strain_thresholds[0],
            Strain::Large => STRAIN_THRESHOLDS[0],
        })
    });
    let may_be_taut = plan.strain_thresholds[1] < STRAIN_THRESHOLDS[1];
    let above_small = if may_be_taut { Strain::Taut } else { Strain::Large };
    for (number, memory) in memories.iter_mut().enumerate().filter(|(_, memory)| is_checked(memory)) {
        if forces.is_strained(number) {
            (memory.strain, memory.calm_substeps) = (memory.strain.max(above_small), 0);
        } else if memory.strain > Strain::Small && checked != CheckedBodies::AllWithinSubstep {
            memory.calm_substeps += 1;
            if u64::from(memory.calm_substeps) >= calm_substeps {
                let is_less = memory.strain == Strain::Large && may_be_taut;
                (memory.strain, memory.calm_substeps) = (if is_less { Strain::Taut } else { Strain::Small }, 0);
            }
        }
    }
    if may_be_taut {
        let is_taut = |memory: &BodyMemory| !memory.asleep && memory.strain == Strain::Taut;
        forces.find_strained(model, memories, plan.simd, motion, |body| {
            is_taut(&memories[body]).then_some(STRAIN_THRESHOLDS[1])
        });
        for (number, memory) in memories.iter_mut().enumerate().filter(|(_, memory)| is_taut(memory)) {
            if forces.is_strained(number) {
                (memory.strain, memory.calm_substeps) = (Strain::Large, 0);
            }
        }
    }
    for (body, memory) in model.bodies.iter().zip(&mut *memories).filter(|(_, memory)| is_checked(memory)) {
        if memory.strain == Strain::Small {
            memory.load = LinkLoad::default();
        } else if checked != CheckedBodies::Strained || memory.load == LinkLoad::default() {
            let now = present::load(body, motion.of(body).position, &mut forces.sums);
            memory.load = now.larger_of(memory.load.times(LOAD_DECAY));
        }
    }
    let strained =
        model.bodies.iter().zip(memories).filter(|(_, memory)| is_checked(memory) && memory.strain > Strain::Small);
    let max_displacement = strained.fold(0.0, |most: f64, (body, _)| {
        let own = motion.of(body);
        let bound = checks::max_relative_speed_of::<R>(plan, own.velocity)
            * body.inverse_cell_size.to_f64()
            * own.secs.to_f64();
        // No link is shorter at rest than a cell: where particles are slow relative to each other, the bound is enough.
        most.max(if bound <= MAX_LINK_DISPLACEMENT { bound } else { strain::max_link_displacement(body, own) })
    });
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count from zero up, saturating")]
    let parts = libm::ceil(max_displacement / MAX_LINK_DISPLACEMENT) as u32;
    parts.clamp(1, MAX_PARTS)
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::Arc;

    use glam::DVec3;

    use crate::geometry::Lattice;
    use crate::math::rng::Rng;
    use crate::physics::Simulation;
    use crate::physics::limits::load::{DAMPING_SAFETY, HOLDING_SHARE, SAFETY};
    use crate::physics::state::Strain;
    use crate::scene::body::CubeShape;
    use crate::scene::material::Spring;
    use crate::scene::resolve::resolve;
    use crate::scene::settings::Stepping;
    use crate::scene::{Body, Material, Scene, Shape, Springs};

    fn cube(dt: f64) -> (Scene, Vec<Arc<Lattice>>) {
        let mut scene = Scene { bodies: vec![Body::default()], ..Scene::default() };
        scene.settings.gravity = [0.0; 3];
        (scene.settings.dt, scene.settings.allow_implicit) = (dt, false);
        scene.bodies[0].self_collides = false;
        let lattice = resolve(&scene.bodies[0].shape, Path::new("."), &()).expect("a cube").lattice;
        (scene, vec![lattice])
    }

    /// Particles at random places, up to `size` (m) from the origin along each axis.
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
        let taken = shreds.substep(&mut ()).counters.substeps;
        assert!(taken > 1 && taken <= parts, "links many times their length: {taken} of {parts}");
        let mut long = Simulation::<f64>::new(&scene, &lattices);
        let mut state = long.state().clone();
        state.position.iter_mut().for_each(|x| x.y *= 1.9);
        long.set_state(state);
        let of_long = long.substep(&mut ()).counters.substeps;
        assert!(of_long < taken, "its links point where they did: {of_long}, {taken} in shreds");
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
            simulation.plan_mut().parts = 0;
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

    /// The energy of a cube that swings across the limit of strain, undamped, over that at the start.
    fn swung(mut change: impl FnMut(&mut Simulation<f64>)) -> f64 {
        let (mut scene, _) = cube(0.02);
        scene.settings.allow_implicit = false;
        scene.settings.inversion_recovery = false;
        scene.obstacles.clear();
        scene.bodies[0].shape = Shape::Cube(CubeShape { cells: 4, size: 0.0072 });
        let [structural, shear, bending] = [10.7, 145.4, 163.9].map(|stiffness| Spring { stiffness, damping: 0.0 });
        scene.bodies[0].material = Material::Springs(Springs { structural, shear, bending, particle_mass: 0.14 });
        let lattices = vec![resolve(&scene.bodies[0].shape, Path::new("."), &()).expect("a cube").lattice];
        let mut simulation = Simulation::<f64>::new(&scene, &lattices);
        let mut state = simulation.state().clone();
        let mut rng = Rng::new(3);
        for v in &mut state.velocity {
            *v = DVec3::from([0; 3].map(|_| rng.between(-0.5, 0.5)));
        }
        simulation.set_state(state);
        let mean = |simulation: &mut Simulation<f64>, change: &mut dyn FnMut(&mut Simulation<f64>)| {
            let energies = (0..300).map(|_| {
                change(simulation);
                assert!(!simulation.substep(&mut ()).diverged, "it stays finite");
                simulation.diagnostics().energy.total()
            });
            energies.sum::<f64>() / 300.0
        };
        let begin = mean(&mut simulation, &mut change);
        for _ in 0..6000 {
            change(&mut simulation);
            simulation.substep(&mut ());
        }
        mean(&mut simulation, &mut change) / begin
    }

    /// The most energy that is seen of a body with these dampings by family whose particles are misplaced by up to that
    /// share of a cell, over that at the start, in steps of a share of its limit.
    fn most(dampings: [f64; 3], noise: f64, share: f64) -> f64 {
        let is_damped = dampings.iter().any(|damping| *damping > 0.0);
        let stiffness = |damping: f64| if is_damped { 20.0 * damping.max(0.02) } else { 20.0 };
        let spring = |damping: f64| Spring { stiffness: stiffness(damping), damping: 2.0 * damping };
        most_of(dampings.map(spring), noise, share)
    }

    fn most_of([structural, shear, bending]: [Spring; 3], noise: f64, share: f64) -> f64 {
        let (mut scene, _) = cube(1e-3);
        (scene.settings.inversion_recovery, scene.settings.stepping) = (false, Stepping::Manual);
        scene.bodies[0].shape = Shape::Cube(CubeShape { cells: 6, size: 0.6 });
        let springs = Springs { structural, shear, bending, particle_mass: 0.01 };
        scene.bodies[0].material = Material::Springs(springs);
        let lattices = vec![resolve(&scene.bodies[0].shape, Path::new("."), &()).expect("a cube").lattice];
        let limit = Simulation::<f64>::new(&scene, &lattices).plan().limits.dt_limit_secs.expect("a limit");
        scene.settings.dt = share * limit;
        let mut simulation = Simulation::<f64>::new(&scene, &lattices);
        simulation.plan_mut().watched = false;
        let mut rng = Rng::new(5);
        let mut state = simulation.state().clone();
        for x in &mut state.position {
            *x += DVec3::from([0; 3].map(|_| 0.1 * noise * rng.between(-1.0, 1.0)));
        }
        simulation.set_state(state);
        let begin = simulation.diagnostics().energy.total();
        let energies = (0..2000).map(|_| {
            let diverged = simulation.substep(&mut ()).diverged;
            if diverged { f64::INFINITY } else { simulation.diagnostics().energy.total() / begin }
        });
        energies.fold(0.0, f64::max)
    }

    #[test]
    fn damping_may_come_nearer_to_its_limit_than_stiffness_where_shear_links_hold_a_body() {
        let [folding, held, alike] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0; 3]];
        for noise in [0.1, 0.5, 1.0] {
            for (dampings, share) in
                [(folding, DAMPING_SAFETY[0]), (held, DAMPING_SAFETY[1]), (alike, DAMPING_SAFETY[1])]
            {
                let kept = most(dampings, noise, share);
                assert!(kept < 1.0, "{dampings:?}: {kept} of the energy, misplaced by {noise} cells");
            }
        }
        for (dampings, share) in [(folding, 0.9), (alike, 1.1), ([0.0; 3], 0.9)] {
            let gained = most(dampings, 0.5, share);
            assert!(gained > 1e3, "{dampings:?}: {gained} of the energy at {share}: the margin is for nothing");
        }
    }

    #[test]
    fn damping_of_bending_links_may_come_near_its_limit_where_shear_links_are_stiff_enough() {
        let kept = |shear: f64, share: f64| {
            let [structural, shear] = [40.0, shear].map(|stiffness| Spring { stiffness, damping: 0.0 });
            let bending = Spring { stiffness: 40.0, damping: 1.0 };
            [0.5, 1.0].map(|noise| most_of([structural, shear, bending], noise, share))
        };
        for shear in [1.01, 3.0, 10.0].map(|times| times * HOLDING_SHARE * 40.0) {
            let held = kept(shear, DAMPING_SAFETY[2]);
            assert!(held.into_iter().all(|kept| kept < 1.0), "{shear} N/m: {held:?} of the energy");
        }
        let [free, folded] = [SAFETY, DAMPING_SAFETY[2]].map(|share| kept(0.0, share));
        assert!(free.into_iter().all(|kept| kept < 1.0), "{free:?} of the energy");
        assert!(folded.into_iter().all(|gained| gained > 1e3), "{folded:?} of the energy: the margin is for nothing");
    }

    #[test]
    fn what_swings_across_the_limit_gains_no_energy_and_would_if_it_changed_its_step_every_time() {
        let mut strained = 0;
        let kept = swung(|simulation| strained += usize::from(simulation.state().bodies[0].strain > Strain::Small));
        assert!(strained > 1000, "it swings across: strained in {strained} substeps");
        assert!(kept < 1.01, "{kept} of the energy");
        let hasty = swung(|simulation| {
            let mut state = simulation.state().clone();
            // One calm check is enough.
            state.bodies[0].calm_substeps = if state.bodies[0].strain > Strain::Small { u32::MAX - 1 } else { 0 };
            simulation.set_state(state);
        });
        assert!(hasty > 1.05, "{hasty} of the energy: to wait is for nothing");
    }

    #[test]
    fn a_body_that_is_about_to_be_torn_takes_its_first_substep_in_parts() {
        let (scene, lattices) = cube(1e-3);
        let mut simulation = Simulation::<f64>::new(&scene, &lattices);
        let mut state = simulation.state().clone();
        state.velocity[0] = DVec3::X * 1e3;
        simulation.set_state(state);
        let parts = u64::from(simulation.plan().parts);
        let taken = simulation.substep(&mut ()).counters.substeps;
        assert!(parts > 1 && taken > parts, "a corner leaves it at 1000 m/s: {taken}, {parts} for the strain alone");
    }

    #[test]
    fn shreds_gain_no_energy_and_would_without_parts() {
        let [with, without] = [true, false].map(gain);
        assert!(with < 1.05, "{with} of the energy");
        assert!(without > 1.3, "{without} of the energy: parts are for nothing");
    }
}
