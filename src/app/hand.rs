//! What the pointer holds in the view: the jelly at a point of its surface, or an obstacle that is not a plane. Pure:
//! pictures and rays in, commands out; knows neither a window nor which button was pressed.

use glam::Vec3;

use crate::math::Aabb;
use crate::scene::edit::{BodyId, Edit, ObstacleId};
use crate::scene::{ObstacleShape, Scene};
use crate::session::{Command, Pull};
use crate::view::draw_list::Selected;
use crate::view::pick::nearest;
use crate::view::{DrawList, Hit, Ray, Solid, Thing};

/// Something in the view that can be chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// A body.
    Body(BodyId),
    /// An obstacle.
    Obstacle(ObstacleId),
}

/// Finds the body or obstacle that a line of sight meets first.
pub fn target(scene: &Scene, draw_list: &DrawList, ray: &Ray) -> Option<(Target, Hit)> {
    let hit = nearest(draw_list, ray)?;
    // Hidden things are in the scene, not in the picture.
    let target = match hit.what {
        Thing::Skin { skin, .. } => {
            let mut shown = scene.bodies.iter().enumerate().filter(|(_, body)| !body.hidden);
            Target::Body(BodyId(shown.nth(skin)?.0))
        }
        Thing::Solid(solid) => {
            let mut shown = scene.obstacles.iter().enumerate().filter(|(_, obstacle)| !obstacle.hidden);
            Target::Obstacle(ObstacleId(shown.nth(solid)?.0))
        }
    };
    Some((target, hit))
}

/// Whether the pointer can take hold of a thing directly: the jelly to pull it, an obstacle to move it. A plane lies under
/// everything and would be moved by accident; it is moved by its handles only.
pub fn can_be_held(scene: &Scene, target: Target) -> bool {
    match target {
        Target::Body(_) => true,
        Target::Obstacle(id) => {
            scene.obstacles.get(id.0).is_some_and(|obstacle| !matches!(obstacle.shape, ObstacleShape::Plane(_)))
        }
    }
}

/// A body or obstacle as the picture names it; `None` if it is hidden.
pub fn selected(scene: &Scene, target: Target) -> Option<Selected> {
    match target {
        Target::Body(id) => {
            scene.bodies.get(id.0).filter(|body| !body.hidden)?;
            Some(Selected::Skin(scene.bodies[..id.0].iter().filter(|body| !body.hidden).count()))
        }
        Target::Obstacle(id) => {
            scene.obstacles.get(id.0).filter(|obstacle| !obstacle.hidden)?;
            Some(Selected::Solid(scene.obstacles[..id.0].iter().filter(|obstacle| !obstacle.hidden).count()))
        }
    }
}

/// The box around a body or obstacle in the picture, m; `None` if it is hidden.
pub fn bounds(scene: &Scene, draw_list: &DrawList, target: Target) -> Option<Aabb<f32>> {
    match selected(scene, target)? {
        Selected::Skin(place) => {
            let skin = &draw_list.skins.get(place)?.skin;
            Some(Aabb::around(skin.vertices().iter().map(|vertex| vertex.place(&draw_list.particles))))
        }
        Selected::Solid(place) => draw_list.solids.get(place).map(Solid::bounds),
    }
}

/// The scalar at a point of a skin, in the picture's unit; `None` if no scalar is shown.
pub fn value_at(draw_list: &DrawList, hit: &Hit) -> Option<f32> {
    let Thing::Skin { weights, .. } = &hit.what else { return None };
    let scalars = draw_list.scalars.as_ref()?;
    weights.iter().map(|&(particle, weight)| Some(scalars.get(particle as usize)? * weight)).sum()
}

/// What the pointer holds.
#[derive(Clone, Debug, Default)]
pub struct Hand {
    held: Option<ThingDrag>,
}

/// A held thing, and the plane across the line of sight in which it is moved.
#[derive(Clone, Debug)]
struct ThingDrag {
    thing: HeldThing,
    point: Vec3,
    normal: Vec3,
    /// Where the pointer wants the held point to be, m.
    pointer_target: Vec3,
}

#[derive(Clone, Debug)]
enum HeldThing {
    Jelly { body: BodyId, weights: Vec<(u32, f32)> },
    Obstacle { obstacle: ObstacleId, center_from_point: Vec3 },
}

impl Hand {
    /// Takes hold of the thing under a line of sight. `forward` is the direction in which the camera looks.
    pub fn take(&mut self, scene: &Scene, draw_list: &DrawList, ray: &Ray, forward: Vec3) -> Option<Target> {
        let (target, hit) = target(scene, draw_list, ray)?;
        let thing = match (target, hit.what) {
            (Target::Body(body), Thing::Skin { weights, .. }) => HeldThing::Jelly { body, weights },
            (Target::Obstacle(obstacle), _) => {
                let held = scene.obstacles.get(obstacle.0).filter(|_| can_be_held(scene, target))?;
                let center = glam::DVec3::from(held.shape.center()).as_vec3();
                HeldThing::Obstacle { obstacle, center_from_point: center - hit.point }
            }
            (Target::Body(_), Thing::Solid(_)) => return None,
        };
        self.held = Some(ThingDrag { thing, point: hit.point, normal: forward, pointer_target: hit.point });
        Some(target)
    }

    /// Whether anything is held.
    pub fn holds(&self) -> bool {
        self.held.is_some()
    }

    /// The point of the jelly that is pulled, and its target, m; `None` if no jelly is held.
    pub fn pulled(&self, draw_list: &DrawList) -> Option<[Vec3; 2]> {
        let held = self.held.as_ref()?;
        let HeldThing::Jelly { weights, .. } = &held.thing else { return None };
        let place = |particle: u32| draw_list.particles.get(particle as usize).map(|at| Vec3::from(*at));
        let terms = weights.iter().map(|&(particle, weight)| Some(place(particle)? * weight));
        Some([terms.sum::<Option<Vec3>>()?, held.pointer_target])
    }

    /// Moves the held thing to another line of sight.
    pub fn drag(&mut self, scene: &Scene, ray: &Ray) -> Option<Command> {
        let held = self.held.as_mut()?;
        let to = ray.at(ray.hit_plane(held.point, held.normal)?);
        held.pointer_target = to;
        match &held.thing {
            HeldThing::Jelly { body, weights } => {
                let pull = Pull { body: *body, weights: weights.clone(), target: to.to_array() };
                Some(Command::Grab(Some(pull)))
            }
            HeldThing::Obstacle { obstacle, center_from_point } => {
                let old = scene.obstacles.get(obstacle.0)?;
                let mut moved = old.clone();
                *moved.shape.center_mut() = (to + *center_from_point).as_dvec3().to_array();
                Some(Command::Drag(Edit::Obstacle(*obstacle, Box::new(moved))))
            }
        }
    }

    /// Lets go. Returns the command for the session, if anything was held.
    pub fn release(&mut self) -> Option<Command> {
        self.held.take().map(|held| match held.thing {
            HeldThing::Jelly { .. } => Command::Grab(None),
            HeldThing::Obstacle { .. } => Command::EndEdit,
        })
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::scene::obstacle::Cuboid;
    use crate::scene::presets::preset;
    use crate::session::Session;

    /// The default scene as it starts: a cube around (0, 1, 0), a ball at (1.5, 0.4, −0.3), the ground.
    fn picture() -> (Scene, DrawList) {
        let scene = (preset("cube-on-plane").expect("a preset").build)();
        let mut session = Session::new(scene.clone(), PathBuf::new(), String::new()).expect("it resolves");
        (scene, session.draw_list())
    }

    fn from_the_front(x: f32, y: f32) -> Ray {
        Ray { origin: Vec3::new(x, y, 5.0), direction: Vec3::NEG_Z }
    }

    #[test]
    fn the_jelly_is_pulled_by_the_point_it_was_taken_at() {
        let (scene, draw_list) = picture();
        let mut hand = Hand::default();
        let taken = hand.take(&scene, &draw_list, &from_the_front(0.1, 1.0), Vec3::NEG_Z);
        assert_eq!(taken, Some(Target::Body(BodyId(0))));
        let Some(Command::Grab(Some(pull))) = hand.drag(&scene, &from_the_front(0.6, 1.5)) else {
            panic!("the jelly is pulled")
        };
        let sum: f32 = pull.weights.iter().map(|(_, weight)| weight).sum();
        assert!((sum - 1.0).abs() < 1e-5, "the weights sum to {sum}");
        let at = pull.weights.iter().fold(Vec3::ZERO, |sum, &(particle, weight)| {
            sum + Vec3::from(draw_list.particles[particle as usize]) * weight
        });
        assert!((at - Vec3::new(0.1, 1.0, at.z)).length() < 1e-4, "the weights are those of the point: {at}");
        let to = Vec3::from(pull.target);
        assert!((to - Vec3::new(0.6, 1.5, at.z)).length() < 1e-4, "pulled across the line of sight, to {to}");
        let [from, shown] = hand.pulled(&draw_list).expect("the pull can be shown");
        assert!(from.distance(at) < 1e-5 && shown == to, "from the point to the pointer: {from}, {shown}");
        assert!(matches!(hand.release(), Some(Command::Grab(None))), "and let go");
        assert!(hand.release().is_none(), "once");
    }

    #[test]
    fn a_ball_moves_with_the_pointer_without_a_jump() {
        let (scene, draw_list) = picture();
        let mut hand = Hand::default();
        let taken = hand.take(&scene, &draw_list, &from_the_front(1.6, 0.5), Vec3::NEG_Z);
        assert_eq!(taken, Some(Target::Obstacle(ObstacleId(1))));
        let Some(Command::Drag(Edit::Obstacle(_, moved))) = hand.drag(&scene, &from_the_front(1.6, 0.9)) else {
            panic!("the ball is moved")
        };
        let ObstacleShape::Sphere(ball) = moved.shape else { panic!("a ball stays one") };
        let off = glam::DVec3::from(ball.center).distance(glam::DVec3::new(1.5, 0.8, -0.3));
        assert!(off < 1e-5, "0.4 m up, like the pointer: {:?}", ball.center);
        assert!(matches!(hand.release(), Some(Command::EndEdit)), "the drag is one change");
    }

    #[test]
    fn a_box_is_held_by_the_side_it_was_taken_at_and_stays_as_it_is_turned() {
        let (mut scene, _) = picture();
        let turned = Cuboid { center: [-1.5, 0.5, 0.0], rotation_deg: [0.0, 30.0, 0.0], half_extents: [0.3; 3] };
        scene.obstacles[1].shape = ObstacleShape::Box(turned);
        let mut session = Session::new(scene.clone(), PathBuf::new(), String::new()).expect("it resolves");
        let mut hand = Hand::default();
        let taken = hand.take(&scene, &session.draw_list(), &from_the_front(-1.4, 0.6), Vec3::NEG_Z);
        assert_eq!(taken, Some(Target::Obstacle(ObstacleId(1))));
        let Some(Command::Drag(Edit::Obstacle(_, moved))) = hand.drag(&scene, &from_the_front(-1.4, 1.0)) else {
            panic!("the box is moved")
        };
        let ObstacleShape::Box(moved) = moved.shape else { panic!("a box stays one") };
        assert!((moved.center[1] - 0.9).abs() < 1e-5, "0.4 m up, like the pointer: {:?}", moved.center);
        assert_eq!(Cuboid { center: turned.center, ..moved }, turned, "and nothing else");
    }

    #[test]
    fn the_ground_is_chosen_but_not_held_and_nothing_is_neither() {
        let (scene, draw_list) = picture();
        let down = Ray { origin: Vec3::new(-3.0, 4.0, 0.0), direction: Vec3::NEG_Y };
        let (found, _) = target(&scene, &draw_list, &down).expect("the ground lies there");
        assert_eq!(found, Target::Obstacle(ObstacleId(0)));
        assert!(!can_be_held(&scene, found), "it lies under everything");
        let mut hand = Hand::default();
        assert_eq!(hand.take(&scene, &draw_list, &down, Vec3::NEG_Y), None);
        assert!(target(&scene, &draw_list, &from_the_front(-3.0, 4.0)).is_none(), "the sky");
    }

    #[test]
    fn hidden_things_are_not_under_the_pointer_but_keep_their_numbers() {
        let (mut scene, _) = picture();
        scene.obstacles[0].hidden = true;
        let mut session = Session::new(scene.clone(), PathBuf::new(), String::new()).expect("it resolves");
        let (found, _) = target(&scene, &session.draw_list(), &from_the_front(1.5, 0.4)).expect("the ball");
        assert_eq!(selected(&scene, found), Some(Selected::Solid(0)), "the first that is drawn");
        assert_eq!(selected(&scene, Target::Obstacle(ObstacleId(0))), None, "the hidden one has no outline");
        assert_eq!(found, Target::Obstacle(ObstacleId(1)), "the second obstacle, though the first is not drawn");
    }

    #[test]
    fn the_value_under_the_pointer_is_that_of_the_particles_there() {
        let (scene, mut draw_list) = picture();
        let (_, hit) = target(&scene, &draw_list, &from_the_front(0.1, 1.0)).expect("the cube");
        assert_eq!(value_at(&draw_list, &hit), None, "the jelly's own colour has no value");
        draw_list.scalars = Some(std::sync::Arc::new(vec![7.0; draw_list.particles.len()]));
        let value = value_at(&draw_list, &hit).expect("a value");
        assert!((value - 7.0).abs() < 1e-4, "seven everywhere: {value}");
    }
}
