//! What a body is made of: the thesis's seven values (GC §3, §8), or a solid by its modulus, density and damping.

use serde::{Deserialize, Serialize};

use crate::geometry::Family;

/// The material of a body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Material {
    /// Link constants given directly.
    Springs(Springs),
    /// A solid, from which the link constants follow for every resolution.
    Solid(Solid),
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

/// A homogeneous isotropic solid. Its Poisson ratio is 1/4, as that of every lattice of central forces (Cauchy).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Solid {
    /// Tension over strain, Pa.
    pub young_modulus: f64,
    /// Mass over volume, kg/m³.
    pub density: f64,
    /// Damping of the slowest vibration along the body over the damping at which it would no longer swing. Faster
    /// vibrations are damped more, in proportion to their frequency.
    pub damping_ratio: f64,
    /// Contraction across over extension along, a note only: whatever it says, the body has [`POISSON_RATIO`].
    pub poisson_ratio: f64,
}

/// Poisson's ratio of every lattice of central forces (Cauchy).
pub const POISSON_RATIO: f64 = 0.25;

impl Solid {
    /// A cube of 1 m of it sags by about 5 % under its own weight and wobbles for a second.
    pub const DEFAULT: Self =
        Self { young_modulus: 1e5, density: 1000.0, damping_ratio: 0.05, poisson_ratio: POISSON_RATIO };
}

impl Default for Solid {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// A material by its everyday name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaterialPreset {
    /// Its everyday name.
    pub name: &'static str,
    /// Its values.
    pub material: Solid,
    /// Where they come from, one sentence.
    pub source: &'static str,
}

/// Solids by their everyday names, soft to stiff. Modulus and density are measured values of the source named; so is
/// the damping where the source says so.
pub fn presets() -> &'static [MaterialPreset] {
    &PRESETS
}

const PRESETS: [MaterialPreset; 8] = [
    preset(
        "pectin jelly",
        [1.2e3, 1000.0, 0.05],
        "H. Nielsen, B. U. Marr, S. Hvidt, Carbohydrate Polymers 45 (2001) 395: shear modulus of the standard gel 379 to \
         429 Pa, three times that as it keeps its volume; density of water, the damping is chosen.",
    ),
    preset(
        "gelatin dessert",
        [4.34e3, 1000.0, 0.05],
        "J. E. Bonavia, arXiv:2512.20502 (2025): 4.34 kPa for 20 parts of water to one of gelatin; density of water, the \
         damping is chosen.",
    ),
    preset(
        "agar jelly",
        [5.2e4, 1000.0, 0.05],
        "K. A. Ross, M. G. Scanlon, Journal of Texture Studies 30 (1999) 17: 52 kPa in compression; density of water, the \
         damping is chosen.",
    ),
    preset(
        "boiled dough",
        [7.0e4, 1100.0, 0.1],
        "Studies on the Rheological Property of Korean Noodles I (1983), koreascience.or.kr JAKO198303041889139: 70 kPa in \
         short creep of boiled wheat noodles; the density is estimated, the damping chosen. Raw dough flows.",
    ),
    preset(
        "sponge",
        [1.36e5, 320.0, 0.1],
        "Rogers Corporation, data sheet of Poron 4701-30, an open-celled urethane: 320 kg/m³, 34 kPa at 25 % compression, \
         whose quotient this is; the damping is chosen.",
    ),
    preset(
        "packing foam",
        [1.6e5, 33.0, 0.1],
        "customfoams.co.uk, data sheet of Plastazote LD33, a closed-cell polyethylene: 33 kg/m³, 40 kPa at 25 % \
         compression, whose quotient this is; the damping is chosen.",
    ),
    preset(
        "gummy sweet",
        [2.77e5, 1200.0, 0.1],
        "J. E. Bonavia, arXiv:2512.20502 (2025): 277 kPa for two parts of water to one of gelatin; the density is \
         estimated, the damping chosen.",
    ),
    preset(
        "rubber",
        [1.5e6, 950.0, 0.05],
        "matweb.com, Natural Rubber, Vulcanized: 950 kg/m³, shear modulus 0.5 MPa, three times that as it keeps its \
         volume; the damping is chosen.",
    ),
];

const fn preset(
    name: &'static str,
    [young_modulus, density, damping_ratio]: [f64; 3],
    source: &'static str,
) -> MaterialPreset {
    MaterialPreset { name, material: Solid { young_modulus, density, damping_ratio, ..Solid::DEFAULT }, source }
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

impl Springs {
    /// The constants of one family.
    pub fn family(&self, family: Family) -> Spring {
        match family {
            Family::Structural => self.structural,
            Family::Shear => self.shear,
            Family::Bending => self.bending,
        }
    }

    /// The constants of one family, to change them.
    pub fn family_mut(&mut self, family: Family) -> &mut Spring {
        match family {
            Family::Structural => &mut self.structural,
            Family::Shear => &mut self.shear,
            Family::Bending => &mut self.bending,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Body, Scene, param};

    #[test]
    fn every_everyday_material_is_in_range_and_names_its_source() {
        let mut last = 0.0;
        for preset in presets() {
            let body = Body { material: Material::Solid(preset.material), ..Body::default() };
            let problems = param::validate(&Scene { bodies: vec![body], ..Scene::default() });
            assert!(problems.is_empty(), "{}: {problems:?}", preset.name);
            assert!(preset.material.young_modulus > last, "{}: from soft to stiff", preset.name);
            assert!(preset.source.len() > 20, "{}: no source", preset.name);
            last = preset.material.young_modulus;
        }
    }
}
