//! How a scene is simulated.

use serde::{Deserialize, Deserializer, Serialize, de};

/// The acceleration of gravity near the ground, m/s².
pub const EARTH_GRAVITY: f64 = 9.81;

/// How a scene is simulated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of its own")]
pub struct Settings {
    /// The step a person asks for, s.
    pub dt: f64,
    /// The scheme that advances a step.
    pub integrator: Integrator,
    /// Who is responsible for the step being small enough.
    pub stepping: Stepping,
    /// How obstacles push back.
    pub contact: ContactRule,
    /// Whether bodies meet each other.
    pub body_contact: bool,
    /// Whether automatic stepping may use the stabilised or the implicit scheme instead of dividing the steps finely, where
    /// that is cheaper.
    pub allow_implicit: bool,
    /// Whether cells that are crushed or turned inside out are pushed back to shape.
    pub inversion_recovery: bool,
    /// Whether a body that has come to rest is left alone until something touches it or a value changes.
    pub sleeping: bool,
    /// Acceleration of gravity, m/s². In files and on the command line a single number g means (0, −g, 0).
    #[serde(deserialize_with = "gravity")]
    pub gravity: [f64; 3],
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            dt: 0.001,
            integrator: Integrator::SemiImplicit,
            stepping: Stepping::Auto,
            contact: ContactRule::Implicit,
            body_contact: true,
            allow_implicit: true,
            inversion_recovery: true,
            sleeping: true,
            gravity: [0.0, -EARTH_GRAVITY, 0.0],
        }
    }
}

/// The scheme that advances a step.
#[derive(Default, Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Integrator {
    /// Semi-implicit Euler (GC §4.1): velocity first, position with the new velocity.
    #[serde(alias = "semi-implicit")]
    #[default]
    SemiImplicit,
    /// Explicit Euler (GC §4.1): velocity and position from the old ones. Grows without damping, however small the step.
    Explicit,
    /// Leapfrog Verlet with a predicted velocity for the damping: second order at one evaluation of the forces a step.
    Verlet,
    /// Runge–Kutta of second order (midpoint). Grows slowly without damping.
    Rk2,
    /// The classical Runge–Kutta method of fourth order. Both leave steps near obstacles and other bodies, and those in which a
    /// hand pulls, to semi-implicit Euler.
    Rk4,
    /// Runge–Kutta–Chebyshev of second order: the damping sets the number of evaluations of the forces, which grows with the
    /// root of the step.
    Stabilised,
    /// Linearly implicit Euler: stable at any step, dissipative.
    Implicit,
}

impl Integrator {
    /// All schemes.
    pub const ALL: [Self; 7] =
        [Self::SemiImplicit, Self::Explicit, Self::Verlet, Self::Rk2, Self::Rk4, Self::Stabilised, Self::Implicit];

    /// The schemes with a largest stable step, to which automatic stepping divides: explicit and RK2 have none, and the
    /// implicit scheme is stable at every step.
    pub const LIMITED: [Self; 3] = [Self::SemiImplicit, Self::Verlet, Self::Rk4];

    /// The scheme's word on the command line and in figures.
    pub fn name(self) -> &'static str {
        match self {
            Self::SemiImplicit => "semi-implicit",
            Self::Explicit => "explicit",
            Self::Verlet => "verlet",
            Self::Rk2 => "rk2",
            Self::Rk4 => "rk4",
            Self::Stabilised => "stabilised",
            Self::Implicit => "implicit",
        }
    }

    /// The scheme's name on screen.
    pub fn words(self) -> &'static str {
        match self {
            Self::SemiImplicit => "semi-implicit Euler",
            Self::Explicit => "explicit Euler",
            Self::Verlet => "velocity Verlet",
            Self::Rk2 => "Runge–Kutta 2",
            Self::Rk4 => "Runge–Kutta 4",
            Self::Stabilised => "stabilised Runge–Kutta",
            Self::Implicit => "implicit Euler",
        }
    }

    /// Whether an undamped vibration stays bounded at some step. If not, no division of a step makes the scheme stable.
    pub fn has_stable_step(self) -> bool {
        !matches!(self, Self::Explicit | Self::Rk2)
    }
}

/// Who is responsible for the step being small enough.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stepping {
    /// The program: a step is subdivided until it respects the stability bound.
    Auto,
    /// The person: the step is taken as it is, stable or not.
    Manual,
}

/// How obstacles push back.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ContactRule {
    /// A stiff, critically damped spring taken implicitly, with Coulomb friction: never limits the step.
    Implicit,
    /// The thesis's own rule (GC §5.2, §6), to teach with: it injects energy and creeps.
    Thesis,
}

fn gravity<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[f64; 3], D::Error> {
    struct Visitor;
    impl<'de> de::Visitor<'de> for Visitor {
        type Value = [f64; 3];
        fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
            f.write_str("three numbers in m/s², or a single number g for (0, -g, 0)")
        }
        fn visit_f64<E: de::Error>(self, g: f64) -> Result<Self::Value, E> {
            Ok([0.0, 0.0 - g, 0.0])
        }
        fn visit_i64<E: de::Error>(self, g: i64) -> Result<Self::Value, E> {
            self.visit_f64(g as f64)
        }
        fn visit_u64<E: de::Error>(self, g: u64) -> Result<Self::Value, E> {
            self.visit_f64(g as f64)
        }
        fn visit_seq<A: de::SeqAccess<'de>>(self, mut seq: A) -> Result<Self::Value, A::Error> {
            let mut gravity = [0.0; 3];
            for (axis, slot) in gravity.iter_mut().enumerate() {
                *slot = seq.next_element()?.ok_or_else(|| de::Error::invalid_length(axis, &self))?;
            }
            if seq.next_element::<f64>()?.is_some() {
                return Err(de::Error::invalid_length(4, &self));
            }
            Ok(gravity)
        }
    }
    deserializer.deserialize_any(Visitor)
}
