//! What the assistant that makes a model into jelly remembers, and when it asks for the work anew.

use std::path::Path;
use std::sync::Arc;

use egui::Ui;

use super::path_field::{PathField, PathUse, Verdict};
use super::wish::Wish;
use crate::scene::Settings;
use crate::scene::body::ModelShape;
use crate::session::jellify::Jellified;
use crate::session::progress::Progress;

/// How long a value must stand before the work begins, s.
const PAUSE_SECS: f64 = 0.3;

/// The assistant.
#[derive(Debug)]
pub(super) struct LoadModel {
    pub(super) field: PathField,
    pub(super) shape: ModelShape,
    /// What was last asked for, and since when it has been waited for, s.
    pub(super) asked: Option<ModelShape>,
    changed_secs: f64,
    pub(super) work: Work,
}

/// How far the work is.
#[derive(Debug, Default)]
pub enum Work {
    /// There is nothing to do.
    #[default]
    Idle,
    /// It goes on.
    Running(Arc<Progress>),
    /// The body is ready.
    Ready(Box<Jellified>),
    /// It cannot be made; why, as a sentence.
    Failed(String),
}

impl LoadModel {
    /// An assistant that starts from a path.
    pub(super) fn new(start: &Path) -> Self {
        let field = PathField::new(PathUse::OpenModel, start);
        let shape = ModelShape::for_new();
        Self { field, shape, asked: None, changed_secs: f64::NEG_INFINITY, work: Work::Idle }
    }

    /// Puts another path into the field.
    pub(super) fn set(&mut self, path: &Path) {
        self.field.set(path);
    }

    /// The work has begun, ended or failed.
    pub(super) fn set_work(&mut self, work: Work) {
        self.work = work;
    }

    /// The shape that the values stand for, once the path leads to a file.
    fn wanted(&mut self) -> Option<ModelShape> {
        let Verdict::Usable(path, _) = self.field.verdict() else { return None };
        let path = std::path::absolute(path).ok()?;
        Some(ModelShape { path: path.to_str()?.to_owned(), ..self.shape.clone() })
    }

    /// Starts the work anew once the values have stood for a while.
    pub(super) fn follow(&mut self, ui: &Ui, settings: &Settings, wishes: &mut Vec<Wish>) {
        let wanted = self.wanted();
        let now = ui.input(|input| input.time);
        if wanted != self.asked {
            self.asked = wanted;
            self.changed_secs = now;
            self.work = Work::Idle;
            wishes.push(Wish::StopJellifying);
        }
        if self.changed_secs.is_finite() && self.asked.is_some() {
            let rest = self.changed_secs + PAUSE_SECS - now;
            if rest <= 0.0 {
                self.changed_secs = f64::NEG_INFINITY;
                wishes
                    .extend(self.asked.clone().map(|shape| Wish::Jellify(Box::new(shape), Box::new(settings.clone()))));
            } else {
                ui.ctx().request_repaint_after(std::time::Duration::from_secs_f64(rest));
            }
        }
    }
}
