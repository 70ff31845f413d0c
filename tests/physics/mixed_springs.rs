//! Bodies of several springs: a link has the mean of the cells that share it.

use gelatin::geometry::Family;
use gelatin::physics::Simulation;
use gelatin::report::statics::{Linear, dot, face_load, mean_displacement};
use gelatin::scene::body::Inlay;
use gelatin::scene::settings::Integrator;
use gelatin::scene::{Body, Scene, Springs};
use glam::DVec3;

use crate::support::{alone, ball, cube, falling, plane, run, simulate, springs};

/// Springs that are alike along and across the axes, like a solid of 1 m with cells of 1/6 m.
fn isotropic(times: f64) -> Springs {
    let mut springs = springs(0.0, 0.0, 0.01);
    springs.structural.stiffness = times * 2.246_71;
    springs.shear.stiffness = times;
    springs
}

/// An inlay of these springs in the half of greater x.
fn half(springs: Springs) -> Inlay {
    Inlay { min: [0.0, -9.0, -9.0], max: [9.0; 3], springs, ..Inlay::default() }
}

fn with(mut body: Body, inlays: Vec<Inlay>) -> Body {
    body.inlays = inlays;
    body
}

/// The stretch of a cube of 6 cells an edge under a pull of 1 N at both ends along x, m.
fn stretch(springs: Springs, inlays: Vec<Inlay>) -> f64 {
    let body = with(cube(6, 1.0, springs, [0.0; 3]), inlays);
    let body = Linear::of(&simulate::<f64>(&alone(body, 1e-3)).model().bodies[0]);
    let on = |direction: DVec3| face_load(&body, DVec3::ONE, 1.0 / 6.0, direction, direction);
    let load: Vec<DVec3> = on(DVec3::X).iter().zip(on(DVec3::NEG_X)).map(|(a, b)| *a + b).collect();
    let displacement = body.solve(&load).expect("it is in balance");
    let stretch = mean_displacement(&load, &displacement);
    assert!((dot(&load, &displacement) / stretch).is_finite(), "it gives way");
    stretch
}

#[test]
fn two_halves_stretch_like_springs_in_a_row() {
    let [soft, stiff] = [1.0, 6.0].map(isotropic);
    let [all_soft, all_stiff] = [soft, stiff].map(|springs| stretch(springs, Vec::new()));
    assert!((all_soft / all_stiff - 6.0).abs() < 1e-6, "{all_soft} and {all_stiff} m");
    let in_a_row = 0.5 * (all_soft + all_stiff);
    for (outside, inside) in [(soft, stiff), (stiff, soft)] {
        let share = stretch(outside, vec![half(inside)]) / in_a_row;
        // Where the halves meet, each keeps the other from growing thinner.
        assert!((0.93..1.0).contains(&share), "{share} of halves that do not hold each other");
    }
}

/// A cube that lands aslant on the ground and a ball; one half of it is stiffer and heavier.
fn landing(integrator: Integrator) -> Scene {
    let own = springs(30.0, 0.15, 0.01);
    let body = with(cube(5, 1.0, own, [0.0, 0.8, 0.0]), vec![half(springs(120.0, 0.3, 0.03))]);
    let mut scene = falling(body);
    scene.bodies[0].pose.rotation_deg = [10.0, 20.0, 30.0];
    scene.obstacles = vec![plane([0.0; 3], [0.0; 3], [0.6, 0.5]), ball([0.8, 0.3, 0.0], 0.4)];
    scene.settings.integrator = integrator;
    scene
}

#[test]
fn by_every_scheme_it_lands_and_gains_nothing() {
    for integrator in Integrator::ALL {
        if integrator == Integrator::Explicit {
            continue;
        }
        let mut simulation: Simulation<f64> = simulate(&landing(integrator));
        let energy = |simulation: &Simulation<f64>| simulation.diagnostics().energy.total();
        let (start, mut most) = (energy(&simulation), f64::NEG_INFINITY);
        for _ in 0..20 {
            run(&mut simulation, 0.2);
            most = most.max(energy(&simulation));
        }
        assert!(most < 1.001 * start, "{integrator:?}: {most} J of {start} J");
    }
}

#[test]
fn inlays_of_the_same_springs_change_no_bit() {
    let hash = |inlays: Vec<Inlay>| {
        let mut scene = landing(Integrator::SemiImplicit);
        scene.bodies[0].inlays = inlays;
        let mut simulation = simulate::<f32>(&scene);
        run(&mut simulation, 0.5);
        simulation.hash()
    };
    let same = springs(30.0, 0.15, 0.01);
    assert_eq!(hash(vec![half(same)]), hash(Vec::new()), "as if there were none");
    let mut other = same;
    other.family_mut(Family::Bending).damping *= 1.001;
    assert_ne!(hash(vec![half(other)]), hash(Vec::new()), "and a breath of other springs is another motion");
}
