//! The energy that rounding errors alone may show, J. Far from the origin, and in large cells, a light stiff body at rest
//! shows no other energy.
//!
//! A scalar resolves a coordinate x to ε|x|, and the length of a link of rest length l to ε l.
//!
//! ```text
//! start     ½ κ δ²,  δ = 8 ε (x, l)                    misplaced once at the start, κ = k/l
//! substep   ½ κ² δ² dt² (1/mᵢ + 1/mⱼ)                  a force that is wrong by κ δ is a kick
//!         ≤ ½ κ δ² (2 S)²                              as dt² κ (1/mᵢ + 1/mⱼ) ≤ dt² ω² ≤ (2 S)², S the margin of the step
//!         × (1 − S²/2) / (1 − S²)                      the energy that a kick leaves in leapfrog at dt ω = 2 S
//!           δ² = ε²/12 (2 x² + 3.75 l²)                two ends, and the length: its difference and root, its product with
//!                                                      1/l, and half of the errors of its squares and their sums; each
//!                                                      anywhere within one unit in the last place
//! walk      ln 10⁶ × substeps                          undamped links keep the kicks, which are independent: the energy of a
//!                                                      random walk in one mode is exponentially distributed, and exceeds
//!                                                      this multiple of its mean once in a million walks
//! ```
//!
//! (Higham and Mary, "A new approach to probabilistic rounding error analysis", 2019; Hairer, Lubich and Wanner,
//! "Geometric Numerical Integration", 2006, I.5 for leapfrog's energy.)

use crate::math::{Aabb, Real};
use crate::physics::BodyModel;
use crate::physics::SAFETY;

/// Units in the last place by which rounding may misplace a particle at the start.
const START_ERROR_ULPS: f64 = 8.0;

/// The roundings in a length, as a sum of the squares of their shares.
const LENGTH_ROUNDINGS: f64 = 3.75;

/// The energy of a kick in automatic stepping over ½ κ δ².
const KICK_ENERGY_RATIO: f64 = 4.0 * SAFETY * SAFETY * (1.0 - 0.5 * SAFETY * SAFETY) / (1.0 - SAFETY * SAFETY);

/// One random walk in this many exceeds the bound.
const WALKS_PER_EXCESS: f64 = 1e6;

/// The quantities that rounding acts on in one body.
#[derive(Debug)]
pub(super) struct Rounding {
    /// ε of the scalar in use.
    epsilon: f64,
    /// κ of all links and contacts together, N/m.
    stiffness: f64,
    /// κ l² of all links together, J.
    link_energy_scale: f64,
    /// The farthest coordinate that was seen, m.
    max_coordinate: f64,
}

impl Rounding {
    pub(super) fn of<R: Real>(body: &BodyModel<R>) -> Self {
        let (mut stiffness, mut link_energy_scale) = (0.0, 0.0);
        for family in &body.links {
            for (number, link) in family.links.iter().enumerate() {
                let [length, force] = [link.rest_length, family.constants(number)[0]].map(Real::to_f64);
                stiffness += force / length;
                link_energy_scale += force * length;
            }
        }
        let contacts: f64 = body.contacts.iter().map(|contact| contact.stiffness.to_f64()).sum();
        stiffness += contacts * body.particles.len() as f64;
        Self { epsilon: R::EPSILON.to_f64(), stiffness, link_energy_scale, max_coordinate: 0.0 }
    }

    /// Takes note of where the body is.
    pub(super) fn include(&mut self, bounds: Aabb<f64>) {
        self.max_coordinate = self.max_coordinate.max(bounds.min.abs().max(bounds.max.abs()).max_element());
    }

    /// The most energy that rounding errors may show after `substeps` substeps, J.
    pub(super) fn energy(&self, substeps: u64) -> f64 {
        let at_start =
            self.displacement_energy(START_ERROR_ULPS * START_ERROR_ULPS, START_ERROR_ULPS * START_ERROR_ULPS);
        at_start + WALKS_PER_EXCESS.ln() * substeps as f64 * self.mean_kick()
    }

    /// The most energy that a substep gives on average, J.
    fn mean_kick(&self) -> f64 {
        KICK_ENERGY_RATIO / 12.0 * self.displacement_energy(2.0, LENGTH_ROUNDINGS)
    }

    /// ½ κ δ² of all links, where δ² is `places` times ε² x² plus `lengths` times ε² l², J.
    fn displacement_energy(&self, places: f64, lengths: f64) -> f64 {
        let places = places * self.stiffness * self.max_coordinate * self.max_coordinate;
        0.5 * self.epsilon * self.epsilon * (places + lengths * self.link_energy_scale)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::Simulation;
    use crate::report::extremes::lattices;
    use crate::scene::body::CubeShape;
    use crate::scene::material::{Material, Spring, Springs};
    use crate::scene::{Body, Scene, Shape};

    /// A cube of one cell, 400 m large, that weighs 35 g and has almost no damping.
    fn light_cube(turned: f64) -> Scene {
        let spring = |stiffness| Spring { stiffness, damping: 0.0 };
        let springs =
            Springs { structural: spring(6.5e6), shear: spring(1.1e5), bending: spring(4e5), particle_mass: 4.4e-3 };
        let mut body = Body { material: Material::Springs(springs), ..Body::default() };
        body.shape = Shape::Cube(CubeShape { cells: 1, size: 400.0 });
        body.pose.position = [40.0, -40.0, 100.0];
        body.pose.rotation_deg = [turned, 2.0 * turned, 178.0];
        let mut scene = Scene { bodies: vec![body], ..Scene::default() };
        scene.settings.gravity = [0.0; 3];
        scene.settings.allow_implicit = false;
        scene.settings.inversion_recovery = false;
        scene
    }

    /// The energy that a light cube shows after 4000 substeps, and the mean derived from rounding, J.
    fn heated<R: Real>(turned: f64) -> (f64, f64) {
        let scene = light_cube(turned);
        let mut simulation = Simulation::<R>::new(&scene, &lattices(&scene).expect("a cube"));
        let mut rounding = Rounding::of(&simulation.model().bodies[0]);
        rounding.include(simulation.diagnostics().bounds);
        for _ in 0..4000 {
            simulation.substep(&mut ());
        }
        (simulation.diagnostics().energy.total(), 4000.0 * rounding.mean_kick())
    }

    #[test]
    fn rounding_gives_a_light_stiff_body_what_is_derived() {
        let walks: Vec<(f64, f64)> = (0..24).map(|walk| heated::<f32>(17.0 * f64::from(walk) + 3.0)).collect();
        let [shown, most] = [walks.iter().map(|w| w.0).sum::<f64>(), walks.iter().map(|w| w.1).sum()];
        assert!(shown < most, "{shown} J shown, {most} J derived");
        assert!(shown > 0.1 * most, "{shown} J shown, {most} J derived: no room for anything else");
        assert!(
            walks.iter().all(|(shown, most)| *shown < WALKS_PER_EXCESS.ln() * most),
            "no walk goes that far: {walks:?}"
        );
    }

    #[test]
    fn double_precision_shows_none_of_it() {
        let [(single, _), (double, most)] = [heated::<f32>(20.0), heated::<f64>(20.0)];
        assert!(double < 1e-12 * single && double < 10.0 * most, "{double} J, {most} J derived, {single} J in single");
    }
}
