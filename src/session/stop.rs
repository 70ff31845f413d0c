//! Stops a substep that takes long, and warns before time runs that it would take forever.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use cpu_time::ThreadTime;

use super::Session;
use super::predict::{MIN_REAL_TIME_FACTOR, slow_run_warning};
use crate::physics::Simulation;
use crate::physics::Stage;
use crate::physics::StageTimer;

/// The most processor time spent on finding out whether a scene is too slow to watch.
const MAX_CHECK_TIME: Duration = Duration::from_secs(1);

/// Gives a substep up when it has taken too long or someone waits.
struct TimeLimit<'a> {
    since: ThreadTime,
    stop: &'a AtomicBool,
}

impl StageTimer for TimeLimit<'_> {
    fn enter(&mut self, _: Stage) {}
    fn leave(&mut self) {}
    fn stops(&self) -> bool {
        self.since.elapsed() >= MAX_CHECK_TIME || self.stop.load(Ordering::Relaxed)
    }
}

impl Session {
    /// Stops time, with the reason, where it would run slower than anyone can watch. If someone interrupts the measurement,
    /// it is repeated before time goes on.
    pub fn pause_if_too_slow(&mut self) {
        if self.awaited_modes().is_some() {
            // Until the modes are found, bodies move by their cells.
            self.may_be_too_slow = true;
            return;
        }
        self.too_slow_reason = slow_scene_warning(&self.simulation, &self.stop).unwrap_or_default();
        self.playing &= self.too_slow_reason.is_empty();
        self.may_be_too_slow = self.stop.load(Ordering::Relaxed);
    }
}

/// Returns the warning before time runs, if it is certain within [`MAX_CHECK_TIME`]. Measures on a copy.
fn slow_scene_warning(simulation: &Simulation<f32>, stop: &AtomicBool) -> Option<String> {
    let mut copy = simulation.clone();
    let start_secs = copy.state().time_secs;
    let mut limit = TimeLimit { since: ThreadTime::now(), stop };
    loop {
        let report = copy.substep(&mut limit);
        if stop.load(Ordering::Relaxed) {
            return None;
        }
        let elapsed_secs = limit.since.elapsed().as_secs_f64();
        let simulated_secs = copy.state().time_secs - start_secs;
        let fast_enough = simulated_secs >= MIN_REAL_TIME_FACTOR * MAX_CHECK_TIME.as_secs_f64();
        if report.diverged || fast_enough {
            return None;
        }
        if report.stopped || limit.stops() {
            // The substep that was given up counts as taken, so that the speed is not underestimated.
            let begun_secs = if report.stopped { copy.plan().substep_secs() } else { 0.0 };
            let words = slow_run_warning((simulated_secs + begun_secs) / elapsed_secs)?;
            return Some(format!("{words}; time stands still until you press Play"));
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

    use super::*;
    use crate::physics::StepReport;
    use crate::scene::body::CubeShape;
    use crate::scene::edit::{BodyId, Edit};
    use crate::scene::settings::Integrator;
    use crate::scene::{Body, Scene, Shape, presets};
    use crate::session::Command;

    /// A stiff cube that falls on the ground: the implicit integrator has taken over.
    const STIFF: &str = "(version: 1, bodies: [(shape: cube(cells: 6), pose: (position: (0, 0.6, 0)), \
                         material: solid(young_modulus: 1e8))], obstacles: [(plane: ())])";

    /// A cube in steps so short that nobody can wait for a second of its motion.
    const SLOW: &str = "(version: 1, settings: (dt: 1e-6, stepping: manual), bodies: [(shape: cube(cells: 60))])";

    fn session(text: &str) -> Session {
        let scene = Scene::from_ron(text, "a.ron").expect("a scene");
        Session::new(scene, PathBuf::new(), String::new()).expect("it resolves")
    }

    /// Stops a substep at one of the looks, or never.
    struct At {
        looks: AtomicU64,
        at: u64,
    }

    impl StageTimer for At {
        fn enter(&mut self, _: Stage) {}
        fn leave(&mut self) {}
        fn stops(&self) -> bool {
            self.looks.fetch_add(1, Ordering::Relaxed) == self.at
        }
    }

    fn substep(session: &mut Session, at: u64) -> (StepReport, u64) {
        let mut timer = At { looks: AtomicU64::new(0), at };
        let report = session.simulation.substep(&mut timer);
        (report, timer.looks.into_inner())
    }

    #[test]
    fn a_large_body_is_asked_within_its_passes_whatever_the_scheme() {
        for integrator in Integrator::ALL {
            let mut scene =
                Scene::from_ron("(version: 1, bodies: [(shape: cube(cells: 24))])", "a.ron").expect("a scene");
            (scene.settings.integrator, scene.settings.allow_implicit) = (integrator, false);
            let mut session = Session::new(scene, PathBuf::new(), String::new()).expect("it resolves");
            let before = session.simulation.state().clone();
            let links = session.simulation.model().link_counts().into_iter().sum::<usize>() as u64;
            let mut whole = session.simulation.clone();
            let mut timer = At { looks: AtomicU64::new(0), at: u64::MAX };
            whole.substep(&mut timer);
            let looks = timer.looks.into_inner();
            assert!(looks >= links / 65_536, "{}: {looks} looks over {links} links", integrator.name());
            for at in 0..looks {
                assert!(substep(&mut session, at).0.stopped, "{}: look {at}", integrator.name());
                assert!(*session.simulation.state() == before, "{}: nothing has happened", integrator.name());
            }
            substep(&mut session, u64::MAX);
            assert!(session.simulation.state() == whole.state(), "{}: the same bits", integrator.name());
        }
    }

    #[test]
    fn a_substep_is_asked_in_every_iteration_and_one_that_is_given_up_leaves_no_trace() {
        let [mut stopped, mut straight] = [session(STIFF), session(STIFF)];
        let mut given_up = 0;
        for count in 0..480 {
            let before = stopped.simulation.state().clone();
            let (report, _) = substep(&mut stopped, count % 23);
            if report.stopped {
                given_up += 1;
                assert!(*stopped.simulation.state() == before, "nothing has happened in substep {count}");
                substep(&mut stopped, u64::MAX);
            }
            let (report, looks) = substep(&mut straight, u64::MAX);
            assert!(looks >= report.counters.iterations, "{looks} looks in {} iterations", report.counters.iterations);
            assert!(*stopped.simulation.state() == *straight.simulation.state(), "the same bits after substep {count}");
        }
        assert!(given_up > 20, "some were given up: {given_up}");
        assert!(straight.simulation.state().position.iter().any(|at| at.y < 0.2), "it has landed");
    }

    #[test]
    fn a_stop_ends_an_advance_and_time_goes_on_once_it_is_taken_back() {
        let mut session = session(STIFF);
        let stop = Arc::new(AtomicBool::new(true));
        session.set_stop(Arc::clone(&stop));
        session.advance(Duration::from_millis(40), Duration::from_millis(200));
        assert!(session.simulation.state().time_secs <= 0.0, "no substep has ended");
        stop.store(false, Ordering::Relaxed);
        session.advance(Duration::from_millis(40), Duration::from_secs(20));
        assert!(session.simulation.state().time_secs > 0.0, "it goes on");
    }

    #[test]
    fn who_stops_the_look_at_a_slow_scene_does_not_wait_for_it_and_is_told_later() {
        let mut slow = session(SLOW);
        let stop = Arc::new(AtomicBool::new(true));
        slow.set_stop(Arc::clone(&stop));
        let before = ThreadTime::now();
        slow.pause_if_too_slow();
        assert!(before.elapsed() < MAX_CHECK_TIME / 5, "after {:?}", before.elapsed());
        assert!(slow.is_playing(), "it is not known yet");
        stop.store(false, Ordering::Relaxed);
        slow.advance(Duration::from_millis(1), Duration::from_millis(1));
        assert!(!slow.is_playing() && slow.status().message.contains("slower than a thousandth"), "now it is");
        slow.handle(Command::Play).expect("always possible");
        slow.advance(Duration::from_millis(1), Duration::from_millis(1));
        assert!(slow.is_playing(), "as asked for");
    }

    #[test]
    fn a_body_that_becomes_too_large_to_watch_waits_for_play() {
        let mut session = session(&SLOW.replace("cells: 60", "cells: 2"));
        let edit = |session: &mut Session, cells| {
            let shape = Shape::Cube(CubeShape { cells, size: 1.0 });
            let body = Body { shape, ..session.scene().bodies[0].clone() };
            session.handle(Command::Edit(Edit::Body(BodyId(0), Box::new(body)))).expect("it can be made");
            session.advance(Duration::from_millis(1), Duration::from_millis(1));
            session.is_playing()
        };
        assert!(edit(&mut session, 3), "a little larger");
        assert!(!edit(&mut session, 60), "much larger");
        assert!(session.status().message.contains("slower than a thousandth"), "{}", session.status().message);
    }

    #[test]
    fn a_scene_that_nobody_can_watch_waits_for_play() {
        let mut slow = session(SLOW);
        slow.pause_if_too_slow();
        let status = slow.status();
        assert!(!status.playing && status.message.contains("slower than a thousandth"), "{}", status.message);
        slow.handle(Command::Play).expect("always possible");
        assert!(slow.status().playing && !slow.status().message.contains("thousandth"), "as asked for");
        for preset in presets::presets() {
            let mut session = Session::new((preset.build)(), PathBuf::new(), String::new()).expect("it resolves");
            session.pause_if_too_slow();
            assert!(session.is_playing(), "{}", preset.name);
        }
    }
}
