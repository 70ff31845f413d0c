//! Work that a step avoids: far tests, stages that a scene does not need.

use gelatin::physics::Stage;
use gelatin::physics::StageTimer;
use gelatin::physics::StepReport;
use gelatin::scene::Scene;
use gelatin::scene::presets::{preset, presets};
use gelatin::scene::settings::ContactRule;

use crate::support::{alone, ball, cube, falling, plane, simulate, springs};

/// Steps until a preset has landed.
const STEPS: usize = 800;

/// The presets under a contact rule, without the finest models and the largest scenes, which differ only in cost.
fn coarse_presets(rule: ContactRule) -> impl Iterator<Item = (&'static str, Scene)> {
    let costly = [
        "coupler-40",
        "coupler-20",
        "spot",
        "chair",
        "shell",
        "bridge",
        "chair-modes",
        "bridge-modes",
        "spot-modes",
        "many",
    ];
    presets().iter().filter(move |preset| !costly.contains(&preset.name)).map(move |preset| {
        let mut scene = (preset.build)();
        scene.settings.contact = rule;
        (preset.name, scene)
    })
}

#[test]
fn the_broad_phase_saves_tests_in_every_preset() {
    // That the broad phase changes no bit is checked by the recorded fingerprints (`golden`).
    for (name, scene) in coarse_presets(ContactRule::Implicit) {
        let mut simulation = simulate::<f32>(&scene);
        let counts = (0..STEPS)
            .map(|_| simulation.step().counters)
            .fold([0; 2], |[saved, done], counted| [saved + counted.narrow_tests_saved, done + counted.narrow_tests]);
        let [saved, done] = counts;
        assert!(saved > 0, "{name}: {done} tests done, none saved");
    }
}

#[test]
fn the_broad_phase_changes_no_preset_by_the_thesis_rule_and_saves_tests() {
    for (name, scene) in coarse_presets(ContactRule::Thesis) {
        let mut with_boxes = simulate::<f32>(&scene);
        let mut without = simulate::<f32>(&scene);
        without.plan_mut().broad_phase = false;
        let (mut saved, mut done, mut all) = (0, 0, 0);
        for _ in 0..STEPS {
            let report = with_boxes.step();
            saved += report.counters.narrow_tests_saved;
            done += report.counters.narrow_tests;
            all += without.step().counters.narrow_tests;
        }
        assert_eq!(with_boxes.hash(), without.hash(), "{name}: bit for bit");
        assert!(saved > 0 && done < all, "{name}: {done} of {all} tests done, {saved} saved");
    }
}

/// Counts how often each stage begins.
#[derive(Default)]
struct Stages([u32; Stage::ALL.len()]);

impl StageTimer for Stages {
    fn enter(&mut self, stage: Stage) {
        self.0[stage as usize] += 1;
    }
    fn leave(&mut self) {}
}

fn begun(scene: &Scene, stage: Stage) -> u32 {
    let mut stages = Stages::default();
    simulate::<f32>(scene).substep(&mut stages);
    stages.0[stage as usize]
}

#[test]
fn what_a_scene_lacks_is_not_run() {
    let empty = alone(cube(2, 1.0, springs(10.0, 0.1, 0.1), [0.0; 3]), 1e-3);
    assert_eq!(begun(&empty, Stage::Contact), 0, "no obstacle, no contact");
    assert_eq!(begun(&empty, Stage::BroadPhase), 0, "and no boxes");
    assert_eq!(begun(&empty, Stage::Links), 1, "the counter counts");
    let slack = alone(cube(2, 1.0, springs(0.0, 0.0, 0.1), [0.0; 3]), 1e-3);
    assert_eq!(begun(&slack, Stage::Links), 0, "no stiffness and no damping, no link forces");
}

#[test]
fn a_far_ball_costs_no_test() {
    let mut scene = alone(cube(2, 1.0, springs(10.0, 0.1, 0.1), [0.0; 3]), 1e-3);
    scene.obstacles.push(ball([50.0, 0.0, 0.0], 1.0));
    let mut simulation = simulate::<f32>(&scene);
    // Only after the first substep is it known that nothing touches.
    simulation.step();
    let mut stages = Stages::default();
    let report = simulation.step_timed(&mut stages);
    assert_eq!(
        (report.counters.narrow_tests, report.counters.narrow_tests_saved),
        (0, 27),
        "every particle was saved a test"
    );
    assert_eq!(
        (stages.0[Stage::BroadPhase as usize], stages.0[Stage::Contact as usize]),
        (1, 0),
        "by one look at boxes"
    );
}

/// A cube that falls on a plane for a second: its report, and the stages that ran.
fn fallen(change: impl Fn(&mut Scene)) -> (StepReport, Vec<String>) {
    let mut scene = falling(cube(3, 1.0, springs(40.0, 0.2, 0.02), [0.0, 0.6, 0.0]));
    scene.obstacles.push(plane([0.0; 3], [0.0; 3], [0.6, 0.5]));
    change(&mut scene);
    let mut simulation = simulate::<f32>(&scene);
    let mut report = StepReport::default();
    (0..1000).for_each(|_| report.add(&simulation.step()));
    (report, simulation.plan().left_out().into_iter().map(|(name, _)| name).collect())
}

fn material(scene: &mut Scene) -> &mut gelatin::scene::Springs {
    let gelatin::scene::Material::Springs(springs) = &mut scene.bodies[0].material else {
        unreachable!("a body of springs")
    };
    springs
}

#[test]
fn each_feature_runs_only_where_it_is_needed_and_the_plan_says_so() {
    let (report, left_out) = fallen(|_| ());
    assert!(
        report.counters.frictions > 0 && report.counters.damped_link_forces == report.counters.link_forces,
        "all is needed: {report:?}"
    );
    assert_eq!((report.counters.sphere_tests, report.counters.recovery_cells), (0, 0), "but no sphere and no push");
    assert!(left_out.contains(&"sphere contact".to_owned()), "{left_out:?}");
    let (report, left_out) = fallen(|scene| scene.obstacles.push(ball([0.0, 0.2, 0.0], 0.3)));
    assert!(report.counters.sphere_tests > 0 && !left_out.contains(&"sphere contact".to_owned()), "a sphere is tested");
    let (report, left_out) = fallen(|scene| scene.obstacles[0] = plane([0.0; 3], [0.0; 3], [0.0; 2]));
    assert!(report.last.contacts > 0 && report.counters.frictions == 0, "no coefficient, no friction: {report:?}");
    assert!(left_out.contains(&"friction".to_owned()), "{left_out:?}");
    let with_bending = fallen(|_| ()).0;
    let (report, left_out) = fallen(|scene| {
        let bending = &mut material(scene).bending;
        (bending.stiffness, bending.damping) = (0.0, 0.0);
    });
    let links = [with_bending, report].map(|report| report.counters.link_forces / report.counters.substeps);
    assert_eq!(links[0] - links[1], 96, "the 3·4²·2 bending links are not evaluated");
    assert!(left_out.contains(&"bending links".to_owned()), "{left_out:?}");
    let (report, left_out) = fallen(|scene| {
        let springs = material(scene);
        springs.shear.damping = 0.0;
        springs.bending.damping = 0.0;
        springs.structural.damping = 0.0;
    });
    assert!(
        report.counters.link_forces > 0 && report.counters.damped_link_forces == 0,
        "no damping, no damped force: {report:?}"
    );
    assert!(left_out.contains(&"shear damping".to_owned()), "{left_out:?}");
}

/// A preset after a second of simulated time, nothing asleep.
fn after_a_second(name: &str, everything: bool, change: fn(&mut Scene)) -> (u64, StepReport) {
    let mut scene = (preset(name).expect("a preset of this name").build)();
    scene.settings.sleeping = false;
    change(&mut scene);
    let mut simulation = simulate::<f32>(&scene);
    if everything {
        simulation.plan_mut().work_out_everything();
    }
    let mut report = StepReport::default();
    (0..1000).for_each(|_| report.add(&simulation.step()));
    (simulation.hash(), report)
}

#[test]
fn what_is_left_out_of_whole_scenes_changes_no_bit() {
    for name in ["cube-on-plane", "cube-on-sphere", "incline", "incline-slide", "u-on-sphere", "tree", "coupler-7"] {
        let (lean, spared) = after_a_second(name, false, |_| ());
        let (full, done) = after_a_second(name, true, |_| ());
        assert_eq!(lean, full, "{name}: bit for bit");
        assert!(spared.counters.narrow_tests < done.counters.narrow_tests, "{name}: far particles are tested");
        assert!(
            spared.counters.cells_looked_at < done.counters.cells_looked_at,
            "{name}: cells are looked at in every substep"
        );
    }
}

/// No friction, no bending, no damping.
fn bare(scene: &mut Scene) {
    for obstacle in &mut scene.obstacles {
        (obstacle.friction_static, obstacle.friction_dynamic) = (0.0, 0.0);
    }
    let springs = material(scene);
    springs.bending.stiffness = 0.0;
    for family in [&mut springs.structural, &mut springs.shear, &mut springs.bending] {
        family.damping = 0.0;
    }
}

/// A bare scene with a ball further away than anything ever gets.
fn bare_with_a_ball(scene: &mut Scene) {
    bare(scene);
    scene.obstacles.push(ball([5e3, 5e3, 0.0], 1.0));
}

#[test]
fn friction_bending_damping_and_spheres_are_missed_by_no_bit() {
    for name in ["cube-on-plane", "incline", "tree"] {
        let (lean, spared) = after_a_second(name, false, bare);
        let (full, done) = after_a_second(name, true, bare_with_a_ball);
        assert_eq!(lean, full, "{name}: bit for bit");
        assert_eq!(
            (spared.counters.frictions, spared.counters.damped_link_forces),
            (0, 0),
            "{name}: nothing rubs, nothing is damped"
        );
        assert!(
            done.counters.frictions > 0
                && done.counters.damped_link_forces > 0
                && done.counters.sphere_tests > spared.counters.sphere_tests,
            "{name}"
        );
        assert!(spared.counters.link_forces < done.counters.link_forces, "{name}: no bending links");
        let (other, _) = after_a_second(name, true, |_| ());
        assert_ne!(other, full, "{name}: what does something is missed");
    }
}
