//! The stability report as a page and as tables of comma-separated values.

use std::fmt::Write;

use super::contact::ContactFigures;
use super::failures::FailureFigures;
use super::hertz::{HertzFigures, HertzRow};
use super::map::MapFigures;
use super::{CaseFigures, RandomFailure, RandomFigures, StabilityFigures};
use crate::report::error::words::quoted;
use crate::report::judge::{Fault, Verdict};

/// The report as a document.
pub fn markdown(found: &StabilityFigures) -> String {
    let mut text = "# Stability\n".to_owned();
    // Writing to a String cannot fail.
    let _ = write_markdown(&mut text, found);
    text
}

fn write_markdown(text: &mut String, found: &StabilityFigures) -> std::fmt::Result {
    write_cases(text, &found.cases)?;
    write_maps(text, &found.maps)?;
    write_contact(text, &found.contact)?;
    found.hertz.as_ref().map_or(Ok(()), |hertz| write_hertz(text, hertz))?;
    write_failures(text, &found.failures)?;
    found.random.as_ref().map_or(Ok(()), |random| write_random(text, random))
}

fn write_cases(text: &mut String, cases: &[CaseFigures]) -> std::fmt::Result {
    if !cases.is_empty() {
        writeln!(
            text,
            "\nThe largest stable step, predicted and measured (bisection on blow-up, links shaken by a thousandth of a \
             cell, no contact), and the motion in automatic stepping.\n\n\
             | case | predicted ms | measured ms | ratio | automatic | watched s | largest gain |\n\
             |---|---|---|---|---|---|---|"
        )?;
    }
    let milliseconds = |secs: Option<f64>| secs.map_or("–".to_owned(), |secs| format!("{:.3e}", secs * 1e3));
    for figures in cases {
        let CaseFigures { case, verdict, ratio, .. } = figures;
        let [predicted, measured] = [figures.dt_limit_predicted_secs, figures.dt_limit_measured_secs].map(milliseconds);
        let ratio = ratio.map_or("–".to_owned(), |ratio| format!("{ratio:.3}"));
        let automatic = verdict.fault.map_or("passed".to_owned(), |fault| format!("**{}**", fault.words()));
        let cut = if verdict.cut_short { " (cut short)" } else { "" };
        writeln!(
            text,
            "| {case} | {predicted} | {measured} | {ratio} | {automatic} | {:.3}{cut} | {:.1} % |",
            verdict.simulated_secs,
            verdict.largest_gain * 100.0
        )?;
    }
    Ok(())
}

fn write_maps(text: &mut String, maps: &[MapFigures]) -> std::fmt::Result {
    let Some(first) = maps.first() else { return Ok(()) };
    writeln!(
        text,
        "\n## The border over stiffness and damping\n\nThe largest stable stiffness of a cube whose links are all alike, \
         for each damping, both per unit mass, at a step of {} ms; shaken, watched for {} steps. A step of another length has \
         the same border with stiffness times its square and damping times itself. The picture shows after how many steps \
         what is beyond it blows up.\n\n![stability.svg](stability.svg)",
        first.dt_secs * 1e3,
        first.watched
    )?;
    for map in maps {
        let result = if map.passed { "passed" } else { "**failed: what is predicted to be stable blows up**" };
        writeln!(
            text,
            "\n### {}: {result}\n\n| damping 1/s | predicted stiffness 1/s² | measured | ratio |\n|---|---|---|---|",
            map.integrator.words()
        )?;
        for column in &map.columns {
            let number = |value: Option<f64>| value.map_or("–".to_owned(), |value| format!("{value:.3e}"));
            let measured = column.measured.map(|[good, _]| good);
            let ratio = column.predicted.zip(measured).map(|(predicted, measured)| predicted / measured);
            let ratio = ratio.map_or("–".to_owned(), |ratio| format!("{ratio:.3}"));
            let fault = if column.passed { "" } else { " **too much**" };
            writeln!(
                text,
                "| {:.2} | {} | {} | {ratio}{fault} |",
                column.damping,
                number(column.predicted),
                number(measured)
            )?;
        }
        if let (Some([predicted, _]), Some(measured)) = (map.predicted_fall.last(), map.measured_fall) {
            let ratio = predicted / measured;
            let least = map.stiffness.first().copied().unwrap_or(0.0);
            writeln!(
                text,
                "\nAt {least:.0e} 1/s² the largest stable damping is {predicted:.1} 1/s predicted and {measured:.1} 1/s \
                 measured, a ratio of {ratio:.3}."
            )?;
        }
    }
    Ok(())
}

fn write_contact(text: &mut String, contact: &[ContactFigures]) -> std::fmt::Result {
    if contact.is_empty() {
        return Ok(());
    }
    writeln!(
        text,
        "\n## Contact and friction\n\nA cube of a metre, 125 particles, steps of 1 ms. The thesis's rule is shown to compare \
         with and not judged: its pressing force is larger on the way out than on the way in.\n\n\
         | | rule | | wanted | |\n|---|---|---|---|---|"
    )?;
    for figures in contact {
        let ContactFigures { case, rule, unit, value, wanted, passed } = figures;
        let value = value.map_or("never".to_owned(), |value| format!("{} {unit}", short(value)));
        let wanted = wanted.map_or("–".to_owned(), |[least, most]| match short(least).as_str() {
            "0" => format!("at most {}", short(most)),
            least => format!("{least} to {}", short(most)),
        });
        let result = match (figures.wanted, passed) {
            (None, _) => "",
            (_, true) => "passed",
            (_, false) => "**failed**",
        };
        writeln!(text, "| {case} | {rule} | {} | {wanted} | {result} |", value.trim_end())?;
    }
    Ok(())
}

fn write_hertz(text: &mut String, HertzFigures { rows, passed }: &HertzFigures) -> std::fmt::Result {
    writeln!(
        text,
        "\n## A round body against Hertz's theory\n\nA ball of a metre is pressed on a hard plane and on its like, without \
         weight, until nothing moves: the force and the radius of the patch over those of Hertz at the same indentation. It \
         is the approach of the middle and the plane, or half of that of the middles; the patch is that whose pressure has the second moment measured. A ball \
         of cells has a flat at its pole and steps around it: pressed in by less than about a cell it is met like a punch, too \
         hard.\n\n\
         | on | cells across | indentation mm | cells deep | force N | over theory | patch mm | over theory | particles |\n\
         |---|---|---|---|---|---|---|---|---|"
    )?;
    for row in rows {
        let HertzRow { divisions, force_n, force_over_theory, patch_over_theory, points, rest_secs, .. } = row;
        let [indentation, patch] = [row.indentation_m, row.patch_radius_m].map(|meters| meters * 1e3);
        let moving = if rest_secs.is_some() { "" } else { " **still moving**" };
        writeln!(
            text,
            "| {} | {divisions} | {indentation:.2} | {:.2} | {} | {force_over_theory:.3} | {patch:.1} | {patch_over_theory:.3} | \
             {points}{moving} |",
            row.against.word(),
            row.cells_deep(),
            short(*force_n)
        )?;
    }
    let result = if *passed { "Passed: the errors shrink as the cells do." } else { "**Failed.**" };
    writeln!(text, "\n{result}")
}

fn write_failures(text: &mut String, failures: &[FailureFigures]) -> std::fmt::Result {
    for FailureFigures { preset, source, happened, what, why, cures, .. } in failures {
        let happened = if *happened { "" } else { " **It did not happen again.**" };
        writeln!(text, "\n## {preset}: {source}\n\n{what}{happened} {why}\n\n| cure | it holds |\n|---|---|")?;
        for cure in cures {
            writeln!(text, "| {} | {} |", cure.words, if cure.holds { "yes" } else { "no" })?;
        }
    }
    Ok(())
}

fn write_random(text: &mut String, figures: &RandomFigures) -> std::fmt::Result {
    let RandomFigures { seed, scenes, passed, cut_short, not_finite, energy, reach, work, slowed, .. } = figures;
    writeln!(
        text,
        "\n## Random scenes\n\n{scenes} scenes of seed {seed}: {passed} passed, {} failed; {cut_short} were cut short, as \
         they take too many substeps, {slowed} reached the limit of the implicit integrator's work. Wall time of all scenes added up: {:.1} s.\n\n| fault | scenes |\n|---|---|\n| not finite | {not_finite} |\n\
         | energy from nowhere | {energy} |\n| out of reach | {reach} |\n| more work than told | {work} |",
        scenes - passed,
        figures.wall_secs
    )?;
    if !figures.failures.is_empty() {
        writeln!(text, "\n| scene | fault | | sound in double precision |\n|---|---|---|---|")?;
    }
    for RandomFailure { number, fault, words, sound_in_double } in &figures.failures {
        let sound = if *sound_in_double { "yes" } else { "no" };
        writeln!(text, "| {number} | {} | {words} | {sound} |", fault.words())?;
    }
    Ok(())
}

/// The cases as comma-separated values.
pub fn csv(cases: &[CaseFigures]) -> String {
    let mut text = "case,dt_limit_predicted_secs,dt_limit_measured_secs,ratio,automatic_finite,passed,fault,\
                    simulated_secs,cut_short,substeps,largest_gain\n"
        .to_owned();
    let number = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:e}"));
    for figures in cases {
        let CaseFigures { case, automatic_finite, passed, verdict, .. } = figures;
        let [predicted, measured, ratio] =
            [figures.dt_limit_predicted_secs, figures.dt_limit_measured_secs, figures.ratio].map(number);
        let fault = verdict.fault.map_or("", Fault::words);
        let Verdict { simulated_secs, cut_short, substeps, largest_gain, .. } = verdict;
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "\"{}\",{predicted},{measured},{ratio},{automatic_finite},{passed},{fault},{simulated_secs:e},{cut_short},\
             {substeps},{largest_gain:e}",
            case.replace('"', "\"\"")
        );
    }
    text
}

/// A number for a person to read, to about three digits.
fn short(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        middling if (0.01..1e4).contains(&middling) => format!("{}", (value * 1e4).round() / 1e4),
        _ => format!("{value:.1e}"),
    }
}

/// The maps as comma-separated values: a line for every stiffness and damping.
pub fn map_csv(maps: &[MapFigures]) -> String {
    let mut text = "integrator,dt_secs,damping_per_mass,stiffness_per_mass,steps_survived,steps_watched,\
                    stiffness_predicted,stiffness_measured\n"
        .to_owned();
    let number = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:e}"));
    for map in maps {
        let (name, dt, watched) = (map.integrator.name(), map.dt_secs, map.watched);
        for column in &map.columns {
            let [predicted, measured] = [column.predicted, column.measured.map(|[good, _]| good)].map(number);
            for (stiffness, survived) in map.stiffness.iter().zip(&column.survived) {
                // Writing to a String cannot fail.
                let _ = writeln!(
                    text,
                    "{name},{dt},{:e},{stiffness:e},{survived},{watched},{predicted},{measured}",
                    column.damping
                );
            }
        }
    }
    text
}

/// The measurements of contact as comma-separated values.
pub fn contact_csv(contact: &[ContactFigures]) -> String {
    let mut text = "case,rule,value,unit,least,most,passed\n".to_owned();
    for ContactFigures { case, rule, unit, value, wanted, passed } in contact {
        let value = value.map_or(String::new(), |value| format!("{value:e}"));
        let wanted = wanted.map_or(",".to_owned(), |[least, most]| format!("{least:e},{most:e}"));
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{},{rule},{value},{unit},{wanted},{passed}", quoted(case));
    }
    text
}

/// The comparison of a ball with Hertz's theory as comma-separated values.
pub fn hertz_csv(figures: Option<&HertzFigures>) -> String {
    let mut text =
        "against,divisions,particles,indentation_m,force_n,force_over_theory,patch_radius_m,patch_over_theory,points,\
                    rest_secs,passed\n"
            .to_owned();
    if let Some(HertzFigures { rows, passed }) = figures {
        for row in rows {
            let HertzRow { divisions, particles, indentation_m, force_n, force_over_theory, .. } = row;
            let HertzRow { patch_radius_m, patch_over_theory, points, .. } = row;
            let rest_secs = row.rest_secs.map_or(String::new(), |secs| format!("{secs}"));
            // Writing to a String cannot fail.
            let _ = writeln!(
                text,
                "{},{divisions},{particles},{indentation_m:e},{force_n:e},{force_over_theory},{patch_radius_m:e},\
                 {patch_over_theory},{points},{rest_secs},{passed}",
                row.against.word()
            );
        }
    }
    text
}
