//! The forms of obstacles, for drawing and for picking.

use std::sync::Arc;

use glam::Vec3;

use super::{Ray, SolidMesh};
use crate::math::Aabb;

/// An obstacle's form.
#[derive(Clone, Debug, PartialEq)]
pub enum Solid {
    /// A two-sided rectangle `center ± half_extents[0] axes[0] ± half_extents[1] axes[1]`.
    Plane {
        /// The middle, m.
        center: Vec3,
        /// The directions of its sides; unit length, at right angles.
        axes: [Vec3; 2],
        /// Half its sides, m.
        half_extents: [f32; 2],
    },
    /// A ball.
    Sphere {
        /// The middle, m.
        center: Vec3,
        /// The radius, m.
        radius: f32,
    },
    /// A box `center ± half_extents[0] axes[0] ± …`.
    Box {
        /// The middle, m.
        center: Vec3,
        /// The directions of its sides; unit length, at right angles.
        axes: [Vec3; 3],
        /// Half its sides, m.
        half_extents: [f32; 3],
    },
    /// A cylinder that ends in half balls.
    Capsule {
        /// The middle, m.
        center: Vec3,
        /// From the middle to the middle of one of the balls, m.
        arm: Vec3,
        /// The radius, m.
        radius: f32,
    },
    /// A cylinder.
    Cylinder {
        /// The middle, m.
        center: Vec3,
        /// From the middle to the middle of one end, m; never zero.
        arm: Vec3,
        /// The radius, m.
        radius: f32,
    },
    /// A mesh.
    Mesh {
        /// The middle of its bounding box, m.
        center: Vec3,
        /// Its own axes in the world: at right angles, each as long as the mesh's unit, m.
        axes: [Vec3; 3],
        /// The mesh in these axes.
        mesh: Arc<SolidMesh>,
    },
}

/// How far up the unit normal of a floor points at least.
const FLOOR_NORMAL_Y: f32 = 0.999;

impl Solid {
    /// Whether it has no inside.
    pub fn is_plane(&self) -> bool {
        matches!(self, Self::Plane { .. })
    }

    /// Whether it is a level plane: things stand on it, it catches shadows and shades nothing below.
    pub fn is_floor(&self) -> bool {
        matches!(*self, Self::Plane { axes: [u, v], .. } if u.cross(v).y.abs() > FLOOR_NORMAL_Y)
    }

    /// The smallest box around it, m.
    pub fn bounds(&self) -> Aabb<f32> {
        let (center, reach) = match *self {
            Self::Plane { center, axes: [u, v], half_extents: [a, b] } => (center, u.abs() * a + v.abs() * b),
            Self::Sphere { center, radius } => (center, Vec3::splat(radius)),
            Self::Box { center, axes: [u, v, w], half_extents: [a, b, c] } => {
                (center, u.abs() * a + v.abs() * b + w.abs() * c)
            }
            Self::Capsule { center, arm, radius } => (center, arm.abs() + radius),
            Self::Cylinder { center, arm, radius } => {
                let along = arm.normalize_or_zero();
                let across = (Vec3::ONE - along * along).max(Vec3::ZERO);
                (center, arm.abs() + Vec3::new(across.x.sqrt(), across.y.sqrt(), across.z.sqrt()) * radius)
            }
            Self::Mesh { center, axes: [u, v, w], ref mesh } => {
                let Vec3 { x, y, z } = mesh.half_extents;
                (center, u.abs() * x + v.abs() * y + w.abs() * z)
            }
        };
        Aabb { min: center - reach, max: center + reach }
    }

    /// The distance along a ray at which its surface is first met, m, from outside or from within.
    pub fn hit(&self, ray: &Ray) -> Option<f32> {
        let first = |[enter, leave]: [f32; 2]| {
            (enter <= leave).then_some([enter, leave]).and_then(|ends| ends.into_iter().find(|&end| end >= 0.0))
        };
        match *self {
            Self::Sphere { center, radius } => ray.hit_sphere(center, radius),
            Self::Plane { center, axes, half_extents } => {
                let distance = ray.hit_plane(center, axes[0].cross(axes[1]))?;
                let offset = ray.at(distance) - center;
                let inside = (0..2).all(|axis| offset.dot(axes[axis]).abs() <= half_extents[axis]);
                inside.then_some(distance)
            }
            Self::Box { center, axes, half_extents } => {
                let slabs = (0..3).map(|axis| slab_interval(ray, center, axes[axis], half_extents[axis]));
                first(slabs.fold(WHOLE_LINE, intersection))
            }
            Self::Cylinder { center, arm, radius } => first(cylinder_interval(ray, center, arm, radius)),
            Self::Mesh { center, axes, ref mesh } => {
                let own = |v: Vec3| Vec3::from(axes.map(|axis| v.dot(axis) / axis.length_squared()));
                // A distance is the same multiple of the direction in both systems of axes.
                mesh.hit(&Ray { origin: own(ray.origin - center), direction: own(ray.direction) })
            }
            Self::Capsule { center, arm, radius } => {
                // The ends and the cylinder are one convex body.
                let ends = [center - arm, center + arm].into_iter().filter_map(|end| ray.hit_sphere(end, radius));
                let side = first(cylinder_interval(ray, center, arm, radius));
                let is_within = self.capsule_contains(ray.origin);
                ends.chain(side).reduce(if is_within { f32::max } else { f32::min })
            }
        }
    }

    /// Whether a point is in a capsule.
    fn capsule_contains(&self, point: Vec3) -> bool {
        let Self::Capsule { center, arm, radius } = *self else { return false };
        let along = ((point - center).dot(arm) / arm.length_squared()).clamp(-1.0, 1.0);
        point.distance(center + arm * along) < radius
    }
}

/// The whole of a line.
const WHOLE_LINE: [f32; 2] = [f32::NEG_INFINITY, f32::INFINITY];

/// The intersection of two parts of a line; its end lies before its beginning if it is empty.
fn intersection(a: [f32; 2], b: [f32; 2]) -> [f32; 2] {
    [a[0].max(b[0]), a[1].min(b[1])]
}

/// The part of a line of sight, m, within `half` of a point, measured along an axis.
fn slab_interval(ray: &Ray, center: Vec3, axis: Vec3, half: f32) -> [f32; 2] {
    let (from, speed) = ((ray.origin - center).dot(axis), ray.direction.dot(axis));
    if speed == 0.0 {
        return if from.abs() <= half { WHOLE_LINE } else { [f32::INFINITY, f32::NEG_INFINITY] };
    }
    let ends = [(-half - from) / speed, (half - from) / speed];
    [ends[0].min(ends[1]), ends[0].max(ends[1])]
}

/// The part of a line of sight, m, that is in a cylinder.
fn cylinder_interval(ray: &Ray, center: Vec3, arm: Vec3, radius: f32) -> [f32; 2] {
    let axis = arm.normalize_or_zero();
    let across = |v: Vec3| v - axis * v.dot(axis);
    let (from, way) = (across(ray.origin - center), across(ray.direction));
    let speed_squared = way.length_squared();
    let sides = if speed_squared > 0.0 {
        let middle = -from.dot(way) / speed_squared;
        let off_squared = (from + way * middle).length_squared();
        let half = ((radius * radius - off_squared) / speed_squared).sqrt();
        // The root of a negative number is NaN: nothing lies between such ends.
        [middle - half, middle + half]
    } else if from.length() <= radius {
        WHOLE_LINE
    } else {
        [f32::NAN; 2]
    };
    if sides[0].is_nan() {
        return [f32::INFINITY, f32::NEG_INFINITY];
    }
    intersection(sides, slab_interval(ray, center, axis, arm.length()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tilted_plane_reaches_as_far_as_its_corners() {
        let tilted = Vec3::new(0.6, 0.8, 0.0);
        let plane = Solid::Plane { center: Vec3::Y, axes: [tilted, Vec3::Z], half_extents: [5.0, 2.0] };
        let bounds = plane.bounds();
        assert!(bounds.min.distance(Vec3::new(-3.0, -3.0, -2.0)) < 1e-5, "lowest corner {}", bounds.min);
        assert!(bounds.max.distance(Vec3::new(3.0, 5.0, 2.0)) < 1e-5, "highest corner {}", bounds.max);
    }

    #[test]
    fn only_level_planes_are_floors() {
        let plane = |tilt: f32| Solid::Plane {
            center: Vec3::Y,
            axes: [Vec3::new(tilt.cos(), tilt.sin(), 0.0), Vec3::Z],
            half_extents: [5.0, 2.0],
        };
        assert!(plane(0.0).is_floor() && plane(std::f32::consts::PI).is_floor(), "level, either side up");
        assert!(!plane(0.1).is_floor(), "a slope");
        assert!(!Solid::Sphere { center: Vec3::ZERO, radius: 9.0 }.is_floor(), "a sphere");
    }

    /// One of each closed form about the origin, all turned by the same rotation.
    fn closed() -> [Solid; 4] {
        let turn = glam::Mat3::from_euler(glam::EulerRot::XYZ, 0.4, -0.7, 1.1);
        let axes = [turn.x_axis, turn.y_axis, turn.z_axis];
        let (center, arm) = (Vec3::ZERO, turn.y_axis * 0.8);
        [
            Solid::Sphere { center, radius: 0.7 },
            Solid::Box { center, axes, half_extents: [0.5, 0.8, 0.3] },
            Solid::Capsule { center, arm, radius: 0.4 },
            Solid::Cylinder { center, arm, radius: 0.4 },
        ]
    }

    #[test]
    fn lines_of_sight_meet_closed_forms_within_their_boxes_and_nothing_else() {
        for solid in closed() {
            let (bounds, mut touched) = (solid.bounds(), Aabb::<f32>::empty());
            for step in 0..80_i16 {
                for other in 0..80_i16 {
                    for axis in 0..3 {
                        let [a, b] = [step, other].map(|step| f32::from(step) / 40.0 - 0.9875);
                        let mut origin = Vec3::ZERO;
                        (origin[(axis + 1) % 3], origin[(axis + 2) % 3], origin[axis]) = (1.5 * a, 1.5 * b, 5.0);
                        let ray = Ray { origin, direction: -Vec3::AXES[axis] };
                        let Some(distance) = solid.hit(&ray) else { continue };
                        let point = ray.at(distance);
                        touched = touched.include(point);
                        let beyond = Ray { origin: ray.at(distance + 1e-3), ..ray };
                        let again = solid.hit(&beyond).unwrap_or(0.0);
                        assert!(again < 2.0, "{solid:?}: from within the far side is met, {again} m on");
                    }
                }
            }
            let off = (touched.min - bounds.min).abs().max((touched.max - bounds.max).abs()).max_element();
            assert!(off < 0.06, "{solid:?}: {touched:?} is not {bounds:?}");
        }
    }
}
