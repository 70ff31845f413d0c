//! The width of the vector instructions that a kernel uses, chosen while the program runs.

use std::sync::OnceLock;

/// A set of vector instructions. All of them give the same bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SimdLevel {
    /// The instructions that every machine of the architecture has.
    Portable,
    /// AVX2: 8 numbers of single precision at a time.
    Avx2,
    /// AVX-512, as far as Ice Lake and Zen 4 have it: 16 numbers of single precision at a time.
    Avx512,
}

/// The level of new plans: the best of the machine if none was chosen.
static CHOSEN: OnceLock<SimdLevel> = OnceLock::new();

impl SimdLevel {
    /// All levels, narrowest first.
    pub const ALL: [Self; 3] = [Self::Portable, Self::Avx2, Self::Avx512];

    /// Returns the level's name on the command line and in figures.
    pub fn name(self) -> &'static str {
        match self {
            Self::Portable => "portable",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    /// Whether the machine supports this level.
    pub fn is_available(self) -> bool {
        match self {
            Self::Portable => true,
            Self::Avx2 => x86::has_avx2(),
            Self::Avx512 => x86::has_avx512(),
        }
    }

    /// Returns the widest level that the machine supports.
    pub fn best() -> Self {
        Self::ALL.into_iter().rev().find(|level| level.is_available()).unwrap_or(Self::Portable)
    }

    /// Returns the level of new plans.
    pub fn chosen() -> Self {
        *CHOSEN.get_or_init(Self::best)
    }

    /// Makes every plan from now on use this level. Returns whether it does: the first choice of a process is final, and a
    /// level that the machine lacks cannot be chosen.
    #[must_use]
    pub fn choose(self) -> bool {
        self.is_available() && *CHOSEN.get_or_init(|| self) == self
    }

    /// Runs `work`, compiled for this level if `work` is inlined. A machine that lacks the level runs it with the
    /// instructions that every machine has.
    #[inline(always)]
    pub fn run<T>(self, work: impl FnOnce() -> T) -> T {
        match self {
            Self::Portable => run_portable(work),
            Self::Avx2 => x86::run_avx2(work),
            Self::Avx512 => x86::run_avx512(work),
        }
    }
}

/// A separate function, as at the other levels: inlined into a larger one, loops are not vectorised.
#[inline(never)]
fn run_portable<T>(work: impl FnOnce() -> T) -> T {
    work()
}

/// The levels of x86 processors.
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
mod x86 {
    use fearless_simd::{Level, Simd};

    pub(super) fn has_avx2() -> bool {
        Level::new().as_avx2().is_some()
    }

    pub(super) fn has_avx512() -> bool {
        Level::new().as_avx512().is_some()
    }

    #[inline(always)]
    pub(super) fn run_avx2<T>(work: impl FnOnce() -> T) -> T {
        match Level::new().as_avx2() {
            Some(avx2) => avx2.vectorize(work),
            None => work(),
        }
    }

    #[inline(always)]
    pub(super) fn run_avx512<T>(work: impl FnOnce() -> T) -> T {
        match Level::new().as_avx512() {
            Some(avx512) => avx512.vectorize(work),
            None => work(),
        }
    }
}

/// Other processors support none of these levels.
#[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
mod x86 {
    pub(super) fn has_avx2() -> bool {
        false
    }

    pub(super) fn has_avx512() -> bool {
        false
    }

    pub(super) fn run_avx2<T>(work: impl FnOnce() -> T) -> T {
        work()
    }

    pub(super) fn run_avx512<T>(work: impl FnOnce() -> T) -> T {
        work()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_level_is_one_that_the_machine_has() {
        assert!(SimdLevel::Portable.is_available(), "every machine has it");
        assert!(SimdLevel::best().is_available());
        let wider = SimdLevel::ALL.into_iter().filter(|level| *level > SimdLevel::best());
        assert!(wider.into_iter().all(|level| !level.is_available()), "there is no wider one");
    }

    #[test]
    fn work_is_done_at_every_level() {
        for level in SimdLevel::ALL {
            assert_eq!(level.run(|| 6 * 7), 42, "{}", level.name());
        }
    }
}
