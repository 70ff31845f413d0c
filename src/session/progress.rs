//! How far long work on another thread is, and whether anyone still wants it.

use std::sync::atomic::{AtomicBool, AtomicU32, AtomicUsize, Ordering};

use crate::geometry::Watch;

/// How far work on another thread is, and whether it is still wanted.
#[derive(Debug, Default)]
pub struct Progress {
    permille: AtomicU32,
    particles: AtomicUsize,
    cancelled: AtomicBool,
}

impl Progress {
    /// How far the work is, 0..1.
    pub fn fraction(&self) -> f32 {
        self.permille.load(Ordering::Relaxed) as f32 / 1000.0
    }

    /// How many particles there will be, once that is known; 0 before.
    pub fn particles(&self) -> usize {
        self.particles.load(Ordering::Relaxed)
    }

    /// Asks the work to stop; it does soon.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// Whether the work is no longer wanted.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }
}

impl Watch for Progress {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of a thousand")]
    fn progress(&self, fraction: f64) {
        self.permille.store((fraction.clamp(0.0, 1.0) * 1000.0) as u32, Ordering::Relaxed);
    }

    fn expect_particles(&self, count: usize) {
        self.particles.store(count, Ordering::Relaxed);
    }

    fn cancelled(&self) -> bool {
        self.is_cancelled()
    }
}
