//! Touches of obstacles by points of bodies' meshes and of free modal bodies, as the state remembers them.

/// A point of a body's mesh, or of a free modal body, that touches an obstacle: on which side, and how far the contact
/// spring is pressed. As with [`super::press::Press`] the motion presses it, not the position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleTouch {
    /// The body.
    pub body: usize,
    /// The point, by its number in the body; from 2³⁰ on points on the edges of the obstacle.
    pub sample: usize,
    /// The obstacle.
    pub obstacle: usize,
    /// The side of a plane or an open mesh that it came from, +1 or −1 along the normal; 0 where the obstacle has an inside.
    pub side: i8,
    /// How far the spring is pressed together, m; no less than nothing.
    pub depth_m: f64,
}

impl SampleTouch {
    /// The key that touches are sorted by.
    pub(in crate::physics) fn place(&self) -> (usize, usize, usize) {
        (self.body, self.sample, self.obstacle)
    }
}
