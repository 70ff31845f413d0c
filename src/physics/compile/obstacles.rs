//! Obstacles of a scene → obstacles of a model, and how bodies meet them.

use std::sync::Arc;

use glam::{DMat3, DVec3};

use super::edges::{EdgeSizes, edges};
use crate::math::{Aabb, Real, RigidMotion, Vector, rotation};
use crate::physics::contact::{DEPTH_SHARE, STIFFNESS_OVER_MASS};
use crate::physics::model::{
    ContactModel, Edges, MeshModel, Model, ObstacleModel, ObstacleShape, OrientedForm, OrientedModel, PlaneModel,
    grown_for_rounding,
};
use crate::scene::obstacle::{Capsule, ContactStiffness, Cylinder, Mesh, Plane};
use crate::scene::{self, Obstacle};

/// No particle rests, or ends a step, deeper in a closed form than this share of the way to its middle: past that the
/// nearest way out is the other side.
const MAX_DEPTH_SHARE: f64 = 0.5;

/// How a body of this size (m) meets an obstacle; `mass` is that of its heaviest particle (kg), `load` what one may have to
/// carry (N).
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
        ContactStiffness::Auto => (STIFFNESS_OVER_MASS * mass).max(load / depth_limit),
    };
    ContactModel {
        stiffness: R::from_f64(stiffness),
        damping: R::from_f64(2.0 * (stiffness * mass).sqrt()),
        depth_limit: R::from_f64(depth_limit),
        thesis_threshold: R::from_f64(cell_size),
    }
}

/// The obstacles of a scene, with edges of these `sizes` for its bodies. The edges of a mesh that is among those of the model
/// `before`, with bodies that need the same, are taken from there.
pub(super) fn obstacles<R: Real>(
    obstacles: &[Obstacle],
    sizes: &[EdgeSizes],
    before: Option<&Model<R>>,
) -> Vec<ObstacleModel<R>> {
    let known = before.filter(|model| sizes_of(model) == sizes).map_or(&[][..], |model| &model.obstacles);
    let (mut sides, mut meshes) = (0, 0);
    obstacles
        .iter()
        .map(|obstacle| {
            let (shape, bounds) = match &obstacle.shape {
                scene::ObstacleShape::Plane(plane) => {
                    sides += 1;
                    plane_model(plane, sides - 1)
                }
                scene::ObstacleShape::Sphere(sphere) => {
                    let center = DVec3::from(sphere.center);
                    let shape = ObstacleShape::Sphere {
                        center: R::Vec3::from_dvec3(center),
                        radius: R::from_f64(sphere.radius),
                    };
                    let reach = DVec3::splat(sphere.radius);
                    (shape, Aabb::around([center - reach, center + reach]))
                }
                scene::ObstacleShape::Box(cuboid) => {
                    let form = OrientedForm::Box { half_extents: cuboid.half_extents.map(R::from_f64) };
                    oriented(&obstacle.shape, cuboid.rotation_deg, form)
                }
                &scene::ObstacleShape::Capsule(Capsule { rotation_deg, radius, half_height, .. }) => {
                    let [radius, half_height] = [radius, half_height].map(R::from_f64);
                    oriented(&obstacle.shape, rotation_deg, OrientedForm::Capsule { radius, half_height })
                }
                &scene::ObstacleShape::Cylinder(Cylinder { rotation_deg, radius, half_height, .. }) => {
                    let [radius, half_height] = [radius, half_height].map(R::from_f64);
                    oriented(&obstacle.shape, rotation_deg, OrientedForm::Cylinder { radius, half_height })
                }
                scene::ObstacleShape::Mesh(mesh) => {
                    let model = mesh_model(mesh, &mut sides, meshes);
                    meshes += 1;
                    (ObstacleShape::Mesh(model), obstacle.shape.bounds())
                }
            };
            let bounds = grown_for_rounding(bounds);
            let motion = obstacle.motion.map(|motion| motion.rigid());
            let bounds = motion.map_or(bounds, |motion| motion_bounds(&bounds, &motion));
            ObstacleModel {
                edges: known
                    .iter()
                    .find(|known| is_same_mesh(&known.shape, &shape))
                    .map_or_else(|| edges_of_each(&shape, sizes), |known| Arc::clone(&known.edges)),
                shape,
                motion,
                carry: None,
                bounds: Aabb { min: R::Vec3::from_dvec3(bounds.min), max: R::Vec3::from_dvec3(bounds.max) },
                friction_static: R::from_f64(obstacle.friction_static),
                friction_dynamic: R::from_f64(obstacle.friction_dynamic),
            }
        })
        .collect()
}

/// The sizes for a model's bodies.
fn sizes_of<R: Real>(model: &Model<R>) -> Vec<EdgeSizes> {
    model.bodies.iter().map(|body| EdgeSizes::of(&body.lattice)).collect()
}

/// The edges of an obstacle for each body; bodies that need the same share them.
fn edges_of_each<R: Real>(shape: &ObstacleShape<R>, sizes: &[EdgeSizes]) -> Arc<[Arc<Edges>]> {
    let mut all: Vec<Arc<Edges>> = Vec::with_capacity(sizes.len());
    for (body, own) in sizes.iter().enumerate() {
        let known = sizes[..body].iter().position(|known| known == own);
        all.push(known.map_or_else(|| Arc::new(edges(shape, *own)), |known| Arc::clone(&all[known])));
    }
    all.into()
}

/// Whether two obstacles are the same mesh, in whatever place.
fn is_same_mesh<R: Real>(one: &ObstacleShape<R>, other: &ObstacleShape<R>) -> bool {
    match (one, other) {
        (ObstacleShape::Mesh(one), ObstacleShape::Mesh(other)) => {
            Arc::ptr_eq(&one.surface, &other.surface) && one.length.to_bits() == other.length.to_bits()
        }
        _ => false,
    }
}

/// The box around all places that the contents of a box come to by their own motion.
fn motion_bounds(bounds: &Aabb<f64>, motion: &RigidMotion) -> Aabb<f64> {
    let reach = DVec3::splat(0.5 * bounds.size().length() + motion.reach());
    Aabb { min: bounds.center() - reach, max: bounds.center() + reach }
}

fn oriented<R: Real>(
    shape: &scene::ObstacleShape,
    rotation_deg: [f64; 3],
    form: OrientedForm<R>,
) -> (ObstacleShape<R>, Aabb<f64>) {
    let turn = rotation::from_euler_deg(rotation_deg);
    let axes = [turn.x_axis, turn.y_axis, turn.z_axis].map(R::Vec3::from_dvec3);
    let center = R::Vec3::from_dvec3(DVec3::from(shape.center()));
    (ObstacleShape::Oriented(OrientedModel { center, axes, form }), shape.bounds())
}

/// # Panics
/// If the model of the obstacle has not been read: whoever opens a scene does that first.
fn mesh_model<R: Real>(mesh: &Mesh, sides: &mut usize, place: usize) -> MeshModel<R> {
    let surface = mesh.surface().expect("models of obstacles are read when a scene is opened");
    let turn = rotation::from_euler_deg(mesh.rotation_deg);
    let side_row = (!surface.is_closed()).then(|| {
        *sides += 1;
        *sides - 1
    });
    MeshModel {
        center: R::Vec3::from_dvec3(DVec3::from(mesh.center)),
        axes: [turn.x_axis, turn.y_axis, turn.z_axis].map(R::Vec3::from_dvec3),
        length: mesh.scale(&surface),
        surface,
        side_row,
        place,
    }
}

fn plane_model<R: Real>(plane: &Plane, side_row: usize) -> (ObstacleShape<R>, Aabb<f64>) {
    let DMat3 { x_axis, y_axis, z_axis } = rotation::from_euler_deg(plane.rotation_deg);
    let center = DVec3::from(plane.center);
    let [a, b] = plane.half_extents;
    let corners = [(-a, -b), (-a, b), (a, -b), (a, b)].map(|(x, z)| center + x_axis * x + z_axis * z);
    let shape = ObstacleShape::Plane(PlaneModel {
        center: R::Vec3::from_dvec3(center),
        axes: [R::Vec3::from_dvec3(x_axis), R::Vec3::from_dvec3(z_axis)],
        half_extents: plane.half_extents.map(R::from_f64),
        normal: R::Vec3::from_dvec3(y_axis),
        side_row,
    });
    (shape, Aabb::around(corners))
}
