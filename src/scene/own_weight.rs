//! Whether a body carries its own weight, and if not, at which size it does.
//!
//! At its foot an even column of height L carries its weight ρ g L per area. A solid of modulus E has the strain ρ g L / E
//! there, and the column sags by half that share of its height. At a strain of 0.25 a cube set down on the ground keeps 87 %
//! of its height, at 0.3 about 75 %; above that it folds (measured, 6 to 9 cells an edge). A smaller body of the same form
//! has a smaller L: everything softer than stone stands if it is small enough.

use glam::{DMat3, DVec3};

use super::body::{Body, Pose, Shape};
use super::material::Solid;
use super::obstacle::{Obstacle, ObstacleShape, Plane};
use crate::geometry::Lattice;
use crate::math::Aabb;
use crate::math::rotation::{from_euler_deg, to_euler_deg};

/// The largest strain at the foot of a body that stands.
const MAX_STANDING_STRAIN: f64 = 0.25;
/// The largest strain at the foot of a body of the size offered.
const OFFERED_STRAIN: f64 = 0.23;
/// The sizes offered, in a decade.
const ROUND_SIZES: [f64; 10] = [1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0];
/// A body is set down this share of its size above the ground; its position is rounded to a quarter of that or finer.
const GROUND_GAP_SHARE: f64 = 2e-3;

/// The build of a body, as far as it matters to whether it stands. Lengths at rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stature {
    /// The extents of its box along its own axes, m.
    pub size_m: [f64; 3],
    /// The height of the even column that would sag by the same share, m, for every axis: first with the weight along the
    /// axis, then against it. Thin legs make it longer than the body.
    columns_m: [[f64; 2]; 3],
}

impl Stature {
    /// Measures the cells of a body.
    pub fn of(lattice: &Lattice) -> Self {
        let rest = (0..lattice.corners.len()).map(|particle| lattice.rest_position(particle));
        let size_m = Aabb::<f64>::around(rest).size().to_array();
        let columns_m = [0, 1, 2].map(|axis| {
            let mut layers = vec![0.0; lattice.grid.dims[axis] as usize];
            for (number, cell) in lattice.cells.iter().enumerate() {
                layers[lattice.corners[cell[0] as usize][axis] as usize] += lattice.share(number);
            }
            let cell = lattice.grid.cell_size;
            [even_column_height(layers.iter(), cell), even_column_height(layers.iter().rev(), cell)]
        });
        Self { size_m, columns_m }
    }

    /// The longest extent, m.
    pub fn longest_m(&self) -> f64 {
        self.size_m.into_iter().fold(0.0, f64::max)
    }

    /// Returns the strain at the foot of a body of a solid in its starting rotation.
    fn strain(&self, solid: &Solid, rotation_deg: [f64; 3], gravity: [f64; 3]) -> f64 {
        let own = from_euler_deg(rotation_deg).transpose() * DVec3::from(gravity);
        let axis = (0..3).max_by(|&a, &b| own[a].abs().total_cmp(&own[b].abs())).unwrap_or(1);
        let column = self.columns_m[axis][usize::from(own[axis] < 0.0)];
        solid.density * own.length() * column / solid.young_modulus
    }

    /// Returns the longest extent at which a body of a solid stands, a round number of metres; none where it stands as it is
    /// or is held by pins.
    pub fn size_to_stand(&self, body: &Body, solid: &Solid, gravity: [f64; 3]) -> Option<f64> {
        let strain = self.strain(solid, body.pose.rotation_deg, gravity);
        let stands = strain <= MAX_STANDING_STRAIN || body.has_pins();
        (!stands).then(|| round_below(self.longest_m() * OFFERED_STRAIN / strain))
    }

    /// Returns the body with another longest extent, set down flat on the ground below a place.
    pub fn set_down(
        &self,
        body: &Body,
        longest_m: f64,
        above: [f64; 3],
        obstacles: &[Obstacle],
        gravity: [f64; 3],
    ) -> Body {
        let factor = longest_m / self.longest_m();
        let mut body = scaled(body, factor, longest_m);
        let down = DVec3::from(gravity).normalize_or(DVec3::NEG_Y);
        if let Some(ground) = ground_below(obstacles, DVec3::from(above), down) {
            let turn = align_nearest_axis(from_euler_deg(body.pose.rotation_deg), ground.normal);
            let half = DVec3::from(self.size_m) * (0.5 * factor);
            let height = (turn.transpose() * ground.normal).abs().dot(half) + GROUND_GAP_SHARE * longest_m;
            let [position, rotation_deg] = [ground.point + ground.normal * height, DVec3::from(to_euler_deg(&turn))];
            body.pose = Pose {
                position: rounded(position, 0.25 * GROUND_GAP_SHARE * longest_m).to_array(),
                rotation_deg: rounded(rotation_deg, 0.001).to_array(),
            };
        }
        body
    }
}

/// The largest size at which a cube of a solid stands, m; infinite without gravity.
pub fn largest_cube(solid: &Solid, gravity: [f64; 3]) -> f64 {
    let size = OFFERED_STRAIN * solid.young_modulus / (solid.density * DVec3::from(gravity).length());
    if size.is_finite() { round_below(size) } else { size }
}

/// Returns the height of the even column that sags by the same share as layers of cells with this edge, listed from the top.
fn even_column_height<'a>(layers: impl Iterator<Item = &'a f64>, cell: f64) -> f64 {
    let [mut height, mut above, mut sag] = [0.0; 3];
    for count in layers.copied().filter(|count| *count > 0.0) {
        sag += (above + 0.5 * count) / count;
        above += count;
        height += 1.0;
    }
    if height > 0.0 { 2.0 * cell * sag / height } else { 0.0 }
}

/// Returns the body with all lengths multiplied by a factor; its longest extent is then `longest_m`.
fn scaled(body: &Body, factor: f64, longest_m: f64) -> Body {
    let mut body = body.clone();
    match &mut body.shape {
        Shape::Cube(cube) => cube.size = longest_m,
        Shape::Cells(cells) => cells.size *= factor,
        Shape::Model(model) => model.length = if model.length > 0.0 { model.length * factor } else { longest_m },
    }
    for corner in body.inlays.iter_mut().flat_map(|inlay| [&mut inlay.min, &mut inlay.max]) {
        *corner = corner.map(|at| at * factor);
    }
    for corner in body.pins.iter_mut().flat_map(|pin| [&mut pin.min, &mut pin.max]) {
        *corner = corner.map(|at| at * factor);
    }
    body
}

/// Where something stands.
struct Ground {
    point: DVec3,
    /// Unit normal, away from the obstacle.
    normal: DVec3,
}

/// The first thing that a body falls on from a place.
fn ground_below(obstacles: &[Obstacle], from: DVec3, down: DVec3) -> Option<Ground> {
    let hits = obstacles.iter().filter_map(|obstacle| match &obstacle.shape {
        ObstacleShape::Plane(plane) => hit_plane(plane, from, down),
        ObstacleShape::Sphere(sphere) => {
            let offset = from - DVec3::from(sphere.center);
            let along = -offset.dot(down);
            let aside = offset.length_squared() - along * along;
            let half = (sphere.radius * sphere.radius - aside).max(0.0).sqrt();
            let distance = along - half;
            (aside < sphere.radius * sphere.radius && distance >= 0.0)
                .then(|| (distance, ((offset + down * distance) / sphere.radius).normalize_or(-down)))
        }
        // The bounding box stands for the shape: on a turned obstacle a person moves the body by hand.
        ObstacleShape::Box(_) | ObstacleShape::Capsule(_) | ObstacleShape::Cylinder(_) | ObstacleShape::Mesh(_) => {
            hit_box(&obstacle.shape.bounds(), from, down).map(|distance| (distance, -down))
        }
    });
    let (distance, normal) = hits.min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(Ground { point: from + down * distance, normal })
}

/// How far below a place a box lies.
fn hit_box(bounds: &Aabb<f64>, from: DVec3, down: DVec3) -> Option<f64> {
    let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
    for axis in 0..3 {
        let [low, high] = [bounds.min[axis], bounds.max[axis]].map(|side| (side - from[axis]) / down[axis]);
        if down[axis] != 0.0 {
            (enter, leave) = (enter.max(low.min(high)), leave.min(low.max(high)));
        } else if from[axis] < bounds.min[axis] || from[axis] > bounds.max[axis] {
            return None;
        }
    }
    (enter > 0.0 && enter <= leave).then_some(enter)
}

/// How far below a place a plane lies, and its normal there.
fn hit_plane(plane: &Plane, from: DVec3, down: DVec3) -> Option<(f64, DVec3)> {
    let turn = from_euler_deg(plane.rotation_deg);
    let slope = turn.y_axis.dot(down);
    if slope.abs() < 1e-6 {
        return None;
    }
    let center = DVec3::from(plane.center);
    let distance = (center - from).dot(turn.y_axis) / slope;
    let at = turn.transpose() * (from + down * distance - center);
    let within = at.x.abs() <= plane.half_extents[0] && at.z.abs() <= plane.half_extents[1];
    (distance >= 0.0 && within).then(|| (distance, turn.y_axis * -slope.signum()))
}

/// Turns a rotation further by the least angle that brings one of its axes along a normal.
fn align_nearest_axis(turn: DMat3, normal: DVec3) -> DMat3 {
    let axes = [turn.x_axis, turn.y_axis, turn.z_axis];
    let nearest = axes.into_iter().max_by(|a, b| a.dot(normal).abs().total_cmp(&b.dot(normal).abs()));
    let axis = nearest.map_or(normal, |axis| axis * axis.dot(normal).signum());
    let about = axis.cross(normal);
    let (sin, cos) = (about.length(), axis.dot(normal));
    let Some(about) = about.try_normalize() else { return turn };
    let across = |v: DVec3| v * cos + about.cross(v) * sin + about * (about.dot(v) * (1.0 - cos));
    DMat3::from_cols(across(turn.x_axis), across(turn.y_axis), across(turn.z_axis))
}

fn rounded(values: DVec3, unit: f64) -> DVec3 {
    // A whole power of ten, so that the number is short when written.
    let digits = 10_f64.powf(-unit.log10().floor());
    (values * digits).round() / digits
}

/// Returns the largest size of the list that is not above this one.
fn round_below(size: f64) -> f64 {
    let decade = 10_f64.powf(size.log10().floor());
    let share = ROUND_SIZES.into_iter().rev().find(|share| share * decade <= 1.001 * size).unwrap_or(1.0);
    // Three digits at most: 0.025 and not 0.025000000000000001.
    let digits = 10_f64.powf(2.0 - size.log10().floor());
    (share * decade * digits).round() / digits
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::voxel::Cells;
    use crate::scene::body::CubeShape;
    use crate::scene::material::presets;
    use crate::scene::obstacle::Sphere;
    use crate::scene::settings::EARTH_GRAVITY;

    const GRAVITY: [f64; 3] = [0.0, -EARTH_GRAVITY, 0.0];

    fn cube(size: f64) -> (Body, Stature) {
        let shape = Shape::Cube(CubeShape { cells: 4, size });
        let lattice = Lattice::new(&Cells::cube(4, size / 4.0).expect("a small cube"));
        (Body { shape, ..Body::default() }, Stature::of(&lattice))
    }

    fn named(name: &str) -> Solid {
        presets().iter().find(|preset| preset.name == name).expect("a material").material
    }

    #[test]
    fn a_cube_is_a_column_of_its_height_whichever_way_it_lies() {
        let (_, stature) = cube(0.8);
        for column in stature.columns_m.into_iter().flatten() {
            assert!((column - 0.8).abs() < 1e-9, "{stature:?}");
        }
        assert!((stature.longest_m() - 0.8).abs() < 1e-9);
    }

    #[test]
    fn a_dessert_is_ten_centimetres_and_rubber_stands_as_it_is() {
        let (body, stature) = cube(1.0);
        let offered = |name: &str, gravity| stature.size_to_stand(&body, &named(name), gravity);
        assert_eq!(offered("gelatin dessert", GRAVITY), Some(0.1));
        assert_eq!(offered("pectin jelly", GRAVITY), Some(0.025));
        assert_eq!(offered("rubber", GRAVITY), None);
        assert_eq!(offered("gelatin dessert", [0.0; 3]), None, "nothing weighs anything");
        let held = Body { pins: vec![crate::scene::body::PinBox::default()], ..body.clone() };
        assert_eq!(stature.size_to_stand(&held, &named("gelatin dessert"), GRAVITY), None, "it hangs");
        assert!((largest_cube(&named("gelatin dessert"), GRAVITY) - 0.1).abs() < 1e-12);
    }

    #[test]
    fn thin_legs_make_a_longer_column() {
        // A slab of 4 × 4 cells on one leg of 4 cells.
        let slab = (0..4).flat_map(|x| (0..4).map(move |z| [x, 4, z]));
        let leg = (0..4).map(|y| [0, y, 0]);
        let cells = Cells::from_list(&slab.chain(leg).collect::<Vec<_>>(), 0.1).expect("cells");
        let stature = Stature::of(&Lattice::new(&cells));
        let [upright, over] = [stature.columns_m[1][1], stature.columns_m[1][0]];
        assert!(upright > 4.0 * 0.5 && over < 0.5, "on its leg {upright} m, on its slab {over} m");
    }

    #[test]
    fn a_body_is_set_down_flat_on_what_is_below_it() {
        let (mut body, stature) = cube(1.0);
        body.pose = Pose { position: [0.0, 1.0, 0.0], rotation_deg: [5.0, 30.0, 8.0] };
        let ground = Obstacle::default();
        let ball = Sphere { center: [2.0, 0.4, 0.0], radius: 0.4 };
        let ball = Obstacle { shape: ObstacleShape::Sphere(ball), ..Obstacle::default() };
        let slope = Plane { center: [-3.0, 0.5, 0.0], rotation_deg: [0.0, 0.0, 20.0], half_extents: [1.0, 1.0] };
        let slope = Obstacle { shape: ObstacleShape::Plane(slope), ..Obstacle::default() };
        let all = [ground, ball, slope];
        for (above, height) in [([0.5, 0.6, 0.2], 0.05), ([2.0, 2.0, 0.0], 0.85), ([-3.0, 2.0, 0.0], 0.55)] {
            let small = stature.set_down(&body, 0.1, above, &all, GRAVITY);
            let Shape::Cube(shape) = &small.shape else { panic!("a cube stays a cube") };
            assert!((shape.size - 0.1).abs() < 1e-12);
            let [x, y, z] = small.pose.position;
            assert!((y - height).abs() < 5e-3 && (x - above[0]).abs() < 0.02, "{above:?}: at {x}, {y}, {z}");
            let normal = if above[0] < -1.0 { from_euler_deg([0.0, 0.0, 20.0]).y_axis } else { DVec3::Y };
            let along = from_euler_deg(small.pose.rotation_deg).y_axis.dot(normal);
            assert!(along > 1.0 - 1e-9, "{above:?}: flat, {:?}", small.pose.rotation_deg);
        }
        let nowhere = stature.set_down(&body, 0.1, [40.0, 1.0, 0.0], &all, GRAVITY);
        assert_eq!(nowhere.pose, body.pose, "nothing is below");
    }
}
