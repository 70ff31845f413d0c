//! The bodies of a scene made ready: lattices to simulate, skins to draw. What an edit leaves alone is kept.

use std::path::Path;
use std::sync::Arc;

use super::SessionError;
use crate::extract::skin::{cells_skin, model_skin};
use crate::geometry::{Lattice, Watch};
use crate::scene::resolve::{Jelly, resolve};
use crate::scene::{Body, Scene, Skin as SkinChoice};
use crate::view::{SkinInstance, Style};

/// The bodies of a scene, made ready.
#[derive(Clone, Debug, Default)]
pub(super) struct Bodies {
    jellies: Vec<Jelly>,
    skins: Vec<SkinInstance>,
}

impl Bodies {
    /// Resolves every body; `kept` says which of `before`'s has the shape of each, if one has.
    pub(super) fn resolve(
        scene: &Scene,
        base_dir: &Path,
        watch: &dyn Watch,
        before: &Self,
        kept: &[Option<usize>],
    ) -> Result<Self, SessionError> {
        let resolve_one = |(index, body): (usize, &Body)| match kept.get(index).copied().flatten() {
            Some(old) => Ok(before.jellies[old].clone()),
            None => resolve(&body.shape, base_dir, watch).map_err(|source| SessionError::Shape { index, source }),
        };
        let jellies = scene.bodies.iter().enumerate().map(resolve_one).collect::<Result<_, _>>()?;
        let mut bodies = Self { jellies, skins: Vec::new() };
        bodies.dress(scene);
        Ok(bodies)
    }

    /// Makes the skins anew, for a scene of the same bodies.
    pub(super) fn dress(&mut self, scene: &Scene) {
        let style = Style::default();
        let mut first = 0u32;
        self.skins.clear();
        for (index, (body, jelly)) in scene.bodies.iter().zip(&self.jellies).enumerate() {
            if !body.hidden {
                let skin = match (&jelly.mesh, body.skin) {
                    (Some(mesh), SkinChoice::Auto) => model_skin(&jelly.lattice, mesh, first),
                    _ => cells_skin(&jelly.lattice, first),
                };
                self.skins.push(SkinInstance { skin: Arc::new(skin), color: style.body(index) });
            }
            first += u32::try_from(jelly.lattice.corners.len()).unwrap_or(u32::MAX);
        }
    }

    /// The lattices, in the scene's order.
    pub(super) fn lattices(&self) -> Vec<Arc<Lattice>> {
        self.jellies.iter().map(|jelly| Arc::clone(&jelly.lattice)).collect()
    }

    /// The skins of the visible bodies.
    pub(super) fn skins(&self) -> &[SkinInstance] {
        &self.skins
    }

    /// What a person should know of the models, a sentence each.
    pub(super) fn warnings(&self) -> impl Iterator<Item = &String> {
        self.jellies.iter().flat_map(|jelly| &jelly.warnings)
    }
}
