//! Converts the schemes and contact rules of the settings to those of the physics, and schemes back.

use crate::physics::model::{ContactRule, Scheme};
use crate::scene::settings::{self, Integrator};

impl From<Integrator> for Scheme {
    fn from(integrator: Integrator) -> Self {
        match integrator {
            Integrator::SemiImplicit => Self::SemiImplicit,
            Integrator::Explicit => Self::Explicit,
            Integrator::Verlet => Self::Verlet,
            Integrator::Rk2 => Self::Rk2,
            Integrator::Rk4 => Self::Rk4,
            Integrator::Stabilised => Self::Stabilised,
            Integrator::Implicit => Self::Implicit,
        }
    }
}

impl From<Scheme> for Integrator {
    fn from(scheme: Scheme) -> Self {
        match scheme {
            Scheme::SemiImplicit => Self::SemiImplicit,
            Scheme::Explicit => Self::Explicit,
            Scheme::Verlet => Self::Verlet,
            Scheme::Rk2 => Self::Rk2,
            Scheme::Rk4 => Self::Rk4,
            Scheme::Stabilised => Self::Stabilised,
            Scheme::Implicit => Self::Implicit,
        }
    }
}

impl From<settings::ContactRule> for ContactRule {
    fn from(rule: settings::ContactRule) -> Self {
        match rule {
            settings::ContactRule::Implicit => Self::Implicit,
            settings::ContactRule::Thesis => Self::Thesis,
        }
    }
}
