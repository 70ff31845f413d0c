//! The same bits every time; live changes keep the motion; a step allocates nothing.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use gelatin::physics::{Arrival, SimdLevel};
use gelatin::scene::body::Inlay;
use gelatin::scene::material::Solid;
use gelatin::scene::settings::Integrator;
use gelatin::scene::{Material, Scene};

use crate::support::{ball, cube, falling, lattices, plane, run, simulate, springs};

fn landing() -> Scene {
    let mut scene = falling(cube(5, 1.0, springs(40.0, 0.2, 0.01), [0.0, 0.7, 0.0]));
    scene.bodies[0].pose.rotation_deg = [10.0, 20.0, 30.0];
    scene.obstacles = vec![plane([0.0; 3], [0.0; 3], [0.6, 0.5]), ball([0.8, 0.3, 0.0], 0.4)];
    scene
}

#[test]
fn the_same_scene_gives_the_same_bits_and_another_one_does_not() {
    let hash = |scene: &Scene| {
        let mut simulation = simulate::<f32>(scene);
        run(&mut simulation, 1.0);
        simulation.hash()
    };
    assert_eq!(hash(&landing()), hash(&landing()), "twice the same");
    let mut other = landing();
    other.bodies[0].velocity[0] = 1e-6;
    assert_ne!(hash(&landing()), hash(&other), "a breath of wind is another motion");
}

#[test]
fn every_level_of_vector_instructions_gives_the_same_bits() {
    let mut solid = landing();
    solid.bodies[0].material = Material::Solid(Solid { young_modulus: 2e4, ..Solid::default() });
    let mut stiff = landing();
    stiff.bodies[0].material = Material::Springs(springs(1e6, 0.2, 0.01));
    stiff.settings.integrator = Integrator::Implicit;
    let mut mixed = landing();
    let other = springs(90.0, 0.3, 0.02);
    mixed.bodies[0].inlays = vec![Inlay { min: [0.0, -1.0, -1.0], max: [1.0; 3], springs: other, ..Inlay::default() }];
    for scene in [landing(), solid, stiff, mixed] {
        let hash = |level: SimdLevel| {
            let mut simulation = simulate::<f32>(&scene);
            simulation.plan_mut().simd = level;
            run(&mut simulation, 1.0);
            simulation.hash()
        };
        let levels = SimdLevel::ALL.into_iter().filter(|level| level.is_available());
        let hashes: Vec<_> = levels.map(|level| (level.name(), hash(level))).collect();
        assert!(hashes.iter().all(|(_, hash)| *hash == hashes[0].1), "{hashes:x?}");
    }
}

/// Checks that a scene moves alike with and without the broad phase, at every level of vector instructions and by several
/// threads, for `secs`. Returns the narrow tests with the broad phase and without.
pub(crate) fn assert_the_same_however_found(scene: &Scene, secs: f64) -> [u64; 2] {
    let integrator = scene.settings.integrator;
    let run_with = |level: SimdLevel, threads: usize, broad_phase: bool| {
        let mut simulation = simulate::<f32>(scene);
        simulation.plan_mut().simd = level;
        simulation.plan_mut().broad_phase = broad_phase;
        simulation.set_threads(threads);
        let report = within(threads, || simulation.run_for(secs));
        (simulation.hash(), report.counters.narrow_tests)
    };
    let (hash, with) = run_with(SimdLevel::Portable, 1, true);
    let (same, without) = run_with(SimdLevel::Portable, 1, false);
    assert_eq!(hash, same, "{integrator:?}: without the broad phase");
    for level in SimdLevel::ALL.into_iter().filter(|level| level.is_available()) {
        for threads in [1, 3] {
            assert_eq!(run_with(level, threads, true).0, hash, "{integrator:?}: {level:?} with {threads} threads");
        }
    }
    [with, without]
}

/// Does some work in a pool of `threads` threads.
pub(crate) fn within<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads").install(work)
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let mut several = landing();
    several.bodies.extend([landing().bodies[0].clone(), landing().bodies[0].clone()]);
    several.bodies[1].pose.position[1] += 2.0;
    several.bodies[1].material = Material::Solid(Solid { young_modulus: 2e4, ..Solid::default() });
    several.bodies[2].pose.position[1] += 4.0;
    let mut stiff = several.clone();
    stiff.bodies.truncate(2);
    stiff.bodies[0].material = Material::Springs(springs(1e6, 0.2, 0.01));
    stiff.bodies[1].material = Material::Springs(springs(1e5, 0.2, 0.01));
    stiff.settings.integrator = Integrator::Implicit;
    let mut stabilised = landing();
    stabilised.bodies[0] = cube(17, 1.0, springs(40.0, 0.2, 0.01), [0.0, 0.52, 0.0]);
    stabilised.settings.integrator = Integrator::Stabilised;
    for (scene, seconds) in [(landing(), 0.7), (several, 0.7), (stiff, 0.3), (stabilised, 0.05)] {
        for level in SimdLevel::ALL.into_iter().filter(|level| level.is_available()) {
            let hash = |threads: usize| {
                let mut simulation = simulate::<f32>(&scene);
                simulation.plan_mut().simd = level;
                simulation.set_threads(threads);
                within(threads, || run(&mut simulation, seconds));
                simulation.hash()
            };
            let hashes = [1, 2, 3, 8].map(hash);
            assert!(hashes.iter().all(|hash| *hash == hashes[0]), "{hashes:x?} at {level:?}");
        }
    }
}

#[test]
fn a_new_parameter_keeps_positions_and_velocities() {
    let mut scene = landing();
    let mut simulation = simulate::<f32>(&scene);
    run(&mut simulation, 0.4);
    let before = simulation.state().clone();
    let Material::Springs(material) = &mut scene.bodies[0].material else { unreachable!("a body of springs") };
    material.bending.stiffness *= 3.0;
    simulation.set_parameters(&scene, &lattices(&scene), &[Some(0)], Arrival::Swept);
    assert_eq!(simulation.state().position, before.position, "everything stays where it is");
    assert_eq!(simulation.state().velocity, before.velocity, "and goes on as fast");
    assert_eq!(simulation.state().side, before.side, "and touches what it touched");
    let mut unchanged = simulate::<f32>(&landing());
    unchanged.set_state(before);
    run(&mut simulation, 0.1);
    run(&mut unchanged, 0.1);
    assert_ne!(simulation.hash(), unchanged.hash(), "but the change acts");
}

#[test]
fn a_step_allocates_nothing() {
    let mut simulation = simulate::<f32>(&landing());
    run(&mut simulation, 1.0);
    let before = allocations();
    for _ in 0..50 {
        simulation.step();
    }
    assert_eq!(allocations() - before, 0, "fifty steps in contact");
    drop(Box::new(before));
    assert!(allocations() > before, "the counter counts");
    simulation.set_threads(2);
    let by_two = within(2, || {
        simulation.step();
        let before = allocations();
        for _ in 0..50 {
            simulation.step();
        }
        allocations() - before
    });
    assert_eq!(by_two, 0, "fifty steps by two threads, on the one that asks");
}

thread_local! {
    static COUNT: Cell<u64> = const { Cell::new(0) };
}

/// How often this thread has allocated.
pub(crate) fn allocations() -> u64 {
    COUNT.with(Cell::get)
}

struct Counting;

#[expect(unsafe_code, reason = "an allocator that counts can only be had by implementing the trait")]
// SAFETY: every call is passed on to the system's allocator unchanged; counting touches only a thread-local integer
// that needs no allocation.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let _ = COUNT.try_with(|count| count.set(count.get() + 1));
        // SAFETY: the caller's promise about `layout` is the one the system's allocator asks for.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: `pointer` came from `alloc` above with this layout, that is from the system's allocator.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;
