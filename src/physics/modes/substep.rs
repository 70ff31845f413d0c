//! All modal bodies over a substep or a part of it, one after another.

use glam::DVec3;

use super::flight::{Flight, RIGID_MOTIONS};
use super::motion::{ModesAtEnd, Motion};
use super::oscillator::Oscillator;
use super::particles::is_resting;
use super::solver;
use super::workspace::{BodyWorkspace, ModalWorkspace};
use crate::math::{Real, Vector};
use crate::physics::contact::Placed;
use crate::physics::interaction::Grab;
use crate::physics::model::plan::{Plan, Stage};
use crate::physics::model::{BodyModel, ModalBody, Model};
use crate::physics::report::Recorder;
use crate::physics::state::sleep::{self, STILL_SECS};
use crate::physics::state::touch::SampleTouch;
use crate::physics::state::{ModalState, State, fallen};

/// A body is still that moves no faster than this, and that forces would not make faster within [`STILL_SECS`], body sizes a
/// second.
const MAX_STILL_SPEED: f64 = 1e-4;

/// A body whose points vibrate farther than so many of its sizes has exploded: single precision has no digits left for its
/// shape.
const MAX_VIBRATION_SIZES: f64 = 1e6;

/// What modal bodies did in a substep.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::physics) struct ModalReport {
    /// Contacts with obstacles that push.
    pub(in crate::physics) contacts: usize,
    /// The deepest point at the end, m.
    pub(in crate::physics) max_depth_m: f64,
    /// Whether all numbers are finite and no body has exploded.
    pub(in crate::physics) is_finite: bool,
}

/// The inputs of modal bodies in a substep or a part of one.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct Inputs<'a, R: Real> {
    pub(in crate::physics) model: &'a Model<R>,
    pub(in crate::physics) plan: &'a Plan,
    /// Where obstacles are in it.
    pub(in crate::physics) obstacles: &'a Placed<R>,
    /// A hand that pulls, at whatever body.
    pub(in crate::physics) grab: Option<&'a Grab<R>>,
    /// Its length, s.
    pub(in crate::physics) secs: f64,
}

impl<'a, R: Real> Inputs<'a, R> {
    /// The hand, where it pulls at this body.
    fn grab(&self, body: usize) -> Option<&'a Grab<R>> {
        self.grab.filter(|grab| grab.body == body)
    }

    /// Whether a body is a modal one that has to be moved.
    pub(super) fn moves(&self, body: usize, state: &State<R>) -> bool {
        let memory = &state.bodies[body];
        let is_left = !sleep::moves(self.model, self.plan, memory) && self.grab(body).is_none();
        memory.is_modal && !memory.gone && !is_left
    }

    /// The rigid motion of a free body over the substep, without impulses.
    pub(super) fn flight(&self, modal: &'a ModalBody, own: &ModalState) -> Option<Flight<'a>> {
        let (inertia, now) = (modal.rigid.as_ref()?, own.rigid?);
        Some(Flight::free(inertia, now, self.model.gravity.to_dvec3(), self.secs))
    }

    /// The motion of a body over the substep, without impulses.
    pub(super) fn motion<'b>(
        &self,
        (number, modal): (usize, &'b ModalBody),
        own: &'b ModalState,
        oscillators: &'b [Oscillator],
        free: &'b [Vec<f64>; 2],
        flight: Option<&'b Flight<'b>>,
    ) -> Motion<'b, R>
    where
        'a: 'b,
    {
        let (body, count) = (&self.model.bodies[number], modal.modes.count());
        let (turn, origin) = flight.map_or((modal.turn, modal.origin), Flight::frame);
        let (start_amplitude, free) =
            (&own.amplitude, ModesAtEnd { amplitude: &free[0][..count], rate: &free[1][..count] });
        Motion { body, number, modal, oscillators, start_amplitude, free, flight, turn, origin, secs: self.secs }
    }
}

/// Moves all modal bodies over a substep or a part of it; `is_last` says whether the substep ends with it. Bodies that met
/// others move by the impulses found then ([`super::body_contact`]). A body that `waits` for another does not come to
/// rest. Where a number would not be finite or a body has exploded, nothing of that body is changed.
pub(in crate::physics) fn advance<R: Real>(
    inputs: Inputs<'_, R>,
    is_last: bool,
    waits: impl Fn(&State<R>, usize) -> bool,
    state: &mut State<R>,
    workspace: &mut ModalWorkspace,
    recorder: &mut Recorder<'_>,
) -> ModalReport {
    let mut report = ModalReport { is_finite: true, ..ModalReport::default() };
    let Inputs { model, plan, secs, .. } = inputs;
    let min_still_substeps = sleep::min_still_substeps(plan);
    for (number, body) in model.bodies.iter().enumerate() {
        let Some(modal) = body.modal.as_ref().filter(|_| inputs.moves(number, state)) else { continue };
        begin(inputs, (number, modal), state, workspace, recorder);
        let ModalWorkspace { oscillators, body_workspaces, end, .. } = &mut *workspace;
        let BodyWorkspace { is_begun, free, change, contacts, hand, hand_pulls, is_changed_by_bodies } =
            &mut body_workspaces[number];
        *is_begun = false;
        let own = &state.modal[number];
        let flight = inputs.flight(modal, own);
        let motion = inputs.motion((number, modal), own, &oscillators[number], free, flight.as_ref());
        let change = &mut change[..motion.count()];
        let is_pushed = *hand_pulls || *is_changed_by_bodies || !contacts.is_empty();
        if is_pushed {
            recorder.enter(Stage::Contact);
            solver::solve(hand_pulls.then_some(hand), contacts, motion.oscillators, secs, change);
            report.contacts += contacts.pushing_count();
            report.max_depth_m = report.max_depth_m.max(contacts.max_depth(secs, change));
            contacts.count_work(recorder);
        }
        recorder.enter(Stage::Integrate);
        let end = with_impulses(motion.free, change, secs, end);
        let flight = flight
            .as_ref()
            .map(|flight| flight.with_impulses(*change.last_chunk().unwrap_or(&[0.0; RIGID_MOTIONS]), secs));
        if !is_sound(body, modal, end, flight.as_ref()) {
            report.is_finite = false;
            continue;
        }
        if let Some(flight) = &flight {
            contacts.forget_touches();
            if is_pushed {
                let motion = Motion { free: end, flight: Some(flight), ..motion };
                let touches = touches_of(&state.touches, number);
                contacts.find_spring_depths(&motion, change);
                contacts.find_touches(&motion, model, inputs.obstacles, touches, plan, recorder);
                recorder.enter(Stage::Integrate);
            }
            replace_touches(contacts.touches(), number, &mut state.touches);
        }
        let waits = waits(state, number);
        let own = &mut state.modal[number];
        let [speed, push] = store_end(own, modal, end, flight.as_ref(), secs);
        let memory = &mut state.bodies[number];
        let is_still =
            speed.max(push * STILL_SECS) <= MAX_STILL_SPEED * body.size.to_f64() && inputs.grab(number).is_none();
        let still_substeps = memory.still_substeps + u64::from(is_last);
        memory.still_substeps = match () {
            () if !(is_still && plan.sleeping) => 0,
            () if waits => still_substeps.min(min_still_substeps),
            () => still_substeps,
        };
        if is_resting(memory, min_still_substeps) && !sleep::moves(model, plan, memory) {
            own.rest();
            // Others meet it there from now on.
            modal.write_particles(body, own, [&mut state.position, &mut state.velocity]);
        }
        if let (true, Some(limit), Some(flight)) = (plan.sleeping, model.fall_limit, &flight) {
            let vibration: f64 =
                own.amplitude.iter().enumerate().map(|(mode, q)| q.abs() * modal.points.max_displacement(mode)).sum();
            if fallen::is_ball_past(limit, flight.end.center, flight.inertia.radius + vibration) {
                (memory.gone, memory.still_substeps) = (true, 0);
                own.stop();
            }
        }
    }
    report
}

/// Finds the motion of a body over a substep without impulses, its contacts with obstacles and the pull of a hand, unless
/// that is done already.
pub(super) fn begin<R: Real>(
    inputs: Inputs<'_, R>,
    (number, modal): (usize, &ModalBody),
    state: &State<R>,
    workspace: &mut ModalWorkspace,
    recorder: &mut Recorder<'_>,
) {
    let Inputs { model, plan, obstacles, secs, .. } = inputs;
    workspace.set_substep_secs(model, secs);
    let ModalWorkspace { oscillators, body_workspaces, .. } = workspace;
    let (oscillators, own) = (&oscillators[number], &state.modal[number]);
    let BodyWorkspace { is_begun, free, change, contacts, hand, hand_pulls, is_changed_by_bodies } =
        &mut body_workspaces[number];
    if *is_begun {
        return;
    }
    recorder.enter(Stage::Integrate);
    recorder.counters.modal_work += modal.modes.count() as u64;
    advance_modes(modal, own, model.gravity.to_dvec3(), oscillators, free);
    let flight = inputs.flight(modal, own);
    let motion = inputs.motion((number, modal), own, oscillators, free, flight.as_ref());
    change.fill(0.0);
    contacts.find(&motion, model, obstacles, touches_of(&state.touches, number), plan, recorder);
    *hand_pulls = inputs.grab(number).is_some_and(|grab| hand.attach(grab, &motion));
    (*is_begun, *is_changed_by_bodies) = (true, false);
}

/// Finds the modes at the end of a substep without impulses. In a free body weight acts on the rigid motion alone.
fn advance_modes(
    modal: &ModalBody,
    own: &ModalState,
    gravity: DVec3,
    oscillators: &[Oscillator],
    [amplitude, rate]: &mut [Vec<f64>; 2],
) {
    let gravity = if modal.rigid.is_some() { DVec3::ZERO } else { modal.turn.transpose() * gravity };
    for (mode, oscillator) in oscillators[..modal.modes.count()].iter().enumerate() {
        let force = modal.modes.load(mode).dot(gravity);
        [amplitude[mode], rate[mode]] = oscillator.after([own.amplitude[mode], own.rate[mode]], force);
    }
}

/// The modes at the end with impulses.
fn with_impulses<'a>(
    free: ModesAtEnd<'_>,
    change: &[f64],
    secs: f64,
    [amplitude, rate]: &'a mut [Vec<f64>; 2],
) -> ModesAtEnd<'a> {
    let count = free.rate.len();
    for mode in 0..count {
        amplitude[mode] = free.amplitude[mode] + secs * change[mode];
        rate[mode] = free.rate[mode] + change[mode];
    }
    ModesAtEnd { amplitude: &amplitude[..count], rate: &rate[..count] }
}

/// Whether all numbers are finite and the body has not exploded.
fn is_sound<R: Real>(body: &BodyModel<R>, modal: &ModalBody, end: ModesAtEnd<'_>, flight: Option<&Flight<'_>>) -> bool {
    let vibration: f64 =
        end.amplitude.iter().enumerate().map(|(mode, q)| q.abs() * modal.points.max_displacement(mode)).sum();
    let vibrates_soundly =
        vibration <= MAX_VIBRATION_SIZES * body.size.to_f64() && end.rate.iter().all(|rate| rate.is_finite());
    vibrates_soundly && flight.is_none_or(Flight::is_sound)
}

/// Sets a body to the end of a substep. Returns bounds on the mean speed of its points, m/s, and on the change of their
/// velocity in a second, m/s².
fn store_end(
    own: &mut ModalState,
    modal: &ModalBody,
    end: ModesAtEnd<'_>,
    flight: Option<&Flight<'_>>,
    secs: f64,
) -> [f64; 2] {
    let [mut speed, mut push] =
        flight.map_or([0.0; 2], |flight| [flight.speed_bound(), flight.velocity_change_bound() / secs]);
    for mode in 0..end.rate.len() {
        let (amplitude, rate) = (end.amplitude[mode], end.rate[mode]);
        let mean = (amplitude - own.amplitude[mode]) / secs;
        push += (rate - own.rate[mode]).abs() * modal.points.max_displacement(mode) / secs;
        speed += mean.abs() * modal.points.max_displacement(mode);
        (own.amplitude[mode], own.rate[mode], own.mean_rate[mode]) = (amplitude, rate, mean);
    }
    own.rigid = flight.map(|flight| flight.end);
    [speed, push]
}

/// The touches of a body, which are by point.
fn touches_of(touches: &[SampleTouch], body: usize) -> &[SampleTouch] {
    let [first, end] = [body, body + 1].map(|body| touches.partition_point(|touch| touch.body < body));
    &touches[first..end]
}

/// Replaces the touches of a body.
fn replace_touches(now: &[SampleTouch], body: usize, touches: &mut Vec<SampleTouch>) {
    if now.is_empty() && touches_of(touches, body).is_empty() {
        return;
    }
    touches.retain(|touch| touch.body != body);
    touches.extend_from_slice(now);
    touches.sort_unstable_by_key(SampleTouch::place);
}
