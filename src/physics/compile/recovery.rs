//! How strongly cells resist inversion: the constants of [`crate::physics::forces::recovery`], from those of the links.

use crate::geometry::{Family, Lattice};
use crate::math::Real;
use crate::physics::limits::cells::CellLoads;
use crate::physics::limits::present::MAX_PUSH_LOAD;
use crate::physics::model::levels::min_filled_share;
use crate::physics::model::plan::Plan;
use crate::physics::model::{BodyModel, CellKind, RecoveryModel, Scheme};

/// The stiffness of the pull over that of the push, at most.
const PULL_SHARE: f64 = 1.0;

/// The constants of recovery for a stiffness (N·m) and a mass (kg) against inversion, not limited by what a substep bears.
/// They hold for the implicit scheme, whose equations contain recovery and give links as much resistance as flowing would.
pub(super) fn unlimited<R: Real>([stiffness, mass]: [f64; 2]) -> RecoveryModel<R> {
    let stiffness = R::from_f64(stiffness);
    let pull = stiffness * R::from_f64(PULL_SHARE);
    RecoveryModel { stiffness, mass: R::from_f64(mass), push: stiffness, pull, flow_secs: R::ZERO }
}

/// Limits push and pull of a body to what whole substeps of an explicit scheme bear.
///
/// With `x = κ dt²/(m h²)` for a push of stiffness κ, the limit of 4 is taken up by at most 2 x from links, less than 2 x
/// from the push on cells whose neighbours are well, and 4 p x from a pull of stiffness p κ.
pub(super) fn limit_to_substep<R: Real>(body: &mut BodyModel<R>, plan: &Plan) {
    if plan.scheme == Scheme::Implicit {
        return;
    }
    let RecoveryModel { stiffness, mass, .. } = body.recovery;
    let secs = plan.recovery_secs();
    let dt = R::from_f64(secs);
    let inverse = body.inverse_cell_size * dt;
    let push = stiffness.min(R::from_f64(MAX_PUSH_LOAD) * mass / (inverse * inverse));
    let inverse = body.inverse_cell_size.to_f64() * secs;
    let load = stiffness.to_f64() * inverse * inverse / mass.to_f64();
    let pull = stiffness * R::from_f64((1.0 / load - 1.0).clamp(0.0, PULL_SHARE));
    body.recovery = RecoveryModel { stiffness, mass, push, pull, flow_secs: dt };
}

/// A cell's stiffness against inversion, N·m, and the mass against it, kg, from the constants of springs.
///
/// A mode of wave number q along an axis changes V by `2 sin(q/2)/h` of its amplitude, so recovery adds at most `4 κ/(m h²)`
/// to the square of a frequency, and links add at most `(4 k1 + 8.74 k2 + 2 k3)/(m h)`. With
/// `κ = h (4 k1 + 8.74 k2 + 2 k3)/2` the sum stays below the limit with the margin of automatic stepping. For equal
/// constants this κ is 7.4 k h; from half of it on every crushed cube came back, at more than twice of it crumpled ones
/// gained energy. A family without links in `lattice` limits no step and is left out. Of several kinds the softest counts:
/// soft cells that are pushed as hard as stiff ones would throw their links far.
pub(super) fn of_springs(kinds: &[CellKind], lattice: &Lattice) -> [f64; 2] {
    let links = |kind: &CellKind| {
        let share = |family: Family, share: f64| {
            let has_links = !lattice.links[family as usize].is_empty();
            if has_links { share * kind.stiffness[family as usize] } else { 0.0 }
        };
        share(Family::Structural, 4.0) + share(Family::Shear, 8.736) + share(Family::Bending, 2.0)
    };
    let lightest = kinds.iter().map(|kind| kind.mass).fold(f64::INFINITY, f64::min);
    let least = kinds.iter().map(links).fold(f64::INFINITY, f64::min);
    [0.5 * least * lattice.grid.cell_size, lightest]
}

/// The same for cells of solids, which share out links and masses. A cell of mass M on its own has `12 κ/(M h²)`, as if its
/// particles weighed a third of M; its links add at most `loads.stiffness`.
pub(super) fn of_cells(kinds: &[CellKind], lattice: &Lattice) -> [f64; 2] {
    let cell_size = lattice.grid.cell_size;
    let lightest = kinds.iter().map(|kind| kind.mass).fold(f64::INFINITY, f64::min) * min_filled_share(lattice) / 3.0;
    [0.5 * CellLoads::of(kinds, cell_size).stiffness * lightest * cell_size * cell_size, lightest]
}
