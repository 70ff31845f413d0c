//! Where a line is within a radius of a point or an axis: what capsules and cylinders have in common.

use crate::math::{Real, Vector};

/// The part of the line `from + t direction` that is no farther than `radius` from the origin: t where it begins and ends. For
/// the distance from an axis, `from` and `direction` are given without their part along it. The line may then stand still,
/// and is inside all the time or never.
pub(super) fn interval_within<R: Real>(radius: R, from: R::Vec3, direction: R::Vec3) -> Option<[R; 2]> {
    let distance = from.length();
    let a = direction.dot(direction);
    if a <= R::ZERO {
        let ever = R::from_f64(f64::INFINITY);
        return (distance <= radius).then_some([-ever, ever]);
    }
    // |from + t way|² = r² as a t² + 2 b t + c = 0. The discriminant is found from the point of the line that is nearest to
    // the origin: from b² − a c rounding would leave nothing where the line is long.
    let b = from.dot(direction);
    let foot = from - direction * (b / a);
    let short = foot.length();
    if short > radius {
        return None;
    }
    let half = (a * ((radius - short) * (radius + short))).sqrt();
    let c = (distance - radius) * (distance + radius);
    // The root of the larger magnitude first, the other by their product c / a.
    let large = if b > R::ZERO { -b - half } else { half - b };
    if large == R::ZERO {
        return Some([R::ZERO; 2]);
    }
    let [one, other] = [large / a, c / large];
    Some([one.min(other), one.max(other)])
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, Vec3};

    use super::*;

    #[test]
    fn a_line_is_within_from_where_it_enters_to_where_it_leaves() {
        let unit = |from: DVec3, direction: DVec3| interval_within(1.0_f64, from, direction);
        let [enter, leave] = unit(DVec3::new(-3.0, 0.6, 0.0), DVec3::X * 2.0).expect("it crosses");
        assert!((enter - 1.1).abs() < 1e-12 && (leave - 1.9).abs() < 1e-12, "{enter} to {leave}");
        let [enter, leave] = unit(DVec3::new(3.0, 0.6, 0.0), DVec3::X).expect("behind it");
        assert!((enter + 3.8).abs() < 1e-12 && (leave + 2.2).abs() < 1e-12, "{enter} to {leave}");
        assert_eq!(unit(DVec3::new(-3.0, 1.1, 0.0), DVec3::X), None, "it passes by");
        assert_eq!(unit(DVec3::X * 2.0, DVec3::ZERO), None, "it stands outside");
        assert_eq!(unit(DVec3::X * 0.5, DVec3::ZERO), Some([f64::NEG_INFINITY, f64::INFINITY]), "it stands inside");
        assert_eq!(unit(DVec3::X, DVec3::Y), Some([0.0; 2]), "it only touches");
    }

    #[test]
    fn a_long_way_does_not_lose_a_thin_rod() {
        // A kilometre in one step past a rod of a millimetre, in single precision.
        for aside in [0.0, 3e-4, 9e-4] {
            let found = interval_within(1e-3_f32, Vec3::new(-500.0, aside, 0.0), Vec3::X * 1000.0);
            assert!(found.is_some(), "{aside} m beside its middle");
        }
    }
}
