//! Finds the parts of the panels that look different from before: only they are drawn again. Most of the time that is a
//! number or a button, a hundredth of the window.

use egui::Rect;
use egui::epaint::ClippedShape;

/// How many shapes two lists are searched ahead for the place where they agree again.
const LOOK_AHEAD: usize = 48;
/// The most parts that are drawn one by one: each part walks all shapes.
const MAX_PARTS: usize = 6;
/// Two parts are drawn as one if their common rectangle is no more than this many times their summed area.
const MAX_AREA_RATIO: f32 = 1.3;

/// The difference between two pictures of the panels, as rectangles of whole pixels that do not overlap, in points.
pub(super) fn damage(before: &[ClippedShape], after: &[ClippedShape], pixels_per_point: f32) -> Vec<Rect> {
    let whole = |rect: Rect| {
        let [min, max] = [rect.min * pixels_per_point, rect.max * pixels_per_point];
        Rect { min: min.floor() / pixels_per_point, max: max.ceil() / pixels_per_point }
    };
    let mut parts = Vec::new();
    let (mut before, mut after) = (before, after);
    loop {
        let same = before.iter().zip(after).take_while(|(old, new)| old == new).count();
        (before, after) = (&before[same..], &after[same..]);
        if before.is_empty() && after.is_empty() {
            return parts;
        }
        let (gone, come) = next_agreement(before, after);
        for shape in before[..gone].iter().chain(&after[..come]) {
            add(&mut parts, whole(extent(shape)));
        }
        (before, after) = (&before[gone..], &after[come..]);
    }
}

/// The `shapes` to draw again so that `parts` look right: each shape once for each part that it touches.
pub(super) fn within(shapes: &[ClippedShape], parts: &[Rect]) -> Vec<ClippedShape> {
    let touching = |part: &Rect| {
        let part = *part;
        shapes
            .iter()
            .filter(move |shape| has_area(extent(shape).intersect(part)))
            .map(move |shape| ClippedShape { clip_rect: shape.clip_rect.intersect(part), ..shape.clone() })
    };
    parts.iter().flat_map(touching).collect()
}

/// The number of shapes of each list to skip until the lists agree again, or end.
fn next_agreement(before: &[ClippedShape], after: &[ClippedShape]) -> (usize, usize) {
    for skipped in 1..=2 * LOOK_AHEAD {
        // The most common change is that of a shape in its place, so equal numbers of skipped and new shapes are tried
        // first.
        let mut ways: Vec<usize> = (0..=skipped).collect();
        ways.sort_by_key(|gone| (2 * gone).abs_diff(skipped));
        for gone in ways {
            let come = skipped - gone;
            if before.get(gone).is_some_and(|old| after.get(come) == Some(old)) {
                return (gone, come);
            }
        }
    }
    (before.len(), after.len())
}

/// The rectangle that a shape covers on the screen. Antialiasing reaches half a pixel further.
fn extent(shape: &ClippedShape) -> Rect {
    let own = shape.shape.visual_bounding_rect().expand(1.0);
    (shape.transform_after_tessellation * own).intersect(shape.clip_rect)
}

fn has_area(rect: Rect) -> bool {
    rect.is_positive()
}

/// Adds a rectangle to a list, so that none of the list overlap.
fn add(parts: &mut Vec<Rect>, mut rect: Rect) {
    if !has_area(rect) {
        return;
    }
    // Every round removes one part.
    while let Some(other) = partner(parts, rect) {
        rect = rect.union(parts.swap_remove(other));
    }
    parts.push(rect);
}

/// The part to draw together with `rect`, if there is one: a part that it overlaps or is close to, or any part if there are
/// too many.
fn partner(parts: &[Rect], rect: Rect) -> Option<usize> {
    let waste = |part: &Rect| part.union(rect).area() / (part.area() + rect.area());
    let close = parts.iter().position(|part| has_area(part.intersect(rect)) || waste(part) <= MAX_AREA_RATIO);
    let least = || (0..parts.len()).min_by(|&a, &b| waste(&parts[a]).total_cmp(&waste(&parts[b])));
    close.or_else(|| if parts.len() >= MAX_PARTS { least() } else { None })
}

#[cfg(test)]
mod tests {
    use egui::{Color32, Pos2, Shape, Vec2};

    use super::*;

    fn square(x: f32, y: f32, color: Color32) -> ClippedShape {
        let rect = Rect::from_min_size(Pos2::new(x, y), Vec2::splat(10.0));
        ClippedShape::new(Rect::from_min_size(Pos2::ZERO, Vec2::splat(1000.0)), Shape::rect_filled(rect, 0, color))
    }

    /// A row of squares.
    fn row(count: u8) -> Vec<ClippedShape> {
        (0..count).map(|index| square(f32::from(index) * 50.0, 0.0, Color32::from_gray(index))).collect()
    }

    fn covers(parts: &[Rect], x: f32) -> bool {
        parts.iter().any(|part| part.contains_rect(Rect::from_min_size(Pos2::new(x, 0.0), Vec2::splat(10.0))))
    }

    #[test]
    fn the_same_panels_have_no_damage() {
        assert!(damage(&row(5), &row(5), 1.0).is_empty());
    }

    #[test]
    fn a_shape_that_changed_is_drawn_again_and_nothing_else() {
        let mut after = row(20);
        after[3] = square(150.0, 0.0, Color32::RED);
        let parts = damage(&row(20), &after, 1.0);
        assert_eq!(parts.len(), 1);
        assert!(covers(&parts, 150.0) && parts[0].width() < 15.0, "{parts:?}");
        let again = within(&after, &parts);
        assert_eq!(again.len(), 1, "only the one that changed is there");
        assert_eq!(again[0].clip_rect, parts[0]);
    }

    #[test]
    fn a_shape_that_moved_is_drawn_where_it_was_and_where_it_is() {
        let mut after = row(20);
        after[3] = square(800.0, 0.0, Color32::from_gray(3));
        let parts = damage(&row(20), &after, 1.0);
        assert!(covers(&parts, 150.0) && covers(&parts, 800.0), "{parts:?}");
        assert!(!covers(&parts, 500.0), "and not between: {parts:?}");
    }

    #[test]
    fn shapes_that_come_and_go_leave_the_others_alone() {
        for (gone, come) in [(0, 3), (3, 0), (2, 5)] {
            let mut after = row(20);
            after.splice(4..4 + gone, (0..come).map(|_| square(900.0, 0.0, Color32::GREEN)));
            let parts = damage(&row(20), &after, 1.0);
            assert!(!covers(&parts, 0.0) && !covers(&parts, 500.0), "-{gone} +{come}: {parts:?}");
            assert_eq!(covers(&parts, 900.0), come > 0);
            assert_eq!(covers(&parts, 200.0), gone > 0);
        }
    }

    #[test]
    fn shapes_that_change_their_order_are_drawn_again() {
        let mut after = row(20);
        after.swap(2, 3);
        let parts = damage(&row(20), &after, 1.0);
        assert!(covers(&parts, 100.0) || covers(&parts, 150.0), "one of them lies over the other now: {parts:?}");
    }

    #[test]
    fn parts_are_few_and_do_not_overlap() {
        let after: Vec<_> = (0..20_u8)
            .map(|index| square(f32::from(index) * 50.0, f32::from(index % 7) * 90.0, Color32::RED))
            .collect();
        let before: Vec<_> = after
            .iter()
            .map(|old| {
                square(old.shape.visual_bounding_rect().min.x, old.shape.visual_bounding_rect().min.y, Color32::BLUE)
            })
            .collect();
        let parts = damage(&before, &after, 1.0);
        assert!(!parts.is_empty() && parts.len() <= MAX_PARTS, "{parts:?}");
        for (index, part) in parts.iter().enumerate() {
            assert!(parts[..index].iter().all(|other| !has_area(other.intersect(*part))), "{parts:?}");
        }
        for shape in &after {
            let covered = parts.iter().any(|part| part.contains_rect(shape.shape.visual_bounding_rect()));
            assert!(covered, "{shape:?} is not drawn again");
        }
    }

    #[test]
    fn what_is_clipped_away_is_no_damage() {
        let hidden = |color| ClippedShape { clip_rect: Rect::NOTHING, ..square(0.0, 0.0, color) };
        assert!(damage(&[hidden(Color32::RED)], &[hidden(Color32::BLUE)], 1.0).is_empty());
    }
}
