//! How bodies meet obstacles, from what a particle may have to carry.

use crate::geometry::Lattice;
use crate::math::{Real, Vector};
use crate::physics::contact::{DEPTH_SHARE, STIFFNESS_OVER_MASS};
use crate::physics::model::{BodyModel, ContactModel, Model};
use crate::scene::obstacle::ContactStiffness;
use crate::scene::settings::ContactRule;
use crate::scene::{Obstacle, Scene};

/// No particle rests, or ends a step, deeper in a closed form than this share of the way to its middle: past that the
/// nearest way out is the other side.
const MAX_DEPTH_SHARE: f64 = 0.5;

/// A body on points of its mesh may stand on a single one, pressed in by a quarter of the depth limit.
const WEIGHTS_ON_A_POINT: f64 = 4.0;

/// Bodies that lie on half of another load its particles this many times as much as if they lay on all of it.
const UNEVENNESS: f64 = 2.0;

/// How a body of this size (m) meets one obstacle, alone; `mass` is that of its heaviest particle (kg), `load` what one may
/// have to carry (N).
pub(super) fn contact<R: Real>(
    obstacle: &Obstacle,
    mass: f64,
    size: f64,
    load: f64,
    cell_size: f64,
) -> ContactModel<R> {
    let thin = obstacle.shape.half_thickness().map_or(f64::INFINITY, |half| MAX_DEPTH_SHARE * half);
    let depth_limit = (DEPTH_SHARE * size).min(thin);
    let stiffness = match obstacle.stiffness {
        ContactStiffness::Given(stiffness) => stiffness,
        ContactStiffness::Auto => auto_stiffness(mass, load, depth_limit),
    };
    ContactModel {
        stiffness: R::from_f64(stiffness),
        damping: R::from_f64(critical_damping(stiffness, mass)),
        depth_limit: R::from_f64(depth_limit),
        thesis_threshold: R::from_f64(cell_size),
    }
}

/// The stiffness, N/m, with which a particle of this mass (kg) carries a load (N) no deeper than the limit (m).
fn auto_stiffness(mass: f64, load: f64, depth_limit: f64) -> f64 {
    (STIFFNESS_OVER_MASS * mass).max(load / depth_limit)
}

fn critical_damping(stiffness: f64, mass: f64) -> f64 {
    2.0 * (stiffness * mass).sqrt()
}

/// Lets bodies carry the others that they meet: whichever may come to lie on them. At the limit of its depth a contact has no
/// spring left that gives way, and a light body would be held there by what lies on it.
pub(super) fn share_loads<R: Real>(model: &mut Model<R>, scene: &Scene) {
    if scene.settings.contact != ContactRule::Implicit {
        return;
    }
    let gravity = model.gravity.to_dvec3().length();
    let meeting = |body: &BodyModel<R>| if body.meets_others() { gravity * free_mass(body) } else { 0.0 };
    let weights: Vec<f64> = model.bodies.iter().map(meeting).collect();
    let of_all: f64 = weights.iter().sum();
    for (body, weight) in model.bodies.iter_mut().zip(weights).filter(|(body, _)| body.meets_others()) {
        let load = UNEVENNESS * (of_all - weight) / smallest_layer(&body.lattice) as f64;
        body.body_contact.load_of_others = load;
        let mass = body.body_contact.heaviest;
        for (contact, obstacle) in body.contacts.iter_mut().zip(&scene.obstacles) {
            let stiffness = auto_stiffness(mass, load, contact.depth_limit.to_f64());
            if obstacle.stiffness == ContactStiffness::Auto && stiffness > contact.stiffness.to_f64() {
                contact.stiffness = R::from_f64(stiffness);
                contact.damping = R::from_f64(critical_damping(stiffness, mass));
            }
        }
    }
}

/// How a body would meet an obstacle whose stiffness follows from the mass if there were no other bodies.
pub(super) fn contact_alone<R: Real>(body: &BodyModel<R>, contact: &ContactModel<R>) -> ContactModel<R> {
    let (mass, load) = (body.body_contact.heaviest, body.body_contact.own_load);
    let stiffness = auto_stiffness(mass, load, contact.depth_limit.to_f64());
    ContactModel {
        stiffness: R::from_f64(stiffness),
        damping: R::from_f64(critical_damping(stiffness, mass)),
        ..*contact
    }
}

/// The part of a body's weight that one outer particle, or point of its mesh, may have to carry at rest, N. `heaviest` is the
/// mass of its heaviest particle, `mean` of all, kg.
pub(super) fn own_load(lattice: &Lattice, [heaviest, mean]: [f64; 2], is_on_points: bool, gravity: f64) -> f64 {
    let load = max_carried_particles(lattice) * heaviest * gravity;
    let weight = mean * lattice.corners.len() as f64 * gravity;
    if is_on_points { load.max(WEIGHTS_ON_A_POINT * weight) } else { load }
}

fn free_mass<R: Real>(body: &BodyModel<R>) -> f64 {
    let free = (0..body.particles.len()).filter(|&particle| !body.is_pinned(particle));
    free.map(|particle| body.mass(particle).to_f64()).sum()
}

/// Particles that one particle in contact may have to carry at rest: the tallest column, or all of them on the
/// smallest of the six outer layers, as a tree stands on its trunk.
fn max_carried_particles(lattice: &Lattice) -> f64 {
    let extent = |axis: usize| {
        let along = || lattice.corners.iter().map(|corner| corner[axis]);
        along().max().zip(along().min()).map_or(0, |(high, low)| high - low + 1)
    };
    let column = (0..3).map(extent).max().unwrap_or(0);
    f64::from(column).max(lattice.corners.len() as f64 / smallest_layer(lattice) as f64)
}

/// How many particles the smallest of the six outer layers has.
fn smallest_layer(lattice: &Lattice) -> usize {
    let layers = (0..3).flat_map(|axis| {
        let along = || lattice.corners.iter().map(move |corner| corner[axis]);
        let ends = [along().min(), along().max()];
        ends.map(|end| along().filter(|&corner| Some(corner) == end).count())
    });
    layers.min().unwrap_or(0).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::compile::step_loads::ContactLoad;
    use crate::physics::simulation::Simulation;
    use crate::scene::Body;
    use crate::scene::body::{CubeShape, Shape};
    use crate::scene::material::{Material, Springs};
    use crate::scene::settings::Integrator;

    /// Cubes of 5 × 5 × 5 particles of these masses (kg), a metre long.
    fn cubes(masses: &[f64]) -> Scene {
        let body = |&particle_mass: &f64| Body {
            shape: Shape::Cube(CubeShape { cells: 4, size: 1.0 }),
            material: Material::Springs(Springs { particle_mass, ..Springs::default() }),
            ..Body::default()
        };
        let obstacles = vec![Obstacle::default()];
        Scene { bodies: masses.iter().map(body).collect(), obstacles, ..Scene::default() }
    }

    fn stiffness(scene: &Scene, body: usize) -> f64 {
        let simulation = Simulation::<f64>::from_scene(scene, "".as_ref()).unwrap();
        simulation.model().bodies[body].contacts[0].stiffness
    }

    #[test]
    fn a_light_body_can_carry_the_heavy_ones_that_may_lie_on_it() {
        let light = stiffness(&cubes(&[1e-3]), 0);
        assert!((light / 100.0 - 1.0).abs() < 1e-9, "{light} N/m alone: 1e5 per s² of a gram");
        // The 25 particles of a side carry 250 of a kilogram, unevenly, with a spring that may be pressed by 2 cm.
        let needed = 2.0 * 250.0 * 9.81 / 25.0 / 0.02;
        let scene = cubes(&[1e-3, 1.0, 1.0]);
        let carrying = stiffness(&scene, 0);
        assert!((carrying / needed - 1.0).abs() < 0.01, "{carrying} N/m, not {needed}");
        let heavy = stiffness(&scene, 1);
        assert!((heavy / 1e5 - 1.0).abs() < 1e-9, "{heavy} N/m: a heavy one is stiff enough as it is");
    }

    #[test]
    fn a_body_carries_nothing_that_does_not_meet_it() {
        let carries = |change: fn(&mut Scene)| {
            let mut scene = cubes(&[1e-3, 1.0]);
            change(&mut scene);
            stiffness(&scene, 0) > 101.0
        };
        assert!(carries(|_| ()));
        assert!(!carries(|scene| scene.settings.body_contact = false));
        assert!(!carries(|scene| scene.bodies[1].collides = false));
        assert!(!carries(|scene| scene.settings.gravity = [0.0; 3]), "nothing weighs anything");
        assert!(!carries(|scene| scene.settings.contact = ContactRule::Thesis), "that rule has its own stiffness");
        assert!(!carries(|scene| scene.obstacles[0].stiffness = ContactStiffness::Given(100.0)), "a given one stays");
    }

    #[test]
    fn what_others_add_to_the_stiffness_does_not_follow_the_mass_of_the_body() {
        let of = |masses: &[f64]| {
            let mut scene = cubes(masses);
            scene.settings.integrator = Integrator::Stabilised;
            let simulation = Simulation::<f64>::from_scene(&scene, "".as_ref()).unwrap();
            ContactLoad::of(&simulation.model().bodies[0], &scene)
        };
        let [alone, carrying] = [of(&[1e-3]), of(&[1e-3, 1.0])];
        let ratios = [alone, carrying].map(|load| load.now().pushes.stiffness_per_damping);
        assert!(ratios[1] > 2.0 * ratios[0], "{ratios:?}");
        // Between the two a heavier body helps, but only against what the others add.
        let between = 0.5 * (ratios[0] + ratios[1]);
        assert!(alone.min_mass_factor(between) < 1e-9);
        let factor = carrying.min_mass_factor(between);
        assert!(factor > 1.0 && factor < 10.0, "{factor}");
        assert!(carrying.min_mass_factor(0.5 * ratios[0]).is_infinite());
    }
}
