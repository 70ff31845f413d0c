//! Places the eye so that something is seen whole, in the part of the picture that nothing covers and from above the floor.

use glam::{Vec2, Vec3};

use super::Orbit;
use crate::math::Aabb;

/// Air left around what is framed, as a factor on its size.
const MARGIN: f32 = 1.12;
/// How near to the floor the eye may come, as a fraction of its distance to the target.
const MIN_FLOOR_CLEARANCE: f32 = 0.02;

/// The part of a picture that nothing covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SafeArea {
    /// Its left and lower edges, in half pictures from the middle: −1 is the picture's own edge.
    pub min: Vec2,
    /// Its right and upper edges; 1 is the picture's own edge.
    pub max: Vec2,
    /// Width over height of the whole picture.
    pub aspect: f32,
}

impl SafeArea {
    /// The whole of a picture.
    pub fn whole(aspect: f32) -> Self {
        Self { min: Vec2::NEG_ONE, max: Vec2::ONE, aspect }
    }

    /// Its middle, in half pictures from the middle of the picture.
    pub fn center(&self) -> Vec2 {
        0.5 * (self.min + self.max)
    }

    /// The slopes of the lines of sight to its edges, for an eye with this field of view.
    fn slopes(&self, fov_rad: f32) -> [Vec2; 2] {
        let half_height = (0.5 * fov_rad).tan();
        let scale = Vec2::new(half_height * self.aspect, half_height);
        [self.min * scale, self.max * scale]
    }

    /// The same area with a margin at its edges.
    fn with_margin(&self) -> Self {
        let half = (self.max - self.min) * (0.5 / MARGIN);
        Self { min: self.center() - half, max: self.center() + half, ..*self }
    }
}

/// The corners of a box as the camera sees them: their offsets to the right, up and ahead of a point, m.
fn corners(orbit: &Orbit, bounds: Aabb<f32>, from: Vec3) -> [Vec3; 8] {
    let camera = orbit.camera();
    let (right, up, forward) = (camera.right(), camera.upward(), camera.forward());
    std::array::from_fn(|corner| {
        let high = |bit: usize| corner >> bit & 1 == 1;
        let place = Vec3::select(glam::BVec3::new(high(0), high(1), high(2)), bounds.max, bounds.min) - from;
        Vec3::new(place.dot(right), place.dot(up), place.dot(forward))
    })
}

fn is_finite_box(bounds: Aabb<f32>) -> bool {
    bounds.size().is_finite() && bounds.center().is_finite() && bounds.min.cmple(bounds.max).all()
}

impl Orbit {
    /// Moves the eye so that the box fills the area. The angles stay. An empty or infinite box changes nothing.
    ///
    /// A corner x to the right and z ahead is inside if `l (z − e) ≤ x − eₓ ≤ r (z − e)`, for an eye at (eₓ, e) and the
    /// slopes l and r of the area's left and right edges; the same holds upward. The nearest eye with all corners inside is
    /// found axis by axis.
    pub fn frame(&mut self, bounds: Aabb<f32>, area: SafeArea) {
        if !is_finite_box(bounds) {
            return;
        }
        let middle = bounds.center();
        let corners = corners(self, bounds, middle);
        let [low, high] = area.with_margin().slopes(self.clamped().fov_rad);
        let mut ahead = f32::INFINITY;
        let (mut least, mut most) = (Vec2::ZERO, Vec2::ZERO);
        for axis in 0..2 {
            let over = |slope: f32| corners.iter().map(move |corner| corner[axis] - slope * corner.z);
            least[axis] = over(high[axis]).fold(f32::NEG_INFINITY, f32::max);
            most[axis] = over(low[axis]).fold(f32::INFINITY, f32::min);
            ahead = ahead.min((most[axis] - least[axis]) / (high[axis] - low[axis]));
        }
        if !ahead.is_finite() {
            return;
        }
        let aside = 0.5 * (least + most + (low + high) * ahead);
        let camera = self.camera();
        self.target = middle + camera.right() * aside.x + camera.upward() * aside.y;
        self.distance = -ahead;
        *self = self.clamped();
    }

    /// Frames the box as [`Orbit::frame`] does, with the eye above the floor, if there is one.
    pub fn frame_above(&mut self, floor: Option<f32>, bounds: Aabb<f32>, area: SafeArea) {
        self.frame(bounds, area);
        if floor.is_some_and(|floor| self.rise_above(floor)) {
            // From the new direction, other corners of the box stand out.
            self.frame(bounds, area);
        }
    }

    /// Whether all of a box is in the area: true for an empty box, false for an infinite one.
    pub fn shows(&self, bounds: Aabb<f32>, area: SafeArea) -> bool {
        if bounds.min.cmpgt(bounds.max).any() {
            return true;
        }
        let [low, high] = area.slopes(self.clamped().fov_rad);
        let corners = corners(self, bounds, self.camera().eye);
        corners.iter().all(|corner| {
            let seen = corner.truncate() / corner.z;
            corner.z > 0.0 && seen.cmpge(low).all() && seen.cmple(high).all()
        })
    }

    /// Moves the eye away from the target until all of a box is in the area, if it is not. The target and the angles stay,
    /// so that everything seen before stays in sight.
    pub fn pull_back(&mut self, bounds: Aabb<f32>, area: SafeArea) {
        if !is_finite_box(bounds) || self.shows(bounds, area) {
            return;
        }
        let [low, high] = area.with_margin().slopes(self.clamped().fov_rad);
        let needed = corners(self, bounds, self.target).map(|corner| {
            let along = |axis: usize| corner[axis] / if corner[axis] > 0.0 { high[axis] } else { low[axis] };
            along(0).max(along(1)) - corner.z
        });
        let farthest = needed.into_iter().fold(self.distance, f32::max);
        if low.max_element() < 0.0 && high.min_element() > 0.0 {
            self.distance = farthest;
            *self = self.clamped();
        } else {
            // The middle of the picture is covered: no distance helps.
            self.frame(bounds, area);
        }
    }

    /// Keeps the eye above a floor after a move, if it was above the floor `before`. A turn stops at the floor; any other
    /// move slides along it.
    pub fn stay_above(&mut self, floor: f32, before: &Self) {
        if before.camera().eye.y < floor {
            return;
        }
        let turned = before.target == self.target && before.distance.to_bits() == self.distance.to_bits();
        if turned && before.pitch_rad > self.pitch_rad && self.target.y >= floor {
            self.rise_above(floor);
        } else {
            self.target.y += (self.min_eye_height(floor) - self.camera().eye.y).max(0.0);
            *self = self.clamped();
        }
    }

    /// Turns an eye below a floor up above it, if the target is above the floor. Returns whether the eye was below.
    pub fn rise_above(&mut self, floor: f32) -> bool {
        let sine = (self.min_eye_height(floor) - self.target.y) / self.distance;
        let below = self.target.y >= floor && self.pitch_rad.sin() < sine;
        if below {
            self.pitch_rad = sine.asin();
            *self = self.clamped();
        }
        below
    }

    /// The height at which the eye is clear of a floor, m.
    fn min_eye_height(&self, floor: f32) -> f32 {
        floor + MIN_FLOOR_CLEARANCE * self.distance
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: Vec2 = Vec2::new(760.0, 690.0);
    const ASPECT: f32 = SIZE.x / SIZE.y;

    fn bounds() -> Aabb<f32> {
        Aabb::around([Vec3::new(-1.0, 0.0, -3.0), Vec3::new(2.0, 5.0, 1.0)])
    }

    /// Where the box ends in the picture, in half pictures from its middle.
    fn extent(orbit: &Orbit, bounds: Aabb<f32>, aspect: f32) -> [Vec2; 2] {
        let size = Vec2::new(800.0 * aspect, 800.0);
        let corner = |corner: usize| {
            let pick = |bit: usize, low: f32, high: f32| if corner >> bit & 1 == 0 { low } else { high };
            let (a, b) = (bounds.min, bounds.max);
            let point = Vec3::new(pick(0, a.x, b.x), pick(1, a.y, b.y), pick(2, a.z, b.z));
            let seen = orbit.camera().pixel_of(point, size).expect("in front of the eye");
            (seen - size * 0.5) / (size * 0.5) * Vec2::new(1.0, -1.0)
        };
        let seen: [Vec2; 8] = std::array::from_fn(corner);
        let (least, most) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        [seen.iter().fold(least, |low, at| low.min(*at)), seen.iter().fold(most, |high, at| high.max(*at))]
    }

    #[test]
    fn a_framed_box_fits_in_the_area_and_nearly_fills_it() {
        let under_a_card = SafeArea { max: Vec2::new(0.8, 0.2), ..SafeArea::whole(ASPECT) };
        for area in [SafeArea::whole(0.5), SafeArea::whole(1.6), under_a_card] {
            for pitch_rad in [-1.0, 0.3, 1.5] {
                let mut orbit = Orbit { pitch_rad, ..Orbit::default() };
                orbit.frame(bounds(), area);
                let [low, high] = extent(&orbit, bounds(), area.aspect);
                assert!(orbit.shows(bounds(), area), "{low} … {high} lies in {area:?}");
                assert!(low.cmpge(area.min).all() && high.cmple(area.max).all(), "{low} … {high} lies in {area:?}");
                let filled = ((high - low) / (area.max - area.min)).max_element();
                assert!(filled > 0.85, "and fills it in one direction: {filled}");
                let off = ((low + high) * 0.5 - area.center()).abs();
                // There is as much air on either side in metres, which is not quite as much in the picture.
                assert!(off.max_element() < 0.05, "about in the middle of the area: {off}");
            }
        }
    }

    #[test]
    fn what_cannot_be_framed_changes_nothing() {
        let infinite = Aabb { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY };
        for bounds in [Aabb::empty(), infinite] {
            let mut orbit = Orbit::default();
            orbit.frame(bounds, SafeArea::whole(1.0));
            orbit.pull_back(bounds, SafeArea::whole(1.0));
            assert_eq!(orbit, Orbit::default(), "{bounds:?}");
        }
    }

    #[test]
    fn pulling_back_keeps_the_target_and_goes_no_farther_than_it_must() {
        let area = SafeArea { max: Vec2::new(1.0, 0.7), ..SafeArea::whole(ASPECT) };
        let mut orbit = Orbit { distance: 2.0, ..Orbit::default() };
        assert!(!orbit.shows(bounds(), area), "too near to see all of it");
        orbit.pull_back(bounds(), area);
        assert!(orbit.shows(bounds(), area), "now it is seen");
        assert_eq!(orbit.target, Orbit::default().target, "the target stays");
        let again = orbit;
        orbit.pull_back(bounds(), area);
        assert_eq!(orbit, again, "what is seen is left as it is");
        let nearer = Orbit { distance: 0.85 * orbit.distance, ..orbit };
        assert!(!nearer.shows(bounds(), area), "nearer would not do");
    }

    #[test]
    fn a_turn_ends_above_the_floor_and_other_moves_slide_along_it() {
        let before = Orbit::default();
        let mut orbit = before;
        orbit.orbit(0.4, -3.0);
        orbit.stay_above(0.0, &before);
        let eye = orbit.camera().eye.y;
        assert!(eye > 0.0 && eye < 0.2 && orbit.target == before.target, "just above the floor: {eye}");
        let low = orbit;
        orbit.pan(Vec2::new(0.0, -400.0), SIZE.y);
        orbit.stay_above(0.0, &low);
        assert!(orbit.camera().eye.y > 0.0 && (orbit.pitch_rad - low.pitch_rad).abs() < 1e-6, "it slides along");
        let near = orbit;
        orbit.zoom_towards(0.1, Vec3::new(0.0, -1.0, 0.0));
        orbit.stay_above(0.0, &near);
        assert!(orbit.camera().eye.y > 0.0, "nor does the wheel take it through");
    }

    #[test]
    fn an_eye_below_the_floor_turns_up_around_a_target_above_it() {
        let mut orbit = Orbit { target: Vec3::Y, pitch_rad: -0.8, ..Orbit::default() };
        assert!(orbit.rise_above(0.0) && orbit.camera().eye.y > 0.0, "it was below and is above");
        assert_eq!(orbit.target, Vec3::Y, "around the same target");
        assert!(!orbit.rise_above(0.0), "once");
        let below = Orbit { target: Vec3::NEG_Y, pitch_rad: -0.8, ..orbit };
        let mut orbit = below;
        assert!(!orbit.rise_above(0.0) && orbit == below, "what is below the floor is looked at from there");
    }

    #[test]
    fn an_eye_that_was_below_the_floor_may_stay_there() {
        let before = Orbit { target: Vec3::new(0.0, -3.0, 0.0), pitch_rad: 0.0, ..Orbit::default() };
        let mut orbit = before;
        orbit.orbit(0.1, -0.2);
        let moved = orbit;
        orbit.stay_above(0.0, &before);
        assert_eq!(orbit, moved, "a scene below its floor can be looked at");
    }
}
