//! Possible cures of a broken simulation, as changes of the scene, best first. Whether one helps is found by trying: see
//! `trials`.

use super::Command;
use super::step_words::{rounded_down, step_text};
use crate::scene::edit::{BodyId, Edit};
use crate::scene::material::Spring;
use crate::scene::settings::{ContactRule, Integrator, Settings, Stepping};
use crate::scene::{Body, Family, Material, Scene, Solid, Springs};
use crate::view::legend::three_digits;

/// A change that helps.
#[derive(Clone, Debug, PartialEq)]
pub struct Cure {
    /// What it does, for a button.
    pub words: String,
    /// The change.
    pub edit: Edit,
    /// Whether the scene has to start anew.
    pub restart: bool,
}

impl Cure {
    /// The commands of the button: the change as one undo step, a restart where it needs one, and play.
    pub fn commands(&self) -> Vec<Command> {
        let restart = self.restart.then_some(Command::Restart);
        [Command::EndEdit, Command::Edit(self.edit.clone()), Command::EndEdit]
            .into_iter()
            .chain(restart)
            .chain([Command::Play])
            .collect()
    }
}

/// A scene that exploded.
#[derive(Clone, Copy, Debug)]
pub(super) struct Exploded<'a> {
    /// The scene.
    pub(super) scene: &'a Scene,
    /// The step in use over the largest safe one; not above 1 where the step is not to blame.
    pub(super) excess: f64,
    /// The body that broke.
    pub(super) body: usize,
}

impl Exploded<'_> {
    /// Returns the changes that might help. A scheme without a stable step is replaced: no step and no material makes it
    /// stable.
    pub(super) fn cures(&self) -> Vec<Cure> {
        let settings = &self.scene.settings;
        if !settings.integrator.has_stable_step() {
            return [Integrator::SemiImplicit, Integrator::Verlet, Integrator::Implicit]
                .map(|s| self.scheme_cure(s))
                .into();
        }
        let mut cures = Vec::new();
        if settings.stepping == Stepping::Manual {
            let automatic = Settings { stepping: Stepping::Auto, ..settings.clone() };
            cures.push(settings_cure("Divide steps automatically".to_owned(), automatic));
        }
        if self.excess > 1.0 {
            let dt = rounded_down(settings.dt / self.excess);
            cures.push(settings_cure(format!("Use a step of {}", step_text(dt)), Settings { dt, ..settings.clone() }));
            cures.extend(self.material_cures());
            return cures;
        }
        if settings.contact == ContactRule::Thesis {
            let contact = Settings { contact: ContactRule::Implicit, ..settings.clone() };
            cures.push(settings_cure("Use implicit contact".to_owned(), contact));
        }
        let others = [Integrator::SemiImplicit, Integrator::Implicit].into_iter();
        cures.extend(others.filter(|scheme| *scheme != settings.integrator).map(|scheme| self.scheme_cure(scheme)));
        cures
    }

    /// Another scheme, with steps divided as it needs them.
    fn scheme_cure(&self, integrator: Integrator) -> Cure {
        let settings = Settings { integrator, stepping: Stepping::Auto, ..self.scene.settings.clone() };
        let divided = self.scene.settings.stepping == Stepping::Manual;
        let how = if divided { ", steps divided automatically" } else { "" };
        settings_cure(format!("Use {}{how}", integrator.words()), settings)
    }

    /// A softer material and a heavier one.
    fn material_cures(&self) -> Vec<Cure> {
        let Some(body) = self.scene.bodies.get(self.body) else { return Vec::new() };
        let cure = |(words, material)| {
            let edit = Edit::Body(BodyId(self.body), Box::new(Body { material, ..body.clone() }));
            Cure { words, edit, restart: true }
        };
        softer_and_heavier(&body.material, self.excess).map(cure).into()
    }
}

/// The cure for cells turned inside out: they are turned back while the scene runs.
pub(super) fn inversion_recovery_cure(scene: &Scene) -> Cure {
    let settings = Settings { inversion_recovery: true, ..scene.settings.clone() };
    Cure { restart: false, ..settings_cure("Turn them back".to_owned(), settings) }
}

fn settings_cure(words: String, settings: Settings) -> Cure {
    Cure { words, edit: Edit::Settings(settings), restart: true }
}

/// A stable step grows with the root of the mass over the stiffness, and with the mass over the damping: the square of
/// the excess is enough for both. A solid's damping follows its modulus and density by their root, so that its damping
/// ratio has to shrink too.
fn softer_and_heavier(material: &Material, excess: f64) -> [(String, Material); 2] {
    let factor = round_up_to_three_digits(excess * excess);
    let [soft, heavy] = match material {
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
                .map(|solid| Solid { damping_ratio: solid.damping_ratio / factor.sqrt(), ..solid })
                .map(Material::Solid)
        }
    };
    let times = three_digits(factor);
    [(format!("Make it {times} times softer"), soft), (format!("Make it {times} times heavier"), heavy)]
}

/// Rounds up to three significant digits, so that a person reads the very number that is used.
fn round_up_to_three_digits(value: f64) -> f64 {
    let unit = libm::pow(10.0, libm::floor(libm::log10(value)) - 2.0);
    libm::ceil(value / unit) * unit
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_factor_is_rounded_to_more_and_reads_as_it_is() {
        for (value, text) in [(7.962, "7.97"), (1.0001, "1.01"), (123.4, "124"), (3.31, "3.31")] {
            let rounded = round_up_to_three_digits(value);
            assert!(rounded >= value * (1.0 - 1e-12) && three_digits(rounded) == text, "{value} became {rounded}");
        }
    }
}
