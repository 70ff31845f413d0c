//! Bodies that move by their modes: each mode is an oscillator of its own, whatever the number of cells (A. Pentland,
//! J. Williams, "Good vibrations: modal dynamics for graphics and animation", SIGGRAPH 1989; SC §5).
//!
//! ```text
//!   u = Σ qᵢ φᵢ       q'' + c q' + ω² q = φᵀ F        c = φᵀ C φ
//! ```
//!
//! The modes themselves come from outside (`modal` finds them); a body that has them is a modal body. Its particles sleep as
//! far as all other rooms know, and are put where the modes have them when someone looks: so a substep costs as much as there
//! are modes, and contact as much as comes near.
//!
//! ```text
//! oscillator   one mode over a step in which the force stays the same, exactly
//! flight       a free body as a whole over a substep: what weight and its spin do
//! motion       both together: where points are, how fast, and how what pushes at them moves the body
//! contact      which points meet what, and their springs
//! hold         the hand and all contacts together, taken implicitly
//! particles    of a modal body: where modes have them, and what modes take up of their motion
//! ```
//!
//! What is constant of them (frequencies, shapes, the points that meet obstacles, inertia) is in `model`, how far each is from
//! rest and how fast it goes, and where a free body is, in `state`.
//!
//! # A substep
//!
//! The free solution `q*` is exact for gravity, so no step is too long and no frequency too high. What pushes at points is
//! taken implicitly, as in `step::pull` and `contact::response`: an impulse `J` at points that modes move by `P` changes the end
//! of the substep by
//!
//! ```text
//!   Δq' = w Pᵀ J,   Δq = dt Δq'       w = 1 / (1 + dt c + dt² ω²)
//! ```
//!
//! Contact is a penalty at surface points with critical damping, Coulomb friction, and no push that moves a point out of what
//! it is in faster than half the body's size in a second. A plane is met by a held body from the side on which a point rests.
//!
//! At rest on something the impulse takes back what weight did in the substep, so that the rate is not zero where nothing moves;
//! what is seen to move and told to rest is the mean rate over a substep, `(q_end − q) / dt`.
//!
//! # Free bodies
//!
//! A body that nothing holds swings about a place that moves and turns with it (D. Terzopoulos, A. Witkin, "Physically based models
//! with rigid and deformable components", IEEE CG&A 8(6), 1988; A. Shabana, *Dynamics of Multibody Systems*, ch. 5):
//!
//! ```text
//!   x = c + R (r + u − r_c)       u = Σ qᵢ φᵢ,   r at rest,   r_c the centre of mass at rest
//! ```
//!
//! Modes have no part of the motion as a whole, so weight acts on that alone, and exactly. To an impulse moving and turning
//! are six more modes without frequency, `P = e_k / √m` and `P = a_k × (r + u − r_c) / √I_k` of the principal axes `a_k`, in the
//! frame in which the substep begins: momentum and angular momentum change by just the impulse and its moment.
//!
//! Left out, as all of it is of second order in the swing or grows with the square of the spin: the Coriolis, centrifugal
//! and Euler forces on modes (what spins is not stretched by it), what the swing itself has of angular momentum, and what it
//! changes of the moments of inertia.
//!
//! Contact differs in four things. A free body remembers on which side of planes and open meshes its points touch them. Where
//! more of its points touch something than can be solved for, each group of neighbours is one contact, as stiff as all of
//! them. Springs are damped as the highest mode is, as they stand for the give about a point that still higher ones would
//! have: critical damping, which takes little from the particle of a cell, would take its bounce from the whole body. Friction
//! and damping are against how fast a point is on the whole in the substep: at its end weight would have it creep.
//!
//! It is worked out after the particles of a substep have moved, against obstacles where these are then. It follows from the
//! state alone and is worked out by one thread: the same bits everywhere.

mod contact;
mod flight;
mod hold;
mod motion;
mod oscillator;
mod particles;

pub(in crate::physics) use particles::{place, resting};

use glam::DVec3;

use contact::ModalContacts;
use flight::{Flight, RIGID};
use hold::Hand;
use motion::{Ends, Motion};
use oscillator::Oscillator;

use super::contact::Placed;
use super::interaction::Grab;
use super::model::{BodyModel, ModalBody, Model};
use super::report::Recorder;
use super::state::touch::SampleTouch;
use super::state::{ModalState, State, fallen};
use super::stepping::looks::substeps_in;
use crate::math::{Real, Vector};
use crate::physics::model::plan::{Plan, Stage};
use crate::physics::state::sleep::STILL_SECS;

/// A body is at rest that moves no faster than this, and is pushed to no faster within [`STILL_SECS`], body sizes a second.
const STILL: f64 = 1e-4;

/// A body that swings farther than so many of its sizes has exploded: single precision has no places left for its shape.
const MOST_SIZES: f64 = 1e6;

/// What modal bodies work in: allocated once, meaningless between substeps.
#[derive(Clone, Debug, Default)]
pub(in crate::physics) struct ModalWorkspace {
    /// The length of a substep, s.
    secs: f64,
    /// Of every body, its modes over a substep and the motions of a free one as a whole; none of a body that moves by its
    /// cells.
    oscillators: Vec<Vec<Oscillator>>,
    /// Amplitudes and rates of the body under work at the end without what pushes at points.
    free: [Vec<f64>; 2],
    /// The same with what pushes.
    end: [Vec<f64>; 2],
    /// What that changes of the rates, m √kg / s.
    change: Vec<f64>,
    contacts: ModalContacts,
    hand: Hand,
}

impl ModalWorkspace {
    /// Room for a model under a plan.
    pub(in crate::physics) fn new<R: Real>(model: &Model<R>, plan: &Plan) -> Self {
        let modal = || model.bodies.iter().filter_map(|body| body.modal.as_ref());
        if modal().next().is_none() {
            return Self::default();
        }
        let most = modal().map(|modal| modal.modes.count() + RIGID).max().unwrap_or(0);
        let points = modal().map(|modal| modal.points.count()).max().unwrap_or(0);
        Self {
            secs: plan.substep_secs(),
            oscillators: oscillators(model, plan.substep_secs()),
            free: [vec![0.0; most], vec![0.0; most]],
            end: [vec![0.0; most], vec![0.0; most]],
            change: vec![0.0; most],
            contacts: ModalContacts::new(
                points * model.obstacles.len(),
                most,
                model.mesh_count(),
                model.points_in_contact(),
            ),
            hand: Hand::new(most),
        }
    }

    /// Has the modes swing in substeps of another length, s.
    fn follow<R: Real>(&mut self, model: &Model<R>, secs: f64) {
        #[expect(clippy::float_cmp, reason = "the same length or another")]
        if self.secs != secs {
            (self.secs, self.oscillators) = (secs, oscillators(model, secs));
        }
    }
}

/// Of every body its modes over a substep and the motions of a free one as a whole, none of one that moves by its cells.
fn oscillators<R: Real>(model: &Model<R>, secs: f64) -> Vec<Vec<Oscillator>> {
    let of_body = |modal: &ModalBody| {
        let rates = modal.modes.rates().iter().copied();
        let rigid = modal.rigid.iter().flat_map(|_| [[0.0; 2]; RIGID]);
        rates.chain(rigid).map(|[omega, damping]| Oscillator::new(omega, damping, secs)).collect()
    };
    model.bodies.iter().map(|body| body.modal.as_ref().map_or_else(Vec::new, of_body)).collect()
}

/// What modal bodies did in a substep.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::physics) struct ModalReport {
    /// Contacts that push.
    pub(in crate::physics) contacts: usize,
    /// The deepest point at the end, m.
    pub(in crate::physics) deepest_m: f64,
    /// Whether all numbers are finite and no body has exploded.
    pub(in crate::physics) is_finite: bool,
}

/// Moves all modal bodies over a substep. Where a number would not be finite or a body has
/// exploded, nothing of that body is changed.
pub(in crate::physics) fn advance<R: Real>(
    model: &Model<R>,
    plan: &Plan,
    obstacles: &Placed<R>,
    grab: Option<&Grab<R>>,
    state: &mut State<R>,
    workspace: &mut ModalWorkspace,
    recorder: &mut Recorder<'_>,
) -> ModalReport {
    let mut report = ModalReport { is_finite: true, ..ModalReport::default() };
    let secs = plan.substep_secs();
    workspace.follow(model, secs);
    let long_enough = substeps_in(plan, STILL_SECS, libm::ceil);
    for (number, body) in model.bodies.iter().enumerate() {
        let Some(modal) = &body.modal else { continue };
        let grab = grab.filter(|grab| grab.body == number);
        let is_resting = plan.sleeping && grab.is_none() && !model.moves_by_itself();
        if state.bodies[number].gone || is_resting && resting(&state.bodies[number], long_enough) {
            continue;
        }
        let own = &state.modal[number];
        recorder.enter(Stage::Integrate);
        recorder.counters.modal_work += modal.modes.count() as u64;
        let ModalWorkspace { oscillators, free, end, change, contacts, hand, .. } = &mut *workspace;
        let oscillators = &oscillators[number];
        let gravity = model.gravity.to_dvec3();
        let flight = match (&modal.rigid, own.rigid) {
            (Some(inertia), Some(now)) => Some(Flight::free(inertia, now, gravity, secs)),
            _ => None,
        };
        let (turn, place) = flight.as_ref().map_or((modal.turn, modal.place), Flight::frame);
        let free = swing(modal, own, gravity, oscillators, free);
        let motion = Motion {
            body,
            number,
            modal,
            oscillators,
            now: &own.amplitude,
            free,
            flight: flight.as_ref(),
            turn,
            place,
            secs,
        };
        let change = &mut change[..motion.count()];
        change.fill(0.0);
        contacts.find(&motion, model, obstacles, touches_of(&state.touches, number), plan, recorder);
        let pulls = grab.is_some_and(|grab| hand.take(grab, &motion));
        let is_pushed = pulls || !contacts.is_empty();
        if is_pushed {
            recorder.enter(Stage::Contact);
            hold::solve(pulls.then_some(&mut *hand), contacts, &motion, change);
            report.contacts += contacts.pushing();
            report.deepest_m = report.deepest_m.max(contacts.deepest(secs, change));
            contacts.count_work(recorder);
        }
        recorder.enter(Stage::Integrate);
        let end = pushed(free, change, secs, end);
        let flight = flight.as_ref().map(|flight| flight.pushed(*change.last_chunk().unwrap_or(&[0.0; RIGID]), secs));
        if !is_sound(body, modal, end, flight.as_ref()) {
            report.is_finite = false;
            continue;
        }
        if let Some(flight) = &flight {
            contacts.forget_touches();
            if is_pushed {
                let motion = Motion { free: end, flight: Some(flight), ..motion };
                contacts.find_touches(&motion, model, obstacles, touches_of(&state.touches, number), plan, recorder);
                recorder.enter(Stage::Integrate);
            }
            remember(contacts.touches(), number, &mut state.touches);
        }
        let own = &mut state.modal[number];
        let [speed, push] = take_over(own, modal, end, flight.as_ref(), secs);
        let memory = &mut state.bodies[number];
        let is_still = speed.max(push * STILL_SECS) <= STILL * body.size.to_f64() && grab.is_none();
        memory.still_substeps = if is_still && plan.sleeping { memory.still_substeps + 1 } else { 0 };
        if resting(memory, long_enough) {
            own.rest();
        }
        if let (true, Some(limit), Some(flight)) = (plan.sleeping, model.fall_limit, &flight) {
            let swings: f64 =
                own.amplitude.iter().enumerate().map(|(mode, q)| q.abs() * modal.points.farthest(mode)).sum();
            if fallen::is_ball_past(limit, flight.end.center, flight.inertia.radius + swings) {
                (memory.gone, memory.still_substeps) = (true, 0);
                own.stop();
            }
        }
    }
    report
}

/// Where modes are at the end of a substep without what pushes. Weight moves a free body as a whole alone.
fn swing<'a>(
    modal: &ModalBody,
    own: &ModalState,
    gravity: DVec3,
    oscillators: &[Oscillator],
    [amplitude, rate]: &'a mut [Vec<f64>; 2],
) -> Ends<'a> {
    let gravity = if modal.rigid.is_some() { DVec3::ZERO } else { modal.turn.transpose() * gravity };
    let count = modal.modes.count();
    for (mode, oscillator) in oscillators[..count].iter().enumerate() {
        let force = modal.modes.load(mode).dot(gravity);
        [amplitude[mode], rate[mode]] = oscillator.after([own.amplitude[mode], own.rate[mode]], force);
    }
    Ends { amplitude: &amplitude[..count], rate: &rate[..count] }
}

/// The same with what pushed.
fn pushed<'a>(free: Ends<'_>, change: &[f64], secs: f64, [amplitude, rate]: &'a mut [Vec<f64>; 2]) -> Ends<'a> {
    let count = free.rate.len();
    for mode in 0..count {
        amplitude[mode] = free.amplitude[mode] + secs * change[mode];
        rate[mode] = free.rate[mode] + change[mode];
    }
    Ends { amplitude: &amplitude[..count], rate: &rate[..count] }
}

/// Whether all numbers are finite and the body has not exploded.
fn is_sound<R: Real>(body: &BodyModel<R>, modal: &ModalBody, end: Ends<'_>, flight: Option<&Flight<'_>>) -> bool {
    let reach: f64 = end.amplitude.iter().enumerate().map(|(mode, q)| q.abs() * modal.points.farthest(mode)).sum();
    let swings_soundly = reach <= MOST_SIZES * body.size.to_f64() && end.rate.iter().all(|rate| rate.is_finite());
    swings_soundly && flight.is_none_or(Flight::is_sound)
}

/// Has a body be where a substep left it. Tells how fast its points moved at most, m/s, and by how much what pushes changes
/// that in a second, m/s².
fn take_over(
    own: &mut ModalState,
    modal: &ModalBody,
    end: Ends<'_>,
    flight: Option<&Flight<'_>>,
    secs: f64,
) -> [f64; 2] {
    let [mut speed, mut push] = flight.map_or([0.0; 2], |flight| [flight.speed(), flight.push() / secs]);
    for mode in 0..end.rate.len() {
        let (amplitude, rate) = (end.amplitude[mode], end.rate[mode]);
        let mean = (amplitude - own.amplitude[mode]) / secs;
        push += (rate - own.rate[mode]).abs() * modal.points.farthest(mode) / secs;
        speed += mean.abs() * modal.points.farthest(mode);
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

/// Has a body touch what it does now.
fn remember(now: &[SampleTouch], body: usize, touches: &mut Vec<SampleTouch>) {
    if now.is_empty() && touches_of(touches, body).is_empty() {
        return;
    }
    touches.retain(|touch| touch.body != body);
    touches.extend_from_slice(now);
    touches.sort_unstable_by_key(SampleTouch::place);
}
