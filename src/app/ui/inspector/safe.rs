//! Bounds on the values of a body's materials up to which no step has to be divided, for their sliders.

use crate::app::ui::value::Bound;
use crate::scene::param;
use crate::session::SafeValue;

/// The safe bounds on the values of a body's materials.
#[derive(Clone, Copy)]
pub(super) struct SafeBounds<'a>(&'a [SafeValue]);

impl<'a> SafeBounds<'a> {
    pub(super) fn of(values: &'a [SafeValue]) -> Self {
        Self(values)
    }

    /// The bound of a value. `None` if its whole range is safe, or none of it: then another value is to blame, and that
    /// one's track shows the bound.
    pub(super) fn bound(self, path: &str) -> Option<Bound> {
        let below_body = path.splitn(3, '.').nth(2)?;
        let safe = self.0.iter().find(|safe| safe.is_at(below_body))?;
        let Some(param::Kind::Number { min, max }) = param::find(path).map(|param| param.kind) else { return None };
        let bound = safe.bound?;
        if safe.is_smallest {
            (bound > min && bound.is_finite()).then_some(Bound::AtLeast(bound))
        } else {
            (bound > 0.0 && bound < max).then_some(Bound::AtMost(bound))
        }
    }
}
