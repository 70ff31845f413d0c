//! The words of the stability panel about a body's place on the map.

use crate::app::ui::figure::rounded_figure;
use crate::scene::{Body, Family, Material};
use crate::session::stability_map::{PlaneShown, StabilityMap, Zone};
use crate::session::step_words::step_text;

/// Whose values are on the axes.
pub(super) fn whose_words(name: &str, family: Option<Family>, limiting: Option<Family>) -> String {
    match (family, limiting) {
        (Some(family), Some(limiting)) if family != limiting => {
            let (family, limiting) = (family.name(), limiting.name());
            format!("On the axes the {family} springs of {name}; its {limiting} springs limit the step more.")
        }
        (Some(family), _) => {
            format!("On the axes the {} springs of {name}, which limit the step most.", family.name())
        }
        (None, _) => format!("On the axes the structural links of {name}, a solid: the others go with them."),
    }
}

/// The body's place on the map, and its stability there.
pub(super) fn now_words(shown: &PlaneShown, body: &Body, zone: Zone, is_manual: bool) -> String {
    let asked = shown.step();
    let step = format!("{}, {}", asked.integrator.words(), step_text(asked.dt_secs));
    let becomes = match (zone, is_manual) {
        (Zone::Safe | Zone::Stable, _) if !asked.integrator.has_stable_step() => "no step is safe",
        (Zone::Unstable, _) if !asked.integrator.has_stable_step() => "no step is safe, and this one may explode",
        (Zone::Safe, _) if shown.border.is_empty() => "stable at any step",
        (Zone::Safe, _) => "stable, with the margin that automatic stepping keeps",
        (Zone::Stable, true) => "stable at rest, with less margin than automatic stepping keeps",
        (Zone::Stable, false) => "stable at rest; automatic stepping divides the step to keep its margin",
        (Zone::Unstable, true) => "not stable: it may explode",
        (Zone::Unstable, false) => "not stable with whole steps: automatic stepping divides them",
    };
    format!("Now {} with {step}: {becomes}.", values_words(body, shown.family()))
}

/// The stability at a place of the map.
pub(super) fn predicted_words(zone: Zone, has_stable_step: bool) -> &'static str {
    match (zone, has_stable_step) {
        (Zone::Safe, true) => "stable, with margin",
        (Zone::Stable, true) => "stable at rest",
        (Zone::Unstable, true) => "not stable",
        (Zone::Safe | Zone::Stable, false) => "grows unless damped",
        (Zone::Unstable, false) => "grows at once",
    }
}

/// The values on the axes.
pub(super) fn values_words(body: &Body, family: Option<Family>) -> String {
    match (&body.material, family) {
        (Material::Springs(springs), Some(family)) => {
            let spring = springs.family(family);
            format!("{} N, {} N·s", rounded_figure(spring.stiffness), rounded_figure(spring.damping))
        }
        (Material::Solid(solid), _) => {
            let (modulus, ratio) = (rounded_figure(solid.young_modulus), rounded_figure(solid.damping_ratio));
            format!("{modulus} Pa, damping ratio {ratio}")
        }
        (Material::Springs(_), None) => String::new(),
    }
}

pub(super) fn measured_words(map: &StabilityMap) -> String {
    let what = match map.stand_in {
        Some(cells) => format!("a cube of {cells} such cells an edge instead of this large body"),
        None => "the body alone".to_owned(),
    };
    format!("Measured: {} steps of {what}, shaken.", map.watched)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Solid;

    #[test]
    fn the_words_name_the_family_and_the_values() {
        let body = Body::default();
        assert_eq!(values_words(&body, Some(Family::Shear)), "25 N, 0.12 N·s");
        let solid = Body { material: Material::Solid(Solid::default()), ..Body::default() };
        assert_eq!(values_words(&solid, None), "100000 Pa, damping ratio 0.05");
        let [shear, bending] = [Some(Family::Shear), Some(Family::Bending)];
        assert!(whose_words("Cube", shear, shear).contains("the shear springs of Cube, which limit"), "which family");
        assert!(
            whose_words("Cube", shear, bending).ends_with("its bending springs limit the step more."),
            "which limits"
        );
        assert!(whose_words("Cube", None, None).contains("a solid"), "a solid has none");
    }
}
