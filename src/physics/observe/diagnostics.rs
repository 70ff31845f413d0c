//! What a simulation looks like in numbers: energies, momentum, extremes, broken cells. Computed when asked, in
//! double precision, never inside a step.

use std::borrow::Cow;
use std::ops::Range;

use glam::DVec3;

use crate::math::{Aabb, Real, Vector};
use crate::physics::contact::bodies::pair_law;
use crate::physics::contact::{ContactRecord, Placed};
use crate::physics::forces::recovery;
use crate::physics::model::Scheme;
use crate::physics::model::plan::Plan;
use crate::physics::model::{BodyModel, Model};
use crate::physics::report::Recorder;
use crate::physics::schemes;
use crate::physics::state::{BodyMemory, State};
use crate::physics::step::precision::substep;
use crate::physics::step::substep::Part;
use crate::physics::step::{Ending, Inputs, StepWorkspace};
use crate::physics::stepping;

/// A share of a substep so small that nothing moves in it.
const INSTANT_SHARE: f64 = 1e-6;

/// The state of a simulation in numbers, SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostics {
    /// Energies.
    pub energy: Energy,
    /// The excess of the kinetic energy over `½ m v₋·v₊`, the product of the velocities half a step before and after, J;
    /// zero where velocities are those of the positions' time. A leapfrog scheme keeps the energy without this excess,
    /// exactly where a body vibrates by little (Hairer, Lubich and Wanner, "Geometric Numerical Integration", 2006, I.5).
    pub half_step: f64,
    /// Mass of all bodies, kg.
    pub mass_kg: f64,
    /// Total momentum, kg·m/s.
    pub momentum: DVec3,
    /// Centre of mass, m.
    pub center: DVec3,
    /// The box around all particles of bodies that have not fallen out of the scene, m.
    pub bounds: Aabb<f64>,
    /// Fastest particle, m/s.
    pub max_speed: f64,
    /// Largest magnitude of a link's strain.
    pub max_strain: f64,
    /// Cells turned inside out: mean-edge signed volume not above zero.
    pub inverted_cells: usize,
    /// Whether all positions and velocities, the times and the energy are finite.
    pub finite: bool,
}

/// Energies of a state, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// Of motion, with the velocity centred on the position's time.
    pub kinetic: f64,
    /// Of the links.
    pub elastic: f64,
    /// Of height, zero at the world's origin.
    pub gravity: f64,
    /// Of the penalty springs of contact.
    pub contact: f64,
    /// Of the recovery from inversion.
    pub recovery: f64,
}

impl Energy {
    /// The sum.
    pub fn total(&self) -> f64 {
        self.kinetic + self.elastic + self.gravity + self.contact + self.recovery
    }
}

impl Diagnostics {
    /// Computes the diagnostics of a state.
    pub fn of<R: Real>(model: &Model<R>, plan: &Plan, state: &State<R>) -> Self {
        NextSubstep::of(model, plan, state).diagnostics(0..model.bodies.len())
    }

    /// Computes those of one body in a state.
    pub fn of_body<R: Real>(model: &Model<R>, plan: &Plan, state: &State<R>, body: usize) -> Self {
        NextSubstep::of(model, plan, state).diagnostics(body..body + 1)
    }

    /// Computes those of every body in a state, for little more than those of one; and the pairs of bodies that push each
    /// other in the coming substep, as a part of that push is in the velocities at the state's time.
    pub(in crate::physics) fn of_each<R: Real>(
        model: &Model<R>,
        plan: &Plan,
        state: &State<R>,
    ) -> (Vec<Self>, Vec<[usize; 2]>) {
        let next_substep = NextSubstep::of(model, plan, state);
        let of_each = (0..model.bodies.len()).map(|body| next_substep.diagnostics(body..body + 1)).collect();
        (of_each, if next_substep.is_velocity_synchronised { Vec::new() } else { next_substep.pushed_pairs })
    }

    fn add_links<R: Real>(&mut self, body: &BodyModel<R>, state: &State<R>) {
        let position = &state.position[body.particles.clone()];
        for family in &body.links {
            for (number, link) in family.links.iter().enumerate() {
                let [i, j] = link.ends.map(|end| position[end as usize].to_dvec3());
                let rest = link.rest_length.to_f64();
                let strain = (j - i).length() / rest - 1.0;
                self.energy.elastic += 0.5 * family.constants(number)[0].to_f64() * rest * strain * strain;
                self.max_strain = self.max_strain.max(strain.abs());
            }
        }
    }
}

/// A state and the substep after it. Where velocities are half a step behind positions, the velocity on time is the mean of
/// the present and the next one; contacts are found on the way.
struct NextSubstep<'a, R: Real> {
    model: &'a Model<R>,
    state: &'a State<R>,
    next: State<R>,
    contacts: Vec<ContactRecord<R>>,
    /// Pairs of bodies that push each other on the way.
    pushed_pairs: Vec<[usize; 2]>,
    /// Whether the velocities of the state are those at its time.
    is_velocity_synchronised: bool,
    /// The share of the change of velocity in the substep that is made by the state's time.
    share: f64,
}

impl<'a, R: Real> NextSubstep<'a, R> {
    fn of(model: &'a Model<R>, plan: &'a Plan, state: &'a State<R>) -> Self {
        // To find the next velocity, the substep, or the part of it that comes next, is taken on a copy.
        let mut next = state.clone();
        // A sleeping body's contacts are found, too.
        next.bodies.iter_mut().for_each(BodyMemory::wake);
        let mut workspace = StepWorkspace::new(model, plan);
        let coming = stepping::first_part(model, plan, &mut next, &mut workspace);
        // Near contact another scheme may take the parts, whose velocities are half a step behind.
        let stays_on_time = coming.scheme != Scheme::SemiImplicit || schemes::starts_on_time(plan.scheme);
        let is_velocity_synchronised = schemes::is_velocity_synchronised(plan, state) && stays_on_time;
        let (observed_plan, part) = if is_velocity_synchronised {
            // Only contacts are needed: any scheme finds them, so the cheapest is taken.
            let whole = Part::whole_substep(plan);
            let observed_plan = Plan { scheme: Scheme::SemiImplicit, halvings: 0, ..plan.clone() };
            workspace = StepWorkspace::new(model, &observed_plan);
            (
                Cow::Owned(observed_plan),
                Part { secs: whole.secs * INSTANT_SHARE, scheme: Scheme::SemiImplicit, ..whole },
            )
        } else {
            (Cow::Borrowed(plan), coming)
        };
        // In an instant rounding error would be most of how far they move.
        let obstacles = Placed::within(model, state, if is_velocity_synchronised { 0.0 } else { part.secs });
        let inputs = Inputs { obstacles: &obstacles, grab: None, modal_grab: None };
        let timer = &mut ();
        let ending = substep(model, &observed_plan, part, inputs, &mut next, &mut workspace, &mut Recorder::new(timer));
        let share = schemes::share_to_center(state, &next);
        let is_velocity_synchronised = is_velocity_synchronised || ending == Ending::Diverged;
        let (contacts, pushed_pairs) = (workspace.contact.contacts, workspace.contact.bodies.pushed_pairs);
        Self { model, state, next, contacts, pushed_pairs, is_velocity_synchronised, share }
    }

    fn centred_velocity(&self, particle: usize, asleep: bool) -> DVec3 {
        let now = self.state.velocity[particle].to_dvec3();
        if asleep || self.is_velocity_synchronised {
            now
        } else {
            now + self.share * (self.next.velocity[particle].to_dvec3() - now)
        }
    }

    /// [`Diagnostics::half_step`] of a particle, per kg.
    fn half_step(&self, particle: usize, asleep: bool) -> f64 {
        if asleep || self.is_velocity_synchronised {
            return 0.0;
        }
        let change = (self.next.velocity[particle] - self.state.velocity[particle]).to_dvec3();
        0.5 * self.share * (1.0 - self.share) * change.length_squared()
    }

    fn diagnostics(&self, bodies: Range<usize>) -> Diagnostics {
        let Self { model, state, ref contacts, .. } = *self;
        let mut sum = Diagnostics {
            energy: Energy::default(),
            half_step: 0.0,
            mass_kg: 0.0,
            momentum: DVec3::ZERO,
            center: DVec3::ZERO,
            bounds: Aabb::empty(),
            max_speed: 0.0,
            max_strain: 0.0,
            inverted_cells: 0,
            finite: [&state.position, &state.position_residual, &state.velocity]
                .into_iter()
                .chain(&state.acceleration)
                .flatten()
                .all(|v| v.is_finite())
                && state.time_secs.is_finite()
                && state.velocity_lag_secs.is_finite(),
        };
        let gravity = model.gravity.to_dvec3();
        for (body, memory) in model.bodies[bodies.clone()].iter().zip(&state.bodies[bodies.clone()]) {
            for (local, particle) in body.particles.clone().enumerate() {
                let mass = body.mass(local).to_f64();
                // The rounding error kept beside a position is part of it.
                let position = state.position[particle].to_dvec3() + state.position_residual[particle].to_dvec3();
                let velocity = self.centred_velocity(particle, memory.asleep);
                sum.mass_kg += mass;
                sum.energy.kinetic += 0.5 * mass * velocity.length_squared();
                sum.half_step += mass * self.half_step(particle, memory.asleep);
                sum.energy.gravity -= mass * gravity.dot(position);
                sum.momentum += mass * state.velocity[particle].to_dvec3();
                sum.center += mass * position;
                if !memory.gone {
                    sum.bounds = sum.bounds.include(position);
                }
                sum.max_speed = sum.max_speed.max(state.velocity[particle].to_dvec3().length());
            }
            sum.add_links(body, state);
            sum.energy.recovery += recovery::energy(body, memory, state);
            sum.inverted_cells += recovery::inverted_cells(body, &state.position[body.particles.clone()]);
        }
        if sum.mass_kg > 0.0 {
            sum.center /= sum.mass_kg;
        }
        for contact in contacts.iter().filter(|contact| contact.gap < R::ZERO) {
            let Some(body) =
                model.bodies[bodies.clone()].iter().find(|body| body.particles.contains(&contact.particle))
            else {
                continue;
            };
            sum.energy.contact += body.contacts[contact.obstacle].to_f64().energy(-contact.gap.to_f64());
        }
        for press in &state.presses {
            // Counts for the body whose point is inside the other.
            if bodies.contains(&press.bodies[0]) {
                sum.energy.contact += pair_law(model, press.bodies).energy(press.depth_m);
            }
        }
        for touch in state.touches.iter().filter(|touch| bodies.contains(&touch.body)) {
            let contact = model.bodies[touch.body].contacts[touch.obstacle].to_f64();
            sum.energy.contact += contact.energy(touch.depth_m);
        }
        sum.finite &= sum.energy.total().is_finite() && sum.momentum.is_finite() && sum.center.is_finite();
        sum
    }
}
