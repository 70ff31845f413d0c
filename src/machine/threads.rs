//! Threads of a pool that are kept awake while short work for them comes again and again: a sleeping thread takes tens of
//! microseconds to wake, as long as a piece of a step.

use std::hint::spin_loop;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread::yield_now;

use rayon::Yield;

use super::processors::Processors;

/// Checks of awaited work before the thread yields its processor: some microseconds.
const SPINS_PER_YIELD: usize = 200;

/// Sets a flag when it is dropped, also by a panic.
struct SetOnDrop<'a>(&'a AtomicBool);

impl Drop for SetOnDrop<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Release);
    }
}

/// Does some work with `threads` threads of the current pool awake, the calling one included. Outside of a pool, or if one
/// thread is enough, it just does the work. Waiting threads yield their processors to others.
pub fn kept_awake<T>(threads: usize, work: impl FnOnce() -> T) -> T {
    let others = threads.min(rayon::current_num_threads()).saturating_sub(1);
    if others == 0 || !in_pool() {
        return work();
    }
    let (awake, done) = (AtomicUsize::new(0), AtomicBool::new(false));
    let processors = Processors::default();
    processors.move_to_free_processor();
    rayon::in_place_scope(|scope| {
        let done_at_last = SetOnDrop(&done);
        for _ in 0..others {
            scope.spawn(|_| {
                awake.fetch_add(1, Ordering::Relaxed);
                processors.move_to_free_processor();
                while !done.load(Ordering::Acquire) {
                    if rayon::yield_now() != Some(Yield::Executed) {
                        yield_now();
                    }
                }
            });
        }
        // All waiting tasks must be with other threads: one taken here, while this thread awaits its own work, would never
        // end.
        while awake.load(Ordering::Relaxed) < others {
            yield_now();
        }
        let outcome = work();
        drop(done_at_last);
        outcome
    })
}

/// Whether the calling thread is one of a pool.
pub fn in_pool() -> bool {
    rayon::current_thread_index().is_some()
}

/// Does `work` while another thread of the current pool does `other`, or this one if none is free. Waits for the other
/// without going to sleep; a join of the pool sleeps after some microseconds.
pub fn join(work: impl FnOnce() + Send, other: impl FnOnce() + Send) {
    let done = AtomicBool::new(false);
    rayon::join(
        || {
            work();
            wait_for(&done);
        },
        || {
            let _done_at_last = SetOnDrop(&done);
            other();
        },
    );
}

/// Waits for work that another thread of the pool has taken up, or takes it up if none has.
fn wait_for(done: &AtomicBool) {
    while !done.load(Ordering::Acquire) {
        if rayon::yield_now() == Some(Yield::Executed) {
            continue;
        }
        for _ in 0..SPINS_PER_YIELD {
            if done.load(Ordering::Acquire) {
                return;
            }
            spin_loop();
        }
        yield_now();
    }
}

#[cfg(test)]
mod tests {
    use std::panic::{AssertUnwindSafe, catch_unwind};

    use super::*;

    fn within<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool").install(work)
    }

    fn sum(of: &[u64]) -> u64 {
        if of.len() < 8 {
            return of.iter().sum();
        }
        let (low, high) = of.split_at(of.len() / 2);
        let (low, high) = rayon::join(|| sum(low), || sum(high));
        low + high
    }

    #[test]
    fn work_is_shared_out_and_comes_to_an_end() {
        let numbers: Vec<u64> = (0..1000).collect();
        for threads in [1, 2, 3, 8] {
            for wanted in [0, 1, 2, 5, 20] {
                let sums: Vec<u64> =
                    within(threads, || (0..50).map(|_| kept_awake(wanted, || sum(&numbers))).collect());
                assert!(sums.iter().all(|sum| *sum == 499_500), "{wanted} of {threads}");
            }
        }
        assert_eq!(kept_awake(4, || sum(&numbers)), 499_500, "outside of a pool");
    }

    #[test]
    fn both_halves_are_done_and_a_panic_of_either_is_not_waited_for() {
        for threads in [1, 2, 3] {
            let done = AtomicUsize::new(0);
            let one = || _ = done.fetch_add(1, Ordering::Relaxed);
            within(threads, || join(one, || join(one, one)));
            assert_eq!(done.load(Ordering::Relaxed), 3, "by {threads}");
            let panics = |work: fn(), other: fn()| within(threads, || catch_unwind(|| join(work, other)).is_err());
            assert!(panics(|| panic!("lost"), || ()) && panics(|| (), || panic!("lost")), "by {threads}");
        }
    }

    #[test]
    fn a_panic_lets_the_others_go() {
        let panics = within(3, || catch_unwind(AssertUnwindSafe(|| kept_awake(3, || panic!("lost")))).is_err());
        assert!(panics, "and goes on");
    }
}
