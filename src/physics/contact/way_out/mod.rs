//! The way on which a body gets out of an obstacle that was put into it (its minimum translation): the direction in which
//! the obstacle pushes the whole body, and how far back the obstacle has to start so that nothing of the body is inside.

mod mesh;
mod oriented;
mod points;
mod way;

use glam::DVec3;

use super::narrow::plane::rounding_margin;
use crate::math::{Real, Vector};
use crate::physics::model::{ObstacleShape, PlaneModel};
use crate::physics::state::touch::SampleTouch;
pub(super) use points::MeetingPoints;
pub(super) use way::WayOut;
use way::{SAME_MIDDLE_TOLERANCE, shortest};

/// A plane carries bodies on a side that faces up by more than this cosine.
const MIN_CARRYING_COSINE: f64 = 0.3;

/// What is known of an obstacle and a body from before the obstacle was put elsewhere.
#[derive(Clone, Copy, Debug)]
pub(super) struct PriorContact<'a, R: Real> {
    /// The obstacle as the body met it; none where it is new.
    pub(super) shape: Option<&'a ObstacleShape<R>>,
    /// The number it had then.
    pub(super) obstacle: usize,
    /// The state's rows of sides.
    pub(super) sides: &'a [Vec<i8>],
    /// Where points of meshes touched.
    pub(super) touches: &'a [SampleTouch],
    /// The direction in which the obstacle was coming; none where it was not.
    pub(super) direction: Option<DVec3>,
}

impl<R: Real> PriorContact<'_, R> {
    /// Nothing is known.
    pub(super) fn none() -> Self {
        Self { shape: None, obstacle: 0, sides: &[], touches: &[], direction: None }
    }

    /// The direction to the side on which a particle touched the plane; none where it did not.
    pub(super) fn touched(&self, particle: usize) -> Option<DVec3> {
        let Some(ObstacleShape::Plane(was)) = self.shape else { return None };
        let side = self.sides.get(was.side_row)?[particle];
        (side != 0).then(|| was.normal.to_dvec3() * f64::from(side))
    }

    /// The direction to the side on which a point of a body touched the plane.
    fn touched_by(&self, points: &MeetingPoints<'_, R>, number: usize) -> Option<DVec3> {
        if !points.are_on_mesh() {
            return self.touched(number);
        }
        let Some(ObstacleShape::Plane(was)) = self.shape else { return None };
        let place = (points.number, number, self.obstacle);
        let side = self.touches[self.touches.binary_search_by_key(&place, SampleTouch::place).ok()?].side;
        (side != 0).then(|| was.normal.to_dvec3() * f64::from(side))
    }

    /// The side on which a body stood on the plane; none where it did not stand.
    fn carrying(&self, points: &MeetingPoints<'_, R>) -> Option<DVec3> {
        let down = points.model.gravity.to_dvec3().normalize_or_zero();
        let sum: DVec3 = points.free_points().filter_map(|(number, _)| self.touched_by(points, number)).sum();
        sum.try_normalize().filter(|direction| -direction.dot(down) > MIN_CARRYING_COSINE)
    }
}

/// The shortest way on which a body gets out of an obstacle; none where it is not inside, or no deeper than it was in
/// contact before.
pub(super) fn way_out<R: Real>(
    points: &MeetingPoints<'_, R>,
    shape: &ObstacleShape<R>,
    prior: &PriorContact<'_, R>,
) -> Option<WayOut> {
    match shape {
        ObstacleShape::Plane(plane) => Plate { plane, points, prior }.way_out(),
        ObstacleShape::Sphere { center, radius } => {
            let ball = Ball { center: center.to_dvec3(), radius: radius.to_f64() };
            let was = match prior.shape {
                Some(ObstacleShape::Sphere { center, radius }) => {
                    Some(Ball { center: center.to_dvec3(), radius: radius.to_f64() })
                }
                _ => None,
            };
            ball.way_out(points, was)
        }
        ObstacleShape::Oriented(solid) => oriented::way_out(points, solid, prior.shape),
        ObstacleShape::Mesh(mesh) => mesh::way_out(points, mesh, prior.shape),
    }
}

/// A plane and a body.
struct Plate<'a, R: Real> {
    plane: &'a PlaneModel<R>,
    points: &'a MeetingPoints<'a, R>,
    prior: &'a PriorContact<'a, R>,
}

impl<R: Real> Plate<'_, R> {
    fn way_out(&self) -> Option<WayOut> {
        let normal = self.plane.normal.to_dvec3();
        let carrying = self.prior.carrying(self.points);
        let chosen = self.prior.direction.or(carrying).filter(|direction| direction.dot(normal) != 0.0);
        if chosen.is_none() && !self.is_pierced() {
            return None;
        }
        let out = |direction: DVec3| WayOut { direction, length_m: self.length_m(direction) };
        let found = match chosen {
            Some(direction) => Some(out(normal * direction.dot(normal).signum())),
            None => shortest(self.points.model.gravity.to_dvec3(), [out(normal), out(-normal)].into_iter()),
        };
        found.filter(|out| out.length_m > 0.0)
    }

    /// Whether a line through the body goes through the rectangle.
    fn is_pierced(&self) -> bool {
        let PlaneModel { center, normal, .. } = *self.plane;
        self.points.lines().any(|[a, b]| {
            let [above, below] = [a, b].map(|end| (end - center).dot(normal));
            let apart = above - below;
            let crosses = (above > R::ZERO) != (below > R::ZERO) && apart != R::ZERO;
            crosses && self.is_over(a + (b - a) * (above / apart))
        })
    }

    /// Whether a point is over or under the rectangle.
    fn is_over(&self, at: R::Vec3) -> bool {
        let PlaneModel { center, axes, half_extents, .. } = *self.plane;
        (0..2).all(|axis| (at - center).dot(axes[axis]).abs() <= half_extents[axis])
    }

    /// How far the body reaches behind the plane, beyond how deep it was in contact on that side before, m.
    fn length_m(&self, direction: DVec3) -> f64 {
        let along =
            |plane: &PlaneModel<R>, at: R::Vec3, direction: DVec3| (at - plane.center).to_dvec3().dot(direction);
        let depth = |(number, at): (usize, R::Vec3)| {
            // A point that ends up in the surface itself must not be taken to be on the other side.
            let margin = 4.0 * rounding_margin::<R>(self.plane, at).to_f64();
            let pressed = match self.prior.shape {
                // Points of meshes forget their touches of a plane that was put elsewhere.
                Some(ObstacleShape::Plane(was)) if !self.points.are_on_mesh() => {
                    let side = self.prior.touched(number).filter(|side| side.dot(direction) > 0.0);
                    side.map(|side| (-along(was, at, side)).max(0.0))
                }
                _ => None,
            };
            -along(self.plane, at, direction) - pressed.unwrap_or(-margin)
        };
        self.points.free_points().filter(|(_, at)| self.is_over(*at)).map(depth).fold(0.0, f64::max)
    }
}

/// A sphere.
#[derive(Clone, Copy)]
struct Ball {
    center: DVec3,
    radius: f64,
}

impl Ball {
    fn way_out<R: Real>(self, points: &MeetingPoints<'_, R>, was: Option<Self>) -> Option<WayOut> {
        let &MeetingPoints { model, body, .. } = points;
        let free = || points.free_points().map(|(_, at)| at.to_dvec3());
        // A particle may stay as deep as it was in contact before.
        let allowed = |at: DVec3| was.map_or(0.0, |was| was.depth(at).max(0.0));
        let margin = 8.0 * R::EPSILON.to_f64() * (self.radius + self.center.abs().max_element());
        if !free().any(|at| self.depth(at) > allowed(at) + margin) {
            return None;
        }
        let length_m = |direction: DVec3| {
            let distance_out = |at: DVec3| {
                let radius = (self.radius - allowed(at) + margin).max(0.0);
                let from = at - self.center;
                let along = from.dot(direction);
                let reach = along * along - from.length_squared() + radius * radius;
                if reach > 0.0 { reach.sqrt() - along } else { 0.0 }
            };
            free().map(distance_out).fold(0.0, f64::max)
        };
        let gravity = model.gravity.to_dvec3();
        let up = (-gravity).try_normalize().unwrap_or(DVec3::Y);
        let radial = points.middle() - self.center;
        let level = radial - up * radial.dot(up);
        // Where the middles coincide, the vector between them is rounding error and no direction.
        let least = SAME_MIDDLE_TOLERANCE * body.size.to_f64();
        let told = |direction: &DVec3| direction.length() > least;
        let directions = [radial, level].into_iter().filter(told).chain([up]).filter_map(DVec3::try_normalize);
        shortest(gravity, directions.map(|direction| WayOut { direction, length_m: length_m(direction) }))
    }

    /// How deep a point is inside, m.
    fn depth(self, at: DVec3) -> f64 {
        self.radius - at.distance(self.center)
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::physics::Simulation;
    use crate::scene::obstacle::{Capsule, Cuboid, Cylinder, Plane, Sphere};
    use crate::scene::resolve::resolve;
    use crate::scene::{Body, Obstacle, ObstacleShape as Shape, Scene};

    /// The way out of an obstacle that is new, for the default cube with its middle at the origin.
    fn out_of(shape: Shape) -> Option<WayOut> {
        let mut scene = Scene { bodies: vec![Body::default()], ..Scene::default() };
        scene.bodies[0].pose.position = [0.0; 3];
        scene.obstacles = vec![Obstacle { shape, ..Obstacle::default() }];
        let jelly = resolve(&scene.bodies[0].shape, Path::new("."), &()).expect("a cube");
        let simulation = Simulation::<f64>::new(&scene, &[jelly.lattice]);
        let (model, state) = (simulation.model(), simulation.state());
        let points = MeetingPoints::new(model, simulation.plan(), 0, &state.position);
        way_out(&points, &model.obstacles[0].shape, &PriorContact::none())
    }

    fn upright(x: f64) -> Shape {
        Shape::Plane(Plane { center: [x, 0.0, 0.0], rotation_deg: [0.0, 0.0, 90.0], half_extents: [3.0; 2] })
    }

    fn level(y: f64) -> Shape {
        Shape::Plane(Plane { center: [0.0, y, 0.0], rotation_deg: [0.0; 3], half_extents: [3.0; 2] })
    }

    fn ball(center: [f64; 3], radius: f64) -> Shape {
        Shape::Sphere(Sphere { center, radius })
    }

    fn check(shape: &Shape, direction: DVec3, length_m: f64) {
        let out = out_of(shape.clone()).expect("inside");
        assert!(out.direction.distance(direction) < 1e-9, "{shape:?}: {out:?}");
        assert!((out.length_m - length_m).abs() < 1e-6, "{shape:?}: {out:?}, not {length_m} m");
    }

    #[test]
    fn a_plane_moves_a_body_to_the_nearer_side_and_rather_up_than_down() {
        check(&upright(0.2), DVec3::NEG_X, 0.3);
        check(&upright(-0.4), DVec3::X, 0.1);
        check(&level(0.2), DVec3::Y, 0.7);
        check(&level(0.45), DVec3::NEG_Y, 0.05);
    }

    #[test]
    fn a_ball_moves_a_body_along_the_line_of_their_middles_or_up() {
        // The nearest particles are half a cell of 1/9 m beside the line in both directions.
        check(&ball([-0.6, 0.0, 0.0], 0.4), DVec3::X, (0.16_f64 - 2.0 / 324.0).sqrt() - 0.1);
        check(&ball([0.0; 3], 0.1), DVec3::Y, (0.01_f64 - 2.0 / 324.0).sqrt() + 0.5);
        let sideways = out_of(ball([0.1, 0.3, 0.0], 0.3)).expect("inside");
        assert!(sideways.direction.distance(DVec3::NEG_X) < 1e-9, "not down through the body: {sideways:?}");
    }

    #[test]
    fn a_closed_form_moves_a_body_along_one_of_its_axes_or_up() {
        let cuboid = |center: [f64; 3], half_extents| {
            Shape::Box(Cuboid { center, rotation_deg: [0.0, 30.0, 0.0], half_extents })
        };
        // It reaches 0.1 m into the body from below, from above and as a board within, thinner than a cell.
        check(&cuboid([0.0, -0.6, 0.0], [2.0, 0.2, 2.0]), DVec3::Y, 0.1);
        check(&cuboid([0.0, 0.5, 0.0], [2.0, 0.1, 2.0]), DVec3::NEG_Y, 0.1);
        check(&cuboid([0.0, -0.4, 0.0], [2.0, 0.001, 2.0]), DVec3::Y, 0.101);
        let rod = |x: f64| {
            let (center, rotation_deg) = ([x, 0.0, 0.0], [90.0, 0.0, 0.0]);
            Shape::Cylinder(Cylinder { center, rotation_deg, radius: 0.2, half_height: 2.0 })
        };
        // The nearest particles are half a cell of 1/9 m above and below its middle.
        check(&rod(-0.6), DVec3::X, (0.04_f64 - 1.0 / 324.0).sqrt() - 0.1);
        let capsule = Capsule { center: [0.0, -0.6, 0.0], rotation_deg: [0.0; 3], radius: 0.2, half_height: 0.1 };
        let up = out_of(Shape::Capsule(capsule)).expect("inside");
        assert!(up.direction.distance(DVec3::Y) < 1e-9 && up.length_m > 0.15, "{up:?}");
    }

    #[test]
    fn what_is_beside_a_body_is_not_inside() {
        for shape in [upright(0.6), level(-0.51), ball([0.0, 1.0, 0.0], 0.4)] {
            assert_eq!(out_of(shape.clone()), None, "{shape:?}");
        }
        let beside = Cuboid { center: [0.0, 0.8, 0.0], rotation_deg: [0.0; 3], half_extents: [1.0, 0.29, 1.0] };
        assert_eq!(out_of(Shape::Box(beside)), None, "a box above it");
        let small = Plane { center: [0.0, 0.0, 2.0], rotation_deg: [0.0; 3], half_extents: [1.0; 2] };
        assert_eq!(out_of(Shape::Plane(small)), None, "the rectangle ends before the body");
    }
}
