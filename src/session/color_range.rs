//! The automatic range of the colours: from zero to about the greatest value, but never so narrow that it shows the noise of
//! a body at rest.

use crate::math::Vector;
use crate::physics::BodyModel;
use crate::physics::Simulation;
use crate::scene::ColorBy;

/// The share of particles that the range covers: one torn corner must not grey out all others.
const COVERED_SHARE: f64 = 0.99;
/// The least range of `load`, as a share of a particle's weight: links within a body at rest carry a few tenths of it.
const MIN_LOAD_SHARE: f64 = 0.1;
/// The least range of strains, %.
const MIN_STRAIN_PERCENT: f64 = 0.1;
/// The least range of speeds, in body sizes a second, 1/s.
const MIN_SPEED_PER_SIZE: f64 = 1e-3;
/// The least acceleration that counts for a particle's weight, in body sizes, 1/s²: it stands in for gravity where there is
/// none.
const MIN_ACCELERATION_PER_SIZE: f64 = 1.0;

/// Returns the range from zero to the value below which 99 % of the scalars lie, or to the least value worth a colour.
pub(super) fn automatic(simulation: &Simulation<f32>, color: ColorBy, scalars: &[f32]) -> [f32; 2] {
    let mut sorted: Vec<f32> = scalars.iter().copied().filter(|x| x.is_finite()).collect();
    #[expect(clippy::cast_possible_truncation, reason = "colours need no more than f32")]
    let min_range = min_range(simulation, color) as f32;
    let min_range = if min_range > 0.0 { min_range } else { 1.0 };
    if sorted.is_empty() {
        return [0.0, min_range];
    }
    // No torn corner distorts the stiffness of a material.
    let share = if color == ColorBy::Stiffness { 1.0 } else { COVERED_SHARE };
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of a length is an index")]
    let place = ((sorted.len() - 1) as f64 * share) as usize;
    let (_, high, _) = sorted.select_nth_unstable_by(place, f32::total_cmp);
    [0.0, high.max(min_range)]
}

/// The least range worth colours, in the scalar's unit. It follows from the weight and size of the bodies.
fn min_range(simulation: &Simulation<f32>, color: ColorBy) -> f64 {
    let model = simulation.model();
    let gravity = model.gravity.to_dvec3().length();
    let largest = |of: &dyn Fn(&BodyModel<f32>) -> f64| model.bodies.iter().map(of).fold(0.0, f64::max);
    let weight = |body: &BodyModel<f32>| {
        let acceleration = gravity.max(MIN_ACCELERATION_PER_SIZE * f64::from(body.size));
        f64::from(body.particle_mass) * acceleration
    };
    match color {
        ColorBy::Plain | ColorBy::Model | ColorBy::Stiffness => 1.0,
        ColorBy::Load => MIN_LOAD_SHARE * largest(&weight),
        ColorBy::Force | ColorBy::Net | ColorBy::Contact => largest(&weight),
        ColorBy::Strain => MIN_STRAIN_PERCENT,
        ColorBy::Speed => MIN_SPEED_PER_SIZE * largest(&|body| f64::from(body.size)),
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::scene::edit::Edit;
    use crate::scene::material::Solid;
    use crate::scene::{Body, Material, Pose, Scene, presets};
    use crate::session::{Command, Session};
    use crate::view::DrawList;

    fn colored(session: &mut Session, color: ColorBy) -> DrawList {
        let view = session.scene().view.clone();
        session.handle(Command::Edit(Edit::View(crate::scene::ViewSettings { color, ..view }))).expect("a colour");
        session.draw_list()
    }

    /// A stiff cube on the ground, after some seconds.
    fn resting(secs: f64) -> Session {
        let material = Material::Solid(Solid { young_modulus: 1e7, ..Solid::default() });
        let pose = Pose { position: [0.0, 0.5, 0.0], ..Pose::default() };
        let body = Body { pose, material, ..Body::default() };
        let mut scene: Scene = presets::ground_only();
        scene.bodies.push(body);
        scene.settings.sleeping = false;
        let mut session = Session::new(scene, PathBuf::new(), String::new()).expect("a cube");
        while session.status().time_secs < secs {
            assert!(session.step(), "it rests");
        }
        session
    }

    #[test]
    fn what_rests_looks_calm() {
        let mut session = resting(4.0);
        for color in [ColorBy::Net, ColorBy::Speed] {
            let drawn = colored(&mut session, color);
            let high = drawn.color_range[1];
            let brightest = drawn.scalars.expect("colours").iter().fold(0.0_f32, |most, value| most.max(*value));
            assert!(brightest < 0.1 * high, "{color:?}: {brightest} on a scale to {high}");
        }
    }

    #[test]
    fn what_is_there_fills_the_scale_as_before() {
        let mut session = resting(4.0);
        for color in [ColorBy::Load, ColorBy::Force, ColorBy::Contact] {
            let drawn = colored(&mut session, color);
            let mut sorted = drawn.scalars.expect("colours").to_vec();
            sorted.sort_unstable_by(f32::total_cmp);
            let high = sorted[(sorted.len() - 1) * 99 / 100];
            assert!(
                (drawn.color_range[1] - high).abs() <= 1e-6 * high,
                "{color:?}: {:?} for {high}",
                drawn.color_range
            );
        }
    }

    #[test]
    fn a_body_that_hangs_in_nothing_has_a_scale_too() {
        let mut scene = Scene { bodies: vec![Body::default()], ..Scene::default() };
        scene.settings.gravity = [0.0; 3];
        let mut session = Session::new(scene, PathBuf::new(), String::new()).expect("a cube");
        session.step();
        for color in ColorBy::ALL {
            let [low, high] = colored(&mut session, color).color_range;
            assert!(low.abs() < f32::MIN_POSITIVE && high >= 9e-4, "{color:?}: {low} … {high}");
        }
    }
}
