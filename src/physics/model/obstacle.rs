//! Obstacles as the narrow phase sees them.

use std::sync::Arc;

use glam::DVec3;

use super::Edges;
use crate::geometry::Surface;
use crate::math::{Aabb, Real, RigidMotion, Vector};

/// An obstacle as the narrow phase sees it.
#[derive(Clone, Debug)]
pub struct ObstacleModel<R: Real> {
    /// Form and place.
    pub shape: ObstacleShape<R>,
    /// The box around it and, where it moves, around its whole path, m.
    pub bounds: Aabb<R>,
    /// Its own motion, relative to its place in `shape` at time zero.
    pub motion: Option<RigidMotion>,
    /// How it moves within the coming substep; none where it stands still.
    pub(in crate::physics) carry: Option<Carry<R>>,
    /// The edges that bodies may meet between their particles, by body: each has as many as its cells need.
    pub(in crate::physics) edges: Arc<[Arc<Edges>]>,
    /// Coulomb coefficient of rest.
    pub friction_static: R,
    /// Coulomb coefficient of motion.
    pub friction_dynamic: R,
}

/// The box around an obstacle is larger by this share of its size and distance from the origin: rounding must not shrink it below
/// the obstacle.
const ROUNDING_SHARE: f64 = 1e-5;

/// A box in double precision, grown so that the same box in the precision of the simulation holds it.
pub(in crate::physics) fn grown_for_rounding(bounds: Aabb<f64>) -> Aabb<f64> {
    bounds.grown(ROUNDING_SHARE * (bounds.size().max_element() + bounds.center().abs().max_element()))
}

impl<R: Real> ObstacleModel<R> {
    /// Whether it has edges, which meet the cells of bodies where particles pass it by.
    pub fn has_edges(&self) -> bool {
        self.edges.iter().any(|edges| !edges.is_empty())
    }
}

impl<R: Real> ObstacleModel<R> {
    /// Where a point that rides along with it ends, m.
    pub(in crate::physics) fn carried(&self, at: DVec3) -> DVec3 {
        self.carry.map_or(at, |carry| carry.apply(R::Vec3::from_dvec3(at)).to_dvec3())
    }

    /// The work (J) of the obstacle's `force` (N) on a point at `at` (m) in a substep of `dt` (s), in which its surface goes the
    /// way of `surface_velocity` (m/s).
    ///
    /// That way is a chord where the obstacle turns. What rides on it has the velocity of the chord before until the force turns
    /// it, and the kinetic energy that an impulse gives goes with the mean of the velocities before and after: that of the surface
    /// as the substep begins. What links do goes with the chord. The larger of both is counted.
    pub(in crate::physics) fn work(&self, force: DVec3, at: DVec3, surface_velocity: DVec3, dt: f64) -> f64 {
        let along_chord = force.dot(surface_velocity) * dt;
        let Some(carry) = self.carry else { return along_chord };
        let point = R::Vec3::from_dvec3(at);
        let way = (carry.apply(point) - carry.place_before(point)).to_dvec3() * 0.5;
        along_chord.max(force.dot(way))
    }
}

/// A rigid motion from the beginning to the end of a substep: `x ↦ turn (x − from) + to`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::physics) struct Carry<R: Real> {
    /// A point at the beginning, m.
    pub(in crate::physics) from: R::Vec3,
    /// The same point at the end, m.
    pub(in crate::physics) to: R::Vec3,
    /// The columns of the rotation.
    pub(in crate::physics) turn: [R::Vec3; 3],
}

impl<R: Real> Carry<R> {
    /// Where a point that rides along ends.
    #[inline]
    pub(in crate::physics) fn apply(&self, point: R::Vec3) -> R::Vec3 {
        let [x, y, z] = (point - self.from).components();
        self.turn[0] * x + self.turn[1] * y + self.turn[2] * z + self.to
    }

    /// Where a point that rides along was as long before, if the obstacle moved alike.
    fn place_before(&self, point: R::Vec3) -> R::Vec3 {
        let way = point - self.to;
        let [x, y, z] = self.turn.map(|column| column.dot(way));
        self.from + R::Vec3::new(x, y, z)
    }
}

/// Form and place of an obstacle.
#[derive(Clone, Debug, PartialEq)]
pub enum ObstacleShape<R: Real> {
    /// A finite plane.
    Plane(PlaneModel<R>),
    /// A ball.
    Sphere {
        /// The middle, m.
        center: R::Vec3,
        /// The radius, m.
        radius: R,
    },
    /// A box, a capsule or a cylinder.
    Oriented(OrientedModel<R>),
    /// A mesh.
    Mesh(MeshModel<R>),
}

impl<R: Real> ObstacleShape<R> {
    /// Half the sides of a box around it, along the axes of the world, m.
    pub(in crate::physics) fn half_extents(&self) -> DVec3 {
        let along = |axes: &[R::Vec3], half: &[f64]| {
            axes.iter().zip(half).map(|(axis, half)| axis.to_dvec3().abs() * *half).sum::<DVec3>()
        };
        match self {
            Self::Plane(plane) => along(&plane.axes, &plane.half_extents.map(R::to_f64)),
            Self::Sphere { radius, .. } => DVec3::splat(radius.to_f64()),
            Self::Oriented(OrientedModel { axes, form, .. }) => along(axes, &form.half_extents().map(R::to_f64)),
            Self::Mesh(mesh) => along(&mesh.axes, &(mesh.surface.half_extents() * mesh.length).to_array()),
        }
    }

    /// The middle, m.
    pub(in crate::physics) fn center_mut(&mut self) -> &mut R::Vec3 {
        match self {
            Self::Plane(PlaneModel { center, .. })
            | Self::Sphere { center, .. }
            | Self::Oriented(OrientedModel { center, .. })
            | Self::Mesh(MeshModel { center, .. }) => center,
        }
    }

    /// Its row of the state's sides; none where it has an inside.
    #[inline]
    pub(in crate::physics) fn side_row(&self) -> Option<usize> {
        match self {
            Self::Plane(plane) => Some(plane.side_row),
            Self::Mesh(mesh) => mesh.side_row,
            Self::Sphere { .. } | Self::Oriented(_) => None,
        }
    }
}

/// A rectangle in space: its middle, its two axes, its normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneModel<R: Real> {
    /// The middle, m.
    pub(in crate::physics) center: R::Vec3,
    /// Unit vectors along the rectangle's own axes.
    pub(in crate::physics) axes: [R::Vec3; 2],
    /// Half the extents along the axes, m.
    pub(in crate::physics) half_extents: [R; 2],
    /// Unit normal.
    pub(in crate::physics) normal: R::Vec3,
    /// Its row of the state's sides.
    pub(in crate::physics) side_row: usize,
}

/// A mesh with three axes of its own.
#[derive(Clone, Debug)]
pub struct MeshModel<R: Real> {
    /// The middle of its box, m.
    pub(in crate::physics) center: R::Vec3,
    /// Unit vectors along its own x, y and z.
    pub(in crate::physics) axes: [R::Vec3; 3],
    /// The longest extent, m: the unit of the surface.
    pub(in crate::physics) length: f64,
    /// The surface about the origin, over its length.
    pub(in crate::physics) surface: Arc<Surface>,
    /// Its row of the state's sides; none of a closed mesh.
    pub(in crate::physics) side_row: Option<usize>,
    /// Its place among the meshes.
    pub(in crate::physics) place: usize,
}

impl<R: Real> PartialEq for MeshModel<R> {
    fn eq(&self, other: &Self) -> bool {
        let same = |a: f64, b: f64| a.to_bits() == b.to_bits();
        Arc::ptr_eq(&self.surface, &other.surface)
            && same(self.length, other.length)
            && (self.center, self.axes, self.side_row) == (other.center, other.axes, other.side_row)
    }
}

impl<R: Real> MeshModel<R> {
    /// A point in its own axes and unit.
    #[inline]
    pub(in crate::physics) fn in_local_frame(&self, point: R::Vec3) -> DVec3 {
        self.displacement_in_local_frame((point - self.center).to_dvec3())
    }

    /// A displacement (m) in its own axes and unit.
    #[inline]
    pub(in crate::physics) fn displacement_in_local_frame(&self, way: DVec3) -> DVec3 {
        let [x, y, z] = self.axes.map(|axis| way.dot(axis.to_dvec3()));
        DVec3::new(x, y, z) / self.length
    }

    /// Turns a direction from its own axes into the scene's.
    #[inline]
    pub(in crate::physics) fn in_scene(&self, own: DVec3) -> DVec3 {
        let [x, y, z] = self.axes.map(Vector::to_dvec3);
        x * own.x + y * own.y + z * own.z
    }
}

/// A closed form with three axes of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrientedModel<R: Real> {
    /// The middle, m.
    pub(in crate::physics) center: R::Vec3,
    /// Unit vectors along its own x, y and z.
    pub(in crate::physics) axes: [R::Vec3; 3],
    /// Its form in those axes.
    pub(in crate::physics) form: OrientedForm<R>,
}

/// A closed form about the origin, unturned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OrientedForm<R> {
    /// A box.
    Box {
        /// Half its sides, m.
        half_extents: [R; 3],
    },
    /// A cylinder about y that ends in half balls.
    Capsule {
        /// The radius of the cylinder and the balls, m.
        radius: R,
        /// Half the length of the cylinder, without the balls, m.
        half_height: R,
    },
    /// A cylinder about y.
    Cylinder {
        /// The radius, m.
        radius: R,
        /// Half the length, m.
        half_height: R,
    },
}

impl<R: Real> OrientedForm<R> {
    /// Half the sides of a box around it, along its own axes, m.
    fn half_extents(self) -> [R; 3] {
        match self {
            Self::Box { half_extents } => half_extents,
            Self::Capsule { radius, half_height } => [radius, radius + half_height, radius],
            Self::Cylinder { radius, half_height } => [radius, half_height, radius],
        }
    }
}

impl<R: Real> OrientedModel<R> {
    /// Turns a direction from the scene's axes into its own.
    #[inline]
    pub(in crate::physics) fn in_local_frame(&self, direction: R::Vec3) -> R::Vec3 {
        let [x, y, z] = self.axes.map(|axis| direction.dot(axis));
        R::Vec3::new(x, y, z)
    }

    /// Turns a direction from its own axes into the scene's.
    #[inline]
    pub(in crate::physics) fn in_scene(&self, own: R::Vec3) -> R::Vec3 {
        let [x, y, z] = own.components();
        self.axes[0] * x + self.axes[1] * y + self.axes[2] * z
    }

    /// The same in double precision.
    pub(in crate::physics) fn to_f64(self) -> OrientedModel<f64> {
        let form = match self.form {
            OrientedForm::Box { half_extents } => OrientedForm::Box { half_extents: half_extents.map(R::to_f64) },
            OrientedForm::Capsule { radius, half_height } => {
                OrientedForm::Capsule { radius: radius.to_f64(), half_height: half_height.to_f64() }
            }
            OrientedForm::Cylinder { radius, half_height } => {
                OrientedForm::Cylinder { radius: radius.to_f64(), half_height: half_height.to_f64() }
            }
        };
        OrientedModel { center: self.center.to_dvec3(), axes: self.axes.map(R::Vec3::to_dvec3), form }
    }
}
