//! Random extreme scenes: every value is drawn over its whole range; bodies are dropped from a kilometre, thrown at a
//! kilometre a second, put into obstacles, heavy beside light, hung up by pins. A scene follows from a seed and a number
//! alone, so each can be made again.

use std::path::Path;
use std::sync::Arc;

use super::disturb::{self, Disturbance};
use super::judge::Patience;
use super::random_source::RandomSource;
use crate::geometry::Lattice;
use crate::math::rng::Rng;
use crate::scene::body::{Body, CellsShape, CubeShape, Inlay, ModelShape, PinBox, Pose};
use crate::scene::material::{Material, Solid, Spring, Springs};
use crate::scene::obstacle::{
    Capsule, ContactStiffness, Cuboid, Cylinder, Mesh, Motion, Oscillate, Plane, Sphere, Turn,
};
use crate::scene::resolve::{ResolveError, resolve};
use crate::scene::settings::{EARTH_GRAVITY, Integrator};
use crate::scene::{ContactOn, Obstacle, ObstacleShape, Scene, Shape, builtin};

/// The share of single bodies made of two solids, and later of first bodies of springs made of two springs.
const INLAID_SHARE: f64 = 0.15;

/// The share of scenes whose body is pinned, from its top down or from one side.
const PINNED_SHARE: f64 = 0.2;

/// The share of scenes whose bodies meet each other; in the others they pass through each other.
const BODY_CONTACT_SHARE: f64 = 0.8;

/// The share of scenes whose models meet other bodies with their mesh.
const MESH_CONTACT_SHARE: f64 = 0.5;

/// The share of scenes with a model among the obstacles, ...
const MESH_OBSTACLE_SHARE: f64 = 0.4;

/// ... and of those with an obstacle that moves by itself.
const MOVING_OBSTACLE_SHARE: f64 = 0.25;

/// The largest ratio of masses between two bodies, and between the two materials of a body.
const MAX_MASS_RATIO: f64 = 1000.0;

/// The most bodies in a scene.
const MAX_BODIES: usize = 6;

/// The carried models that scenes are made of. Adding a model would change the scenes of every seed.
const MODELS: [&str; 5] = ["bowl.obj", "comb.obj", "coupler.obj", "spot.obj", "tree.obj"];

/// Those that obstacles are made of: closed and open, smooth and with edges.
const OBSTACLE_MODELS: [&str; 7] =
    ["bowl.obj", "chair.obj", "comb.obj", "coupler.obj", "shell.obj", "spot.obj", "tree.obj"];

/// How long a random scene is watched. Most scenes take a thousandth of the link forces at which one is cut short. Of 2659
/// scenes 27 were cut short; with a tenth of the limit, 29 of 895 others were.
pub fn patience(quick: bool) -> Patience {
    let (seconds, most_link_forces) = if quick { (0.5, 1_000_000) } else { (2.0, 2_000_000_000) };
    Patience { seconds, most_link_forces }
}

/// The rules by which scenes follow from a seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Edition {
    /// Obstacles are planes and spheres. Scenes that once failed are named by a seed and a number of this edition.
    First,
    /// The bodies of the first edition, with boxes, capsules and cylinders among the obstacles.
    Second,
    /// As the second; some bodies of springs have two kinds of them.
    Third,
    /// As the third; some models meet others with their mesh.
    Fourth,
    /// As the fourth, with models among the obstacles, and obstacles that turn or swing.
    Fifth,
    /// As the fifth; up to six bodies of any shapes and sizes in those scenes that have several.
    Sixth,
}

/// Random scene `number` of those that follow from `seed`, in automatic stepping.
pub fn extreme_scene(seed: u64, number: u64) -> Scene {
    extreme(seed, number).0
}

/// A random scene and its disturbances while time runs.
pub fn extreme(seed: u64, number: u64) -> (Scene, Vec<Disturbance>) {
    extreme_of(Edition::Sixth, seed, number)
}

/// A random scene of an edition, and its disturbances.
pub fn extreme_of(edition: Edition, seed: u64, number: u64) -> (Scene, Vec<Disturbance>) {
    // The generator mixes the seed, so that the sequences of neighbouring numbers are not one sequence shifted.
    let mut seeds = Rng::new(seed ^ number.wrapping_mul(0xd134_2543_de82_ef95));
    let mut random = RandomSource(Rng::new(seeds.next_u64()));
    let size = random.log_uniform(-3.0, 3.0);
    let (shape, cell_size) = random.shape(size);
    let springs = random.springs(cell_size);
    let body = random.body(shape, springs, size);
    let mut scene = Scene { bodies: vec![body], obstacles: random.obstacles(size), ..Scene::default() };
    if random.chance(0.2) {
        let other = random.heavier_or_lighter(&scene.bodies[0], springs);
        scene.bodies.push(other);
    }
    scene.settings.dt = random.log_uniform(-4.0, -1.0);
    scene.settings.inversion_recovery = random.chance(0.8);
    scene.settings.integrator =
        if random.chance(0.6) { Integrator::SemiImplicit } else { random.one_of(&Integrator::LIMITED) };
    let strength =
        if random.chance(0.5) { random.one_of(&[0.0, EARTH_GRAVITY, 1000.0]) } else { random.log_uniform(-3.0, 3.0) };
    scene.settings.gravity =
        if random.chance(0.8) { [0.0, -strength, 0.0] } else { random.direction().map(|x| x * strength) };
    // Each feature below has its own draws, so that scenes without it stay the same.
    let mut more = RandomSource(Rng::new(seeds.next_u64()));
    if scene.bodies.len() == 1 && more.chance(INLAID_SHARE) {
        let step = more.log_uniform(-4.3, -1.5);
        more.inlay(&mut scene.bodies[0], cell_size, size, step);
    }
    let mut last = RandomSource(Rng::new(seeds.next_u64()));
    last.add_pins_and_bodies(&mut scene, size);
    scene.settings.body_contact = RandomSource(Rng::new(seeds.next_u64())).chance(BODY_CONTACT_SHARE);
    if edition >= Edition::Second {
        RandomSource(Rng::new(seeds.next_u64())).closed_forms(&mut scene, size);
    }
    if edition >= Edition::Third {
        RandomSource(Rng::new(seeds.next_u64())).other_springs(&mut scene, cell_size, size);
    }
    if edition >= Edition::Fourth && RandomSource(Rng::new(seeds.next_u64())).chance(MESH_CONTACT_SHARE) {
        let models = scene.bodies.iter_mut().filter(|body| matches!(body.shape, Shape::Model(_)));
        models.for_each(|body| body.contact_on = ContactOn::Mesh);
    }
    if edition >= Edition::Fifth {
        RandomSource(Rng::new(seeds.next_u64())).meshes_and_motions(&mut scene, size);
    }
    if edition >= Edition::Sixth && scene.bodies.len() > 1 {
        RandomSource(Rng::new(seeds.next_u64())).unlike_bodies(&mut scene, size);
    }
    let disturbances = disturb::disturbances(&mut more, &scene, size);
    (scene, disturbances)
}

/// The lattices of a scene's bodies; models are those that the program carries.
pub fn lattices(scene: &Scene) -> Result<Vec<Arc<Lattice>>, ResolveError> {
    let resolved = scene.bodies.iter().map(|body| Ok(resolve(&body.shape, Path::new("."), &())?.lattice));
    resolved.collect()
}

impl RandomSource {
    /// A body about `size` (m) large that falls, flies, or starts inside obstacles.
    fn body(&mut self, shape: Shape, springs: Springs, size: f64) -> Body {
        let material = Material::Springs(springs);
        let rotation_deg = self.vector(180.0);
        let mut body =
            Body { shape, material, pose: Pose { position: [0.0, size, 0.0], rotation_deg }, ..Body::default() };
        match self.integer(0, 3) {
            0 => body.pose.position = [self.between(-0.5, 0.5) * size, 1000.0, 0.0],
            1 => {
                let speed = if self.chance(0.5) { 999.0 } else { self.log_uniform(0.0, 2.9) };
                body.velocity = self.direction().map(|x| x * speed);
                if self.chance(0.7) {
                    body.velocity[1] = -body.velocity[1].abs();
                }
            }
            2 => body.pose.position = self.vector(0.7 * size),
            _ => body.velocity = [0.0, -self.log_uniform(-1.0, 1.5), 0.0],
        }
        body
    }

    /// A shape, and the size of its cells (m).
    fn shape(&mut self, size: f64) -> (Shape, f64) {
        let kind = self.between(0.0, 1.0);
        if kind < 0.55 {
            let cells = self.integer(1, 4);
            return (Shape::Cube(CubeShape { cells: cells.unsigned_abs(), size }), size / f64::from(cells));
        }
        if kind < 0.85 {
            let list = self.cells();
            let cell_size = (size / 3.0).max(1e-3);
            return (Shape::Cells(CellsShape { list, size: cell_size }), cell_size);
        }
        let divisions = self.integer(2, 6);
        let path = format!("{}{}", builtin::PREFIX, self.one_of(&MODELS));
        let length = size.max(1e-2);
        let model = ModelShape { path, divisions: divisions.unsigned_abs(), length, ..ModelShape::default() };
        (Shape::Model(model), length / f64::from(divisions))
    }

    /// Some cells of a 3 × 3 × 3 cube, a thin bar or a thin plate.
    fn cells(&mut self) -> Vec<[i32; 3]> {
        match self.integer(0, 3) {
            0 => (0..self.integer(3, 12)).map(|x| [x, 0, 0]).collect(),
            1 => (0..4).flat_map(|x| (0..4).map(move |z| [x, 0, z])).collect(),
            _ => {
                let mut list = vec![[1; 3]];
                list.extend((0..14).map(|_| [0; 3].map(|_| self.integer(0, 2))));
                list
            }
        }
    }

    /// Draws constants over all their decades. Nine materials in ten are kept soft enough for a stable step of some tens of
    /// microseconds or more, as two seconds of the others would take too long.
    fn springs(&mut self, cell_size: f64) -> Springs {
        let particle_mass = self.log_uniform(-6.0, 3.0);
        let (stiffest, most_damping) = if self.chance(0.1) {
            (1e8, 1e5)
        } else {
            let step = self.log_uniform(-4.3, -0.5);
            (particle_mass * cell_size / (step * step), particle_mass * cell_size / step)
        };
        let [structural, shear, bending] = [0; 3].map(|_| Spring {
            stiffness: if self.chance(0.1) { 0.0 } else { (stiffest * self.log_uniform(-4.0, 0.0)).min(1e8) },
            damping: if self.chance(0.4) { 0.0 } else { (most_damping * self.log_uniform(-6.0, 0.0)).min(1e5) },
        });
        Springs { structural, shear, bending, particle_mass }
    }

    /// Makes a body of two solids, in any combination a thousand times as heavy and as stiff as each other, whose stable
    /// step is about `step` (s).
    fn inlay(&mut self, body: &mut Body, cell_size: f64, size: f64, step: f64) {
        let mut solid = |density: f64, lighter: f64| {
            let speed = cell_size / step;
            let softer = if self.chance(0.5) { 1.0 / MAX_MASS_RATIO } else { 1.0 };
            Solid {
                young_modulus: (density * speed * speed * lighter * softer).clamp(1.0, 1e10),
                density,
                damping_ratio: if self.chance(0.4) { 0.0 } else { self.log_uniform(-4.0, -1.0) },
                ..Solid::DEFAULT
            }
        };
        let heavy = if body.velocity[1] < 0.0 { 1e4 } else { 1e2 };
        let [first, second] = [solid(heavy, 1.0 / MAX_MASS_RATIO), solid(heavy / MAX_MASS_RATIO, 1.0)];
        let (outside, inside) = if self.chance(0.5) { (first, second) } else { (second, first) };
        body.material = Material::Solid(outside);
        // This covers about half of the body.
        let end = self.between(-0.2, 0.2) * size;
        body.inlays = vec![Inlay {
            min: [-10.0 * size; 3],
            max: [end, 10.0 * size, 10.0 * size],
            solid: inside,
            ..Inlay::default()
        }];
    }

    /// In some scenes, makes about half of the first body of other springs, up to a thousand times as heavy or light.
    fn other_springs(&mut self, scene: &mut Scene, cell_size: f64, size: f64) {
        let Some(Material::Springs(own)) = scene.bodies.first().map(|body| body.material.clone()) else { return };
        if !self.chance(INLAID_SHARE) {
            return;
        }
        let mut springs = self.springs(cell_size);
        let mass = own.particle_mass;
        springs.particle_mass =
            springs.particle_mass.clamp(mass / MAX_MASS_RATIO, mass * MAX_MASS_RATIO).clamp(1e-6, 1e3);
        let end = self.between(-0.2, 0.2) * size;
        let far = 10.0 * size;
        scene.bodies[0].inlays = vec![Inlay { min: [-far; 3], max: [end, far, far], springs, ..Inlay::default() }];
    }

    fn obstacles(&mut self, size: f64) -> Vec<Obstacle> {
        let ground = Plane { half_extents: [self.log_uniform(0.0, 1.0) * size; 2], ..Plane::default() };
        let mut obstacles = vec![self.obstacle(ObstacleShape::Plane(ground))];
        if self.chance(0.7) {
            let center = self.vector(0.5 * size);
            let radius = (self.log_uniform(-1.5, 0.7) * size).clamp(1e-3, 1e4);
            let sphere = ObstacleShape::Sphere(Sphere { center, radius });
            obstacles.push(self.obstacle(sphere));
        }
        if self.chance(0.3) {
            let rotation_deg = self.vector(180.0);
            let plane =
                Plane { center: self.vector(0.5 * size), rotation_deg, half_extents: [size.max(1e-3), 2.0 * size] };
            obstacles.push(self.obstacle(ObstacleShape::Plane(plane)));
        }
        obstacles
    }

    /// Adds boxes, capsules and cylinders to most scenes, long, flat or thick; in some of them the sphere is removed.
    fn closed_forms(&mut self, scene: &mut Scene, size: f64) {
        if self.chance(0.5) {
            scene.obstacles.retain(|obstacle| !matches!(obstacle.shape, ObstacleShape::Sphere(_)));
        }
        for _ in 0..self.integer(0, 2) {
            let (center, rotation_deg) = (self.vector(0.5 * size), self.vector(180.0));
            let [a, b, c] = [0; 3].map(|_| (self.log_uniform(-1.5, 0.5) * size).clamp(1e-3, 1e4));
            let shape = match self.integer(0, 2) {
                0 => ObstacleShape::Box(Cuboid { center, rotation_deg, half_extents: [a, b, c] }),
                1 => ObstacleShape::Capsule(Capsule { center, rotation_deg, radius: a, half_height: b }),
                _ => ObstacleShape::Cylinder(Cylinder { center, rotation_deg, radius: a, half_height: b }),
            };
            scene.obstacles.push(self.obstacle(shape));
        }
    }

    /// Adds a model to the obstacles of some scenes, and lets one obstacle of some move.
    fn meshes_and_motions(&mut self, scene: &mut Scene, size: f64) {
        if self.chance(MESH_OBSTACLE_SHARE) {
            let path = format!("{}{}", builtin::PREFIX, self.one_of(&OBSTACLE_MODELS));
            let (center, rotation_deg) = (self.vector(0.5 * size), self.vector(180.0));
            let length = (self.log_uniform(-1.0, 0.7) * size).clamp(1e-3, 1e3);
            let mesh = Mesh { path, center, rotation_deg, length, ..Mesh::default() };
            scene.obstacles.push(self.obstacle(ObstacleShape::Mesh(mesh)));
        }
        if self.chance(MOVING_OBSTACLE_SHARE) {
            let axis = self.direction();
            let motion = if self.chance(0.5) {
                let sign = if self.chance(0.5) { 1.0 } else { -1.0 };
                Motion::Turn(Turn { axis, turns_per_sec: sign * self.log_uniform(-2.0, 1.3) })
            } else {
                let amplitude = (self.log_uniform(-2.0, 0.3) * size).min(100.0);
                Motion::Oscillate(Oscillate { axis, amplitude, period_secs: self.log_uniform(-1.0, 1.0) })
            };
            let last = scene.obstacles.len() - 1;
            let number = self.integer(0, i32::try_from(last).unwrap_or(0));
            if let Some(obstacle) = scene.obstacles.get_mut(usize::try_from(number).unwrap_or(0)) {
                obstacle.motion = Some(motion);
            }
        }
    }

    fn obstacle(&mut self, shape: ObstacleShape) -> Obstacle {
        let stiffness = match self.integer(0, 4) {
            0 => ContactStiffness::Given(self.log_uniform(-2.0, 9.0)),
            _ => ContactStiffness::Auto,
        };
        let [friction_static, friction_dynamic] =
            [0; 2].map(|_| if self.chance(0.3) { 0.0 } else { self.log_uniform(-2.0, 1.0) });
        Obstacle { shape, stiffness, friction_static, friction_dynamic, ..Obstacle::default() }
    }

    /// Hangs the first body of some scenes, puts more bodies into some, and keeps some to their own integrator.
    fn add_pins_and_bodies(&mut self, scene: &mut Scene, size: f64) {
        if self.chance(PINNED_SHARE) {
            let mut min = [-10.0 * size; 3];
            min[usize::from(self.chance(0.5))] = self.between(-0.3, 0.4) * size;
            scene.bodies[0].pins = vec![PinBox { min, max: [10.0 * size; 3] }];
        }
        if scene.bodies.len() == 2 && self.chance(0.5) {
            for _ in 0..self.integer(1, 3) {
                let mut other = scene.bodies[usize::from(self.chance(0.5))].clone();
                let away = self.vector(2.0 * size);
                other.pose.position.iter_mut().zip(away).for_each(|(at, away)| *at += away);
                scene.bodies.push(other);
            }
        }
        scene.settings.allow_implicit = !self.chance(0.1);
    }

    /// Adds bodies of their own shapes and springs, up to six in all.
    fn unlike_bodies(&mut self, scene: &mut Scene, size: f64) {
        let room = MAX_BODIES.saturating_sub(scene.bodies.len());
        for _ in 0..self.integer(0, i32::try_from(room).unwrap_or(0)) {
            let own_size = (size * self.log_uniform(-0.6, 0.3)).clamp(1e-3, 1e3);
            let (shape, cell_size) = self.shape(own_size);
            let springs = self.springs(cell_size);
            let mut other = self.body(shape, springs, own_size);
            let (middle, away) = (scene.bodies[0].pose.position, self.vector(1.5 * size));
            other.pose.position = [0, 1, 2].map(|axis| middle[axis] + away[axis]);
            if matches!(other.shape, Shape::Model(_)) && self.chance(MESH_CONTACT_SHARE) {
                other.contact_on = ContactOn::Mesh;
            }
            scene.bodies.push(other);
        }
    }

    /// A copy of the body beside it, with a thousand times or a thousandth of its mass.
    fn heavier_or_lighter(&mut self, body: &Body, springs: Springs) -> Body {
        let heavier =
            springs.particle_mass * if springs.particle_mass < 1.0 { MAX_MASS_RATIO } else { 1.0 / MAX_MASS_RATIO };
        let material = Material::Springs(Springs { particle_mass: heavier.clamp(1e-6, 1e3), ..springs });
        let mut other = Body { material, ..body.clone() };
        other.pose.position[2] += self.between(-0.5, 0.5);
        other
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::disturb::DisturbanceKind;
    use crate::scene::param;

    #[test]
    fn every_scene_is_within_the_ranges_and_can_be_made_again() {
        for number in 0..2000 {
            let scene = extreme_scene(3, number);
            assert_eq!(param::validate(&scene), [], "scene {number}");
            assert_eq!(extreme(3, number), extreme(3, number), "scene {number}");
            for disturbance in extreme(3, number).1 {
                if let DisturbanceKind::Obstacles { scene, .. } = disturbance.kind {
                    assert_eq!(param::validate(&scene), [], "scene {number} after {} s", disturbance.at_secs);
                }
            }
        }
        assert_ne!(extreme_scene(3, 0), extreme_scene(4, 0), "another seed, another scene");
    }

    #[test]
    fn the_second_edition_has_the_bodies_of_the_first() {
        for number in 0..200 {
            let [first, second] = [Edition::First, Edition::Second].map(|edition| extreme_of(edition, 3, number).0);
            assert_eq!(first.bodies, second.bodies, "scene {number}");
            let known = |obstacle: &Obstacle| obstacle.shape.half_thickness().is_none();
            assert!(first.obstacles.iter().all(known), "scene {number} has planes and spheres alone");
        }
    }

    #[test]
    fn the_third_edition_differs_by_springs_within_bodies_alone() {
        for number in 0..200 {
            let [second, mut third] = [Edition::Second, Edition::Third].map(|edition| extreme_of(edition, 3, number).0);
            if matches!(second.bodies[0].material, Material::Springs(_)) {
                third.bodies[0].inlays.clear();
            }
            assert_eq!(second, third, "scene {number}");
        }
    }

    #[test]
    fn the_fourth_edition_differs_by_what_models_meet_with_alone() {
        for number in 0..200 {
            let [third, mut fourth] = [Edition::Third, Edition::Fourth].map(|edition| extreme_of(edition, 3, number).0);
            fourth.bodies.iter_mut().for_each(|body| body.contact_on = ContactOn::Cells);
            assert_eq!(third, fourth, "scene {number}");
        }
    }

    #[test]
    fn the_fifth_edition_adds_models_and_motions_to_obstacles_alone() {
        for number in 0..200 {
            let [fourth, mut fifth] = [Edition::Fourth, Edition::Fifth].map(|edition| extreme_of(edition, 3, number).0);
            fifth.obstacles.retain(|obstacle| !matches!(obstacle.shape, ObstacleShape::Mesh(_)));
            fifth.obstacles.iter_mut().for_each(|obstacle| obstacle.motion = None);
            assert_eq!(fourth, fifth, "scene {number}");
        }
    }

    #[test]
    fn the_sixth_edition_adds_bodies_to_scenes_of_several_alone() {
        for number in 0..200 {
            let [fifth, mut sixth] = [Edition::Fifth, Edition::Sixth].map(|edition| extreme_of(edition, 3, number).0);
            assert!(sixth.bodies.len() <= MAX_BODIES, "scene {number}");
            let several = fifth.bodies.len() > 1;
            assert!(several || sixth.bodies.len() == 1, "scene {number}");
            sixth.bodies.truncate(fifth.bodies.len());
            assert_eq!(fifth, sixth, "scene {number}");
        }
    }

    #[test]
    fn there_is_some_of_everything() {
        let scenes: Vec<Scene> = (0..500).map(|number| extreme_scene(3, number)).collect();
        let some = |what: &str, is: &dyn Fn(&Scene) -> bool| {
            let count = scenes.iter().filter(|scene| is(scene)).count();
            assert!(count > 25, "{what}: {count} of 500");
        };
        some("models", &|scene| matches!(scene.bodies[0].shape, Shape::Model(_)));
        some("models that meet with their mesh", &|scene| scene.bodies[0].contact_on == ContactOn::Mesh);
        some("cells", &|scene| matches!(scene.bodies[0].shape, Shape::Cells(_)));
        some("heights of a kilometre", &|scene| scene.bodies[0].pose.position[1] > 999.0);
        some("a kilometre a second", &|scene| {
            scene.bodies[0].velocity.iter().map(|v| v * v).sum::<f64>() > 990.0 * 990.0
        });
        some("no gravity", &|scene| scene.settings.gravity.iter().all(|g| g.abs() < 1e-9));
        some("great gravity", &|scene| scene.settings.gravity[1] < -999.0);
        some("several bodies", &|scene| scene.bodies.len() > 1);
        let has = |scene: &Scene, is: fn(&ObstacleShape) -> bool| scene.obstacles.iter().any(|o| is(&o.shape));
        some("boxes", &|scene| has(scene, |shape| matches!(shape, ObstacleShape::Box(_))));
        some("capsules", &|scene| has(scene, |shape| matches!(shape, ObstacleShape::Capsule(_))));
        some("cylinders", &|scene| has(scene, |shape| matches!(shape, ObstacleShape::Cylinder(_))));
        some("meshes", &|scene| has(scene, |shape| matches!(shape, ObstacleShape::Mesh(_))));
        let moves = |scene: &Scene, is: fn(&Motion) -> bool| scene.obstacles.iter().any(|o| o.motion.iter().any(is));
        some("turning obstacles", &|scene| moves(scene, |motion| matches!(motion, Motion::Turn(_))));
        some("swinging obstacles", &|scene| moves(scene, |motion| matches!(motion, Motion::Oscillate(_))));
        some("more bodies", &|scene| scene.bodies.len() > 2);
        some("bodies of several shapes", &|scene| scene.bodies.iter().any(|body| body.shape != scene.bodies[0].shape));
        let most = scenes.iter().map(|scene| scene.bodies.len()).max();
        assert_eq!(most, Some(MAX_BODIES), "the most bodies in a scene");
        some("bodies that meet", &|scene| scene.bodies.len() > 1 && scene.settings.body_contact);
        some("pins", &|scene| !scene.bodies[0].pins.is_empty());
        some("no implicit integrator", &|scene| !scene.settings.allow_implicit);
        let inlaid = |scene: &Scene, is_solid: bool| {
            let body = &scene.bodies[0];
            !body.inlays.is_empty() && matches!(body.material, Material::Solid(_)) == is_solid
        };
        some("two solids in a body", &|scene| inlaid(scene, true));
        some("two springs in a body", &|scene| inlaid(scene, false));
        let disturbed = (0..500).filter(|&number| !extreme(3, number).1.is_empty()).count();
        assert!(disturbed > 50, "{disturbed} of 500 are disturbed");
    }
}
