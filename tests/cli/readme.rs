//! The commands named in the README are known to the program.

use std::ffi::OsString;

use gelatin::cli::check_known;

/// A command line of the README, and whether it is only mentioned.
#[derive(Debug, PartialEq)]
struct Named {
    words: Vec<String>,
    is_mention: bool,
}

/// The commands in a text: lines of code blocks, and text between backticks.
fn named(text: &str) -> Vec<Named> {
    let mut found = Vec::new();
    let joined = text.replace("\\\n", " ");
    for (index, block) in joined.split("```").enumerate() {
        if index % 2 == 1 {
            found.extend(block.lines().filter_map(command).map(|words| Named { words, is_mention: false }));
        } else {
            // A span between backticks may continue on the next line.
            let prose = block.replace('\n', " ");
            let spans: Vec<&str> = prose.split('`').skip(1).step_by(2).collect();
            found.extend(spans.into_iter().filter_map(command).map(|words| Named { words, is_mention: true }));
        }
    }
    found
}

/// The words of the call of gelatin in a line, up to a comment or another program's part, with placeholders filled in.
fn command(line: &str) -> Option<Vec<String>> {
    let line = line.split(" #").next().unwrap_or_default().trim();
    let at = if line.starts_with("parallel ") { line.find("gelatin ")? } else { 0 };
    let words: Vec<&str> = line[at..].split_whitespace().take_while(|word| *word != ":::").collect();
    let is_call = words.first() == Some(&"gelatin") && words.get(1) != Some(&"=");
    let filled = |word: &&str| {
        let word = word.trim_matches('"').replace("{}", "1").replace("$SLURM_ARRAY_TASK_ID", "1");
        if ["S", "N", "K/N"].contains(&word.as_str()) { "1".to_owned() } else { word }
    };
    is_call.then(|| words.iter().map(filled).collect())
}

fn unknown(text: &str) -> Vec<String> {
    let check = |named: &Named| {
        let words = named.words.iter().map(OsString::from);
        check_known(words, named.is_mention).err().map(|why| format!("{}: {why}", named.words.join(" ")))
    };
    named(text).iter().filter_map(check).collect()
}

#[test]
fn every_command_of_the_readme_is_known() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/README.md");
    let text = std::fs::read_to_string(path).expect("the README");
    let found = named(&text);
    for begin in ["gelatin report error", "gelatin report merge", "gelatin sweep tree", "gelatin run tree", "gelatin"] {
        assert!(found.iter().any(|named| named.words.join(" ").starts_with(begin)), "{begin} is found: {found:?}");
    }
    assert!(found.len() > 20, "all of them: {found:?}");
    assert_eq!(unknown(&text), Vec::<String>::new(), "the README names what there is not");
}

#[test]
fn what_there_is_not_is_found() {
    let block = |line: &str| format!("Text.\n```sh\n{line}\n```\n");
    for line in [
        "gelatin report eror",
        "gelatin export tree",
        "gelatin sweep tree",
        "gelatin run tree --wobble 3 # words",
        "parallel --jobs 2 gelatin report error --shard {} ::: 1 2",
        "gelatin report merge parts \\\n    --into made",
    ] {
        assert_eq!(unknown(&block(line)).len(), 1, "{line}: {:?}", named(&block(line)));
    }
    assert_eq!(unknown("a mention of `gelatin run`, and of `gelatin\nrender tree --wobble`").len(), 1, "across lines");
    assert_eq!(unknown("`gelatin = { path = 1 }` is no command").len(), 0, "a dependency");
    assert_eq!(unknown(&block("gelatin run tree # --wobble")).len(), 0, "a comment");
}
