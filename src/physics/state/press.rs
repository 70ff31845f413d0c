//! How far bodies have pressed each other's contact springs, as the state has it.

/// A spring between a particle and another body. It is pressed by what moves the two together while it is there, not by
/// where they are: what finds itself deep inside another body has not pressed anything.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Press {
    /// The body of the particle, and the one that it is in.
    pub bodies: [usize; 2],
    /// The particle, in the state's arrays.
    pub particle: usize,
    /// How far it is pressed together, m; no less than nothing.
    pub depth_m: f64,
}

impl Press {
    /// They are in this order.
    pub(in crate::physics) fn place(&self) -> (usize, usize) {
        (self.particle, self.bodies[1])
    }
}
