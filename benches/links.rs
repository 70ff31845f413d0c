//! Time of the forces of links and of a whole substep, a link, of cubes that are free in space: at every level of vector
//! instructions, beside the plain loop that everybody writes first (`naive`), in turns in one process, in processor time.
//!
//! `naive` keeps particles and springs as structures in two lists, and has no more than springs, gravity and semi-implicit
//! Euler. The forces of links are timed with bringing particles to their box and forces back. Each figure is the median of
//! the rounds, with the share by which a quarter of them lie below and above: where that is large, the machine was busy.

use std::hint::black_box;
use std::io::Write;
use std::path::Path;
use std::time::Duration;

use cpu_time::ThreadTime;
use gelatin::physics::{SimdLevel, Simulation, Stage, StageTimer};
use gelatin::scene::body::CubeShape;
use gelatin::scene::resolve::resolve;
use gelatin::scene::settings::Stepping;
use gelatin::scene::{Body, Scene, Shape};
use glam::Vec3;

/// How often everything is timed.
const ROUNDS: usize = 9;

/// Links a timing, at least.
const LINKS: usize = 2_000_000;

/// The step, s.
const DT: f32 = 1e-5;

struct Particle {
    position: Vec3,
    velocity: Vec3,
    force: Vec3,
    mass: f32,
}

struct Spring {
    ends: [usize; 2],
    stiffness: f32,
    damping: f32,
    rest_length: f32,
}

/// A cube as the first program anybody writes has it.
struct Naive {
    particles: Vec<Particle>,
    springs: Vec<Spring>,
}

impl Naive {
    fn new(simulation: &Simulation<f32>) -> Self {
        let body = &simulation.model().bodies[0];
        let particle = |position: &Vec3| Particle {
            position: *position,
            velocity: Vec3::ZERO,
            force: Vec3::ZERO,
            mass: body.particle_mass,
        };
        let springs = body.links.iter().flat_map(|family| {
            family.links.iter().map(|link| Spring {
                ends: link.ends.map(|end| end as usize),
                stiffness: family.stiffness,
                damping: family.damping,
                rest_length: link.rest_length,
            })
        });
        Self { particles: body.start.iter().map(particle).collect(), springs: springs.collect() }
    }

    fn step(&mut self) {
        let Self { particles, springs } = self;
        for particle in particles.iter_mut() {
            particle.force = Vec3::new(0.0, -9.81, 0.0) * particle.mass;
        }
        for spring in springs.iter() {
            let [a, b] = spring.ends;
            let way = particles[b].position - particles[a].position;
            let length = way.length();
            let direction = way / length;
            let rate = (particles[b].velocity - particles[a].velocity).dot(direction);
            let size =
                spring.stiffness * (length / spring.rest_length - 1.0) + spring.damping * rate / spring.rest_length;
            particles[a].force += direction * size;
            particles[b].force -= direction * size;
        }
        for particle in particles.iter_mut() {
            particle.velocity += particle.force * (DT / particle.mass);
            particle.position += particle.velocity * DT;
        }
    }
}

/// Takes the time of the stage of links.
#[derive(Default)]
struct Clock {
    links: Duration,
    since: Option<ThreadTime>,
}

impl StageTimer for Clock {
    fn enter(&mut self, stage: Stage) {
        self.leave();
        self.since = (stage == Stage::Links).then(ThreadTime::now);
    }

    fn leave(&mut self) {
        self.links += self.since.take().map_or(Duration::ZERO, |since| since.elapsed());
    }
}

/// The median of some times, and how far a quarter of them lie below and above it, as shares of it.
fn summary(times: &mut [f64]) -> (f64, f64, f64) {
    times.sort_by(f64::total_cmp);
    let at = |share: usize| times[(times.len() - 1) * share / 4];
    (at(2), 1.0 - at(1) / at(2), at(3) / at(2) - 1.0)
}

fn cube(cells: u32) -> Simulation<f32> {
    let mut body = Body { shape: Shape::Cube(CubeShape { cells, size: 1.0 }), ..Body::default() };
    body.velocity = [0.1, 0.0, 0.0];
    let mut scene = Scene { bodies: vec![body], ..Scene::default() };
    (scene.settings.dt, scene.settings.stepping) = (f64::from(DT), Stepping::Manual);
    scene.settings.sleeping = false;
    let lattice = resolve(&scene.bodies[0].shape, Path::new("."), &()).expect("a cube").lattice;
    Simulation::new(&scene, &[lattice])
}

/// Times everything in turns and writes a line for each.
fn compare(particles: u32, out: &mut impl Write) -> std::io::Result<()> {
    let start = cube(particles - 1);
    let links: usize = start.model().link_counts().iter().sum();
    let steps = LINKS.div_ceil(links);
    let nanos = |time: Duration| time.as_secs_f64() * 1e9 / (links * steps) as f64;
    let mut naive = Naive::new(&start);
    let levels: Vec<_> = SimdLevel::ALL.into_iter().filter(|level| level.is_available()).collect();
    let mut simulations: Vec<_> = levels
        .iter()
        .map(|level| {
            let mut simulation = start.clone();
            simulation.plan_mut().simd = *level;
            simulation
        })
        .collect();
    let mut naive_times = Vec::new();
    let mut times = vec![[Vec::new(), Vec::new()]; levels.len()];
    for _ in 0..ROUNDS {
        let begin = ThreadTime::now();
        (0..steps).for_each(|_| naive.step());
        naive_times.push(nanos(begin.elapsed()));
        black_box(naive.particles[0].position);
        for (simulation, [of_links, of_steps]) in simulations.iter_mut().zip(&mut times) {
            let mut clock = Clock::default();
            let begin = ThreadTime::now();
            for _ in 0..steps {
                black_box(simulation.step_timed(&mut clock));
            }
            of_steps.push(nanos(begin.elapsed()));
            of_links.push(nanos(clock.links));
        }
    }
    let (median, below, above) = summary(&mut naive_times);
    let mut line = |what: &str, (time, below, above): (f64, f64, f64)| {
        writeln!(
            out,
            "{particles:>4}  {what:<16} {time:>6.2} ns a link  -{:<2.0} % +{:<3.0} %  {:>5.1} x naive",
            100.0 * below,
            100.0 * above,
            median / time
        )
    };
    line("naive, step", (median, below, above))?;
    for (level, times) in levels.iter().zip(&mut times) {
        for (what, times) in ["links", "step"].into_iter().zip(times) {
            line(&format!("{}, {what}", level.name()), summary(times))?;
        }
    }
    Ok(())
}

fn main() -> std::io::Result<()> {
    // Cargo asks benches that are tested for nothing but to build.
    if std::env::args().any(|argument| argument == "--test") {
        return Ok(());
    }
    [10, 20, 40, 64].into_iter().try_for_each(|particles| compare(particles, &mut std::io::stdout()))
}
