//! Whether a body comes near an obstacle within a substep: asked for schemes that leave contact to another one, to choose who
//! takes the substep ([`Plan::at_obstacles`]).

use super::placed::Placed;
use crate::math::{Aabb, Real, Vector};
use crate::physics::kernels::bounds;
use crate::physics::model::plan::Plan;
use crate::physics::model::{ContactRule, Model, ObstacleModel, ObstacleShape};
use crate::physics::state::State;

/// Boxes that look ahead for obstacles are grown by this share of a cell, for what forces add to the motion within a substep.
pub(super) const AHEAD_SHARE: f64 = 0.5;

/// Whether any particle of a body that is awake comes near an obstacle in the next `secs`, or touches one. `velocity_bounds` are
/// the boxes around the velocities of each body, m/s. The thesis's rule is part of the forces and asks for no such care.
pub(in crate::physics) fn comes_near_obstacle<R: Real>(
    (model, plan, obstacles): (&Model<R>, &Plan, &Placed<R>),
    state: &State<R>,
    velocity_bounds: &[Aabb<R>],
    secs: f64,
) -> bool {
    if plan.contact_rule != ContactRule::Implicit {
        return false;
    }
    let secs = R::from_f64(secs);
    model.bodies.iter().enumerate().any(|(number, body)| {
        if model.obstacles.is_empty() || state.bodies[number].asleep || body.modal.is_some() {
            return false;
        }
        let own = body.particles.clone();
        let (at, fast) = (bounds::<R>(plan.simd, &state.position[own.clone()]), velocity_bounds[number]);
        let around = at.swept(fast, secs).grown(R::from_f64(AHEAD_SHARE * body.lattice.grid.cell_size));
        (0..model.obstacles.len()).map(|obstacle| obstacles.for_body(number, obstacle)).any(|obstacle| {
            let touches = |row: usize| state.side[row][own.clone()].iter().any(|side| *side != 0);
            comes_near(obstacle, &around) || obstacle.shape.side_row().is_some_and(touches)
        })
    })
}

/// Whether an obstacle may be in a box. The box around a tilted plane is mostly empty: there the plane itself is asked.
fn comes_near<R: Real>(obstacle: &ObstacleModel<R>, around: &Aabb<R>) -> bool {
    if !obstacle.bounds.overlaps(around) {
        return false;
    }
    let ObstacleShape::Plane(plane) = &obstacle.shape else { return true };
    if obstacle.carry.is_some() {
        return true;
    }
    let half = R::from_f64(0.5);
    let (middle, size) = ((around.min + around.max) * half, (around.max - around.min) * half);
    let reach = plane.normal.max(-plane.normal).dot(size);
    let height = (middle - plane.center).dot(plane.normal);
    height <= reach && -height <= reach
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::Simulation;
    use crate::scene::obstacle::{Obstacle, ObstacleShape, Plane, Sphere};
    use crate::scene::{Body, Scene};

    /// Whether a cube of 1 m around the origin, moving with a velocity, comes near an obstacle in a hundredth of a second.
    fn is_near(shape: ObstacleShape, velocity: [f64; 3], rule: ContactRule) -> bool {
        let scene = Scene {
            bodies: vec![Body { velocity, ..Body::default() }],
            obstacles: vec![Obstacle { shape, ..Obstacle::default() }],
            ..Scene::default()
        };
        let simulation = Simulation::<f64>::from_scene(&scene, "".as_ref()).expect("a sound scene");
        let (model, state) = (simulation.model(), simulation.state());
        let plan = Plan { contact_rule: rule, ..simulation.plan().clone() };
        let velocity_bounds = Aabb::around(state.velocity.iter().copied());
        comes_near_obstacle((model, &plan, &Placed::now(model, state)), state, &[velocity_bounds], 1e-2)
    }

    #[test]
    fn what_a_body_will_reach_is_near_and_a_tilted_plane_only_where_it_is() {
        let plane = |height: f64, tilt_deg: f64| {
            let (center, rotation_deg) = ([0.0, height, 0.0], [tilt_deg, 0.0, 0.0]);
            ObstacleShape::Plane(Plane { center, rotation_deg, ..Plane::default() })
        };
        let by = ContactRule::Implicit;
        assert!(!is_near(plane(-0.6, 0.0), [0.0; 3], by), "a cell's width below it");
        assert!(is_near(plane(-0.6, 0.0), [0.0, -10.0, 0.0], by), "it falls onto it");
        assert!(!is_near(plane(-0.6, 0.0), [0.0, 10.0, 0.0], by), "it flies away");
        assert!(!is_near(plane(-0.6, 0.0), [0.0, -10.0, 0.0], ContactRule::Thesis), "the thesis's rule is a force");
        assert!(is_near(plane(-1.0, 45.0), [0.0; 3], by), "an edge is near the plane");
        assert!(!is_near(plane(-1.3, 45.0), [0.0; 3], by), "only in the box around the plane");
        let ball = |x: f64| ObstacleShape::Sphere(Sphere { center: [x, 0.0, 0.0], radius: 0.5 });
        assert!(is_near(ball(1.04), [0.0; 3], by) && !is_near(ball(1.2), [0.0; 3], by));
    }
}
