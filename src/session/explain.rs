//! Explains why a simulation broke: which value was too large for which other one.

use std::sync::Arc;
use std::time::Instant;

use super::cures::{Cure, Exploded, inversion_recovery_cure};
use super::step_words::{limit_text, step_text};
use super::trials::Trials;
use super::{Session, Trouble};
use crate::extract;
use crate::math::Vector;
use crate::physics::{Scheme, Term};
use crate::scene::settings::Integrator;
use crate::scene::{Body, Family, Material, Springs};
use crate::view::legend::three_digits;

/// What an explosion is called.
const EXPLOSION_TITLE: &str = "It exploded";

/// What was done about it.
const STOPPED_WORDS: &str = "The simulation exploded and was stopped at its last good state";

/// Simulated time after which a cure that did not help a broken body is tried again, s.
const RETRY_SECS: f64 = 1.0;

impl Session {
    /// Explains cells that are turned inside out where nothing turns them back (GC §10, Fig 24).
    pub(super) fn explain_inversion(&self) -> Option<Trouble> {
        let broken = self.inverted_cells;
        if broken == 0 {
            return None;
        }
        let cells: usize = self.simulation.model().bodies.iter().map(|body| body.lattice.cells.len()).sum();
        let words = format!(
            "{broken} of {cells} cells are turned inside out. Their springs are as long as they want to be, so nothing \
             turns them back: a spring knows lengths, not left from right."
        );
        Some(self.trouble_with_cures("It broke", words))
    }

    /// Builds what a person is shown, with the cures found so far.
    fn trouble_with_cures(&self, title: &str, words: String) -> Trouble {
        Trouble {
            title: title.to_owned(),
            words,
            stopped: self.simulation.has_diverged(),
            cures: self.trials.as_ref().map(|trials| trials.helpful_cures().to_vec()).unwrap_or_default(),
            looking: self.trials.as_ref().is_some_and(|trials| !trials.are_over()),
            guilty_links: Arc::default(),
        }
    }

    /// Looks for cells that are turned inside out, where nothing turns them back.
    pub(super) fn find_inversion(&mut self) {
        let left_broken = !self.scene.settings.inversion_recovery;
        self.inverted_cells = if left_broken { self.simulation.inverted_cells() } else { 0 };
        if self.trouble.is_some() {
            return;
        }
        if self.inverted_cells == 0 {
            self.trials = None;
        } else if self.trials.as_ref().is_none_or(|trials| self.is_worth_another_trial(trials)) {
            self.try_cures(vec![inversion_recovery_cure(&self.scene)]);
        }
    }

    /// Whether to try cures again. One that failed a second ago may help now: cells are not turned back while they are being
    /// crushed.
    fn is_worth_another_trial(&self, trials: &Trials) -> bool {
        let since_secs = self.simulation.state().time_secs - trials.began_at_secs();
        trials.are_over() && trials.helpful_cures().is_empty() && since_secs >= RETRY_SECS
    }

    /// Begins to try cures.
    fn try_cures(&mut self, cures: Vec<Cure>) {
        self.trials = Some(Trials::new(&self.scene, self.bodies.lattices(), &self.simulation, cures));
    }

    /// Explains why the simulation has just been stopped, and begins to try cures.
    pub(super) fn find_trouble(&mut self) {
        self.trouble = Some(self.explain_divergence());
        let plan = self.simulation.plan();
        let excess = match plan.limits_at_work().dt_safe_secs {
            Some(safe_secs) if plan.scheme != Scheme::Implicit => plan.substep_secs() / safe_secs,
            _ => 0.0,
        };
        let body = self.fastest_body();
        self.try_cures(Exploded { scene: &self.scene, excess, body }.cures());
    }

    /// Goes on trying cures until this instant, or until all are tried.
    pub(super) fn continue_trials(&mut self, until: Option<Instant>) {
        if let Some(trials) = &mut self.trials {
            trials.run_until(until, &self.stop);
        }
    }

    /// Returns what is wrong, if anything is, with the cures found so far.
    pub(super) fn current_trouble(&self) -> Option<Trouble> {
        let Some(trouble) = &self.trouble else { return self.explain_inversion() };
        let Trouble { title, words, guilty_links, .. } = trouble.clone();
        Some(Trouble { guilty_links, ..self.trouble_with_cures(&title, words) })
    }

    /// Explains why the simulation has just been stopped.
    pub(super) fn explain_divergence(&self) -> Trouble {
        let plan = self.simulation.plan();
        if !Integrator::from(plan.scheme).has_stable_step() {
            return self.without_stable_step();
        }
        let (dt_secs, limits) = (plan.substep_secs(), plan.limits_at_work());
        let safe_secs = plan.limits_at_work().dt_safe_secs.unwrap_or(f64::INFINITY);
        if dt_secs <= safe_secs || plan.scheme == Scheme::Implicit {
            return self.trouble_with_cures(
                EXPLOSION_TITLE,
                format!("{STOPPED_WORDS}. Nothing in the scene is known to be the reason."),
            );
        }
        let limiting_term = limits.limited_by(plan.dt_secs);
        let body = self.fastest_body();
        let value_and_mass =
            self.scene.bodies.get(body).map_or_else(String::new, |body| too_large_value_words(limiting_term, body));
        let words = format!(
            "{STOPPED_WORDS}. A step of {} is too large for {value_and_mass}: the largest safe step is {}.",
            step_text(dt_secs),
            limit_text(safe_secs)
        );
        let guilty_links = Arc::new(extract::guilty::guilty_links(&self.simulation, body, families_of(limiting_term)));
        Trouble { guilty_links, ..self.trouble_with_cures(EXPLOSION_TITLE, words) }
    }

    fn without_stable_step(&self) -> Trouble {
        let scheme = Integrator::from(self.simulation.plan().scheme).words();
        let words = format!(
            "{STOPPED_WORDS}: {scheme} has no stable step. It gives every vibration energy, less in smaller steps but \
             always some."
        );
        // The vibration that grows fastest has ended it: no family is more to blame than another.
        let guilty_links = extract::guilty::guilty_links(&self.simulation, self.fastest_body(), &Family::ALL);
        Trouble { guilty_links: Arc::new(guilty_links), ..self.trouble_with_cures(EXPLOSION_TITLE, words) }
    }

    /// The body with the fastest particle: the one that broke.
    fn fastest_body(&self) -> usize {
        let velocity = &self.simulation.state().velocity;
        let speed = |body: &crate::physics::BodyModel<f32>| {
            velocity[body.particles.clone()].iter().fold(0.0_f32, |fastest, v| fastest.max(Vector::length(*v)))
        };
        let speeds = self.simulation.model().bodies.iter().map(speed).enumerate();
        speeds.max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(body, _)| body)
    }
}

/// The families whose links are at fault.
fn families_of(limiting_term: Term) -> &'static [Family] {
    match limiting_term {
        Term::Stiffness(family) | Term::Damping(family) => match family {
            Family::Structural => &[Family::Structural],
            Family::Shear => &[Family::Shear],
            Family::Bending => &[Family::Bending],
        },
        Term::Combined => &Family::ALL,
        Term::Contact | Term::User => &[],
    }
}

/// The value that is too large, and the mass it is too large for.
fn too_large_value_words(limiting_term: Term, body: &Body) -> String {
    match &body.material {
        Material::Springs(springs) => too_large_spring_words(limiting_term, springs),
        Material::Solid(solid) => {
            let density = three_digits(solid.density);
            let modulus = three_digits(solid.young_modulus);
            match limiting_term {
                Term::Stiffness(_) => format!("a Young's modulus of {modulus} Pa with a density of {density} kg/m³"),
                Term::Damping(_) => format!("a damping ratio of {}", three_digits(solid.damping_ratio)),
                Term::Contact | Term::User | Term::Combined => {
                    format!("{} with a density of {density} kg/m³", limiting_term.words())
                }
            }
        }
    }
}

fn too_large_spring_words(limiting_term: Term, springs: &Springs) -> String {
    let mass = format!("a particle mass of {} g", three_digits(springs.particle_mass * 1e3));
    match limiting_term {
        Term::Stiffness(family) => {
            let stiffness = three_digits(springs.family(family).stiffness);
            format!("{} of {stiffness} N with {mass}", limiting_term.words())
        }
        Term::Damping(family) => {
            let damping = three_digits(springs.family(family).damping);
            format!("{} of {damping} N·s with {mass}", limiting_term.words())
        }
        Term::Contact | Term::User | Term::Combined => format!("{} with {mass}", limiting_term.words()),
    }
}
