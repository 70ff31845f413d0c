//! The motion of a modal body over a substep without impulses: by its modes and, where nothing holds it, by weight and spin.

use glam::{DMat3, DVec3};

use super::flight::{Flight, RIGID_MOTIONS};
use super::oscillator::Oscillator;
use crate::math::{Aabb, Real};
use crate::physics::model::{BodyModel, ModalBody};

/// Where modes are at the end of a substep.
#[derive(Clone, Copy)]
pub(super) struct ModesAtEnd<'a> {
    /// m √kg.
    pub(super) amplitude: &'a [f64],
    /// m √kg / s.
    pub(super) rate: &'a [f64],
}

/// A body over a substep. In the body's coordinates as the substep begins, unless stated otherwise.
#[derive(Clone, Copy)]
pub(super) struct Motion<'a, R: Real> {
    pub(super) body: &'a BodyModel<R>,
    /// Its place among the bodies.
    pub(super) number: usize,
    pub(super) modal: &'a ModalBody,
    /// Its modes over the substep, and the six motions of a free body after them.
    pub(super) oscillators: &'a [Oscillator],
    /// The amplitudes when it begins.
    pub(super) start_amplitude: &'a [f64],
    /// Where modes are at its end.
    pub(super) free: ModesAtEnd<'a>,
    /// The rigid motion of a free body.
    pub(super) flight: Option<&'a Flight<'a>>,
    /// From the body's coordinates to the scene's.
    pub(super) turn: DMat3,
    /// The origin of the body's coordinates in the scene, m.
    pub(super) origin: DVec3,
    /// The length of the substep, s.
    pub(super) secs: f64,
}

/// The motion of a point over a substep.
#[derive(Clone, Copy, Debug)]
pub(super) struct PointMotion {
    /// Where it begins, m.
    pub(super) start: DVec3,
    /// Its displacement, m.
    pub(super) displacement: DVec3,
    /// Its velocity at the end, m/s; of a free body, its mean velocity: with that at the end, weight would make a body at
    /// rest creep.
    pub(super) velocity: DVec3,
}

impl<R: Real> Motion<'_, R> {
    /// The number of modes and rigid motions.
    pub(super) fn count(&self) -> usize {
        self.oscillators.len()
    }

    /// The motion of a point that is at `rest` (m) in the body at rest. `row` holds its displacement by each mode; the rigid
    /// motions after them are filled in.
    pub(super) fn point_motion(&self, rest: DVec3, row: &mut [DVec3]) -> PointMotion {
        let start = rest + superpose(row, self.start_amplitude);
        let Some(flight) = self.flight else {
            let displacement = superpose(row, self.free.amplitude) - superpose(row, self.start_amplitude);
            return PointMotion { start, displacement, velocity: superpose(row, self.free.rate) };
        };
        let displacement = flight.end_position(rest + superpose(row, self.free.amplitude)) - start;
        let modes = row.len() - RIGID_MOTIONS;
        flight.inertia.row(start - flight.inertia.center, &mut row[modes..]);
        PointMotion { start, displacement, velocity: displacement / self.secs }
    }

    /// A box in the scene that holds all particles over the substep, m.
    pub(super) fn motion_bounds(&self) -> Aabb<f64> {
        let around = self.modal.bounds.grown(self.vibration_bound());
        let half = 0.5 * (around.max - around.min);
        let middle = self.in_scene(around.min + half);
        let turned =
            self.turn.x_axis.abs() * half.x + self.turn.y_axis.abs() * half.y + self.turn.z_axis.abs() * half.z;
        let carried = self.flight.map_or(0.0, |flight| flight.displacement_bound(around));
        Aabb { min: middle - turned, max: middle + turned }.grown(carried)
    }

    /// The mean velocity of the body as a whole, m/s.
    pub(super) fn drift(&self) -> DVec3 {
        self.flight.map_or(DVec3::ZERO, |flight| self.turn * flight.center_displacement() / self.secs)
    }

    /// A bound on the vibration of any particle about its place at rest, m.
    fn vibration_bound(&self) -> f64 {
        self.modal.displacement_bound(
            self.start_amplitude.iter().zip(self.free.amplitude).map(|(now, then)| now.abs().max(then.abs())),
        )
    }

    /// Writes where particles are in the scene when the substep begins and when it ends, m. This is so for all cells in
    /// which a point of this region may be; particles farther away are written as at rest.
    pub(super) fn predict_positions(&self, region: &Aabb<f64>, [now, predicted]: [&mut [DVec3]; 2]) {
        let modes = self.modal.modes.count();
        let (lattice, vibration) = (&self.body.lattice, self.vibration_bound());
        // No corner is farther than this from points in its cell, vibration and carrying included.
        let carried = self.flight.map_or(0.0, |flight| flight.displacement_bound(self.modal.bounds.grown(vibration)));
        let region = region.grown(3.0_f64.sqrt() * lattice.grid.cell_size + 4.0 * vibration + carried);
        for (particle, (now, predicted)) in now.iter_mut().zip(predicted).enumerate() {
            let rest = lattice.rest_position(particle);
            let at = self.in_scene(rest);
            (*now, *predicted) = (at, at);
            if !region.holds(at) {
                continue;
            }
            let ends = self.start_amplitude[..modes].iter().zip(self.free.amplitude);
            let row = self.modal.modes.row(particle).iter().zip(ends);
            let [begin, end] = row.fold([DVec3::ZERO; 2], |[begin, end], (way, (now, then))| {
                let way = DVec3::from(way.map(f64::from));
                [begin + way * *now, end + way * *then]
            });
            let end = self.flight.map_or(rest + end, |flight| flight.end_position(rest + end));
            (*now, *predicted) = (self.in_scene(rest + begin), self.in_scene(end));
        }
    }

    /// A place in the body's coordinates as one in the scene, m.
    pub(super) fn in_scene(&self, at: DVec3) -> DVec3 {
        self.origin + self.turn * at
    }

    /// Whether points of a box, which holds them at the beginning's and at the end's amplitudes, may come within these
    /// bounds in the scene, m.
    pub(super) fn reaches(&self, around: Aabb<f64>, [min, max]: [DVec3; 2]) -> bool {
        let Self { turn, origin, .. } = self;
        let half = 0.5 * (around.max - around.min);
        let middle = *origin + *turn * (around.min + half);
        let half = turn.x_axis.abs() * half.x + turn.y_axis.abs() * half.y + turn.z_axis.abs() * half.z;
        let carried = self.flight.map_or(0.0, |flight| flight.displacement_bound(around));
        let half = half + DVec3::splat(carried + ROUNDING_MARGIN * (self.body.size.to_f64() + middle.length()));
        ((middle - half).cmple(max) & (middle + half).cmpge(min)).all()
    }
}

/// Boxes are grown by this share of the body's size, for rounding errors.
pub(super) const ROUNDING_MARGIN: f64 = 1e-5;

/// The displacement of a point by these amplitudes, m.
pub(super) fn superpose(row: &[DVec3], amplitude: &[f64]) -> DVec3 {
    row.iter().zip(amplitude).fold(DVec3::ZERO, |sum, (way, q)| sum + *way * *q)
}
