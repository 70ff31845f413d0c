//! Contact of round bodies against Hertz's theory: how hard a ball has to be pressed to be indented so far, and how large
//! the patch becomes that it is pressed on, for a hard plane and for its like, over ever more cells.
//!
//! ```text
//!    ▔▔▔▔▔▔▔▔▔  plate, comes down by δ          ▔▔▔▔▔▔▔▔▔  2 δ
//!      ╭───╮                                      ╭───╮
//!      │ + │    middle: R − δ above the plate     │ + │
//!      ╰───╯                                      ╰───╯   middles: 2 R − 2 δ from each other
//!    ▁▁▁▁▁▁▁▁▁  plate, comes up by δ              ╭───╮
//!                                                 │ + │
//!                                                 ╰───╯
//!                                               ▁▁▁▁▁▁▁▁▁  2 δ
//! ```
//!
//! The indentation is measured as the approach of the middles, or of the middle and the plane: Hertz's own, that of points
//! far from the patch. Plates press, with no weight and no pins: a pinned middle would stiffen the ball around it, and a
//! weight is not a force at the patch. The plates come slowly, then stand until nothing moves.
//!
//! By Hertz a ball of radius R meets a hard plane with `F = 4/3 E* √R δ^(3/2)` and the pressure `p₀ √(1 − r²/a²)` on a patch
//! of radius `a = √(R δ)`, where `E* = E/(1 − ν²)`; a ball meets its like as one of R/2 and E*/2. The second moment of that
//! pressure is `2/5 a²`, by which the patch is measured: a number of particles would go up in steps.
//!
//! A ball of cells has a flat of radius `√(R h)` at its pole, h the edge of a cell, with steps around it. Until it is pressed
//! in by about h only the flat touches, and it is met like a punch, too hard: by `3/2 √(h/δ)` times Hertz's force. So at one
//! indentation the error shrinks with the cells, and with one number of cells it grows the less a ball is indented.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::physics::{Arrival, Simulation};
use crate::report::extremes::lattices;
use crate::scene::body::{CellsShape, Pose};
use crate::scene::obstacle::{Cuboid, Motion, Oscillate};
use crate::scene::resolve::ResolveError;
use crate::scene::{Body, Material, Obstacle, ObstacleShape, Scene, Shape, Solid};

/// The radius of the balls, m.
const RADIUS: f64 = 0.5;
/// Soft for their mass, so that the springs of contact, whose stiffness goes by mass, give way by no more than a fiftieth of
/// a cell.
const SOLID: Solid = Solid { young_modulus: 1e3, density: 1000.0, damping_ratio: 0.5 };
/// Of every lattice of central forces.
const POISSON_RATIO: f64 = 0.25;
/// How far a ball is pressed into a plane, as a share of its radius.
const INDENTATION: f64 = 0.1;
/// Half of what the plates are thick, m.
const PLATE: f64 = 0.5;
/// The plates come in this time, s: several times what a wave needs through a ball.
const PRESS_SECS: f64 = 2.0;
/// The step that is asked for, s.
const STEP_SECS: f64 = 4e-3;
/// How often it is looked whether anything moves, s, and for how long at most.
const LOOK_SECS: f64 = 0.2;
const LONGEST_SECS: f64 = 30.0;
/// No particle is faster where a ball is at rest, m/s: over a second that is a thousandth of the indentation.
const REST_SPEED: f64 = 5e-5;
/// The force and the patch may miss theory by so much where a ball is indented by the edge of a cell, half as much at twice that.
const MOST_ERROR: f64 = 1.0;

/// What a ball is pressed on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Case {
    /// A plane that gives way nowhere.
    Plane,
    /// Another ball of the same cells.
    Like,
}

impl Case {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Plane, Self::Like];

    /// The name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Plane => "a ball on a hard plane",
            Self::Like => "a ball on its like",
        }
    }

    /// Cells across the ball.
    pub fn divisions(quick: bool) -> &'static [u32] {
        if quick { &[10, 20] } else { &[10, 20, 40] }
    }

    /// Where the middles are before anything is pressed, m.
    fn middles(self) -> Vec<DVec3> {
        match self {
            Self::Plane => vec![DVec3::ZERO],
            Self::Like => vec![DVec3::NEG_Y * RADIUS, DVec3::Y * RADIUS],
        }
    }

    /// Theory's radius (m) and modulus (Pa): those of a ball on a hard plane that would do the same.
    fn alone(self) -> [f64; 2] {
        let modulus = SOLID.young_modulus / (1.0 - POISSON_RATIO * POISSON_RATIO);
        match self {
            Self::Plane => [RADIUS, modulus],
            Self::Like => [0.5 * RADIUS, 0.5 * modulus],
        }
    }

    /// What the plates rub with. A plane must not, in Hertz's theory. Balls that are alike do not move along each other where
    /// they touch, so that friction changes nothing between them, and without it they would give way sideways.
    fn friction(self) -> [f64; 2] {
        match self {
            Self::Plane => [0.0; 2],
            Self::Like => [0.6, 0.5],
        }
    }

    /// How far each plate comes, m: all of the contacts between two plates are pressed alike.
    fn way(self) -> f64 {
        INDENTATION * RADIUS * self.middles().len() as f64
    }

    /// The force (N) and the radius of the patch (m) at an indentation (m), by Hertz.
    fn theory(self, indentation_m: f64) -> [f64; 2] {
        let [radius, modulus] = self.alone();
        let patch = (radius * indentation_m).sqrt();
        [4.0 / 3.0 * modulus * patch * indentation_m, patch]
    }

    /// The balls between plates that are on their way, or have come.
    fn scene(self, divisions: u32, have_come: bool) -> Scene {
        let ball = |middle: &DVec3| Body {
            shape: ball(divisions),
            material: Material::Solid(SOLID),
            pose: Pose { position: middle.to_array(), ..Pose::default() },
            self_collides: false,
            ..Body::default()
        };
        let middles = self.middles();
        let friction = self.friction();
        let plate = |side: f64| {
            let way = if have_come { self.way() } else { 0.0 };
            let center = [0.0, side * (RADIUS * middles.len() as f64 + PLATE - way), 0.0];
            let shape = Cuboid { center, half_extents: [2.0 * RADIUS, PLATE, 2.0 * RADIUS], ..Cuboid::default() };
            let coming = Oscillate { axis: [0.0, -side, 0.0], amplitude: self.way(), period_secs: 4.0 * PRESS_SECS };
            Obstacle {
                shape: ObstacleShape::Box(shape),
                motion: (!have_come).then_some(Motion::Oscillate(coming)),
                friction_static: friction[0],
                friction_dynamic: friction[1],
                ..Obstacle::default()
            }
        };
        let obstacles = [-1.0, 1.0].map(plate).to_vec();
        let mut scene = Scene { bodies: middles.iter().map(ball).collect(), obstacles, ..Scene::default() };
        scene.settings.gravity = [0.0; 3];
        scene.settings.dt = STEP_SECS;
        scene.settings.sleeping = false;
        scene
    }
}

/// The cells whose middle is in a ball of so many across.
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
    pub divisions: u32,
    pub particles: usize,
    /// How far the middles, or the middle and the plane, have come nearer.
    pub indentation_m: f64,
    pub force_n: f64,
    pub force_over_theory: f64,
    /// Of a patch whose pressure is Hertz's, by its second moment.
    pub patch_radius_m: f64,
    pub patch_over_theory: f64,
    /// Particles that push.
    pub points: usize,
    /// The simulated time until nothing moved; none where something still did.
    pub rest_secs: Option<f64>,
}

impl HertzRow {
    /// The larger one of the errors of force and patch, as a share of theory.
    pub fn error(&self) -> f64 {
        (self.force_over_theory - 1.0).abs().max((self.patch_over_theory - 1.0).abs())
    }

    /// How many cells each ball was to be indented by.
    pub fn cells_deep(&self) -> f64 {
        0.5 * f64::from(self.divisions) * INDENTATION
    }
}

/// What was measured of one case; the names are those of the JSON object.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the names are the keys of the JSON object")]
pub struct HertzFigures {
    pub case: String,
    pub rows: Vec<HertzRow>,
    /// Whether all came to rest and the errors shrink as the cells do.
    pub passed: bool,
}

/// Measures a case at each of these numbers of cells across the ball, in their order.
///
/// # Errors
/// If a shape cannot be made, which no ball should cause.
pub fn measure(case: Case, divisions: &[u32]) -> Result<HertzFigures, ResolveError> {
    let rows: Vec<_> = divisions.iter().map(|&divisions| pressed(case, divisions)).collect::<Result<_, _>>()?;
    Ok(HertzFigures { case: case.name().to_owned(), passed: converges(&rows), rows })
}

/// Whether all rows are at rest and miss by less the finer they are, and by no more than their cells account for.
fn converges(rows: &[HertzRow]) -> bool {
    let shrinks = rows.windows(2).all(|pair| pair[1].error() < pair[0].error());
    let good = |row: &HertzRow| row.rest_secs.is_some() && row.cells_deep() * row.error() <= MOST_ERROR;
    shrinks && rows.iter().all(good)
}

/// Presses until nothing moves.
fn pressed(case: Case, divisions: u32) -> Result<HertzRow, ResolveError> {
    let coming = case.scene(divisions, false);
    let lattices = lattices(&coming)?;
    let mut simulation = Simulation::<f64>::new(&coming, &lattices);
    simulation.run_for(PRESS_SECS);
    // They sweep to where they are.
    simulation.set_parameters(&case.scene(divisions, true), &lattices, &[Some(0), Some(1)], Arrival::Swept);
    let mut rest_secs = None;
    while rest_secs.is_none() && simulation.state().time_secs < LONGEST_SECS {
        if simulation.run_for(LOOK_SECS).diverged {
            break;
        }
        let is_still = simulation.diagnostics().max_speed < REST_SPEED;
        rest_secs = is_still.then_some(simulation.state().time_secs);
    }
    Ok(row(case, divisions, &simulation, rest_secs))
}

fn row(case: Case, divisions: u32, simulation: &Simulation<f64>, rest_secs: Option<f64>) -> HertzRow {
    let middles: Vec<f64> = (0..case.middles().len()).map(|body| middle(simulation, body)).collect();
    let indentation_m = match middles[..] {
        [low, high] => 2.0 * RADIUS - (high - low),
        _ => RADIUS - (middles[0] + RADIUS - case.way()),
    };
    let pushes = pushes(case, simulation);
    let force_n: f64 = pushes.iter().map(|(_, force)| force).sum();
    let moment: f64 = pushes.iter().map(|(squared, force)| squared * force).sum();
    let patch_radius_m = (2.5 * moment / force_n).sqrt();
    let [force, patch] = case.theory(indentation_m);
    HertzRow {
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

/// How high the particle is now that is nearest to the middle of a body at its start, m.
fn middle(simulation: &Simulation<f64>, body: usize) -> f64 {
    let body = &simulation.model().bodies[body];
    let middle = body.start.iter().sum::<DVec3>() / body.start.len() as f64;
    let nearest = body
        .particles
        .clone()
        .zip(&body.start)
        .min_by(|(_, a), (_, b)| a.distance_squared(middle).total_cmp(&b.distance_squared(middle)));
    nearest.map_or(f64::NAN, |(particle, _)| simulation.state().position[particle].y)
}

/// The particles that push at the lower plate, or at the other ball: the square of their distance from the axis, m², and the
/// force, N. Between balls either's points push at the other.
fn pushes(case: Case, simulation: &Simulation<f64>) -> Vec<(f64, f64)> {
    let away = |particle: usize| {
        let at = simulation.state().position[particle];
        at.x * at.x + at.z * at.z
    };
    let on_plate = simulation.contacts().iter().filter(|contact| contact.obstacle == 0);
    let on_plate = on_plate.map(|contact| (away(contact.particle), contact.force.y));
    let on_ball = simulation.body_contacts().iter().map(|contact| (away(contact.particle), contact.force.y.abs()));
    let pushes: Vec<_> = if case == Case::Plane { on_plate.collect() } else { on_ball.collect() };
    pushes.into_iter().filter(|(_, force)| *force > 0.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(divisions: u32, force_over_theory: f64) -> HertzRow {
        HertzRow {
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
    fn a_ball_on_its_like_is_one_on_a_plane_at_half_the_approach() {
        let [[on_plane, patch], [on_like, same]] = [Case::Plane.theory(0.05), Case::Like.theory(0.1)];
        assert!((on_like / on_plane - 1.0).abs() < 1e-12 && (patch / same - 1.0).abs() < 1e-12);
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
