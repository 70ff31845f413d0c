//! Handles to move and turn a thing with the pointer: arrows along three axes, squares between them, rings around them.
//! Plain data and geometry, which says what the pointer hits and what a drag means; the caller owns the mouse.
//!
//! ```text
//!        ▲ y
//!     ╭──│──╮        arrow   moves along its axis
//!    ╱ ┌┐│   ╲       square  moves in the plane of two axes
//!   │  └┘└────│──▶   ring    turns about an axis
//!    ╲  ╱     ╱
//!     ╰╱─────╯       lengths are pixels of the picture, whatever the distance
//!     ◣ z
//! ```
//!
//! Pixels are counted from the upper left corner of the view, in the unit of [`super::Overlay`]'s widths.

use std::f32::consts::{PI, TAU};
use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::Camera;
use super::overlay::{Fill, LineEnds, Lines, Overlay, Segment};
use super::style::{OverlayColors, Tint};

/// Where an arrow begins and ends, pixels from the middle.
const ARROW_SPAN: [f32; 2] = [14.0, 84.0];
/// The length of its head, pixels.
const ARROW_HEAD_LENGTH: f32 = 15.0;
/// Where a square begins and ends along both of its axes, pixels from the middle.
const SQUARE_SPAN: [f32; 2] = [26.0, 46.0];
/// The radius of a ring, pixels.
const RING_RADIUS: f32 = 102.0;
/// Lines in a whole ring.
const RING_SIDES: u16 = 96;
/// The width of the rim of lines, pixels.
const RIM_WIDTH: f32 = 1.0;
/// How near to an arrow or a ring the pointer must be to hit it, pixels.
const HIT_DISTANCE: f32 = 8.0;
/// An arrow is left out if the cosine of its angle to the line of sight exceeds this: it points too straight at the eye.
const MAX_ARROW_COSINE: f32 = 0.97;
/// A square is left out if it is seen flatter than this, as a sine.
const MIN_SQUARE_SINE: f32 = 0.12;
/// A ring seen flatter than this, as a sine, is turned by a drag along its tangent instead of around its middle.
const MIN_RING_SINE: f32 = 0.25;
/// The farthest that a drag moves the thing, in distances from the eye: towards the horizon there is no limit otherwise.
const MAX_RELATIVE_DRAG: f32 = 20.0;

/// Handles around a thing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gizmo {
    /// The middle of the thing, m.
    pub center: Vec3,
    /// The directions of the handles; of unit length, at right angles.
    pub axes: [Vec3; 3],
    /// Whether there are rings. A sphere needs none: its turns are invisible.
    pub has_rings: bool,
}

/// One of the handles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Handle {
    /// Moves along an axis.
    Arrow(usize),
    /// Moves in the plane at right angles to an axis.
    Square(usize),
    /// Turns about an axis.
    Ring(usize),
}

/// The effect of a drag on the thing, relative to where it was when the drag began.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drag {
    /// Moves it, m.
    Move(Vec3),
    /// Turns it about its middle.
    Turn {
        /// Of unit length.
        axis: Vec3,
        /// Counter-clockwise seen against the axis, radians.
        angle_rad: f32,
    },
}

impl Gizmo {
    /// Handles along the axes of the world.
    pub fn new(center: Vec3, has_rings: bool) -> Self {
        Self { center, axes: Vec3::AXES, has_rings }
    }

    /// The handle under a pixel of a view of `size` pixels.
    pub fn hit(&self, camera: &Camera, size: Vec2, pixel: Vec2) -> Option<Handle> {
        let projected = ProjectedGizmo::new(self, camera, size)?;
        let squares =
            projected.squares().find(|(_, corners)| is_inside(corners, pixel)).map(|(axis, _)| Handle::Square(axis));
        let near = |handle: Handle, distance: f32| (distance < HIT_DISTANCE).then_some((handle, distance));
        let arrows =
            projected.arrows().filter_map(|(axis, ends)| near(Handle::Arrow(axis), distance_to_segment(pixel, ends)));
        let rings = projected.rings().filter_map(|(axis, points)| {
            let distances = points.windows(2).map(|pair| distance_to_segment(pixel, [pair[0], pair[1]]));
            near(Handle::Ring(axis), distances.fold(f32::INFINITY, f32::min))
        });
        squares.or_else(|| {
            let nearest = arrows.chain(rings).min_by(|(_, a), (_, b)| a.total_cmp(b));
            nearest.map(|(handle, _)| handle)
        })
    }

    /// Returns the effect of dragging a handle from one pixel to another. `None` where the pointer is at no meaningful
    /// place: the last result stands then. The gizmo and the camera must be those of the beginning of the drag.
    pub fn drag(&self, camera: &Camera, size: Vec2, handle: Handle, from: Vec2, to: Vec2) -> Option<Drag> {
        let max_drag = MAX_RELATIVE_DRAG * camera.eye.distance(self.center);
        let moved = match handle {
            Handle::Arrow(axis) => {
                let along = |pixel| self.nearest_on_axis(camera, size, axis, pixel);
                self.axes[axis] * (along(to)? - along(from)?)
            }
            Handle::Square(axis) => {
                let normal = self.axes[axis];
                let on_plane = |pixel| {
                    let ray = camera.ray_through(pixel, size);
                    ray.hit_plane(self.center, normal).map(|distance| ray.at(distance))
                };
                on_plane(to)? - on_plane(from)?
            }
            Handle::Ring(axis) => {
                let angle_rad = self.drag_angle(camera, size, axis, from, to)?;
                return Some(Drag::Turn { axis: self.axes[axis], angle_rad });
            }
        };
        (moved.length() < max_drag).then_some(Drag::Move(moved))
    }

    /// The point of an axis that is nearest to the line of sight through a pixel, m from the middle.
    fn nearest_on_axis(&self, camera: &Camera, size: Vec2, axis: usize, pixel: Vec2) -> Option<f32> {
        let (ray, axis) = (camera.ray_through(pixel, size), self.axes[axis]);
        let to_center = self.center - ray.origin;
        let cos = ray.direction.dot(axis);
        let along = (cos * ray.direction.dot(to_center) - axis.dot(to_center)) / (1.0 - cos * cos);
        let ahead = ray.direction.dot(to_center) + cos * along;
        (along.is_finite() && ahead > 0.0).then_some(along)
    }

    fn drag_angle(&self, camera: &Camera, size: Vec2, axis: usize, from: Vec2, to: Vec2) -> Option<f32> {
        let axis = self.axes[axis];
        let to_eye = (camera.eye - self.center).try_normalize()?;
        let facing = to_eye.dot(axis);
        let on_plane = |pixel, normal| {
            let ray = camera.ray_through(pixel, size);
            ray.hit_plane(self.center, normal).map(|distance| ray.at(distance) - self.center)
        };
        if facing.abs() > MIN_RING_SINE {
            let (a, b) = (on_plane(from, axis)?, on_plane(to, axis)?);
            return Some(axis.dot(a.cross(b)).atan2(a.dot(b)));
        }
        // Seen flat, the near side of the ring is a line: a way of one radius along it is a turn of one radian.
        let toward = (to_eye - axis * facing).try_normalize()?;
        let tangent = axis.cross(toward);
        let radius = ProjectedGizmo::new(self, camera, size)?.metres(RING_RADIUS);
        let along = |pixel| on_plane(pixel, toward).map(|place| place.dot(tangent));
        let angle = (along(to)? - along(from)?) / radius;
        Some((angle + PI).rem_euclid(TAU) - PI)
    }

    /// Draws the handles over a picture of `size` pixels. The `hot` handle, under the pointer or dragged, stands out.
    pub fn add_to(
        &self,
        overlay: &mut Overlay,
        camera: &Camera,
        size: Vec2,
        hot: Option<Handle>,
        colors: &OverlayColors,
    ) {
        let Some(projected) = ProjectedGizmo::new(self, camera, size) else { return };
        let color = |handle: Handle, axis: usize, opacity: f32| {
            let [r, g, b] = if hot == Some(handle) { colors.hot } else { colors.axes[axis] };
            [r, g, b, if hot == Some(handle) { opacity.max(0.75) } else { opacity }]
        };
        let wider = |handle: Handle| if hot == Some(handle) { 1.5 } else { 1.0 };
        let (mut segments, mut fills) = (Vec::new(), overlay.fills.to_vec());
        for axis in projected.ring_axes() {
            let (handle, points) = (Handle::Ring(axis), projected.ring(axis));
            let color = color(handle, axis, 1.0);
            segments.extend(points.windows(2).map(|pair| Segment::new(pair[0], pair[1], color, 2.2 * wider(handle))));
        }
        for axis in projected.square_axes() {
            let (handle, corners) = (Handle::Square(axis), projected.square(axis));
            let [a, b, c, d] = corners;
            let fill = color(handle, axis, 0.35);
            fills.extend([a, b, c, a, c, d].map(|place| Fill { place: place.to_array(), color: fill }));
            let edge = color(handle, axis, 1.0);
            let edges = [[a, b], [b, c], [c, d], [d, a]];
            segments.extend(edges.map(|[from, to]| Segment::new(from, to, edge, 1.5 * wider(handle))));
        }
        for axis in projected.arrow_axes() {
            let (handle, [tail, tip]) = (Handle::Arrow(axis), projected.arrow(axis));
            let color = color(handle, axis, 1.0);
            let neck = tip - self.axes[axis] * projected.metres(ARROW_HEAD_LENGTH);
            segments.push(Segment::new(tail, neck, color, 3.0 * wider(handle)));
            let widths = [11.0 * wider(handle), 0.0];
            segments.push(Segment { widths, ..Segment::new(neck, tip, color, 0.0) });
        }
        let [r, g, b] = colors.rim;
        let rims = segments.iter().map(|segment| projected.rim_of(segment, [r, g, b, 1.0]));
        let ends = LineEnds::Placed(Arc::new(rims.chain(segments.iter().copied()).collect()));
        overlay.lines.push(Lines { ends, tint: Tint::Own, opacity: 1.0, width: 1.0, hidden: 1.0 });
        overlay.fills = Arc::new(fills);
    }
}

/// A gizmo as a camera sees it.
struct ProjectedGizmo<'a> {
    gizmo: &'a Gizmo,
    camera: &'a Camera,
    size: Vec2,
    to_eye: Vec3,
    metres_per_pixel: f32,
}

impl<'a> ProjectedGizmo<'a> {
    /// `None` if the middle is not ahead of the eye.
    fn new(gizmo: &'a Gizmo, camera: &'a Camera, size: Vec2) -> Option<Self> {
        let ahead = (gizmo.center - camera.eye).dot(camera.forward());
        let metres_per_pixel = 2.0 * (0.5 * camera.fov_rad).tan() * ahead / size.y;
        let to_eye = (camera.eye - gizmo.center).try_normalize()?;
        let usable = ahead > camera.near() && metres_per_pixel.is_finite();
        usable.then_some(Self { gizmo, camera, size, to_eye, metres_per_pixel })
    }

    fn metres(&self, pixels: f32) -> f32 {
        pixels * self.metres_per_pixel
    }

    fn facing(&self, axis: usize) -> f32 {
        self.to_eye.dot(self.gizmo.axes[axis])
    }

    fn arrow_axes(&self) -> impl Iterator<Item = usize> {
        (0..3).filter(|&axis| self.facing(axis).abs() < MAX_ARROW_COSINE)
    }

    fn square_axes(&self) -> impl Iterator<Item = usize> {
        (0..3).filter(|&axis| self.facing(axis).abs() > MIN_SQUARE_SINE)
    }

    fn ring_axes(&self) -> impl Iterator<Item = usize> {
        (0..3).filter(|_| self.gizmo.has_rings)
    }

    fn arrow(&self, axis: usize) -> [Vec3; 2] {
        ARROW_SPAN.map(|pixels| self.gizmo.center + self.gizmo.axes[axis] * self.metres(pixels))
    }

    /// The square at right angles to an axis, in the quarter between the two other arrows.
    fn square(&self, axis: usize) -> [Vec3; 4] {
        let [u, v] = [1, 2].map(|next| self.gizmo.axes[(axis + next) % 3]);
        let [near, far] = SQUARE_SPAN.map(|pixels| self.metres(pixels));
        [[near, near], [far, near], [far, far], [near, far]].map(|[a, b]| self.gizmo.center + u * a + v * b)
    }

    /// The half of the ring nearer to the eye; the whole ring if the eye looks along its axis.
    fn ring(&self, axis: usize) -> Vec<Vec3> {
        let normal = self.gizmo.axes[axis];
        let facing = self.facing(axis);
        let toward = (self.to_eye - normal * facing).try_normalize().unwrap_or(self.gizmo.axes[(axis + 1) % 3]);
        let side = normal.cross(toward);
        let whole = facing.abs() > MAX_ARROW_COSINE;
        let sides = if whole { RING_SIDES } else { RING_SIDES / 2 };
        let span = if whole { PI } else { 0.5 * PI };
        let radius = self.metres(RING_RADIUS);
        let point = |step: u16| {
            let (sin, cos) = (span * (2.0 * f32::from(step) / f32::from(sides) - 1.0)).sin_cos();
            self.gizmo.center + (toward * cos + side * sin) * radius
        };
        (0..=sides).map(point).collect()
    }

    /// The rim of a line: a line that reaches a little further on all sides.
    fn rim_of(&self, segment: &Segment, color: [f32; 4]) -> Segment {
        let [from, to] = segment.ends.map(Vec3::from);
        let flat_ended = segment.widths[0] > 2.0 * segment.widths[1];
        let beyond = if flat_ended { (to - from).normalize_or_zero() * self.metres(RIM_WIDTH) } else { Vec3::ZERO };
        let widths = segment.widths.map(|width| width + 2.0 * RIM_WIDTH);
        Segment { ends: [(from - beyond).to_array(), (to + 2.0 * beyond).to_array()], color, widths }
    }

    fn pixel(&self, point: Vec3) -> Option<Vec2> {
        self.camera.pixel_of(point, self.size)
    }

    fn arrows(&self) -> impl Iterator<Item = (usize, [Vec2; 2])> {
        self.arrow_axes().filter_map(|axis| {
            let [tail, tip] = self.arrow(axis);
            Some((axis, [self.pixel(tail)?, self.pixel(tip)?]))
        })
    }

    fn squares(&self) -> impl Iterator<Item = (usize, [Vec2; 4])> {
        self.square_axes().filter_map(|axis| {
            let [a, b, c, d] = self.square(axis).map(|corner| self.pixel(corner));
            Some((axis, [a?, b?, c?, d?]))
        })
    }

    fn rings(&self) -> impl Iterator<Item = (usize, Vec<Vec2>)> {
        self.ring_axes().map(|axis| (axis, self.ring(axis).into_iter().filter_map(|point| self.pixel(point)).collect()))
    }
}

fn distance_to_segment(pixel: Vec2, [a, b]: [Vec2; 2]) -> f32 {
    let way = b - a;
    let share = ((pixel - a).dot(way) / way.length_squared()).clamp(0.0, 1.0);
    pixel.distance(if share.is_finite() { a + way * share } else { a })
}

/// Whether a pixel lies within a convex quadrilateral of either winding.
fn is_inside(corners: &[Vec2; 4], pixel: Vec2) -> bool {
    let turns = (0..4).map(|at| (corners[(at + 1) % 4] - corners[at]).perp_dot(pixel - corners[at]));
    let (mut left, mut right) = (false, false);
    for turn in turns {
        left |= turn > 0.0;
        right |= turn < 0.0;
    }
    left != right
}

#[cfg(test)]
#[path = "gizmo_tests.rs"]
mod tests;
