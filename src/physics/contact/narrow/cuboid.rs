//! A box about the origin.

use crate::math::{Real, Vector};
use crate::physics::contact::surface::{Crossing, Surface};

/// The axes in the order of preference among faces that are equally near: from the very middle the way is up.
const FACE_PREFERENCE: [usize; 3] = [1, 0, 2];

/// The point of the surface nearest to a point; from inside it is on a face.
pub(super) fn nearest<R: Real>(half_extents: [R; 3], at: R::Vec3) -> Surface<R> {
    let at = at.components();
    let past: [R; 3] = std::array::from_fn(|axis| at[axis].abs() - half_extents[axis]);
    let signed = |axis: usize, length: R| if at[axis] < R::ZERO { -length } else { length };
    if past.iter().any(|past| *past > R::ZERO) {
        let [x, y, z] = std::array::from_fn(|axis| signed(axis, past[axis].max(R::ZERO)));
        let offset = R::Vec3::new(x, y, z);
        let gap = offset.length();
        // A point whose distance is too small to be squared counts by one face alone.
        if gap > R::ZERO {
            return Surface { normal: offset * (R::ONE / gap), gap };
        }
    }
    let face = FACE_PREFERENCE.into_iter().reduce(|best, axis| if past[axis] > past[best] { axis } else { best });
    let face = face.unwrap_or_default();
    Surface { normal: axis_vector(face, signed(face, R::ONE)), gap: past[face] }
}

/// Where a line crosses the box.
pub(super) fn crossing<R: Real>(half_extents: [R; 3], from: R::Vec3, direction: R::Vec3) -> Option<Crossing<R>> {
    let ever = R::from_f64(f64::INFINITY);
    let mut found = Crossing { enter: -ever, leave: ever, normal: R::Vec3::ZERO };
    let (from, direction) = (from.components(), direction.components());
    for axis in 0..3 {
        let [enter, leave] = slab_interval(half_extents[axis], from[axis], direction[axis])?;
        if enter > found.enter {
            let outwards = if direction[axis] > R::ZERO { -R::ONE } else { R::ONE };
            (found.enter, found.normal) = (enter, axis_vector(axis, outwards));
        }
        found.leave = found.leave.min(leave);
    }
    (found.enter <= found.leave).then_some(found)
}

/// The part of a line that lies between −half and half along one axis: t where it begins and ends.
pub(super) fn slab_interval<R: Real>(half: R, from: R, direction: R) -> Option<[R; 2]> {
    if direction == R::ZERO {
        let ever = R::from_f64(f64::INFINITY);
        return (from.abs() <= half).then_some([-ever, ever]);
    }
    let [low, high] = [(-half - from) / direction, (half - from) / direction];
    Some([low.min(high), low.max(high)])
}

/// A vector along one axis.
fn axis_vector<R: Real>(axis: usize, length: R) -> R::Vec3 {
    let [x, y, z] = std::array::from_fn(|other| if other == axis { length } else { R::ZERO });
    R::Vec3::new(x, y, z)
}
