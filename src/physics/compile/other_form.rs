//! A material in its other form, so that a person who switches between springs and solid keeps the body they had.

use crate::geometry::{Family, Lattice};
use crate::math::Aabb;
use crate::physics::compile::assembly::{MODULUS_OVER_SHEAR, STRUCTURAL_OVER_SHEAR, solid_cell};
use crate::scene::material::{Solid, Spring};
use crate::scene::{Material, MaterialValue, Springs};

/// The same body in the other form: of a solid the constants that its links have inside it, of springs the isotropic
/// solid that comes nearest to them. What would be outside a parameter's range ends at it.
pub fn other_form(material: &Material, lattice: &Lattice) -> Material {
    let h = lattice.grid.cell_size;
    let particles = lattice.corners.len() as f64;
    let rest = (0..lattice.corners.len()).map(|particle| lattice.rest_position(particle));
    let size = Aabb::<f64>::around(rest).size().max_element();
    match material {
        Material::Springs(springs) => {
            // What stands in for the shear stiffness of an isotropic lattice, seen along the axes and across them.
            let mean = |of: fn(&Spring) -> f64| {
                let along = of(&springs.structural) + 2.0 * of(&springs.bending);
                0.5 * (of(&springs.shear) + along / STRUCTURAL_OVER_SHEAR)
            };
            let (stiffness, damping) = (mean(|spring| spring.stiffness), mean(|spring| spring.damping));
            let young_modulus = MaterialValue::YoungModulus.in_range(MODULUS_OVER_SHEAR * stiffness / (h * h));
            let density = MaterialValue::Density.in_range(springs.particle_mass * particles / lattice.volume_m3());
            let slowest = std::f64::consts::PI / size * (young_modulus / density).sqrt();
            let ratio = if stiffness > 0.0 { 0.5 * damping / stiffness * slowest } else { 0.0 };
            Material::Solid(Solid {
                young_modulus,
                density,
                damping_ratio: MaterialValue::DampingRatio.in_range(ratio),
            })
        }
        Material::Solid(solid) => {
            let kind = solid_cell(solid, lattice, size);
            let spring = |family: Family| Spring {
                stiffness: MaterialValue::Stiffness(family).in_range(kind.stiffness[family as usize]),
                damping: MaterialValue::Damping(family).in_range(kind.damping[family as usize]),
            };
            Material::Springs(Springs {
                structural: spring(Family::Structural),
                shear: spring(Family::Shear),
                bending: Spring { stiffness: 0.0, damping: 0.0 },
                particle_mass: MaterialValue::ParticleMass.in_range(solid.density * lattice.volume_m3() / particles),
            })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::voxel::Cells;
    use crate::scene::param;

    fn lattice() -> Lattice {
        Lattice::new(&Cells::cube(4, 0.25).expect("a small cube"))
    }

    #[test]
    fn there_and_back_a_solid_is_what_it_was() {
        let solid = Solid { young_modulus: 2.5e4, density: 300.0, damping_ratio: 0.2 };
        let springs = other_form(&Material::Solid(solid), &lattice());
        let Material::Solid(back) = other_form(&springs, &lattice()) else { panic!("a solid again") };
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-9;
        assert!(near(back.young_modulus, solid.young_modulus) && near(back.density, solid.density), "{back:?}");
        assert!(near(back.damping_ratio, solid.damping_ratio), "{back:?}");
    }

    #[test]
    fn the_mass_stays_and_the_ranges_are_kept() {
        let Material::Solid(solid) = other_form(&Material::default(), &lattice()) else { panic!("a solid") };
        assert!((solid.density - 1.25).abs() < 1e-9, "125 particles of 10 g in a cubic metre: {solid:?}");
        let none = Springs { particle_mass: 1e-6, ..Springs::default() };
        let weightless = other_form(&Material::Springs(none), &lattice());
        let scene = crate::scene::Scene {
            bodies: vec![crate::scene::Body { material: weightless, ..crate::scene::Body::default() }],
            ..crate::scene::Scene::default()
        };
        assert!(param::validate(&scene).is_empty(), "what comes out can be used: {:?}", scene.bodies[0].material);
    }
}
