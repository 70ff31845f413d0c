//! The figures of a run that a study asks for, by their names in `gelatin run --json`: `max_speed`,
//! `energy_joule.total`, `center.1`.

use anyhow::anyhow;
use serde_json::Value;

use crate::cli::Failure;
use crate::text::echo;

/// The default figures.
const DEFAULT_FIGURES: [&str; 6] =
    ["finite", "max_speed", "peak.max_strain", "peak.max_penetration_m", "energy_joule.total", "wall_secs"];

/// The units of figures, by how their names end or begin.
const UNITS: [(&str, &str); 9] = [
    ("secs", "s"),
    ("_m", "m"),
    ("_kg", "kg"),
    ("_bytes", "bytes"),
    ("_speed", "m/s"),
    ("energy_joule", "J"),
    ("momentum", "kg·m/s"),
    ("center", "m"),
    ("bounds", "m"),
];

/// The names asked for, separated by commas, or the default ones; `specimen` is the output of any run.
pub(super) fn names(asked: Option<&str>, specimen: &Value) -> Result<Vec<String>, Failure> {
    let names: Vec<String> = match asked {
        Some(text) => text.split(',').map(|name| name.trim().to_owned()).collect(),
        None => DEFAULT_FIGURES.map(str::to_owned).to_vec(),
    };
    let mut known = Vec::new();
    collect_names("", specimen, &mut known);
    for (index, name) in names.iter().enumerate() {
        if !known.contains(name) {
            let (name, known) = (echo(name), known.join(", "));
            return Err(Failure::usage(anyhow!("a run has no figure {name:?}; it has {known}")));
        }
        if names[..index].contains(name) {
            return Err(Failure::usage(anyhow!("the figure {name} is asked for twice")));
        }
    }
    Ok(names)
}

/// The figure of a name.
pub(super) fn figure<'a>(run: &'a Value, name: &str) -> Value {
    let below = |node: &'a Value, word: &str| match node {
        Value::Array(entries) => entries.get(word.parse::<usize>().ok()?),
        node => node.get(word),
    };
    name.split('.').try_fold(run, below).cloned().unwrap_or_default()
}

/// The name with its unit, for the axis of a plot.
pub(super) fn title(name: &str) -> String {
    let fits = |pattern: &str| {
        name.ends_with(pattern) || name.split('.').any(|word| word == pattern || word.ends_with(pattern))
    };
    let unit = UNITS.iter().find(|(pattern, _)| fits(pattern)).map(|(_, unit)| unit);
    unit.map_or(name.to_owned(), |unit| format!("{name}, {unit}"))
}

/// A figure in a table of comma-separated values.
pub(super) fn cell(figure: &Value) -> String {
    match figure {
        Value::Null => String::new(),
        Value::String(text) if text.contains(['"', ',', '\n', '\r']) => format!("\"{}\"", text.replace('"', "\"\"")),
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

/// Collects the names of all single values. The stages and the warnings of a run are left out, as lists of varying length.
fn collect_names(path: &str, node: &Value, found: &mut Vec<String>) {
    let below = |name: &str| if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
    match node {
        _ if ["stages", "warnings"].contains(&path) => {}
        Value::Object(fields) => fields.iter().for_each(|(name, node)| collect_names(&below(name), node, found)),
        Value::Array(entries) => {
            entries.iter().enumerate().for_each(|(index, node)| collect_names(&below(&index.to_string()), node, found));
        }
        _ => found.push(path.to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn names_are_those_of_single_values() {
        let run = json!({ "a": 1.5, "b": { "c": [1, 2] }, "d": null, "stages": [{ "secs": 1 }] });
        let known = |asked: &str| names(Some(asked), &run).map_err(|failure| failure.to_string());
        assert_eq!(known("b.c.1, a,d"), Ok(vec!["b.c.1".into(), "a".into(), "d".into()]));
        for (asked, word) in [
            ("b", "no figure \"b\"; it has a, b.c.0"),
            ("", "no figure"),
            ("a,a", "twice"),
            ("stages.0.secs", "no figure"),
        ] {
            assert!(known(asked).is_err_and(|why| why.contains(word)), "{asked}: {:?}", known(asked));
        }
        assert_eq!((figure(&run, "b.c.1"), figure(&run, "a")), (json!(2), json!(1.5)));
        assert_eq!(figure(&run, "b.c.7"), Value::Null);
    }

    #[test]
    fn titles_carry_units() {
        for (name, title_of) in [
            ("wall_secs", "wall_secs, s"),
            ("peak.max_penetration_m", "peak.max_penetration_m, m"),
            ("start.energy_joule.total", "start.energy_joule.total, J"),
            ("peak.total_energy_joule", "peak.total_energy_joule, J"),
            ("max_speed", "max_speed, m/s"),
            ("bounds.max.1", "bounds.max.1, m"),
            ("max_strain", "max_strain"),
        ] {
            assert_eq!(title(name), title_of);
        }
    }

    #[test]
    fn texts_are_quoted_where_they_must_be() {
        assert_eq!(cell(&json!("a, \"b\"")), "\"a, \"\"b\"\"\"");
        assert_eq!(
            (cell(&json!(0.5)), cell(&json!(true)), cell(&Value::Null)),
            ("0.5".into(), "true".into(), String::new())
        );
    }
}
