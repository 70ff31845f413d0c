//! The error report as a page and as a table of comma-separated values.

use std::fmt::Write;

use super::cells::{CellsFigures, CellsRow, advice as cells_advice, millimetres};
use super::{ErrorFigures, Row};

/// Errors that somebody may want to stay below, m.
const WANTED_M: [f64; 3] = [0.01, 0.001, 0.0001];

/// The page.
pub fn markdown(scenes: &[ErrorFigures]) -> String {
    let mut text = "# Error against run time\n".to_owned();
    write_markdown(&mut text, scenes).unwrap_or_default();
    text
}

fn write_markdown(text: &mut String, scenes: &[ErrorFigures]) -> std::fmt::Result {
    writeln!(
        text,
        "\nError: root mean square distance of the particles from a reference in double precision, at equal simulated \
         times. Wall time: for a simulated second, median of runs in turn (least to most). Bold rows: nothing else is \
         both as fast and as exact."
    )?;
    for figures in scenes {
        let ErrorFigures { scene, particles, links, simulated_secs, size_m, reference_dt_secs, .. } = figures;
        writeln!(
            text,
            "\n## {scene}\n\n{particles} particles, {links} links, {size_m:.3} m, {simulated_secs} s simulated. The \
             reference takes steps of {:.3e} ms; at twice that it differs by {:.1e} m.\n",
            reference_dt_secs * 1e3,
            figures.reference_error_m
        )?;
        for wanted in WANTED_M {
            writeln!(text, "- {}", advice(figures, wanted))?;
        }
        for name in &figures.not_converging {
            writeln!(text, "- **{name} does not converge: its error does not shrink with the step**")?;
        }
        writeln!(text, "\n| scheme | step ms | error m | wall ms |\n|---|---|---|---|")?;
        for row in &figures.rows {
            writeln!(text, "{}", line(figures, row))?;
        }
    }
    Ok(())
}

/// The part of the page about grid resolution.
pub fn cells_markdown(cases: &[CellsFigures]) -> String {
    let mut text = String::new();
    write_cells(&mut text, cases).unwrap_or_default();
    text
}

fn write_cells(text: &mut String, cases: &[CellsFigures]) -> std::fmt::Result {
    writeln!(
        text,
        "\n# Error against grid resolution\n\nBodies of 1 m, ever more cells along them: how far a displacement at rest misses \
         that of the solid. Steps' error: the same body let go under its weight, in automatic stepping, against steps many \
         times smaller. Wall time: for a simulated second at that step."
    )?;
    for figures in cases {
        let CellsFigures { case, reference_m, reference, rows, converges, .. } = figures;
        writeln!(
            text,
            "\n## {case}\n\n{}\n\nThe solid moves by {}, from {reference}.",
            cells_advice(figures),
            millimetres(*reference_m)
        )?;
        if !converges {
            writeln!(text, "\n**The cells do not lead to that: they stand for another solid.**")?;
        }
        writeln!(text, "\n| divisions | particles | error mm | of the displacement | wall s |\n|---|---|---|---|---|")?;
        for CellsRow { divisions, particles, error_m, wall_secs, .. } in rows {
            let share = 100.0 * error_m / reference_m.abs();
            writeln!(text, "| {divisions} | {particles} | {:.4} | {share:.2} % | {wall_secs:.3} |", error_m * 1e3)?;
        }
    }
    Ok(())
}

/// The table of resolutions.
pub fn cells_csv(cases: &[CellsFigures]) -> String {
    let mut text = "case,divisions,particles,displacement_m,error_m,wall_secs,reference_m,steps_divisions,step_secs,\
                    steps_error_m\n"
        .to_owned();
    for figures in cases {
        let CellsFigures { case, reference_m, steps_divisions, step_secs, steps_error_m, .. } = figures;
        for CellsRow { divisions, particles, displacement_m, error_m, wall_secs } in &figures.rows {
            let line = format!(
                "{case},{divisions},{particles},{displacement_m},{error_m},{wall_secs},{reference_m},{steps_divisions},\
                 {step_secs},{steps_error_m}\n"
            );
            text.push_str(&line);
        }
    }
    text
}

fn line(figures: &ErrorFigures, row: &Row) -> String {
    let error = match row.error_rms_m {
        _ if row.diverged => "diverged".to_owned(),
        error if error < 2.0 * figures.reference_error_m => format!("{error:.2e} (as the reference)"),
        error => format!("{error:.2e}"),
    };
    let [median, min, max] = [row.wall_secs_median, row.wall_secs_min, row.wall_secs_max].map(|secs| secs * 1e3);
    let bold = if row.pareto { "**" } else { "" };
    format!(
        "| {bold}{}{bold} | {bold}{}{bold} | {bold}{error}{bold} | {bold}{median:.3}{bold} ({min:.3} to {max:.3}) |",
        row.integrator.name(),
        row.dt_secs * 1e3
    )
}

/// Recommends what to use for an error below `wanted_m`.
pub fn advice(figures: &ErrorFigures, wanted_m: f64) -> String {
    let wanted = length(wanted_m);
    let good = figures.rows.iter().filter(|row| row.error_rms_m <= wanted_m);
    match good.min_by(|a, b| a.wall_secs_median.total_cmp(&b.wall_secs_median)) {
        Some(row) => format!(
            "For {wanted} of error on this scene use {} with a step of {} ms: {:.1} ms per simulated second.",
            row.integrator.words(),
            row.dt_secs * 1e3,
            row.wall_secs_median * 1e3
        ),
        None => format!("Nothing measured stays below {wanted} of error on this scene."),
    }
}

fn length(meters: f64) -> String {
    format!("{} mm", (meters * 1e6).round() / 1e3)
}

/// The table.
pub fn csv(scenes: &[ErrorFigures]) -> String {
    let mut text = "scene,integrator,dt_secs,steps,error_rms_m,wall_secs_median,wall_secs_min,wall_secs_max,diverged,\
                    pareto,reference_error_m\n"
        .to_owned();
    for figures in scenes {
        let scene = quoted(&figures.scene);
        for row in &figures.rows {
            let Row { dt_secs, steps, wall_secs_median, wall_secs_min, wall_secs_max, diverged, pareto, .. } = row;
            let error = if row.diverged { String::new() } else { row.error_rms_m.to_string() };
            let name = row.integrator.name();
            let known = figures.reference_error_m;
            let line = format!(
                "{scene},{name},{dt_secs},{steps},{error},{wall_secs_median},{wall_secs_min},{wall_secs_max},{diverged},\
                 {pareto},{known}\n"
            );
            text.push_str(&line);
        }
    }
    text
}

/// A text as one value of a table of comma-separated values.
pub(crate) fn quoted(text: &str) -> String {
    let plain = !text.contains(['"', ',', '\n', '\r']);
    if plain { text.to_owned() } else { format!("\"{}\"", text.replace('"', "\"\"")) }
}
