//! Carrying out edits, taking them back and making them again: from an [`Impact`] to what the simulation, the skins and
//! the picture have to do about it.

use std::sync::Arc;

use glam::{DMat3, DVec3};

use super::cancellation::run_until_cancelled;
use super::history::{Change, Undone};
use super::words::{value_at, words};
use super::{Bodies, Session, SessionError};
use crate::geometry::Watch;
use crate::geometry::watch::Portion;
use crate::math::rotation;
use crate::physics::Simulation;
use crate::physics::{Arrival, BodyMotion};
use crate::scene::cell_brush::{middle_shift, own_cells};
use crate::scene::edit::{Applied, BodyId, Edit, EditError, Impact, ObstacleId, body_impact};
use crate::scene::param::Problem;
use crate::scene::resolve::{Jelly, load_meshes};
use crate::scene::{Body, MovesBy, Obstacle, ObstacleShape, Pose, Scene, Shape, named};

/// The progress of a change once its bodies are made, and once they are compiled for simulation.
const BODIES_MADE_PROGRESS: f64 = 0.4;
const COMPILED_PROGRESS: f64 = 0.9;

impl Session {
    /// Changes the scene and remembers how to take the change back. New names are made unique.
    pub(super) fn edit(&mut self, mut edit: Edit, arrival: Arrival) -> Result<(), SessionError> {
        self.scene.make_names_unique(&mut edit);
        let words = words(&self.scene, &edit);
        if words.is_empty() && edit.replaces_a_node_of(&self.scene) {
            return Ok(());
        }
        let change = self.make_change(edit, words, false, arrival)?;
        self.history.record(change);
        Ok(())
    }

    /// Adds a mesh that stands where a cube of its length would: how high it is is known once its file is read.
    pub(super) fn add_mesh(&mut self, obstacle: Obstacle) -> Result<(), SessionError> {
        let place = self.scene.obstacles.len();
        let mut scene = Scene::clone(&self.scene);
        scene.obstacles.push(obstacle);
        self.read_meshes(&mut scene)?;
        let mut obstacle = scene.obstacles.remove(place);
        if let ObstacleShape::Mesh(mesh) = &mut obstacle.shape {
            mesh.center[1] += mesh.half_extents().y - 0.5 * mesh.length;
        }
        self.edit(Edit::InsertObstacle(ObstacleId(place), Box::new(obstacle)), Arrival::Placed)
    }

    /// Reads the models of a scene's obstacles that have not been read; what another obstacle has read is shared.
    fn read_meshes(&self, scene: &mut Scene) -> Result<(), SessionError> {
        let is_read = |mesh: &ObstacleShape| !matches!(mesh, ObstacleShape::Mesh(mesh) if mesh.surface().is_none());
        if scene.obstacles.iter().all(|obstacle| is_read(&obstacle.shape)) {
            return Ok(());
        }
        let watch: &dyn Watch = self.progress.as_ref().map_or(&(), |progress| &**progress);
        let read = load_meshes(scene, self.shape_cache.base_dir(), watch);
        if watch.cancelled() {
            return Err(SessionError::ChangeStopped);
        }
        Ok(read?)
    }

    /// Puts the middle of a body somewhere.
    pub(super) fn teleport(&mut self, id: BodyId, place: [f64; 3]) -> Result<(), SessionError> {
        let count = self.scene.bodies.len();
        let mut body = self.scene.bodies.get(id.0).cloned().ok_or(EditError::NoSuchBody { id, count })?;
        let words = format!("teleport {}", named(&body.name, "body", id.0));
        body.pose.position = place;
        let change = self.make_change(Edit::Body(id, Box::new(body)), words, true, Arrival::Placed)?;
        self.history.record(change);
        self.history.close();
        Ok(())
    }

    /// Adds a body whose shape is ready.
    pub(super) fn add_body(&mut self, body: Box<Body>, jelly: Jelly) -> Result<(), SessionError> {
        self.history.close();
        self.shape_cache.insert(body.shape.clone(), jelly);
        self.edit(Edit::InsertBody(BodyId(self.scene.bodies.len()), body), Arrival::Placed)?;
        self.history.close();
        Ok(())
    }

    /// Gives a body another shape that was made ready elsewhere.
    pub(super) fn refill(&mut self, id: BodyId, body: Box<Body>, jelly: Jelly) -> Result<(), SessionError> {
        self.history.close();
        self.shape_cache.insert(body.shape.clone(), jelly);
        self.edit(Edit::Body(id, body), Arrival::Placed)?;
        self.history.close();
        Ok(())
    }

    /// Takes back the open change, as if it had never been made.
    pub(super) fn cancel_edit(&mut self) -> Result<(), SessionError> {
        if self.history.is_open() {
            self.undo()?;
            self.history.forget_cancelled();
        }
        Ok(())
    }

    /// Takes the last change back, with the motion of the body it moved or removed.
    pub(super) fn undo(&mut self) -> Result<(), SessionError> {
        let Some(change) = self.history.pop_done() else { return Ok(()) };
        match self.apply_edit(change.inverse.clone(), Arrival::Placed) {
            Ok(applied) => {
                if let Some((body, motion)) = &change.motion {
                    self.simulation.set_body_motion(*body, motion);
                    self.picture.invalidate();
                }
                let Change { words, teleport, .. } = change;
                self.history.push_undone(Undone { edit: applied.inverse, words, teleport });
                Ok(())
            }
            Err(error) => {
                self.history.push(change);
                Err(error)
            }
        }
    }

    /// Makes the change again that was taken back last.
    pub(super) fn redo(&mut self) -> Result<(), SessionError> {
        let Some(Undone { edit, words, teleport }) = self.history.pop_undone() else { return Ok(()) };
        match self.make_change(edit.clone(), words.clone(), teleport, Arrival::Placed) {
            Ok(change) => {
                self.history.push(change);
                Ok(())
            }
            Err(error) => {
                self.history.push_undone(Undone { edit, words, teleport });
                Err(error)
            }
        }
    }

    /// Carries an edit out, and tells how to take it back.
    pub(super) fn make_change(
        &mut self,
        edit: Edit,
        words: String,
        teleport: bool,
        arrival: Arrival,
    ) -> Result<Change, SessionError> {
        let edit = self.pinned_where_it_is(edit);
        let motion = if teleport || self.may_move_body(&edit) { self.motion_before(&edit) } else { None };
        let Applied { inverse, impact } = self.apply_edit(edit, arrival)?;
        if let Some((body, _)) = motion.as_ref().filter(|_| teleport && impact < Impact::Motion) {
            let rotation_deg = self.scene.bodies[*body].pose.rotation_deg;
            self.simulation.teleport_body(*body, rotation_deg, rotation_deg);
            self.picture.invalidate();
        }
        Ok(Change { inverse, words, motion: motion.filter(|_| teleport || impact >= Impact::Motion), teleport })
    }

    /// Lets an edit that first pins a body moving by its modes pin it where it is now: the modes of a pinned body are about
    /// its start.
    fn pinned_where_it_is(&self, edit: Edit) -> Edit {
        let Edit::Body(id, mut new) = edit else { return edit };
        let old = self.scene.bodies.get(id.0).filter(|_| !self.simulation.is_at_start());
        if old.is_some_and(|old| pins_free_modal_body(old, &new) && old.pose == new.pose) {
            new.pose = self.current_pose(id.0).unwrap_or(new.pose);
        }
        Edit::Body(id, new)
    }

    /// Returns the pose of a free body that moves by its modes as it is now, without its swing.
    fn current_pose(&self, body: usize) -> Option<Pose> {
        let inertia = self.simulation.model().bodies[body].inertia()?;
        let rigid = self.simulation.state().modal[body].rigid?;
        let position = rigid.center - rigid.turn * inertia.center;
        let rotation_deg = rotation::to_euler_deg(&DMat3::from_quat(rigid.turn));
        Some(Pose { position: position.to_array(), rotation_deg })
    }

    /// Whether an edit may move, reshape or remove a body: a constant that changes needs no copy of its motion.
    fn may_move_body(&self, edit: &Edit) -> bool {
        let Edit::Body(id, new) = edit else { return true };
        let Some(old) = self.scene.bodies.get(id.0) else { return true };
        body_impact(old, new) >= Impact::Motion
    }

    fn motion_before(&self, edit: &Edit) -> Option<(usize, BodyMotion<f32>)> {
        match edit {
            Edit::Body(id, _) | Edit::RemoveBody(id) if id.0 < self.scene.bodies.len() => {
                Some((id.0, self.simulation.body_motion(id.0)))
            }
            _ => None,
        }
    }

    /// Changes the scene and everything that depends on it; on an error nothing changes.
    fn apply_edit(&mut self, edit: Edit, arrival: Arrival) -> Result<Applied, SessionError> {
        let old_body_indices = old_body_indices(&edit, self.scene.bodies.len());
        let old_obstacle_indices = old_obstacle_indices(&edit, self.scene.obstacles.len());
        let edited_body = if let Edit::Body(id, _) = &edit { Some(id.0) } else { None };
        let mut scene = Scene::clone(&self.scene);
        let applied = scene.apply(edit).map_err(|error| self.error_in_words(error))?;
        self.read_meshes(&mut scene)?;
        let scene = Arc::new(scene);
        match applied.impact {
            Impact::Topology => self.rebuild(&scene, &old_body_indices)?,
            Impact::Parameters | Impact::Motion => {
                if let Some(problem) = self.bodies.part_problem(&scene) {
                    return Err(self.error_in_words(EditError::BadValue(problem)));
                }
                self.simulation.set_parameters(&scene, &self.bodies.lattices(), &old_obstacle_indices, arrival);
            }
            Impact::Appearance => (),
        }
        if let Some(body) = edited_body {
            self.move_to_new_start(body, &scene);
        }
        self.bodies.update_skins(&scene);
        if applied.impact > Impact::Appearance {
            self.forget_trouble();
            self.step_errors.reset();
            self.picture.invalidate();
        }
        self.scene = scene;
        self.end_outdated_swing();
        self.update_modes();
        self.find_inversion();
        self.find_notice();
        self.update_body_analyses();
        Ok(applied)
    }

    /// Words why an edit is refused, without paths.
    fn error_in_words(&self, error: EditError) -> SessionError {
        match error {
            EditError::BadValue(Problem { path, message }) => {
                SessionError::Value { what: value_at(&self.scene, &path), message }
            }
            error => error.into(),
        }
    }

    /// Compiles the scene anew. Bodies whose shape stays keep their motion, and so do bodies whose model is filled with
    /// other cells or whose cells change within their grid.
    fn rebuild(&mut self, scene: &Arc<Scene>, kept: &[Option<usize>]) -> Result<(), SessionError> {
        let progress = self.progress.clone();
        let watch: &dyn Watch = progress.as_ref().map_or(&(), |progress| &**progress);
        let making = Portion::new(watch, [0.0, BODIES_MADE_PROGRESS]);
        let bodies = Bodies::resolve(scene, &mut self.shape_cache, &making).map_err(|error| match error {
            _ if watch.cancelled() => SessionError::ChangeStopped,
            SessionError::Part(problem) => self.error_in_words(EditError::BadValue(problem)),
            error => error,
        })?;
        let same_shape = |(new, old): (usize, &Option<usize>)| {
            old.filter(|&old| scene.bodies[new].shape == self.scene.bodies[old].shape)
        };
        let goes_on = !self.simulation.is_at_start();
        let refilled = |(new, old): (usize, &Option<usize>)| {
            let old = old.filter(|_| goes_on)?;
            Some((new, old, reshape_of(&self.scene.bodies[old], &scene.bodies[new])?))
        };
        let reshaped: Vec<_> = kept.iter().enumerate().filter_map(refilled).collect();
        let kept: Vec<_> = kept.iter().enumerate().map(same_shape).collect();
        watch.progress(BODIES_MADE_PROGRESS);
        let (compiled, lattices, modes) = (Arc::clone(scene), bodies.lattices(), self.known_modes(scene));
        let compile = move || Simulation::with_modes(&compiled, &lattices, &modes);
        let mut simulation = run_until_cancelled(watch, compile).ok_or(SessionError::ChangeStopped)?;
        watch.progress(COMPILED_PROGRESS);
        simulation.carry_over(&self.simulation, &kept);
        for (body, old, reshape) in reshaped {
            let (scale, shift) = match reshape {
                Reshape::Model => (bodies.model_length(body) / self.bodies.model_length(old), DVec3::ZERO),
                Reshape::Cells { shift } => (1.0, shift),
            };
            simulation.reshape_body(body, &self.simulation, old, scale, shift);
        }
        // A scene with more particles than before may be too slow to watch.
        let particles = |simulation: &Simulation<f32>| simulation.model().particle_count();
        self.may_be_too_slow |= particles(&simulation) > particles(&self.simulation);
        self.bodies = bodies.with_skins_of(&self.bodies);
        self.simulation = simulation;
        self.simulation.set_grab(None);
        Ok(())
    }

    /// Moves a body whose start was changed.
    fn move_to_new_start(&mut self, body: usize, scene: &Scene) {
        let (old, new) = (&self.scene.bodies[body], &scene.bodies[body]);
        let moved = (old.pose, old.velocity) != (new.pose, new.velocity);
        if !moved || old.shape != new.shape {
            return;
        }
        if self.simulation.is_at_start() {
            self.simulation.restart_body(body);
        } else if pins_free_modal_body(old, new) {
            // `pinned_where_it_is` has already put its start where the body is.
        } else if old.pose == new.pose {
            self.simulation.throw_body(body);
        } else {
            self.simulation.teleport_body(body, old.pose.rotation_deg, new.pose.rotation_deg);
        }
    }
}

/// Whether an edit pins a body that moves by its modes and was free.
fn pins_free_modal_body(old: &Body, new: &Body) -> bool {
    let goes_on_by_modes = [old, new].iter().all(|body| body.moves_by == MovesBy::Modes);
    goes_on_by_modes && !old.has_pins() && new.has_pins()
}

/// How the cells of a body have changed, if those that stay keep their motion.
enum Reshape {
    /// The same model is filled or scaled in another way.
    Model,
    /// Cells were added or taken away in the same grid; the middle of the body moves by this much, m.
    Cells { shift: DVec3 },
}

fn reshape_of(old: &Body, new: &Body) -> Option<Reshape> {
    let same_start = (old.pose, old.velocity) == (new.pose, new.velocity);
    match (&old.shape, &new.shape) {
        (Shape::Model(of_old), Shape::Model(of_new)) => {
            let same_model = (&of_old.path, of_old.up) == (&of_new.path, of_new.up);
            (same_start && of_old != of_new && same_model).then_some(Reshape::Model)
        }
        (old_shape, new_shape) if old_shape != new_shape => {
            // The new start must keep the remaining cells where they were.
            let same_cells = |from: &Body, to: &Body| {
                let (list, _) = own_cells(&to.shape)?;
                let moved = from.with_cells(list)?;
                Some((moved.pose, moved.velocity) == (to.pose, to.velocity))
            };
            let is_same_grid = same_cells(old, new)? || same_cells(new, old)?;
            is_same_grid.then_some(Reshape::Cells { shift: middle_shift(old_shape, new_shape)? })
        }
        _ => None,
    }
}

/// For every body after an edit, its place in the scene before it, if it was there.
fn old_body_indices(edit: &Edit, before: usize) -> Vec<Option<usize>> {
    match edit {
        Edit::InsertBody(id, _) => indices_after_insertion(id.0, before),
        Edit::RemoveBody(id) => indices_after_removal(id.0, before),
        _ => (0..before).map(Some).collect(),
    }
}

/// For every obstacle after an edit, its place in the scene before it, if it was there.
fn old_obstacle_indices(edit: &Edit, before: usize) -> Vec<Option<usize>> {
    match edit {
        Edit::InsertObstacle(id, _) => indices_after_insertion(id.0, before),
        Edit::RemoveObstacle(id) => indices_after_removal(id.0, before),
        _ => (0..before).map(Some).collect(),
    }
}

fn indices_after_insertion(place: usize, before: usize) -> Vec<Option<usize>> {
    let mut kept: Vec<_> = (0..before).map(Some).collect();
    if place <= before {
        kept.insert(place, None);
    }
    kept
}

fn indices_after_removal(place: usize, before: usize) -> Vec<Option<usize>> {
    (0..before).filter(|&old| old != place).map(Some).collect()
}
