//! Finds the modes of a body for display, beside the sandbox, and describes what is shown of them.

use std::path::Path;
use std::sync::Arc;

use super::background::{BackgroundError, PausingWatch};
use super::document::Opened;
use super::progress::Progress;
use crate::geometry::Watch;
use crate::geometry::watch::CancelOnly;
use crate::machine::free_memory;
use crate::modal::{self, ModalError, Modes, Wanted};
use crate::physics::Simulation;
use crate::scene::edit::BodyId;
use crate::scene::{Body, MovesBy, Scene};

/// How many modes are shown of a body that moves by its cells.
pub const SHOWN_MODES: usize = 20;

/// The most swings per second in the picture: the eye does not follow more.
pub(super) const MAX_SHOWN_HZ: f64 = 2.0;

/// The modes of a body of a scene.
#[derive(Clone, Debug)]
pub struct BodyModes {
    /// The body.
    pub body: BodyId,
    /// The lowest of its modes.
    pub modes: Modes,
    /// The body as it was when they were found.
    pub(super) source_body: Body,
}

/// What is shown of a body's modes.
#[derive(Clone, Debug)]
pub struct Swing {
    /// The modes.
    pub of: Arc<BodyModes>,
    /// For every mode the largest displacement of a particle, as a share of the body's size.
    pub amplitudes: Vec<f64>,
    /// The mode that swings; the others stay as they are.
    pub played: Option<usize>,
}

impl PartialEq for Swing {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.of, &other.of) && (&self.amplitudes, self.played) == (&other.amplitudes, other.played)
    }
}

/// A swing and how long it has been going on.
#[derive(Clone, Debug)]
pub(super) struct Swinging {
    pub(super) swing: Swing,
    /// How long, s.
    pub(super) secs: f64,
}

/// Finds the modes of a body of a scene. Relative model paths start at `base_dir`; `pause` is called now and then.
pub fn body_modes(
    scene: &Scene,
    base_dir: &Path,
    body: BodyId,
    progress: &Progress,
    pause: &(dyn Fn() + Sync),
) -> Result<BodyModes, BackgroundError> {
    let Some(source_body) = scene.bodies.get(body.0) else {
        return Err(BackgroundError::NotPossible("there is no such body"));
    };
    let alone = Scene { bodies: vec![source_body.clone()], obstacles: Vec::new(), ..scene.clone() };
    let opened = Opened::without_file(alone, String::new(), base_dir.to_owned());
    let lattices = opened.lattices(&CancelOnly(progress))?;
    if progress.is_cancelled() {
        return Err(BackgroundError::Cancelled);
    }
    let simulation = Simulation::<f32>::new(&opened.scene, &lattices);
    let count = if source_body.moves_by == MovesBy::Modes { source_body.mode_count as usize } else { SHOWN_MODES };
    let modes =
        compute_modes(&simulation, 0, count, &PausingWatch { progress, pause }).map_err(|error| match error {
            ModalError::Cancelled => BackgroundError::Cancelled,
            error => BackgroundError::Modal(error),
        })?;
    Ok(BodyModes { body, modes, source_body: source_body.clone() })
}

pub(super) fn compute_modes(
    simulation: &Simulation<f32>,
    body: usize,
    count: usize,
    watch: &dyn Watch,
) -> Result<Modes, ModalError> {
    let max_bytes = free_memory().map_or(u64::MAX, |free| free.bytes);
    modal::modes(&simulation.model().bodies[body], Wanted { count, max_bytes }, watch)
}

impl BodyModes {
    /// Whether they belong to the body as it is in the scene now; its place does not matter.
    pub fn is_of(&self, scene: &Scene) -> bool {
        scene.bodies.get(self.body.0).is_some_and(|body| has_same_modes(body, &self.source_body))
    }
}

/// Whether two bodies have the same modes; their places do not matter.
pub(super) fn has_same_modes(body: &Body, other: &Body) -> bool {
    let Body { shape, material, inlays, parts, .. } = body;
    (shape, material, inlays, parts) == (&other.shape, &other.material, &other.inlays, &other.parts)
        && body.has_same_pins(other)
}

impl Swing {
    /// A body bent by one of its modes, by this share of its size.
    pub fn bent(of: &Arc<BodyModes>, mode: usize, share: f64) -> Self {
        let amplitudes = (0..of.modes.modes.len()).map(|number| if number == mode { share } else { 0.0 }).collect();
        Self { of: Arc::clone(of), amplitudes, played: None }
    }

    /// How often the picture of the played mode swings in a second, Hz, and how many times slower that is than the mode.
    pub fn shown_hz(&self) -> Option<(f64, f64)> {
        let hertz = self.of.modes.modes.get(self.played?)?.frequency_hz;
        let shown = hertz.min(MAX_SHOWN_HZ);
        (shown > 0.0).then(|| (shown, hertz / shown))
    }
}
