//! How hard a contact of a point pushes and rubs.

use glam::DVec3;

/// Default stiffness of a contact spring over the mass of the particle it has to carry, 1/s².
pub(in crate::physics) const STIFFNESS_OVER_MASS: f64 = 1e5;

/// Depth limit: nothing rests, or ends a step, deeper in what it meets than this share of its body's size.
pub const DEPTH_SHARE: f64 = 0.02;

/// A point that is inside something without having pressed its spring leaves no faster than this share of its body's size in a
/// second.
pub(in crate::physics) const PARTING_SPEED_SHARE: f64 = 0.5;

/// A point whose mobility is below this (1/kg) counts as held: a push moves it by no more than rounding error.
pub(in crate::physics) const MIN_MOBILITY: f64 = 1e-12;

/// The law of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::physics) struct PointLaw {
    /// Stiffness of a point's spring, N/m.
    pub(in crate::physics::contact) stiffness: f64,
    /// Its damping over the critical one.
    pub(in crate::physics::contact) damping_ratio: f64,
    /// Deeper than this the spring pushes no harder, m; and no point gets deeper that was not.
    pub(in crate::physics::contact) depth_limit: f64,
    /// The most that one point may have to carry, N.
    pub(in crate::physics::contact) load: f64,
    /// Largest speed at which a point leaves that is deeper than its spring is pressed, m/s.
    pub(in crate::physics::contact) max_parting_speed: f64,
    /// Coulomb's coefficients, at rest and sliding.
    pub(in crate::physics::contact) friction: [f64; 2],
}

impl PointLaw {
    /// Returns the energy of a point's spring that is `pressed` (m), J.
    pub(in crate::physics) fn energy(&self, pressed: f64) -> f64 {
        let sprung = pressed.clamp(0.0, self.depth_limit);
        0.5 * self.stiffness * sprung * sprung
    }
}

/// Returns the impulse of friction, N·s, where one of `stopping` would end all sliding: that, if friction at rest can give it, else
/// the most that sliding friction gives. `friction` are Coulomb's coefficients, at rest and sliding.
pub(in crate::physics) fn coulomb_impulse(stopping: DVec3, friction: [f64; 2], normal_impulse: f64) -> DVec3 {
    let strength = stopping.length();
    let held = strength <= friction[0] * normal_impulse;
    let most = if held { strength } else { (friction[1] * normal_impulse).min(strength) };
    if strength > 0.0 { stopping * (most / strength) } else { DVec3::ZERO }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn friction_holds_up_to_its_limit_and_slides_with_less_beyond() {
        let stopping = DVec3::new(3.0, 0.0, -4.0);
        assert_eq!(coulomb_impulse(stopping, [0.5, 0.2], 10.0), stopping, "just as much as friction at rest can give");
        let sliding = coulomb_impulse(stopping * 1.001, [0.5, 0.2], 10.0);
        assert!((sliding - stopping * 0.4).length() < 1e-12, "2 N·s, the same way: {sliding}");
        assert_eq!(coulomb_impulse(stopping, [0.0, 9.0], 10.0), stopping, "never more than stops it");
        assert_eq!(coulomb_impulse(DVec3::ZERO, [0.5, 0.2], 10.0), DVec3::ZERO, "nothing slides");
        assert_eq!(coulomb_impulse(stopping, [0.5, 0.2], 0.0), DVec3::ZERO, "nothing presses");
    }
}
