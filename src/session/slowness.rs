//! Why the simulation is slower than asked, in plain words: what was measured over the last second says whether it waits
//! for a processor, and where its own time goes.

use super::Session;
use super::clock::ClockInterval;
use super::step_words::step_text;
use crate::physics::{Scheme, Strain};

/// The simulation counts as slow below this share of the speed asked for.
pub const KEEPS_UP: f64 = 0.95;
/// Steps do not wait for drawing that takes less than this share of the processors.
const MIN_DRAWING_SHARE: f64 = 0.15;
/// Fewer iterations of the implicit integrator than this in a substep are not mentioned.
const MIN_MENTIONED_ITERATIONS: u64 = 20;
/// What is known of a simulation that is slower than asked.
#[derive(Clone, Debug)]
struct Facts<'a> {
    speed: f64,
    recent: ClockInterval,
    /// The share of the processors that drawing takes.
    drawing_share: f64,
    /// How many processors there are.
    processors: f64,
    halved: bool,
    /// Whether substeps reached the limit of their work.
    slowed: bool,
    contact: bool,
    links: usize,
    /// Iterations of the implicit integrator in the last substep.
    iterations: u64,
    /// The substeps that a step takes while links are far from their rest length.
    strained: Option<u64>,
    /// The same while points come near each other or an obstacle.
    in_contact: Option<u64>,
    /// What limits the step, and the length of the substeps that it is divided into, s.
    divided: Option<(&'a str, f64)>,
}

impl Session {
    /// Tells what share of the processors drawing takes, 0 to 1.
    pub fn note_drawing(&mut self, share: f64) {
        self.drawing_share = share;
    }

    /// Whether simulated time is owed for which there was no wall time.
    pub(super) fn is_behind(&self) -> bool {
        self.playing && self.clock.is_step_due(self.simulation.plan().dt_secs)
    }

    /// Why the speed asked for is not reached; empty when it is.
    pub(super) fn slowness(&self, links: usize) -> String {
        let plan = self.simulation.plan();
        let limit = plan.limits_at_work().limited_by(plan.dt_secs).words();
        let is_divided = plan.substeps > 1 && plan.scheme != Scheme::Implicit;
        let facts = Facts {
            speed: self.speed,
            recent: self.clock.recent(),
            drawing_share: self.drawing_share,
            processors: std::thread::available_parallelism().map_or(1.0, |count| count.get() as f64),
            halved: self.simulation.state().halvings > 0,
            slowed: self.report.counters.slowed > 0,
            contact: self.stage_sample.is_mostly_contact(),
            links,
            iterations: self.report.counters.iterations,
            strained: self.strained_substeps(),
            in_contact: self.substeps_in_contact(),
            divided: is_divided.then_some((limit.as_str(), plan.substep_secs())),
        };
        if self.playing { words(&facts) } else { String::new() }
    }

    /// The substeps in a step, if the planned ones are divided because a body is strained.
    fn strained_substeps(&self) -> Option<u64> {
        let (plan, parts) = (self.simulation.plan(), self.report.counters.substeps);
        let mut bodies = self.simulation.state().bodies.iter();
        let is_strained = bodies.any(|body| !body.asleep && body.strain > Strain::Small);
        (is_strained && parts > 1 && plan.scheme != Scheme::Implicit)
            .then(|| parts * u64::from(plan.max_substeps_in_step()))
    }

    /// The substeps in a step, if the last one was divided for contact of points.
    fn substeps_in_contact(&self) -> Option<u64> {
        let parts = self.report.counters.contact_parts;
        (parts > 1).then(|| parts * u64::from(self.simulation.plan().max_substeps_in_step()))
    }
}

fn words(facts: &Facts<'_>) -> String {
    let Facts {
        speed,
        recent,
        drawing_share,
        processors,
        halved,
        slowed,
        contact,
        links,
        iterations,
        strained,
        in_contact,
        divided,
    } = facts;
    let factor = recent.real_time_factor().unwrap_or(*speed);
    if factor >= KEEPS_UP * speed || factor <= 0.0 {
        return String::new();
    }
    // The speed if a processor had always been at work on the steps.
    let alone = recent.simulated_secs / recent.processor_secs.max(1e-9);
    // While steps wait, no processor is idle: other programs have what neither drawing nor the steps take.
    let others = 1.0 - drawing_share - recent.processor_secs / recent.wall_secs / processors;
    let cause = if alone >= *speed {
        if *drawing_share >= MIN_DRAWING_SHARE.max(others) {
            format!("drawing takes {:.0} % of the processors", drawing_share * 100.0)
        } else {
            "other programs take the processors".to_owned()
        }
    } else if *slowed {
        "the motion is too violent for the implicit integrator, whose steps are slowed where enough work went into one"
            .to_owned()
    } else if *halved {
        "the motion is too violent for the implicit integrator's steps, which are halved again and again".to_owned()
    } else if *contact {
        "contact takes more time than the links".to_owned()
    } else if let Some(substeps) = strained {
        format!("strained links take {substeps} substeps a step")
    } else if let Some(substeps) = in_contact {
        format!("bodies that touch take {} substeps a step", two_digits(*substeps))
    } else if let Some((limit, secs)) = divided {
        format!("{limit} takes substeps of {}", step_text(*secs))
    } else if *iterations >= MIN_MENTIONED_ITERATIONS {
        format!("the stiff links take about {} iterations a substep", two_digits(*iterations))
    } else {
        format!("limited by the number of links, {links}")
    };
    let pace = if (speed - 1.0).abs() < 1e-9 { "real time" } else { "the speed asked for" };
    let slower = speed / factor;
    let digits = usize::from(slower < 10.0);
    format!("{slower:.digits$} times slower than {pace}: {cause}")
}

/// Rounds a number to its first two digits: the others flicker.
fn two_digits(count: u64) -> u64 {
    let unit = 10_u64.pow(count.checked_ilog10().map_or(0, |digits| digits.saturating_sub(1)));
    (count + unit / 2) / unit * unit
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::scene::presets;

    /// A second in which `processor_secs` of work simulated `simulated_secs`.
    fn facts(simulated_secs: f64, processor_secs: f64) -> Facts<'static> {
        let recent = ClockInterval { wall_secs: 1.0, simulated_secs, stepping_secs: 0.9, processor_secs };
        Facts {
            speed: 1.0,
            recent,
            drawing_share: 0.5,
            processors: 2.0,
            halved: false,
            slowed: false,
            contact: false,
            links: 12_876,
            iterations: 0,
            strained: None,
            in_contact: None,
            divided: None,
        }
    }

    #[test]
    fn steps_that_wait_for_a_processor_blame_who_has_it() {
        let waiting = facts(0.5, 0.3);
        assert_eq!(words(&waiting), "2.0 times slower than real time: drawing takes 50 % of the processors");
        for drawing_share in [0.02, 0.2] {
            let elsewhere = words(&Facts { drawing_share, ..waiting.clone() });
            assert_eq!(
                elsewhere, "2.0 times slower than real time: other programs take the processors",
                "{drawing_share}"
            );
        }
    }

    #[test]
    fn steps_that_have_a_processor_blame_their_own_work() {
        let busy = facts(0.5, 0.9);
        assert_eq!(words(&busy), "2.0 times slower than real time: limited by the number of links, 12876");
        assert!(words(&facts(0.0005, 0.9)).starts_with("2000 times slower"), "{}", words(&facts(0.0005, 0.9)));
        let divided = Facts { divided: Some(("shear damping", 5e-4)), ..busy.clone() };
        let divided = words(&divided);
        assert!(divided.ends_with("shear damping takes substeps of 0.500 ms"), "{divided}");
        let strained = words(&Facts { strained: Some(18), divided: Some(("shear damping", 5e-4)), ..busy.clone() });
        assert!(strained.ends_with("strained links take 18 substeps a step"));
        let touching = words(&Facts { in_contact: Some(2796), ..busy.clone() });
        assert!(touching.ends_with("bodies that touch take 2800 substeps a step"), "{touching}");
        let stiff = words(&Facts { iterations: 1_249, ..busy.clone() });
        assert!(stiff.ends_with("about 1200 iterations a substep"), "{stiff}");
        let soft = words(&Facts { iterations: MIN_MENTIONED_ITERATIONS - 1, ..busy.clone() });
        assert!(soft.ends_with("limited by the number of links, 12876"), "{soft}");
        let contact = words(&Facts { contact: true, ..busy.clone() });
        assert!(contact.ends_with("contact takes more time than the links"), "{contact}");
        let slowed = words(&Facts { slowed: true, ..busy.clone() });
        assert!(slowed.contains("slowed where enough work"), "{slowed}");
        let halved = words(&Facts { halved: true, ..busy });
        assert!(halved.contains("too violent"), "{halved}");
    }

    #[test]
    fn counts_are_told_to_two_digits() {
        assert_eq!([0, 7, 42, 999, 1_249, 100_000].map(two_digits), [0, 7, 42, 1_000, 1_200, 100_000]);
    }

    #[test]
    fn what_keeps_up_says_nothing() {
        assert_eq!(words(&facts(0.97, 0.9)), "", "close enough");
        assert_eq!(
            words(&Facts { recent: ClockInterval::default(), ..facts(0.0, 0.0) }),
            "",
            "nothing was measured yet"
        );
        let slow_motion = Facts { speed: 0.1, ..facts(0.1, 0.9) };
        assert_eq!(words(&slow_motion), "", "as slow as asked");
    }

    #[test]
    fn a_torn_body_takes_more_substeps_than_are_planned_and_one_at_rest_does_not() {
        let scene = (presets::preset("cube-on-plane").expect("a preset").build)();
        let mut session = Session::new(scene, PathBuf::new(), String::new()).expect("it resolves");
        session.step();
        assert_eq!(session.strained_substeps(), None, "it falls as it is");
        let mut state = session.simulation().state().clone();
        // Its links line up.
        state.position.iter_mut().step_by(2).for_each(|at| at.y += 10.0);
        session.replace_state(state);
        // In the second they move.
        (0..2).for_each(|_| assert!(session.step(), "it goes on"));
        let (planned, taken) = (session.simulation().plan().max_substeps_in_step(), session.strained_substeps());
        assert!(taken.is_some_and(|taken| taken > u64::from(planned)), "{taken:?} of {planned} planned");
    }
}
