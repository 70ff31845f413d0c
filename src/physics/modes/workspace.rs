//! The workspace of modal bodies.

use glam::DVec3;

use super::contact::ModalContacts;
use super::flight::RIGID_MOTIONS;
use super::oscillator::Oscillator;
use super::solver::Hand;
use crate::math::Real;
use crate::physics::model::plan::Plan;
use crate::physics::model::{BodyModel, Model};

/// The workspace of modal bodies: allocated once, meaningless between substeps.
#[derive(Clone, Debug, Default)]
pub(in crate::physics) struct ModalWorkspace {
    /// The length of a substep, s.
    pub(super) secs: f64,
    /// Of every body its modes over a substep, then the rigid motions of a free one; none of a body that moves by its cells.
    pub(super) oscillators: Vec<Vec<Oscillator>>,
    /// The work on every body in a substep.
    pub(super) body_workspaces: Vec<BodyWorkspace>,
    /// Amplitudes and rates of the body under work at the end.
    pub(super) end: [Vec<f64>; 2],
    /// The row under work.
    pub(super) row: Vec<DVec3>,
}

/// The work on a body in a substep; empty for a body that moves by its cells.
#[derive(Clone, Debug, Default)]
pub(super) struct BodyWorkspace {
    /// Whether the other fields are of the substep under way.
    pub(super) is_begun: bool,
    /// Amplitudes and rates at the end without impulses.
    pub(super) free: [Vec<f64>; 2],
    /// The change of the rates by impulses, m √kg / s.
    pub(super) change: Vec<f64>,
    pub(super) contacts: ModalContacts,
    pub(super) hand: Hand,
    /// Whether the hand pulls.
    pub(super) hand_pulls: bool,
    /// Whether contact with other bodies has changed the rates.
    pub(super) is_changed_by_bodies: bool,
}

impl ModalWorkspace {
    /// Room for a model under a plan.
    pub(in crate::physics) fn new<R: Real>(model: &Model<R>, plan: &Plan) -> Self {
        let modal = || model.bodies.iter().filter_map(|body| body.modal.as_ref());
        if modal().next().is_none() {
            return Self::default();
        }
        let most = modal().map(|modal| modal.modes.count() + RIGID_MOTIONS).max().unwrap_or(0);
        let work = |body: &BodyModel<R>| {
            let Some(modal) = &body.modal else { return BodyWorkspace::default() };
            let count = modal.modes.count() + RIGID_MOTIONS;
            BodyWorkspace {
                free: [vec![0.0; count], vec![0.0; count]],
                change: vec![0.0; count],
                contacts: ModalContacts::new(
                    modal.points.count() * model.obstacles.len(),
                    count,
                    model.mesh_count(),
                    model.max_touches_of(body),
                ),
                hand: Hand::new(count),
                ..BodyWorkspace::default()
            }
        };
        Self {
            secs: plan.substep_secs(),
            oscillators: oscillators(model, plan.substep_secs()),
            body_workspaces: model.bodies.iter().map(work).collect(),
            end: [vec![0.0; most], vec![0.0; most]],
            row: vec![DVec3::ZERO; most],
        }
    }

    /// Forgets what was found for a substep that was not taken.
    pub(in crate::physics) fn discard_substep(&mut self) {
        self.body_workspaces.iter_mut().for_each(|work| work.is_begun = false);
    }

    /// Fits the modes to substeps of another length, s.
    pub(super) fn set_substep_secs<R: Real>(&mut self, model: &Model<R>, secs: f64) {
        #[expect(clippy::float_cmp, reason = "the same length or another")]
        if self.secs != secs {
            self.secs = secs;
            for (own, body) in self.oscillators.iter_mut().zip(&model.bodies) {
                own.clear();
                own.extend(motions(body, secs));
            }
        }
    }
}

/// Of every body its modes over a substep, then the rigid motions of a free one; none of one that moves by its cells.
fn oscillators<R: Real>(model: &Model<R>, secs: f64) -> Vec<Vec<Oscillator>> {
    model.bodies.iter().map(|body| motions(body, secs).collect()).collect()
}

/// Those of one body.
fn motions<R: Real>(body: &BodyModel<R>, secs: f64) -> impl Iterator<Item = Oscillator> {
    body.modal.iter().flat_map(move |modal| {
        let rigid = modal.rigid.iter().flat_map(|_| [[0.0; 2]; RIGID_MOTIONS]);
        let rates = modal.modes.rates().iter().copied().chain(rigid);
        rates.map(move |[omega, damping]| Oscillator::new(omega, damping, secs))
    })
}
