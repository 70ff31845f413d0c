//! What a body is made of: the thesis's seven values (GC §3, §8).

use serde::{Deserialize, Serialize};

/// The material of a body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Material {
    /// Link constants given directly.
    Springs(Springs),
}

impl Default for Material {
    fn default() -> Self {
        Self::Springs(Springs::default())
    }
}

/// The seven values of the thesis: a particle mass, three stiffnesses, three dampings. Free values make a material
/// that is in general anisotropic.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Springs {
    /// Links to the 6 nearest particles.
    pub structural: Spring,
    /// Links across the faces and the body of a cell.
    pub shear: Spring,
    /// Links to the 6 second neighbours along the axes.
    pub bending: Spring,
    /// Mass of every particle, kg.
    pub particle_mass: f64,
}

impl Default for Springs {
    /// A 1 m cube of 9 cells an edge weighs 10 kg, is squashed by a fall and settles after a few swings; alike along
    /// and across the axes (structural + 2 bending ≈ 2.2 shear). Most of the damping is in the bending links: they
    /// resist long waves most and the shortest ones, which limit the step, not at all.
    fn default() -> Self {
        Self {
            structural: Spring { stiffness: 30.0, damping: 0.1 },
            shear: Spring { stiffness: 25.0, damping: 0.12 },
            bending: Spring { stiffness: 12.0, damping: 0.3 },
            particle_mass: 0.01,
        }
    }
}

/// The two constants of a family of links.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spring {
    /// Force at 100 % strain, N (not N/m: the Hooke constant is this over the rest length).
    pub stiffness: f64,
    /// Force at a relative speed of one rest length per second along the link, N·s.
    pub damping: f64,
}

/// The three families of links (GC §3.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Family {
    /// The 6 nearest neighbours along the axes.
    Structural,
    /// The 12 face-diagonal and 8 body-diagonal neighbours.
    Shear,
    /// The 6 second neighbours along the axes.
    Bending,
}

impl Family {
    /// All families, in the order in which arrays by family hold them.
    pub const ALL: [Self; 3] = [Self::Structural, Self::Shear, Self::Bending];

    /// The family's word in files, figures and on screen.
    pub fn name(self) -> &'static str {
        match self {
            Self::Structural => "structural",
            Self::Shear => "shear",
            Self::Bending => "bending",
        }
    }
}

impl Springs {
    /// The constants of one family.
    pub fn family(&self, family: Family) -> Spring {
        match family {
            Family::Structural => self.structural,
            Family::Shear => self.shear,
            Family::Bending => self.bending,
        }
    }
}
