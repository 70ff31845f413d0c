//! What steps of a scheme make of stiffness and damping: a load that has a limit, and the margin to it that automatic
//! stepping keeps.

use crate::geometry::Family;
use crate::physics::model::{ContactRule, Scheme};
use crate::physics::schemes::chebyshev::{DISC_RADIUS, MOST_STAGES, reach};

/// The share of the step bounded at rest by stiffness alone that automatic stepping takes, which covers crumpled bodies.
pub const SAFETY: f64 = 0.55;

/// The same of a step of semi-implicit Euler that the damping of a family alone bounds: structural, shear, bending. A link
/// resists along itself with no more than its damping however long it is, and shear links hold a cell in shape. Not of
/// Verlet's, which predicts the velocity from how the links pointed before.
pub(in crate::physics) const DAMPING_SAFETY: [f64; 3] = [SAFETY, 0.9, 0.85];

/// Shear links hold the angles of a cell if they are stiffer than this share of the stiffest other links: then links of
/// different directions do not line up unseen, which would be damped several times as fast together.
pub(in crate::physics) const HOLDING_SHARE: f64 = 0.05;

/// The share of the disc that the stabilised scheme takes. However a body is crumpled, stiffness and damping of a link point
/// the same way: only across links that are stretched is there stiffness alone, and those are watched.
const DISC_SAFETY: f64 = 0.9;

/// The largest eigenvalue of `M⁻¹ (dt² K + 2 dt C)` with which motion stays bounded.
pub(in crate::physics) const LATTICE_LIMIT: f64 = 4.0;

/// Where in the complex plane dt times an eigenvalue of the motion may lie, by scheme.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Region {
    /// The leapfrog family: `dt² ω² + 2 s dt c < 4` with a share s of the damping, 1 for semi-implicit Euler and 2 where
    /// the velocity of the damping is predicted.
    Leapfrog(f64),
    /// Half a disc of this radius. An eigenvalue is no larger than the larger of ω and c, whichever way damping and
    /// stiffness mix.
    HalfDisc(f64),
    /// A disc that touches 0, in which everything lies whose stiffness is no more than so much of its damping, and the
    /// negative axis as far as the most stages reach ([`super::stabilised`]).
    DiscAndAxis,
    /// Everything: links are part of the equations that are solved.
    Everywhere,
}

impl Region {
    pub(super) fn of(scheme: Scheme) -> Self {
        match scheme {
            Scheme::SemiImplicit => Self::Leapfrog(1.0),
            Scheme::Verlet => Self::Leapfrog(2.0),
            // Largest half disc within |1 + z + z²/2 + z³/6 + z⁴/24| ≤ 1, whose ends are 2.828 i and −2.785.
            Scheme::Rk4 => Self::HalfDisc(2.61),
            // Beyond −2 both blow up for certain; below, undamped vibrations still grow, slowly.
            Scheme::Explicit | Scheme::Rk2 => Self::HalfDisc(2.0),
            Scheme::Stabilised => Self::DiscAndAxis,
            Scheme::Implicit => Self::Everywhere,
        }
    }
}

/// How much of the stiffness (1/s²) and of the damping (1/s) of a vibration adds to its load, which stays bounded up to
/// [`LATTICE_LIMIT`].
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct LoadShare {
    /// s².
    pub(in crate::physics) stiffness: f64,
    /// Of each family, s.
    pub(in crate::physics) damping: [f64; 3],
    /// Of contact where it pushes at the stages of the scheme, s.
    pub(in crate::physics) pushes: f64,
}

impl LoadShare {
    /// For steps of `dt` (s) of the default scheme, semi-implicit Euler.
    pub(in crate::physics) fn of_default(dt: f64) -> Self {
        Self { stiffness: dt * dt, damping: [2.0 * dt; 3], pushes: 0.0 }
    }

    /// Of the damping of cells that share out their links, s: whichever family it is of.
    pub(in crate::physics) fn damping_of_cells(&self) -> f64 {
        self.damping[Family::Structural as usize]
    }
}

/// What the links of a body add at most to its load, whichever way it vibrates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinkLoad {
    /// To the square of a frequency, 1/s².
    pub stiffness: f64,
    /// To a rate of damping, 1/s.
    pub damping: f64,
}

impl LinkLoad {
    /// A share of it.
    pub(in crate::physics) fn times(self, share: f64) -> Self {
        Self { stiffness: share * self.stiffness, damping: share * self.damping }
    }

    /// The larger of two loads, each part by itself.
    pub(in crate::physics) fn larger_of(self, other: Self) -> Self {
        Self { stiffness: self.stiffness.max(other.stiffness), damping: self.damping.max(other.damping) }
    }

    /// Whether steps of `dt` (s) of a scheme bear it with a margin.
    pub(super) fn is_borne(&self, scheme: Scheme, dt: f64, margin: Margin) -> bool {
        let longer = dt / margin.stiffness;
        // Across a link that is stretched nothing damps: there the stabilised scheme is no better than RK2.
        let across = if scheme == Scheme::Stabilised { longer * longer * self.stiffness } else { 0.0 };
        let of_links = |share: LoadShare| self.stiffness * share.stiffness + self.damping * share.damping_of_cells();
        across <= LATTICE_LIMIT
            && load_shares(scheme, dt, margin).into_iter().flatten().map(of_links).all(|load| load <= LATTICE_LIMIT)
    }
}

/// The shares of the step bounded at rest that automatic stepping takes: where stiffness bounds it, and where the damping
/// of each family does. Where several do, each adds to the load as if the step were longer by its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::physics) struct Margin {
    pub(super) stiffness: f64,
    pub(super) damping: [f64; 3],
}

impl Margin {
    /// All of the bound.
    pub(in crate::physics) const NONE: Self = Self { stiffness: 1.0, damping: [1.0; 3] };

    /// The same share of everything.
    pub(super) const fn alike(share: f64) -> Self {
        Self { stiffness: share, damping: [share; 3] }
    }

    /// What a scheme keeps of a body whose cells' angles are held, or are not.
    pub(in crate::physics) fn of(scheme: Scheme, angles_are_held: bool) -> Self {
        let damping = if angles_are_held { DAMPING_SAFETY } else { [SAFETY; 3] };
        match scheme {
            Scheme::SemiImplicit => Self { stiffness: SAFETY, damping },
            Scheme::Stabilised => Self { stiffness: DISC_SAFETY, damping },
            _ => Self::alike(SAFETY),
        }
    }

    /// The load of contact's stiffness (1/s²) in a step of `dt` (s) that nothing else limits, over that stiffness.
    pub(in crate::physics) fn contact_secs2(self, dt: f64) -> f64 {
        let longer = dt / self.stiffness;
        longer * longer
    }
}

/// Whether links of such stiffness by family hold the angles of cells.
pub(in crate::physics) fn angles_are_held([structural, shear, bending]: [f64; 3]) -> bool {
    shear > HOLDING_SHARE * structural.max(bending)
}

/// The loads that each have to stay below their limit for steps of `dt` (s) of a scheme with a margin; none where links do
/// not limit it.
pub(in crate::physics) fn load_shares(
    scheme: Scheme,
    dt: f64,
    margin: Margin,
) -> Option<impl Iterator<Item = LoadShare>> {
    const NOTHING: LoadShare = LoadShare { stiffness: 0.0, damping: [0.0; 3], pushes: 0.0 };
    let (of_stiffness, of_damping) = (dt / margin.stiffness, margin.damping.map(|share| dt / share));
    let shares = match Region::of(scheme) {
        Region::Leapfrog(share) => {
            let damping = of_damping.map(|dt| 2.0 * share * dt);
            [Some(LoadShare { stiffness: of_stiffness * of_stiffness, damping, ..NOTHING }), None]
        }
        Region::HalfDisc(radius) => [
            Some(LoadShare { stiffness: LATTICE_LIMIT * (of_stiffness / radius) * (of_stiffness / radius), ..NOTHING }),
            Some(LoadShare { damping: of_damping.map(|dt| LATTICE_LIMIT * dt / radius), ..NOTHING }),
        ],
        Region::DiscAndAxis => {
            let of_rate = |dt: f64| LATTICE_LIMIT * dt / most_reach();
            [Some(LoadShare { damping: of_damping.map(of_rate), pushes: of_rate(dt), ..NOTHING }), None]
        }
        Region::Everywhere => return None,
    };
    Some(shares.into_iter().flatten())
}

/// How far the most stages of the stabilised scheme reach along the negative axis.
fn most_reach() -> f64 {
    reach(MOST_STAGES)
}

/// How many times its damping (1/s) a stiffness (1/s²) may be in steps of `dt` (s) with a margin, 1/s, with a scheme that
/// asks for that.
pub(in crate::physics) fn most_stiffness_per_damping(scheme: Scheme, dt: f64, margin: Margin) -> Option<f64> {
    (Region::of(scheme) == Region::DiscAndAxis).then(|| DISC_RADIUS * margin.stiffness / dt)
}

/// Whether the springs of contact push at the stages of a scheme and so take their share of its limits.
pub(in crate::physics) fn has_pushes(scheme: Scheme, rule: ContactRule) -> bool {
    Region::of(scheme).has_pushes(rule)
}

impl Region {
    pub(super) fn has_pushes(self, rule: ContactRule) -> bool {
        self == Self::DiscAndAxis && rule != ContactRule::Thesis
    }

    /// The largest step for a vibration with `ω² = λ`.
    pub(super) fn undamped_limit(self, lambda: f64) -> Option<f64> {
        match self {
            Self::Leapfrog(_) => undamped_limit(lambda),
            Self::HalfDisc(radius) => (lambda > 0.0).then(|| radius / lambda.sqrt()),
            Self::DiscAndAxis => (lambda > 0.0).then_some(0.0),
            Self::Everywhere => None,
        }
    }

    /// The largest step for stiffness and damping that are in this proportion, 1/s: as [`Self::undamped_limit`] where the
    /// damping does not matter.
    pub(super) fn stiffness_limit(self, lambda: f64, damping: f64) -> Option<f64> {
        match self {
            Self::DiscAndAxis => (lambda > 0.0).then(|| DISC_RADIUS * damping / lambda),
            _ => self.undamped_limit(lambda),
        }
    }

    /// The largest step for the thesis's explicit contact, which is as a spring is.
    pub(super) fn contact_limit(self, lambda: f64) -> Option<f64> {
        match self {
            Self::Everywhere | Self::DiscAndAxis => undamped_limit(lambda),
            Self::Leapfrog(_) | Self::HalfDisc(_) => self.undamped_limit(lambda),
        }
    }

    /// The largest step for damping with `c = λ`.
    pub(super) fn damped_limit(self, lambda: f64) -> Option<f64> {
        match self {
            Self::Leapfrog(share) => damped_limit(share * lambda),
            Self::HalfDisc(radius) => (lambda > 0.0).then(|| radius / lambda),
            Self::DiscAndAxis => (lambda > 0.0).then(|| most_reach() / lambda),
            Self::Everywhere => None,
        }
    }
}

/// `dt² λ ≤ 4`.
pub(super) fn undamped_limit(lambda: f64) -> Option<f64> {
    (lambda > 0.0).then(|| 2.0 / lambda.sqrt())
}

/// `2 dt λ ≤ 4`.
pub(super) fn damped_limit(lambda: f64) -> Option<f64> {
    (lambda > 0.0).then(|| 2.0 / lambda)
}
