//! Compiles modal bodies, and takes them out of what limits the step.

use std::sync::Arc;

use glam::DVec3;

use crate::math::{Aabb, Real, rotation};
use crate::physics::model::{
    BodyModel, Composition, Inertia, LinkConstants, LinkFamily, ModalBody, ModalModel, ModalPoints, Model,
};
use crate::scene::Pose;

/// Makes a compiled body move by modes, if these are of as many particles as it has. Its points that meet obstacles are
/// taken over from a body that moved by the same modes.
pub(super) fn give_modes<R: Real>(
    body: &mut BodyModel<R>,
    modes: &Arc<ModalModel>,
    pose: &Pose,
    before: &[BodyModel<R>],
) {
    if modes.particle_count() != body.particles.len() {
        return;
    }
    let is_free = !body.is_held();
    let alike = |modal: &&ModalBody| {
        let is_on_mesh = modal.points.is_on_mesh() == body.samples.is_some();
        Arc::ptr_eq(&modal.modes, modes) && is_on_mesh && modal.rigid.is_some() == is_free
    };
    let known = before.iter().filter_map(|body| body.modal.as_ref()).find(alike);
    let points = known.map_or_else(
        || Arc::new(ModalPoints::new(&body.lattice, modes, body.samples.as_ref(), is_free)),
        |modal| Arc::clone(&modal.points),
    );
    let rigid = is_free.then(|| {
        Inertia::new((0..body.particles.len()).map(|p| (body.mass(p).to_f64(), body.lattice.rest_position(p))))
    });
    let (turn, origin) = (rotation::from_euler_deg(pose.rotation_deg), DVec3::from(pose.position));
    let bounds = Aabb::<f64>::around((0..body.particles.len()).map(|p| body.lattice.rest_position(p)));
    let alike = known.map(|modal| Arc::clone(&modal.max_displacements));
    let max_displacements = alike.unwrap_or_else(|| max_displacements(modes, body.particles.len()));
    body.modal = Some(ModalBody { modes: Arc::clone(modes), bounds, max_displacements, points, rigid, turn, origin });
    // A motion in which parts of the body would meet is no longer a small one, for which modes hold.
    body.body_contact.meets_itself = false;
}

/// For each mode the largest displacement of a particle for an amplitude of 1, 1/√kg.
fn max_displacements(modes: &ModalModel, particles: usize) -> Arc<[f64]> {
    let mut max_displacements = vec![0.0_f64; modes.count()];
    for particle in 0..particles {
        for (displacement, way) in max_displacements.iter_mut().zip(modes.row(particle)) {
            *displacement = displacement.max(DVec3::from(way.map(f64::from)).length());
        }
    }
    max_displacements.into()
}

/// A copy of a model in which modal bodies have nothing that would limit a step; none where no body is modal.
pub(super) fn without_modal<R: Real>(model: &Model<R>) -> Option<Model<R>> {
    model.bodies.iter().any(|body| body.modal.is_some()).then(|| {
        let Model { bodies, obstacles, gravity, fall_limit } = model;
        let bodies = bodies.iter().map(|body| if body.modal.is_some() { without_links(body) } else { body.clone() });
        Model { bodies: bodies.collect(), obstacles: obstacles.clone(), gravity: *gravity, fall_limit: *fall_limit }
    })
}

/// A body of the same particles without any link.
fn without_links<R: Real>(body: &BodyModel<R>) -> BodyModel<R> {
    let none = || LinkFamily {
        stiffness: R::ZERO,
        damping: R::ZERO,
        links: Arc::default(),
        constants: LinkConstants::Uniform([R::ZERO; 2]),
    };
    let mut without_links = BodyModel {
        composition: Composition::Alike,
        links: std::array::from_fn(|_| none()),
        boxed_links: None,
        inverse_length_sums: Arc::default(),
        samples: None,
        body_contact: body.body_contact.clone(),
        ..body.clone()
    };
    without_links.recovery.stiffness = R::ZERO;
    without_links
}
