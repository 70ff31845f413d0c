//! How fast a step is: free cubes at every level of vector instructions and on several threads, beside the naive loop
//! that everybody writes first, in turns in one process; and scenes beside real time.

pub mod naive;
mod peak_flops;
pub mod scenes;
pub mod words;

use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use cpu_time::ThreadTime;
use rayon::{ThreadPool, ThreadPoolBuilder};
use serde::Serialize;

use self::naive::Naive;
use self::scenes::{SceneSpeed, TimedScene};
use super::cost::noise::{Change, median};
use crate::geometry::Watch;
use crate::machine::threads::kept_awake;
use crate::physics::{SimdLevel, Simulation};
use crate::scene::body::{CellsShape, CubeShape};
use crate::scene::resolve::{ResolveError, resolve};
use crate::scene::settings::Stepping;
use crate::scene::{Body, Scene, Shape};

/// How often everything is timed.
const ROUNDS: usize = 9;

/// The step, s.
const DT: f32 = 1e-5;

/// The step for which real time is judged, s.
const REAL_STEP_SECS: f64 = 1e-3;

/// Operations of a damped link: 3 + 5 for its length, a root and a quotient, 3 + 6 for its rate of change, 4 for the
/// strength, 3 for the force, 6 to add it at both ends.
const FLOPS_A_LINK: f64 = 32.0;

/// Cells along the edge of the box of which a ring fills a tenth.
const RING_BOX_CELLS: i32 = 63;

/// How much is measured.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Particles along an edge of the cubes.
    pub sizes: &'static [u32],
    /// The least number of links in a timing.
    pub min_links: usize,
    /// How long scenes run, s of the wall clock.
    pub scene_secs: f64,
}

impl Effort {
    /// The effort of the published figures.
    pub const FULL: Self = Self { sizes: &[10, 20, 40, 64, 100], min_links: 20_000_000, scene_secs: 6.0 };
    /// An effort of some seconds.
    pub const QUICK: Self = Self { sizes: &[10, 20], min_links: 200_000, scene_secs: 0.3 };
}

/// One way to take the steps of a cube.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names are the keys of the command line's JSON")]
pub struct SpeedRow {
    /// Particles along an edge.
    pub n: u32,
    pub kernel: &'static str,
    pub simd: &'static str,
    pub threads: usize,
    pub ns_per_link: f64,
    pub ns_per_particle: f64,
    pub ratio_to_naive: f64,
    /// The range of the ratio over the rounds, without the least and the most.
    pub ratio_range: [f64; 2],
    pub fraction_of_peak: f64,
    /// Hash of the state at the end; none of the naive loop, whose state is another.
    pub hash: Option<String>,
}

/// All figures.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names are the keys of the command line's JSON")]
pub struct SpeedFigures {
    pub rows: Vec<SpeedRow>,
    /// Peak of one thread at the widest level.
    pub peak_gflops_fma: f64,
    /// The largest cube for which an undivided step of 1 ms takes no more than 1 ms, as particles along an edge; none
    /// where no cubes were timed.
    pub largest_real_time_n: Option<u32>,
    /// Time per link of a ring that fills a tenth of its box over that of a cube that fills it; none with `--quick`.
    pub ring_over_cube: Option<f64>,
    pub scenes: Vec<SceneSpeed>,
}

impl SpeedFigures {
    /// A defect: levels or threads with different bits.
    pub fn defect(&self) -> Option<String> {
        let hash = |row: &&SpeedRow| row.hash.is_some();
        self.rows.iter().filter(hash).find_map(|row| {
            let first = self.rows.iter().filter(hash).find(|first| first.n == row.n)?;
            (first.hash != row.hash).then(|| {
                let [row, first] = [row, first].map(|row| format!("{} by {} threads", row.simd, row.threads));
                format!("{row} gives other bits than {first}")
            })
        })
    }
}

/// Times given scenes from their start, with up to `threads` threads.
pub fn measure_scenes(scenes: &[TimedScene], effort: Effort, threads: usize) -> SpeedFigures {
    let pool = steps_pool(threads);
    let scenes = scenes::measure(scenes, effort.scene_secs, threads, pool.as_ref());
    let peak_gflops_fma = peak_gflops(SimdLevel::best());
    SpeedFigures { rows: Vec::new(), peak_gflops_fma, largest_real_time_n: None, ring_over_cube: None, scenes }
}

/// Times cubes and the scenes of the report itself, with up to `threads` threads; none where `watch` cancels. Of the
/// machine's levels of vector instructions the cubes take all, or the one called `only`.
///
/// # Errors
/// If a shape cannot be made: a fault of this program.
pub fn measure(
    effort: Effort,
    threads: usize,
    only: Option<&str>,
    watch: &dyn Watch,
) -> Result<Option<SpeedFigures>, ResolveError> {
    let is_wanted = |level: &SimdLevel| level.is_available() && only.is_none_or(|only| level.name() == only);
    let levels: Vec<_> = SimdLevel::ALL.into_iter().filter(is_wanted).collect();
    let pool = steps_pool(threads);
    let peak = peak_gflops(SimdLevel::best());
    let mut rows = Vec::new();
    let stages = effort.sizes.len() + 2;
    for (done, &n) in effort.sizes.iter().enumerate() {
        watch.progress(done as f64 / stages as f64);
        let start = free_body(cube(n - 1))?;
        let mut modes: Vec<ExecutionMode> =
            levels.iter().map(|level| ExecutionMode { level: *level, threads: 1 }).collect();
        if let (Some(widest), true) = (levels.last(), threads > 1 && pool.is_some()) {
            modes.push(ExecutionMode { level: *widest, threads });
        }
        rows.extend(compare(n, &start, &modes, pool.as_ref(), effort.min_links, peak));
        if watch.cancelled() {
            return Ok(None);
        }
    }
    let is_full = effort.sizes.contains(&64);
    let ring_over_cube = if is_full { Some(ring_over_cube(effort.min_links)?) } else { None };
    watch.progress((stages - 1) as f64 / stages as f64);
    let scenes = scenes::measure(&TimedScene::own()?, effort.scene_secs, threads, pool.as_ref());
    let largest_real_time_n = Some(largest_real_time_n(&rows));
    Ok(Some(SpeedFigures { rows, peak_gflops_fma: peak, largest_real_time_n, ring_over_cube, scenes }))
}

/// Threads for the steps alone: the rows of one thread must not find others at work.
fn steps_pool(threads: usize) -> Option<ThreadPool> {
    ThreadPoolBuilder::new().num_threads(threads.max(1)).build().ok()
}

/// How a simulation takes its steps.
#[derive(Clone, Copy, Debug)]
struct ExecutionMode {
    level: SimdLevel,
    threads: usize,
}

/// Processor time of one thread and wall time, s.
#[derive(Clone, Copy, Debug)]
struct Times {
    processor: f64,
    wall: f64,
}

impl Times {
    fn of(work: impl FnOnce()) -> Self {
        let (wall, processor) = (Instant::now(), ThreadTime::now());
        work();
        Self { processor: processor.elapsed().as_secs_f64(), wall: wall.elapsed().as_secs_f64() }
    }

    /// The time that counts for a number of threads.
    fn for_threads(self, threads: usize) -> f64 {
        if threads == 1 { self.processor } else { self.wall }
    }
}

/// Times the naive loop and all ways in turns. Each turn begins with a step that does not count: in use steps follow each
/// other, and what the others left in the caches is not there.
fn compare(
    n: u32,
    start: &Simulation<f32>,
    modes: &[ExecutionMode],
    pool: Option<&ThreadPool>,
    min_links: usize,
    peak_gflops: f64,
) -> Vec<SpeedRow> {
    let links: usize = start.model().link_counts().iter().sum();
    let particles = start.model().particle_count();
    let steps = min_links.div_ceil(links);
    let mut naive = Naive::new(start);
    let mut simulations: Vec<_> = modes.iter().map(|mode| prepared(start, *mode)).collect();
    let (mut naive_times, mut mode_times) = (Vec::new(), vec![Vec::new(); modes.len()]);
    for _ in 0..ROUNDS {
        naive.step(DT);
        naive_times.push(Times::of(|| (0..steps).for_each(|_| naive.step(DT))));
        for ((mode, simulation), times) in modes.iter().zip(&mut simulations).zip(&mut mode_times) {
            times.push(timed(simulation, *mode, pool, steps));
        }
    }
    black_box(naive.height());
    let naive_times: [Vec<f64>; 2] =
        [1, 2].map(|threads| naive_times.iter().map(|times| times.for_threads(threads)).collect());
    let row = |kernel, simd: &'static str, threads: usize, times: &[f64], hash| {
        let nanos = 1e9 * median(times) / steps as f64;
        let naive = &naive_times[usize::from(threads > 1)];
        let Change { median, low, high } = Change::of(naive, times);
        SpeedRow {
            n,
            kernel,
            simd,
            threads,
            ns_per_link: nanos / links as f64,
            ns_per_particle: nanos / particles as f64,
            ratio_to_naive: 1.0 + median,
            ratio_range: [1.0 + low, 1.0 + high],
            fraction_of_peak: FLOPS_A_LINK * links as f64 / nanos / (peak_gflops * threads as f64),
            hash,
        }
    };
    let mut rows = vec![row("naive", SimdLevel::Portable.name(), 1, &naive_times[0], None)];
    for ((mode, simulation), times) in modes.iter().zip(&simulations).zip(mode_times) {
        let times: Vec<f64> = times.iter().map(|times| times.for_threads(mode.threads)).collect();
        let hash = format!("{:016x}", simulation.hash());
        rows.push(row("exact", mode.level.name(), mode.threads, &times, Some(hash)));
    }
    rows
}

fn prepared(start: &Simulation<f32>, mode: ExecutionMode) -> Simulation<f32> {
    let mut simulation = start.clone();
    simulation.plan_mut().simd = mode.level;
    simulation.set_threads(mode.threads);
    simulation
}

fn timed(simulation: &mut Simulation<f32>, mode: ExecutionMode, pool: Option<&ThreadPool>, steps: usize) -> Times {
    let mut work = || {
        black_box(simulation.step());
        Times::of(|| {
            for _ in 0..steps {
                black_box(simulation.step());
            }
        })
    };
    match pool.filter(|_| mode.threads > 1) {
        Some(pool) => pool.install(|| kept_awake(mode.threads, work)),
        None => work(),
    }
}

/// Time per link of a ring over that of a full cube in a box of the same size, by one thread at the widest level.
fn ring_over_cube(min_links: usize) -> Result<f64, ResolveError> {
    let mode = ExecutionMode { level: SimdLevel::best(), threads: 1 };
    let mut bodies = Vec::new();
    for shape in [ring(), cube(RING_BOX_CELLS.unsigned_abs())] {
        let simulation = prepared(&free_body(shape)?, mode);
        let links: usize = simulation.model().link_counts().iter().sum();
        bodies.push((simulation, links, Vec::new()));
    }
    for _ in 0..ROUNDS {
        for (simulation, links, times) in &mut bodies {
            let steps = min_links.div_ceil(*links);
            times.push(timed(simulation, mode, None, steps).processor / (steps * *links) as f64);
        }
    }
    let [ring, cube] = [0, 1].map(|body| bodies[body].2.clone());
    Ok(1.0 + Change::of(&ring, &cube).median)
}

/// GFLOP/s of one thread that only multiplies and adds: the most of some rounds.
fn peak_gflops(level: SimdLevel) -> f64 {
    const LOOPS: u64 = 2_000_000;
    let secs = (0..ROUNDS).map(|_| {
        Times::of(|| {
            black_box(peak_flops::multiply_adds(level, LOOPS));
        })
        .processor
    });
    (peak_flops::FLOPS_A_ROUND * LOOPS) as f64 / secs.fold(f64::INFINITY, f64::min) / 1e9
}

/// The largest cube in real time, from the fastest rows. A size between two measured ones has the time per particle of the
/// smaller one.
fn largest_real_time_n(rows: &[SpeedRow]) -> u32 {
    let fastest = |n: u32| {
        let sizes = rows.iter().filter(|row| row.kernel == "exact" && row.n <= n);
        let size = sizes.map(|row| row.n).max().or_else(|| rows.iter().map(|row| row.n).min())?;
        rows.iter().filter(|row| row.kernel == "exact" && row.n == size).map(|row| row.ns_per_particle).reduce(f64::min)
    };
    let is_real_time = |n: &u32| fastest(*n).is_some_and(|nanos| f64::from(*n).powi(3) * nanos <= 1e9 * REAL_STEP_SECS);
    (2..1000).take_while(is_real_time).last().unwrap_or(0)
}

fn cube(cells: u32) -> Shape {
    Shape::Cube(CubeShape { cells, size: 1.0 })
}

/// A torus that fills a tenth of its box.
fn ring() -> Shape {
    let middle = 0.5 * f64::from(RING_BOX_CELLS - 1);
    let (around, thick) = (0.325 * f64::from(RING_BOX_CELLS), 0.16 * f64::from(RING_BOX_CELLS));
    let inside = |cell: &[i32; 3]| {
        let [x, y, z] = cell.map(|at| f64::from(at) - middle);
        ((x * x + y * y).sqrt() - around).hypot(z) < thick
    };
    let all = (0..RING_BOX_CELLS)
        .flat_map(|z| (0..RING_BOX_CELLS).flat_map(move |y| (0..RING_BOX_CELLS).map(move |x| [x, y, z])));
    Shape::Cells(CellsShape { list: all.filter(inside).collect(), size: 1.0 / f64::from(RING_BOX_CELLS) })
}

/// A moving body alone in space.
fn free_body(shape: Shape) -> Result<Simulation<f32>, ResolveError> {
    let body = Body { shape, velocity: [0.1, 0.0, 0.0], ..Body::default() };
    let mut scene = Scene { bodies: vec![body], ..Scene::default() };
    (scene.settings.dt, scene.settings.stepping) = (f64::from(DT), Stepping::Manual);
    scene.settings.sleeping = false;
    let lattice = resolve(&scene.bodies[0].shape, Path::new("."), &())?.lattice;
    Ok(Simulation::new(&scene, &[lattice]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(n: u32, threads: usize, hash: &str) -> SpeedRow {
        SpeedRow {
            n,
            kernel: "exact",
            simd: "portable",
            threads,
            ns_per_link: 1.0,
            ns_per_particle: 15.0,
            ratio_to_naive: 9.0,
            ratio_range: [8.5, 9.5],
            fraction_of_peak: 0.1,
            hash: Some(hash.into()),
        }
    }

    fn figures(rows: Vec<SpeedRow>) -> SpeedFigures {
        SpeedFigures {
            rows,
            peak_gflops_fma: 100.0,
            largest_real_time_n: Some(40),
            ring_over_cube: None,
            scenes: Vec::new(),
        }
    }

    #[test]
    fn other_bits_by_two_threads_are_a_defect() {
        assert_eq!(figures(vec![row(10, 1, "a"), row(20, 1, "b"), row(20, 2, "b")]).defect(), None);
        let wrong = figures(vec![row(10, 1, "a"), row(10, 2, "b")]).defect();
        assert_eq!(wrong.as_deref(), Some("portable by 2 threads gives other bits than portable by 1 threads"));
    }

    #[test]
    fn the_naive_loop_moves_a_body_as_the_core_does() {
        let mut simulation = free_body(cube(3)).expect("a cube");
        let mut naive = Naive::new(&simulation);
        let before = naive.height();
        for _ in 0..2000 {
            simulation.step();
            naive.step(DT);
        }
        let fall = naive.height() - before;
        assert!((naive.height() - simulation.diagnostics().center.y).abs() < 0.01 * fall.abs(), "{fall} m");
    }

    #[test]
    fn a_ring_fills_a_tenth_of_its_box() {
        let Shape::Cells(cells) = ring() else { panic!("a list of cells") };
        let share = cells.list.len() as f64 / f64::from(RING_BOX_CELLS).powi(3);
        assert!((0.09..0.18).contains(&share), "{share}");
    }

    #[test]
    fn the_largest_cube_in_real_time_follows_from_the_time_a_particle() {
        // At 15 ns a particle, 66 666 particles fit into 1 ms.
        assert_eq!(largest_real_time_n(&[row(10, 1, "a"), row(20, 1, "a")]), 40);
    }
}
