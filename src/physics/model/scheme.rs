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
