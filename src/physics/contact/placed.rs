//! Where obstacles are as bodies meet them: at their places in the model, or on their way there.

use super::{approach, moving};
use crate::math::Real;
use crate::physics::model::{Model, ObstacleModel};
use crate::physics::state::State;

/// The obstacles of a model in a substep. Follows from model and state; kept so that it is filled without allocating.
#[derive(Clone, Debug)]
pub struct Placed<R: Real> {
    obstacles: Vec<ObstacleModel<R>>,
    displaced: Vec<Displaced<R>>,
    /// Whether any is elsewhere than in the model.
    moves: bool,
}

/// An obstacle that one body meets away from its real place: it was put into the body and comes to its place gently.
#[derive(Clone, Debug)]
struct Displaced<R: Real> {
    body: usize,
    obstacle: usize,
    met: ObstacleModel<R>,
}

impl<R: Real> Placed<R> {
    /// The obstacles as a state has them, standing still.
    pub fn now(model: &Model<R>, state: &State<R>) -> Self {
        Self::within(model, state, 0.0)
    }

    /// The obstacles as they move in the `secs` that follow on a state; where that is zero, as they stand.
    pub(in crate::physics) fn within(model: &Model<R>, state: &State<R>, secs: f64) -> Self {
        let displaced = Vec::with_capacity(model.bodies.len() * model.obstacles.len());
        let mut placed = Self { obstacles: model.obstacles.clone(), displaced, moves: true };
        placed.place(model, state, secs);
        placed
    }

    /// Places the obstacles as they move in the next `secs`; where that is zero, as they stand.
    pub(in crate::physics) fn place(&mut self, model: &Model<R>, state: &State<R>, secs: f64) {
        let moves = !state.sweeps.is_empty() || !state.approaches.is_empty() || model.has_moving_obstacle();
        if !moves && !self.moves {
            return;
        }
        self.moves = moves;
        self.obstacles.clone_from(&model.obstacles);
        for (place, arrived) in model.obstacles.iter().enumerate() {
            let sweep = state.sweeps.iter().find(|sweep| sweep.obstacle == place);
            if sweep.is_some() || arrived.motion.is_some() {
                self.obstacles[place] = moving::placed(sweep, arrived, state.time_secs, secs);
            }
        }
        self.displaced.clear();
        for approach in &state.approaches {
            let met = approach::displaced(approach, model, &self.obstacles[approach.obstacle], secs);
            self.displaced.push(Displaced { body: approach.body, obstacle: approach.obstacle, met });
        }
    }

    /// All obstacles where they are.
    pub fn all(&self) -> &[ObstacleModel<R>] {
        &self.obstacles
    }

    /// An obstacle where a body meets it.
    #[inline]
    pub(in crate::physics) fn for_body(&self, body: usize, obstacle: usize) -> &ObstacleModel<R> {
        let here = |displaced: &&Displaced<R>| (displaced.body, displaced.obstacle) == (body, obstacle);
        self.displaced.iter().find(here).map_or(&self.obstacles[obstacle], |displaced| &displaced.met)
    }
}
