//! How wide the panels beside the view are.

use serde::{Deserialize, Serialize};

/// Widths of the list, points: the least, the usual, the greatest.
pub(super) const LIST: [f32; 3] = [150.0, 194.0, 400.0];
/// Widths of the values.
pub(super) const VALUES: [f32; 3] = [316.0, 336.0, 620.0];
/// The fraction of the window's width that the panels may take: the view keeps the rest.
const MAX_PANELS_SHARE: f32 = 0.5;
/// Below this width of the window (points) both panels are on one side.
pub(super) const TWO_SIDES_NEED: f32 = 1100.0;

/// The widths that a person wants for the panels beside the view, points.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Widths {
    /// The list of bodies and obstacles.
    pub list: f32,
    /// The values of the selected thing.
    pub values: f32,
}

impl Default for Widths {
    fn default() -> Self {
        Self { list: LIST[1], values: VALUES[1] }
    }
}

impl Widths {
    /// The nearest allowed widths.
    pub fn allowed(self) -> Self {
        Self { list: self.list.clamp(LIST[0], LIST[2]), values: self.values.clamp(VALUES[0], VALUES[2]) }
    }

    /// The widths in a window of this width, so that the view keeps its share.
    pub(super) fn within(self, window: f32) -> Self {
        let Self { list, values } = self.allowed();
        let room = MAX_PANELS_SHARE * window;
        if window < TWO_SIDES_NEED {
            return Self { list: list.min(room), values: values.min(room).max(VALUES[0]) };
        }
        let values = values.min(room - LIST[1]).max(VALUES[0]);
        Self { list: list.min(room - values).max(LIST[0]), values }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_view_keeps_its_half_of_every_window() {
        for list in LIST {
            for values in VALUES {
                for window in [760.0_f32, 900.0, 1100.0, 1280.0, 1920.0, 3840.0] {
                    let shown = Widths { list, values }.within(window);
                    let taken = if window < TWO_SIDES_NEED { shown.values } else { shown.list + shown.values };
                    assert!(taken <= MAX_PANELS_SHARE * window, "{list} and {values} in {window}: {shown:?}");
                    assert!(shown.list >= LIST[0] && shown.values >= VALUES[0], "nothing is squeezed: {shown:?}");
                }
            }
        }
        let usual = Widths::default();
        assert_eq!(usual.within(1280.0), usual, "there is room for the usual");
    }
}
