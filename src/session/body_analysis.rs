//! How far the values of the materials may go before a step has to be divided: found once for each material, lattice
//! and step, not every frame.

use std::sync::Arc;

use crate::geometry::Lattice;
use crate::physics::{BodyModel, ContactLoad, OtherForm, SafeValue, StepSettings, largest_safe};
use crate::scene::body::{Inlay, Part};
use crate::scene::own_weight::Stature;
use crate::scene::{Body, Material, Scene};

/// The results for one body.
#[derive(Clone, Debug)]
pub(super) struct BodyAnalysis {
    material: Material,
    lattice: Arc<Lattice>,
    inlays: Vec<Inlay>,
    parts: Vec<Part>,
    step: StepSettings,
    contact: ContactLoad,
    /// The build of the body.
    pub(super) stature: Stature,
    /// How far its values may go.
    pub(super) safe: Arc<Vec<SafeValue>>,
    /// Its materials in the other form.
    pub(super) other_form: Arc<OtherForm>,
}

/// Finds the safe values, the other form and the build of every body, compiled to `models`. Results from `before` are kept
/// for bodies that have not changed.
pub(super) fn analyse_bodies(scene: &Scene, models: &[BodyModel<f32>], before: &[BodyAnalysis]) -> Vec<BodyAnalysis> {
    let step = StepSettings::of(scene);
    let find_one = |(body, model): (&Body, &BodyModel<f32>)| {
        let (lattice, contact) = (Arc::clone(&model.lattice), ContactLoad::of(model, scene));
        let fits = |analysis: &&BodyAnalysis| {
            Arc::ptr_eq(&analysis.lattice, &lattice)
                && analysis.material == body.material
                && analysis.inlays == body.inlays
                && analysis.parts == body.parts
                && analysis.step == step
                && analysis.contact == contact
        };
        let of_lattice = before.iter().find(|analysis| Arc::ptr_eq(&analysis.lattice, &lattice));
        before.iter().find(fits).cloned().unwrap_or_else(|| BodyAnalysis {
            safe: Arc::new(largest_safe(body, model, step, contact)),
            other_form: Arc::new(OtherForm::of(body, &lattice)),
            stature: of_lattice.map_or_else(|| Stature::of(&lattice), |analysis| analysis.stature),
            material: body.material.clone(),
            lattice,
            inlays: body.inlays.clone(),
            parts: body.parts.clone(),
            step,
            contact,
        })
    };
    scene.bodies.iter().zip(models).map(find_one).collect()
}
