//! One random scene told sample by sample: how its energy developed, and what disturbed it on the way.

use std::fmt::Write;

use serde::Serialize;

use super::extremes::{extreme, lattices, patience};
use super::judge::{EnergySample, JudgeEvent, Verdict, judge_disturbed, judge_with_events};
use crate::scene::Scene;
use crate::scene::file::SceneFileError;
use crate::scene::resolve::ResolveError;

/// The account of one random scene; the names are those of the JSON object. SI units.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names are the keys of the JSON object")]
pub struct SceneAccount {
    pub seed: u64,
    pub number: u64,
    pub bodies: usize,
    pub events: Vec<Event>,
    pub verdict: Verdict,
    /// The verdict in double precision, where the scene failed.
    pub in_double: Option<Verdict>,
}

/// What was seen at one time.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Event {
    /// A sample of a body.
    Look(EnergySample),
    /// A disturbance of the scene.
    Disturbed {
        /// Simulated time, s.
        time_secs: f64,
        /// What happened.
        words: String,
        /// The work counted for it, J.
        work: f64,
    },
}

/// Judges random scene `number` and keeps its account.
///
/// # Errors
/// If a shape cannot be made, which no scene of [`extreme`] should cause.
pub fn account(seed: u64, number: u64, quick: bool) -> Result<SceneAccount, ResolveError> {
    let (scene, disturbances) = extreme(seed, number);
    let lattices = lattices(&scene)?;
    let mut events = Vec::new();
    let verdict = judge_with_events::<f32>(&scene, &disturbances, &lattices, patience(quick), |judged| {
        events.push(event(judged));
    });
    let in_double = || judge_disturbed::<f64>(&scene, &disturbances, &lattices, patience(quick));
    let in_double = verdict.fault.map(|_| in_double());
    Ok(SceneAccount { seed, number, bodies: scene.bodies.len(), events, verdict, in_double })
}

fn event(judged: JudgeEvent<'_>) -> Event {
    match judged {
        JudgeEvent::Sample(sample) => Event::Look(sample.clone()),
        JudgeEvent::Disturbed(disturbance, work) => {
            Event::Disturbed { time_secs: disturbance.at_secs, words: disturbance.words(), work }
        }
    }
}

/// The account as a document.
pub fn markdown(account: &SceneAccount) -> String {
    let mut text = String::new();
    write_markdown(&mut text, account).unwrap_or_default();
    text
}

fn write_markdown(text: &mut String, account: &SceneAccount) -> std::fmt::Result {
    let SceneAccount { seed, number, events, verdict, in_double, .. } = account;
    writeln!(
        text,
        "# Random scene {number} of seed {seed}\n\nEnergies in J. A body's own energy is that of motion, links, recovery \
         and contact, without what a vibration has by the length of its steps; allowed is what it began with and the work done on it since, that of gravity included.\n\n\
         | s | body | kinetic | elastic | recovery | contact | own | allowed | work | substeps | halved | contacts | depth m |\n\
         |---|---|---|---|---|---|---|---|---|---|---|---|---|"
    )?;
    for event in events {
        match event {
            Event::Look(look) => {
                let EnergySample { time_secs, body, kinetic, elastic, recovery, contact, own, allowed, work, .. } =
                    look;
                let EnergySample { substeps, halved, contacts, depth_m, .. } = look;
                writeln!(
                    text,
                    "| {time_secs:.6} | {body} | {kinetic:.4e} | {elastic:.4e} | {recovery:.4e} | {contact:.4e} | {own:.4e} \
                     | {allowed:.4e} | {work:.4e} | {substeps} | {halved} | {contacts} | {depth_m:.3e} |"
                )?;
            }
            Event::Disturbed { time_secs, words, work } => {
                writeln!(text, "| {time_secs:.6} | {words} | | | | | | | {work:+.4e} | | | | |")?;
            }
        }
    }
    writeln!(text, "\n{}", verdict_words(verdict))?;
    if let Some(verdict) = in_double {
        writeln!(text, "In double precision: {}", verdict_words(verdict))?;
    }
    Ok(())
}

fn verdict_words(verdict: &Verdict) -> String {
    let Verdict { fault, words, simulated_secs, cut_short, largest_gain, .. } = verdict;
    let watched = if *cut_short { " (cut short)" } else { "" };
    match fault {
        Some(fault) => format!("Failed, {}: {words}.", fault.words()),
        None => {
            format!("Passed: {simulated_secs:.3} s watched{watched}, largest gain {:.1} %.", largest_gain * 100.0)
        }
    }
}

/// The scene as a scene file, with comments on the disturbances that `gelatin run` would leave out and the command that
/// repeats everything.
///
/// # Errors
/// If the scene cannot be written.
pub fn ron(seed: u64, number: u64) -> Result<String, SceneFileError> {
    let (scene, disturbances): (Scene, _) = extreme(seed, number);
    let mut text = format!(
        "// Random scene {number} of seed {seed}. The same motion, with all that happens on the way:\n\
         //   gelatin report stability --seed {seed} --scene {number}\n"
    );
    for disturbance in &disturbances {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "// Not in this file: after {:.6} s {}.", disturbance.at_secs, disturbance.words());
    }
    Ok(text + &scene.to_ron()?)
}
