//! A cylinder about the origin and the y axis.

use super::{cuboid, round};
use crate::math::{Real, Vector};
use crate::physics::contact::surface::{Crossing, Surface};

/// The point of the surface nearest to a point; from the very axis the way to the side is along x.
pub(super) fn nearest<R: Real>(radius: R, half_height: R, at: R::Vec3) -> Surface<R> {
    let [x, y, z] = at.components();
    let level = R::Vec3::new(x, R::ZERO, z);
    let distance = level.length();
    let unit = R::Vec3::new(R::ONE, R::ZERO, R::ZERO);
    let radial = if distance > R::ZERO { level * (R::ONE / distance) } else { unit };
    let axial = R::Vec3::new(R::ZERO, if y < R::ZERO { -R::ONE } else { R::ONE }, R::ZERO);
    let (past_side, past_end) = (distance - radius, y.abs() - half_height);
    if past_side > R::ZERO && past_end > R::ZERO {
        let offset = radial * past_side + axial * past_end;
        let gap = offset.length();
        if gap > R::ZERO {
            return Surface { normal: offset * (R::ONE / gap), gap };
        }
    }
    if past_end >= past_side {
        Surface { normal: axial, gap: past_end }
    } else {
        Surface { normal: radial, gap: past_side }
    }
}

/// Where a line crosses the cylinder.
pub(super) fn crossing<R: Real>(radius: R, half_height: R, from: R::Vec3, direction: R::Vec3) -> Option<Crossing<R>> {
    let level = |[x, _, z]: [R; 3]| R::Vec3::new(x, R::ZERO, z);
    let (at, along) = (from.components(), direction.components());
    let sides = round::interval_within(radius, level(at), level(along))?;
    let ends = cuboid::slab_interval(half_height, at[1], along[1])?;
    let [enter, leave] = [sides[0].max(ends[0]), sides[1].min(ends[1])];
    let by_end = ends[0] >= sides[0];
    let normal = if by_end {
        R::Vec3::new(R::ZERO, if along[1] > R::ZERO { -R::ONE } else { R::ONE }, R::ZERO)
    } else {
        let radial = level((from + direction * enter).components());
        radial * (R::ONE / radial.length())
    };
    (enter <= leave).then_some(Crossing { enter, leave, normal })
}
