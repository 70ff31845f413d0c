//! Shares the work of a step among the threads of the caller's pool.
//!
//! Work is shared out in halves: the calling thread does one half, and a free thread the other, or the same thread where
//! none is free; each halves its own again while there are threads. A caller that wants several threads runs the simulation
//! within a long-lived pool ([`rayon::ThreadPool::install`]); elsewhere one thread does it all. Threads of a pool look for
//! work for some microseconds and then sleep; `machine::threads` keeps them awake for callers that take many steps. Nothing
//! is allocated on the way. The result does not depend on how the work is halved or on which thread does which half.

use std::ops::Range;
use std::sync::OnceLock;

use crate::machine::threads::{in_pool, join};
use crate::math::Real;
use crate::physics::model::Model;

/// How many threads new plans may use; one if [`choose_step_threads`] was not called.
static CHOSEN: OnceLock<usize> = OnceLock::new();

/// Lets every plan made from now on use `count` threads. Returns whether it does: the first choice of a process holds.
#[must_use]
pub fn choose_step_threads(count: usize) -> bool {
    *CHOSEN.get_or_init(|| count.max(1)) == count.max(1)
}

/// How many threads new plans may use.
pub fn step_threads() -> usize {
    *CHOSEN.get_or_init(|| 1)
}

/// Work that can be shared out.
pub(in crate::physics) trait DivisibleWork: Send + Sized {
    /// Into how many pieces the work can be divided, at least one.
    fn pieces(&self) -> usize;
    /// Two parts of the work, as equal as possible. There must be at least two pieces.
    fn halve(self) -> [Self; 2];
    /// Does all of the work.
    fn work(self);
}

/// Does some work with up to `threads` threads of the current pool; with this thread alone outside a pool.
pub(in crate::physics) fn share(threads: usize, work: impl DivisibleWork) {
    if threads <= 1 || work.pieces() <= 1 || !in_pool() {
        return work.work();
    }
    let [one, other] = work.halve();
    join(|| share(threads.div_ceil(2), one), || share(threads / 2, other));
}

/// Fewer particles are not shared out: handing them over would take as long as the work.
const MIN_PARTICLES: usize = 2048;

/// Writes slices of equal length, an element a particle, part by part: `work` gets the range of a part and that part of each
/// slice.
pub(in crate::physics) fn by_part<T: Send, const N: usize>(
    threads: usize,
    to: [&mut [T]; N],
    work: impl Fn(Range<usize>, [&mut [T]; N]) + Sync,
) {
    share(threads, Part { first: 0, to, fewest: MIN_PARTICLES, work: &work });
}

/// The same for a slice with an element for each group of `group` particles.
pub(in crate::physics) fn by_groups<T: Send>(
    threads: usize,
    group: usize,
    to: &mut [T],
    work: impl Fn(Range<usize>, &mut [T]) + Sync,
) {
    let work = |part, [to]: [&mut [T]; 1]| work(part, to);
    share(threads, Part { first: 0, to: [to], fewest: MIN_PARTICLES / group, work: &work });
}

/// The same limit for work that costs as much for each particle as contact does.
pub(in crate::physics) const MIN_CONTACT_PARTICLES: usize = 512;

/// Parts for each thread where some may take far longer than others: a thread that is free takes the next.
const PARTS_PER_THREAD: usize = 4;

/// One or several slices that can be cut in two.
pub(in crate::physics) trait Cut: Send + Sized {
    /// The elements before `at`, and those from there on.
    fn cut(self, at: usize) -> [Self; 2];
}

impl<T: Send> Cut for &mut [T] {
    fn cut(self, at: usize) -> [Self; 2] {
        self.split_at_mut(at).into()
    }
}

impl Cut for () {
    fn cut(self, _: usize) -> [Self; 2] {
        [(); 2]
    }
}

impl<A: Cut, B: Cut> Cut for (A, B) {
    fn cut(self, at: usize) -> [Self; 2] {
        let ([first, last], [of_first, of_last]) = (self.0.cut(at), self.1.cut(at));
        [(first, of_first), (last, of_last)]
    }
}

impl<A: Cut> Cut for Option<A> {
    fn cut(self, at: usize) -> [Self; 2] {
        self.map_or_else(|| [None, None], |all| all.cut(at).map(Some))
    }
}

/// Works on the bodies of a model in parallel: `work` gets a range of bodies and its part of the data of every body and of
/// every particle. A part has at least `fewest` particles, unless it is a single body.
pub(in crate::physics) fn for_body_ranges<R: Real, B: Cut, P: Cut>(
    threads: usize,
    fewest: usize,
    model: &Model<R>,
    (of_bodies, of_particles): (B, P),
    work: impl Fn(Range<usize>, B, P) + Sync,
) {
    let bodies = 0..model.bodies.len();
    let parts = if threads > 1 { PARTS_PER_THREAD * threads } else { 1 };
    share(parts, BodyRange { model, bodies, fewest, of_bodies, of_particles, work: &work });
}

/// A range of bodies.
struct BodyRange<'a, R: Real, B, P, W> {
    model: &'a Model<R>,
    bodies: Range<usize>,
    fewest: usize,
    of_bodies: B,
    of_particles: P,
    work: &'a W,
}

impl<R: Real, B, P, W> BodyRange<'_, R, B, P, W> {
    /// Their particles.
    fn particles(&self) -> Range<usize> {
        let start = |body: usize| self.model.bodies[body].particles.start;
        match self.bodies.end.checked_sub(1) {
            Some(last) if !self.bodies.is_empty() => start(self.bodies.start)..self.model.bodies[last].particles.end,
            _ => 0..0,
        }
    }
}

impl<R: Real, B: Cut, P: Cut, W: Fn(Range<usize>, B, P) + Sync> DivisibleWork for BodyRange<'_, R, B, P, W> {
    fn pieces(&self) -> usize {
        self.bodies.len().min(self.particles().len() / self.fewest).max(1)
    }

    fn halve(self) -> [Self; 2] {
        let particles = self.particles();
        let middle = particles.start + particles.len() / 2;
        let off = |body: &usize| self.model.bodies[*body].particles.start.abs_diff(middle);
        let at = (self.bodies.start + 1..self.bodies.end).min_by_key(off).unwrap_or(self.bodies.end);
        let cut = self.model.bodies.get(at).map_or(particles.end, |body| body.particles.start);
        let Self { model, bodies, fewest, of_bodies, of_particles, work } = self;
        let [first_bodies, last_bodies] = of_bodies.cut(at - bodies.start);
        let [first_particles, last_particles] = of_particles.cut(cut - particles.start);
        let [first, last] = [bodies.start..at, at..bodies.end];
        [
            Self { model, bodies: first, fewest, of_bodies: first_bodies, of_particles: first_particles, work },
            Self { model, bodies: last, fewest, of_bodies: last_bodies, of_particles: last_particles, work },
        ]
    }

    fn work(self) {
        (self.work)(self.bodies, self.of_bodies, self.of_particles);
    }
}

/// The same as [`by_part`] for a slice with an element for each body of a model.
pub(in crate::physics) fn by_bodies<R: Real, T: Send>(
    threads: usize,
    model: &Model<R>,
    to: &mut [T],
    work: impl Fn(Range<usize>, &mut [T]) + Sync,
) {
    let mean = model.particle_count() / model.bodies.len().max(1);
    by_groups(threads, mean.clamp(1, MIN_PARTICLES), to, work);
}

/// A part of the slices that are written.
struct Part<'a, T, W, const N: usize> {
    first: usize,
    to: [&'a mut [T]; N],
    /// The fewest elements of a half.
    fewest: usize,
    work: &'a W,
}

impl<T: Send, W: Fn(Range<usize>, [&mut [T]; N]) + Sync, const N: usize> Part<'_, T, W, N> {
    fn len(&self) -> usize {
        self.to.first().map_or(0, |to| to.len())
    }
}

impl<T: Send, W: Fn(Range<usize>, [&mut [T]; N]) + Sync, const N: usize> DivisibleWork for Part<'_, T, W, N> {
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
    use std::path::Path;
    use std::sync::Barrier;

    use super::*;
    use crate::physics::Simulation;
    use crate::scene::body::CubeShape;
    use crate::scene::{Body, Scene, Shape};

    struct Squares<'a>(&'a mut [usize], usize);

    impl DivisibleWork for Squares<'_> {
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
    fn bodies_side_by_side_have_each_their_own_once() {
        // Of 64, 1000, 27 and 343 particles.
        let cube = |(number, cells): (usize, u32)| {
            let mut body = Body { shape: Shape::Cube(CubeShape { cells, size: 0.4 }), ..Body::default() };
            body.pose.position[0] = number as f64;
            body
        };
        let bodies: Vec<Body> = [3, 9, 2, 6].into_iter().enumerate().map(cube).collect();
        let scene = Scene { bodies, ..Scene::default() };
        let simulation = Simulation::<f32>::from_scene(&scene, Path::new(".")).expect("cubes");
        let model = simulation.model();
        for (threads, fewest) in [(1, 1), (2, 1), (3, 100), (8, 1), (8, 5000)] {
            let (mut seen, mut owner) = (vec![0; 4], vec![None; model.particle_count()]);
            let to = ((&mut seen[..], Some(())), (&mut owner[..], ()));
            within(threads, || {
                for_body_ranges(threads, fewest, model, to, |these, (seen, _), (owner, ())| {
                    let first = model.bodies[these.start].particles.start;
                    for (body, seen) in these.zip(seen) {
                        *seen += 1;
                        let own = &model.bodies[body].particles;
                        owner[own.start - first..own.end - first].fill(Some(body));
                    }
                });
            });
            assert_eq!(seen, [1; 4], "by {threads}");
            let expected = (0..model.particle_count()).map(|particle| model.body_of(particle));
            assert!(owner.iter().copied().eq(expected), "by {threads} of at least {fewest}");
        }
    }

    #[test]
    fn halves_meet_and_without_a_pool_nobody_waits() {
        struct Meets<'a>(&'a Barrier, usize);
        impl DivisibleWork for Meets<'_> {
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
