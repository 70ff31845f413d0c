//! How far the values of the materials may go before a step has to be divided: found once for each material, lattice
//! and step, not every frame.

use std::sync::Arc;

use crate::geometry::Lattice;
use crate::physics::BodyModel;
use crate::physics::other_form;
use crate::physics::{ContactLoad, SafeValue, largest_safe};
use crate::scene::body::Inlay;
use crate::scene::own_weight::Stature;
use crate::scene::settings::Integrator;
use crate::scene::{Body, Material, Scene};

/// What was found for one body.
#[derive(Clone, Debug)]
pub(super) struct Found {
    material: Material,
    lattice: Arc<Lattice>,
    inlays: Vec<Inlay>,
    dt_secs: f64,
    integrator: Integrator,
    among_obstacles: bool,
    contact: ContactLoad,
    /// How it is built.
    pub(super) stature: Stature,
    /// How far its values may go.
    pub(super) safe: Arc<Vec<SafeValue>>,
    /// Its material in the other form.
    pub(super) other: Material,
}

/// Finds what has become of every body, of which `models` were compiled; what was found before and has not changed is
/// kept.
pub(super) fn find(scene: &Scene, models: &[BodyModel<f32>], before: &[Found]) -> Vec<Found> {
    let (dt_secs, integrator) = (scene.settings.dt, scene.settings.integrator);
    let among_obstacles = !scene.obstacles.is_empty();
    let find_one = |(body, model): (&Body, &BodyModel<f32>)| {
        let (lattice, contact) = (Arc::clone(&model.lattice), ContactLoad::of(model, scene));
        let fits = |found: &&Found| {
            Arc::ptr_eq(&found.lattice, &lattice)
                && found.material == body.material
                && found.inlays == body.inlays
                && found.dt_secs.to_bits() == dt_secs.to_bits()
                && (found.integrator, found.among_obstacles) == (integrator, among_obstacles)
                && found.contact == contact
        };
        let of_lattice = before.iter().find(|found| Arc::ptr_eq(&found.lattice, &lattice));
        before.iter().find(fits).cloned().unwrap_or_else(|| Found {
            safe: Arc::new(largest_safe(body, &lattice, dt_secs, integrator, among_obstacles, contact)),
            other: other_form(&body.material, &lattice),
            stature: of_lattice.map_or_else(|| Stature::of(&lattice), |found| found.stature),
            material: body.material.clone(),
            lattice,
            inlays: body.inlays.clone(),
            dt_secs,
            integrator,
            among_obstacles,
            contact,
        })
    };
    scene.bodies.iter().zip(models).map(find_one).collect()
}
