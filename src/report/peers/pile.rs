//! Soft bodies that meet: a dozen jellies fall into a bowl, ours and another engine's of the same particles, masses, links
//! and outer faces.
//!
//! The report compares the time per simulated second, while the bodies fall and once they lie, and how deep they are in each
//! other then. Depth is measured on the particles alone, in the same way for both engines: a particle of one body that lies
//! inside the closed surface made of another's outer faces is as deep as its distance from that surface.

use glam::DVec3;
use serde::Serialize;

use super::contender::{Contender, Peer};
use super::pile_scene::{Pile, outer_faces};
use super::rapier::World;
use crate::geometry::watch::CancelOnly;
use crate::geometry::{Surface, TriMesh, Watch};
use crate::math::Aabb;
use crate::physics::{BodyModel, Simulation};
use crate::report::error::recording::{RecordedRun, Stepper, mean_square_distance, record_steps, rounded_count};
use crate::report::error::{SAMPLE_INTERVAL_SECS, SteppingMethod};
use crate::scene::resolve::ResolveError;

/// How long the bodies fall and then lie, s; and with `--quick`.
pub const SECONDS: [[f64; 2]; 2] = [[4.0, 2.0], [1.6, 0.4]];
/// The steps that are measured, s.
const OUR_STEPS_SECS: [f64; 2] = [0.004, 0.001];
const THEIR_STEPS_SECS: [f64; 3] = [0.02, 0.008, 0.004];
/// The radius of the bowl, m.
const BOWL_RADIUS: f64 = 1.3;
/// Two bodies have passed into each other if a particle is deeper than this share of the edge of a cell.
const MAX_DEPTH_SHARE: f64 = 0.5;

/// One contender at one step; the names are those of the table and the JSON object.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the names are the keys of the JSON object")]
pub struct PileRow {
    pub contender: Contender,
    pub dt_secs: f64,
    /// Processor time per simulated second, while the bodies fall and while they lie.
    pub falling_secs: f64,
    pub lying_secs: f64,
    /// None where it diverged.
    pub end: Option<PileState>,
}

/// How a pile lies.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PileState {
    /// The deepest position of a particle of one body inside another.
    pub deepest_m: f64,
    /// Root mean square speed of the particles.
    pub speed_m_s: f64,
    /// Bodies whose middle is in the bowl.
    pub in_bowl: usize,
}

/// The measurements; the names are those of the JSON object. SI units.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the names are the keys of the JSON object")]
pub struct PileFigures {
    pub bodies: usize,
    pub cells: usize,
    pub particles: usize,
    pub links: usize,
    /// The edge of a cell.
    pub cell_m: f64,
    pub falling_secs: f64,
    pub lying_secs: f64,
    pub rows: Vec<PileRow>,
}

impl PileFigures {
    /// A defect of ours: divergence, or bodies that pass into each other.
    pub fn defect(&self) -> Option<String> {
        let mut ours = self.rows.iter().filter(|row| matches!(row.contender, Contender::Ours(_)));
        let limit = MAX_DEPTH_SHARE * self.cell_m;
        ours.find_map(|row| match row.end {
            None => Some("our pile diverged".to_owned()),
            Some(end) if end.deepest_m > limit => {
                Some(format!("our bodies are {} m deep in each other", end.deepest_m))
            }
            Some(_) => None,
        })
    }
}

/// Lets the pile fall for some time and then lie for some time, s, both multiples of [`SAMPLE_INTERVAL_SECS`]; none where
/// `watch` cancels. Run it on one thread.
///
/// # Errors
/// If the pile cannot be made.
pub fn measure([falling_secs, lying_secs]: [f64; 2], watch: &dyn Watch) -> Result<Option<PileFigures>, ResolveError> {
    let pile = Pile::new()?;
    // Progress is reported between runs, as reporting it takes processor time.
    let quiet = &CancelOnly(watch);
    let seconds = [falling_secs, lying_secs];
    let ours = OUR_STEPS_SECS.map(|dt| (Contender::Ours(SteppingMethod::Automatic), dt));
    let theirs = THEIR_STEPS_SECS.map(|dt| (Contender::Peer(Peer::Links), dt));
    let mut rows = Vec::new();
    for (contender, dt_secs) in ours.into_iter().chain(theirs) {
        let Some(row) = pile.row(contender, dt_secs, seconds, quiet) else { return Ok(None) };
        rows.push(row);
        watch.progress(rows.len() as f64 / (OUR_STEPS_SECS.len() + THEIR_STEPS_SECS.len()) as f64);
    }
    let sum = |of: &dyn Fn(&BodyModel<f64>) -> usize| pile.bodies.iter().map(of).sum();
    Ok(Some(PileFigures {
        bodies: pile.bodies.len(),
        cells: sum(&|body| body.lattice.cells.len()),
        particles: sum(&|body| body.start.len()),
        cell_m: pile.bodies.iter().map(|body| body.lattice.grid.cell_size).fold(f64::INFINITY, f64::min),
        links: sum(&|body| body.links.iter().map(|family| family.links.len()).sum()),
        falling_secs,
        lying_secs,
        rows,
    }))
}

impl Pile {
    fn row(&self, contender: Contender, dt_secs: f64, seconds: [f64; 2], watch: &dyn Watch) -> Option<PileRow> {
        let runs = match contender {
            Contender::Ours(method) => {
                let scene = method.applied(&self.scene, dt_secs);
                run_fall_and_rest(&mut Simulation::<f32>::new(&scene, &self.lattices), dt_secs, seconds, watch)
            }
            Contender::Peer(_) => run_fall_and_rest(&mut World::of_pile(self, dt_secs)?, dt_secs, seconds, watch),
        };
        let [falling, lying] = runs?;
        let a_second = |run: &RecordedRun, secs: f64| run.processor_time.as_secs_f64() / secs;
        let diverged = falling.diverged || lying.diverged;
        let end = lying.samples.last_chunk().filter(|_| !diverged).and_then(|last| self.end(last));
        let [falling_secs, lying_secs] = [a_second(&falling, seconds[0]), a_second(&lying, seconds[1])];
        Some(PileRow { contender, dt_secs, falling_secs, lying_secs, end })
    }

    /// How the pile lies at the second of two samples; none where a position is not finite.
    fn end(&self, [before, last]: &[Vec<[f64; 3]>; 2]) -> Option<PileState> {
        let at: Vec<DVec3> = last.iter().copied().map(DVec3::from).collect();
        if !at.iter().all(|at| at.is_finite()) {
            return None;
        }
        let is_in = |body: &&BodyModel<f64>| {
            let own = &at[body.particles.clone()];
            let middle = own.iter().sum::<DVec3>() / own.len() as f64;
            middle.y > 0.0 && DVec3::new(middle.x, 0.0, middle.z).length() < BOWL_RADIUS
        };
        Some(PileState {
            deepest_m: max_penetration(&self.bodies, &at),
            speed_m_s: mean_square_distance(before, last).sqrt() / SAMPLE_INTERVAL_SECS,
            in_bowl: self.bodies.iter().filter(is_in).count(),
        })
    }
}

/// Runs the fall and then the rest; none where `watch` cancels.
fn run_fall_and_rest(
    stepper: &mut impl Stepper,
    dt_secs: f64,
    seconds: [f64; 2],
    watch: &dyn Watch,
) -> Option<[RecordedRun; 2]> {
    let runs =
        seconds.map(|secs| record_steps(stepper, dt_secs, rounded_count(secs / SAMPLE_INTERVAL_SECS), None, watch));
    runs.iter().all(|run| !run.cancelled).then_some(runs)
}

/// The deepest position of a particle of one body inside another, m.
fn max_penetration(bodies: &[BodyModel<f64>], at: &[DVec3]) -> f64 {
    let mut deepest = 0.0_f64;
    for (number, body) in bodies.iter().enumerate() {
        let mesh = TriMesh { positions: at[body.particles.clone()].to_vec(), triangles: outer_faces(body) };
        let bounds: Aabb<f64> = mesh.bounds();
        let Ok(surface) = Surface::new(&mesh) else { continue };
        let others = bodies.iter().enumerate().filter(|(other, _)| *other != number);
        for point in others.flat_map(|(_, other)| &at[other.particles.clone()]) {
            let is_near = point.cmpge(bounds.min).all() && point.cmple(bounds.max).all();
            // The surface is scaled by its own length and centred on its bounding box.
            let within = (*point - bounds.center()) / surface.own_length();
            if is_near && surface.holds(within) {
                deepest = deepest.max(surface.nearest(within).distance * surface.own_length());
            }
        }
    }
    deepest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_body_that_is_pushed_into_another_is_found_as_deep() {
        let pile = Pile::new().expect("a pile");
        let two = &pile.bodies[..2];
        let mut at: Vec<DVec3> = two.iter().flat_map(|body| body.start.iter().copied()).collect();
        assert!(max_penetration(two, &at) == 0.0, "they are apart at the start");
        // The cube comes down on the uppermost particle of the ball, 2 cm too far.
        let [cube, ball] = [0, 1].map(|body: usize| two[body].particles.clone());
        let top = at[ball].iter().copied().reduce(|a, b| if b.y > a.y { b } else { a }).expect("particles");
        let bounds = Aabb::<f64>::around(at[cube.clone()].iter().copied());
        let below = DVec3 { y: bounds.min.y, ..bounds.center() };
        at[cube].iter_mut().for_each(|at| *at += top - DVec3::Y * 0.02 - below);
        let found = max_penetration(two, &at);
        assert!((found - 0.02).abs() < 1e-6, "{found} m");
    }
}
