//! Finds where something new goes: near where a person looks, on what is there, apart from other things.
//!
//! Where there is room a new thing stands beside the others, not on them: it gets a column of its own, from the ground up.
//! Columns are tried on a grid around the place looked at, nearest first. Columns to its left and right come before those
//! behind or in front of it, where one thing would hide the other. Where no column is free, as on a small floor, things are
//! stacked.

use glam::{DVec2, DVec3};

use super::obstacle::{ObstacleShape, Plane};
use super::{Obstacle, Scene};
use crate::math::{Aabb, rotation};

/// Planes steeper than this carry nothing: sine of their slope.
const MAX_FLOOR_SLOPE: f64 = 0.77;
/// Room between two things, in sizes of the new one.
const GAP_IN_SIZES: f64 = 0.25;
/// Columns tried on either side of the place looked at; they are half a size apart.
const GRID_RADIUS: i32 = 40;
/// A column behind or in front of the place looked at counts as this many times as far away as one beside it.
const DEPTH_COST_FACTOR: f64 = 1.6;
/// A floor more than this many sizes above the place looked at is a roof: nothing is put on it.
const ROOF_HEIGHT_IN_SIZES: f64 = 2.5;

/// Where a person looks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Look {
    /// The point looked at, m.
    pub at: DVec3,
    /// The direction of sight; any length.
    pub ahead: DVec3,
}

/// What is there already.
#[derive(Clone, Debug, Default)]
pub struct Surroundings {
    /// The boxes around the bodies as they are now, m.
    bodies: Vec<Aabb<f64>>,
    /// The boxes around the obstacles that carry nothing, m.
    blocks: Vec<Aabb<f64>>,
    floors: Vec<Floor>,
}

/// A plane that carries things.
#[derive(Clone, Copy, Debug)]
struct Floor {
    plane: Plane,
    axes: [DVec3; 2],
    normal: DVec3,
    bounds: Aabb<f64>,
}

/// What lies below a box.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Support {
    /// A floor under all of it, at this height (m).
    Floor(f64),
    /// The edge of a floor.
    Edge,
    /// Nothing.
    Missing,
}

impl Surroundings {
    /// Takes a scene and the present boxes of its bodies, m; empty and non-finite boxes are left out.
    pub fn new(scene: &Scene, bodies: impl IntoIterator<Item = Aabb<f64>>) -> Self {
        let is_there = |bounds: &Aabb<f64>| bounds.size().is_finite() && bounds.min.cmple(bounds.max).all();
        let mut made = Self { bodies: bodies.into_iter().filter(is_there).collect(), ..Self::default() };
        for obstacle in &scene.obstacles {
            match Floor::new(obstacle) {
                Some(floor) => made.floors.push(floor),
                None => made.blocks.push(obstacle.shape.bounds()),
            }
        }
        made
    }

    /// Returns the middle of a box of this size (m) that stands near where a person looks, `above` the thing that carries it
    /// (m).
    pub fn place(&self, look: Look, size: DVec3, above: f64) -> DVec3 {
        let look = Look { at: if look.at.is_finite() { look.at } else { DVec3::ZERO }, ..look };
        let middle = self.clamped(look.at);
        let all: Vec<DVec2> = columns(middle, look.ahead, size).collect();
        let gap = GAP_IN_SIZES * size.max_element();
        let roof = look.at.y + ROOF_HEIGHT_IN_SIZES * size.max_element();
        let foot = |at: DVec2| Aabb::<f64> {
            min: DVec3::new(at.x - 0.5 * size.x, 0.0, at.y - 0.5 * size.z),
            max: DVec3::new(at.x + 0.5 * size.x, 0.0, at.y + 0.5 * size.z),
        };
        let blocked = |foot: &Aabb<f64>| self.blocks.iter().any(|block| shares_column(foot, block, gap));
        let taken = |foot: &Aabb<f64>| self.bodies.iter().any(|body| shares_column(foot, body, gap));
        let on_floor =
            |at: &&DVec2| self.floors.is_empty() || matches!(self.support_under(&foot(**at), roof), Support::Floor(_));
        let open: Vec<DVec2> = all.iter().filter(on_floor).copied().filter(|at| !blocked(&foot(*at))).collect();
        let top = |at: &DVec2| {
            let under = self.bodies.iter().filter(|body| shares_column(&foot(*at), body, gap));
            under.map(|body| body.max.y).fold(f64::NEG_INFINITY, f64::max)
        };
        let free = open.iter().find(|at| !taken(&foot(**at)));
        let found = free.or_else(|| open.iter().min_by(|a, b| top(a).total_cmp(&top(b))));
        let at = found.copied().unwrap_or(middle);
        let foot = foot(at);
        let Support::Floor(height) = self.support_under(&foot, roof) else {
            let height = if self.floors.is_empty() { look.at.y } else { self.top_under(&foot) + above + 0.5 * size.y };
            return rounded(DVec3::new(at.x, height, at.y), size);
        };
        let stack = self.bodies.iter().chain(&self.blocks).filter(|thing| shares_column(&foot, thing, 0.0));
        let top = stack.map(|thing| thing.max.y + gap).fold(height, f64::max);
        rounded(DVec3::new(at.x, top + above + 0.5 * size.y, at.y), size)
    }

    /// Returns the place looked at, seen from above, or the nearest place to it within the box around everything.
    fn clamped(&self, at: DVec3) -> DVec2 {
        let floors = self.floors.iter().map(|floor| floor.bounds);
        let all = self.bodies.iter().chain(&self.blocks).copied().chain(floors);
        let bounds = all.fold(Aabb::<f64>::empty(), Aabb::joined);
        if bounds.min.cmpgt(bounds.max).any() {
            return DVec2::new(at.x, at.z);
        }
        DVec2::new(at.x.clamp(bounds.min.x, bounds.max.x), at.z.clamp(bounds.min.z, bounds.max.z))
    }

    /// What carries a box: the highest floor below it that is no roof.
    fn support_under(&self, foot: &Aabb<f64>, roof: f64) -> Support {
        let mut support = Support::Missing;
        for floor in &self.floors {
            let corners = corners(foot).map(|at| floor.height(at));
            let top = corners.iter().flatten().copied().fold(f64::NEG_INFINITY, f64::max);
            if corners.iter().all(Option::is_some) && top <= roof {
                support = match support {
                    Support::Missing => Support::Floor(top),
                    Support::Floor(height) => Support::Floor(height.max(top)),
                    Support::Edge => Support::Edge,
                };
            } else if shares_column(foot, &floor.bounds, 0.0) && floor.bounds.min.y <= roof {
                return Support::Edge;
            }
        }
        support
    }

    /// Returns the top of everything in the column of a box, m; used where no floor carries the whole box.
    fn top_under(&self, foot: &Aabb<f64>) -> f64 {
        let floors = self.floors.iter().map(|floor| floor.bounds);
        let all = self.bodies.iter().chain(&self.blocks).copied().chain(floors);
        let tops = all.filter(|thing| shares_column(foot, thing, 0.0)).map(|thing| thing.max.y);
        let top = tops.fold(f64::NEG_INFINITY, f64::max);
        if top.is_finite() { top } else { 0.0 }
    }
}

impl Floor {
    /// Returns none where an obstacle is not a plane or is too steep to carry anything.
    fn new(obstacle: &Obstacle) -> Option<Self> {
        let ObstacleShape::Plane(plane) = obstacle.shape else { return None };
        let turn = rotation::from_euler_deg(plane.rotation_deg);
        let normal = turn.y_axis;
        let level = (1.0 - normal.y * normal.y).max(0.0).sqrt() <= MAX_FLOOR_SLOPE;
        level.then(|| Self { plane, axes: [turn.x_axis, turn.z_axis], normal, bounds: obstacle.shape.bounds() })
    }

    /// Its height at a place seen from above, m; none outside it.
    fn height(&self, at: DVec2) -> Option<f64> {
        let center = DVec3::from(self.plane.center);
        let (x, z) = (at.x - center.x, at.y - center.z);
        let offset = DVec3::new(x, -(self.normal.x * x + self.normal.z * z) / self.normal.y, z);
        let inside = (0..2).all(|axis| offset.dot(self.axes[axis]).abs() <= self.plane.half_extents[axis]);
        inside.then_some(center.y + offset.y)
    }
}

/// Places seen from above on a grid around a place, nearest first.
fn columns(middle: DVec2, ahead: DVec3, size: DVec3) -> impl Iterator<Item = DVec2> {
    let pitch = 0.5 * (1.0 + GAP_IN_SIZES) * size.x.max(size.z).max(1e-6);
    let ahead = DVec2::new(ahead.x, ahead.z).normalize_or_zero();
    let steps = (-GRID_RADIUS..=GRID_RADIUS)
        .flat_map(|x| (-GRID_RADIUS..=GRID_RADIUS).map(move |z| DVec2::new(f64::from(x), f64::from(z))));
    let cost = |step: &DVec2| {
        let along = step.dot(ahead);
        step.length_squared() + (DEPTH_COST_FACTOR * DEPTH_COST_FACTOR - 1.0) * along * along
    };
    let mut steps: Vec<DVec2> = steps.collect();
    steps.sort_by(|a, b| cost(a).total_cmp(&cost(b)));
    steps.into_iter().map(move |step| middle + step * pitch)
}

/// Whether two boxes overlap as seen from above, with a gap around one of them.
fn shares_column(foot: &Aabb<f64>, other: &Aabb<f64>, gap: f64) -> bool {
    let apart = |axis: usize| foot.min[axis] - gap >= other.max[axis] || foot.max[axis] + gap <= other.min[axis];
    !apart(0) && !apart(2)
}

/// The corners of a box and its middle, seen from above.
fn corners(foot: &Aabb<f64>) -> [DVec2; 5] {
    let (low, high) = (foot.min, foot.max);
    let middle = foot.center();
    [(low.x, low.z), (low.x, high.z), (high.x, low.z), (high.x, high.z), (middle.x, middle.z)]
        .map(|(x, z)| DVec2::new(x, z))
}

/// Rounds a place to numbers a person can read: to about a hundredth of the size, the height a hundred times finer.
fn rounded(at: DVec3, size: DVec3) -> DVec3 {
    let scale = libm::exp10(2.0 - libm::floor(libm::log10(size.max_element().max(1e-6))));
    let scales = DVec3::new(scale, 100.0 * scale, scale);
    (at * scales).round() / scales
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::obstacle::Sphere;
    use crate::scene::presets;

    const AHEAD: DVec3 = DVec3::new(-0.5, -0.3, -0.8);

    fn cube(at: DVec3, size: f64) -> Aabb<f64> {
        Aabb { min: at - DVec3::splat(0.5 * size), max: at + DVec3::splat(0.5 * size) }
    }

    fn plane(half_extents: [f64; 2], rotation_deg: [f64; 3], center: [f64; 3]) -> Obstacle {
        let shape = ObstacleShape::Plane(Plane { center, rotation_deg, half_extents });
        Obstacle { shape, ..Obstacle::default() }
    }

    fn ground(half: f64) -> Scene {
        Scene { obstacles: vec![plane([half; 2], [0.0; 3], [0.0; 3])], ..Scene::default() }
    }

    /// Adds cubes of a metre one after another, each where there is room.
    fn add(scene: &Scene, bodies: &mut Vec<Aabb<f64>>, look: Look, count: usize) {
        for _ in 0..count {
            let at = Surroundings::new(scene, bodies.iter().copied()).place(look, DVec3::ONE, 0.2);
            bodies.push(cube(at, 1.0));
        }
    }

    fn apart(bodies: &[Aabb<f64>]) -> bool {
        bodies.iter().enumerate().all(|(n, a)| bodies[..n].iter().all(|b| !shares_column(a, b, 0.0)))
    }

    #[test]
    fn twenty_cubes_stand_on_the_ground_near_where_a_person_looks() {
        let scene = (presets::preset("cube-on-plane").expect("a preset").build)();
        let look = Look { at: DVec3::new(0.5, 0.6, 0.0), ahead: AHEAD };
        let mut bodies = vec![cube(DVec3::new(0.0, 0.5, 0.0), 1.15)];
        add(&scene, &mut bodies, look, 20);
        assert!(apart(&bodies), "none falls on another");
        for body in &bodies[1..] {
            let at = body.center();
            assert!((at.y - 0.7).abs() < 1e-9, "on the ground: {at}");
            assert!(at.distance(look.at) < 6.0, "near by: {at}");
            let ball = cube(DVec3::new(1.5, 0.4, -0.3), 0.8);
            assert!(!shares_column(body, &ball, 0.0), "beside the ball: {at}");
        }
        let nearest = bodies[1].center();
        assert!(nearest.distance(look.at) < 2.5, "the first is next to what is looked at: {nearest}");
    }

    #[test]
    fn where_a_person_looks_decides() {
        let look = Look { at: DVec3::new(-4.0, 1.0, 3.0), ahead: AHEAD };
        let at = Surroundings::new(&ground(10.0), []).place(look, DVec3::ONE, 0.0);
        assert!(at.distance(DVec3::new(-4.0, 0.5, 3.0)) < 1e-9, "right there, on the ground: {at}");
        let beyond = Look { at: DVec3::new(40.0, 1.0, 0.0), ahead: AHEAD };
        let at = Surroundings::new(&ground(10.0), []).place(beyond, DVec3::ONE, 0.0);
        assert!(at.x <= 9.5 && at.x > 8.0, "on the ground that is nearest to it: {at}");
    }

    #[test]
    fn a_floor_that_is_full_gets_stacks_and_nothing_beside_it() {
        let mut bodies = Vec::new();
        add(&ground(1.5), &mut bodies, Look::default(), 9);
        for (number, body) in bodies.iter().enumerate() {
            assert!(body.min.cmpge(DVec3::new(-1.5, 0.0, -1.5)).all() && body.max.x <= 1.5 && body.max.z <= 1.5);
            let clear = bodies[..number].iter().all(|other| !body.overlaps(other));
            assert!(clear, "it starts apart from the others: {body:?}");
        }
        assert!(bodies.iter().any(|body| body.min.y > 1.0), "some stand higher");
    }

    #[test]
    fn a_slope_carries_and_its_edge_and_a_wall_do_not() {
        let scene = (presets::preset("incline").expect("a preset").build)();
        let look = Look { at: DVec3::new(-0.8, 1.2, 0.0), ahead: AHEAD };
        let at = Surroundings::new(&scene, []).place(look, DVec3::ONE, 0.0);
        assert!(at.y > 1.4 && at.x.abs() < 1.9 && at.z.abs() < 0.8, "on the slope: {at}");
        let mut walled = ground(10.0);
        walled.obstacles.push(plane([3.0, 3.0], [0.0, 0.0, 90.0], [0.0, 3.0, 0.0]));
        let at = Surroundings::new(&walled, []).place(Look::default(), DVec3::ONE, 0.0);
        assert!(at.x.abs() > 0.5 && (at.y - 0.5).abs() < 1e-9, "beside the wall: {at}");
    }

    #[test]
    fn under_a_roof_things_stand_on_the_ground() {
        let mut roofed = ground(10.0);
        roofed.obstacles.push(plane([10.0, 10.0], [0.0; 3], [0.0, 6.0, 0.0]));
        let at = Surroundings::new(&roofed, []).place(Look::default(), DVec3::ONE, 0.0);
        assert!(at.distance(DVec3::new(0.0, 0.5, 0.0)) < 1e-9, "not on the roof: {at}");
    }

    #[test]
    fn without_a_floor_things_come_where_a_person_looks_apart_from_the_others() {
        let sphere = ObstacleShape::Sphere(Sphere { center: [0.0, 5.0, 0.0], radius: 0.5 });
        let space = Scene { obstacles: vec![Obstacle { shape: sphere, ..Obstacle::default() }], ..Scene::default() };
        let look = Look { at: DVec3::new(0.0, 5.0, 0.0), ahead: AHEAD };
        let mut bodies = Vec::new();
        add(&space, &mut bodies, look, 5);
        assert!(apart(&bodies), "none is in another's way");
        assert!(bodies.iter().all(|body| (body.center().y - 5.0).abs() < 1e-9), "all at the height looked at");
    }

    #[test]
    fn nothing_at_all_and_not_a_number_still_give_a_place() {
        let nan = Look { at: DVec3::NAN, ahead: DVec3::NAN };
        for scene in [Scene::default(), ground(0.1)] {
            for look in [nan, Look::default()] {
                let at = Surroundings::new(&scene, [Aabb::empty()]).place(look, DVec3::ONE, 0.1);
                assert!(at.is_finite(), "{at}");
            }
        }
    }
}
