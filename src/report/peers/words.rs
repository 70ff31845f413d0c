//! The comparison as a page and as a table of comma-separated values.

use std::fmt::Write;

use super::pile::{PileFigures, PileRow};
use super::{Contender, MatchedPeer, Peer, PeersFigures, Row, SAME_SAG, SKIN_SHARE, SUBSTEPS};
use crate::report::error::words::quoted;

/// Errors that somebody may want to stay below, m.
const WANTED_M: [f64; 3] = [0.01, 0.001, 0.0001];

/// The page.
pub fn markdown(cubes: &[PeersFigures], pile: &PileFigures) -> String {
    let mut text = "# Beside another engine\n".to_owned();
    // Writing to a String cannot fail.
    let _ = write_markdown(&mut text, cubes).and_then(|()| write_pile(&mut text, pile));
    text
}

fn write_pile(text: &mut String, figures: &PileFigures) -> std::fmt::Result {
    let PileFigures { bodies, cells, particles, links, falling_secs, lying_secs, rows, .. } = figures;
    writeln!(
        text,
        "\n## A pile\n\nThe preset `pile`: {bodies} bodies of {cells} cells, {particles} particles and {links} links in all fall \
         into a bowl. Rapier has our links as edges and the outer faces of our cells as surfaces, which it holds apart by a \
         skin of {:.0} % of a cell; neither looks for bodies that fold onto themselves. Time of the processor for a simulated \
         second, one run each, of the {falling_secs} s in which they fall and of the {lying_secs} s after it. At the end: the \
         deepest that a particle of one is inside the surface of another, found in the same way of both, how fast the \
         particles move, root of the mean square, and how many bodies are in the bowl.\n\n\
         | body | step ms | falling ms | lying ms | deepest mm | mm/s | in the bowl |\n|---|---|---|---|---|---|---|",
        SKIN_SHARE * 100.0
    )?;
    for row in rows {
        let PileRow { contender, dt_secs, falling_secs, lying_secs, .. } = row;
        let [falling, lying] = [falling_secs, lying_secs].map(|secs| secs * 1e3);
        let outcome = match row.end {
            Some(end) => {
                format!("{:.2} | {:.1} | {}", end.deepest_m * 1e3, end.speed_m_s * 1e3, end.in_bowl)
            }
            None => "diverged | – | –".to_owned(),
        };
        writeln!(text, "| {} | {} | {falling:.0} | {lying:.0} | {outcome} |", contender.name(), dt_secs * 1e3)?;
    }
    if let Some(defect) = figures.defect() {
        writeln!(text, "\n**{defect}**")?;
    }
    Ok(())
}

/// The table of the pile.
pub fn pile_csv(figures: &PileFigures) -> String {
    let mut text =
        "contender,dt_secs,falling_processor_secs,lying_processor_secs,deepest_m,speed_m_s,in_bowl\n".to_owned();
    for PileRow { contender, dt_secs, falling_secs, lying_secs, end } in &figures.rows {
        let end = end.map_or(",,".to_owned(), |end| format!("{},{},{}", end.deepest_m, end.speed_m_s, end.in_bowl));
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{},{dt_secs},{falling_secs},{lying_secs},{end}", quoted(contender.name()));
    }
    text
}

fn write_markdown(text: &mut String, cubes: &[PeersFigures]) -> std::fmt::Result {
    writeln!(
        text,
        "\nA cube of 1 m hangs by its top and is let go unstretched: Gelatin's solid, and soft bodies of rapier3d 0.36 \
         of the same particles, masses and pins, as stiff as makes them hang as low ({:.0} % of difference is allowed), \
         on one thread each and in the same process. Its elastic cells have the damping with which they swing most like \
         ours.\n\n\
         Error: root mean square distance of the particles from our converged reference in double precision, at equal \
         times of the swing and hanging still. With our links rapier solves the same equations, so that its error is \
         that of its steps; its elastic cells, five tetrahedra in each of ours, are another discrete body, and their \
         error contains the difference, which is there at rest too.\n\n\
         Times: for a simulated second of the swing, medians of five runs in turn (least to most), of the processor, by \
         which the bodies are compared, and of the wall clock: on a busy machine a long run waits more often than a \
         short one. A step of rapier is divided into {SUBSTEPS} substeps, as it does by itself. Bold rows: nothing else \
         is both as fast and as exact.",
        SAME_SAG * 100.0
    )?;
    for figures in cubes {
        write_cube(text, figures)?;
    }
    Ok(())
}

fn write_cube(text: &mut String, figures: &PeersFigures) -> std::fmt::Result {
    let PeersFigures { divisions, particles, links, simulated_secs, sag_m, .. } = figures;
    writeln!(
        text,
        "\n## {divisions} divisions\n\n{particles} particles, {links} links, {simulated_secs} s of swing; at rest its \
         lowest particles hang {:.3} mm low. The reference takes steps of {:.3e} ms; at twice that it differs by {:.1e} m.\n",
        sag_m * 1e3,
        figures.reference_dt_secs * 1e3,
        figures.reference_error_m
    )?;
    for wanted in WANTED_M {
        writeln!(text, "- {}", advice(figures, wanted))?;
    }
    for matched in &figures.peers {
        writeln!(text, "- {}", matched_words(matched))?;
    }
    for defect in &figures.defects {
        writeln!(text, "- **{defect}**")?;
    }
    writeln!(
        text,
        "\n| body | step ms | sag mm | error swinging m | error at rest m | processor ms | wall ms |\n\
         |---|---|---|---|---|---|---|"
    )?;
    for row in &figures.rows {
        writeln!(text, "{}", line(row))?;
    }
    Ok(())
}

fn matched_words(matched: &MatchedPeer) -> String {
    let MatchedPeer { peer, stiffness, damping, sag_m, same_sag } = matched;
    let name = Contender::Peer(*peer).name();
    let made_of = match peer {
        Peer::Links => format!("{stiffness:.4} times the stiffness of our links and their damping"),
        Peer::Cells | Peer::Elements => format!("a modulus of {stiffness:.4e} Pa and a damping ratio of {damping:.2}"),
    };
    if *same_sag {
        format!("{name}: {made_of}.")
    } else {
        format!("**{name} cannot hang as low: {:.3} mm at the nearest, with {made_of}.**", sag_m * 1e3)
    }
}

/// Names the fastest of ours and of the other engine with an error below `wanted_m`.
pub fn advice(figures: &PeersFigures, wanted_m: f64) -> String {
    let good =
        || figures.rows.iter().filter(|row| row.same_sag && row.swing_rms_m.is_some_and(|error| error <= wanted_m));
    let fastest = |is_ours: bool| {
        let of_side = good().filter(|row| matches!(row.contender, Contender::Ours(_)) == is_ours);
        of_side.min_by(|a, b| a.processor_secs_median.total_cmp(&b.processor_secs_median))
    };
    let told = |row: &Row| {
        format!(
            "{} with a step of {} ms: {:.1} ms",
            row.contender.name(),
            row.dt_secs * 1e3,
            row.processor_secs_median * 1e3
        )
    };
    let wanted = wanted_m * 1e3;
    match (fastest(true), fastest(false)) {
        (Some(ours), Some(theirs)) => format!(
            "For {wanted} mm of error: {}; {}: {:.1} times ours.",
            told(ours),
            told(theirs),
            theirs.processor_secs_median / ours.processor_secs_median
        ),
        (Some(ours), None) => {
            format!("For {wanted} mm of error: {}; no peer measured stays below it.", told(ours))
        }
        (None, Some(theirs)) => {
            format!("For {wanted} mm of error: {}; nothing measured of ours stays below it.", told(theirs))
        }
        (None, None) => format!("Nothing measured stays below {wanted} mm of error in the swing."),
    }
}

fn line(row: &Row) -> String {
    let Row { contender, dt_secs, sag_m, same_sag, swing_rms_m, rest_rms_m, .. } = row;
    let [median, min, max] = [row.wall_secs_median, row.wall_secs_min, row.wall_secs_max].map(|secs| secs * 1e3);
    let processor = [row.processor_secs_median, row.processor_secs_min, row.processor_secs_max].map(|secs| secs * 1e3);
    let swing = swing_rms_m.map_or("diverged".to_owned(), |error| format!("{error:.2e}"));
    let sag = format!("{:.3}{}", sag_m * 1e3, if *same_sag { "" } else { " (another sag)" });
    let bold = if row.pareto { "**" } else { "" };
    format!(
        "| {bold}{}{bold} | {bold}{}{bold} | {sag} | {bold}{swing}{bold} | {rest_rms_m:.2e} | \
         {bold}{:.1}{bold} ({:.1} to {:.1}) | {median:.1} ({min:.1} to {max:.1}) |",
        contender.name(),
        dt_secs * 1e3,
        processor[0],
        processor[1],
        processor[2]
    )
}

/// The table.
pub fn csv(cubes: &[PeersFigures]) -> String {
    let mut text = "divisions,contender,dt_secs,sag_m,same_sag,swing_rms_m,rest_rms_m,wall_secs_median,wall_secs_min,\
                    wall_secs_max,processor_secs_median,processor_secs_min,processor_secs_max,pareto,\
                    reference_sag_m,reference_error_m\n"
        .to_owned();
    for figures in cubes {
        let PeersFigures { divisions, sag_m: reference_sag_m, reference_error_m, .. } = figures;
        for row in &figures.rows {
            let Row { dt_secs, sag_m, same_sag, rest_rms_m, pareto, .. } = row;
            let Row { wall_secs_median, wall_secs_min, wall_secs_max, .. } = row;
            let Row { processor_secs_median, processor_secs_min, processor_secs_max, .. } = row;
            let name = quoted(row.contender.name());
            let swing = row.swing_rms_m.map_or(String::new(), |error| error.to_string());
            let line = format!(
                "{divisions},{name},{dt_secs},{sag_m},{same_sag},{swing},{rest_rms_m},{wall_secs_median},{wall_secs_min},\
                 {wall_secs_max},{processor_secs_median},{processor_secs_min},{processor_secs_max},{pareto},\
                 {reference_sag_m},{reference_error_m}\n"
            );
            text.push_str(&line);
        }
    }
    text
}
