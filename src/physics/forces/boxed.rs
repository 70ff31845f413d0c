//! The forces of all links by the threads of a team: each works out what is on the particles of its shares.

use super::links::{Configuration, for_each_link, is_damped};
use crate::math::Real;
use crate::physics::kernels::{self, Pass};
use crate::physics::model::Model;
use crate::physics::model::plan::Plan;
use crate::physics::share::{Share, middle};
use crate::physics::state::BodyMemory;
use crate::physics::team::Halves;

/// Forces of links that are to be added.
pub(super) struct LinkForces<'a, R: Real> {
    pub(super) model: &'a Model<R>,
    pub(super) plan: &'a Plan,
    pub(super) memory: &'a [BodyMemory],
    pub(super) at: Configuration<'a, R>,
    pub(super) shares: &'a mut [Share<R>],
    /// Those on the particles of the shares, N.
    pub(super) force: &'a mut [R::Vec3],
}

impl<R: Real> LinkForces<'_, R> {
    /// Adds them until it is to stop: over the box of a body where it has one, else along the list of its links.
    pub(super) fn add(self, stops: &dyn Fn() -> bool) {
        let Self { model, plan, memory, at, shares, mut force } = self;
        for share in shares {
            let (own, rest) = force.split_at_mut(share.particles.len());
            force = rest;
            share.evaluated = 0;
            if memory[share.body].asleep {
                continue;
            }
            let body = &model.bodies[share.body];
            let [position, velocity] = [at.position, at.velocity].map(|of| &of[body.particles.clone()]);
            if let (Some(boxed), Some(piece)) = (&body.boxed_links, &mut share.piece) {
                let damped = [0, 1, 2].map(|family| plan.families[family] && is_damped(plan, &body.links[family]));
                let pass = Pass { level: plan.simd, families: plan.families, damped };
                share.evaluated = kernels::add_forces(boxed, pass, [position, velocity], own, piece, stops);
                continue;
            }
            for_each_link(body, plan, position, velocity, stops, |[i, j], on_i| {
                own[i] += on_i;
                own[j] -= on_i;
                share.evaluated += 1;
            });
        }
    }
}

impl<R: Real> Halves for LinkForces<'_, R> {
    fn pieces(&self) -> usize {
        self.shares.len()
    }

    fn halve(self) -> [Self; 2] {
        let Self { model, plan, memory, at, shares, force } = self;
        let (low, high) = shares.split_at_mut(middle(shares, memory));
        let count = low.iter().map(|share| share.particles.len()).sum();
        let (on_low, on_high) = force.split_at_mut(count);
        [
            Self { model, plan, memory, at, shares: low, force: on_low },
            Self { model, plan, memory, at, shares: high, force: on_high },
        ]
    }

    fn work(self) {
        // Who may stop it is asked between passes, by the thread that asked for this one.
        self.add(&|| false);
    }
}
