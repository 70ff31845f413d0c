//! Suggests what a first word may mean that is neither a command nor a scene.

use std::ffi::OsStr;
use std::path::Path;

use anyhow::anyhow;
use clap::CommandFactory;

use super::arguments::Arguments;
use super::failure::Failure;
use crate::scene::presets;
use crate::text::{distance, echo};

/// Refuses a word that looks like a command but is no command, no preset's name and no file.
pub(super) fn refusal(word: &OsStr) -> Option<Failure> {
    let path = Path::new(word);
    let presets: Vec<&str> = presets::presets().iter().map(|preset| preset.name).collect();
    let word = word.to_str().filter(|word| !word.is_empty() && !word.starts_with('-') && !presets.contains(word))?;
    // A name with an extension or a folder means a file.
    if path.exists() || path.extension().is_some() || path.components().count() > 1 {
        return None;
    }
    let arguments = Arguments::command();
    let commands: Vec<&str> = arguments.get_subcommands().map(clap::Command::get_name).collect();
    if commands.contains(&word) {
        return None;
    }
    let nearest = commands.iter().chain(&presets).min_by_key(|name| distance(word, name));
    let meant = nearest.filter(|name| distance(word, name) <= word.chars().count() / 2);
    let meant = meant.map(|name| format!("; did you mean {name}?")).unwrap_or_default();
    Some(Failure::usage(anyhow!(
        "there is no command, no preset and no file called {}{meant}\ncommands are {}\npresets are {}",
        echo(word),
        commands.join(", "),
        presets.join(", ")
    )))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_word_that_may_be_a_command_is_refused_with_the_nearest() {
        let said = |word: &str| refusal(OsStr::new(word)).map(|failure| failure.to_string());
        assert!(said("chek").is_some_and(|words| words.contains("did you mean check?")), "a slip");
        assert!(said("tre").is_some_and(|words| words.contains("did you mean tree?")), "of a preset's name");
        assert!(said("wobblewobble").is_some_and(|words| !words.contains("did you mean")), "nothing is near");
        for word in ["check", "tree", "gone.obj", "there/gone", "--wobble", "Cargo.toml", ""] {
            assert_eq!(said(word), None, "{word}");
        }
    }
}
