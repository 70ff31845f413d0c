//! The pull on the crushed cells of a body that is stuck: a body that is slow and has inverted cells.
//!
//! In a knot, push and links are in balance, and the volume shows no way out. A pull of a cell's mean edges F, in cell
//! sizes, towards the rotation R nearest to them has no mirrored minimum:
//!
//! ```text
//! W = κ p s(V) |R − F|²/2 / max(1, longest mean edge)      f = −∂W/∂F, no less than half of it on the way back
//! s = ((T − V)/2 T)², at most 1                            p ≤ 1: as much as is paid for, and the substep bears
//! ```
//!
//! The pull keeps momentum, and angular momentum as `R Fᵀ` is symmetric. Three parts follow no potential: the divisor for
//! stretched cells, the bound on what `∂s/∂V` adds (the same as that of the push), and R, which is shortened where no
//! rotation is the nearest. Apart from these the pull gives no more than it takes once it acts. Switching it on brings W of
//! the crushed cells into the body, a few κ each, as none of them may be wider than [`MAX_EDGE_LENGTH`]; in a body of few
//! cells that can be as much as all its links hold. So p only grows as the energy that recovery has taken from the body
//! pays for W, see [`super::account`]. W would be too much for a body in violent motion, so that such a body is never
//! stuck: it must first be so slow for a while that its kinetic energy is negligible beside the energy of a single cell.
//! From then on the pull acts, however the body moves, until none of its cells is crushed, and W is zero, or until one of
//! them is torn apart.

use super::edges::{MAX_PUSH_DEPTH, Strength, VOLUME_THRESHOLD, is_inverted};
use crate::math::{Real, Vector};
use crate::physics::forces::recovery::edges::MeanEdges;
use crate::physics::forces::recovery::rotation::nearest_rotation;
use crate::physics::model::{BodyModel, Composition};
use crate::physics::state::{BodyMemory, RecoveryAccount};

/// The missing volume at which the whole pull acts. The pull grows from zero at the threshold, so that a cell gains no
/// energy as it crosses it.
const FULL_PULL_VOLUME: f64 = 2.0 * VOLUME_THRESHOLD;

/// A body is slow while the root mean square of the rates at which its links change their lengths is at most this share of
/// `√(κ/m)`, the speed at which the push turns the lightest cells over. Its kinetic energy is then negligible beside what an
/// inverted cell could set free. At a mass M above m a rate v counts as `v √(M/m)`, which has the same energy.
const MAX_RMS_LINK_RATE: f64 = 3e-3;

/// The same bound for each single link. It is wider, as links that were crushed to no length tremble for ever: their
/// direction changes at every step.
const MAX_LINK_RATE: f64 = 0.1;

/// How long a body with inverted cells must be slow before it is stuck, s: less than it takes to fall asleep, except for
/// very soft bodies.
const MIN_SLOW_SECS: f64 = 0.1;

/// The same over `h/√(κ/m)`, which is longer in a very soft body: a motion that turns back is slow for less than that.
const MIN_SLOW_TURN_TIMES: f64 = 1.0;

/// The most that either bound asks for, s.
const MAX_SLOW_SECS: f64 = 4.0;

/// A body is torn, not knotted, if a mean edge of a crushed cell is longer than this, cell sizes. W grows with the width,
/// and the volume of so wide a cell, which switches W on and off, changes in no time.
const MAX_EDGE_LENGTH: f64 = 3.0;

/// The extremes of a body's crushed cells.
#[derive(Clone, Copy, Debug)]
pub(super) struct CellExtremes {
    /// The smallest volume.
    smallest: f64,
    /// The longest mean edge of cells below the threshold, cell sizes.
    longest: f64,
}

impl Default for CellExtremes {
    fn default() -> Self {
        Self { smallest: f64::INFINITY, longest: 0.0 }
    }
}

impl CellExtremes {
    /// Takes note of a cell.
    pub(super) fn include<R: Real>(&mut self, edges: &MeanEdges<R>) {
        let volume = edges.volume().to_f64();
        self.smallest = self.smallest.min(volume);
        if volume < VOLUME_THRESHOLD {
            self.longest = self.longest.max(edges.longest().to_f64());
        }
    }
}

/// Updates whether a body is stuck, given the extremes of its cells, before a substep of `secs`.
pub(super) fn update_stuck<R: Real>(
    body: &BodyModel<R>,
    memory: &mut BodyMemory,
    CellExtremes { smallest, longest }: CellExtremes,
    position: &[R::Vec3],
    velocity: &[R::Vec3],
    secs: f64,
) {
    if longest > MAX_EDGE_LENGTH {
        reset(memory);
        return;
    }
    if memory.stuck {
        if smallest >= VOLUME_THRESHOLD {
            reset(memory);
        }
        return;
    }
    // The count begins with an inverted cell.
    if memory.knotted_nanos == 0 && !is_inverted(smallest) {
        return;
    }
    if smallest >= VOLUME_THRESHOLD || !is_slow(body, position, velocity) {
        memory.knotted_nanos = 0;
        return;
    }
    // A cell that trembles about zero volume is inverted half of the time: the count pauses.
    if !is_inverted(smallest) {
        return;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a time of at least one, saturating")]
    let nanos = libm::ceil(secs * 1e9) as u32;
    memory.knotted_nanos = memory.knotted_nanos.saturating_add(nanos);
    let required_secs =
        MIN_SLOW_SECS.max(MIN_SLOW_TURN_TIMES / (turning_speed(body) * body.inverse_cell_size.to_f64()));
    if f64::from(memory.knotted_nanos) >= required_secs.min(MAX_SLOW_SECS) * 1e9 {
        reset(memory);
        memory.stuck = true;
    }
}

/// Switches on as much of the pull of a stuck body as the energy that recovery has taken from it pays for: switching on the
/// whole pull brings W of each crushed cell into the body.
pub(super) fn raise_pull_share<R: Real>(body: &BodyModel<R>, memory: &mut BodyMemory, position: &[R::Vec3]) {
    let RecoveryAccount { taken_j, pull_share } = memory.account;
    if !memory.stuck || pull_share >= 1.0 || taken_j <= 0.0 {
        return;
    }
    let energy_of =
        |cell: &u32| cell_energy(&MeanEdges::of(position, &body.lattice.cells[*cell as usize], body.inverse_cell_size));
    let whole = body.recovery.pull.to_f64() * memory.near_inversion.iter().map(energy_of).sum::<f64>();
    let more = (taken_j / whole).min(1.0 - pull_share);
    if more > 0.0 {
        memory.account = RecoveryAccount { taken_j: taken_j - more * whole, pull_share: pull_share + more };
    }
}

/// Returns the stiffness of the pull on a body's cells, N·m; none for a body that is not stuck.
pub(super) fn stiffness<R: Real>(body: &BodyModel<R>, memory: &BodyMemory) -> Option<R> {
    memory.stuck.then(|| body.recovery.pull * R::from_f64(memory.account.pull_share))
}

/// Marks the body as neither stuck nor about to be.
pub(super) fn reset(memory: &mut BodyMemory) {
    (memory.stuck, memory.knotted_nanos, memory.account.pull_share) = (false, 0, 0.0);
}

/// Returns about how fast the push turns cells over, m/s.
fn turning_speed<R: Real>(body: &BodyModel<R>) -> f64 {
    (body.recovery.stiffness.to_f64() / body.recovery.mass.to_f64()).sqrt()
}

/// Returns the mean mass of a link's ends over that of a particle of the lightest cells, at least 1. Within the lightest
/// cells of a solid a particle weighs three times its mass against the push.
fn heaviness<R: Real>(body: &BodyModel<R>, [i, j]: [usize; 2]) -> R {
    let lightest = match body.composition {
        Composition::Alike => return R::ONE,
        Composition::Solids { .. } => 3.0,
        Composition::Springs { .. } => 1.0,
    };
    ((body.mass(i) + body.mass(j)) / (body.recovery.mass * R::from_f64(2.0 * lightest))).max(R::ONE)
}

/// Whether the links change their lengths slowly, however the body moves and turns as a whole.
fn is_slow<R: Real>(body: &BodyModel<R>, position: &[R::Vec3], velocity: &[R::Vec3]) -> bool {
    let speed = turning_speed(body);
    let most = R::from_f64(MAX_LINK_RATE * MAX_LINK_RATE * speed * speed);
    let count: usize = body.links.iter().map(|family| family.links.len()).sum();
    let most_of_all = R::from_f64(MAX_RMS_LINK_RATE * MAX_RMS_LINK_RATE * speed * speed * count as f64);
    let mut sum = R::ZERO;
    for link in body.links.iter().flat_map(|family| family.links.iter()) {
        let [i, j] = link.ends.map(|end| end as usize);
        let (d, dv) = (position[j] - position[i], velocity[j] - velocity[i]);
        let squared = d.dot(d);
        if squared > R::ZERO {
            let along = d.dot(dv);
            let rate = along * along / squared * heaviness(body, [i, j]);
            sum += rate;
            // In a body that moves a few links tell.
            let may_be_slow = rate <= most && sum <= most_of_all;
            if !may_be_slow {
                return false;
            }
        }
    }
    true
}

/// Returns the forces of the pull on the three mean edges of a cell, N, which change at these rates, m/s; none above the
/// threshold.
pub(super) fn cell_force<R: Real>(
    edges: &MeanEdges<R>,
    rates: &[R::Vec3; 3],
    strength: Strength<R>,
) -> Option<[R::Vec3; 3]> {
    if !edges.is_pushed() {
        return None;
    }
    let (rotation, _) = nearest_rotation::<R>(&edges.edges, &edges.faces);
    let missing: [R::Vec3; 3] = std::array::from_fn(|axis| rotation[axis] - edges.edges[axis]);
    let cap = pull_divisor(edges);
    let misshaped = missing.iter().fold(R::ZERO, |sum, part| sum + part.dot(*part)) / cap;
    let [share, growth] = volume_share(edges.missing_volume());
    let pull = share / cap;
    let push = (misshaped * growth * R::from_f64(0.5)).min(R::from_f64(MAX_PUSH_DEPTH)) / edges.push_divisor();
    let force: [R::Vec3; 3] = std::array::from_fn(|axis| missing[axis] * pull + edges.faces[axis] * push);
    let dot = |with: &[R::Vec3; 3]| (0..3).fold(R::ZERO, |sum, axis| sum + with[axis].dot(force[axis]));
    let size = dot(&force).sqrt();
    let is_there = size > R::ZERO;
    let strength = if is_there { strength.times(size, dot(rates) / size) / size } else { R::ZERO };
    Some(force.map(|force| force * strength)).filter(|force| force.iter().all(|force| force.is_finite()))
}

/// Returns the energy of the pull on a cell for a stiffness of one.
pub(super) fn cell_energy<R: Real>(edges: &MeanEdges<R>) -> f64 {
    if !edges.is_pushed() {
        return 0.0;
    }
    let (_, along) = nearest_rotation::<R>(&edges.edges, &edges.faces);
    let size = edges.edges.iter().fold(0.0, |sum, edge| sum + edge.dot(*edge).to_f64());
    let misshaped = (size + 3.0 - 2.0 * along.to_f64()).max(0.0);
    0.5 * misshaped * volume_share(edges.missing_volume())[0].to_f64() / pull_divisor(edges).to_f64()
}

/// Returns the resistance to a change of the mean edges over the pull's stiffness.
pub(super) fn resistance<R: Real>(edges: &MeanEdges<R>) -> f64 {
    (volume_share(edges.missing_volume())[0] / pull_divisor(edges)).to_f64()
}

/// Returns the share of the pull that acts at a missing volume, and its derivative by that.
fn volume_share<R: Real>(missing: R) -> [R; 2] {
    let part = missing * R::from_f64(1.0 / FULL_PULL_VOLUME);
    if part < R::ONE { [part * part, part * R::from_f64(2.0 / FULL_PULL_VOLUME)] } else { [R::ONE, R::ZERO] }
}

/// Returns the length of the longest mean edge, at least 1: the divisor of the pull.
fn pull_divisor<R: Real>(edges: &MeanEdges<R>) -> R {
    edges.edges.iter().fold(R::ONE, |longest, edge| longest.max(edge.length()))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use glam::DVec3;

    use super::*;
    use crate::math::rng::Rng;
    use crate::physics::compile::compile;
    use crate::scene::body::Inlay;
    use crate::scene::material::Solid;
    use crate::scene::resolve::resolve;
    use crate::scene::{Body, Material, Scene};

    const CORNERS: [u32; 8] = [0, 1, 2, 3, 4, 5, 6, 7];

    /// A cell with these mean edges.
    fn cell([a, b, c]: [DVec3; 3]) -> MeanEdges<f64> {
        let corners = CORNERS.map(|p| a * f64::from(p & 1) + b * f64::from(p >> 1 & 1) + c * f64::from(p >> 2));
        MeanEdges::of(&corners, &CORNERS, 1.0)
    }

    /// Returns crushed and mirrored cells that are not stretched, whose rotation is definite and that meet no bound: there
    /// the pull follows a potential.
    fn crushed_cells() -> impl Iterator<Item = [DVec3; 3]> {
        let mut rng = Rng::new(3);
        let all = std::iter::repeat_with(move || [0; 3].map(|_| DVec3::from([0; 3].map(|_| rng.between(-0.55, 0.55)))));
        let is_definite = |edges: &[DVec3; 3]| {
            let edges = cell(*edges);
            let ([a, b, c], _) = nearest_rotation::<f64>(&edges.edges, &edges.faces);
            let [share, growth] = volume_share(edges.missing_volume());
            (a.dot(b.cross(c)) - 1.0).abs() < 1e-7 && cell_energy(&edges) * growth / share < 0.95 * MAX_PUSH_DEPTH
        };
        all.filter(is_definite).take(100)
    }

    #[test]
    fn the_pull_is_what_its_energy_falls_by() {
        for edges in crushed_cells() {
            let force = cell_force(&cell(edges), &[DVec3::ZERO; 3], Strength::one()).expect("it is crushed");
            for axis in 0..3 {
                for component in 0..3 {
                    let energy = |way: f64| {
                        let mut moved = edges;
                        moved[axis][component] += way;
                        cell_energy(&cell(moved))
                    };
                    let slope = (energy(-1e-5) - energy(1e-5)) / 2e-5;
                    assert!((slope - force[axis][component]).abs() < 2e-3, "{edges:?}: {slope} and {force:?}");
                }
            }
        }
    }

    /// Whether a cube is slow that is stretched at `rate` times the speed at which its lightest cells turn over; `density`
    /// is that of its right half over that of its left half.
    fn stretches_slowly(rate: f64, density: f64) -> bool {
        let solid = Solid { density: 100.0, ..Solid::default() };
        let heavy = Inlay {
            min: [0.0, -9.0, -9.0],
            max: [9.0; 3],
            solid: Solid { density: 100.0 * density, ..solid },
            ..Inlay::default()
        };
        let mut body = Body { material: Material::Solid(solid), inlays: vec![heavy], ..Body::default() };
        body.pose.position = [0.0; 3];
        let lattice = resolve(&body.shape, Path::new("."), &()).expect("a cube").lattice;
        let scene = Scene { bodies: vec![body], ..Scene::default() };
        let (model, _) = compile::<f64>(&scene, &[lattice], &[], None);
        let body = &model.bodies[0];
        let stretching = rate * turning_speed(body) * body.inverse_cell_size;
        let velocity: Vec<DVec3> = body.start.iter().map(|x| DVec3::X * x.x * stretching).collect();
        is_slow(body, &body.start, &velocity)
    }

    #[test]
    fn a_heavy_part_that_moves_is_not_slow_because_light_cells_could_move_faster() {
        assert!(
            stretches_slowly(MAX_RMS_LINK_RATE, 1.0) && !stretches_slowly(4.0 * MAX_RMS_LINK_RATE, 1.0),
            "all of it weighs alike"
        );
        assert!(!stretches_slowly(MAX_RMS_LINK_RATE, 1000.0), "half of it has a thousand times the energy");
        assert!(stretches_slowly(MAX_RMS_LINK_RATE / 1000.0_f64.sqrt(), 1000.0), "the energy is the same");
    }

    #[test]
    fn the_pull_turns_nothing_and_ends_at_the_threshold() {
        for edges in crushed_cells() {
            let force = cell_force(&cell(edges), &[DVec3::ZERO; 3], Strength::one()).expect("it is crushed");
            let torque = (0..3).fold(DVec3::ZERO, |sum, axis| sum + edges[axis].cross(force[axis]));
            assert!(torque.length() < 1e-10, "{edges:?}: {torque}");
        }
        let flat = |height: f64| cell([DVec3::X, DVec3::Y, DVec3::Z * height]);
        assert!(cell_force(&flat(0.31), &[DVec3::ZERO; 3], Strength::one()).is_none(), "none above it");
        assert!(cell_energy(&flat(0.299)) < 1e-5, "next to nothing just below it");
    }
}
