//! Which points of a body's mesh meet which obstacles within a substep.

use glam::DVec3;

use super::near;
use super::workspace::{FoundContact, SamplesWorkspace};
use crate::math::{Real, Vector};
use crate::physics::contact::swept_point::SweptPoint;
use crate::physics::contact::weighted::WeightedParticles;
use crate::physics::contact::{broad, narrow};
use crate::physics::kernels::bounds;
use crate::physics::model::{ObstacleShape, SampledCell, Samples};
use crate::physics::report::Counters;
use crate::physics::state::touch::SampleTouch;
use crate::physics::step::substep::Substep;

/// Adds the contacts that the points of a body have with these velocities and that were not found before. Returns whether
/// there are any.
pub(super) fn find_contacts<R: Real>(
    substep: Substep<'_, R>,
    number: usize,
    samples: &Samples,
    velocity: &[R::Vec3],
    workspace: &mut SamplesWorkspace<R>,
    counters: &mut Counters,
) -> bool {
    let Substep { model, state, plan, dt, .. } = substep;
    let own = model.bodies[number].particles.clone();
    let (position, velocity) = (&state.position[own.clone()], &velocity[own]);
    let mut touches = near::touches_of(state, number);
    find_near_obstacles(substep, number, position, velocity, workspace);
    let before = workspace.found_contacts.len();
    if workspace.near_obstacles.is_empty() && touches.is_empty() {
        return false;
    }
    let displacement = if plan.broad_phase {
        workspace.clearances[number].update(substep, number, samples, [position, velocity])
    } else {
        f64::INFINITY
    };
    let mut search = PointSearch { substep, body: number, samples, workspace, tests: 0, sphere_tests: 0 };
    for (place, cell) in samples.cells.iter().enumerate() {
        let in_cell = touches.iter().take_while(|touch| touch.sample < cell.points.end).count();
        let (touching, rest) = touches.split_at(in_cell);
        touches = rest;
        if plan.broad_phase && touching.is_empty() {
            if search.workspace.clearances[number].are_clear(place, displacement) {
                continue;
            }
            let around = near::motion_bounds(cell, position, velocity, dt);
            let is_near = |obstacle: &usize| around.overlaps(&substep.obstacles.for_body(number, *obstacle).bounds);
            if !search.workspace.near_obstacles.iter().any(is_near) {
                continue;
            }
        }
        let corners = Corners::of(cell, position, velocity);
        for sample in cell.points.clone() {
            search.meet_obstacles(sample, &corners, touching);
        }
    }
    let PointSearch { tests, sphere_tests, workspace, .. } = search;
    counters.narrow_tests += tests;
    counters.sphere_tests += sphere_tests;
    let all_tests = (samples.count() * model.obstacles.len()) as u64;
    counters.narrow_tests_saved += all_tests.saturating_sub(tests);
    workspace.found_contacts.len() > before
}

/// The particles of a cell that carries points: where they are as a substep begins, and how they would move in it.
struct Corners<R: Real> {
    /// Their numbers in the body.
    particles: [u32; 8],
    position: [R::Vec3; 8],
    velocity: [R::Vec3; 8],
    largest_coordinates: R::Vec3,
    middle: R::Vec3,
}

impl<R: Real> Corners<R> {
    /// Those of a cell, from the positions (m) and velocities (m/s) of the body's particles.
    fn of(cell: &SampledCell, position: &[R::Vec3], velocity: &[R::Vec3]) -> Self {
        let [position, velocity] = [position, velocity].map(|of| cell.carriers.map(|carrier| of[carrier as usize]));
        let largest_coordinates = position.iter().fold(R::Vec3::ZERO, |largest, at| largest.max(*at).max(-*at));
        let middle = position.iter().fold(R::Vec3::ZERO, |sum, at| sum + *at) * R::from_f64(0.125);
        Self { particles: cell.carriers, position, velocity, largest_coordinates, middle }
    }

    /// Where a point with these weights begins, m, and the way that it would go in `dt` (s), m.
    fn path(&self, weights: &[f64; 8], dt: R) -> [R::Vec3; 2] {
        let mean = |of: &[R::Vec3; 8]| {
            let terms = of.iter().zip(weights);
            terms.map(|(of, weight)| of.to_dvec3() * *weight).sum::<DVec3>()
        };
        let (from, way) = (mean(&self.position), mean(&self.velocity) * dt.to_f64());
        [R::Vec3::from_dvec3(from), R::Vec3::from_dvec3(way)]
    }

    /// Returns the side of a plane that a point came from if it is on the plane within rounding error and has not touched it:
    /// the side of its cell; else 0. A body that begins on a plane has points on either side of it by rounding alone.
    fn side(&self, shape: &ObstacleShape<R>, from: R::Vec3) -> i8 {
        let ObstacleShape::Plane(plane) = shape else { return 0 };
        let height = |at: R::Vec3| (at - plane.center).dot(plane.normal);
        if height(from).abs() > narrow::plane::rounding_margin(plane, self.largest_coordinates) {
            return 0;
        }
        if height(self.middle) >= R::ZERO { 1 } else { -1 }
    }
}

/// The search for contacts of a body's points, the tests made in it, and where the contacts are written.
struct PointSearch<'a, R: Real> {
    substep: Substep<'a, R>,
    body: usize,
    samples: &'a Samples,
    workspace: &'a mut SamplesWorkspace<R>,
    tests: u64,
    sphere_tests: u64,
}

impl<R: Real> PointSearch<'_, R> {
    /// Adds the contacts of one point with all obstacles that it touches or may meet. `touching` are the touches of its cell.
    fn meet_obstacles(&mut self, sample: usize, corners: &Corners<R>, touching: &[SampleTouch]) {
        let Substep { model, plan, obstacles, dt, .. } = self.substep;
        let [from, path] = corners.path(&self.samples.weights[sample], dt);
        let meshes = model.mesh_count();
        let workspace = &mut *self.workspace;
        let caches = &mut workspace.caches[(workspace.first_sample[self.body] + sample) * meshes..][..meshes];
        for obstacle in 0..model.obstacles.len() {
            let key = (sample, obstacle);
            let touch = touching.iter().find(|touch| (touch.sample, touch.obstacle) == key);
            let is_near = touch.is_some() || workspace.near_obstacles.contains(&obstacle);
            if !is_near || workspace.found_pairs.binary_search(&key).is_ok() {
                continue;
            }
            let met = obstacles.for_body(self.body, obstacle);
            let side = touch.map_or_else(|| corners.side(&met.shape, from), |touch| touch.side);
            if plan.broad_phase && side == 0 && !broad::path_bounds::<R>(from, path).overlaps(&met.bounds) {
                continue;
            }
            self.tests += 1;
            self.sphere_tests += u64::from(matches!(met.shape, ObstacleShape::Sphere { .. }));
            let swept = SweptPoint { from, path, side, largest_coordinates: Some(corners.largest_coordinates) };
            let Some((surface, surface_velocity)) = swept.meet(met, dt, caches) else { continue };
            let start = model.bodies[self.body].particles.start;
            let particles = corners.particles.map(|particle| start + particle as usize);
            workspace.found_contacts.push(FoundContact {
                body: self.body,
                sample,
                obstacle,
                own: WeightedParticles::of_cell(particles, self.samples.weights[sample]),
                normal: surface.normal.to_dvec3(),
                gap: surface.gap.to_f64(),
                surface_velocity: surface_velocity.to_dvec3(),
            });
        }
    }
}

/// Lists the obstacles that the motion of a body may meet.
fn find_near_obstacles<R: Real>(
    substep: Substep<'_, R>,
    number: usize,
    position: &[R::Vec3],
    velocity: &[R::Vec3],
    workspace: &mut SamplesWorkspace<R>,
) {
    let Substep { model, plan, dt, .. } = substep;
    workspace.near_obstacles.clear();
    if !plan.broad_phase {
        workspace.near_obstacles.extend(0..model.obstacles.len());
        return;
    }
    let Some(samples) = &model.bodies[number].samples else { return };
    let at = bounds::<R>(plan.simd, position);
    let fast = bounds::<R>(plan.simd, velocity);
    let around = near::bounds_of_all(at.swept(fast, dt), samples);
    let is_near = |obstacle: &usize| around.overlaps(&substep.obstacles.for_body(number, *obstacle).bounds);
    workspace.near_obstacles.extend((0..model.obstacles.len()).filter(is_near));
}
