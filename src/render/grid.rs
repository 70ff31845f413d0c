//! The lines on floors: their spacing, width and strength, which change smoothly as the eye comes nearer.
//!
//! ```text
//! eye at      1 m            3 m            10 m            30 m
//! lines of    10 cm ━━━━━━━━ 10 cm ──────── 10 cm ········  –
//!             1 m   ━━━━━━━━ 1 m   ━━━━━━━━ 1 m   ━━━━━━━━  1 m ────────
//! ```

use crate::view::Camera;

/// Levels of lines, each ten times as far apart as the one before. Two levels are clearly visible, the third fades in or
/// out.
pub(super) const LEVELS: usize = 3;
/// The strength of fine lines that have faded in fully, as a share of the strength of strong ones.
const FINE_STRENGTH: f32 = 0.4;
/// Distance of the eye, m, at which the lines of a metre are the strong ones and those of a decimetre have faded in fully.
const METRE_GRID_DISTANCE: f32 = 3.0;
/// Width of a line at the point looked at, pixels.
const WIDTH_PIXELS: f32 = 1.3;

/// The lines on floors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Grid {
    /// Distance between the finest lines, m.
    pub(super) spacing: f32,
    /// Width of every line, m.
    pub(super) width: f32,
    /// Strength of the lines of each level, the finest first, 0..1.
    pub(super) strengths: [f32; LEVELS],
}

impl Grid {
    /// The lines for a picture `height` pixels high.
    pub(super) fn new(camera: &Camera, height: f32) -> Self {
        let distance = camera.distance();
        let decades = (distance / METRE_GRID_DISTANCE).log10();
        let (whole, part) = (decades.floor(), decades - decades.floor());
        let fading = FINE_STRENGTH * (1.0 - part);
        Self {
            spacing: 10_f32.powf(whole - 1.0),
            width: WIDTH_PIXELS * 2.0 * (0.5 * camera.fov_rad).tan() * distance / height.max(1.0),
            strengths: [fading, 1.0 + (FINE_STRENGTH - 1.0) * part, 1.0],
        }
    }

    /// Strength of the lines with this spacing; 0 if there are none.
    #[cfg(test)]
    fn strength(&self, spacing: f32) -> f32 {
        let levels = (0..).zip(self.strengths).map(|(level, strength)| (self.spacing * 10_f32.powi(level), strength));
        let found = levels.filter(|(finest, _)| (spacing / finest - 1.0).abs() < 1e-3).map(|(_, strength)| strength);
        let coarser = if spacing > 50.0 * self.spacing { 1.0 } else { 0.0 };
        found.fold(coarser, f32::max)
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    fn seen_from(distance: f32) -> Grid {
        let camera = Camera { eye: Vec3::new(0.0, 0.6, 0.8) * distance, target: Vec3::ZERO, ..Camera::default() };
        Grid::new(&camera, 700.0)
    }

    #[test]
    fn strong_lines_are_a_metre_apart_seen_from_a_few_metres() {
        for (distance, spacing) in [(5.0, 1.0), (29.0, 1.0), (50.0, 10.0), (0.5, 0.1)] {
            let grid = seen_from(distance);
            assert!(
                grid.strength(spacing) >= FINE_STRENGTH && grid.strength(10.0 * spacing) > 0.99,
                "from {distance} m: {grid:?}"
            );
            assert!(
                grid.strength(0.1 * spacing) <= FINE_STRENGTH,
                "finer lines are fainter, from {distance} m: {grid:?}"
            );
        }
    }

    #[test]
    fn lines_come_and_go_without_a_jump() {
        let distances: Vec<f32> = (0..4000_u16).map(|step| 0.01 * 1.003_f32.powf(f32::from(step))).collect();
        for pair in distances.windows(2) {
            let [before, after] = [seen_from(pair[0]), seen_from(pair[1])];
            for decade in -4..6 {
                let spacing = 10_f32.powi(decade);
                let change = (after.strength(spacing) - before.strength(spacing)).abs();
                assert!(change < 0.01, "lines of {spacing} m change by {change} from {} m to {} m", pair[0], pair[1]);
            }
        }
    }
}
