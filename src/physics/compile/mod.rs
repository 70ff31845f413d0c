//! Compiles the document to a running simulation, and an edited document to one that goes on: places particles, measures
//! links, frames obstacles, plans steps.

mod assembly;
mod edges;
mod kinds;
mod link_classes;
mod mesh_edges;
mod modal;
mod obstacles;
pub(in crate::physics) mod other_form;
mod pins;
mod plan;
mod recovery;
pub(in crate::physics) mod safe_values;
mod scheme;
mod scheme_cost;
mod spring_loads;
mod springs_by_cell;
pub(in crate::physics) mod stability_plane;
pub(in crate::physics) mod step_loads;
mod waves;

use std::path::Path;
use std::sync::Arc;

use glam::DVec3;
use thiserror::Error;

use super::model::{BodyContactModel, BodyModel, Composition, LinkFamily, Model, Samples, Values};
use crate::geometry::{Family, Lattice};
use crate::math::{Aabb, Real, Vector, rotation};
use crate::physics::kernels::{BoxedLinks, Layout};
use crate::physics::limits::{any_state, lattice};
use crate::physics::model::ModalModel;
use crate::physics::model::plan::Plan;
use crate::physics::simulation::{Arrival, Simulation};
use crate::physics::state::fallen;
use crate::scene::param::{self, Problem};
use crate::scene::part_problem::part_problem;
use crate::scene::resolve::{MeshError, ResolveError, load_meshes, resolve};
use crate::scene::{Body, ContactOn, Material, Scene};
use assembly::Assembled;
use edges::EdgeSizes;
use kinds::Kinds;
use springs_by_cell::springs_by_cell;

/// Why a scene cannot be simulated.
#[derive(Debug, Error)]
pub enum SceneError {
    /// A value is not allowed.
    #[error(transparent)]
    Value(#[from] Problem),
    /// The mesh of an obstacle cannot be used.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A shape gives no particles.
    #[error("bodies.{body}: its shape cannot be made of cells")]
    Shape {
        /// Its place among the bodies, from 0.
        body: usize,
        /// Why.
        source: ResolveError,
    },
}

impl<R: Real> Simulation<R> {
    /// A scene at its start. Model files are looked for in `folder`, read and filled with cells. Bodies that are to move by
    /// their modes move by their cells until they are given some ([`Self::set_modes`]).
    ///
    /// # Errors
    /// The first value that is not allowed, by its path, or the first body whose shape cannot be made of cells.
    pub fn from_scene(scene: &Scene, folder: &Path) -> Result<Self, SceneError> {
        if let Some(problem) = param::validate(scene).into_iter().next() {
            return Err(problem.into());
        }
        let mut scene = scene.clone();
        load_meshes(&mut scene, folder, &())?;
        let lattices = scene.bodies.iter().enumerate().map(|(body, described)| {
            let jelly = resolve(&described.shape, scene.model_places(folder), &());
            jelly.map(|jelly| jelly.lattice).map_err(|source| SceneError::Shape { body, source })
        });
        let lattices = lattices.collect::<Result<Vec<_>, _>>()?;
        let mut bodies = scene.bodies.iter().zip(&lattices).enumerate();
        if let Some(problem) = bodies.find_map(|(place, (body, lattice))| part_problem(place, body, lattice)) {
            return Err(problem.into());
        }
        Ok(Self::new(&scene, &lattices))
    }

    /// A scene at its start. `lattices` are those of the scene's bodies, in their order.
    pub fn new(scene: &Scene, lattices: &[Arc<Lattice>]) -> Self {
        Self::with_modes(scene, lattices, &[])
    }

    /// The same with modes for the bodies that have any, in the bodies' order; the others move by their cells.
    pub fn with_modes(scene: &Scene, lattices: &[Arc<Lattice>], modes: &[Option<Arc<ModalModel>>]) -> Self {
        let (model, plan) = compile(scene, lattices, modes, None);
        Self::start(model, plan)
    }

    /// Lets bodies move by these modes from now on, each from its present place and motion; bodies without modes move by
    /// their cells. The scene must be the one that goes on.
    pub fn set_modes(&mut self, scene: &Scene, lattices: &[Arc<Lattice>], modes: &[Option<Arc<ModalModel>>]) {
        let kept: Vec<Option<usize>> = (0..scene.obstacles.len()).map(Some).collect();
        let (model, plan) = compile(scene, lattices, modes, Some(self.model()));
        self.replace_model(model, plan, &kept, Arrival::Placed);
    }

    /// Takes new parameters, obstacles and settings while everything keeps moving: the scene must have the bodies and
    /// lattices it had. `kept` names, for each obstacle of the scene, the old one that it was.
    pub fn set_parameters(
        &mut self,
        scene: &Scene,
        lattices: &[Arc<Lattice>],
        kept: &[Option<usize>],
        arrival: Arrival,
    ) {
        let modes: Vec<_> = self.model().bodies.iter().map(|body| body.modes().cloned()).collect();
        let (model, plan) = compile(scene, lattices, &modes, Some(self.model()));
        self.replace_model(model, plan, kept, arrival);
    }
}

/// Builds the model of a scene and the plan of its step; `lattices` are those of the scene's bodies, in their order. What
/// follows from a lattice alone is taken from bodies of the model `before`, where there is one: changing a constant does not
/// measure a million links again. `modes` are those of bodies that have any, in the bodies' order.
///
/// # Panics
/// If there are not as many lattices as bodies: the caller resolves every body first.
pub(super) fn compile<R: Real>(
    scene: &Scene,
    lattices: &[Arc<Lattice>],
    modes: &[Option<Arc<ModalModel>>],
    before: Option<&Model<R>>,
) -> (Model<R>, Plan) {
    assert_eq!(scene.bodies.len(), lattices.len(), "every body needs its lattice");
    let gravity = DVec3::from(scene.settings.gravity);
    let sizes: Vec<_> = lattices.iter().map(|lattice| EdgeSizes::of(lattice)).collect();
    let mut model = Model {
        bodies: Vec::new(),
        obstacles: obstacles::obstacles(&scene.obstacles, &sizes, before),
        gravity: R::Vec3::from_dvec3(gravity),
        fall_limit: None,
    };
    let (mut first, before) = (0, before.map_or(&[][..], |model| &model.bodies));
    for (number, (body, lattice)) in scene.bodies.iter().zip(lattices).enumerate() {
        let mut compiled = compile_body(body, lattice, first, scene, before);
        if let Some(modes) = modes.get(number).and_then(Option::as_ref) {
            modal::give_modes(&mut compiled, modes, &body.pose, before);
        }
        first = compiled.particles.end;
        model.bodies.push(compiled);
    }
    model.fall_limit = fallen::limit(&model);
    let plan = plan::plan(&scene.settings, modal::without_modal(&model).as_ref().unwrap_or(&model));
    for body in &mut model.bodies {
        recovery::limit_to_substep(body, &plan);
    }
    (model, plan)
}

fn compile_body<R: Real>(
    body: &Body,
    lattice: &Arc<Lattice>,
    first: usize,
    scene: &Scene,
    before: &[BodyModel<R>],
) -> BodyModel<R> {
    let gravity = DVec3::from(scene.settings.gravity).length();
    let rotation = rotation::from_euler_deg(body.pose.rotation_deg);
    let position = DVec3::from(body.pose.position);
    let rest: Vec<DVec3> = (0..lattice.corners.len()).map(|p| lattice.rest_position(p)).collect();
    let size = Aabb::<f64>::around(rest.iter().copied()).size().max_element();
    let pinned = pins::pinned(body, lattice, &rest);
    let known = before.iter().find(|body| Arc::ptr_eq(&body.lattice, lattice));
    let measured = known.map_or_else(
        || assembly::measure_links(lattice, &rest),
        |body| body.links.each_ref().map(LinkFamily::shared_links),
    );
    let inverse_length_sums = known.map_or_else(
        || any_state::inverse_length_sums(rest.len(), &measured),
        |body| Arc::clone(&body.inverse_length_sums),
    );
    let modulus = |stiffness| assembly::modulus(stiffness, lattice);
    let Kinds { all: kinds, numbers, of_cell: kind_of_cell } = match &body.material {
        Material::Springs(springs) => kinds::of_springs(springs, body, lattice, &rest),
        Material::Solid(solid) => kinds::of_solid(solid, body, lattice, size, &rest),
    };
    let of_kind = |kind: &u8| modulus(kinds[usize::from(*kind)].stiffness[Family::Shear as usize]);
    let moduli = match &kind_of_cell {
        Values::Uniform(kind) => Values::Uniform(of_kind(kind)),
        Values::Each(kinds) => Values::Each(kinds.iter().map(of_kind).collect()),
    };
    let of_recovery = scene.settings.inversion_recovery.then(|| match &body.material {
        Material::Springs(_) => recovery::of_springs(&kinds, lattice),
        Material::Solid(_) => recovery::of_cells(&kinds, lattice),
    });
    let (Assembled { particle_mass, masses, links }, composition) = match &body.material {
        Material::Springs(springs) if kinds.len() == 1 => (assembly::uniform(springs, measured), Composition::Alike),
        Material::Springs(_) => {
            let (assembled, loads) = springs_by_cell(kinds, &kind_of_cell, lattice, measured);
            (assembled, Composition::Springs { loads: Arc::new(loads), numbers })
        }
        Material::Solid(_) => {
            let assembled = assembly::by_cell(&kinds, &kind_of_cell, lattice, measured);
            let load_share = if kinds.len() > 1 {
                1.0
            } else {
                known_load_share(before, lattice)
                    .unwrap_or_else(|| lattice::load_share(lattice, [assembly::STRUCTURAL_OVER_SHEAR, 1.0]))
            };
            (assembled, Composition::Solids { kinds, load_share })
        }
    };
    let (heaviest, masses) = match masses {
        Values::Uniform(mass) => (mass, Values::Uniform(R::from_f64(mass))),
        Values::Each(masses) => {
            let heaviest = masses.iter().copied().fold(particle_mass, f64::max);
            (heaviest, Values::Each(masses.into_iter().map(R::from_f64).collect()))
        }
    };
    let layout = known.map_or_else(
        || Layout::new(lattice).map(Arc::new),
        |body| body.boxed_links.as_ref().map(|boxed| Arc::clone(&boxed.layout)),
    );
    let boxed_links = layout.map(|layout| BoxedLinks::new(layout, lattice, &links));
    let load = max_carried_particles(lattice) * heaviest * gravity;
    let meets_others = scene.settings.body_contact && body.collides && scene.bodies.len() > 1;
    let is_on_mesh = body.contact_on == ContactOn::Mesh;
    let samples_known = known.and_then(|body| body.samples.as_ref().map(Arc::clone));
    let samples_known = samples_known.filter(|samples| samples.meet_bodies || !meets_others);
    let new_samples = || Samples::new(lattice, meets_others).map(Arc::new);
    let samples = if is_on_mesh { samples_known.or_else(new_samples) } else { None };
    // A body may stand on a single point of its mesh, pressed in by a quarter of the depth limit.
    let weight = particle_mass * rest.len() as f64 * gravity;
    let max_point_load = if samples.is_some() { load.max(4.0 * weight) } else { load };
    let hull = known.map_or_else(Arc::default, |body| Arc::clone(&body.body_contact.hull));
    BodyModel {
        particles: first..first + rest.len(),
        start: rest.iter().map(|p| R::Vec3::from_dvec3(position + rotation * *p)).collect(),
        start_velocity: R::Vec3::from_dvec3(DVec3::from(body.velocity)),
        particle_mass: R::from_f64(particle_mass),
        masses,
        composition,
        moduli,
        pinned,
        links,
        boxed_links,
        inverse_length_sums,
        lattice: Arc::clone(lattice),
        size: R::from_f64(size),
        inverse_cell_size: R::from_f64(1.0 / lattice.grid.cell_size),
        recovery: recovery::unlimited(of_recovery.unwrap_or([0.0, particle_mass])),
        contacts: scene
            .obstacles
            .iter()
            .map(|obstacle| obstacles::contact(obstacle, heaviest, size, max_point_load, lattice.grid.cell_size))
            .collect(),
        body_contact: BodyContactModel {
            meets_others,
            meets_itself: scene.settings.body_contact && body.self_collides,
            hull,
            friction: [body.friction_static, body.friction_dynamic],
            heaviest,
            max_load: max_point_load,
        },
        modal: None,
        samples,
    }
}

/// The load share of a body of one solid with this lattice, where there is such a body.
fn known_load_share<R: Real>(bodies: &[BodyModel<R>], lattice: &Arc<Lattice>) -> Option<f64> {
    let of_one = |body: &BodyModel<R>| match &body.composition {
        Composition::Solids { kinds, load_share } if kinds.len() == 1 => Some(*load_share),
        _ => None,
    };
    bodies.iter().filter(|body| Arc::ptr_eq(&body.lattice, lattice)).find_map(of_one)
}

/// Particles that one particle in contact may have to carry at rest: the tallest column, or all of them on the
/// smallest of the six outer layers, as a tree stands on its trunk.
fn max_carried_particles(lattice: &Lattice) -> f64 {
    let mut column = 0;
    let mut layer = usize::MAX;
    for axis in 0..3 {
        let along = || lattice.corners.iter().map(|corner| corner[axis]);
        let (Some(low), Some(high)) = (along().min(), along().max()) else { return 0.0 };
        column = column.max(high - low + 1);
        for end in [low, high] {
            layer = layer.min(along().filter(|&c| c == end).count());
        }
    }
    f64::from(column).max(lattice.corners.len() as f64 / layer as f64)
}

#[cfg(test)]
mod tests {
    use std::error::Error;

    use super::*;
    use crate::scene::body::{Body, ModelShape, Shape};

    fn refused(change: impl FnOnce(&mut Scene)) -> String {
        let mut scene = Scene { bodies: vec![Body::default()], ..Scene::default() };
        change(&mut scene);
        let error = Simulation::<f32>::from_scene(&scene, Path::new(".")).expect_err("it is refused");
        let cause = error.source().map_or_else(String::new, |cause| format!(": {cause}"));
        format!("{error}{cause}")
    }

    #[test]
    fn what_cannot_be_simulated_is_refused_by_its_path() {
        let said = refused(|scene| scene.settings.dt = -1.0);
        assert!(said.starts_with("settings.dt = "), "{said}");
        let shape = ModelShape { path: "no-such-file.obj".to_owned(), ..ModelShape::default() };
        let said = refused(|scene| scene.bodies[0].shape = Shape::Model(shape));
        assert!(said.starts_with("bodies.0: ") && said.contains("no-such-file.obj"), "{said}");
    }
}
