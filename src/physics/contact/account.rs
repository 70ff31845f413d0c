//! Energy of a particle and the springs of its contacts, and the work that moving obstacles do on them.

use super::record::ContactRecord;
use crate::math::{Real, Vector};
use crate::physics::model::ContactModel;

/// Returns the energy of a particle with this velocity and of the springs of its contacts after `secs` of it, J.
pub(super) fn energy<R: Real>(
    velocity: R::Vec3,
    secs: R,
    mass: R,
    contacts: &[ContactModel<R>],
    found: &[ContactRecord<R>],
) -> R {
    found.iter().fold(R::from_f64(0.5) * mass * velocity.dot(velocity), |sum, record| {
        let along = (velocity - record.surface_velocity).dot(record.normal);
        sum + contacts[record.obstacle].energy(-(record.gap + along * secs))
    })
}

/// Returns the work that moving obstacles do on a particle with the forces found so far, J.
pub(super) fn work<R: Real>(dt: R, found: &[ContactRecord<R>]) -> R {
    found.iter().fold(R::ZERO, |sum, record| sum + record.force.dot(record.surface_velocity) * dt)
}
