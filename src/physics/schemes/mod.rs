//! The schemes that advance positions and velocities by a substep (GC §4.1), one file each.
//!
//! A scheme is given the forces at the state and predicts the velocities at the end of the substep. Contact changes them,
//! once. Some schemes move particles with another velocity, or evaluate forces again on the way. They then go through the
//! substep once more, with the change by contact as a constant force. RK2 and RK4 meet obstacles so only where these were not
//! foreseen: they leave substeps near them and near other bodies, and those in which a hand pulls, to semi-implicit Euler, of
//! second order too where its velocities are half a substep behind ([`Scheme::leaves_contact`]). A scheme never writes to the state,
//! except for what it must remember once a substep is accepted, and knows nothing of obstacles.
//!
//! ```text
//! semi-implicit Euler   v' = v + dt a(x, v)                  x' = x + dt v'
//! explicit Euler        v' = v + dt a(x, v)                  x' = x + dt v
//! Verlet                v' = v + dt a(x, v + dt/2 a before)  x' = x + dt v'     v half a step behind x
//! RK2 (midpoint), RK4   forces at 1 and 3 more places between
//! stabilised            forces at as many more places as damping asks for, stable along the negative axis
//! implicit Euler        v' = v + dt a(x', v'), linearised       x' = x + dt v'
//! ```

pub(in crate::physics) mod chebyshev;
mod held;
pub(in crate::physics) mod implicit;
mod rk2;
mod rk4;
mod stabilised;
mod stepper;
mod verlet;

pub(super) use held::{ContactSpring, HeldFriction, HeldParticle, SurfaceContact};
pub(super) use implicit::bytes as implicit_bytes;
pub(super) use stepper::{SchemeWorkspace, Stepper, kick_secs, moves_by_mean, starts_on_time};

use stepper::kick;

use super::contact::ContactWorkspace;
use super::model::Model;
use super::report::Recorder;
use super::state::State;
use super::step::substep::Substep;
use crate::math::Real;
use crate::physics::model::Scheme;
use crate::physics::model::plan::Plan;

impl<R: Real> Stepper<'_, R> {
    /// Writes the velocities that the forces at the state predict for the end of the substep.
    pub(super) fn predict(&mut self, velocity: &mut [R::Vec3]) {
        if self.substep.scheme == Scheme::Stabilised {
            stabilised::predict(self, velocity);
            return;
        }
        let Substep { model, plan, state, .. } = self.substep;
        velocity.copy_from_slice(&state.velocity);
        kick(model, plan.simd, &state.bodies, kick_secs(self.substep), self.force, velocity);
        if moves_by_mean(self.substep.scheme) {
            self.workspace.predicted.copy_from_slice(velocity);
        }
    }

    /// Writes the velocities of particles in free fall, as if they had no links.
    pub(super) fn fall(&self, velocity: &mut [R::Vec3]) {
        velocity.copy_from_slice(&self.substep.state.velocity);
        for body in &self.substep.model.bodies {
            for (local, particle) in body.particles.clone().enumerate() {
                if !body.is_pinned(local) {
                    velocity[particle] += self.substep.model.gravity * self.substep.dt;
                }
            }
        }
    }

    /// Writes the velocities at the end of the substep from the implicit scheme's equations, contact and the hand's pull
    /// included; gives up if asked to stop.
    pub(super) fn solve(
        &mut self,
        contact: &mut ContactWorkspace<R>,
        velocity: &mut [R::Vec3],
        recorder: &mut Recorder<'_>,
    ) {
        implicit::solve(self, contact, velocity, recorder);
    }

    /// Goes through the substep once more for schemes that move particles with another velocity than that at its end: writes
    /// both velocities. The change of the predicted velocities acts as a constant force. Explicit Euler moves particles that
    /// contact changed by the velocity it left them.
    pub(super) fn refine(&mut self, velocity: &mut [R::Vec3], recorder: &mut Recorder<'_>) {
        match self.substep.scheme {
            Scheme::Explicit => self.write_explicit_paths(velocity),
            Scheme::Rk2 | Scheme::Rk4 => {
                self.workspace.after_contact.copy_from_slice(velocity);
                if self.substep.scheme == Scheme::Rk2 {
                    rk2::refine(self, velocity, recorder);
                } else {
                    rk4::refine(self, velocity, recorder);
                }
            }
            Scheme::Stabilised => stabilised::refine(self, velocity, recorder),
            Scheme::SemiImplicit | Scheme::Verlet | Scheme::Implicit => {}
        }
    }

    /// Writes the velocities that move particles in explicit Euler.
    fn write_explicit_paths(&mut self, velocity: &[R::Vec3]) {
        let SchemeWorkspace { mean_velocity: Some(mean_velocity), predicted, .. } = self.workspace else { return };
        let both = velocity.iter().zip(&*predicted).zip(&self.substep.state.velocity);
        for (mean, ((after, predicted), before)) in mean_velocity.iter_mut().zip(both) {
            *mean = if after == predicted { *before } else { *after };
        }
    }
}

/// Whether the state's velocity belongs to the same time as its position.
pub(super) fn is_velocity_synchronised<R: Real>(plan: &Plan, state: &State<R>) -> bool {
    match plan.scheme {
        Scheme::SemiImplicit => false,
        Scheme::Verlet | Scheme::Rk2 | Scheme::Rk4 => state.velocity_lag_secs <= 0.0,
        Scheme::Explicit | Scheme::Stabilised | Scheme::Implicit => true,
    }
}

/// Brings velocities up to the time of the positions, by the forces at the state.
pub(super) fn synchronise<R: Real>(model: &Model<R>, plan: &Plan, force: &[R::Vec3], state: &mut State<R>) {
    let lag = R::from_f64(std::mem::take(&mut state.velocity_lag_secs));
    kick(model, plan.simd, &state.bodies, lag, force, &mut state.velocity);
}

/// Returns the share of the coming substep's change of velocity that is past at the position's time.
pub(super) fn share_to_center<R: Real>(state: &State<R>, ahead: &State<R>) -> f64 {
    let [before, after] = [state.velocity_lag_secs, ahead.velocity_lag_secs];
    // Velocities that do not stay behind are those at the end.
    let after = if after > 0.0 { after } else { ahead.time_secs - state.time_secs };
    if before > 0.0 && after > 0.0 { before / (before + after) } else { 0.5 }
}

/// Returns the velocities with which the damping at the state is evaluated.
pub(super) fn damping_velocity<'a, R: Real>(
    scheme: Scheme,
    state: &'a State<R>,
    workspace: &'a mut SchemeWorkspace<R>,
) -> &'a [R::Vec3] {
    match scheme {
        Scheme::Verlet => verlet::predicted_velocity(state, &mut workspace.velocity),
        _ => &state.velocity,
    }
}

/// Whether what the next substep needs of an accepted one are its forces.
pub(super) fn remembers_forces(plan: &Plan) -> bool {
    plan.scheme == Scheme::Verlet
}

/// Remembers what the next substep needs of an accepted one, which a scheme took that need not be the plan's.
pub(super) fn remember<R: Real>(
    model: &Model<R>,
    (plan, scheme): (&Plan, Scheme),
    dt: R,
    force: &[R::Vec3],
    thesis_force: Option<&[R::Vec3]>,
    state: &mut State<R>,
) {
    match plan.scheme {
        Scheme::Verlet => verlet::remember(model, dt, force, thesis_force, state),
        // The next kick is longer or shorter where the substeps change.
        Scheme::SemiImplicit => state.velocity_lag_secs = 0.5 * dt.to_f64(),
        other if starts_on_time(other) && scheme == Scheme::SemiImplicit => {
            state.velocity_lag_secs = 0.5 * dt.to_f64();
        }
        _ => {}
    }
}
