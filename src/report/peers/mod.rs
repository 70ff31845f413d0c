//! Another engine's soft body beside ours: wall time and error on the same cube in the same process.
//!
//! The cube hangs by its top and is let go unstretched. Every peer has our particles, masses and pins; its stiffness is
//! tuned until it hangs as low as our cube does at rest. The report compares
//!
//! - the swing: root mean square distance of all particles from our converged reference in double precision, at equal times
//!   after the cube is let go;
//! - rest: the same distance of the particles at rest, which depends on the body and not on the steps;
//! - wall time per simulated second of the swing, one thread each, in runs in turn; and processor time, by which the two are
//!   compared, as on a busy machine a long run waits more often than a short one.
//!
//! A peer with our links is the same system of equations: its error is that of its steps, and has to shrink with them. A
//! peer with elastic cells of its own is another discrete body, even at the same sag, and its error includes that
//! difference.
//!
//! [`pile`] compares soft bodies that meet.

mod contender;
mod cube;
mod matching;
pub mod pile;
mod pile_scene;
mod rapier;
pub mod words;

use serde::Serialize;

use crate::geometry::Watch;
use crate::geometry::watch::CancelOnly;
use crate::report::error::recording::{
    DivergenceTest, RecordedRun, initial_extent, mean_square_distance, record_run, rounded_count,
};
use crate::report::error::reference::{Reference, fine_step};
use crate::report::error::repeated_run::{RepeatedRun, pareto_front};
use crate::report::error::{
    CONVERGENCE_CRITERION, DIVERGED_ERROR_RATIO, REFERENCE, REPEATS, SAMPLE_INTERVAL_SECS, SteppingMethod,
};
use crate::scene::Solid;
use crate::scene::resolve::ResolveError;
pub use contender::{Contender, Peer};
use cube::Cube;
pub use matching::{MatchedPeer, SAME_SAG};
use matching::{is_same_sag, match_peer, run_swing, run_to_rest};
use rapier::SKIN_SHARE;
pub use rapier::SUBSTEPS;

/// The reference takes steps well below this, s.
const REFERENCE_SECS: f64 = 1e-3;
/// The steps that are measured, s.
const OUR_STEPS_SECS: [f64; 4] = [0.008, 0.004, 0.002, 0.001];
const THEIR_STEPS_SECS: [f64; 3] = [0.02, 0.008, 0.004];

/// One contender at one step; the names are those of the table and the JSON object.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the names are the keys of the JSON object")]
pub struct Row {
    pub contender: Contender,
    pub dt_secs: f64,
    pub sag_m: f64,
    /// Whether it hangs as low as ours.
    pub same_sag: bool,
    /// Distance from the reference during the swing; none where it diverged.
    pub swing_rms_m: Option<f64>,
    /// Distance from the reference at rest.
    pub rest_rms_m: f64,
    /// Wall time per simulated second.
    pub wall_secs_median: f64,
    pub wall_secs_min: f64,
    pub wall_secs_max: f64,
    /// Processor time per simulated second, without that of other programs.
    pub processor_secs_median: f64,
    pub processor_secs_min: f64,
    pub processor_secs_max: f64,
    /// Whether no other row that hangs as low is both as fast and as exact.
    pub pareto: bool,
}

/// The measurements of one cube; the names are those of the JSON object. SI units.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the names are the keys of the JSON object")]
pub struct PeersFigures {
    pub divisions: u32,
    pub particles: usize,
    pub links: usize,
    pub simulated_secs: f64,
    /// The sag of the reference at rest.
    pub sag_m: f64,
    pub reference_dt_secs: f64,
    /// Difference between the reference and the same at twice the step.
    pub reference_error_m: f64,
    pub peers: Vec<MatchedPeer>,
    pub rows: Vec<Row>,
    /// Results that contradict both engines solving the equations of the same links.
    pub defects: Vec<String>,
}

/// Measures a cube of `divisions` cells an edge by a swing of `seconds`, a multiple of [`SAMPLE_INTERVAL_SECS`]; none where
/// `watch` cancels. Run it on one thread.
///
/// # Errors
/// If the cube cannot be made.
pub fn measure(divisions: u32, seconds: f64, watch: &dyn Watch) -> Result<Option<PeersFigures>, ResolveError> {
    let cube = Cube::hanging(divisions, Solid::default())?;
    Ok(compare([&cube, &cube], seconds, watch))
}

/// Compares our cube with peers made from another cube of the same particles.
fn compare([ours, theirs]: [&Cube; 2], seconds: f64, watch: &dyn Watch) -> Option<PeersFigures> {
    let samples = rounded_count(seconds / SAMPLE_INTERVAL_SECS).max(1);
    let fine = fine_step(&ours.scene, &ours.lattices, REFERENCE_SECS);
    let both = [fine, 2.0 * fine].map(|dt| SteppingMethod::Manual(REFERENCE).applied(&ours.scene, dt));
    let reference = Reference::of(both.each_ref(), &ours.lattices, samples, false, [0.05, 0.08], watch)?;
    // Progress is reported between runs, as reporting it takes processor time.
    let quiet = &CancelOnly(watch);
    let at_rest = ours.rest_positions(quiet)?;
    let sag_m = ours.sag(&at_rest);
    let mut peers = Vec::new();
    for (done, peer) in Peer::ALL.into_iter().enumerate() {
        peers.push(match_peer(theirs, peer, sag_m, &reference.samples, quiet)?);
        watch.progress(0.08 + 0.32 * (done + 1) as f64 / Peer::ALL.len() as f64);
    }
    let mut settings = Vec::new();
    for contender in Contender::ALL {
        let steps: &[f64] = if matches!(contender, Contender::Ours(_)) { &OUR_STEPS_SECS } else { &THEIR_STEPS_SECS };
        for &dt in steps {
            let rest_positions = match peers.iter().find(|matched| contender == Contender::Peer(matched.peer)) {
                Some(matched) => run_to_rest(theirs, matched.peer, matched.tuning(), dt, quiet)?,
                // The rest position of our cube depends on nothing that is chosen here.
                None => at_rest.clone(),
            };
            settings.push(Setting { contender, dt, rest_positions, measured: RepeatedRun::new() });
        }
    }
    watch.progress(0.6);
    let max_error_m = DIVERGED_ERROR_RATIO * initial_extent(&reference.samples);
    for repeat in 0..REPEATS {
        for setting in settings.iter_mut().filter(|setting| !setting.measured.diverged) {
            let Setting { contender, dt, measured, .. } = setting;
            measured.run(&reference.samples, max_error_m, |is_diverged| match contender {
                Contender::Ours(method) => record_run::<f32>(
                    &method.applied(&ours.scene, *dt),
                    &ours.lattices,
                    samples,
                    Some(is_diverged),
                    quiet,
                ),
                Contender::Peer(peer) => swing_matched_peer(theirs, *peer, &peers, *dt, samples, is_diverged, quiet),
            });
            if watch.cancelled() {
                return None;
            }
        }
        watch.progress(0.6 + 0.4 * (repeat + 1) as f64 / REPEATS as f64);
    }
    let mut rows: Vec<Row> = settings.into_iter().map(|setting| setting.row(ours, &at_rest, sag_m)).collect();
    mark_pareto(&mut rows);
    Some(PeersFigures {
        divisions: ours.divisions,
        particles: ours.body.start.len(),
        links: ours.body.links.iter().map(|family| family.links.len()).sum(),
        simulated_secs: samples as f64 * SAMPLE_INTERVAL_SECS,
        sag_m,
        reference_dt_secs: reference.dt_secs,
        reference_error_m: reference.error_m,
        defects: defects(&peers, &rows),
        peers,
        rows,
    })
}

fn swing_matched_peer(
    cube: &Cube,
    peer: Peer,
    peers: &[MatchedPeer],
    dt: f64,
    samples: u64,
    is_diverged: DivergenceTest<'_>,
    watch: &dyn Watch,
) -> RecordedRun {
    let tuning =
        peers.iter().find(|matched| matched.peer == peer).map_or_else(|| peer.start(cube), MatchedPeer::tuning);
    run_swing(cube, peer, tuning, dt, samples, Some(is_diverged), watch)
}

/// One contender at one step, with its measurements so far.
struct Setting {
    contender: Contender,
    dt: f64,
    rest_positions: Vec<[f64; 3]>,
    measured: RepeatedRun,
}

impl Setting {
    fn row(self, cube: &Cube, at_rest: &[[f64; 3]], wanted_m: f64) -> Row {
        let [wall_secs_median, wall_secs_min, wall_secs_max] = self.measured.wall_secs();
        let [processor_secs_median, processor_secs_min, processor_secs_max] = self.measured.processor_secs();
        let sag_m = cube.sag(&self.rest_positions);
        Row {
            contender: self.contender,
            dt_secs: self.dt,
            sag_m,
            same_sag: is_same_sag(sag_m, wanted_m),
            swing_rms_m: (!self.measured.diverged).then_some(self.measured.error_m),
            rest_rms_m: mean_square_distance(&self.rest_positions, at_rest).sqrt(),
            wall_secs_median,
            wall_secs_min,
            wall_secs_max,
            processor_secs_median,
            processor_secs_min,
            processor_secs_max,
            pareto: false,
        }
    }
}

/// Marks the Pareto front of the rows of the same sag, by processor time.
fn mark_pareto(rows: &mut [Row]) {
    let error = |row: &Row| row.swing_rms_m.filter(|_| row.same_sag).unwrap_or(f64::INFINITY);
    let figures: Vec<_> = rows.iter().map(|row| (row.processor_secs_median, error(row))).collect();
    for (row, is_best) in rows.iter_mut().zip(pareto_front(&figures)) {
        row.pareto = is_best && error(row).is_finite();
    }
}

/// Finds results that contradict both engines solving the equations of the same links: another stiffness at the same sag, or
/// an error that does not shrink with the step.
fn defects(peers: &[MatchedPeer], rows: &[Row]) -> Vec<String> {
    let mut found = Vec::new();
    if let Some(links) = peers.iter().find(|matched| matched.peer == Peer::Links) {
        let MatchedPeer { stiffness, same_sag, .. } = links;
        if !same_sag {
            found.push("the peer with our links never hangs as low as ours".to_owned());
        } else if (stiffness - 1.0).abs() > SAME_SAG {
            found.push(format!(
                "the peer with our links hangs as low as ours only with {stiffness:.3} times their stiffness"
            ));
        }
    }
    let of_links = |row: &&Row| row.contender == Contender::Peer(Peer::Links);
    let errors: Vec<_> = rows.iter().filter(of_links).filter_map(|row| Some((row.dt_secs, row.swing_rms_m?))).collect();
    let [least_steps, shrinks] = CONVERGENCE_CRITERION;
    let does_not = errors.last().is_some_and(|&(dt, finest)| {
        let coarse = errors.iter().rfind(|(coarse, _)| *coarse >= (least_steps - 1e-9) * dt);
        coarse.is_none_or(|(_, coarse)| finest > shrinks * coarse)
    });
    if does_not || errors.is_empty() {
        found.push("the error of the peer with our links does not shrink with its steps".to_owned());
    }
    found
}

#[cfg(test)]
mod tests;
