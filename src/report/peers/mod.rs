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
mod jellies;
mod matching;
pub mod pile;
mod rapier;
pub mod words;

use serde::Serialize;

use crate::geometry::Watch;
use crate::geometry::watch::CancelOnly;
use crate::report::error::follow::{Followed, Lost, follow, mean_square, size, whole};
use crate::report::error::measured::{Measured, front};
use crate::report::error::reference::{Reference, fine_step};
use crate::report::error::{CONVERGES, LOOK_SECS, LOST, REFERENCE, REPEATS, Way};
use crate::scene::Solid;
use crate::scene::resolve::ResolveError;
pub use contender::{Contender, Peer};
use cube::Cube;
pub use matching::{Matched, SAME_SAG};
use matching::{is_same_sag, matched, rest, swing};
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
    pub peers: Vec<Matched>,
    pub rows: Vec<Row>,
    /// Results that contradict both engines solving the equations of the same links.
    pub defects: Vec<String>,
}

/// Measures a cube of `divisions` cells an edge by a swing of `seconds`, a multiple of [`LOOK_SECS`]; none where `watch`
/// cancels. Run it on one thread.
///
/// # Errors
/// If the cube cannot be made.
pub fn measure(divisions: u32, seconds: f64, watch: &dyn Watch) -> Result<Option<PeersFigures>, ResolveError> {
    let cube = Cube::hanging(divisions, Solid::default())?;
    Ok(compare([&cube, &cube], seconds, watch))
}

/// Compares our cube with peers made from another cube of the same particles.
fn compare([ours, theirs]: [&Cube; 2], seconds: f64, watch: &dyn Watch) -> Option<PeersFigures> {
    let looks = whole(seconds / LOOK_SECS).max(1);
    let fine = fine_step(&ours.scene, &ours.lattices, REFERENCE_SECS);
    let both = [fine, 2.0 * fine].map(|dt| Way::Manual(REFERENCE).applied(&ours.scene, dt));
    let reference = Reference::of(both.each_ref(), &ours.lattices, looks, false, [0.05, 0.08], watch)?;
    // Progress is reported between runs, as reporting it takes processor time.
    let quiet = &CancelOnly(watch);
    let at_rest = ours.rest(quiet)?;
    let sag_m = ours.sag(&at_rest);
    let mut peers = Vec::new();
    for (done, peer) in Peer::ALL.into_iter().enumerate() {
        peers.push(matched(theirs, peer, sag_m, &reference.looks, quiet)?);
        watch.progress(0.08 + 0.32 * (done + 1) as f64 / Peer::ALL.len() as f64);
    }
    let mut settings = Vec::new();
    for contender in Contender::ALL {
        let steps: &[f64] = if matches!(contender, Contender::Ours(_)) { &OUR_STEPS_SECS } else { &THEIR_STEPS_SECS };
        for &dt in steps {
            let still = match peers.iter().find(|matched| contender == Contender::Peer(matched.peer)) {
                Some(matched) => rest(theirs, matched.peer, matched.tuning(), dt, quiet)?,
                // The rest position of our cube depends on nothing that is chosen here.
                None => at_rest.clone(),
            };
            settings.push(Setting { contender, dt, still, measured: Measured::new() });
        }
    }
    watch.progress(0.6);
    let lost_m = LOST * size(&reference.looks);
    for repeat in 0..REPEATS {
        for setting in settings.iter_mut().filter(|setting| !setting.measured.diverged) {
            let Setting { contender, dt, measured, .. } = setting;
            measured.run(&reference.looks, lost_m, |lost| match contender {
                Contender::Ours(way) => {
                    follow::<f32>(&way.applied(&ours.scene, *dt), &ours.lattices, looks, Some(lost), quiet)
                }
                Contender::Peer(peer) => let_go(theirs, *peer, &peers, *dt, looks, lost, quiet),
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
        simulated_secs: looks as f64 * LOOK_SECS,
        sag_m,
        reference_dt_secs: reference.dt_secs,
        reference_error_m: reference.error_m,
        defects: defects(&peers, &rows),
        peers,
        rows,
    })
}

fn let_go(
    cube: &Cube,
    peer: Peer,
    peers: &[Matched],
    dt: f64,
    looks: u64,
    lost: Lost<'_>,
    watch: &dyn Watch,
) -> Followed {
    let tuning = peers.iter().find(|matched| matched.peer == peer).map_or_else(|| peer.start(cube), Matched::tuning);
    swing(cube, peer, tuning, dt, looks, Some(lost), watch)
}

/// One contender at one step, with its measurements so far.
struct Setting {
    contender: Contender,
    dt: f64,
    still: Vec<[f64; 3]>,
    measured: Measured,
}

impl Setting {
    fn row(self, cube: &Cube, at_rest: &[[f64; 3]], wanted_m: f64) -> Row {
        let [wall_secs_median, wall_secs_min, wall_secs_max] = self.measured.wall_secs();
        let [processor_secs_median, processor_secs_min, processor_secs_max] = self.measured.processor_secs();
        let sag_m = cube.sag(&self.still);
        Row {
            contender: self.contender,
            dt_secs: self.dt,
            sag_m,
            same_sag: is_same_sag(sag_m, wanted_m),
            swing_rms_m: (!self.measured.diverged).then_some(self.measured.error_m),
            rest_rms_m: mean_square(&self.still, at_rest).sqrt(),
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
    for (row, is_best) in rows.iter_mut().zip(front(&figures)) {
        row.pareto = is_best && error(row).is_finite();
    }
}

/// Finds results that contradict both engines solving the equations of the same links: another stiffness at the same sag, or
/// an error that does not shrink with the step.
fn defects(peers: &[Matched], rows: &[Row]) -> Vec<String> {
    let mut found = Vec::new();
    if let Some(links) = peers.iter().find(|matched| matched.peer == Peer::Links) {
        let Matched { stiffness, same_sag, .. } = links;
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
    let [least_steps, shrinks] = CONVERGES;
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
