//! The report of a step, and the trait of what times its stages or stops it.

use std::cell::Cell;

use crate::physics::model::plan::{SOLVE_WORK, Stage};

/// The report of one or more substeps. Plain numbers; the step never logs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepReport {
    /// Sums over the substeps.
    pub counters: Counters,
    /// What held at the end of the last one that was taken.
    pub last: LastSubstep,
    /// Whether the substep was given up, state untouched, because the timer stopped it.
    pub stopped: bool,
    /// Whether the step was abandoned, state untouched, because a number would have stopped being finite or, in
    /// manual stepping, a body would have been torn apart.
    pub diverged: bool,
}

/// Sums over substeps, and the extremes among them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Counters {
    /// Substeps taken, and parts of substeps that were halved.
    pub substeps: u64,
    /// The shortest of them, s; none where none was taken.
    pub shortest_secs: Option<f64>,
    /// Deepest penetration at the end of any of them, m.
    pub peak_penetration_m: f64,
    /// Tests made of particles against obstacles, and against cells of other bodies.
    pub narrow_tests: u64,
    /// Such tests that bounding boxes made unnecessary.
    pub narrow_tests_saved: u64,
    /// Points of bodies that came near cells of another body, or of their own, and were tested for being inside.
    pub points_looked_for: u64,
    /// Contacts between bodies that were solved for.
    pub body_contacts: u64,
    /// Of the particle–obstacle tests, the ones against spheres.
    pub sphere_tests: u64,
    /// Contacts with obstacles for which friction was computed.
    pub frictions: u64,
    /// Link forces evaluated.
    pub link_forces: u64,
    /// Of these, those with damping.
    pub damped_link_forces: u64,
    /// Cells tested for being near inversion.
    pub cells_looked_at: u64,
    /// Watched cells whose push against inversion was computed.
    pub recovery_cells: u64,
    /// Linear systems that the implicit integrator solved.
    pub solves: u64,
    /// Iterations of the implicit integrator's solver.
    pub iterations: u64,
    /// Links that these iterations passed over: each those of the bodies that it solves for.
    pub iterated_links: u64,
    /// Parts of substeps that were divided because points of bodies came near each other or an obstacle.
    pub contact_parts: u64,
    /// Substeps of the implicit integrator, or parts of one, that would have given energy and were halved.
    pub halved: u64,
    /// Substeps of the implicit integrator that reached their work limit and were finished in long parts, with bodies slowed
    /// where these parts would have given energy.
    pub slowed: u64,
    /// Work of modal bodies: modes advanced, boxes and points looked at.
    pub modal_work: u64,
    /// Work done by moving obstacles, J.
    pub obstacle_work_j: f64,
    /// The same without the contacts that took energy, J: no body can have got more of it.
    pub obstacle_gain_j: f64,
    /// Work done to part bodies that were inside each other without having pressed a contact spring, J.
    pub parting_work_j: f64,
    /// The largest speed of an obstacle's surface that a particle met, m/s.
    pub fastest_surface_m_s: f64,
}

/// What holds at the end of a substep; of several substeps, at the end of the last.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LastSubstep {
    /// Contacts with obstacles that push.
    pub contacts: usize,
    /// Contacts between bodies that push.
    pub body_contacts: usize,
    /// Deepest penetration, m.
    pub max_penetration_m: f64,
    /// Bodies that sleep.
    pub bodies_asleep: usize,
}

impl Counters {
    /// The work of the implicit integrator, in iterations.
    pub fn implicit_work(&self) -> u64 {
        self.iterations + SOLVE_WORK * self.solves
    }

    /// Work of obstacles, the part of it that they gave, and the work of parting, J.
    pub(in crate::physics) fn energy_from_outside(&self) -> [f64; 3] {
        [self.obstacle_work_j, self.obstacle_gain_j, self.parting_work_j]
    }

    /// Takes back what was counted of a motion that is refused.
    pub(in crate::physics) fn set_energy_from_outside(&mut self, energy: [f64; 3]) {
        [self.obstacle_work_j, self.obstacle_gain_j, self.parting_work_j] = energy;
    }

    /// Counts the work (J) of an obstacle in a contact with its surface, which moves at `speed` (m/s).
    pub(in crate::physics) fn add_obstacle_work(&mut self, work: f64, speed: f64) {
        self.obstacle_work_j += work;
        self.obstacle_gain_j += work.max(0.0);
        self.fastest_surface_m_s = self.fastest_surface_m_s.max(speed);
    }

    /// Adds what another stretch of substeps counted.
    pub fn add(&mut self, other: &Self) {
        self.substeps += other.substeps;
        self.shortest_secs = match (self.shortest_secs, other.shortest_secs) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        };
        self.peak_penetration_m = self.peak_penetration_m.max(other.peak_penetration_m);
        self.narrow_tests += other.narrow_tests;
        self.narrow_tests_saved += other.narrow_tests_saved;
        self.points_looked_for += other.points_looked_for;
        self.body_contacts += other.body_contacts;
        self.sphere_tests += other.sphere_tests;
        self.frictions += other.frictions;
        self.link_forces += other.link_forces;
        self.damped_link_forces += other.damped_link_forces;
        self.cells_looked_at += other.cells_looked_at;
        self.recovery_cells += other.recovery_cells;
        self.solves += other.solves;
        self.iterations += other.iterations;
        self.iterated_links += other.iterated_links;
        self.contact_parts += other.contact_parts;
        self.halved += other.halved;
        self.slowed += other.slowed;
        self.modal_work += other.modal_work;
        self.obstacle_work_j += other.obstacle_work_j;
        self.obstacle_gain_j += other.obstacle_gain_j;
        self.parting_work_j += other.parting_work_j;
        self.fastest_surface_m_s = self.fastest_surface_m_s.max(other.fastest_surface_m_s);
    }
}

impl StepReport {
    /// Adds what a later stretch of substeps reports.
    pub fn add(&mut self, later: &Self) {
        self.counters.add(&later.counters);
        self.last = later.last;
        self.stopped |= later.stopped;
        self.diverged |= later.diverged;
    }
}

/// Learns when each stage begins, and may stop a substep; the core itself reads no clock.
pub trait StageTimer {
    /// A stage begins and the one before it ends.
    fn enter(&mut self, stage: Stage);
    /// The last stage of a substep ends.
    fn leave(&mut self);
    /// Contact between bodies begins; it enters the same stages as contact with obstacles.
    fn begin_bodies(&mut self) {}
    /// Contact between bodies ends.
    fn end_bodies(&mut self) {}
    /// Whether to give the substep up. Called at least once in every pass over a body's links, in every iteration of the
    /// implicit integrator, whose substeps can take seconds, and, in a large body, once for some ten thousand links of a
    /// thread. A substep that was given up is taken again later, to the same bits.
    fn stops(&self) -> bool {
        false
    }
}

/// Takes no time.
impl StageTimer for () {
    fn enter(&mut self, _: Stage) {}
    fn leave(&mut self) {}
}

/// Collects a substep's counts and passes its stages on to the timer.
pub(super) struct Recorder<'a> {
    pub(super) counters: Counters,
    pub(super) last: LastSubstep,
    timer: &'a mut dyn StageTimer,
    /// The deepest penetration between bodies at the end of the part, m.
    depth_between_bodies_m: f64,
    may_be_given_up: bool,
    stopped: Cell<bool>,
}

impl<'a> Recorder<'a> {
    /// The recorder of a substep that has not begun.
    pub(super) fn new(timer: &'a mut dyn StageTimer) -> Self {
        let (counters, last) = (Counters::default(), LastSubstep::default());
        Self { counters, last, timer, depth_between_bodies_m: 0.0, may_be_given_up: true, stopped: Cell::new(false) }
    }

    /// Notes that a part of `secs` (s) was taken, after which `bodies_asleep` bodies sleep. The substep cannot be given up
    /// from now on.
    pub(super) fn note_part(&mut self, secs: f64, bodies_asleep: usize) {
        self.forbid_stop();
        self.counters.substeps += 1;
        self.counters.shortest_secs = Some(self.counters.shortest_secs.map_or(secs, |shortest| shortest.min(secs)));
        self.last.bodies_asleep = bodies_asleep;
    }

    /// The substep cannot be given up from now on: the state has changed.
    pub(super) fn forbid_stop(&mut self) {
        self.may_be_given_up = false;
    }

    /// A stage begins and the one before it ends.
    pub(super) fn enter(&mut self, stage: Stage) {
        self.timer.enter(stage);
    }

    /// Contact between bodies begins.
    pub(super) fn begin_bodies(&mut self) {
        self.timer.begin_bodies();
    }

    /// Contact between bodies ends.
    pub(super) fn end_bodies(&mut self) {
        self.timer.end_bodies();
    }

    /// Whether the substep is to be given up; once true, it stays true.
    pub(super) fn stops(&self) -> bool {
        if self.may_be_given_up && !self.stopped.get() {
            self.stopped.set(self.timer.stops());
        }
        self.stopped.get()
    }

    /// The last answer of [`Self::stops`].
    pub(super) fn has_stopped(&self) -> bool {
        self.stopped.get()
    }

    /// Notes the deepest penetration between bodies at the end of a part, m. Called before [`Self::note_depth`].
    pub(super) fn note_depth_between_bodies(&mut self, depth_m: f64) {
        self.depth_between_bodies_m = depth_m;
        self.note_depth(depth_m);
    }

    /// Notes the deepest penetration at the end of a part, m.
    pub(super) fn note_depth(&mut self, depth_m: f64) {
        let depth_m = depth_m.max(self.depth_between_bodies_m);
        self.last.max_penetration_m = depth_m;
        self.counters.peak_penetration_m = self.counters.peak_penetration_m.max(depth_m);
    }

    /// Ends the last stage and returns the report.
    pub(super) fn leave(self, diverged: bool) -> StepReport {
        self.timer.leave();
        let Self { counters, last, stopped, .. } = self;
        StepReport { counters, last, stopped: stopped.into_inner(), diverged }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_add_up_and_what_holds_now_is_the_last() {
        let of = |substeps, secs, depth, contacts| StepReport {
            counters: Counters {
                substeps,
                shortest_secs: Some(secs),
                peak_penetration_m: depth,
                ..Counters::default()
            },
            last: LastSubstep { contacts, max_penetration_m: depth, bodies_asleep: contacts, ..LastSubstep::default() },
            ..StepReport::default()
        };
        let mut report = StepReport::default();
        report.add(&of(2, 1e-3, 0.3, 5));
        report.add(&of(4, 5e-4, 0.1, 3));
        report.add(&of(1, 1e-3, 0.2, 1));
        assert_eq!((report.counters.substeps, report.counters.shortest_secs), (7, Some(5e-4)));
        assert_eq!((report.counters.peak_penetration_m, report.last), (0.3, of(1, 1e-3, 0.2, 1).last));
    }

    #[test]
    fn what_must_be_finished_is_not_asked() {
        struct Never;
        impl StageTimer for Never {
            fn enter(&mut self, _: Stage) {}
            fn leave(&mut self) {}
            fn stops(&self) -> bool {
                true
            }
        }
        assert!(Recorder::new(&mut Never).stops());
        let mut never = Never;
        let mut recorder = Recorder::new(&mut never);
        recorder.note_part(1e-3, 0);
        assert!(!recorder.stops(), "a part of it was taken");
    }
}
