//! `gelatin run`: simulates without a window as fast as possible.

use std::path::PathBuf;

use anyhow::anyhow;
use clap::Args;

use super::Failure;
use super::out::{self, Progress};
use super::scene_args::{self, SceneArgs};
use crate::session::Command;
use crate::session::predict::{slow_run_warning, speed_alone};
use crate::session::run::{RunFigures, run as run_session};
use crate::session::step_words::limit_text;
use crate::session::threads::within_pool;
use crate::text::counted;
use crate::view::legend::three_digits;

/// The scene and how long it runs.
#[derive(Debug, Args)]
pub(super) struct RunArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// Simulated time, s.
    #[arg(long, value_name = "S", default_value_t = 2.0, allow_negative_numbers = true, value_parser = seconds)]
    seconds: f64,
    /// Write the state at the end to a file.
    #[arg(long, value_name = "FILE")]
    save_state: Option<PathBuf>,
    /// Start from a state that --save-state wrote.
    #[arg(long, value_name = "FILE")]
    from_state: Option<PathBuf>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// A time on the command line.
pub(super) fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(secs) if (0.0..=86_400.0).contains(&secs) => Ok(secs),
        _ => Err("a time from 0 to 86400 s is needed".to_owned()),
    }
}

/// Simulates the scene and prints its figures.
pub(super) fn run(args: &RunArgs) -> Result<(), Failure> {
    if let Some(path) = &args.save_state {
        out::check_writable(path)?;
        out::check_spares(path, args.from_state.as_slice())?;
    }
    let mut session = args.scene.start(args.save_state.as_deref())?;
    scene_args::find_modes(&mut session);
    if let Some(path) = &args.from_state {
        session.handle(Command::OpenState { path: path.clone() })?;
    }
    if args.seconds > 0.0
        && let Some(warning) = speed_alone(session.simulation()).and_then(slow_run_warning)
    {
        out::note(&format!("warning: {warning}"));
    }
    let figures = within_pool(|| run_session(&mut session, args.seconds, &Progress::new("simulating")));
    if let Some(path) = &args.save_state {
        session.handle(Command::SaveState { path: path.clone() })?;
    }
    if args.json {
        out::json(&serde_json::to_value(&figures)?)?;
    } else {
        out::figures(&table(&figures))?;
        figures.warnings.iter().for_each(|warning| out::note(&format!("warning: {warning}")));
    }
    match figures.trouble {
        Some(words) => Err(anyhow!(words).into()),
        None => Ok(()),
    }
}

fn table(figures: &RunFigures) -> String {
    let links = figures.links;
    let safe = figures.dt_safe_secs.map_or("no limit".to_owned(), |safe| format!("{} safe", limit_text(safe)));
    let rows = [
        ("scene", figures.scene.clone()),
        (
            "simulated",
            format!(
                "{:.3} s in {:.3} s, {} × real time",
                figures.simulated_secs,
                figures.wall_secs,
                three_digits(figures.real_time_factor)
            ),
        ),
        (
            "steps",
            format!(
                "{} whole, {}, the shortest {} ms ({safe}, limited by {})",
                figures.steps,
                counted(figures.substeps, "substep", "substeps"),
                three_digits(figures.dt_secs * 1e3),
                figures.limited_by_words
            ),
        ),
        (
            "body",
            format!(
                "{} particles, {} structural + {} shear + {} bending links, {:.3} kg",
                figures.particles, links.structural, links.shear, links.bending, figures.mass_kg
            ),
        ),
        (
            "energy",
            format!(
                "{:.4} J (kinetic {:.4}, elastic {:.4}, gravity {:.4}, contact {:.4}, recovery {:.4})",
                figures.energy_joule.total,
                figures.energy_joule.kinetic,
                figures.energy_joule.elastic,
                figures.energy_joule.gravity,
                figures.energy_joule.contact,
                figures.energy_joule.recovery
            ),
        ),
        ("center", format!("{:.4} {:.4} {:.4} m", figures.center[0], figures.center[1], figures.center[2])),
        (
            "extremes",
            format!(
                "speed {:.5} m/s, strain {:.1} %, depth {:.4} m, {} inverted cells",
                figures.max_speed,
                figures.max_strain * 100.0,
                figures.max_penetration_m,
                figures.inverted_cells
            ),
        ),
        (
            "contact",
            format!(
                "{} with obstacles, {} between bodies, {} narrow tests, {} saved",
                figures.contacts, figures.body_contacts, figures.narrow_tests, figures.narrow_tests_saved
            ),
        ),
        (
            "asleep",
            format!("{} of {} bodies, {} fallen out", figures.bodies_asleep, figures.bodies, figures.bodies_gone),
        ),
        ("finite", if figures.finite { "yes" } else { "no" }.to_owned()),
        ("hash", figures.hash.clone()),
    ];
    let modes = figures.modes.iter().map(|modes| ("modes", modes.words()));
    let all = rows.into_iter().chain(modes).map(|(name, value)| format!("{name:<10} {value}"));
    all.collect::<Vec<_>>().join("\n")
}
