//! The time integration schemes; [`crate::physics::schemes`] has their formulas.

/// The scheme that advances a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// Semi-implicit Euler (GC §4.1).
    SemiImplicit,
    /// Explicit Euler (GC §4.1).
    Explicit,
    /// Leapfrog Verlet with the velocity of the damping predicted.
    Verlet,
    /// Runge–Kutta of second order (midpoint).
    Rk2,
    /// The classical Runge–Kutta method of fourth order.
    Rk4,
    /// Runge–Kutta–Chebyshev of second order, with as many stages as the damping needs.
    Stabilised,
    /// Linearly implicit Euler.
    Implicit,
}

impl Scheme {
    /// Whether it leaves substeps in which a body comes near an obstacle or another body, or a hand pulls, to semi-implicit
    /// Euler: the schemes of Runge and Kutta do. Contact holds a particle by one impulse on its velocity, and what follows it
    /// through the stages does not hold it. If it keeps to that velocity while its neighbours move on with the means of the
    /// stages, links give momentum that nothing takes; if it does not, contact loses its damping. The thesis's rule is a force
    /// as any other and stays in the stages.
    pub(in crate::physics) fn leaves_contact(self) -> bool {
        matches!(self, Self::Rk2 | Self::Rk4)
    }
}
