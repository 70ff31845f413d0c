//! Contact candidates of a modal body: points that meet obstacles, alone or as the mean of neighbours.

use glam::{DMat3, DVec3};

use super::motion::{Motion, PointMotion};
use crate::math::{Real, Vector};
use crate::physics::contact::Surface;

/// How a point touched an obstacle before.
#[derive(Clone, Copy, Debug)]
pub(super) struct PriorTouch {
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
    pub(super) point_motion: PointMotion,
    /// Unit normal, away from the obstacle.
    pub(super) normal: DVec3,
    /// How far the point is from the surface when the substep begins, m; negative inside.
    pub(super) gap: f64,
    /// The velocity of the surface, m/s.
    pub(super) surface_velocity: DVec3,
    /// How far its spring is pressed then, m; negative outside.
    pub(super) pressed: f64,
}

impl Candidate {
    /// The candidate of a point that meets an obstacle as `contact` says, both by number.
    pub(super) fn new<R: Real>(
        motion: &Motion<'_, R>,
        (point, obstacle): (usize, usize),
        prior: Option<PriorTouch>,
        contact: &SweptContact<R>,
    ) -> Self {
        let back: DMat3 = motion.turn.transpose();
        let gap = contact.surface.gap.to_f64();
        Self {
            point,
            place: motion.modal.points.place_in_tree(point),
            obstacle,
            point_motion: contact.point_motion,
            normal: back * contact.surface.normal.to_dvec3(),
            gap,
            surface_velocity: back * contact.surface_velocity.to_dvec3(),
            pressed: prior.map_or(0.0, |prior| prior.pressed).min(-gap),
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
            mean.point_motion.displacement += other.point_motion.displacement;
            mean.point_motion.velocity += other.point_motion.velocity;
            mean.normal += other.normal;
            mean.gap += other.gap;
            mean.surface_velocity += other.surface_velocity;
            mean.pressed += other.pressed;
        }
        let share = 1.0 / of.len() as f64;
        mean.point_motion.displacement *= share;
        mean.point_motion.velocity *= share;
        mean.normal = mean.normal.normalize_or(first.normal);
        mean.gap *= share;
        mean.surface_velocity *= share;
        mean.pressed = (mean.pressed * share).min(-mean.gap);
        Some(mean)
    }

    /// Its depth at the end of a substep of `dt` (s) without impulses, m.
    pub(super) fn depth(&self, dt: f64) -> f64 {
        -(self.gap + (self.point_motion.displacement - self.surface_velocity * dt).dot(self.normal))
    }
}

/// How a point meets an obstacle.
pub(super) struct SweptContact<R: Real> {
    pub(super) point_motion: PointMotion,
    pub(super) surface: Surface<R>,
    /// The velocity of the surface, m/s.
    pub(super) surface_velocity: R::Vec3,
}
