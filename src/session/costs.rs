//! Where the time of the steps goes, measured only while someone looks. Measuring reads clocks and changes no motion.

use std::time::{Duration, Instant};

use crate::physics::Stage;
use crate::physics::{Plan, Simulation, StepReport};
use crate::report::timer::WallTimer;

/// The measurement that is shown is replaced this often.
const REFRESH_INTERVAL: Duration = Duration::from_millis(500);

/// The recent cost of a step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StepCost {
    /// The stages that the scene needs, in their order.
    pub stages: Vec<StageCost>,
    /// The events in a whole step, on average.
    pub counts: Vec<(&'static str, f64)>,
    /// The parts of a step that the scene does not need, and why.
    pub left_out: Vec<(String, &'static str)>,
}

/// One stage of a step.
#[derive(Clone, Debug, PartialEq)]
pub struct StageCost {
    /// Its name.
    pub name: &'static str,
    /// Wall time in a whole step, s.
    pub secs: f64,
    /// The share of all stages, 0 to 1.
    pub share: f64,
}

/// Measures steps, and keeps the last measurement.
#[derive(Debug)]
pub(super) struct Costs {
    since: Instant,
    /// The simulated time at that instant, s.
    since_secs: f64,
    timer: WallTimer,
    report: StepReport,
    shown: StepCost,
}

impl Costs {
    /// Begins to measure.
    pub(super) fn new(simulation: &Simulation) -> Self {
        let shown = StepCost { left_out: simulation.plan().left_out(), ..StepCost::default() };
        let since_secs = simulation.state().time_secs;
        Self { since: Instant::now(), since_secs, timer: WallTimer::default(), report: StepReport::default(), shown }
    }

    /// Returns the timer that takes the time of the stages.
    pub(super) fn timer(&mut self) -> &mut WallTimer {
        &mut self.timer
    }

    /// Notes a substep that was taken.
    pub(super) fn note(&mut self, report: &StepReport, simulation: &Simulation) {
        self.report.add(report);
        if self.since.elapsed() >= REFRESH_INTERVAL {
            let (plan, now_secs) = (simulation.plan(), simulation.state().time_secs);
            self.shown = step_cost(&self.timer, &self.report, (now_secs - self.since_secs) / plan.dt_secs, plan);
            (self.since, self.since_secs) = (Instant::now(), now_secs);
            self.timer = WallTimer::default();
            self.report = StepReport::default();
        }
    }

    /// Returns the last measurement.
    pub(super) fn shown(&self, plan: &Plan) -> StepCost {
        StepCost { left_out: plan.left_out(), ..self.shown.clone() }
    }
}

fn step_cost(timer: &WallTimer, report: &StepReport, steps: f64, plan: &Plan) -> StepCost {
    if steps <= 0.0 {
        return StepCost::default();
    }
    let secs = |stage| timer.spent(stage).0.as_secs_f64() / steps;
    let total: f64 = Stage::ALL.into_iter().map(secs).sum();
    let stages = Stage::ALL.into_iter().filter(|&stage| plan.runs(stage)).map(|stage| StageCost {
        name: stage.name(),
        secs: secs(stage),
        share: if total > 0.0 { secs(stage) / total } else { 0.0 },
    });
    let count = |name, count: u64| (name, count as f64 / steps);
    StepCost {
        stages: stages.collect(),
        counts: vec![
            count("substeps", report.counters.substeps),
            count("link forces", report.counters.link_forces),
            count("of them damped", report.counters.damped_link_forces),
            count("contact tests", report.counters.narrow_tests),
            count("tests saved by boxes", report.counters.narrow_tests_saved),
            count("cells looked at", report.counters.cells_looked_at),
            count("cells pushed back", report.counters.recovery_cells),
            count("implicit solves", report.counters.solves),
            count("iterations of these", report.counters.iterations),
            count("halvings", report.counters.halved),
            count("substeps slowed", report.counters.slowed),
        ],
        left_out: plan.left_out(),
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use crate::physics::Stage;
    use crate::scene::presets::preset;
    use crate::session::{Command, Session};

    fn session(name: &str) -> Session {
        let preset = preset(name).expect("a preset of this name");
        Session::new((preset.build)(), PathBuf::new(), name.to_owned()).expect("a preset is sound")
    }

    #[test]
    fn cost_is_measured_only_while_someone_looks_and_changes_no_motion() {
        let (mut watched, mut other) = (session("tree"), session("tree"));
        assert!(watched.status().cost.is_none(), "nobody looks");
        watched.handle(Command::WatchCost(true)).expect("anyone may look");
        for _ in 0..20 {
            assert!(watched.step() && other.step(), "a preset is stable");
        }
        std::thread::sleep(super::REFRESH_INTERVAL);
        watched.step();
        other.step();
        let cost = watched.status().cost.expect("someone looks");
        let links = cost.stages.iter().find(|stage| stage.name == Stage::Links.name()).expect("it has links");
        assert!(links.secs > 0.0 && links.share > 0.2, "links take most of the time: {cost:?}");
        let share: f64 = cost.stages.iter().map(|stage| stage.share).sum();
        assert!((share - 1.0).abs() < 1e-9, "the shares make up the whole: {share}");
        assert!(cost.left_out.iter().any(|(what, _)| what == "sphere contact"), "it has no sphere: {cost:?}");
        assert_eq!(watched.simulation().hash(), other.simulation().hash(), "the same motion");
        watched.handle(Command::WatchCost(false)).expect("anyone may look away");
        assert!(watched.status().cost.is_none(), "nobody looks");
    }
}
