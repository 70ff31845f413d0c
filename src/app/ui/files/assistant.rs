//! The state of the assistant that makes a model into jelly, and its requests for the work.

use std::path::Path;
use std::sync::Arc;

use egui::Ui;

use super::inset::Inset;
use super::path_field::{PathField, PathUse, Verdict};
use super::request::FileRequest;
use crate::app::ui::Running;
use crate::scene::body::{Body, ModelShape, Shape};
use crate::scene::edit::BodyId;
use crate::session::jellify::{Jellified, Wanted};
use crate::session::progress::Progress;

/// How long the values must stay the same before the work begins, s.
const PAUSE_SECS: f64 = 0.3;

/// The assistant.
#[derive(Debug)]
pub(super) struct LoadModel {
    pub(super) source: ModelSource,
    pub(super) shape: ModelShape,
    /// The last shape wanted.
    pub(super) wanted_shape: Option<ModelShape>,
    changed_secs: f64,
    pub(super) work: Work,
    /// The picture of the result.
    pub(super) inset: Inset,
}

/// The model that is made into jelly.
#[derive(Debug)]
pub(super) enum ModelSource {
    /// A file, as a new body.
    File(PathField),
    /// The model of a body of the scene, once more.
    Body(BodyId),
}

/// The state of the work.
#[derive(Debug, Default)]
pub enum Work {
    /// There is nothing to do.
    #[default]
    Idle,
    /// It is in progress.
    Running(Arc<Progress>),
    /// The body is ready.
    Ready(Box<Jellified>),
    /// It has failed; the reason as a sentence.
    Failed(String),
}

impl LoadModel {
    /// An assistant that begins with a path.
    pub(super) fn new(start: &Path) -> Self {
        Self::with(ModelSource::File(PathField::new(PathUse::OpenModel, start)), ModelShape::for_new())
    }

    /// An assistant that begins with the model of a body.
    pub(super) fn of_body(id: BodyId, shape: ModelShape) -> Self {
        Self::with(ModelSource::Body(id), shape)
    }

    fn with(source: ModelSource, shape: ModelShape) -> Self {
        let (changed_secs, inset) = (f64::NEG_INFINITY, Inset::default());
        Self { source, shape, wanted_shape: None, changed_secs, work: Work::Idle, inset }
    }

    /// Puts another path into the field.
    pub(super) fn set(&mut self, path: &Path) {
        if let ModelSource::File(field) = &mut self.source {
            field.set(path);
        }
    }

    /// Sets the state of the work.
    pub(super) fn set_work(&mut self, work: Work) {
        self.work = work;
    }

    /// The shape according to the values; `None` until the path leads to a file.
    fn wanted(&mut self) -> Option<ModelShape> {
        let ModelSource::File(field) = &mut self.source else { return Some(self.shape.clone()) };
        let Verdict::Usable(path, _) = field.verdict() else { return None };
        let path = std::path::absolute(path).ok()?;
        Some(ModelShape { path: path.to_str()?.to_owned(), ..self.shape.clone() })
    }

    /// Requests the work anew once the values have stayed the same for a while.
    pub(super) fn follow(&mut self, ui: &Ui, running: Running<'_>, requests: &mut Vec<FileRequest>) {
        let wanted = self.wanted();
        let now = ui.input(|input| input.time);
        if wanted != self.wanted_shape {
            self.wanted_shape = wanted;
            self.changed_secs = now;
            self.work = Work::Idle;
            requests.push(FileRequest::StopJellifying);
        }
        if self.changed_secs.is_finite()
            && let Some(wanted_shape) = &self.wanted_shape
        {
            let rest = self.changed_secs + PAUSE_SECS - now;
            if rest <= 0.0 {
                self.changed_secs = f64::NEG_INFINITY;
                requests.push(FileRequest::Jellify(Box::new(self.work_for(wanted_shape.clone(), running))));
            } else {
                ui.ctx().request_repaint_after(std::time::Duration::from_secs_f64(rest));
            }
        }
    }

    fn work_for(&self, model: ModelShape, running: Running<'_>) -> Wanted {
        let wanted = Wanted::new(model, running.scene.settings.clone());
        match self.body(running) {
            None => wanted,
            Some(body) => Wanted {
                body: Some(Box::new(body.clone())),
                base_dir: running.status.base_dir.clone(),
                held: running.scene.models.clone(),
                ..wanted
            },
        }
    }

    /// The body whose model is filled again.
    pub(super) fn body<'a>(&self, running: Running<'a>) -> Option<&'a Body> {
        let ModelSource::Body(id) = self.source else { return None };
        running.scene.bodies.get(id.0)
    }

    /// Whether there is still a model: the body may be gone, or have another shape now.
    pub(super) fn is_sound(&self, running: Running<'_>) -> bool {
        let is_model = |body: &Body| matches!(&body.shape, Shape::Model(_));
        matches!(self.source, ModelSource::File(_)) || self.body(running).is_some_and(is_model)
    }
}
