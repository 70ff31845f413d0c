//! What a step tells about itself, and who may take its time.

use super::plan::{SOLVE_WORK, Stage};

/// What happened in one or more substeps. Plain numbers; the step never logs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepReport {
    /// Substeps taken.
    pub substeps: u64,
    /// Contacts in the last substep.
    pub contacts: usize,
    /// Deepest penetration at the end of the last substep, m.
    pub max_penetration_m: f64,
    /// Deepest penetration at the end of any substep, m.
    pub peak_penetration_m: f64,
    /// Particle–obstacle tests made.
    pub narrow_tests: u64,
    /// Particle–obstacle tests that boxes made unnecessary.
    pub narrow_tests_saved: u64,
    /// Link forces evaluated.
    pub link_forces: u64,
    /// Substeps of the implicit integrator, or parts of one, that would have given energy and were halved.
    pub halved: u64,
    /// Substeps of the implicit integrator that reached the limit of their work, and were finished in long parts, slowed
    /// where those would have given energy.
    pub slowed: u64,
    /// Linear systems that the implicit integrator solved.
    pub solves: u64,
    /// Iterations of the implicit integrator's solver.
    pub iterations: u64,
    /// Of these, the ones with a damping to work out.
    pub damped_link_forces: u64,
    /// Of the particle–obstacle tests, the ones against spheres.
    pub sphere_tests: u64,
    /// Pushes of an obstacle for which friction was worked out.
    pub frictions: u64,
    /// Cells looked at for being near inversion.
    pub cells_looked_at: u64,
    /// Watched cells whose push against inversion was worked out.
    pub recovery_cells: u64,
    /// Work that moving obstacles did, J.
    pub obstacle_work_j: f64,
    /// Bodies that sleep after the last substep.
    pub bodies_asleep: usize,
    /// Whether the substep was given up, state untouched, because nobody waits for it any more.
    pub stopped: bool,
    /// Whether the step was abandoned, state untouched, because a number would have stopped being finite or, in
    /// manual stepping, a body would have been torn apart.
    pub diverged: bool,
}

impl StepReport {
    /// The work of the implicit integrator, in iterations.
    pub fn implicit_work(&self) -> u64 {
        self.iterations + SOLVE_WORK * self.solves
    }

    /// Adds what a later stretch of substeps reports.
    pub fn add(&mut self, later: &Self) {
        self.substeps += later.substeps;
        self.contacts = later.contacts;
        self.max_penetration_m = later.max_penetration_m;
        self.peak_penetration_m = self.peak_penetration_m.max(later.peak_penetration_m);
        self.narrow_tests += later.narrow_tests;
        self.narrow_tests_saved += later.narrow_tests_saved;
        self.link_forces += later.link_forces;
        self.halved += later.halved;
        self.slowed += later.slowed;
        self.solves += later.solves;
        self.iterations += later.iterations;
        self.damped_link_forces += later.damped_link_forces;
        self.sphere_tests += later.sphere_tests;
        self.frictions += later.frictions;
        self.cells_looked_at += later.cells_looked_at;
        self.recovery_cells += later.recovery_cells;
        self.obstacle_work_j += later.obstacle_work_j;
        self.bodies_asleep = later.bodies_asleep;
        self.stopped |= later.stopped;
        self.diverged |= later.diverged;
    }
}

/// Told when a stage begins, and asked whether to go on; the core itself reads no clock.
pub trait StageTimer {
    /// A stage begins and the one before it ends.
    fn enter(&mut self, stage: Stage);
    /// The last stage of a substep ends.
    fn leave(&mut self);
    /// Whether the substep is to be given up: asked in every iteration of the implicit integrator, whose substeps can
    /// take seconds. What was given up is taken anew later, to the same bits.
    fn stops(&self) -> bool {
        false
    }
}

/// Takes no time.
impl StageTimer for () {
    fn enter(&mut self, _: Stage) {}
    fn leave(&mut self) {}
}
