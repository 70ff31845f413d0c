//! Random numbers in the forms that random scenes need.

use crate::math::rng::Rng;

/// Draws one value after another.
pub(super) struct RandomSource(pub(super) Rng);

impl RandomSource {
    pub(super) fn chance(&mut self, share: f64) -> bool {
        self.0.unit() < share
    }

    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0.between(low, high)
    }

    /// Uniform in the logarithm, from 10^`low` to 10^`high`.
    pub(super) fn log_uniform(&mut self, low: f64, high: f64) -> f64 {
        libm::exp10(self.0.between(low, high)).clamp(libm::exp10(low), libm::exp10(high))
    }

    pub(super) fn integer(&mut self, low: i32, high: i32) -> i32 {
        #[expect(clippy::cast_possible_truncation, reason = "it lies between two i32")]
        let drawn = libm::floor(self.0.between(f64::from(low), f64::from(high) + 1.0)) as i32;
        drawn.min(high)
    }

    pub(super) fn one_of<T: Copy>(&mut self, choices: &[T]) -> T {
        #[expect(clippy::cast_possible_truncation, reason = "smaller than the number of choices")]
        let place = (self.0.next_u64() % choices.len() as u64) as usize;
        choices[place]
    }

    pub(super) fn vector(&mut self, reach: f64) -> [f64; 3] {
        [0; 3].map(|_| self.between(-reach, reach))
    }

    /// A unit vector.
    pub(super) fn direction(&mut self) -> [f64; 3] {
        loop {
            let drawn = self.vector(1.0);
            let length = drawn.iter().map(|x| x * x).sum::<f64>().sqrt();
            if (0.1..=1.0).contains(&length) {
                return drawn.map(|x| x / length);
            }
        }
    }
}
