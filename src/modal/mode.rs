//! The modes of a body and the request for them, as plain numbers.

use glam::DVec3;

/// The fewest and the most modes that can be asked for.
pub const COUNTS: [usize; 2] = [1, 60];

/// The modes that are asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// How many of the lowest modes; all of them where a body has fewer.
    pub count: usize,
    /// The most memory that the computation may take, bytes.
    pub max_bytes: u64,
}

impl Default for Wanted {
    fn default() -> Self {
        Self { count: 20, max_bytes: u64::MAX }
    }
}

/// The lowest modes of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Modes {
    /// By frequency, the lowest first.
    pub modes: Vec<Mode>,
    /// The number of rigid motions that nothing holds: six for a free body in one piece.
    pub rigid: usize,
    /// How far the worst mode is from solving the equations: `|K φ − ω² M φ|` over `|ω² M φ|`, both weighted by the inverse
    /// of `M`.
    pub residual: f64,
    /// The memory that the computation took, as predicted before it began, bytes.
    pub bytes: u64,
}

/// One way in which a body vibrates.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// The frequency without damping, Hz; zero if no stiffness resists.
    pub frequency_hz: f64,
    /// The damping of this mode by the links: `φᵀ C φ`, 1/s. Coupling to other modes is left out; a solid has none, as its
    /// damping is proportional to its stiffness.
    pub damping: f64,
    /// The displacement of every particle in the body's coordinates for `q` = 1, 1/√kg; zero where it is held.
    pub shape: Vec<DVec3>,
}

impl Mode {
    /// `ω`, 1/s.
    pub fn angular_frequency(&self) -> f64 {
        std::f64::consts::TAU * self.frequency_hz
    }

    /// The damping over the critical one, from which the mode no longer vibrates; none if no stiffness resists.
    pub fn damping_ratio(&self) -> Option<f64> {
        let omega = self.angular_frequency();
        (omega > 0.0).then(|| 0.5 * self.damping / omega)
    }

    /// The farthest that a particle moves for `q` = 1, 1/√kg.
    pub fn reach(&self) -> f64 {
        self.shape.iter().map(|way| way.length()).fold(0.0, f64::max)
    }
}
