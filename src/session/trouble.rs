//! A simulation that broke: what was too large against what, in plain words, and what would cure it, as commands.

use std::sync::Arc;

use super::{Command, Session};
use crate::extract;
use crate::math::Vector;
use crate::physics::stability::Term;
use crate::scene::edit::{BodyId, Edit};
use crate::scene::material::Spring;
use crate::scene::settings::{Integrator, Stepping};
use crate::scene::{Body, Family, Material, Solid, Springs};
use crate::view::legend::three_digits;

/// A simulation that broke, explained.
#[derive(Clone, Debug, PartialEq)]
pub struct Trouble {
    /// What happened, in two or three words.
    pub title: String,
    /// What happened and why, a few sentences.
    pub words: String,
    /// What would help, best first.
    pub cures: Vec<Cure>,
    /// The links that are at fault, as particles of the draw list: marked in the picture.
    pub guilty_links: Arc<Vec<[u32; 2]>>,
}

/// Something that would help.
#[derive(Clone, Debug, PartialEq)]
pub struct Cure {
    /// What it does, for a button.
    pub words: String,
    /// The change it needs; none where a new start is enough.
    pub edit: Option<Edit>,
    /// Whether the scene has to start anew.
    pub restart: bool,
}

impl Cure {
    /// What the button sends: the change, as one step of undo, a new start where it needs one, and time.
    pub fn commands(&self) -> Vec<Command> {
        let edit = self.edit.iter().cloned().flat_map(|edit| [Command::EndEdit, Command::Edit(edit), Command::EndEdit]);
        let restart = self.restart.then_some(Command::Restart);
        edit.chain(restart).chain([Command::Play]).collect()
    }
}

/// What an explosion is called.
const EXPLODED: &str = "It exploded";

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
        let mut settings = self.scene.settings.clone();
        settings.inversion_recovery = true;
        let heal = Cure { words: "Turn them back".to_owned(), edit: Some(Edit::Settings(settings)), restart: false };
        let again = Cure { words: "Start again".to_owned(), edit: None, restart: true };
        Some(Trouble { title: "It broke".to_owned(), words, cures: vec![heal, again], guilty_links: Arc::default() })
    }

    /// Looks for cells that are turned inside out, where nothing turns them back.
    pub(super) fn find_inversion(&mut self) {
        let left_broken = !self.scene.settings.inversion_recovery;
        self.inverted_cells = if left_broken { extract::overlay::inverted_cells(&self.simulation) } else { 0 };
    }

    /// Explains why the simulation has just been stopped.
    pub(super) fn explain_divergence(&self) -> Trouble {
        let plan = self.simulation.plan();
        let (dt_secs, limits) = (plan.substep_secs(), &plan.limits);
        let (Some(limit_secs), Some(safe_secs)) = (limits.dt_limit_secs, limits.dt_safe_secs()) else {
            return self.unexplained();
        };
        if dt_secs <= safe_secs || plan.integrator == Integrator::Implicit {
            return self.unexplained();
        }
        let guilty = limits.limited_by(plan.dt_secs);
        let body = self.fastest_body();
        let against = self.scene.bodies.get(body).map_or_else(String::new, |body| accuse(guilty, body));
        let bound = if dt_secs > limit_secs {
            format!("the motion stays bounded only below {} ms", three_digits(limit_secs * 1e3))
        } else {
            format!("at rest it would just do, squashed springs need less than {} ms", three_digits(safe_secs * 1e3))
        };
        let step = three_digits(dt_secs * 1e3);
        let words = format!(
            "The simulation exploded and was stopped at its last good state. A step of {step} ms is too large for \
             {against}: {bound}."
        );
        let guilty_links = Arc::new(extract::guilty::guilty_links(&self.simulation, body, families(guilty)));
        Trouble { title: EXPLODED.to_owned(), words, cures: self.cures(dt_secs / safe_secs), guilty_links }
    }

    fn unexplained(&self) -> Trouble {
        let words = "The simulation became unstable and was stopped at its last good state.".to_owned();
        let (title, cures) = (EXPLODED.to_owned(), self.cures(1.0));
        Trouble { title, words, cures, guilty_links: Arc::default() }
    }

    /// What helps against a step that is `excess` times too large to be safe.
    fn cures(&self, excess: f64) -> Vec<Cure> {
        let settings = &self.scene.settings;
        let mut cures = Vec::new();
        let cure = |words: String, edit| Cure { words, edit: Some(edit), restart: true };
        if settings.stepping == Stepping::Manual {
            let mut automatic = settings.clone();
            automatic.stepping = Stepping::Auto;
            cures.push(cure("Divide steps automatically".to_owned(), Edit::Settings(automatic)));
        }
        if excess > 1.0 {
            let mut finer = settings.clone();
            finer.dt = rounded_down(settings.dt / excess);
            let words = format!("Use a step of {} ms", three_digits(finer.dt * 1e3));
            cures.push(cure(words, Edit::Settings(finer)));
            let guilty = self.fastest_body();
            if let Some(body) = self.scene.bodies.get(guilty) {
                let replaced = |body| Edit::Body(BodyId(guilty), Box::new(body));
                cures.extend(material_cures(body, excess).map(|(words, body)| cure(words, replaced(body))));
            }
        }
        cures.push(Cure { words: "Start again".to_owned(), edit: None, restart: true });
        cures
    }

    /// The body with the fastest particle: the one that broke.
    fn fastest_body(&self) -> usize {
        let velocity = &self.simulation.state().velocity;
        let speed = |body: &crate::physics::model::BodyModel<f32>| {
            velocity[body.particles.clone()].iter().fold(0.0_f32, |fastest, v| fastest.max(Vector::length(*v)))
        };
        let speeds = self.simulation.model().bodies.iter().map(speed).enumerate();
        speeds.max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(body, _)| body)
    }
}

/// The families whose links are at fault.
fn families(guilty: Term) -> &'static [Family] {
    match guilty {
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
fn accuse(guilty: Term, body: &Body) -> String {
    match &body.material {
        Material::Springs(springs) => accuse_springs(guilty, springs),
        Material::Solid(solid) => {
            let density = three_digits(solid.density);
            let modulus = three_digits(solid.young_modulus);
            match guilty {
                Term::Stiffness(_) => format!("a Young's modulus of {modulus} Pa with a density of {density} kg/m³"),
                Term::Damping(_) => format!("a damping ratio of {}", three_digits(solid.damping_ratio)),
                Term::Contact | Term::User | Term::Combined => {
                    format!("{} with a density of {density} kg/m³", guilty.words())
                }
            }
        }
    }
}

fn accuse_springs(guilty: Term, springs: &Springs) -> String {
    let mass = format!("a particle mass of {} g", three_digits(springs.particle_mass * 1e3));
    match guilty {
        Term::Stiffness(family) => {
            let stiffness = three_digits(springs.family(family).stiffness);
            format!("{} of {stiffness} N with {mass}", guilty.words())
        }
        Term::Damping(family) => {
            let damping = three_digits(springs.family(family).damping);
            format!("{} of {damping} N·s with {mass}", guilty.words())
        }
        Term::Contact | Term::User | Term::Combined => format!("{} with {mass}", guilty.words()),
    }
}

/// A stable step grows with the root of the mass over the stiffness, and with the mass over the damping: the square of
/// the excess is enough for both. A solid's damping follows its modulus and density by their root, so that its damping
/// ratio has to shrink too.
fn material_cures(body: &Body, excess: f64) -> impl Iterator<Item = (String, Body)> {
    let factor = excess * excess;
    let [soft, heavy] = match &body.material {
        Material::Springs(springs) => {
            let softer =
                |spring: Spring| Spring { stiffness: spring.stiffness / factor, damping: spring.damping / factor };
            let [structural, shear, bending] = Family::ALL.map(|family| softer(springs.family(family)));
            let heavy = Springs { particle_mass: springs.particle_mass * factor, ..*springs };
            [Springs { structural, shear, bending, ..*springs }, heavy].map(Material::Springs)
        }
        Material::Solid(solid) => {
            let soft = Solid { young_modulus: solid.young_modulus / factor, ..*solid };
            let heavy = Solid { density: solid.density * factor, ..*solid };
            [soft, heavy]
                .map(|solid| Solid { damping_ratio: solid.damping_ratio / excess, ..solid })
                .map(Material::Solid)
        }
    };
    let times = three_digits(factor);
    [(format!("Make the springs {times} times softer"), soft), (format!("Make it {times} times heavier"), heavy)]
        .into_iter()
        .map(|(words, material)| (words, Body { material, ..body.clone() }))
}

/// Two significant digits, never more than given.
fn rounded_down(value: f64) -> f64 {
    let unit = libm::pow(10.0, libm::floor(libm::log10(value)) - 1.0);
    libm::floor(value / unit) * unit
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_rounded_to_less() {
        for (value, rounded) in [(0.001_29, 0.0012), (0.5, 0.5), (9.99e-5, 9.9e-5)] {
            let got = rounded_down(value);
            assert!(got <= value && (got - rounded).abs() < 1e-9 * rounded + 1e-12, "{value} became {got}");
        }
    }
}
