//! The crowded case (GC §7): a cube among more and more obstacles, with and without the broad phase.

use serde::Serialize;

use super::ablation::{TimingPlan, timed};
use super::noise::{Change, median};
use crate::geometry::Watch;
use crate::physics::Simulation;
use crate::report::extremes::lattices;
use crate::scene::body::{Body, CubeShape, Pose};
use crate::scene::obstacle::Sphere;
use crate::scene::resolve::ResolveError;
use crate::scene::{Obstacle, ObstacleShape, Scene, Shape};

/// Cells an edge: cubes of 512 and of 1000 particles.
const CELLS: [u32; 2] = [7, 9];
/// Numbers of obstacles; and with `quick`.
const OBSTACLES: [&[usize]; 2] = [&[1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12], &[1, 6, 12]];
/// The simulated time at which they are measured, s: the cube has just met the ground.
const AT_SECS: f64 = 0.26;
/// Distance of the balls around the cube from its middle, m; the nearest few touch it.
const AROUND: [f64; 2] = [0.75, 0.45];

/// A cube among a number of obstacles. Times and tests are of a substep.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names are the keys of the command line's JSON")]
pub struct CrowdRow {
    pub particles: usize,
    pub obstacles: usize,
    pub tests_on: f64,
    pub tests_off: f64,
    pub secs_on: f64,
    pub secs_off: f64,
    /// The share by which the broad phase changes the time.
    pub change: Change,
    pub within_noise: bool,
    pub same_bits: bool,
}

/// Measures the crowded case.
///
/// # Errors
/// If a shape cannot be made, which no cube should cause.
pub fn crowd(quick: bool, watch: &impl Watch) -> Result<Vec<CrowdRow>, ResolveError> {
    let counts = OBSTACLES[usize::from(quick)];
    let cases: Vec<_> = CELLS.into_iter().flat_map(|cells| counts.iter().map(move |&count| (cells, count))).collect();
    let mut rows = Vec::new();
    for (done, &(cells, obstacles)) in cases.iter().enumerate() {
        rows.push(row(cells, obstacles)?);
        watch.progress((done + 1) as f64 / cases.len() as f64);
    }
    Ok(rows)
}

fn row(cells: u32, obstacles: usize) -> Result<CrowdRow, ResolveError> {
    let scene = crowded(cells, obstacles);
    let lattices = lattices(&scene)?;
    let mut with = Simulation::<f32>::new(&scene, &lattices);
    while with.state().time_secs < AT_SECS {
        with.step();
    }
    let mut without = with.clone();
    without.plan_mut().broad_phase = false;
    let TimingPlan { substeps, rounds } = TimingPlan::of(&with);
    let [mut on, mut off] = [Vec::new(), Vec::new()];
    let mut ends = [0; 2];
    for round in 0..rounds {
        for place in [round % 2, 1 - round % 2] {
            let (secs, (hash, _)) = timed([&with, &without][place], substeps);
            [&mut on, &mut off][place].push(secs);
            ends[place] = hash;
        }
    }
    let change = Change::of(&on, &off);
    Ok(CrowdRow {
        particles: with.model().particle_count(),
        obstacles,
        tests_on: tests(&with, substeps),
        tests_off: tests(&without, substeps),
        secs_on: median(&on),
        secs_off: median(&off),
        change,
        within_noise: change.is_noise(),
        same_bits: ends[0] == ends[1],
    })
}

/// Counts the narrow-phase tests of a substep, on average.
fn tests(simulation: &Simulation<f32>, substeps: usize) -> f64 {
    let mut copy = simulation.clone();
    let tests: u64 = (0..substeps).map(|_| copy.substep(&mut ()).counters.narrow_tests).sum();
    tests as f64 / substeps as f64
}

/// A cube that falls on the ground among balls: the ground is the first obstacle.
fn crowded(cells: u32, obstacles: usize) -> Scene {
    let body = Body {
        shape: Shape::Cube(CubeShape { cells, size: 1.0 }),
        pose: Pose { position: [0.0, 0.75, 0.0], ..Pose::default() },
        ..Body::default()
    };
    let mut scene = Scene { bodies: vec![body], obstacles: vec![Obstacle::default()], ..Scene::default() };
    scene.settings.sleeping = false;
    let [ring, radius] = AROUND;
    for ball in 1..obstacles {
        // Every third one stands in the first row, which the cube touches as it widens.
        let angle = ball as f64 * std::f64::consts::TAU / 11.0;
        let distance = ring + radius * (0.35 + (ball % 3) as f64);
        let center = [distance * libm::cos(angle), 0.3, distance * libm::sin(angle)];
        let shape = ObstacleShape::Sphere(Sphere { center, radius: 0.3 });
        scene.obstacles.push(Obstacle { shape, ..Obstacle::default() });
    }
    scene
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::param;

    #[test]
    fn the_broad_phase_saves_tests_in_a_crowd_and_changes_no_bit() {
        assert_eq!(param::validate(&crowded(9, 12)), [], "it is a scene");
        let [one, many] = [1, 12].map(|obstacles| row(7, obstacles).expect("a cube"));
        assert_eq!((one.particles, one.obstacles), (512, 1));
        assert!(one.same_bits && many.same_bits, "{one:?} {many:?}");
        assert!(one.tests_off >= 512.0 && many.tests_off >= 12.0 * 512.0, "all with all, some twice: {one:?} {many:?}");
        assert!(one.tests_on > 0.0, "it touches the ground: {one:?}");
        assert!(many.tests_on < 0.5 * many.tests_off, "most is far: {many:?}");
    }
}
