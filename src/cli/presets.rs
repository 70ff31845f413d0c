//! `gelatin presets`: the scenes that the program carries, and everything that can be set.

use clap::Args;
use serde_json::{Value, json};

use super::{Failure, out};
use crate::scene::param::{Kind, PARAMS, Param};
use crate::scene::presets::presets;

/// What to list.
#[derive(Debug, Args)]
pub(super) struct PresetsArgs {
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
    /// List every path that --set takes, with unit, range, default and help, instead of the presets.
    #[arg(long)]
    params: bool,
}

/// Prints the list.
pub(super) fn run(args: &PresetsArgs) -> Result<(), Failure> {
    match (args.json, args.params) {
        (true, false) => {
            let list = presets().iter().map(|preset| json!({ "name": preset.name, "summary": preset.summary }));
            out::json(&json!({ "presets": list.collect::<Vec<_>>() }))?;
        }
        (true, true) => out::json(&json!({ "params": PARAMS.iter().map(param_json).collect::<Vec<_>>() }))?,
        (false, false) => {
            let width = presets().iter().map(|preset| preset.name.len()).max().unwrap_or(0);
            for preset in presets() {
                out::figures(&format!("{:width$}  {}", preset.name, preset.summary))?;
            }
        }
        (false, true) => {
            for param in PARAMS {
                out::figures(&param_text(param))?;
            }
        }
    }
    Ok(())
}

fn param_text(param: &Param) -> String {
    let path = param.path.replace('*', "N");
    let of = if param.len > 1 { format!("{} × ", param.len) } else { String::new() };
    let default = match param.default_value() {
        Some(Value::String(word)) if word.is_empty() => "none".to_owned(),
        Some(Value::String(word)) => word,
        Some(value) => value.to_string(),
        None if param.is_optional() => "automatic".to_owned(),
        None => "none".to_owned(),
    };
    format!("{path}\n    {of}{}; default {default}\n    {}", param.range_text(), param.help)
}

fn param_json(param: &Param) -> Value {
    let (kind, min, max, words) = match param.kind {
        Kind::Number { min, max } => ("number", json!(min), json!(max), json!([])),
        Kind::NumberOr { word, min, max } => ("number", json!(min), json!(max), json!([word])),
        Kind::Integer { min, max } => ("integer", json!(min), json!(max), json!([])),
        Kind::Flag => ("flag", Value::Null, Value::Null, json!([])),
        Kind::Text => ("text", Value::Null, Value::Null, json!([])),
        Kind::Word(words) => ("word", Value::Null, Value::Null, json!(words)),
        Kind::List => ("list", Value::Null, Value::Null, json!([])),
    };
    json!({
        "path": param.path.replace('*', "N"),
        "kind": kind,
        "count": param.len,
        "unit": param.unit,
        "min": min,
        "max": max,
        "words": words,
        "logarithmic": param.logarithmic,
        "default": param.default_value(),
        "help": param.help,
    })
}
