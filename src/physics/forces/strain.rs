//! Finds the bodies that have links far from their rest length. All threads of a step search; a body counts as not strained
//! once all its links have been checked.

use crate::math::{Real, Vector};
use crate::physics::forces::ForceWorkspace;
use crate::physics::kernels::{self, SimdLevel};
use crate::physics::model::{BodyModel, Model};
use crate::physics::share::{Share, balanced_cut};
use crate::physics::state::BodyMemory;
use crate::physics::team::{self, DivisibleWork};

/// A motion along straight lines, in which links are checked for strain.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct StraightMotion<'a, R: Real> {
    /// Positions, m.
    pub(in crate::physics) position: &'a [R::Vec3],
    /// Velocities, m/s.
    pub(in crate::physics) velocity: &'a [R::Vec3],
    /// Duration of the motion, s: links are checked at its start and at its end.
    pub(in crate::physics) secs: R,
}

impl<R: Real> StraightMotion<'_, R> {
    /// The motion of one body.
    pub(in crate::physics) fn of(self, body: &BodyModel<R>) -> Self {
        let Self { position, velocity, secs } = self;
        Self { position: &position[body.particles.clone()], velocity: &velocity[body.particles.clone()], secs }
    }
}

impl<R: Real> ForceWorkspace<R> {
    /// Checks which bodies have a link strained by more than `strain` returns for the body, if it returns a value; it is
    /// called once for each body. [`Self::is_strained`] tells the result.
    pub(in crate::physics) fn find_strained(
        &mut self,
        model: &Model<R>,
        memories: &[BodyMemory],
        level: SimdLevel,
        motion: StraightMotion<'_, R>,
        mut strain: impl FnMut(usize) -> Option<f64>,
    ) {
        let Self { shares, threads, .. } = self;
        let mut last = None;
        for share in &mut *shares {
            if last.is_none_or(|(body, _)| body != share.body) {
                last = Some((share.body, strain(share.body)));
            }
            (share.strain, share.is_strained) = (last.and_then(|(_, strain)| strain), false);
        }
        if shares.iter().any(|share| share.strain.is_some()) {
            team::share(*threads, StrainCheck { model, memories, level, motion, shares });
        }
    }

    /// Whether the last check found such a link in a body.
    pub(in crate::physics) fn is_strained(&self, body: usize) -> bool {
        self.shares.iter().any(|share| share.body == body && share.is_strained)
    }
}

/// A job: check the links of some shares.
struct StrainCheck<'a, R: Real> {
    model: &'a Model<R>,
    memories: &'a [BodyMemory],
    level: SimdLevel,
    motion: StraightMotion<'a, R>,
    shares: &'a mut [Share<R>],
}

impl<R: Real> DivisibleWork for StrainCheck<'_, R> {
    fn pieces(&self) -> usize {
        self.shares.len()
    }

    fn halve(self) -> [Self; 2] {
        let Self { model, memories, level, motion, shares } = self;
        let (low, high) = shares.split_at_mut(balanced_cut(shares, |body| !memories[body].asleep));
        [low, high].map(|shares| Self { model, memories, level, motion, shares })
    }

    fn work(self) {
        for share in self.shares {
            let Some(strain) = share.strain else { continue };
            let body = &self.model.bodies[share.body];
            let own = self.motion.of(body);
            share.is_strained = match (&body.boxed_links, &mut share.piece) {
                (Some(links), Some(piece)) => {
                    kernels::are_strained(links, self.level, strain, own.secs, [own.position, own.velocity], piece)
                }
                _ => is_beyond(body, own, strain),
            };
        }
    }
}

/// Whether any link is strained by more than `strain` at the start or at the end of the motion.
fn is_beyond<R: Real>(body: &BodyModel<R>, own: StraightMotion<'_, R>, strain: f64) -> bool {
    let [shortest, longest] = [1.0 - strain, 1.0 + strain].map(R::from_f64);
    let is_beyond = |d: R::Vec3| {
        let squared = d.dot(d);
        squared > longest * longest || squared < shortest * shortest
    };
    links(body, own).any(|(d, displacement)| is_beyond(d) || is_beyond(d + displacement))
}

/// Returns the longest way that two ends of a link move relative to each other in the motion, in rest lengths of that link.
pub(in crate::physics) fn max_link_displacement<R: Real>(body: &BodyModel<R>, own: StraightMotion<'_, R>) -> f64 {
    links(body, own).fold(R::ZERO, |most, (_, displacement)| most.max(displacement.dot(displacement))).to_f64().sqrt()
}

/// Returns for each link the vector from end to end and its change in the motion, in rest lengths. Links without a force are
/// included: their length tells of the angles between others.
fn links<R: Real>(body: &BodyModel<R>, own: StraightMotion<'_, R>) -> impl Iterator<Item = (R::Vec3, R::Vec3)> {
    let StraightMotion { position, velocity, secs } = own;
    body.links.iter().flat_map(|family| family.links.iter()).map(move |link| {
        let [i, j] = link.ends.map(|end| end as usize);
        let d = (position[j] - position[i]) * link.inverse_rest_length;
        (d, (velocity[j] - velocity[i]) * (link.inverse_rest_length * secs))
    })
}
