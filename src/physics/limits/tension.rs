//! Links under tension: how much stiffness across links the stabilised scheme bears.
//!
//! A link that is stretched by a strain e resists across itself, with its tension over its length, and only the links around
//! it damp that motion. In a plane wave with vector q over a lattice whose links are all stretched alike
//!
//! ```text
//! K_t(q) = K(q) + t G(q),   G(q) = Σ over half links of k/l0 2 (1 − cos q·δ) (1 − d̂ d̂ᵀ),   t = e/(1 + e)
//! ```
//!
//! Every vibration lies in the scheme's disc of radius R if `(R/dt) C(q) − K_t(q)` is positive semidefinite:
//! `M z² + dt C z + dt² K_t` for a unit vector gives `|z|² = dt² k` and `2 Re z = −dt c`, and the disc is
//! `|z|² ≤ −2 R Re z`. At rest this holds for all families together, as it holds for each alone. Stiff links with only weak
//! dampers across them leave the disc at a small strain.

use glam::{DMat3, DVec3};

use super::{WaveTensors, lattice_waves};
use crate::math::Real;
use crate::physics::model::{BodyModel, LatticeConstants};
use crate::physics::schemes::chebyshev::DISC_RADIUS;

/// Steps of a bisection: to a millionth of the range.
const BISECTION_STEPS: usize = 20;

/// Doublings of a rate after which no rate counts as high enough.
const DOUBLINGS: usize = 30;

/// The largest rounding error of an eigenvalue that is zero, as a share of the stiffnesses and of the dampings times their
/// rate. The latter is so much smaller that the highest rate hides no stiffness.
const ROUNDING: [f64; 2] = [1e-9, 1e-14];

/// Returns the largest strain of all links of a body, up to `most`, at which substeps of `secs` of the stabilised scheme are
/// stable; zero if there is none.
pub(in crate::physics) fn largest_strain<R: Real>(body: &BodyModel<R>, secs: f64, most: f64) -> f64 {
    let waves = lattice_waves();
    let rate = DISC_RADIUS / secs;
    let mut tension = most / (1.0 + most);
    for lattice in body.lattices() {
        for tensors in &waves {
            if lattice.holds(tensors, rate, tension) {
                continue;
            }
            let mut low = 0.0;
            for _ in 0..BISECTION_STEPS {
                let middle = 0.5 * (low + tension);
                if lattice.holds(tensors, rate, middle) { low = middle } else { tension = middle }
            }
            tension = low;
        }
    }
    tension / (1.0 - tension)
}

/// Returns the longest stable substep of the stabilised scheme while all links of a body have a strain, s; zero if there is
/// none, as nothing damps across some links.
pub(in crate::physics) fn longest_secs<R: Real>(body: &BodyModel<R>, strain: f64) -> f64 {
    let waves = lattice_waves();
    let tension = strain / (1.0 + strain);
    let mut least_rate = 0.0_f64;
    for lattice in body.lattices() {
        for tensors in &waves {
            if lattice.holds(tensors, least_rate, tension) {
                continue;
            }
            let first = least_rate.max(lattice.rate());
            let doubled = (0..DOUBLINGS).scan(first, |rate, _| {
                *rate *= 2.0;
                Some(*rate)
            });
            let Some(mut high) = doubled.into_iter().find(|&rate| lattice.holds(tensors, rate, tension)) else {
                return 0.0;
            };
            for _ in 0..BISECTION_STEPS {
                let middle = 0.5 * (least_rate + high);
                if lattice.holds(tensors, middle, tension) { high = middle } else { least_rate = middle }
            }
            least_rate = high;
        }
    }
    DISC_RADIUS / least_rate
}

impl LatticeConstants {
    /// Whether `rate C − K − tension G` is positive semidefinite for a wave.
    fn holds(&self, tensors: &WaveTensors, rate: f64, tension: f64) -> bool {
        let (mut lacks, mut rounding) = (DMat3::ZERO, 0.0);
        for (family, along) in tensors.iter().enumerate() {
            let (stiffness, damping) = (self.stiffness[family], self.damping[family]);
            let trace = along.x_axis.x + along.y_axis.y + along.z_axis.z;
            let across = DMat3::from_diagonal(DVec3::splat(trace)) - *along;
            lacks += *along * (stiffness - rate * damping) + across * (tension * stiffness);
            rounding += trace * (ROUNDING[0] * stiffness + ROUNDING[1] * rate * damping);
        }
        // Links that do not take part in this wave lack nothing.
        rounding <= 0.0 || is_positive(DMat3::from_diagonal(DVec3::splat(rounding)) - lacks)
    }

    /// Returns a typical ratio of stiffness to damping of the links, 1/s.
    fn rate(&self) -> f64 {
        let [stiffness, damping] = [self.stiffness, self.damping].map(|of| of.iter().sum::<f64>());
        if damping > 0.0 && stiffness > 0.0 { stiffness / damping } else { 1.0 }
    }
}

/// Whether a symmetric matrix is positive definite, by its pivots: rounding leaves their signs right even if its entries are
/// of very different sizes.
fn is_positive(a: DMat3) -> bool {
    let [x, y, z] = [a.x_axis, a.y_axis, a.z_axis];
    if x.x <= 0.0 {
        return false;
    }
    let [yy, yz, zz] = [y.y - x.y * x.y / x.x, y.z - x.y * x.z / x.x, z.z - x.z * x.z / x.x];
    yy > 0.0 && yy * zz > yz * yz
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use glam::{DMat3, DVec3};

    use super::{is_positive, largest_strain, longest_secs};
    use crate::math::rng::Rng;
    use crate::physics::Simulation;
    use crate::scene::body::{CubeShape, PinBox};
    use crate::scene::material::Spring;
    use crate::scene::resolve::resolve;
    use crate::scene::settings::{Integrator, Stepping};
    use crate::scene::{Body, Material, Scene, Shape, Solid, Springs};

    /// Springs of families far apart: what is stiff is not damped across.
    fn apart() -> Material {
        let spring = |stiffness, damping| Spring { stiffness, damping };
        let (structural, shear, bending) = (spring(200.0, 1.5), spring(5.0, 0.05), spring(0.0, 0.0));
        Material::Springs(Springs { structural, shear, bending, particle_mass: 0.01 })
    }

    /// Returns a cube of this material in steps of `dt` seconds of the stabilised scheme, all of its outside held.
    fn held(material: Material, dt: f64) -> Simulation<f64> {
        let mut scene = Scene { bodies: vec![Body::default()], ..Scene::default() };
        scene.obstacles.clear();
        (scene.settings.gravity, scene.settings.inversion_recovery) = ([0.0; 3], false);
        (scene.settings.dt, scene.settings.stepping) = (dt, Stepping::Manual);
        (scene.settings.integrator, scene.settings.sleeping) = (Integrator::Stabilised, false);
        let body = &mut scene.bodies[0];
        (body.material, body.self_collides) = (material, false);
        body.shape = Shape::Cube(CubeShape { cells: 8, size: 0.8 });
        body.pins = (0..6)
            .map(|side| {
                let mut pin = PinBox { min: [-1.0; 3], max: [1.0; 3] };
                let ends = if side < 3 { &mut pin.max } else { &mut pin.min };
                ends[side % 3] = if side < 3 { -0.39 } else { 0.39 };
                pin
            })
            .collect();
        let lattice = resolve(&scene.bodies[0].shape, Path::new("."), &()).expect("a cube").lattice;
        Simulation::new(&scene, &[lattice])
    }

    /// Returns how many times as fast the particles move after a while as at the start, if all links are stretched alike at
    /// first.
    fn growth(mut simulation: Simulation<f64>, strain: f64) -> f64 {
        let mut state = simulation.state().clone();
        let middle = state.position.iter().sum::<DVec3>() / state.position.len() as f64;
        let mut rng = Rng::new(4);
        for (number, (x, v)) in state.position.iter_mut().zip(&mut state.velocity).enumerate() {
            *x = middle + (*x - middle) * (1.0 + strain);
            if !simulation.model().bodies[0].is_pinned(number) {
                *v = DVec3::from([0; 3].map(|_| rng.between(-1e-6, 1e-6)));
            }
        }
        simulation.set_state(state);
        let speed = |simulation: &Simulation<f64>| {
            simulation.state().velocity.iter().map(|v| v.length_squared()).sum::<f64>().sqrt()
        };
        let begin = speed(&simulation);
        for _ in 0..1500 {
            if simulation.substep(&mut ()).diverged {
                return f64::INFINITY;
            }
        }
        speed(&simulation) / begin
    }

    #[test]
    fn a_stretched_lattice_is_stable_up_to_the_bound_and_not_far_beyond() {
        for dt in [6e-3, 8e-3] {
            let simulation = held(apart(), dt);
            let borne = largest_strain(&simulation.model().bodies[0], dt, 1.0);
            assert!(borne > 0.01 && borne < 0.5, "{borne}");
            let [at_rest, within, beyond] = [0.0, 0.9, 5.0].map(|share| growth(held(apart(), dt), share * borne));
            assert!(at_rest < 1.0 && within < 1.0, "steps of {dt} s, strain of {borne}: {at_rest}, {within}");
            assert!(beyond > 1e3, "steps of {dt} s: {borne} is far too careful: {beyond}");
        }
    }

    #[test]
    fn the_longest_step_for_a_strain_bears_just_that() {
        let solid = Material::Solid(Solid { young_modulus: 1e4, density: 1e3, damping_ratio: 0.5, ..Solid::DEFAULT });
        for material in [apart(), solid, Material::default()] {
            let simulation = held(material, 1e-3);
            let body = &simulation.model().bodies[0];
            for strain in [0.02, 0.2] {
                let secs = longest_secs(body, strain);
                let borne = largest_strain(body, secs, 1.0);
                assert!((borne / strain - 1.0).abs() < 1e-3, "{strain} in {secs} s, but {borne}");
            }
        }
    }

    #[test]
    fn the_sign_of_a_known_matrix() {
        let rotation = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
        for far in [1.0, 1e12] {
            for (least, expected) in [(1e-3, true), (-1e-3, false)] {
                let a = DMat3::from_diagonal(DVec3::new(far, least, 0.5));
                assert_eq!(is_positive(a), expected, "{far} and {least}");
            }
            let turned =
                |least| rotation * DMat3::from_diagonal(DVec3::new(far, 0.5 * far, least)) * rotation.transpose();
            assert!(is_positive(turned(1e-3 * far)) && !is_positive(turned(-1e-3 * far)), "turned, {far}");
        }
    }

    #[test]
    fn what_nothing_damps_across_bears_no_tension() {
        let mut material = apart();
        if let Material::Springs(springs) = &mut material {
            springs.shear = Spring { stiffness: 0.0, damping: 0.0 };
        }
        let simulation = held(material, 1e-3);
        let body = &simulation.model().bodies[0];
        assert!(longest_secs(body, 0.2) <= 0.0, "{}", longest_secs(body, 0.2));
        assert!(largest_strain(body, 1e-6, 0.7) < 1e-5, "{}", largest_strain(body, 1e-6, 0.7));
    }
}
