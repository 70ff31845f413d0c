//! Recovery from inversion (S7; the "broken cube" of GC §10): springs alone have mirrored minima, in which crushed
//! cells stay inside out for ever.
//!
//! With the means a, b, c of a cell's four edges along each axis and its cell size h, the signed volume
//! `V = a·(b×c)/h³` is 1 at rest and not above 0 when the cell is inverted. Below [`THRESHOLD`] the cell pushes back:
//!
//! ```text
//!       6───────7         force on the mean edge a, cyclic in a, b, c:
//!      /│      /│         f_a = κ min(T − V, 2) (b×c)/h³ / max(1, largest face/h²)
//!     4───────5 │  y      each of the four ends of an axis takes a quarter; the others the opposite
//!     │ 2─────│─3  │
//!     │/      │/   └─ x   T = 0.3
//!     0───────1  z
//! ```
//!
//! One common cap for all three keeps momentum and angular momentum; without it the push would grow with the fourth
//! power of an edge. A cell that is on its way back is pushed half as hard as one on its way in: what it takes from
//! a blow it does not give back in full, so that crushed bodies come to rest rather than gain energy. The size of κ
//! follows from the links (`of_springs`, `of_cells`), so that the term costs no smaller step.
//!
//! Only the cells of a list are pushed: those below [`WATCH`]. All cells are looked at once in every 1/60 s of simulated
//! time, sooner where particles move past each other fast enough to crush a cell in that time, and in every substep while the list is not empty, as a cell that inverted unseen would be given energy; a body
//! that is well costs nothing but those few looks. The list is part of the [`State`]: the motion follows from the
//! state alone.
//!
//! The push alone does not turn every body back whose families are far apart: the two sublattices that shear links
//! alone make of it, for one, hold their mirror images against any push that the step could bear. There
//! the links between particles of crushed cells lose their elastic force by and by, all but 1 % where V ≤ 0 and the
//! families are furthest apart, and get a damping of `k dt/2` in its place: they flow while the volume turns over and
//! are springs again as soon as it has. Link forces act in pairs along the link: momentum and angular momentum stay.
//! A body whose families are alike, or of little but bending links, is moved by the push alone.
//!
//! Measured with 9 ways to break a cube and the 6 ways in which families can be 1e4 apart, over 5 to 10
//! particles an edge, free, held and on rough ground, with three integrators: of 594 cubes 54 stay broken (by up to
//! 187 cells) with the push alone, 11 (by one or two cells) with soft links, and none flies apart.
//!
//! What does not come back for certain is a body of shear links alone, or of shear and bending links, that was crushed
//! to a point: in 19 of 36 such cubes (5 to 10 particles an edge, three random starts) one to five cells stay in a
//! knot, and the volume is blind to more: in each of the two sublattices about a fifth of the tetrahedra of such a cube are
//! mirrored.

use super::cell_bound::CellLoads;
use super::forces::link_force;
use super::model::{BodyModel, CellKind, Model};
use super::plan::Plan;
use super::report::StepReport;
use super::state::{BodyMemory, State};
use crate::geometry::Lattice;
use crate::math::{Real, Vector};
use crate::scene::{Family, Springs};

/// A cell below this signed volume is pushed back to shape.
pub const THRESHOLD: f64 = 0.3;

/// Cells below this signed volume are put on the list: what inverts between two looks has mostly been here before.
pub const WATCH: f64 = 0.7;

/// The push stops growing this far below the threshold.
const DEEPEST: f64 = 2.0;

/// Simulated time between two looks at all cells, s, in a body that is calm.
const LOOK_SECS: f64 = 1.0 / 60.0;

/// Two particles of a body move past each other by no more than this between two looks, cell sizes: a cell that was not
/// on the list then is still above the threshold, even if it is crushed along all its axes at once.
const UNSEEN_SHARE: f64 = 0.2;

/// The share of the push that is left while a cell is on its way back.
const RETURNED: f64 = 0.5;

/// The most of `κ dt²/(m h²)`: a person's own step or an implicit one may be larger than the push could bear.
const STIFFEST: f64 = 0.6;

/// The share of their elastic force that links between particles of inverted cells lose in a body whose families are
/// far apart. All of it would leave nothing to put a body in order that was crushed to a point.
const SOFTEST: f64 = 0.99;

/// The damping that such links get instead, over `k dt`. In semi-implicit Euler a half limits the step as much as the
/// elastic force that was taken away; at three quarters Verlet, which counts it twice, kept cubes broken.
const FLOW: f64 = 0.5;

/// Strains from and to which links keep ever more of their force: what flies apart unhindered comes back with more
/// energy than it left with; crumpled cubes blew up.
const TAUT: [f64; 2] = [0.5, 2.0];

/// A cell's stiffness against inversion, N·m, and the mass against it, kg, from the constants of links that are alike.
///
/// A mode of wave number q along an axis changes V by `2 sin(q/2)/h` of its amplitude, so the term adds at most
/// `4 κ/(m h²)` to the square of a frequency, and the links at most `(4 k1 + 8.74 k2 + 2 k3)/(m h)`. Half of the latter
/// keeps the sum below the limit at the share of it that automatic stepping takes. For equal constants it is 7.4 k h;
/// from half of that on every crushed cube came back, at more than twice of it crumpled ones gained energy. A family
/// without links in `lattice` limits no step and so has no share.
pub(super) fn of_springs(springs: &Springs, lattice: &Lattice) -> [f64; 2] {
    let share = |family: Family, share: f64| {
        let has_links = !lattice.links[family as usize].is_empty();
        if has_links { share * springs.family(family).stiffness } else { 0.0 }
    };
    let links = share(Family::Structural, 4.0) + share(Family::Shear, 8.736) + share(Family::Bending, 2.0);
    [0.5 * links * lattice.grid.cell_size, springs.particle_mass]
}

/// The same from cells that share out their links and masses. On its own a cell of mass M moves with `12 κ/(M h²)`, as if
/// its particles weighed a third of it; its links add at most `loads.stiffness`.
pub(super) fn of_cells(kinds: &[CellKind], cell_size: f64) -> [f64; 2] {
    let lightest = kinds.iter().map(|kind| kind.mass).fold(f64::INFINITY, f64::min) / 3.0;
    [0.5 * CellLoads::of(kinds, cell_size).stiffness * lightest * cell_size * cell_size, lightest]
}

/// Room that links of crushed cells are softened in; empty where no body's links are.
#[derive(Clone, Debug)]
pub(super) struct Scratch<R: Real> {
    /// For each particle of the body at hand the share of elastic force that its links lose.
    softness: Vec<R>,
}

impl<R: Real> Scratch<R> {
    /// Room for the largest body of a model whose links may be softened.
    pub(super) fn new(model: &Model<R>) -> Self {
        let soft = model.bodies.iter().filter(|body| softest(body) > R::ZERO);
        Self { softness: vec![R::ZERO; soft.map(|body| body.particles.len()).max().unwrap_or(0)] }
    }
}

/// Whether all cells are looked at in this substep.
pub(super) fn is_due<R: Real>(model: &Model<R>, plan: &Plan, state: &State<R>) -> bool {
    let between_looks = model.bodies.iter().fold(LOOK_SECS, |secs, body| secs.min(unseen_secs(body, state)));
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count of at least one, saturating")]
    let every = libm::round(between_looks / plan.substep_secs()).max(1.0) as u64;
    let number = state.steps.wrapping_mul(u64::from(plan.substeps)).wrapping_add(u64::from(state.substep));
    number % every == 0 || !plan.lean || state.bodies.iter().any(BodyMemory::is_watched)
}

/// How long a body's cells may stay unseen as fast as its particles move past each other now, s.
fn unseen_secs<R: Real>(body: &BodyModel<R>, state: &State<R>) -> f64 {
    let velocity = &state.velocity[body.particles.clone()];
    // Bounds of the components: cheap, and no larger than the differences between particles.
    let Some(&first) = velocity.first() else { return LOOK_SECS };
    let (low, high) = velocity.iter().fold((first, first), |(low, high), v| (low.min(*v), high.max(*v)));
    let fastest = (high - low).length().to_f64();
    if fastest > 0.0 { UNSEEN_SHARE / (body.inverse_cell_size.to_f64() * fastest) } else { LOOK_SECS }
}

/// Looks at all cells and writes down those that are near inversion.
pub(super) fn look<R: Real>(model: &Model<R>, state: &mut State<R>, report: &mut StepReport) {
    let watch = R::from_f64(WATCH);
    for (body, memory) in model.bodies.iter().zip(&mut state.bodies).filter(|(_, memory)| !memory.asleep) {
        memory.near_inversion.clear();
        if body.recovery_stiffness <= R::ZERO {
            continue;
        }
        let position = &state.position[body.particles.clone()];
        report.cells_looked_at += body.lattice.cells.len() as u64;
        for (number, corners) in (0u32..).zip(&body.lattice.cells) {
            if MeanEdges::of(position, corners, body.inverse_cell_size).volume() < watch {
                memory.near_inversion.push(number);
            }
        }
    }
}

#[expect(clippy::too_many_arguments, reason = "the parts of one substep, split borrow by borrow")]
/// Adds the push of the cells on the lists in `memory`, N.
pub(super) fn add_forces<R: Real>(
    model: &Model<R>,
    plan: &Plan,
    position: &[R::Vec3],
    velocity: &[R::Vec3],
    memory: &[BodyMemory],
    force: &mut [R::Vec3],
    scratch: &mut Scratch<R>,
    report: &mut StepReport,
) {
    let dt = R::from_f64(plan.substep_secs());
    for (body, memory) in model.bodies.iter().zip(memory).filter(|(_, memory)| !memory.asleep) {
        let position = &position[body.particles.clone()];
        let velocity = &velocity[body.particles.clone()];
        let force = &mut force[body.particles.clone()];
        report.recovery_cells += memory.near_inversion.len() as u64;
        soften(body, &memory.near_inversion, position, velocity, dt, scratch, force);
        let stiffness = bearable_stiffness(plan, body) * body.inverse_cell_size;
        for &cell in &memory.near_inversion {
            let corners = &body.lattice.cells[cell as usize];
            let edges = MeanEdges::of(position, corners, body.inverse_cell_size);
            let rates = mean_edges(velocity, corners, R::ONE);
            let Some(push) = edges.push(&rates, stiffness) else { continue };
            for (place, &corner) in corners.iter().enumerate() {
                let quarter = R::from_f64(0.25);
                for (axis, push) in push.into_iter().enumerate() {
                    let share = if place >> axis & 1 == 1 { quarter } else { -quarter };
                    force[corner as usize] += push * share;
                }
            }
        }
    }
}

/// Takes from the links between particles of crushed cells most of their elastic force and lets them flow instead: the
/// links of a mirrored cell would hold it in its mirror image, and springs that are only weakened would give back more
/// than they took when they strengthen again.
fn soften<R: Real>(
    body: &BodyModel<R>,
    cells: &[u32],
    position: &[R::Vec3],
    velocity: &[R::Vec3],
    dt: R,
    scratch: &mut Scratch<R>,
    force: &mut [R::Vec3],
) {
    let softest = softest(body);
    if softest <= R::ZERO {
        return;
    }
    let crushed = |&cell: &u32| {
        let corners = &body.lattice.cells[cell as usize];
        let missing = R::from_f64(THRESHOLD) - MeanEdges::of(position, corners, body.inverse_cell_size).volume();
        let share = softest * (missing * R::from_f64(1.0 / THRESHOLD)).min(R::ONE);
        (missing.is_finite() && missing > R::ZERO).then_some((corners, share))
    };
    let mut crushed = cells.iter().filter_map(crushed).peekable();
    if crushed.peek().is_none() {
        return;
    }
    let softness = &mut scratch.softness[..position.len()];
    softness.fill(R::ZERO);
    for (corners, share) in crushed {
        for &corner in corners {
            softness[corner as usize] = softness[corner as usize].max(share);
        }
    }
    for family in &body.links {
        let flow = family.stiffness * dt * R::from_f64(FLOW);
        for link in &family.links {
            let [i, j] = link.ends.map(|end| end as usize);
            let softness = softness[i].min(softness[j]);
            if softness > R::ZERO {
                let (d, dv) = (position[j] - position[i], velocity[j] - velocity[i]);
                let strain = d.length() * link.inverse_rest_length - R::ONE;
                let stretched = (strain - R::from_f64(TAUT[0])) * R::from_f64(1.0 / (TAUT[1] - TAUT[0]));
                let share = softness * (R::ONE - stretched).max(R::ZERO).min(R::ONE);
                let on_i = link_force(d, dv, link.inverse_rest_length, family.stiffness, -flow) * share;
                force[i] -= on_i;
                force[j] += on_i;
            }
        }
    }
}

/// The share of their elastic force that links between inverted cells' particles lose: it grows with how far structural
/// and shear links are apart. Where bending outweighs both, the push alone turns cells back, and soft links would give a
/// body energy; links that cells share out are never far apart.
fn softest<R: Real>(body: &BodyModel<R>) -> R {
    let [structural, shear, bending] = [0, 1, 2].map(|family: usize| body.links[family].stiffness);
    let most = structural.max(shear).max(bending);
    if most > R::ZERO && body.cell_kinds.is_empty() {
        R::from_f64(SOFTEST) * ((structural - shear).max(shear - structural) / most)
    } else {
        R::ZERO
    }
}

/// The stiffness of a body's cells as far as the substep bears it, N·m.
fn bearable_stiffness<R: Real>(plan: &Plan, body: &BodyModel<R>) -> R {
    let dt = R::from_f64(plan.substep_secs());
    let inverse = body.inverse_cell_size * dt;
    body.recovery_stiffness.min(R::from_f64(STIFFEST) * body.recovery_mass / (inverse * inverse))
}

/// Energy of the push of a body's cells, J. The cap on far-stretched cells follows no potential: their share is the
/// work that the present push would do.
pub(super) fn energy<R: Real>(plan: &Plan, body: &BodyModel<R>, state: &State<R>) -> f64 {
    let position = &state.position[body.particles.clone()];
    let energy_of = |corners: &[u32; 8]| {
        let edges = MeanEdges::of(position, corners, body.inverse_cell_size);
        let missing = THRESHOLD - edges.volume().to_f64();
        if missing <= 0.0 {
            return 0.0;
        }
        let sprung = missing.min(DEEPEST);
        sprung * (missing - 0.5 * sprung) / edges.cap().to_f64()
    };
    bearable_stiffness(plan, body).to_f64() * body.lattice.cells.iter().map(energy_of).sum::<f64>()
}

/// The signed volume of a cell over that at rest; not above zero where it is inverted.
pub(super) fn volume<R: Real>(body: &BodyModel<R>, position: &[R::Vec3], corners: &[u32; 8]) -> f64 {
    MeanEdges::of(position, corners, body.inverse_cell_size).volume().to_f64()
}

/// The differences of some quantity along a cell's three axes, the mean of the four edges each.
#[inline]
fn mean_edges<R: Real>(of: &[R::Vec3], corners: &[u32; 8], scale: R) -> [R::Vec3; 3] {
    let at = corners.map(|corner| of[corner as usize]);
    // Neighbours first: far from the origin their difference is exact, sums of positions would not be.
    let mean = |ends: [[usize; 2]; 4]| {
        let edge = |[low, high]: [usize; 2]| at[high] - at[low];
        ((edge(ends[0]) + edge(ends[1])) + (edge(ends[2]) + edge(ends[3]))) * (R::from_f64(0.25) * scale)
    };
    [
        mean([[0, 1], [2, 3], [4, 5], [6, 7]]),
        mean([[0, 2], [1, 3], [4, 6], [5, 7]]),
        mean([[0, 4], [1, 5], [2, 6], [3, 7]]),
    ]
}

/// The first of the mean edges along a cell's axes, and the cross products of the other two, in cell sizes.
struct MeanEdges<R: Real> {
    first: R::Vec3,
    faces: [R::Vec3; 3],
}

impl<R: Real> MeanEdges<R> {
    #[inline]
    fn of(position: &[R::Vec3], corners: &[u32; 8], inverse_cell_size: R) -> Self {
        let [a, b, c] = mean_edges(position, corners, inverse_cell_size);
        Self { first: a, faces: [b.cross(c), c.cross(a), a.cross(b)] }
    }

    #[inline]
    fn volume(&self) -> R {
        self.first.dot(self.faces[0])
    }

    /// The largest face, at least 1: what the push is divided by.
    fn cap(&self) -> R {
        self.faces.iter().fold(R::ONE, |largest, face| largest.max(face.length()))
    }

    /// The forces on the three mean edges for a stiffness over the cell size, N; none above the threshold, or where a
    /// cell is so far stretched that its volume is no number.
    #[inline]
    fn push(&self, rates: &[R::Vec3; 3], stiffness: R) -> Option<[R::Vec3; 3]> {
        let missing = R::from_f64(THRESHOLD) - self.volume();
        if !missing.is_finite() || missing <= R::ZERO {
            return None;
        }
        let growth = (0..3).fold(R::ZERO, |sum, axis| sum + rates[axis].dot(self.faces[axis]));
        let returned = if growth > R::ZERO { R::from_f64(RETURNED) } else { R::ONE };
        let strength = stiffness * returned * missing.min(R::from_f64(DEEPEST)) / self.cap();
        Some(self.faces.map(|face| face * strength)).filter(|push| push.iter().all(|force| force.is_finite()))
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    const CORNERS: [u32; 8] = [0, 1, 2, 3, 4, 5, 6, 7];

    fn cell(scale: DVec3) -> Vec<DVec3> {
        (0..8u32).map(|p| DVec3::new(f64::from(p & 1), f64::from(p >> 1 & 1), f64::from(p >> 2)) * scale).collect()
    }

    fn edges(scale: DVec3) -> MeanEdges<f64> {
        MeanEdges::of(&cell(scale), &CORNERS, 1.0)
    }

    #[test]
    fn the_volume_is_signed() {
        assert!((edges(DVec3::ONE).volume() - 1.0).abs() < 1e-15, "one at rest");
        assert!((edges(DVec3::new(2.0, 1.0, -1.0)).volume() + 2.0).abs() < 1e-15, "negative when mirrored");
    }

    #[test]
    fn only_what_is_crushed_is_pushed_and_never_without_bound() {
        assert!(
            edges(DVec3::new(1.0, 1.0, 0.31)).push(&[DVec3::ZERO; 3], 1.0).is_none(),
            "above the threshold there is no force"
        );
        let flat = edges(DVec3::new(1.0, 1.0, 0.1)).push(&[DVec3::ZERO; 3], 1.0).expect("a flat cell is pushed");
        assert!((flat[2] - DVec3::Z * 0.2).length() < 1e-15, "outward along the short edge: {flat:?}");
        let returning = [DVec3::ZERO, DVec3::ZERO, DVec3::Z];
        let back = edges(DVec3::new(1.0, 1.0, 0.1)).push(&returning, 1.0).expect("a flat cell is pushed");
        assert!((back[2] * 2.0 - flat[2]).length() < 1e-15, "half as hard on its way back: {back:?}");
        for size in [1.0, 10.0, 1e3] {
            let far =
                edges(DVec3::new(size, size, -size)).push(&[DVec3::ZERO; 3], 1.0).expect("a mirrored cell is pushed");
            assert!(far.iter().all(|f| f.length() <= 2.0 + 1e-12), "{size} times the size: {far:?}");
        }
    }
}
