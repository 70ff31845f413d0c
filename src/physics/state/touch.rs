//! Where points of bodies' meshes and of free modal bodies touch obstacles, as the state has it.

/// A point of a body's mesh, or any of a free modal body, that touches an obstacle: on which side, and how far the spring between
/// them is pressed. As with [`super::press::Press`] it is the motion that presses it, not the place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleTouch {
    /// The body.
    pub body: usize,
    /// The point, by its number in the body.
    pub sample: usize,
    /// The obstacle.
    pub obstacle: usize,
    /// The side of a plane or an open mesh that it came from, +1 or −1 along the normal; 0 where the obstacle has an inside.
    pub side: i8,
    /// How far the spring is pressed together, m; no less than nothing.
    pub depth_m: f64,
}

impl SampleTouch {
    /// They are in this order.
    pub(in crate::physics) fn place(&self) -> (usize, usize, usize) {
        (self.body, self.sample, self.obstacle)
    }
}
