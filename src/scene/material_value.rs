//! The single values of a material: their paths below a body, and the ranges of their parameters.

use super::param::{self, Kind};
use crate::geometry::Family;

/// A value of a material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MaterialValue {
    /// A family's stiffness, of springs.
    Stiffness(Family),
    /// A family's damping, of springs.
    Damping(Family),
    /// The mass of a particle, of springs.
    ParticleMass,
    /// Young's modulus, of a solid.
    YoungModulus,
    /// The density, of a solid.
    Density,
    /// The damping ratio, of a solid.
    DampingRatio,
}

impl MaterialValue {
    /// Its path below a body.
    pub fn path(self) -> &'static str {
        match self {
            Self::Stiffness(Family::Structural) => "material.springs.structural.stiffness",
            Self::Stiffness(Family::Shear) => "material.springs.shear.stiffness",
            Self::Stiffness(Family::Bending) => "material.springs.bending.stiffness",
            Self::Damping(Family::Structural) => "material.springs.structural.damping",
            Self::Damping(Family::Shear) => "material.springs.shear.damping",
            Self::Damping(Family::Bending) => "material.springs.bending.damping",
            Self::ParticleMass => "material.springs.particle_mass",
            Self::YoungModulus => "material.solid.young_modulus",
            Self::Density => "material.solid.density",
            Self::DampingRatio => "material.solid.damping_ratio",
        }
    }

    /// The nearest value that its range allows.
    pub fn in_range(self, value: f64) -> f64 {
        match param::find(&format!("bodies.0.{}", self.path())).map(|param| param.kind) {
            Some(Kind::Number { min, max }) => value.clamp(min, max),
            _ => value,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_is_a_parameter_with_a_range() {
        let of_families = Family::ALL.map(|family| [MaterialValue::Stiffness(family), MaterialValue::Damping(family)]);
        let others = [MaterialValue::ParticleMass, MaterialValue::YoungModulus, MaterialValue::Density];
        let all = of_families.into_iter().flatten().chain(others).chain([MaterialValue::DampingRatio]);
        for value in all {
            assert!(value.in_range(f64::INFINITY).is_finite(), "{value:?} has a largest value");
            assert!(value.in_range(f64::NEG_INFINITY) >= 0.0, "{value:?} has a smallest one");
        }
    }
}
