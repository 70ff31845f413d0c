//! The load that stiffness and damping put on the steps of a scheme, its limit, and the margin that automatic stepping
//! keeps.

use crate::geometry::Family;
use crate::physics::model::{ContactRule, Scheme};
use crate::physics::schemes::chebyshev::{DISC_RADIUS, MAX_STAGES, reach};

/// The share of the step bounded at rest by stiffness alone that automatic stepping takes, which covers crumpled bodies.
pub const SAFETY: f64 = 0.55;

/// The same share for a step of semi-implicit Euler bounded by the damping of one family alone: structural, shear, bending.
/// A link resists along itself with no more than its damping however long it is, and shear links hold a cell in shape. These
/// shares do not hold for Verlet, which predicts the velocity from how the links pointed before.
pub(in crate::physics) const DAMPING_SAFETY: [f64; 3] = [SAFETY, 0.9, 0.85];

/// Shear links hold the angles of a cell if they are stiffer than this share of the stiffest other links. Then links of
/// different directions do not line up unseen; lined up, they would be damped several times as fast together.
pub(in crate::physics) const HOLDING_SHARE: f64 = 0.05;

/// The share of the disc that the stabilised scheme takes. However a body is crumpled, stiffness and damping of a link point
/// the same way: stiffness without damping acts only across stretched links, and those are watched.
const DISC_SAFETY: f64 = 0.9;

/// The largest eigenvalue of `M⁻¹ (dt² K + 2 dt C)` with which motion stays bounded.
pub(in crate::physics) const LATTICE_LIMIT: f64 = 4.0;

/// Where in the complex plane dt times an eigenvalue of the motion may lie, by scheme.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum StabilityRegion {
    /// The leapfrog family: `dt² ω² + 2 s dt c < 4` with a share s of the damping, 1 for semi-implicit Euler and 2 where
    /// the velocity of the damping is predicted.
    Leapfrog(f64),
    /// Half a disc of this radius. An eigenvalue is no larger than the larger of ω and c, whichever way damping and
    /// stiffness mix.
    HalfDisc(f64),
    /// A disc that touches 0, which holds every vibration whose ratio of stiffness to damping is small enough, and the
    /// negative axis as far as the most stages reach (`physics::schemes::stabilised`).
    DiscAndAxis,
    /// Everything: links are part of the equations that are solved.
    Everywhere,
}

impl StabilityRegion {
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

/// The factors that make the load of a vibration from its stiffness (1/s²) and its damping (1/s). The vibration stays
/// bounded up to a load of [`LATTICE_LIMIT`].
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct LoadShare {
    /// Of the stiffness, s².
    pub(in crate::physics) stiffness: f64,
    /// Of the damping of each family, s.
    pub(in crate::physics) damping: [f64; 3],
    /// Of the damping of contact, if it pushes at the stages of the scheme, s.
    pub(in crate::physics) pushes: f64,
}

impl LoadShare {
    /// Returns the factors for steps of `dt` (s) of the default scheme, semi-implicit Euler.
    pub(in crate::physics) fn of_default(dt: f64) -> Self {
        Self { stiffness: dt * dt, damping: [2.0 * dt; 3], pushes: 0.0 }
    }

    /// Returns the factor for the damping of cells that share out their links, s: the same for every family.
    pub(in crate::physics) fn damping_of_cells(&self) -> f64 {
        self.damping[Family::Structural as usize]
    }
}

/// The most that the links of a body add to its load, in whatever mode it vibrates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinkLoad {
    /// Added to the square of a frequency, 1/s².
    pub stiffness: f64,
    /// Added to a rate of damping, 1/s.
    pub damping: f64,
}

impl LinkLoad {
    /// Returns a share of the load.
    pub(in crate::physics) fn times(self, share: f64) -> Self {
        Self { stiffness: share * self.stiffness, damping: share * self.damping }
    }

    /// Returns the larger of two loads, each part by itself.
    pub(in crate::physics) fn larger_of(self, other: Self) -> Self {
        Self { stiffness: self.stiffness.max(other.stiffness), damping: self.damping.max(other.damping) }
    }

    /// Returns the share of the limit that the load takes up in steps of `dt` (s) of semi-implicit Euler.
    pub(super) fn share_of_limit(self, dt: f64) -> f64 {
        (dt * dt * self.stiffness + 2.0 * dt * self.damping) / LATTICE_LIMIT
    }

    /// Whether steps of `dt` (s) of a scheme bear the load with a margin.
    pub(super) fn is_borne(&self, scheme: Scheme, dt: f64, margin: Margin) -> bool {
        let longer = dt / margin.stiffness;
        // Nothing damps across a stretched link: there the stabilised scheme is no better than RK2.
        let across = if scheme == Scheme::Stabilised { longer * longer * self.stiffness } else { 0.0 };
        let of_links = |share: LoadShare| self.stiffness * share.stiffness + self.damping * share.damping_of_cells();
        across <= LATTICE_LIMIT
            && load_shares(scheme, dt, margin).into_iter().flatten().map(of_links).all(|load| load <= LATTICE_LIMIT)
    }
}

/// The shares of the step bounded at rest that automatic stepping takes: one if stiffness bounds the step, and one for each
/// family if its damping does. If several bound it, each adds to the load as if the step were longer by its own margin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::physics) struct Margin {
    pub(super) stiffness: f64,
    pub(super) damping: [f64; 3],
}

impl Margin {
    /// No margin: the whole bound.
    pub(in crate::physics) const NONE: Self = Self { stiffness: 1.0, damping: [1.0; 3] };

    /// Returns the same share for everything.
    pub(super) const fn alike(share: f64) -> Self {
        Self { stiffness: share, damping: [share; 3] }
    }

    /// Returns the margin of a scheme for a body whose links hold the angles of its cells, or do not.
    pub(in crate::physics) fn of(scheme: Scheme, angles_are_held: bool) -> Self {
        let damping = if angles_are_held { DAMPING_SAFETY } else { [SAFETY; 3] };
        match scheme {
            Scheme::SemiImplicit => Self { stiffness: SAFETY, damping },
            Scheme::Stabilised => Self { stiffness: DISC_SAFETY, damping },
            _ => Self::alike(SAFETY),
        }
    }

    /// Returns the load of contact's stiffness (1/s²) over that stiffness, s², in a step of `dt` (s) that nothing else
    /// limits.
    pub(in crate::physics) fn contact_secs2(self, dt: f64) -> f64 {
        let longer = dt / self.stiffness;
        longer * longer
    }
}

/// Whether links with this stiffness by family hold the angles of cells.
pub(in crate::physics) fn angles_are_held([structural, shear, bending]: [f64; 3]) -> bool {
    shear > HOLDING_SHARE * structural.max(bending)
}

/// Returns the factors of every load that must stay below the limit in steps of `dt` (s) of a scheme with a margin; none if
/// links do not limit the scheme.
pub(in crate::physics) fn load_shares(
    scheme: Scheme,
    dt: f64,
    margin: Margin,
) -> Option<impl Iterator<Item = LoadShare>> {
    const ZERO: LoadShare = LoadShare { stiffness: 0.0, damping: [0.0; 3], pushes: 0.0 };
    let (of_stiffness, of_damping) = (dt / margin.stiffness, margin.damping.map(|share| dt / share));
    let shares = match StabilityRegion::of(scheme) {
        StabilityRegion::Leapfrog(share) => {
            let damping = of_damping.map(|dt| 2.0 * share * dt);
            [Some(LoadShare { stiffness: of_stiffness * of_stiffness, damping, ..ZERO }), None]
        }
        StabilityRegion::HalfDisc(radius) => [
            Some(LoadShare { stiffness: LATTICE_LIMIT * (of_stiffness / radius) * (of_stiffness / radius), ..ZERO }),
            Some(LoadShare { damping: of_damping.map(|dt| LATTICE_LIMIT * dt / radius), ..ZERO }),
        ],
        StabilityRegion::DiscAndAxis => {
            let of_rate = |dt: f64| LATTICE_LIMIT * dt / most_reach();
            [Some(LoadShare { damping: of_damping.map(of_rate), pushes: of_rate(dt), ..ZERO }), None]
        }
        StabilityRegion::Everywhere => return None,
    };
    Some(shares.into_iter().flatten())
}

/// Returns how far the most stages of the stabilised scheme reach along the negative axis.
fn most_reach() -> f64 {
    reach(MAX_STAGES)
}

/// Returns the largest ratio of stiffness (1/s²) to damping (1/s) in steps of `dt` (s) with a margin, 1/s; only for a scheme
/// that limits it.
pub(in crate::physics) fn most_stiffness_per_damping(scheme: Scheme, dt: f64, margin: Margin) -> Option<f64> {
    (StabilityRegion::of(scheme) == StabilityRegion::DiscAndAxis).then(|| DISC_RADIUS * margin.stiffness / dt)
}

/// Whether the springs of contact push at the stages of a scheme and so use up part of its limits.
pub(in crate::physics) fn has_pushes(scheme: Scheme, rule: ContactRule) -> bool {
    StabilityRegion::of(scheme).has_pushes(rule)
}

impl StabilityRegion {
    pub(super) fn has_pushes(self, rule: ContactRule) -> bool {
        self == Self::DiscAndAxis && rule != ContactRule::Thesis
    }

    /// Returns the largest step for an undamped vibration with `ω² = λ`.
    pub(super) fn undamped_limit(self, lambda: f64) -> Option<f64> {
        match self {
            Self::Leapfrog(_) => undamped_limit(lambda),
            Self::HalfDisc(radius) => (lambda > 0.0).then(|| radius / lambda.sqrt()),
            Self::DiscAndAxis => (lambda > 0.0).then_some(0.0),
            Self::Everywhere => None,
        }
    }

    /// Returns the largest step for stiffness (1/s²) and damping (1/s) in this proportion; that of [`Self::undamped_limit`]
    /// for schemes to which the damping does not matter.
    pub(super) fn stiffness_limit(self, lambda: f64, damping: f64) -> Option<f64> {
        match self {
            Self::DiscAndAxis => (lambda > 0.0).then(|| DISC_RADIUS * damping / lambda),
            _ => self.undamped_limit(lambda),
        }
    }

    /// Returns the largest step for the thesis's explicit contact, which acts as a spring.
    pub(super) fn contact_limit(self, lambda: f64) -> Option<f64> {
        match self {
            Self::Everywhere | Self::DiscAndAxis => undamped_limit(lambda),
            Self::Leapfrog(_) | Self::HalfDisc(_) => self.undamped_limit(lambda),
        }
    }

    /// Returns the largest step for damping with `c = λ`.
    pub(super) fn damped_limit(self, lambda: f64) -> Option<f64> {
        match self {
            Self::Leapfrog(share) => damped_limit(share * lambda),
            Self::HalfDisc(radius) => (lambda > 0.0).then(|| radius / lambda),
            Self::DiscAndAxis => (lambda > 0.0).then(|| most_reach() / lambda),
            Self::Everywhere => None,
        }
    }
}

/// Returns the largest step with `dt² λ ≤ 4`.
pub(super) fn undamped_limit(lambda: f64) -> Option<f64> {
    (lambda > 0.0).then(|| 2.0 / lambda.sqrt())
}

/// Returns the largest step with `2 dt λ ≤ 4`.
pub(super) fn damped_limit(lambda: f64) -> Option<f64> {
    (lambda > 0.0).then(|| 2.0 / lambda)
}
