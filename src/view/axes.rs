//! Draws a small cross of the axes, with their letters, in the lower right corner of a picture.

use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::Camera;
use super::overlay::{LineEnds, Lines, Segment};
use super::style::{OverlayColors, Tint};

/// The middle of the cross, pixels from the lower right corner.
const MIDDLE: Vec2 = Vec2::new(-52.0, 52.0);
/// The length of an axis in the plane of the picture, pixels.
const AXIS_LENGTH: f32 = 28.0;
/// From the middle of the cross to the middle of a letter, pixels.
const LETTER_DISTANCE: f32 = 38.0;
/// The opacity of an axis that points straight away from the eye.
const MIN_OPACITY: f32 = 0.45;

/// The strokes of the letters x, y, z, within ±1.
const LETTER_STROKES: [&[[[f32; 2]; 2]]; 3] = [
    &[[[-0.75, -1.0], [0.75, 1.0]], [[-0.75, 1.0], [0.75, -1.0]]],
    &[[[-0.75, 1.0], [0.0, 0.0]], [[0.75, 1.0], [0.0, 0.0]], [[0.0, 0.0], [0.0, -1.0]]],
    &[[[-0.7, 1.0], [0.7, 1.0]], [[0.7, 1.0], [-0.7, -1.0]], [[-0.7, -1.0], [0.7, -1.0]]],
];
/// Half the height of a letter, pixels.
const HALF_LETTER: f32 = 4.0;

/// Returns the cross as this camera sees it.
pub fn axes(camera: &Camera, colors: &OverlayColors) -> Lines {
    let (right, up, forward) = (camera.right(), camera.upward(), camera.forward());
    let mut axes: Vec<(usize, Vec3)> = Vec3::AXES.into_iter().enumerate().collect();
    // The farthest axis first, so that the nearest one covers it.
    axes.sort_by(|(_, a), (_, b)| b.dot(forward).total_cmp(&a.dot(forward)));
    let mut segments = Vec::new();
    for (index, axis) in axes {
        let direction = Vec2::new(axis.dot(right), axis.dot(up));
        let nearness = 0.5 - 0.5 * axis.dot(forward);
        let [r, g, b] = colors.axes[index];
        let color = [r, g, b, MIN_OPACITY + (1.0 - MIN_OPACITY) * nearness];
        let mut line = |from: Vec2, to: Vec2, width: f32| {
            segments.push(Segment::new(from.extend(0.0), to.extend(0.0), color, width));
        };
        line(MIDDLE, MIDDLE + direction * AXIS_LENGTH, 2.5);
        // The letter stands aside of a short axis, so that it does not cover the middle.
        let aside = direction.try_normalize().unwrap_or(Vec2::new(-0.7, -0.7));
        let letter = MIDDLE + direction * AXIS_LENGTH + aside * (LETTER_DISTANCE - AXIS_LENGTH);
        for [from, to] in LETTER_STROKES[index] {
            line(letter + Vec2::from(*from) * HALF_LETTER, letter + Vec2::from(*to) * HALF_LETTER, 1.6);
        }
    }
    Lines { ends: LineEnds::Screen(Arc::new(segments)), tint: Tint::Own, opacity: 1.0, width: 1.0, hidden: 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::{Orbit, Style};

    fn directions(orbit: &Orbit) -> Vec<Vec2> {
        let LineEnds::Screen(segments) = axes(&orbit.camera(), &Style::dark().overlay).ends else {
            panic!("the cross stays in its corner")
        };
        let from_middle = |segment: &&Segment| Vec3::from(segment.ends[0]).distance(MIDDLE.extend(0.0)) < 1e-3;
        segments.iter().filter(from_middle).map(|segment| Vec3::from(segment.ends[1]).truncate() - MIDDLE).collect()
    }

    #[test]
    fn seen_from_the_front_x_is_right_and_y_is_up() {
        let front = Orbit { yaw_rad: 0.0, pitch_rad: 0.0, ..Orbit::default() };
        let [x, y, z] = directions(&front)[..] else { panic!("three axes") };
        assert!(x.distance(Vec2::X * AXIS_LENGTH) < 1e-3 && y.distance(Vec2::Y * AXIS_LENGTH) < 1e-3, "{x} and {y}");
        assert!(z.length() < 1e-3, "z, the nearest and so the last, points at the eye: {z}");
    }

    #[test]
    fn the_cross_turns_with_the_camera_and_stays_within_its_corner() {
        for turn in 0..12_u8 {
            let orbit = Orbit { yaw_rad: f32::from(turn) * 0.5, pitch_rad: 0.4, ..Orbit::default() };
            assert!(directions(&orbit).iter().all(|axis| axis.length() <= AXIS_LENGTH + 1e-3), "turn {turn}");
        }
    }
}
