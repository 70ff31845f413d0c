//! Contact of a round body against Hertz's theory: the force that presses a ball on a hard plane, or on a like ball, to a
//! given indentation, and the size of the patch of contact, over ever more cells.
//!
//! ```text
//!    ▔▔▔▔▔▔▔▔▔  plate, comes down by δ              ▔▔▔▔▔▔▔▔▔  by 2 δ
//!      ╭───╮                                          ╭─+─╮
//!      │ + │    middle: R − δ above the plate         ╰───╯    middles: 2 (R − δ) from each other
//!      ╰───╯                                          ╭───╮
//!    ▁▁▁▁▁▁▁▁▁  plate, comes up by δ                  ╰─+─╯
//!                                                   ▁▁▁▁▁▁▁▁▁
//! ```
//!
//! The indentation is measured as the approach of the middle and the plane. Hertz's own is the approach of points far from
//! the patch. Plates press, with no weight and no pins: a pinned middle would stiffen the ball around it, and a weight does
//! not act at the patch. The plates come slowly, then stand until nothing moves.
//!
//! By Hertz a ball of radius R meets a hard plane with the force `F = 4/3 E* √R δ^(3/2)` and the pressure `p₀ √(1 − r²/a²)`
//! on a patch of radius `a = √(R δ)`, where `E* = E/(1 − ν²)`. The second moment of that pressure is `2/5 a²`. The patch is
//! measured by this moment, as a number of particles would grow in steps. Two like balls meet as if a hard plane were
//! between them: with half the modulus, half the radius and twice the approach the formulas give the same force and patch.
//!
//! Hertz's theory has no friction. Two balls on each other between plates without friction buckle aside, so these plates
//! have it. Friction between the balls changes nothing, as both spread alike.
//!
//! A ball of cells has a flat of radius `√(R h)` at its pole, h the edge of a cell, with steps around it. Until it is
//! pressed in by about h only the flat touches, and meets the plane like a punch, with `3/2 √(h/δ)` times Hertz's force. So
//! at a fixed indentation the error shrinks with the cells, and at a fixed number of cells it grows as the indentation
//! shrinks.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::physics::{Arrival, Simulation};
use crate::report::extremes::lattices;
use crate::scene::body::{CellsShape, Pose};
use crate::scene::material::POISSON_RATIO;
use crate::scene::obstacle::{Cuboid, Motion, Oscillate};
use crate::scene::resolve::ResolveError;
use crate::scene::{Body, Material, Obstacle, ObstacleShape, Scene, Shape, Solid};

/// The radius of the balls, m.
const RADIUS: f64 = 0.5;
/// Soft for its mass: the stiffness of contact springs follows from the mass, and they should give way by no more than a
/// fiftieth of a cell.
const SOLID: Solid = Solid { young_modulus: 1e3, density: 1000.0, damping_ratio: 0.5, ..Solid::DEFAULT };
/// How far a ball is pressed into a plane, as a share of its radius; and in metres, which is how far each plate comes.
const INDENTATION: f64 = 0.1;
const PLATE_TRAVEL: f64 = INDENTATION * RADIUS;
/// Half the thickness of the plates, m.
const PLATE_HALF_THICKNESS: f64 = 0.5;
/// The time in which the plates come, s: several times what a wave needs through a ball.
const PRESS_SECS: f64 = 2.0;
/// The step asked for, s.
const STEP_SECS: f64 = 4e-3;
/// A ball is at rest if no particle is faster than this, m/s: a thousandth of the indentation in a second.
const REST_SPEED: f64 = 5e-5;
/// Two balls on each other roll aside in the end. They count as at rest before that if their approach changes by no more
/// than this share over this many checks, which take a second.
const MAX_REST_CHANGE: f64 = 1e-3;
const REST_CHECKS: usize = 5;
/// Friction that keeps two balls on each other.
const FRICTION: f64 = 0.6;
/// Time between two checks whether anything moves, s, and the longest wait.
const CHECK_INTERVAL_SECS: f64 = 0.2;
const MAX_WAIT_SECS: f64 = 30.0;
/// The share by which force and patch may miss theory if the indentation is the edge of a cell; half as much at twice that.
const MAX_ERROR_IN_CELLS: f64 = 1.0;

/// What a ball is pressed on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Counterpart {
    /// A hard plane.
    Plane,
    /// Another ball like it.
    Like,
}

impl Counterpart {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Plane, Self::Like];

    /// Balls between the plates.
    fn balls(self) -> u8 {
        match self {
            Self::Plane => 1,
            Self::Like => 2,
        }
    }

    /// In a word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Plane => "plane",
            Self::Like => "like",
        }
    }
}

/// Numbers of cells across the ball.
fn divisions(quick: bool) -> &'static [u32] {
    if quick { &[10, 20] } else { &[10, 20, 40] }
}

/// Hertz's force (N) and patch radius (m) at an indentation (m).
fn theory(indentation_m: f64) -> [f64; 2] {
    let modulus = SOLID.young_modulus / (1.0 - POISSON_RATIO * POISSON_RATIO);
    let patch = (RADIUS * indentation_m).sqrt();
    [4.0 / 3.0 * modulus * patch * indentation_m, patch]
}

/// The balls between plates that are coming, or have come.
fn scene(divisions: u32, against: Counterpart, have_come: bool) -> Scene {
    let balls = f64::from(against.balls());
    let friction = if against == Counterpart::Plane { 0.0 } else { FRICTION };
    let ball = |number: u8| Body {
        shape: ball(divisions),
        pose: Pose { position: [0.0, RADIUS * (2.0 * f64::from(number) + 1.0 - balls), 0.0], ..Pose::default() },
        material: Material::Solid(SOLID),
        self_collides: false,
        friction_static: friction,
        friction_dynamic: friction,
        ..Body::default()
    };
    let amplitude = balls * PLATE_TRAVEL;
    let plate = |side: f64| {
        let travel = if have_come { amplitude } else { 0.0 };
        let center = [0.0, side * (balls * RADIUS + PLATE_HALF_THICKNESS - travel), 0.0];
        let shape =
            Cuboid { center, half_extents: [2.0 * RADIUS, PLATE_HALF_THICKNESS, 2.0 * RADIUS], ..Cuboid::default() };
        let coming = Oscillate { axis: [0.0, -side, 0.0], amplitude, period_secs: 4.0 * PRESS_SECS };
        Obstacle {
            shape: ObstacleShape::Box(shape),
            motion: (!have_come).then_some(Motion::Oscillate(coming)),
            friction_static: friction,
            friction_dynamic: friction,
            ..Obstacle::default()
        }
    };
    let bodies = (0..against.balls()).map(ball).collect();
    let mut scene = Scene { bodies, obstacles: [-1.0, 1.0].map(plate).to_vec(), ..Scene::default() };
    scene.settings.gravity = [0.0; 3];
    scene.settings.dt = STEP_SECS;
    scene.settings.sleeping = false;
    scene
}

/// The cells whose middle lies in a ball of `divisions` cells across.
fn ball(divisions: u32) -> Shape {
    let middle = 0.5 * f64::from(divisions);
    let along = i32::try_from(divisions).unwrap_or(i32::MAX);
    let is_in = |cell: &[i32; 3]| (DVec3::from(cell.map(f64::from)) + 0.5 - middle).length() <= middle;
    let all = (0..along).flat_map(|z| (0..along).flat_map(move |y| (0..along).map(move |x| [x, y, z])));
    let list = all.filter(is_in).collect();
    Shape::Cells(CellsShape { list, size: 2.0 * RADIUS / f64::from(divisions) })
}

/// One resolution; the names are those of the table and the JSON object.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the names are the keys of the JSON object")]
pub struct HertzRow {
    pub against: Counterpart,
    pub divisions: u32,
    /// Of all balls.
    pub particles: usize,
    /// The approach of the middle and the plane, or half the approach of the middles.
    pub indentation_m: f64,
    pub force_n: f64,
    pub force_over_theory: f64,
    /// Radius of a patch with Hertz's pressure and the measured second moment.
    pub patch_radius_m: f64,
    pub patch_over_theory: f64,
    /// Contact points that push.
    pub points: usize,
    /// The simulated time until nothing moved; none where something still moved.
    pub rest_secs: Option<f64>,
}

impl HertzRow {
    /// The larger one of the errors of force and patch, as a share of theory.
    pub fn error(&self) -> f64 {
        (self.force_over_theory - 1.0).abs().max((self.patch_over_theory - 1.0).abs())
    }

    /// The intended indentation, in cells.
    pub fn cells_deep(&self) -> f64 {
        0.5 * f64::from(self.divisions) * INDENTATION
    }
}

/// The measurements; the names are those of the JSON object.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the names are the keys of the JSON object")]
pub struct HertzFigures {
    pub rows: Vec<HertzRow>,
    /// Whether all balls came to rest and the errors shrink with the cells.
    pub passed: bool,
}

/// Presses balls of ever more cells; of fewer if `quick`.
///
/// # Errors
/// If a shape cannot be made, which no ball should cause.
pub fn measure(quick: bool) -> Result<HertzFigures, ResolveError> {
    let pressed = |against| divisions(quick).iter().map(move |divisions| pressed(*divisions, against));
    let rows: Vec<_> = Counterpart::ALL.into_iter().flat_map(pressed).collect::<Result<_, _>>()?;
    let passed = rows.chunk_by(|a, b| a.against == b.against).all(converges);
    Ok(HertzFigures { rows, passed })
}

/// Whether all rows came to rest, miss by less the finer they are, and by no more than their cells account for.
fn converges(rows: &[HertzRow]) -> bool {
    let shrinks = rows.windows(2).all(|pair| pair[1].error() < pair[0].error());
    let good = |row: &HertzRow| row.rest_secs.is_some() && row.cells_deep() * row.error() <= MAX_ERROR_IN_CELLS;
    shrinks && rows.iter().all(good)
}

/// Presses until nothing moves.
fn pressed(divisions: u32, against: Counterpart) -> Result<HertzRow, ResolveError> {
    let coming = scene(divisions, against, false);
    let lattices = lattices(&coming)?;
    let mut simulation = Simulation::<f64>::new(&coming, &lattices);
    simulation.run_for(PRESS_SECS);
    // The plates sweep to their final places.
    simulation.set_parameters(&scene(divisions, against, true), &lattices, &[Some(0), Some(1)], Arrival::Swept);
    let (mut rest_secs, mut indentations) = (None, Vec::new());
    while rest_secs.is_none() && simulation.state().time_secs < MAX_WAIT_SECS {
        if simulation.run_for(CHECK_INTERVAL_SECS).diverged {
            break;
        }
        indentations.push(indentation(&simulation, against));
        let is_still = match against {
            Counterpart::Plane => simulation.diagnostics().max_speed < REST_SPEED,
            Counterpart::Like => {
                indentations.len() > REST_CHECKS
                    && changes(&indentations[indentations.len() - 1 - REST_CHECKS..]) < MAX_REST_CHANGE
            }
        };
        rest_secs = is_still.then_some(simulation.state().time_secs);
    }
    Ok(row(divisions, against, &simulation, rest_secs))
}

fn row(divisions: u32, against: Counterpart, simulation: &Simulation<f64>, rest_secs: Option<f64>) -> HertzRow {
    let indentation_m = indentation(simulation, against);
    let pushes = match against {
        Counterpart::Plane => pushes_on_plate(simulation),
        Counterpart::Like => pushes_on_like(simulation),
    };
    let force_n: f64 = pushes.iter().map(|(_, force)| force).sum();
    let moment: f64 = pushes.iter().map(|(squared, force)| squared * force).sum();
    let patch_radius_m = (2.5 * moment / force_n).sqrt();
    let [force, patch] = theory(indentation_m);
    HertzRow {
        against,
        divisions,
        particles: simulation.model().particle_count(),
        indentation_m,
        force_n,
        force_over_theory: force_n / force,
        patch_radius_m,
        patch_over_theory: patch_radius_m / patch,
        points: pushes.len(),
        rest_secs,
    }
}

/// The approach of the middle and the plane, or half the approach of the middles, m.
fn indentation(simulation: &Simulation<f64>, against: Counterpart) -> f64 {
    match against {
        Counterpart::Plane => PLATE_TRAVEL - middle(simulation, 0),
        Counterpart::Like => RADIUS - 0.5 * (middle(simulation, 1) - middle(simulation, 0)),
    }
}

/// The spread of some values over the last.
fn changes(indentations: &[f64]) -> f64 {
    let least = indentations.iter().copied().fold(f64::INFINITY, f64::min);
    let most = indentations.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    (most - least) / indentations.last().copied().unwrap_or(f64::NAN)
}

/// The height of the particle that was nearest to the middle of a ball at the start, m.
fn middle(simulation: &Simulation<f64>, ball: usize) -> f64 {
    let body = &simulation.model().bodies[ball];
    let start = &body.start;
    let middle = start.iter().sum::<DVec3>() / start.len() as f64;
    let nearest = (simulation.state().position[body.particles.clone()].iter().zip(start))
        .min_by(|(_, a), (_, b)| a.distance_squared(middle).total_cmp(&b.distance_squared(middle)));
    nearest.map_or(f64::NAN, |(now, _)| now.y)
}

/// The particles that push the lower plate: the square of their distance from the axis, m², and the force, N.
fn pushes_on_plate(simulation: &Simulation<f64>) -> Vec<(f64, f64)> {
    let on_plate = simulation.contacts().iter().filter(|contact| contact.obstacle == 0 && contact.force.y > 0.0);
    on_plate.map(|contact| (from_axis(simulation, contact.particle), contact.force.y)).collect()
}

/// The contact points of both balls that push the other ball: the square of their distance from the axis, m², and the force,
/// N.
fn pushes_on_like(simulation: &Simulation<f64>) -> Vec<(f64, f64)> {
    let all =
        simulation.body_contacts().iter().map(|contact| (contact.own.place(simulation.state()), contact.force.y.abs()));
    all.filter(|(_, force)| *force > 0.0).map(|(at, force)| (at.x * at.x + at.z * at.z, force)).collect()
}

fn from_axis(simulation: &Simulation<f64>, particle: usize) -> f64 {
    let at = simulation.state().position[particle];
    at.x * at.x + at.z * at.z
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(divisions: u32, force_over_theory: f64) -> HertzRow {
        HertzRow {
            against: Counterpart::Plane,
            divisions,
            particles: 1,
            indentation_m: 0.05,
            force_n: 1.0,
            force_over_theory,
            patch_radius_m: 0.1,
            patch_over_theory: 1.0,
            points: 1,
            rest_secs: Some(1.0),
        }
    }

    #[test]
    fn what_does_not_converge_or_rest_fails() {
        assert!(converges(&[row(10, 1.4), row(20, 1.2)]), "half the error");
        assert!(!converges(&[row(10, 1.2), row(20, 0.7)]), "a larger one");
        assert!(!converges(&[row(10, 9.0), row(20, 8.0)]), "smaller, but far off");
        let moving = HertzRow { rest_secs: None, ..row(20, 1.2) };
        assert!(!converges(&[row(10, 1.4), moving]), "it moves");
    }

    #[test]
    fn a_ball_of_cells_has_the_volume_of_the_ball_and_a_flat_at_its_pole() {
        let Shape::Cells(CellsShape { list, size }) = ball(20) else { panic!("cells") };
        let volume = list.len() as f64 * size * size * size;
        let round = 4.0 / 3.0 * std::f64::consts::PI * RADIUS * RADIUS * RADIUS;
        assert!((volume / round - 1.0).abs() < 0.01, "{volume} m³ of {round} m³");
        let flat = list.iter().filter(|cell| cell[1] == 0).count() as f64;
        let radius = (flat / std::f64::consts::PI).sqrt() * size;
        assert!((radius / (RADIUS * size).sqrt() - 1.0).abs() < 0.05, "a flat of {radius} m");
    }
}
