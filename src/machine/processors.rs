//! Threads that work together, each on a processor of its own.
//!
//! A system may wake a thread on the processor of the thread that woke it although another processor is free. There the two
//! take turns. As the waiting one yields again and again, the system considers both too recently active to move: on Linux 6
//! they stay together for milliseconds, as long as the work takes.

#[cfg(target_os = "linux")]
use std::sync::Mutex;

#[cfg(target_os = "linux")]
use rustix::thread::{CpuSet, sched_getaffinity, sched_getcpu, sched_setaffinity};

/// The processors taken by threads that work together.
#[derive(Debug, Default)]
pub(super) struct Processors {
    #[cfg(target_os = "linux")]
    taken: Mutex<Option<CpuSet>>,
}

impl Processors {
    /// Moves the calling thread to a processor that none of the others is on, if it is allowed to be on one. The thread is
    /// not bound to it. Does nothing if the system does not tell.
    #[cfg(target_os = "linux")]
    pub(super) fn move_to_free_processor(&self) {
        let Ok(mut taken) = self.taken.lock() else { return };
        let taken = taken.get_or_insert_default();
        let mut here = sched_getcpu();
        if here < CpuSet::MAX_CPU
            && taken.is_set(here)
            && let Ok(allowed) = sched_getaffinity(None)
        {
            let mut free = allowed;
            for processor in (0..CpuSet::MAX_CPU).filter(|processor| taken.is_set(*processor)) {
                free.unset(processor);
            }
            // If it may be on no other processor, or is forbidden to choose, the thread stays.
            if free.count() > 0 && sched_setaffinity(None, &free).is_ok() {
                here = sched_getcpu();
                if sched_setaffinity(None, &allowed).is_err() {
                    log::debug!("a thread stays bound to {} processors", free.count());
                }
            }
        }
        if here < CpuSet::MAX_CPU {
            taken.set(here);
        }
    }

    /// Does nothing: the processors of other systems are not known.
    #[cfg(not(target_os = "linux"))]
    #[expect(clippy::unused_self, reason = "as on Linux")]
    pub(super) fn move_to_free_processor(&self) {}
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use std::thread::scope;

    use super::*;

    #[test]
    fn a_thread_leaves_the_processor_of_another_and_may_still_be_on_all() {
        scope(|scope| {
            scope.spawn(|| {
                let allowed = sched_getaffinity(None).expect("Linux tells");
                let processors = Processors::default();
                // From the second call on the processor of this thread is taken, and it moves to another: as many calls as
                // there are processors.
                for _ in 0..allowed.count() {
                    processors.move_to_free_processor();
                    assert_eq!(sched_getaffinity(None), Ok(allowed), "it is bound to none");
                }
                let taken = processors.taken.into_inner().expect("nobody panicked").expect("one at least");
                assert_eq!(taken.count(), allowed.count(), "another one each time");
                let again = Processors { taken: Mutex::new(Some(taken)) };
                again.move_to_free_processor();
                assert_eq!(sched_getaffinity(None), Ok(allowed), "there is none left: it stays");
            });
        });
    }
}
