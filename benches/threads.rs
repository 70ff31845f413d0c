//! Wall time of a substep on one thread and on more, in turns in one process: free cubes, and the largest preset as it
//! lands. Each figure is the median of the rounds, with the shares by which the quartiles lie below and above, and the
//! fastest round. A large spread means that the machine was busy; then the fastest rounds tell more.

use std::io::Write;
use std::path::Path;
use std::thread::available_parallelism;
use std::time::Instant;

use gelatin::machine::threads::kept_awake;
use gelatin::physics::Simulation;
use gelatin::scene::body::CubeShape;
use gelatin::scene::presets::preset;
use gelatin::scene::settings::Stepping;
use gelatin::scene::{Body, Scene, Shape};

/// How often everything is timed.
const ROUNDS: usize = 61;

/// The least number of links in a timing.
const LINKS: usize = 2_000_000;

/// Whole steps before the timing: the preset has landed.
const BEFORE: usize = 30;

/// A cube with `particles` particles along each edge.
fn cube(particles: u32) -> Scene {
    let mut body = Body { shape: Shape::Cube(CubeShape { cells: particles - 1, size: 1.0 }), ..Body::default() };
    body.velocity = [0.1, 0.0, 0.0];
    let mut scene = Scene { bodies: vec![body], ..Scene::default() };
    (scene.settings.dt, scene.settings.stepping) = (1e-5, Stepping::Manual);
    scene
}

fn landed(scene: &Scene, steps: usize) -> Simulation<f32> {
    let mut scene = scene.clone();
    scene.settings.sleeping = false;
    let mut simulation = Simulation::from_scene(&scene, Path::new("")).expect("a sound scene");
    for _ in 0..steps {
        simulation.step();
    }
    simulation
}

/// Time of a substep for each number of threads, in every round, s.
fn times(start: &Simulation<f32>, threads: &[usize]) -> Vec<Vec<f64>> {
    let links: usize = start.model().link_counts().iter().sum();
    let substeps = LINKS.div_ceil(links);
    let mut runs: Vec<_> = threads
        .iter()
        .map(|&threads| {
            let mut simulation = start.clone();
            simulation.set_threads(threads);
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            (simulation, pool, Vec::new())
        })
        .collect();
    for _ in 0..ROUNDS {
        for (simulation, pool, times) in &mut runs {
            pool.install(|| {
                kept_awake(simulation.plan().threads, || {
                    let begin = Instant::now();
                    (0..substeps).for_each(|_| {
                        simulation.substep(&mut ());
                    });
                    times.push(begin.elapsed().as_secs_f64() / substeps as f64);
                });
            });
        }
    }
    assert!(runs.iter().all(|(run, ..)| run.hash() == runs[0].0.hash()), "the same bits");
    runs.into_iter().map(|(_, _, times)| times).collect()
}

fn compare(name: &str, start: &Simulation<f32>, out: &mut impl Write) -> std::io::Result<()> {
    let most = available_parallelism().map_or(2, |count| count.get().max(2));
    let threads: Vec<usize> = (0..=most.ilog2()).map(|power| 1 << power).collect();
    let mut alone = [0.0; 2];
    for (threads, mut times) in threads.iter().zip(times(start, &threads)) {
        times.sort_by(f64::total_cmp);
        let at = |share: usize| times[(times.len() - 1) * share / 4];
        let [median, fastest] = [at(2), at(0)];
        if *threads == 1 {
            alone = [median, fastest];
        }
        writeln!(
            out,
            "{name:<12} {threads} threads  {:>8.1} us  -{:<2.0} % +{:<3.0} %  {:>4.2} x one    fastest {:>8.1} us  {:>4.2} x one",
            1e6 * median,
            100.0 * (1.0 - at(1) / median),
            100.0 * (at(3) / median - 1.0),
            alone[0] / median,
            1e6 * fastest,
            alone[1] / fastest,
        )?;
    }
    Ok(())
}

fn main() -> std::io::Result<()> {
    // When Cargo tests benches, they only have to build.
    if std::env::args().any(|argument| argument == "--test") {
        return Ok(());
    }
    let out = &mut std::io::stdout();
    for particles in [10, 14, 20, 40] {
        compare(&format!("cube {particles}"), &landed(&cube(particles), 0), out)?;
    }
    for name in ["spot", "coupler-20", "coupler-40"] {
        let scene = (preset(name).expect("a preset").build)();
        compare(name, &landed(&scene, BEFORE), out)?;
    }
    Ok(())
}
