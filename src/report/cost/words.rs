//! The cost report as a page and as a table of comma-separated values.

use std::fmt::Write;

use super::crowd::CrowdRow;
use super::{Ablation, CostFigures};
use crate::report::error::words::quoted;

/// The page.
pub fn markdown(scenes: &[CostFigures], crowd: &[CrowdRow]) -> String {
    let mut text = "# What scenes cost\n".to_owned();
    // Writing to a String cannot fail.
    let _ = write_page(&mut text, scenes, crowd);
    text
}

fn write_page(text: &mut String, scenes: &[CostFigures], crowd: &[CrowdRow]) -> std::fmt::Result {
    writeln!(
        text,
        "\nTimes of stages are sums over the run, by the clock. A feature is compared by substeps with and without it, in \
         turn, from the same state, in time of the processor: median of fifteen pairs, in brackets the spread without the \
         two least and the two most of them; where a substep takes more than 20 ms, of seven and without one of each. \
         Where that holds both more and less, the pairs do not agree, and the change is within the noise of the machine. \
         The control compares a scene with itself.\n\n\
         | scene | particles | links | µs a substep | most of it | left out |\n|---|---|---|---|---|---|"
    )?;
    for figures in scenes {
        let largest = figures.stages.iter().max_by(|a, b| a.share.total_cmp(&b.share));
        let largest = largest
            .map_or(String::new(), |stage| format!("{}, {:.0} %", stage.name.replace('_', " "), stage.share * 100.0));
        let left_out: Vec<&str> = figures.left_out.iter().map(|left_out| left_out.name.as_str()).collect();
        let CostFigures { scene, particles, links, substep_secs, .. } = figures;
        let left_out = left_out.join(", ");
        writeln!(text, "| {scene} | {particles} | {links} | {:.1} | {largest} | {left_out} |", substep_secs * 1e6)?;
    }
    for figures in scenes {
        write_scene(text, figures)?;
    }
    if !crowd.is_empty() {
        write_crowd(text, crowd)?;
    }
    Ok(())
}

fn write_scene(text: &mut String, figures: &CostFigures) -> std::fmt::Result {
    let CostFigures { scene, particles, links, simulated_secs, substeps, .. } = figures;
    writeln!(
        text,
        "\n## {scene}\n\n{particles} particles, {links} links, {substeps} substeps in {simulated_secs:.3} s\n"
    )?;
    if let Some(secs) = figures.exploded_at_secs {
        writeln!(text, "It explodes after {secs:.3} s. Its features are compared at its start.\n")?;
    }
    writeln!(text, "| stage | begun | ms | share |\n|---|---|---|---|")?;
    for stage in &figures.stages {
        let (name, count) = (stage.name.replace('_', " "), stage.count);
        writeln!(text, "| {name} | {count} | {:.1} | {:.1} % |", stage.secs * 1e3, stage.share * 100.0)?;
    }
    writeln!(text, "\n| left out | why |\n|---|---|")?;
    for left_out in &figures.left_out {
        writeln!(text, "| {} | {} |", left_out.name, left_out.why)?;
    }
    writeln!(text, "\n| counted | |\n|---|---|")?;
    let counters = [
        ("link forces", figures.link_forces),
        ("of these damped", figures.damped_link_forces),
        ("narrow tests", figures.narrow_tests),
        ("narrow tests saved by boxes", figures.narrow_tests_saved),
        ("tests against spheres", figures.sphere_tests),
        ("pushes of obstacles with friction", figures.frictions),
        ("points of bodies looked for in cells", figures.points_looked_for),
        ("contacts between and within bodies", figures.body_contacts),
        ("parts that contact divides substeps into", figures.contact_parts),
        ("cells looked at for inversion", figures.cells_looked_at),
        ("cells pushed back", figures.recovery_cells),
        ("bodies asleep at the end", figures.bodies_asleep as u64),
    ];
    for (name, count) in counters {
        writeln!(text, "| {name} | {count} |")?;
    }
    writeln!(
        text,
        "\n| feature | with it, µs | without, µs | for each | it changes the time by | same motion to the bit |\n|---|---|---|---|---|---|"
    )?;
    for row in &figures.ablation {
        let Ablation { feature, per, .. } = row;
        let [on, off] = [row.secs_on, row.secs_off].map(|secs| secs * 1e6);
        let same = match (row.same_bits, row.must_be_same) {
            (true, true) => "yes, as it must be",
            (true, false) => "yes",
            (false, false) => "no",
            (false, true) => "NO, BUT IT MUST BE",
        };
        writeln!(text, "| {feature} | {on:.2} | {off:.2} | {per} | {} | {same} |", row.change.words())?;
    }
    Ok(())
}

fn write_crowd(text: &mut String, crowd: &[CrowdRow]) -> std::fmt::Result {
    writeln!(
        text,
        "\n## A cube in a crowd\n\nA cube on the ground among balls, with the broad phase and without it (GC §7); times and \
         tests of particles against obstacles are of a substep.\n\n\
         | particles | obstacles | tests with it | without | µs with it | without | it changes the time by | same motion to \
         the bit |\n|---|---|---|---|---|---|---|---|"
    )?;
    for row in crowd {
        let CrowdRow { particles, obstacles, tests_on, tests_off, .. } = row;
        let [on, off] = [row.secs_on, row.secs_off].map(|secs| secs * 1e6);
        let same = if row.same_bits { "yes, as it must be" } else { "NO, BUT IT MUST BE" };
        writeln!(
            text,
            "| {particles} | {obstacles} | {tests_on:.0} | {tests_off:.0} | {on:.2} | {off:.2} | {} | {same} |",
            row.change.words()
        )?;
    }
    Ok(())
}

/// The table: a line for each stage of a scene, each feature that it leaves out, each feature compared, and each crowd.
pub fn csv(scenes: &[CostFigures], crowd: &[CrowdRow]) -> String {
    let mut text =
        "scene,kind,name,secs,secs_without,share,change_low,change_high,within_noise,same_bits,note\n".to_owned();
    // Writing to a String cannot fail.
    let _ = write_csv(&mut text, scenes, crowd);
    text
}

fn write_csv(text: &mut String, scenes: &[CostFigures], crowd: &[CrowdRow]) -> std::fmt::Result {
    for figures in scenes {
        let scene = quoted(&figures.scene);
        for stage in &figures.stages {
            writeln!(text, "{scene},stage,{},{:e},,{},,,,,", stage.name, stage.secs, stage.share)?;
        }
        for left_out in &figures.left_out {
            writeln!(text, "{scene},left out,{},,,,,,,,{}", quoted(&left_out.name), quoted(left_out.why))?;
        }
        for row in &figures.ablation {
            let Ablation { feature, per, secs_on, secs_off, change, within_noise, same_bits, .. } = row;
            writeln!(
                text,
                "{scene},feature,{},{secs_on:e},{secs_off:e},{},{},{},{within_noise},{same_bits},each {per}",
                quoted(feature),
                change.median,
                change.low,
                change.high
            )?;
        }
    }
    for row in crowd {
        let CrowdRow { particles, obstacles, secs_on, secs_off, change, within_noise, same_bits, .. } = row;
        writeln!(
            text,
            "crowd,broad phase,{particles} particles {obstacles} obstacles,{secs_on:e},{secs_off:e},{},{},{},\
             {within_noise},{same_bits},{:.0} tests of {:.0}",
            change.median, change.low, change.high, row.tests_on, row.tests_off
        )?;
    }
    Ok(())
}
