//! Disturbs random extreme scenes from outside while time runs: obstacles sweep or jump to other places, bodies are thrown
//! anew or put back.

use std::sync::Arc;

use super::random_source::RandomSource;
use crate::geometry::Lattice;
use crate::math::Real;
use crate::physics::Arrival;
use crate::physics::Simulation;
use crate::scene::Scene;

/// Something that happens to a scene at some time.
#[derive(Clone, Debug, PartialEq)]
pub struct Disturbance {
    /// Simulated time, s.
    pub at_secs: f64,
    /// What.
    pub kind: DisturbanceKind,
}

/// What can happen to a scene while time runs.
#[derive(Clone, Debug, PartialEq)]
pub enum DisturbanceKind {
    /// Replaces the obstacles by those of this scene.
    Obstacles {
        /// The scene from then on; only its obstacles differ.
        scene: Box<Scene>,
        /// Whether the obstacles sweep or jump there.
        arrival: Arrival,
    },
    /// Puts a body back to where it started, deformed as it is.
    Teleport(usize),
    /// Gives a body the velocity it started with.
    Throw(usize),
}

/// The share of random scenes that are disturbed.
const DISTURBED_SHARE: f64 = 0.25;

/// Draws what happens to a random scene: to most, nothing. The draws are separate from those that make the scene, so the
/// scene stays the same. Scenes of two bodies are left alone, as work from outside is judged for all bodies together.
pub(super) fn disturbances(random: &mut RandomSource, scene: &Scene, size: f64) -> Vec<Disturbance> {
    if !random.chance(DISTURBED_SHARE) || scene.bodies.len() != 1 {
        return Vec::new();
    }
    let mut now = scene.clone();
    let mut at_secs = 0.0;
    let events = 0..random.integer(1, 3);
    events
        .map(|_| {
            at_secs += random.log_uniform(-3.0, -0.2);
            let kind = match random.integer(0, 5) {
                0 => DisturbanceKind::Teleport(0),
                1 => DisturbanceKind::Throw(0),
                _ => {
                    move_obstacle(random, &mut now, size);
                    let arrival = if random.chance(0.6) { Arrival::Swept } else { Arrival::Placed };
                    DisturbanceKind::Obstacles { scene: Box::new(now.clone()), arrival }
                }
            };
            Disturbance { at_secs, kind }
        })
        .collect()
}

fn move_obstacle(random: &mut RandomSource, scene: &mut Scene, size: f64) {
    let displacement = random.vector(size);
    let turn = random.vector(90.0);
    let last = scene.obstacles.len() - 1;
    let number = random.integer(0, i32::try_from(last).unwrap_or(0));
    let add = |at: &mut [f64; 3], by: [f64; 3]| at.iter_mut().zip(by).for_each(|(at, by)| *at += by);
    if let Some(obstacle) = scene.obstacles.get_mut(usize::try_from(number).unwrap_or(0)) {
        add(obstacle.shape.center_mut(), displacement);
        if let Some(rotation_deg) = obstacle.shape.rotation_deg_mut() {
            add(rotation_deg, turn);
        }
    }
}

impl Disturbance {
    /// What happens, in words.
    pub fn words(&self) -> String {
        match &self.kind {
            DisturbanceKind::Obstacles { arrival: Arrival::Swept, .. } => "obstacles sweep to other places".to_owned(),
            DisturbanceKind::Obstacles { arrival: Arrival::Placed, .. } => {
                "obstacles are at once in other places".to_owned()
            }
            DisturbanceKind::Teleport(body) => format!("body {body} is put back to where it started"),
            DisturbanceKind::Throw(body) => format!("body {body} gets the velocity that it started with"),
        }
    }

    /// Carries out the disturbance; `lattices` are those of the scene's bodies.
    pub(super) fn apply<R: Real>(&self, simulation: &mut Simulation<R>, scene: &Scene, lattices: &[Arc<Lattice>]) {
        match &self.kind {
            DisturbanceKind::Obstacles { scene, arrival } => {
                let kept: Vec<Option<usize>> = (0..scene.obstacles.len()).map(Some).collect();
                simulation.set_parameters(scene, lattices, &kept, *arrival);
            }
            DisturbanceKind::Teleport(body) => {
                let rotation = scene.bodies[*body].pose.rotation_deg;
                simulation.teleport_body(*body, rotation, rotation);
            }
            DisturbanceKind::Throw(body) => simulation.throw_body(*body),
        }
    }
}
