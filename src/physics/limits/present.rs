//! How large a step may be in the present state of a body.
//!
//! The bound for any state ([`super::any_state`]) is far too careful for a body that hangs by a few cells: its links still
//! point everywhere. A link along a unit vector d̂ that is stretched to the length l resists along itself and, with its
//! tension over its length, across:
//!
//! ```text
//! S = d̂ d̂ᵀ + t (1 − d̂ d̂ᵀ),   t = max(0, 1 − l0/l)
//! ```
//!
//! With `(aᵢ − aⱼ)² ≤ (1/m + 1/M) (m aᵢ² + M aⱼ²)` for the masses m and M of its ends, as in any state, but with its
//! direction kept,
//!
//! ```text
//! λ(K) ≤ max over particles λmax(Σ over its links k/l0 (1/m + 1/M) S)
//! ```
//!
//! and the same for the damping with `d̂ d̂ᵀ` alone. At rest this is a third of the bound in any state. A compressed link
//! pushes its ends aside, which only lowers the stiffness.
//!
//! Cells near inversion are pushed back ([`crate::physics::forces::recovery`]), and the push takes up some of the limit beside
//! links. Where links are damped up to their own margin, a crushed body is divided into one part more.
//!
//! Semi-implicit Euler takes this bound with the margin that it keeps at rest: it gave no energy in thousands of extreme
//! scenes. Verlet, whose damping follows from how links pointed before, gave some. The stabilised scheme has nothing that
//! damps across stretched links, and what hits a body may stretch them within one of its long substeps. These two keep to
//! the bound for any state.
//!
//! The bound holds for the present directions of links. They are checked again before they can have turned by much
//! ([`checks`]), and a part of a substep in which the ends of a link move past each other by half a link is divided further.
//!
//! [`checks`]: crate::physics::stepping

use super::any_state::MAX_PARTS;
use super::load::{LinkLoad, Margin, SAFETY};
use crate::math::{Real, Vector};
use crate::physics::kernels::SimdLevel;
use crate::physics::model::{BodyModel, LinkFamily, Scheme};

/// The share that is taken of a step of semi-implicit Euler bounded by damping, the same for all families. At rest, families
/// that do not hold a body in shape take less, as links may point elsewhere by the next step, and those that do take more.
const DAMPING_SAFETY: f64 = 0.8;

/// The most of `κ dt²/(m h²)` for the push of stiffness κ on crushed cells in a whole substep: a manual step may be longer
/// than the push could bear.
pub(in crate::physics) const MAX_PUSH_LOAD: f64 = 0.6;

/// The share of the limit that the push takes up beside links in a whole substep, at most (`compile::recovery`).
const PUSH_SHARE: f64 = 0.5 * MAX_PUSH_LOAD;

/// The share that the damper of the push takes up in a part of any length: it stops half of the speed of the push's fastest
/// mode ([`crate::physics::forces::recovery`]), and the limit is twice that speed.
const PUSH_DAMPER_SHARE: f64 = 0.25;

/// Returns into how many parts a substep of `dt_secs` of semi-implicit Euler is divided while a body's links add this load,
/// and while its cells are pushed out of inversion if `is_crushed`.
pub(in crate::physics) fn parts(load: LinkLoad, is_crushed: bool, dt_secs: f64) -> u32 {
    let margin = Margin { stiffness: SAFETY, damping: [DAMPING_SAFETY; 3] };
    let bears = |parts: u32| {
        let dt = dt_secs / f64::from(parts);
        let pushed = PUSH_SHARE / f64::from(parts * parts) + PUSH_DAMPER_SHARE;
        let has_room = !is_crushed || load.share_of_limit(dt) + pushed <= 1.0;
        has_room && load.is_borne(Scheme::SemiImplicit, dt, margin)
    };
    (1..MAX_PARTS).find(|&parts| bears(parts)).unwrap_or(MAX_PARTS)
}

/// A symmetric matrix: xx, yy, zz, yz, zx, xy.
type Symmetric<R> = [R; 6];

/// The identity.
const IDENTITY: Symmetric<f64> = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0];

/// The sums at a particle: the matrix of stiffness and that of damping, side by side, so that both are added at once.
pub(in crate::physics) type Sums<R> = [R; 12];

/// Memory for the sums of a particle in single precision.
pub(in crate::physics) const BYTES_A_PARTICLE: usize = size_of::<Sums<f32>>();

/// Returns the most that the links of a body add with its particles at `position` (m); `sums` has an element for each of them.
pub(in crate::physics) fn load<R: Real>(
    level: SimdLevel,
    body: &BodyModel<R>,
    position: &[R::Vec3],
    sums: &mut [Sums<R>],
) -> LinkLoad {
    sums.fill(Sums::default());
    for family in &body.links {
        level.run(
            #[inline(always)]
            || add_links(body, family, position, sums),
        );
    }
    let free = sums.iter().enumerate().filter(|(particle, _)| !body.is_pinned(*particle));
    let most = free.fold([R::ZERO; 2], |[most_stiffness, most_damping], (_, &sums)| {
        let [xx, yy, zz, yz, zx, xy, damping @ ..] = sums;
        [
            most_stiffness.max(largest_eigenvalue(&[xx, yy, zz, yz, zx, xy])),
            most_damping.max(largest_eigenvalue(&damping)),
        ]
    });
    let [stiffness, damping] = most.map(Real::to_f64);
    LinkLoad { stiffness, damping }
}

/// Adds what the links of a family resist to the sums at their ends.
#[inline(always)]
#[expect(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest level alone")]
fn add_links<R: Real>(body: &BodyModel<R>, family: &LinkFamily<R>, position: &[R::Vec3], sums: &mut [Sums<R>]) {
    let identity = IDENTITY.map(R::from_f64);
    let mobility = |particle: usize| if body.is_pinned(particle) { R::ZERO } else { body.inverse_mass(particle) };
    for (number, link) in family.links.iter().enumerate() {
        let ends = link.ends.map(|end| end as usize);
        let d = (position[ends[1]] - position[ends[0]]) * link.inverse_rest_length;
        let length = d.length();
        let (along, tension) = if length > R::ZERO {
            let [x, y, z] = (d * (R::ONE / length)).components();
            ([x * x, y * y, z * z, y * z, z * x, x * y], (R::ONE - R::ONE / length).max(R::ZERO))
        } else {
            // Ends in one place may go apart in any direction.
            (identity, R::ZERO)
        };
        let per_constant = link.inverse_rest_length * (mobility(ends[0]) + mobility(ends[1]));
        let [stiffness, damping] = family.constants(number).map(|constant| constant * per_constant);
        let mut own = Sums::<R>::default();
        for (place, along) in along.into_iter().enumerate() {
            own[place] = stiffness * (along + tension * (identity[place] - along));
            own[place + 6] = damping * along;
        }
        for end in ends {
            for (sum, own) in sums[end].iter_mut().zip(own) {
                *sum += own;
            }
        }
    }
}

/// Returns an upper bound of a matrix's largest eigenvalue, exact if the two others are equal. With the mean μ of the three
/// and the sum s² of the squares of their distances from it, none is above `μ + √(2/3 s²)` (Wolkowicz and Styan, "Bounds for
/// Eigenvalues Using Traces", 1980, theorem 2.1).
fn largest_eigenvalue<R: Real>(&[xx, yy, zz, yz, zx, xy]: &Symmetric<R>) -> R {
    let mean = (xx + yy + zz) * R::from_f64(1.0 / 3.0);
    let [a, b, c] = [xx - mean, yy - mean, zz - mean];
    let squares = a * a + b * b + c * c + (yz * yz + zx * zx + xy * xy) * R::from_f64(2.0);
    mean + (squares * R::from_f64(2.0 / 3.0)).sqrt()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use glam::{DMat3, DQuat, DVec3};

    use super::{MAX_PUSH_LOAD, PUSH_DAMPER_SHARE, SimdLevel, Sums, largest_eigenvalue, load, parts};
    use crate::math::rng::Rng;
    use crate::physics::Simulation;
    use crate::physics::limits::fastest_tests::fastest;
    use crate::physics::limits::{LinkLoad, any_state};
    use crate::physics::model::BodyModel;
    use crate::scene::body::{CubeShape, PinBox};
    use crate::scene::resolve::resolve;
    use crate::scene::{Body, Scene, Shape};

    fn cube(cells: u32, pins: Vec<PinBox>) -> Simulation<f64> {
        let mut scene = Scene { bodies: vec![Body::default()], ..Scene::default() };
        scene.bodies[0].shape = Shape::Cube(CubeShape { cells, size: 1.0 });
        scene.bodies[0].pins = pins;
        let lattice = resolve(&scene.bodies[0].shape, Path::new("."), &()).expect("a cube").lattice;
        Simulation::new(&scene, &[lattice])
    }

    fn load_of(body: &BodyModel<f64>, position: &[DVec3]) -> LinkLoad {
        load(SimdLevel::best(), body, position, &mut vec![Sums::default(); position.len()])
    }

    #[test]
    fn links_and_the_push_on_crushed_cells_share_the_limit() {
        let dt = 1e-3;
        for tenths in 1..=40 {
            let of_limit = f64::from(tenths) / 10.0;
            let stiff = LinkLoad { stiffness: 4.0 * of_limit / (dt * dt), damping: 0.0 };
            let damped = LinkLoad { stiffness: 0.0, damping: 2.0 * of_limit / dt };
            for load in [stiff, damped] {
                let [whole, crushed] = [false, true].map(|is_crushed| parts(load, is_crushed, dt));
                assert!(crushed >= whole, "{load:?}: {crushed} parts of crushed cells, {whole} of others");
                let part = 1.0 / f64::from(crushed);
                let share = part * part * (0.5 * MAX_PUSH_LOAD) + PUSH_DAMPER_SHARE + load.share_of_limit(part * dt);
                assert!(share <= 1.0, "{load:?}: {share} of the limit");
            }
            let [whole, crushed] = [false, true].map(|is_crushed| parts(damped, is_crushed, dt));
            assert!(tenths != 7 || [whole, crushed] == [1, 2], "{whole} and {crushed} parts");
            assert_eq!(parts(stiff, true, dt), parts(stiff, false, dt), "stiff links leave the push its room");
        }
    }

    #[test]
    fn no_vibration_is_faster_than_the_bound_and_some_are_nearly_as_fast() {
        let top = PinBox { min: [-1.0, 0.4, -1.0], max: [1.0; 3] };
        for pins in [Vec::new(), vec![top]] {
            let simulation = cube(4, pins);
            let (body, rest) = (&simulation.model().bodies[0], &simulation.state().position);
            let mut rng = Rng::new(8);
            for noise in [0.0, 0.05, 0.2, 2.0] {
                let shaken = |x: &DVec3| *x * 1.2 + noise * DVec3::from([0; 3].map(|_| rng.between(-1.0, 1.0)));
                let position: Vec<DVec3> = rest.iter().map(shaken).collect();
                let LinkLoad { stiffness, damping } = load_of(body, &position);
                let found = fastest(body, &position);
                for (bound, found) in [stiffness, damping].into_iter().zip(found) {
                    let share = found / bound;
                    assert!((0.4..=1.0 + 1e-9).contains(&share), "{noise}: {found} of {bound}");
                }
            }
        }
    }

    #[test]
    fn a_body_at_rest_bears_a_third_of_any_state_however_it_is_turned() {
        let simulation = cube(6, Vec::new());
        let (body, rest) = (&simulation.model().bodies[0], &simulation.state().position);
        let at_rest = load_of(body, rest);
        let [stiffness, damping] = any_state::own_rates(body).map(|rate| 6.0 * rate);
        for (found, any) in [(at_rest.stiffness, stiffness), (at_rest.damping, damping)] {
            // Links of particles on the outside do not point everywhere alike.
            assert!((0.333..0.35).contains(&(found / any)), "{found} of {any}");
        }
        let turn = DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 1.0);
        let stretched: Vec<DVec3> = rest.iter().map(|x| *x * DVec3::new(1.5, 0.8, 1.0)).collect();
        let turned: Vec<DVec3> = stretched.iter().map(|x| turn * *x).collect();
        let [one, other] = [&stretched, &turned].map(|position| load_of(body, position));
        for (one, other) in [(one.stiffness, other.stiffness), (one.damping, other.damping)] {
            assert!((one / other - 1.0).abs() < 1e-9, "{one} and {other}");
        }
    }

    #[test]
    fn links_that_line_up_or_have_ends_in_one_place_are_borne_as_in_any_state_at_most() {
        let simulation = cube(3, Vec::new());
        let (body, rest) = (&simulation.model().bodies[0], &simulation.state().position);
        let [most, _] = any_state::own_rates(body).map(|rate| 6.0 * rate);
        let flat: Vec<DVec3> = rest.iter().map(|x| *x * DVec3::new(1.0, 0.0, 0.0)).collect();
        for (position, share) in [(flat, 0.5), (vec![DVec3::ZERO; rest.len()], 1.0)] {
            let borne = load_of(body, &position).stiffness / most;
            assert!(borne >= share - 1e-9 && borne <= 1.0 + 1e-9, "{borne}");
        }
    }

    #[test]
    fn the_largest_eigenvalue_of_a_known_matrix() {
        let turn = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 2.0) / 3.0, 0.9);
        for ([a, b, c], is_exact) in [([5.0, 1.0, 1.0], true), ([2.0; 3], true), ([5.0, 4.0, 0.5], false)] {
            let m = turn * DMat3::from_diagonal(DVec3::new(a, b, c)) * turn.transpose();
            let bound = largest_eigenvalue(&[m.x_axis.x, m.y_axis.y, m.z_axis.z, m.y_axis.z, m.z_axis.x, m.x_axis.y]);
            let most = if is_exact { a + 1e-12 } else { 1.2 * a };
            assert!((a - 1e-12..=most).contains(&bound), "{bound}, not {a}");
        }
    }
}
