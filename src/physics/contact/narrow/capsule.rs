//! A capsule about the origin: all that is no farther than its radius from a piece of the y axis.

use super::{cuboid, round};
use crate::math::{Real, Vector};
use crate::physics::contact::surface::{Crossing, Surface};

/// The point of the surface nearest to a point; from the very axis it is beside it.
pub(super) fn nearest<R: Real>(radius: R, half_height: R, at: R::Vec3) -> Surface<R> {
    let [x, y, z] = at.components();
    let offset = R::Vec3::new(x, y - y.max(-half_height).min(half_height), z);
    let distance = offset.length();
    let sideways = R::Vec3::new(R::ONE, R::ZERO, R::ZERO);
    let normal = if distance > R::ZERO { offset * (R::ONE / distance) } else { sideways };
    Surface { normal, gap: distance - radius }
}

/// Where a line crosses the capsule: its parts inside the two balls and inside the cylinder between them join into one piece.
pub(super) fn crossing<R: Real>(radius: R, half_height: R, from: R::Vec3, direction: R::Vec3) -> Option<Crossing<R>> {
    let top = R::Vec3::new(R::ZERO, half_height, R::ZERO);
    let balls = [top, -top].map(|middle| round::interval_within(radius, from - middle, direction));
    let pieces = balls.into_iter().chain([in_cylinder(radius, half_height, from, direction)]).flatten();
    let [enter, leave] = pieces.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])?;
    let normal = nearest(radius, half_height, from + direction * enter).normal;
    Some(Crossing { enter, leave, normal })
}

/// The part of a line within a cylinder about y without its ends.
fn in_cylinder<R: Real>(radius: R, half_height: R, from: R::Vec3, direction: R::Vec3) -> Option<[R; 2]> {
    let level = |[x, _, z]: [R; 3]| R::Vec3::new(x, R::ZERO, z);
    let (from, direction) = (from.components(), direction.components());
    let sides = round::interval_within(radius, level(from), level(direction))?;
    let ends = cuboid::slab_interval(half_height, from[1], direction[1])?;
    let [enter, leave] = [sides[0].max(ends[0]), sides[1].min(ends[1])];
    (enter <= leave).then_some([enter, leave])
}
