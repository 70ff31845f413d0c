//! A material in its other form, so that a person who switches between springs and solid keeps the body they had.

use crate::geometry::{Family, Lattice};
use crate::math::Aabb;
use crate::physics::compile::assembly::{MODULUS_OVER_SHEAR, STRUCTURAL_OVER_SHEAR, solid_cell};
use crate::scene::material::{Solid, Spring};
use crate::scene::{Body, Material, MaterialValue, Springs};

/// The materials of a body in the other form.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OtherForm {
    material: Material,
    /// The materials of its inlays and of its parts, in their order.
    within: [Vec<Material>; 2],
}

impl OtherForm {
    /// Converts the materials of a body of this lattice.
    pub fn of(body: &Body, lattice: &Lattice) -> Self {
        let converted = |(solid, springs): (Solid, Springs)| match &body.material {
            Material::Springs(_) => other_form(&Material::Springs(springs), lattice),
            Material::Solid(_) => other_form(&Material::Solid(solid), lattice),
        };
        let inlays = body.inlays.iter().map(|inlay| (inlay.solid, inlay.springs));
        let parts = body.parts.iter().map(|part| (part.solid, part.springs));
        Self {
            material: other_form(&body.material, lattice),
            within: [inlays.map(converted).collect(), parts.map(converted).collect()],
        }
    }

    /// The body with these materials.
    pub fn given_to(&self, body: &Body) -> Body {
        let set = |material: &Material, solid: &mut Solid, springs: &mut Springs| match material {
            Material::Springs(of) => *springs = *of,
            Material::Solid(of) => *solid = *of,
        };
        let mut body = Body { material: self.material.clone(), ..body.clone() };
        let [inlays, parts] = &self.within;
        body.inlays.iter_mut().zip(inlays).for_each(|(inlay, of)| set(of, &mut inlay.solid, &mut inlay.springs));
        body.parts.iter_mut().zip(parts).for_each(|(part, of)| set(of, &mut part.solid, &mut part.springs));
        body
    }
}

/// The same material in the other form: for a solid the constants of the links inside it, for springs the isotropic solid
/// that comes nearest to them. Values are kept within their parameters' ranges.
fn other_form(material: &Material, lattice: &Lattice) -> Material {
    let h = lattice.grid.cell_size;
    let particles = lattice.corners.len() as f64;
    let rest = (0..lattice.corners.len()).map(|particle| lattice.rest_position(particle));
    let size = Aabb::<f64>::around(rest).size().max_element();
    match material {
        Material::Springs(springs) => {
            // The shear stiffness of the nearest isotropic lattice: the mean of what links along the axes and across them
            // ask for.
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
                ..Solid::DEFAULT
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
    use crate::scene::body::{Inlay, Part};
    use crate::scene::param;

    fn lattice() -> Lattice {
        Lattice::new(&Cells::cube(4, 0.25).expect("a small cube"))
    }

    #[test]
    fn there_and_back_a_solid_is_what_it_was() {
        let solid = Solid { young_modulus: 2.5e4, density: 300.0, damping_ratio: 0.2, ..Solid::DEFAULT };
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

    #[test]
    fn what_is_within_a_body_takes_the_other_form_with_it() {
        let solid = Solid { young_modulus: 2.5e4, density: 300.0, damping_ratio: 0.2, ..Solid::DEFAULT };
        let body = Body {
            material: Material::Solid(Solid::default()),
            inlays: vec![Inlay { solid, ..Inlay::default() }],
            parts: vec![Part { name: "Leg".to_owned(), solid, ..Part::default() }],
            ..Body::default()
        };
        let of_springs = OtherForm::of(&body, &lattice()).given_to(&body);
        assert_eq!(of_springs.material, other_form(&body.material, &lattice()));
        let springs = other_form(&Material::Solid(solid), &lattice());
        let [inlay, part] = [of_springs.inlays[0].springs, of_springs.parts[0].springs];
        assert_eq!([inlay, part].map(Material::Springs), [springs.clone(), springs], "of their own solids");
        assert_eq!((of_springs.inlays[0].solid, &of_springs.parts[0].name[..]), (solid, "Leg"), "nothing else changes");
        let back = OtherForm::of(&of_springs, &lattice()).given_to(&of_springs);
        assert!((back.inlays[0].solid.young_modulus / solid.young_modulus - 1.0).abs() < 1e-9, "and back");
    }
}
