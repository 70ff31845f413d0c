//! `gelatin check`: parse, validate, and predict the stable step and the cost of a scene before anything runs.

use std::ffi::OsStr;

use clap::Args;
use serde_json::{Value, json};

use super::Failure;
use super::named_parts;
use super::out;
use super::scene_args::{self, SceneArgs};
use crate::machine::bytes_text;
use crate::scene::file::SceneFileError;
use crate::scene::named;
use crate::scene::param::Problem;
use crate::session::predict::Prediction;
use crate::session::step_words::limit_text;
use crate::session::{BodyParts, Session, SessionError};
use crate::text::counted;
use crate::view::legend::three_digits;

/// The scene to check.
#[derive(Debug, Args)]
pub(super) struct CheckArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// Checks the scene and prints what was found; errors in it are a failure.
pub(super) fn run(args: &CheckArgs) -> Result<(), Failure> {
    match args.scene.open().and_then(|opened| Ok(scene_args::session(opened)?)) {
        Ok(mut session) => {
            scene_args::find_modes(&mut session);
            report(args, &session)
        }
        Err(failure @ Failure::Usage(_)) => Err(failure),
        Err(Failure::Work(error)) => {
            if args.json {
                out::json(&unsound(&error, args.scene.given()))?;
            }
            Err(Failure::Work(error))
        }
    }
}

fn report(args: &CheckArgs, session: &Session) -> Result<(), Failure> {
    let prediction = Prediction::of(session);
    if args.json {
        let mut object = serde_json::to_value(&prediction)?;
        object["named_parts"] = json!(session.named_parts());
        out::json(&object)?;
        return Ok(());
    }
    let limit = |secs: Option<f64>| secs.map_or("no limit".to_owned(), limit_text);
    // The limit of each term, with the same margin as the overall limit.
    let margin = match (prediction.dt_safe_secs, prediction.dt_limit_secs) {
        (Some(safe), Some(at_rest)) => safe / at_rest,
        _ => 1.0,
    };
    out::figures(&format!(
        "{}: sound\n{}, {}, {} kg, about {} of memory\nlargest safe step {}\n\
         {} in 1/60 s, limited by {}\n{}",
        session.title(),
        counted(prediction.particles, "particle", "particles"),
        counted(prediction.links, "link", "links"),
        three_digits(prediction.mass_kg),
        bytes_text(prediction.memory_bytes),
        limit(prediction.dt_safe_secs),
        counted(prediction.substeps_per_frame, "substep", "substeps"),
        prediction.limited_by_words,
        prediction.predicted_real_time_factor.map_or_else(
            || "it explodes".to_owned(),
            |factor| format!("about {} × real time on this machine with nothing drawn", three_digits(factor)),
        ),
    ))?;
    if prediction.mesh_points > 0 {
        out::figures(&format!(
            "{} points of meshes meet obstacles in place of the particles of their bodies",
            prediction.mesh_points
        ))?;
    }
    for modes in &prediction.modes {
        out::figures(&modes.words())?;
    }
    if let Some(most) = prediction.most_iterations_per_frame {
        out::figures(&format!(
            "at most {most} iterations of the implicit integrator in 1/60 s, however violent the motion"
        ))?;
    }
    if let Some([parts, strained]) = prediction.parts_in_contact {
        let may_solve = session.simulation().plan().may_solve_for_contact();
        let whole = if may_solve { ", or is solved for as a whole where that is cheaper" } else { "" };
        out::figures(&format!(
            "a substep in which points come near each other or an obstacle takes {parts} parts, {strained} while links are far \
             from their rest length{whole}"
        ))?;
    }
    if prediction.candidates.len() > 1 {
        out::figures("predicted work, in forces of links a simulated second; the least is taken")?;
    }
    for candidate in prediction.candidates.iter().filter(|_| prediction.candidates.len() > 1) {
        out::figures(&format!(
            "  {:<22} {} million, in steps of {}",
            candidate.integrator.replace('-', " "),
            three_digits(candidate.cost_per_sec / 1e6),
            limit_text(candidate.substep_secs),
        ))?;
    }
    out::figures("largest safe step of each term alone, with the same margin")?;
    for term in prediction.limits.iter().filter(|limit| limit.term != "user") {
        let safe = term.dt_limit_secs.map(|at_rest| margin * at_rest);
        out::figures(&format!("  {:<22} {}", term.term.replace('_', " "), limit(safe)))?;
    }
    for BodyParts { body, parts } in session.named_parts() {
        named_parts::print(&named(&session.scene().bodies[body].name, "body", body), &parts)?;
    }
    for warning in &prediction.warnings {
        out::note(&format!("warning: {warning}"));
    }
    Ok(())
}

/// An unsound scene as a JSON object: its errors, and null for everything that cannot be worked out.
fn unsound(error: &anyhow::Error, scene: &OsStr) -> Value {
    let none = Value::Null;
    json!({
        "ok": false,
        "errors": problems(error),
        "warnings": [],
        "scene": scene.to_string_lossy(),
        "particles": none,
        "links": none,
        "mass_kg": none,
        "mesh_points": none,
        "modes": [],
        "named_parts": [],
        "memory_bytes": none,
        "dt_limit_secs": none,
        "dt_safe_secs": none,
        "limited_by": none,
        "integrator": none,
        "candidates": [],
        "limits": [],
        "substeps_per_frame": none,
        "most_iterations_per_frame": none,
        "parts_in_contact": none,
        "predicted_real_time_factor": none,
    })
}

/// The errors of a scene one by one; any other error as one problem without a path.
fn problems(error: &anyhow::Error) -> Vec<Problem> {
    let message = format!("{error:#}");
    let found = match (error.downcast_ref(), error.downcast_ref()) {
        (Some(file), _) => SceneFileError::problems(file),
        (None, Some(SessionError::Shape { index, source })) => {
            vec![Problem { path: format!("bodies.{index}.{}", source.path()), message: message.clone() }]
        }
        (None, Some(SessionError::Part(problem))) => vec![problem.clone()],
        (None, Some(SessionError::Mesh { index, source })) => {
            let path = format!("obstacles.{index}.{}", source.path().replace("shape.model", "mesh"));
            vec![Problem { path, message: message.clone() }]
        }
        _ => Vec::new(),
    };
    if found.is_empty() { vec![Problem { path: String::new(), message }] } else { found }
}
