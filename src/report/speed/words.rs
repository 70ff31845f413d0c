//! The speed report as a page and as a table of comma-separated values.

use std::fmt::Write;

use super::scenes::{BodyContactSpeed, SceneSpeed};
use super::{SpeedFigures, SpeedRow};
use crate::report::error::words::quoted;

/// The page.
pub fn markdown(figures: &SpeedFigures) -> String {
    let mut text = "# How fast a step is\n".to_owned();
    // Writing to a String cannot fail.
    let _ = write_page(&mut text, figures);
    text
}

fn write_page(text: &mut String, figures: &SpeedFigures) -> std::fmt::Result {
    if !figures.rows.is_empty() {
        write_cubes(text, figures)?;
    }
    let start = if figures.rows.is_empty() {
        "From the start"
    } else {
        "From the start, a pile from when its bodies lie on each other"
    };
    writeln!(
        text,
        "\n## Scenes\n\n{start}; steps divided as they must be, with nothing drawn.\n\n\
         | scene | particles | threads | simulated, s | × real time |\n|---|---|---|---|---|"
    )?;
    for speed in &figures.scenes {
        let SceneSpeed { scene, particles, threads, simulated_secs, real_time_factor, .. } = speed;
        // This shows three digits of a value that may be hundreds or hundredths.
        let digits = if *real_time_factor < 1.0 { 3 } else { usize::from(*real_time_factor < 10.0) };
        let exploded = speed.exploded_at_secs.map_or_else(String::new, |secs| format!(", exploded at {secs:.3} s"));
        writeln!(
            text,
            "| {scene} | {particles} | {threads} | {simulated_secs:.2} | {real_time_factor:.digits$}{exploded} |"
        )?;
    }
    if figures.scenes.iter().any(|speed| speed.modes_as_cells) {
        writeln!(text, "\nBodies that move by their modes are timed by their cells.")?;
    }
    if figures.scenes.iter().any(|speed| speed.meeting.is_some()) {
        write_meeting(text, &figures.scenes)?;
    }
    Ok(())
}

fn write_cubes(text: &mut String, figures: &SpeedFigures) -> std::fmt::Result {
    let SpeedFigures { peak_gflops_fma, .. } = figures;
    writeln!(
        text,
        "\nWhole steps of a cube that is free in space, n particles along an edge, beside the loop that everybody writes \
         first (`naive`: particles and springs as structures in two lists). All take turns in one process, each turn with \
         a step at its beginning that does not count: time of the processor for one thread, of the wall clock for \
         several; medians of nine rounds, the ratio pair by pair, in brackets without the least and the most of them: \
         where that is wide, the machine was busy. Peak is \
         {peak_gflops_fma:.0} GFLOP/s, one thread of multiplications with additions and nothing else, measured beside it; \
         a link counts as 32 operations.\n\n\
         | n | kernel | instructions | threads | ns a link | ns a particle | × naive | of the peak |\n\
         |---|---|---|---|---|---|---|---|"
    )?;
    for row in &figures.rows {
        let SpeedRow { n, kernel, simd, threads, ns_per_link, ns_per_particle, ratio_to_naive, .. } = row;
        let [low, high] = row.ratio_range;
        let ratio =
            if row.hash.is_some() { format!("{ratio_to_naive:.1} ({low:.1} to {high:.1})") } else { "1".to_owned() };
        writeln!(
            text,
            "| {n} | {kernel} | {simd} | {threads} | {ns_per_link:.2} | {ns_per_particle:.1} | {ratio} | {:.1} % |",
            100.0 * row.fraction_of_peak
        )?;
    }
    if let Some(n) = figures.largest_real_time_n {
        writeln!(
            text,
            "\nThe largest cube whose undivided steps of 1 ms take no longer than that: {n} particles along an edge."
        )?;
    }
    if let Some(ratio) = figures.ring_over_cube {
        writeln!(
            text,
            "A link of a ring in a box of 64³ takes {ratio:.2} times as long as one of the cube that fills it."
        )?;
    }
    if let Some(words) = figures.defect() {
        writeln!(text, "\n**{words}**")?;
    }
    Ok(())
}

fn write_meeting(text: &mut String, scenes: &[SceneSpeed]) -> std::fmt::Result {
    writeln!(
        text,
        "\n## Bodies that meet\n\nA second is one of the wall clock. Points are looked for in the cells of another body that \
         is near them, or of their own where it folds; contacts are solved together. The share is that of finding and solving \
         them in the time of a step.\n\n\
         | scene | bodies | threads | contacts | contacts a second | points looked for a second | share of a step |\n\
         |---|---|---|---|---|---|---|"
    )?;
    for SceneSpeed { scene, threads, meeting, .. } in scenes {
        if let Some(BodyContactSpeed { bodies, contacts, contacts_per_sec, points_per_sec, share }) = meeting {
            writeln!(
                text,
                "| {scene} | {bodies} | {threads} | {contacts:.0} | {contacts_per_sec:.2e} | {points_per_sec:.2e} | {:.1} % |",
                100.0 * share
            )?;
        }
    }
    Ok(())
}

/// The scenes.
pub fn scenes_csv(scenes: &[SceneSpeed]) -> String {
    let mut text = "scene,particles,threads,simulated_secs,real_time_factor,bodies,contacts,contacts_per_sec,\
                    points_per_sec,share,exploded_at_secs\n"
        .to_owned();
    for SceneSpeed { scene, particles, threads, simulated_secs, real_time_factor, exploded_at_secs, meeting, .. } in
        scenes
    {
        let meeting = meeting.map_or(",,,,".to_owned(), |meeting| {
            let BodyContactSpeed { bodies, contacts, contacts_per_sec, points_per_sec, share } = meeting;
            format!("{bodies},{contacts},{contacts_per_sec},{points_per_sec},{share}")
        });
        let exploded = exploded_at_secs.map_or_else(String::new, |secs| secs.to_string());
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{},{particles},{threads},{simulated_secs},{real_time_factor},{meeting},{exploded}",
            quoted(scene)
        );
    }
    text
}

/// The rows of cubes.
pub fn csv(figures: &SpeedFigures) -> String {
    let mut text = "n,kernel,simd,threads,ns_per_link,ns_per_particle,ratio_to_naive,ratio_low,ratio_high,\
                    fraction_of_peak,hash\n"
        .to_owned();
    for row in &figures.rows {
        let SpeedRow { n, kernel, simd, threads, ns_per_link, ns_per_particle, ratio_to_naive, .. } = row;
        let ([low, high], peak) = (row.ratio_range, row.fraction_of_peak);
        let hash = row.hash.as_deref().unwrap_or_default();
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{n},{kernel},{simd},{threads},{ns_per_link},{ns_per_particle},{ratio_to_naive},{low},{high},{peak},{hash}"
        );
    }
    text
}
