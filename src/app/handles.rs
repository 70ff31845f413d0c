//! The handles of the chosen obstacle: which one is under the pointer, and what a drag does to the obstacle.
//! Pure: knows neither a window nor which button was pressed.

use glam::{DMat3, DVec3, Vec2};

use super::hand::Target;
use crate::math::rotation::{from_euler_deg, to_euler_deg};
use crate::scene::edit::{Edit, ObstacleId};
use crate::scene::{Obstacle, ObstacleShape, Scene};
use crate::session::{Command, Status};
use crate::view::gizmo::{Drag, Gizmo, Handle};
use crate::view::style::OverlayColors;
use crate::view::{Camera, Overlay};

/// How the view is seen: the camera, the view's size in points, and the pointer from its upper left corner in points.
#[derive(Clone, Copy, Debug)]
pub struct PointerView {
    /// The camera.
    pub camera: Camera,
    /// Width and height of the view, points.
    pub size: Vec2,
    /// The pointer, points from the view's upper left corner.
    pub pointer: Vec2,
}

/// The chosen thing of a scene, at a time: an obstacle with a motion of its own moves on.
#[derive(Clone, Copy, Debug)]
pub struct Chosen<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The chosen body or obstacle, if any.
    pub target: Option<Target>,
    /// The simulated time, s.
    pub secs: f64,
}

impl<'a> Chosen<'a> {
    /// The chosen thing of a scene as it is now.
    pub fn of(scene: &'a Scene, target: Option<Target>, status: &Status) -> Self {
        Self { scene, target, secs: status.time_secs }
    }
}

/// The handles of the chosen obstacle.
#[derive(Clone, Debug, Default)]
pub struct Handles {
    hot: Option<Handle>,
    held: Option<HandleDrag>,
}

/// A handle that is dragged, and the state at the beginning of the drag.
#[derive(Clone, Debug)]
struct HandleDrag {
    id: ObstacleId,
    start: Obstacle,
    /// The rotation that the obstacle's own motion had given it.
    turned: DMat3,
    gizmo: Gizmo,
    handle: Handle,
    from: PointerView,
}

impl Handles {
    /// Notes that the pointer has moved. Returns whether another handle than before is highlighted.
    pub fn hover(&mut self, chosen: Chosen<'_>, pointer_view: &PointerView) -> bool {
        if self.held.is_some() {
            return false;
        }
        let hot = handle_at(chosen, pointer_view).map(|(_, _, handle)| handle);
        std::mem::replace(&mut self.hot, hot) != hot
    }

    /// Takes hold of the handle under the pointer. Returns whether there is one.
    pub fn take(&mut self, chosen: Chosen<'_>, pointer_view: &PointerView) -> bool {
        self.held = handle_at(chosen, pointer_view).map(|(id, gizmo, handle)| {
            let start = chosen.scene.obstacles[id.0].clone();
            let (_, turned) = start.moved(chosen.secs);
            HandleDrag { id, start, turned, gizmo, handle, from: *pointer_view }
        });
        self.hot = self.held.as_ref().map(|held| held.handle).or(self.hot);
        self.held.is_some()
    }

    /// Whether a handle is held.
    pub fn holds(&self) -> bool {
        self.held.is_some()
    }

    /// Drags the held handle to another place, points from the view's upper left corner.
    pub fn drag(&self, to: Vec2) -> Option<Command> {
        let HandleDrag { id, start, turned, gizmo, handle, from } = self.held.as_ref()?;
        let drag = gizmo.drag(&from.camera, from.size, *handle, from.pointer, to)?;
        let obstacle = Obstacle { shape: dragged(start.shape.clone(), turned, drag), ..start.clone() };
        Some(Command::Drag(Edit::Obstacle(*id, Box::new(obstacle))))
    }

    /// Lets go. Returns the command for the session, if a handle was held.
    pub fn release(&mut self) -> Option<Command> {
        self.held.take().map(|_| Command::EndEdit)
    }

    /// Lets go and puts the obstacle back. Returns the command for the session, if a handle was held.
    pub fn cancel(&mut self) -> Option<Command> {
        self.held.take().map(|_| Command::CancelEdit)
    }

    /// Draws the handles of the chosen obstacle.
    pub fn add_to(&self, tools: &mut Overlay, chosen: Chosen<'_>, pointer_view: &PointerView, colors: &OverlayColors) {
        if let Some((_, gizmo)) = gizmo_of(chosen) {
            gizmo.add_to(tools, &pointer_view.camera, pointer_view.size, self.hot, colors);
        }
    }
}

/// Whether a handle lies under the pointer.
pub fn is_on_handle(chosen: Chosen<'_>, pointer_view: &PointerView) -> bool {
    handle_at(chosen, pointer_view).is_some()
}

fn handle_at(chosen: Chosen<'_>, pointer_view: &PointerView) -> Option<(ObstacleId, Gizmo, Handle)> {
    let (id, gizmo) = gizmo_of(chosen)?;
    let handle = gizmo.hit(&pointer_view.camera, pointer_view.size, pointer_view.pointer)?;
    Some((id, gizmo, handle))
}

fn gizmo_of(chosen: Chosen<'_>) -> Option<(ObstacleId, Gizmo)> {
    let Some(Target::Obstacle(id)) = chosen.target else { return None };
    let obstacle = chosen.scene.obstacles.get(id.0).filter(|obstacle| !obstacle.hidden)?;
    let (way, _) = obstacle.moved(chosen.secs);
    let center = (DVec3::from(obstacle.shape.center()) + way).as_vec3();
    Some((id, Gizmo::new(center, obstacle.shape.rotation_deg().is_some())))
}

/// The shape of an obstacle after a drag of its drawn place, which its own motion has `turned`.
fn dragged(mut shape: ObstacleShape, turned: &DMat3, drag: Drag) -> ObstacleShape {
    match drag {
        Drag::Move(way) => {
            *shape.center_mut() = (DVec3::from(shape.center()) + way.as_dvec3()).to_array();
        }
        Drag::Turn { axis, angle_rad } => {
            if let Some(rotation_deg) = shape.rotation_deg_mut() {
                let turn = DMat3::from_axis_angle(axis.as_dvec3(), f64::from(angle_rad));
                let own = turned.transpose() * turn * *turned;
                *rotation_deg = to_euler_deg(&(own * from_euler_deg(*rotation_deg)));
            }
        }
    }
    shape
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::scene::obstacle::{Cuboid, Cylinder, Motion, Oscillate, Sphere};
    use crate::scene::presets::preset;

    const SIZE: Vec2 = Vec2::new(800.0, 600.0);
    const GROUND: Option<Target> = Some(Target::Obstacle(ObstacleId(0)));
    const BALL: Option<Target> = Some(Target::Obstacle(ObstacleId(1)));

    fn scene() -> Scene {
        (preset("cube-on-plane").expect("a preset").build)()
    }

    /// The chosen thing of a scene at its start.
    fn of(scene: &Scene, target: Option<Target>) -> Chosen<'_> {
        Chosen { scene, target, secs: 0.0 }
    }

    /// From the front, a little from above.
    fn pointer_view(pointer: Vec2) -> PointerView {
        let target = Vec3::new(0.0, 0.3, 0.0);
        let camera = Camera { eye: target + Vec3::new(1.0, 2.0, 8.0), target, up: Vec3::Y, fov_rad: 0.7 };
        PointerView { camera, size: SIZE, pointer }
    }

    /// The first pixel on a line across the view with a handle of the wanted kind.
    fn find(chosen: Option<Target>, wanted: impl Fn(Handle) -> bool) -> PointerView {
        let pixels = (0..600).flat_map(|y| (0..800).step_by(3).map(move |x| Vec2::new(x as f32, y as f32)));
        let mut views = pixels.map(pointer_view);
        let found =
            views.find(|pointer_view| handle_at(of(&scene(), chosen), pointer_view).is_some_and(|(_, _, h)| wanted(h)));
        found.expect("there is such a handle in the view")
    }

    fn drag(chosen: Option<Target>, wanted: impl Fn(Handle) -> bool, way: Vec2) -> ObstacleShape {
        let mut handles = Handles::default();
        let pointer_view = find(chosen, wanted);
        assert!(handles.take(of(&scene(), chosen), &pointer_view), "there is a handle under the pointer");
        let Some(Command::Drag(Edit::Obstacle(_, moved))) = handles.drag(pointer_view.pointer + way) else {
            panic!("dragging it changes the obstacle")
        };
        assert!(matches!(handles.release(), Some(Command::EndEdit)) && !handles.holds(), "and is one change");
        moved.shape
    }

    #[test]
    fn an_arrow_moves_a_ball_along_its_axis_alone() {
        let ObstacleShape::Sphere(ball) = drag(BALL, |handle| handle == Handle::Arrow(1), Vec2::new(5.0, -40.0)) else {
            panic!("a ball stays one")
        };
        let [x, y, z] = ball.center;
        assert!((x - 1.5).abs() < 1e-6 && (z + 0.3).abs() < 1e-6 && y > 0.5, "up, and nowhere else: {:?}", ball.center);
    }

    #[test]
    fn a_cylinder_is_turned_by_a_ring_about_its_own_middle() {
        let cylinder = ObstacleShape::Cylinder(Cylinder::default());
        let turned = dragged(cylinder, &DMat3::IDENTITY, Drag::Turn { axis: Vec3::Z, angle_rad: 0.5 });
        let off = DVec3::from(turned.center()).distance(DVec3::from(Cylinder::default().center));
        assert!(off < 1e-12, "it stays where it is");
        let [x, y, z] = turned.rotation_deg().expect("it has been turned");
        assert!(x.abs() + y.abs() < 1e-5 && (z - 0.5_f64.to_degrees()).abs() < 1e-4, "about z alone: {x}, {y}, {z}");
        let ball = ObstacleShape::Sphere(Sphere::default());
        assert_eq!(
            dragged(ball.clone(), &DMat3::IDENTITY, Drag::Turn { axis: Vec3::Z, angle_rad: 0.5 }),
            ball,
            "nobody sees a ball turn"
        );
    }

    #[test]
    fn a_drag_that_is_cancelled_puts_the_obstacle_back() {
        let mut handles = Handles::default();
        assert!(handles.cancel().is_none(), "nothing is held");
        assert!(handles.take(of(&scene(), BALL), &find(BALL, |handle| handle == Handle::Arrow(1))), "a handle is held");
        assert!(matches!(handles.cancel(), Some(Command::CancelEdit)) && !handles.holds(), "and let go");
    }

    #[test]
    fn a_ring_turns_the_ground_about_its_middle() {
        let turned = drag(GROUND, |handle| matches!(handle, Handle::Ring(_)), Vec2::new(30.0, 30.0));
        let ObstacleShape::Plane(plane) = turned else { panic!("a plane stays one") };
        let angle = plane.rotation_deg.iter().fold(0.0_f64, |largest, angle| largest.max(angle.abs()));
        assert!(DVec3::from(plane.center).length() < 1e-9 && angle > 1.0, "turned where it lies: {plane:?}");
    }

    #[test]
    fn only_a_visible_obstacle_has_handles_and_the_one_under_the_pointer_stands_out() {
        let on_arrow = find(GROUND, |handle| handle == Handle::Arrow(1));
        let mut handles = Handles::default();
        assert!(handles.hover(of(&scene(), GROUND), &on_arrow), "the pointer comes over it");
        assert!(!handles.hover(of(&scene(), GROUND), &on_arrow), "and stays there");
        assert!(handles.hover(of(&scene(), None), &on_arrow), "nothing is chosen any more");
        let mut hidden = scene();
        hidden.obstacles[0].hidden = true;
        assert!(!is_on_handle(of(&hidden, GROUND), &on_arrow), "what is not seen has no handles");
    }

    #[test]
    fn an_obstacle_that_moves_has_its_handles_where_it_is_and_is_turned_as_it_is_seen() {
        let mut scene = scene();
        let swing = Oscillate { axis: [1.0, 0.0, 0.0], amplitude: 2.0, period_secs: 4.0 };
        scene.obstacles[1].motion = Some(Motion::Oscillate(swing));
        let center = |secs| {
            let (_, gizmo) = gizmo_of(Chosen { scene: &scene, target: BALL, secs }).expect("it is there");
            gizmo.center
        };
        assert!((center(1.0) - center(0.0)).distance(Vec3::X * 2.0) < 1e-6, "at the end of its swing");
        // Half a turn about y has reversed x and z: a turn about the visible x is a turn about the obstacle's own −x.
        let half = DMat3::from_rotation_y(std::f64::consts::PI);
        let cuboid = ObstacleShape::Box(Cuboid::default());
        let turned = dragged(cuboid, &half, Drag::Turn { axis: Vec3::X, angle_rad: 0.5 });
        let own = from_euler_deg(turned.rotation_deg().expect("it has been turned"));
        let seen = half * own * half.transpose();
        let off = seen.y_axis.distance(DMat3::from_rotation_x(0.5).y_axis);
        assert!(off < 1e-6, "turned as the ring was: {off}");
    }
}
