//! Watches the size of the selected body. If an edit or its undo changes the size by far, the eye is suddenly inside the
//! body or too far away to see it.

use super::Running;
use crate::app::hand::Target;

/// A change by at least this factor counts as far.
const MIN_SIZE_FACTOR: f64 = 1.5;

/// The selected body at the last call, and its longest extent at rest then, m.
#[derive(Debug, Default)]
pub struct ChosenSize {
    last: Option<(Target, f64)>,
}

impl ChosenSize {
    /// Notes the selected body. Returns whether it has become larger or smaller by far. While `a_hand_is_at_it`, its size is
    /// not final.
    pub(super) fn follow(&mut self, chosen: Option<(Target, f64)>, a_hand_is_at_it: bool) -> bool {
        let before = self.last.zip(chosen).filter(|((was, _), (is, _))| was == is).map(|((_, size), _)| size);
        if before.is_some() && a_hand_is_at_it {
            return false;
        }
        self.last = chosen;
        before.zip(chosen).is_some_and(|(before, (_, now))| before.max(now) >= MIN_SIZE_FACTOR * before.min(now))
    }
}

/// The selected body, if it is visible, and its size, m.
pub(super) fn size_of_selected(running: Running<'_>, chosen: Option<Target>) -> Option<(Target, f64)> {
    let target = chosen?;
    let Target::Body(id) = target else { return None };
    running.scene.bodies.get(id.0).filter(|body| !body.hidden)?;
    Some((target, running.status.bodies.get(id.0)?.stature.longest_m()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::edit::BodyId;

    const FIRST: Target = Target::Body(BodyId(0));
    const SECOND: Target = Target::Body(BodyId(1));

    #[test]
    fn only_the_same_body_with_another_size_by_far_is_told() {
        let mut size = ChosenSize::default();
        assert!(!size.follow(Some((FIRST, 1.0)), false), "it has just been chosen");
        assert!(!size.follow(Some((FIRST, 1.2)), false), "a little larger");
        assert!(!size.follow(Some((SECOND, 0.1)), false), "another one is smaller");
        assert!(!size.follow(None, false) && !size.follow(Some((FIRST, 1.2)), false), "chosen again");
        assert!(size.follow(Some((FIRST, 0.1)), false), "much smaller");
        assert!(!size.follow(Some((FIRST, 0.1)), false), "once");
        assert!(size.follow(Some((FIRST, 1.2)), false), "and back");
    }

    #[test]
    fn what_is_dragged_is_told_when_it_is_let_go() {
        let mut size = ChosenSize::default();
        size.follow(Some((FIRST, 1.0)), false);
        assert!([1.3, 1.7, 2.2].iter().all(|now| !size.follow(Some((FIRST, *now)), true)), "the hand is at it");
        assert!(size.follow(Some((FIRST, 2.2)), false), "let go");
    }
}
