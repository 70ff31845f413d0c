//! Which bodies have links far from their length at rest, looked for by all threads of a step: a body that is not strained is
//! known not to be once all of its links have been seen.

use crate::math::{Real, Vector};
use crate::physics::forces::ForceWorkspace;
use crate::physics::kernels::{self, SimdLevel};
use crate::physics::model::{BodyModel, Model};
use crate::physics::share::{Share, middle};
use crate::physics::state::BodyMemory;
use crate::physics::team::{self, Halves};

/// Where and how particles are whose links are looked at.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct StraightMotion<'a, R: Real> {
    /// Positions, m.
    pub(in crate::physics) position: &'a [R::Vec3],
    /// Velocities, m/s.
    pub(in crate::physics) velocity: &'a [R::Vec3],
    /// For so long they go on, s: links are looked at as they are, and as they would be then.
    pub(in crate::physics) secs: R,
}

impl<R: Real> StraightMotion<'_, R> {
    /// That of one body.
    pub(in crate::physics) fn of(self, body: &BodyModel<R>) -> Self {
        let Self { position, velocity, secs } = self;
        Self { position: &position[body.particles.clone()], velocity: &velocity[body.particles.clone()], secs }
    }
}

impl<R: Real> ForceWorkspace<R> {
    /// Looks which bodies have a link that is strained by more than what `strain` says of them, if it says something, and
    /// is asked once of each. What is found is [`Self::is_strained`].
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
            team::share(*threads, Look { model, memories, level, motion, shares });
        }
    }

    /// Whether a body was found to have such a link at the last look.
    pub(in crate::physics) fn is_strained(&self, body: usize) -> bool {
        self.shares.iter().any(|share| share.body == body && share.is_strained)
    }
}

/// Shares that are looked through.
struct Look<'a, R: Real> {
    model: &'a Model<R>,
    memories: &'a [BodyMemory],
    level: SimdLevel,
    motion: StraightMotion<'a, R>,
    shares: &'a mut [Share<R>],
}

impl<R: Real> Halves for Look<'_, R> {
    fn pieces(&self) -> usize {
        self.shares.len()
    }

    fn halve(self) -> [Self; 2] {
        let Self { model, memories, level, motion, shares } = self;
        let (low, high) = shares.split_at_mut(middle(shares, memories));
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

/// Whether any link is strained by more than so much, or is at the end of the motion.
fn is_beyond<R: Real>(body: &BodyModel<R>, own: StraightMotion<'_, R>, strain: f64) -> bool {
    let [shortest, longest] = [1.0 - strain, 1.0 + strain].map(R::from_f64);
    let is_beyond = |d: R::Vec3| {
        let squared = d.dot(d);
        squared > longest * longest || squared < shortest * shortest
    };
    links(body, own).any(|(d, way)| is_beyond(d) || is_beyond(d + way))
}

/// The furthest that ends of a link of a body go past each other in the motion, in its lengths at rest.
pub(in crate::physics) fn longest_way<R: Real>(body: &BodyModel<R>, own: StraightMotion<'_, R>) -> f64 {
    links(body, own).fold(R::ZERO, |most, (_, way)| most.max(way.dot(way))).to_f64().sqrt()
}

/// From end to end of each link and how that changes in the motion, in lengths at rest; of links without a force, too: their
/// length tells of the angles between others.
fn links<R: Real>(body: &BodyModel<R>, own: StraightMotion<'_, R>) -> impl Iterator<Item = (R::Vec3, R::Vec3)> {
    let StraightMotion { position, velocity, secs } = own;
    body.links.iter().flat_map(|family| family.links.iter()).map(move |link| {
        let [i, j] = link.ends.map(|end| end as usize);
        let d = (position[j] - position[i]) * link.inverse_rest_length;
        (d, (velocity[j] - velocity[i]) * (link.inverse_rest_length * secs))
    })
}
