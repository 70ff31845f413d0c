//! Contact candidates of a modal body: points that meet obstacles, alone or as the mean of neighbours.

use glam::{DMat3, DVec3};

use super::motion::{Motion, Way};
use crate::math::{Real, Vector};
use crate::physics::contact::Surface;

/// How a point touched an obstacle before.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch {
    /// The side of a plane or an open mesh that it came from.
    pub(super) side: i8,
    /// How far its spring is pressed, m.
    pub(super) pressed: f64,
}

/// A point that meets an obstacle. All in the body's coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    pub(super) point: usize,
    /// Its place in the order of the tree.
    pub(super) place: usize,
    pub(super) obstacle: usize,
    pub(super) way: Way,
    /// Unit normal, away from the obstacle.
    pub(super) normal: DVec3,
    /// How far the point is from the surface when the substep begins, m; negative inside.
    pub(super) gap: f64,
    /// The velocity of the surface, m/s.
    pub(super) velocity: DVec3,
    /// How far its spring is pressed then, m; negative outside.
    pub(super) pressed: f64,
}

impl Candidate {
    /// The candidate of a point that meets an obstacle as `met` says, both by number.
    pub(super) fn new<R: Real>(
        motion: &Motion<'_, R>,
        (point, obstacle): (usize, usize),
        known: Option<Touch>,
        met: &Met<R>,
    ) -> Self {
        let back: DMat3 = motion.turn.transpose();
        let gap = met.surface.gap.to_f64();
        Self {
            point,
            place: motion.modal.points.place(point),
            obstacle,
            way: met.way,
            normal: back * met.surface.normal.to_dvec3(),
            gap,
            velocity: back * met.velocity.to_dvec3(),
            pressed: known.map_or(0.0, |known| known.pressed).min(-gap),
        }
    }

    /// The mean of neighbours that meet the same obstacle. Its spring is pressed by the mean of theirs, to push as all of
    /// them would.
    pub(super) fn mean(of: &[Self]) -> Option<Self> {
        let [first, others @ ..] = of else { return None };
        let mut mean = *first;
        if others.is_empty() {
            return Some(mean);
        }
        for other in others {
            mean.way.path += other.way.path;
            mean.way.speed += other.way.speed;
            mean.normal += other.normal;
            mean.gap += other.gap;
            mean.velocity += other.velocity;
            mean.pressed += other.pressed;
        }
        let share = 1.0 / of.len() as f64;
        mean.way.path *= share;
        mean.way.speed *= share;
        mean.normal = mean.normal.normalize_or(first.normal);
        mean.gap *= share;
        mean.velocity *= share;
        mean.pressed = (mean.pressed * share).min(-mean.gap);
        Some(mean)
    }

    /// Its depth at the end of a substep of `dt` (s) without impulses, m.
    pub(super) fn depth(&self, dt: f64) -> f64 {
        -(self.gap + (self.way.path - self.velocity * dt).dot(self.normal))
    }
}

/// How a point meets an obstacle.
pub(super) struct Met<R: Real> {
    pub(super) way: Way,
    pub(super) surface: Surface<R>,
    /// The velocity of the surface, m/s.
    pub(super) velocity: R::Vec3,
}
