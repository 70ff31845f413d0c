//! Bodies that move by their modes: each mode is an oscillator of its own, whatever the number of cells (A. Pentland,
//! J. Williams, "Good vibrations: modal dynamics for graphics and animation", SIGGRAPH 1989; SC §5).
//!
//! ```text
//!   u = Σ qᵢ φᵢ       q'' + c q' + ω² q = φᵀ F        c = φᵀ C φ
//! ```
//!
//! The motion is linear and about the place of rest, so it is one of bodies that are held: a free one would have to turn.
//! The modes themselves come from outside (`modal` finds them); a body that has them is a modal body. Its particles sleep as
//! far as all other rooms know, and are put where the modes have them when someone looks: so a substep costs as much as there
//! are modes, and contact as much as comes near.
//!
//! ```text
//! oscillator   one mode over a step in which the force stays the same, exactly
//! contact      which points meet what, and their springs
//! hold         the hand and all contacts together, taken implicitly
//! particles    of a modal body: where modes have them, and what modes take up of their motion
//! ```
//!
//! What is constant of them (frequencies, shapes, the points that meet obstacles) is in `model`, how far each is from rest and
//! how fast it goes in `state`.
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
//! it is in faster than half the body's size in a second. A plane is met from the side on which a point rests.
//!
//! At rest on something the impulse takes back what weight did in the substep, so that the rate is not zero where nothing moves;
//! what is seen to move and told to rest is the mean rate over a substep, `(q_end − q) / dt`.
//!
//! It is worked out after the particles of a substep have moved, against obstacles where these are then. It follows from the
//! state alone and is worked out by one thread: the same bits everywhere.

mod contact;
mod hold;
mod oscillator;
mod particles;

pub(in crate::physics) use particles::{place, resting};

use contact::{Ends, ModalContacts};
use hold::Hand;
use oscillator::Oscillator;

use super::contact::Placed;
use super::interaction::Grab;
use super::model::{ModalBody, Model};
use super::report::Recorder;
use super::state::State;
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
    /// Of every body, its modes over a substep; none of a body that moves by its cells.
    oscillators: Vec<Vec<Oscillator>>,
    /// Amplitudes and rates of the body under work at the end without what pushes at points.
    free: [Vec<f64>; 2],
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
        let most = modal().map(|modal| modal.modes.count()).max().unwrap_or(0);
        let points = modal().map(|modal| modal.points.count()).max().unwrap_or(0);
        Self {
            secs: plan.substep_secs(),
            oscillators: oscillators(model, plan.substep_secs()),
            free: [vec![0.0; most], vec![0.0; most]],
            change: vec![0.0; most],
            contacts: ModalContacts::new(points * model.obstacles.len(), most, model.mesh_count()),
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

/// Of every body its modes over a substep, none of one that moves by its cells.
fn oscillators<R: Real>(model: &Model<R>, secs: f64) -> Vec<Vec<Oscillator>> {
    let of_body = |modal: &ModalBody| {
        let rates = modal.modes.rates().iter();
        rates.map(|&[omega, damping]| Oscillator::new(omega, damping, secs)).collect()
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
        if plan.sleeping && grab.is_none() && !model.moves_by_itself() && resting(&state.bodies[number], long_enough) {
            continue;
        }
        let (modes, own) = (&*modal.modes, &mut state.modal[number]);
        let count = modes.count();
        recorder.enter(Stage::Integrate);
        recorder.counters.modal_work += count as u64;
        let ModalWorkspace { oscillators, free, change, contacts, hand, .. } = &mut *workspace;
        let oscillators = &oscillators[number];
        let gravity = modal.turn.transpose() * model.gravity.to_dvec3();
        let [amplitude, rate] = free.each_mut().map(|of| &mut of[..count]);
        for (mode, oscillator) in oscillators.iter().enumerate() {
            let force = modes.load(mode).dot(gravity);
            [amplitude[mode], rate[mode]] = oscillator.after([own.amplitude[mode], own.rate[mode]], force);
        }
        let (free, change) = (Ends { amplitude, rate }, &mut change[..count]);
        change.fill(0.0);
        recorder.enter(Stage::BroadPhase);
        let motion = contact::Motion { body, number, modal, oscillators, now: &own.amplitude, free, secs };
        contacts.find(&motion, model, obstacles, plan, recorder);
        let pulls = grab.is_some_and(|grab| hand.take(grab, &motion));
        if pulls || !contacts.is_empty() {
            recorder.enter(Stage::Contact);
            hold::solve(pulls.then_some(&mut *hand), contacts, &motion, change);
            report.contacts += contacts.pushing();
            report.deepest_m = report.deepest_m.max(contacts.deepest(secs, change));
            contacts.count_work(recorder);
        }
        recorder.enter(Stage::Integrate);
        let end = |mode: usize| [free.amplitude[mode] + secs * change[mode], free.rate[mode] + change[mode]];
        let reach: f64 = (0..count).map(|mode| end(mode)[0].abs() * modal.points.farthest(mode)).sum();
        let is_sound = reach <= MOST_SIZES * body.size.to_f64() && (0..count).all(|mode| end(mode)[1].is_finite());
        if !is_sound {
            report.is_finite = false;
            continue;
        }
        let (mut speed, mut push) = (0.0, 0.0);
        for mode in 0..count {
            let [amplitude, rate] = end(mode);
            let mean = (amplitude - own.amplitude[mode]) / secs;
            push += (rate - own.rate[mode]).abs() * modal.points.farthest(mode) / secs;
            speed += mean.abs() * modal.points.farthest(mode);
            (own.amplitude[mode], own.rate[mode], own.mean_rate[mode]) = (amplitude, rate, mean);
        }
        let memory = &mut state.bodies[number];
        let is_still = speed.max(push * STILL_SECS) <= STILL * body.size.to_f64() && grab.is_none();
        memory.still_substeps = if is_still && plan.sleeping { memory.still_substeps + 1 } else { 0 };
        if resting(memory, long_enough) {
            own.mean_rate.fill(0.0);
        }
    }
    report
}
