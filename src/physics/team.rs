//! The threads that take a step together: those of the pool that it is asked for in.
//!
//! Work that can be halved is shared out: the thread that asks does one half, and whoever is free the other, or the same
//! thread where nobody is; each halves its own again while there are threads. Whoever runs a simulation does so within a
//! pool that stays ([`rayon::ThreadPool::install`]); elsewhere one thread does it all. Threads of a pool look for work for
//! some microseconds and sleep then; who takes many steps keeps them awake (`machine::threads`). Nothing is allocated on the
//! way. Work is such that its result does not depend on the halves or on who does them.

use std::ops::Range;
use std::sync::OnceLock;

use crate::machine::threads::{in_pool, join};
use crate::math::Real;
use crate::physics::model::Model;

/// How many threads new plans may use; one where nobody has chosen.
static CHOSEN: OnceLock<usize> = OnceLock::new();

/// Lets every plan made from now on use so many threads. Says whether it does: the first choice of a process holds.
#[must_use]
pub fn choose_step_threads(count: usize) -> bool {
    *CHOSEN.get_or_init(|| count.max(1)) == count.max(1)
}

/// How many threads new plans may use.
pub fn step_threads() -> usize {
    *CHOSEN.get_or_init(|| 1)
}

/// Work that can be shared out.
pub(in crate::physics) trait Halves: Send + Sized {
    /// Into how many pieces it can be taken apart, at least one.
    fn pieces(&self) -> usize;
    /// Two parts of as much work each as can be, where there are pieces enough.
    fn halve(self) -> [Self; 2];
    /// Does it all.
    fn work(self);
}

/// Has some work done by so many threads of the pool, by this one alone where it is of none.
pub(in crate::physics) fn share(threads: usize, work: impl Halves) {
    if threads <= 1 || work.pieces() <= 1 || !in_pool() {
        return work.work();
    }
    let [one, other] = work.halve();
    join(|| share(threads.div_ceil(2), one), || share(threads / 2, other));
}

/// Fewer particles are not shared out: what they take is no longer than it takes to hand them over.
const FEWEST_PARTICLES: usize = 2048;

/// Has what is written of some particles that follow one another worked out part by part: `work` is given the places of a
/// part among them, and its own of each of the slices, which are of one length.
pub(in crate::physics) fn by_part<T: Send, const N: usize>(
    threads: usize,
    to: [&mut [T]; N],
    work: impl Fn(Range<usize>, [&mut [T]; N]) + Sync,
) {
    share(threads, Part { first: 0, to, fewest: FEWEST_PARTICLES, work: &work });
}

/// The same of groups of so many particles.
pub(in crate::physics) fn by_groups<T: Send>(
    threads: usize,
    group: usize,
    to: &mut [T],
    work: impl Fn(Range<usize>, &mut [T]) + Sync,
) {
    let work = |part, [to]: [&mut [T]; 1]| work(part, to);
    share(threads, Part { first: 0, to: [to], fewest: FEWEST_PARTICLES / group, work: &work });
}

/// The same of the bodies of a model, of which there is one each.
pub(in crate::physics) fn by_bodies<R: Real, T: Send>(
    threads: usize,
    model: &Model<R>,
    to: &mut [T],
    work: impl Fn(Range<usize>, &mut [T]) + Sync,
) {
    let mean = model.particle_count() / model.bodies.len().max(1);
    by_groups(threads, mean.clamp(1, FEWEST_PARTICLES), to, work);
}

/// A part of what is written.
struct Part<'a, T, W, const N: usize> {
    first: usize,
    to: [&'a mut [T]; N],
    /// No half is shorter.
    fewest: usize,
    work: &'a W,
}

impl<T: Send, W: Fn(Range<usize>, [&mut [T]; N]) + Sync, const N: usize> Part<'_, T, W, N> {
    fn len(&self) -> usize {
        self.to.first().map_or(0, |to| to.len())
    }
}

impl<T: Send, W: Fn(Range<usize>, [&mut [T]; N]) + Sync, const N: usize> Halves for Part<'_, T, W, N> {
    fn pieces(&self) -> usize {
        (self.len() / self.fewest).max(1)
    }

    fn halve(self) -> [Self; 2] {
        let half = self.len() / 2;
        let Self { first, to, fewest, work } = self;
        let mut halves = to.map(|to| to.split_at_mut(half));
        let low = halves.each_mut().map(|(low, _)| std::mem::take(low));
        let high = halves.map(|(_, high)| high);
        [Self { first, to: low, fewest, work }, Self { first: first + half, to: high, fewest, work }]
    }

    fn work(self) {
        let part = self.first..self.first + self.len();
        (self.work)(part, self.to);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Barrier;

    use super::*;

    struct Squares<'a>(&'a mut [usize], usize);

    impl Halves for Squares<'_> {
        fn pieces(&self) -> usize {
            self.0.len()
        }

        fn halve(self) -> [Self; 2] {
            let middle = self.0.len() / 2;
            let (low, high) = self.0.split_at_mut(middle);
            [Self(low, self.1), Self(high, self.1 + middle)]
        }

        fn work(self) {
            for (number, square) in self.0.iter_mut().enumerate() {
                *square = (self.1 + number).pow(2);
            }
        }
    }

    #[test]
    fn all_of_the_work_is_done_by_any_team() {
        for threads in [0, 1, 2, 3, 8] {
            for count in [0, 1, 2, 3, 100] {
                let mut squares = vec![0; count];
                within(threads, || share(threads, Squares(&mut squares, 0)));
                let expected: Vec<usize> = (0..count).map(|number| number * number).collect();
                assert_eq!(squares, expected, "{count} by {threads}");
            }
        }
    }

    #[test]
    fn parts_have_their_places_and_come_to_the_whole() {
        for threads in [1, 2, 3, 8] {
            for count in [0, 1, 5000, 20_001] {
                let (mut places, mut twice) = (vec![0; count], vec![0; count]);
                let write = |part: Range<usize>, [places, twice]: [&mut [usize]; 2]| {
                    for (place, (to, twice)) in part.zip(places.iter_mut().zip(twice)) {
                        (*to, *twice) = (place, 2 * place);
                    }
                };
                within(threads, || by_part(threads, [&mut places, &mut twice], write));
                assert!(places.iter().copied().eq(0..count), "{count} by {threads}");
                assert!(twice.iter().copied().eq((0..count).map(|place| 2 * place)), "{count} by {threads}");
            }
        }
    }

    #[test]
    fn halves_meet_and_without_a_pool_nobody_waits() {
        struct Meets<'a>(&'a Barrier, usize);
        impl Halves for Meets<'_> {
            fn pieces(&self) -> usize {
                self.1
            }
            fn halve(self) -> [Self; 2] {
                [Self(self.0, 1), Self(self.0, 1)]
            }
            fn work(self) {
                if self.1 == 1 {
                    self.0.wait();
                }
            }
        }
        let barrier = Barrier::new(2);
        within(2, || share(2, Meets(&barrier, 2)));
        share(2, Meets(&barrier, 2));
    }

    fn within<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
        rayon::ThreadPoolBuilder::new().num_threads(threads.max(1)).build().expect("a pool").install(work)
    }
}
