//! What each command does, or which part of the sandbox does it.

use std::path::PathBuf;
use std::sync::Arc;

use super::collect::collect;
use super::costs::Costs;
use super::document::Opened;
use super::error::SPEED_RANGE;
use super::progress::Progress;
use super::stroke::Stroke;
use super::{Command, Session, SessionError};
use crate::physics::Arrival;
use crate::scene::Scene;

impl Session {
    /// As [`Session::handle`]; long work reports its progress, and is refused once nobody waits for it.
    pub fn handle_awaited(&mut self, command: Command, progress: &Arc<Progress>) -> Result<(), SessionError> {
        self.progress = Some(Arc::clone(progress));
        let outcome = self.handle(command);
        self.progress = None;
        outcome
    }

    /// Carries out a person's command; on an error nothing changes.
    pub fn handle(&mut self, command: Command) -> Result<(), SessionError> {
        match command {
            Command::Play => {
                self.too_slow_reason.clear();
                // A simulation that exploded cannot go on.
                if self.simulation.has_diverged() {
                    self.restart();
                }
                self.playing = true;
                self.clock.reset();
            }
            Command::Pause => {
                self.playing = false;
                self.clock.reset();
            }
            Command::StepOnce => {
                self.playing = false;
                self.clock.reset();
                self.step();
            }
            Command::Restart => self.restart(),
            Command::SetSpeed(speed) if (SPEED_RANGE[0]..=SPEED_RANGE[1]).contains(&speed) => {
                self.speed = speed;
                self.clock.reset();
            }
            Command::SetSpeed(speed) => return Err(SessionError::Speed { speed }),
            Command::Replace { .. } | Command::New | Command::Open { .. } | Command::Recover { .. } => {
                if let Some(opened) = Opened::by(command)? {
                    *self = Self::open(opened, &())?;
                }
            }
            Command::Save { camera } => self.document.save(&self.scene, camera, None)?,
            Command::SaveAs { path, camera, models } => {
                self.document.save(&self.scene, camera, Some((path, models)))?;
            }
            Command::Collect { folder, camera } => {
                let mut scene = Scene::clone(&self.scene);
                scene.view.camera = camera;
                collect(&scene, &self.document.base_dir, &self.document.title, &folder).map_err(Box::new)?;
            }
            Command::SaveState { path } => self.save_state(&path)?,
            Command::OpenState { path } => self.open_state(&path)?,
            Command::Edit(edit) => self.edit(edit, Arrival::Placed)?,
            Command::Drag(edit) => self.edit(edit, if self.playing { Arrival::Swept } else { Arrival::Placed })?,
            Command::Teleport(body, place) => self.teleport(body, place)?,
            Command::EndEdit => {
                self.history.close();
                self.stroke = Stroke::default();
            }
            Command::CancelEdit => self.cancel_edit()?,
            Command::AddBody { body, jelly } => self.add_body(body, *jelly)?,
            Command::AddMesh(obstacle) => self.add_mesh(*obstacle)?,
            Command::Refill { id, body, jelly } => self.refill(id, body, *jelly)?,
            Command::Undo => self.undo()?,
            Command::Redo => self.redo()?,
            Command::Grab(pull) => self.grab(pull)?,
            Command::Brush(touch) => self.brush(&touch)?,
            Command::WatchCost(watch) => self.costs = watch.then(|| Costs::new(&self.simulation)),
            Command::WatchStability(of) => self.watch_stability(of),
            Command::ShowModes(swing) => self.show_modes(swing)?,
            Command::MarkBox(marked) => self.marked_box = marked,
            Command::TakeModes(found) => self.receive_modes(*found),
        }
        Ok(())
    }
}

impl Opened {
    /// Returns the scene with which a command replaces the present one, if it does.
    ///
    /// # Errors
    /// If the file it names cannot be read.
    pub fn by(command: Command) -> Result<Option<Self>, SessionError> {
        Ok(Some(match command {
            Command::Replace { scene, base_dir, title } => Self::without_file(*scene, title, base_dir),
            Command::New => Self::blank(),
            Command::Open { path } => Self::from_file(&path)?,
            Command::Recover { scene, title, file, on_disk } => {
                Self { scene: *scene, title, base_dir: PathBuf::new(), file, unsaved: true, on_disk }
            }
            _ => return Ok(None),
        }))
    }
}
