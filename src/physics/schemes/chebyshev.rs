//! The polynomials of the stabilised scheme: Runge–Kutta–Chebyshev of second order (Sommeijer, Shampine and Verwer, "RKC:
//! an explicit solver for parabolic PDEs", J. Comput. Appl. Math. 88, 1997).
//!
//! With Chebyshev's polynomials `T_j` of the first kind, `w0 = 1 + ε/s²`, `w1 = T_s'(w0)/T_s''(w0)`, `b_j = T_j''/(T_j')²`
//! and `a_j = 1 − b_j T_j`, all at w0, s stages multiply a solution of `y' = λ y` in a step h by
//!
//! ```text
//! P_s(z) = a_s + b_s T_s(w0 + w1 z),   z = h λ,   |P_s| ≤ 1 for −β ≤ z ≤ 0,   β = (1 + w0)/w1 ≈ 0.65 s²
//! ```

/// ε: how much the polynomials are damped.
const DAMPING: f64 = 2.0 / 13.0;

/// The fewest stages: with fewer, a step divided by its stages is no longer than a step of semi-implicit Euler.
pub(in crate::physics) const MIN_STAGES: u32 = 4;

/// The most stages.
pub(in crate::physics) const MAX_STAGES: u32 = 16;

/// The radius of the largest disc that lies within the stability region and touches its end at 0, for any number of stages
/// that is used.
pub(in crate::physics) const DISC_RADIUS: f64 = 2.0;

/// A polynomial `T_j` and its first two derivatives at w0.
#[derive(Clone, Copy, Debug)]
struct Chebyshev {
    value: f64,
    slope: f64,
    curvature: f64,
}

impl Chebyshev {
    /// `T_0` and `T_1`.
    fn first(w0: f64) -> [Self; 2] {
        let constant = Self { value: 1.0, slope: 0.0, curvature: 0.0 };
        [constant, Self { value: w0, slope: 1.0, ..constant }]
    }

    /// `T_j = 2 w T_(j−1) − T_(j−2)`.
    fn next(w0: f64, [before, last]: [Self; 2]) -> Self {
        Self {
            value: 2.0 * w0 * last.value - before.value,
            slope: 2.0 * last.value + 2.0 * w0 * last.slope - before.slope,
            curvature: 4.0 * last.slope + 2.0 * w0 * last.curvature - before.curvature,
        }
    }

    /// `b_j`.
    fn weight(self) -> f64 {
        self.curvature / (self.slope * self.slope)
    }
}

/// The weights of a stage: `y_j − y_0 = last (y_(j−1) − y_0) + before (y_(j−2) − y_0) + h (slope f_(j−1) + first f_0)`.
#[derive(Clone, Copy, Debug)]
pub(super) struct StageWeights {
    pub(super) last: f64,
    pub(super) before: f64,
    pub(super) slope: f64,
    pub(super) first: f64,
}

impl StageWeights {
    /// Returns `y_j − y_0` of one number, from that of the two stages before and the slopes times h.
    pub(super) fn next(&self, before: f64, last: f64, slope: f64, first: f64) -> f64 {
        self.last * last + self.before * before + self.slope * slope + self.first * first
    }
}

/// The stages of a step, one after the other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stages {
    w0: f64,
    w1: f64,
    /// `b_j` of the last two stages.
    weights: [f64; 2],
    polynomials: [Chebyshev; 2],
}

impl Stages {
    /// Returns how far the first of `count` stages goes along the slope at the state, in steps, and the stages that follow.
    pub(super) fn new(count: u32) -> (f64, Self) {
        let (w0, last) = last(count);
        let w1 = last.slope / last.curvature;
        let polynomials = Chebyshev::first(w0);
        let second = Chebyshev::next(w0, polynomials).weight();
        let weights = [second, 1.0 / w0];
        (w1 / w0, Self { w0, w1, weights, polynomials })
    }

    /// Returns the next stage.
    pub(super) fn next(&mut self) -> StageWeights {
        let [before, last] = self.polynomials;
        let polynomial = Chebyshev::next(self.w0, [before, last]);
        let weight = polynomial.weight();
        let [weight_before, weight_last] = self.weights;
        let slope = 2.0 * weight * self.w1 / weight_last;
        let stage = StageWeights {
            last: 2.0 * weight * self.w0 / weight_last,
            before: -weight / weight_before,
            slope,
            first: -(1.0 - weight_last * last.value) * slope,
        };
        self.weights = [weight_last, weight];
        self.polynomials = [last, polynomial];
        stage
    }
}

/// Returns `w0` for `count` stages, and the last polynomial there.
fn last(count: u32) -> (f64, Chebyshev) {
    let w0 = 1.0 + DAMPING / (f64::from(count) * f64::from(count));
    let mut polynomials = Chebyshev::first(w0);
    for _ in 1..count {
        polynomials = [polynomials[1], Chebyshev::next(w0, polynomials)];
    }
    (w0, polynomials[1])
}

/// Returns β: how far along the negative axis this many stages are stable.
pub(in crate::physics) fn reach(stages: u32) -> f64 {
    let (w0, last) = last(stages);
    (1.0 + w0) * last.curvature / last.slope
}

/// Returns the fewest stages that reach this far along the negative axis, or the most there are.
pub(in crate::physics) fn stages_for(along: f64) -> u32 {
    (MIN_STAGES..MAX_STAGES).find(|&stages| reach(stages) >= along).unwrap_or(MAX_STAGES)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A complex number.
    type Complex = [f64; 2];

    fn times(a: Complex, b: Complex) -> Complex {
        [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
    }

    /// Returns the factor that `stages` stages multiply by, stage by stage as a step takes them.
    fn factor(stages: u32, z: Complex) -> f64 {
        let (ahead, mut rest) = Stages::new(stages);
        let [mut before, mut last] = [[0.0; 2], z.map(|part| ahead * part)];
        for _ in 1..stages {
            let stage = rest.next();
            let slope = times(z, [1.0 + last[0], last[1]]);
            let next: Complex = std::array::from_fn(|part| stage.next(before[part], last[part], slope[part], z[part]));
            (before, last) = (last, next);
        }
        (1.0 + last[0]).hypot(last[1])
    }

    #[test]
    fn the_region_of_stability_holds_the_axis_and_the_disc() {
        for stages in MIN_STAGES..=MAX_STAGES {
            let reach = reach(stages);
            for part in 0..=4000 {
                let along = f64::from(part) / 4000.0;
                assert!(factor(stages, [-reach * along, 0.0]) <= 1.0 + 1e-9, "{stages} stages at {along} of {reach}");
                let (sin, cos) = libm::sincos(std::f64::consts::PI * along);
                let on_circle = factor(stages, [DISC_RADIUS * (cos - 1.0), DISC_RADIUS * sin]);
                assert!(on_circle <= 1.0 + 1e-9, "{stages} stages at {along} of the circle: {on_circle}");
            }
            assert!(factor(stages, [-1.3 * reach, 0.0]) > 1.0, "{stages} stages end there");
            assert!(factor(stages, [-2.6 * DISC_RADIUS, 1.3 * DISC_RADIUS]) > 1.0 || stages < 5, "no much larger one");
        }
    }

    #[test]
    fn stages_are_of_second_order() {
        for stages in [MIN_STAGES, 7, MAX_STAGES] {
            let error = |z: f64| (factor(stages, [-z, 0.0]) - (-z).exp()).abs();
            let ratio = error(0.1) / error(0.05);
            assert!((7.0..9.0).contains(&ratio), "{stages} stages: {ratio}");
        }
    }

    #[test]
    fn as_many_stages_as_reach_so_far() {
        assert_eq!(stages_for(1.0), MIN_STAGES);
        assert!(reach(stages_for(50.0)) >= 50.0 && reach(stages_for(50.0) - 1) < 50.0);
        assert_eq!(stages_for(1e9), MAX_STAGES);
    }
}
