//! A brush over the cells of a body: which cell a hand touches, and the edit that puts one there or takes it away.

use glam::DVec3;

use super::stroke::Stroke;
use super::{CellTouch, Session, SessionError};
use crate::math::Vector;
use crate::physics::Arrival;
use crate::scene::cell_brush::{CellChange, cell_in_grid, face_at, lowest_cell, middle, own_cells};
use crate::scene::edit::{BodyId, Edit, EditError};
use crate::scene::{Body, Shape, named};

impl Session {
    /// Changes the cell that is touched.
    pub(super) fn brush(&mut self, touch: &CellTouch) -> Result<(), SessionError> {
        let id = touch.body;
        let count = self.scene.bodies.len();
        let body = self.scene.bodies.get(id.0).ok_or(EditError::NoSuchBody { id, count })?;
        let name = || named(&body.name, "body", id.0);
        let point = self.rest_position_of_touch(touch)?;
        let (mut list, at) = self.grid_cells_and_point(id, &body.shape, point);
        let Some((touched, beyond)) = face_at(&list, at) else { return Ok(()) };
        if self.stroke.body != Some(id) {
            self.stroke = Stroke { body: Some(id), changed: Vec::new() };
        }
        let (changed, adds) = match touch.change {
            CellChange::Attach => (beyond, true),
            CellChange::Erase => (touched, false),
            CellChange::Paint(inlay) | CellChange::Scrape(inlay) => {
                let adds = touch.change == CellChange::Paint(inlay);
                let new = body.with_painted(touched, inlay, adds);
                return self.replace_touched_body(id, new, format!("inlays of {}", name()));
            }
            CellChange::Pin | CellChange::Release => {
                let new = body.with_pinned(touched, touch.change == CellChange::Pin);
                return self.replace_touched_body(id, new, format!("pins of {}", name()));
            }
        };
        // A stroke neither builds on a cell that it has added nor digs on where it has taken one away.
        let other = if adds { touched } else { beyond };
        if self.stroke.changed.contains(&other) {
            return Ok(());
        }
        if adds {
            list.push(changed);
        } else {
            list.retain(|cell| *cell != changed);
        }
        if list.is_empty() {
            return Err(SessionError::LastCell { name: name() });
        }
        let new = if let Shape::Model(model) = &body.shape {
            Some(Body { shape: Shape::Model(model.with_cell(changed, adds)), ..body.clone() })
        } else {
            body.with_cells(list)
        };
        // A cell that is taken away holds no particles any more.
        let new = new.map(|new| if adds { new } else { new.with_pinned(changed, false).unwrap_or(new) });
        // The first cell turns a cube into a list. Equal words join all cells of a stroke into one change.
        let words = format!("cells of {}", name());
        self.replace_touched_body(id, new, words)?;
        self.stroke.changed.push(changed);
        Ok(())
    }

    /// Replaces a body by what a touch makes of it; does nothing where a touch changes nothing.
    fn replace_touched_body(&mut self, id: BodyId, new: Option<Body>, words: String) -> Result<(), SessionError> {
        let Some(new) = new else { return Ok(()) };
        let change = self.make_change(Edit::Body(id, Box::new(new)), words, false, Arrival::Placed)?;
        self.history.record(change);
        Ok(())
    }

    /// Returns the cells of a body in the grid in which a brush changes them, and a point of the body (given in its own
    /// coordinates, m) in that grid.
    fn grid_cells_and_point(&self, id: BodyId, shape: &Shape, point: DVec3) -> (Vec<[i32; 3]>, DVec3) {
        if let Some((list, size)) = own_cells(shape) {
            let at = middle(&list) + point / size;
            return (list, at);
        }
        let lattice = &self.simulation.model().bodies[id.0].lattice;
        let low = lowest_cell(shape);
        let cells = (0..).zip(&lattice.cells).map(|(cell, _)| cell_in_grid(low, lattice.low(cell)));
        let list = cells.collect();
        let from_low = (point - lattice.grid.origin) / lattice.grid.cell_size;
        (list, from_low + DVec3::from_array(low.map(f64::from)))
    }

    /// Returns the rest position of the touched point in the body's coordinates, m.
    fn rest_position_of_touch(&self, touch: &CellTouch) -> Result<DVec3, SessionError> {
        let body = self.simulation.model().bodies.get(touch.body.0).ok_or(SessionError::Pull)?;
        let mut at = DVec3::ZERO;
        for &(particle, weight) in &touch.weights {
            let particle = particle as usize;
            if !body.particles.contains(&particle) {
                return Err(SessionError::Pull);
            }
            at += body.lattice.rest_position(particle - body.particles.start) * f64::from(weight);
        }
        if Vector::is_finite(at) { Ok(at) } else { Err(SessionError::Pull) }
    }
}
