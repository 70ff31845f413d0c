//! One mode over a step in which the force stays the same: the exact solution.

/// The effect of a step on an oscillator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Oscillator {
    /// The amplitude after the step for an amplitude of 1 before it, and for a rate of 1, s.
    amplitude: [f64; 2],
    /// The same of the rate, 1/s and without unit.
    rate: [f64; 2],
    /// What a force of 1 adds to amplitude and rate.
    force: [f64; 2],
    /// The share of an impulse that is left in the rate at the end of the step, stiffness and damping of the mode taken
    /// implicitly.
    pub(super) mobility: f64,
}

impl Oscillator {
    /// An oscillator of angular frequency `omega` (1/s) and `damping` (1/s) over `dt` (s).
    pub(super) fn new(omega: f64, damping: f64, dt: f64) -> Self {
        let half = 0.5 * damping;
        let square = omega * omega - half * half;
        let decay = libm::exp(-half * dt);
        // `cosine` and `sine` are e^{−ct/2} cos wt and e^{−ct/2} sin(wt)/w, of a w that may be imaginary.
        let [cosine, sine] = if square.abs() * dt * dt < 1e-12 {
            [decay, decay * dt]
        } else if square > 0.0 {
            let w = square.sqrt();
            [decay * libm::cos(w * dt), decay * libm::sin(w * dt) / w]
        } else {
            // No power is positive, as w is at most half the damping.
            let w = (-square).sqrt();
            let [slow, fast] = [w - half, -w - half].map(|power| libm::exp(power * dt));
            [0.5 * (slow + fast), 0.5 * (slow - fast) / w]
        };
        let stays = cosine + half * sine;
        let pushed = if omega * dt > 1e-4 {
            (1.0 - stays) / (omega * omega)
        } else if damping * dt > 1e-4 {
            (dt - sine) / damping
        } else {
            // The first terms of the series, as the differences above would be rounding.
            0.5 * dt * dt * (1.0 - damping * dt / 3.0)
        };
        let mobility = 1.0 / (1.0 + dt * (damping + dt * omega * omega));
        let rate = [-omega * omega * sine, cosine - half * sine];
        Self { amplitude: [stays, sine], rate, force: [pushed, sine], mobility }
    }

    /// Amplitude and rate after the step, under a force.
    pub(super) fn after(&self, [amplitude, rate]: [f64; 2], force: f64) -> [f64; 2] {
        let end =
            |[of_amplitude, of_rate]: [f64; 2], of_force| of_amplitude * amplitude + of_rate * rate + of_force * force;
        [end(self.amplitude, self.force[0]), end(self.rate, self.force[1])]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same by many small steps of Verlet's scheme.
    fn followed(omega: f64, damping: f64, force: f64, [mut q, mut v]: [f64; 2], secs: f64) -> [f64; 2] {
        let steps = 200_000;
        let dt = secs / f64::from(steps);
        for _ in 0..steps {
            // The middle of the step, with what the damping takes in it solved for.
            let half = q + 0.5 * dt * v;
            v = (v * (1.0 - 0.5 * dt * damping) + dt * (force - omega * omega * half)) / (1.0 + 0.5 * dt * damping);
            q = half + 0.5 * dt * v;
        }
        [q, v]
    }

    #[test]
    fn a_step_of_any_length_is_exact() {
        for (omega, damping) in [(3.0, 0.0), (3.0, 0.4), (3.0, 6.0), (3.0, 40.0), (0.0, 0.0), (0.0, 2.0), (1e-6, 1e-6)]
        {
            for secs in [0.01, 0.7, 5.0] {
                let found = Oscillator::new(omega, damping, secs).after([0.7, -1.1], 2.5);
                let expected = followed(omega, damping, 2.5, [0.7, -1.1], secs);
                for (found, expected) in found.into_iter().zip(expected) {
                    let off = (found - expected).abs();
                    assert!(
                        off < 1e-6 * (1.0 + expected.abs()),
                        "ω {omega}, c {damping}, {secs} s: {found} for {expected}"
                    );
                }
            }
        }
    }

    #[test]
    fn what_is_damped_beyond_measure_stays_finite() {
        for (omega, damping, dt) in [(1e6, 1e12, 10.0), (1e6, 0.0, 10.0), (1e-9, 1e9, 1e3)] {
            let Oscillator { amplitude, rate, force, mobility } = Oscillator::new(omega, damping, dt);
            let all = [amplitude, rate, force, [mobility; 2]];
            assert!(all.iter().flatten().all(|x| x.is_finite()), "ω {omega}, c {damping}");
            assert!(amplitude[0].abs() <= 1.0 + 1e-12, "nothing grows: {}", amplitude[0]);
        }
    }
}
