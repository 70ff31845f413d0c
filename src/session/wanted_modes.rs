//! The modes that a body is to move by: the search for them, beside the sandbox or in it, where they are kept, and the
//! outcome.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::background::{BackgroundError, PausingWatch};
use super::document::Opened;
use super::modes::{compute_modes, has_same_modes};
use super::modes_cache::{self, ENDING};
use super::progress::Progress;
use crate::geometry::Watch;
use crate::geometry::watch::CancelOnly;
use crate::modal::ModalError;
use crate::physics::{BodyModel, ModalModel, Simulation};
use crate::scene::edit::BodyId;
use crate::scene::{Body, MovesBy, Scene, named};

/// Modes that a body of the scene is to move by and that are still to be found.
#[derive(Clone, Debug, PartialEq)]
pub struct WantedModes {
    /// The body.
    pub body: BodyId,
    /// Its name.
    pub name: String,
    /// The body that they are of.
    source_body: Body,
}

/// The outcome of the search for a body's modes.
#[derive(Clone, Debug)]
pub struct FoundModes {
    pub(super) source_body: Body,
    pub(super) outcome: SearchOutcome,
}

/// The possible outcomes.
#[derive(Clone, Debug)]
pub(super) enum SearchOutcome {
    /// The body moves by these modes.
    Found(Arc<ModalModel>),
    /// The body cannot move by modes; why, as half a sentence.
    Refused(String),
    /// A person stopped the search.
    Stopped,
}

impl WantedModes {
    /// The modes wanted for a body of a scene, if it is to move by modes.
    pub(super) fn of(scene: &Scene, body: usize) -> Option<Self> {
        let source_body = &scene.bodies[body];
        is_wanted(source_body).then(|| Self {
            body: BodyId(body),
            name: named(&source_body.name, "body", body),
            source_body: source_body.clone(),
        })
    }

    /// The outcome if nobody wants to wait for them.
    pub fn stopped(&self) -> FoundModes {
        FoundModes { source_body: self.source_body.clone(), outcome: SearchOutcome::Stopped }
    }

    /// The outcome if they cannot be found; why, as half a sentence.
    pub fn refused(&self, why: String) -> FoundModes {
        FoundModes { source_body: self.source_body.clone(), outcome: SearchOutcome::Refused(why) }
    }

    /// Whether another body waits for the same modes.
    pub fn is_alike(&self, other: &Self) -> bool {
        has_same_modes_and_count(&self.source_body, &other.source_body)
    }

    /// Reads them from a folder where they are kept, or finds them in a compiled body and keeps them there.
    pub(super) fn find_in(
        &self,
        simulation: &Simulation<f32>,
        body: usize,
        folder: Option<&Path>,
        watch: &dyn Watch,
    ) -> Result<FoundModes, ModalError> {
        let model = &simulation.model().bodies[body];
        let count = self.source_body.mode_count as usize;
        let key = modes_cache::key(model, count);
        let kept = folder.and_then(|folder| modes_cache::read(folder, key, model));
        let outcome = match kept {
            Some(kept) => SearchOutcome::Found(Arc::new(kept)),
            None => match compute_modes(simulation, body, count, watch) {
                Ok(found) if found.rigid != rigid_motions(model) => SearchOutcome::Refused(refusal(model).to_owned()),
                Ok(found) => {
                    let modes = found.reduced(model);
                    if let Some(folder) = folder {
                        modes_cache::write(folder, key, &modes);
                    }
                    SearchOutcome::Found(modes)
                }
                Err(ModalError::Cancelled) => return Err(ModalError::Cancelled),
                Err(error) => SearchOutcome::Refused(error.to_string()),
            },
        };
        Ok(FoundModes { source_body: self.source_body.clone(), outcome })
    }
}

/// Returns the folder in which found modes are kept: beside the scene's file, with the name of the file. For a scene without
/// a file it is in `spare`, the folder of data that can be found anew, if there is one.
pub fn folder(file: Option<&Path>, spare: Option<PathBuf>) -> Option<PathBuf> {
    let beside = file.map(|file| file.with_extension(ENDING));
    beside.or_else(|| spare.map(|spare| spare.join(ENDING)))
}

/// Finds the modes that a body of a scene waits for, unless `folder` has them. Relative model paths start at `base_dir`;
/// `pause` is called now and then.
pub fn find_modes(
    scene: &Scene,
    base_dir: &Path,
    wanted: &WantedModes,
    folder: Option<&Path>,
    progress: &Progress,
    pause: &(dyn Fn() + Sync),
) -> Result<FoundModes, BackgroundError> {
    let alone = Scene { bodies: vec![wanted.source_body.clone()], obstacles: Vec::new(), ..scene.clone() };
    let opened = Opened::without_file(alone, String::new(), base_dir.to_owned());
    let lattices = opened.lattices(&CancelOnly(progress))?;
    if progress.is_cancelled() {
        return Err(BackgroundError::Cancelled);
    }
    let simulation = Simulation::<f32>::new(&opened.scene, &lattices);
    wanted
        .find_in(&simulation, 0, folder, &PausingWatch { progress, pause })
        .map_err(|_cancelled| BackgroundError::Cancelled)
}

/// Whether a body is to move by modes.
pub(super) fn is_wanted(body: &Body) -> bool {
    body.moves_by == MovesBy::Modes
}

/// The number of rigid motions that a body must have: 6 where nothing holds it, otherwise none.
fn rigid_motions(body: &BodyModel<f32>) -> usize {
    if body.is_held() { 0 } else { 6 }
}

/// Explains why a body with another number of rigid motions cannot move by modes, as half a sentence.
fn refusal(body: &BodyModel<f32>) -> &'static str {
    if body.is_held() {
        "a part of it can still turn or move freely, which modes cannot follow; hold it at three places or more that are not \
         in a line"
    } else {
        "it is of loose pieces, which would move apart and modes cannot follow; join them or hold each"
    }
}

/// Whether two bodies have the same modes, and want as many of them.
pub(super) fn has_same_modes_and_count(body: &Body, source_body: &Body) -> bool {
    body.mode_count == source_body.mode_count && has_same_modes(body, source_body)
}
