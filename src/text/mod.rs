//! Makes texts of strangers fit for a message: text from files, arguments and other programs reaches a terminal short and
//! without control characters, which could move its cursor, change its title or hide what was said. Also finds how far a
//! word is from the one that may have been meant, and puts numbers of things into words.

use std::fmt::Display;
use std::path::Path;

/// The most characters of somebody else's text in a message.
const LONGEST: usize = 200;

/// A text from a file or an argument as a message may repeat it: printable, and cut where it is long.
pub fn echo(text: &str) -> String {
    echo_up_to(text, LONGEST)
}

/// Does the same, but cuts after `longest` characters.
pub fn echo_up_to(text: &str, longest: usize) -> String {
    let mut letters = text.chars();
    let mut shown: String = letters.by_ref().take(longest).map(printable).collect();
    if letters.next().is_some() {
        shown.push('…');
    }
    shown
}

/// A path as a message may repeat it; where it is long its beginning is left out.
pub fn echo_path(path: &Path) -> String {
    let shown = path.to_string_lossy();
    let count = shown.chars().count();
    let end: String = shown.chars().skip(count.saturating_sub(LONGEST)).map(printable).collect();
    if count > LONGEST { format!("…{end}") } else { end }
}

/// A whole message on its way to a terminal: lines stay lines, everything else that steers a terminal is replaced.
pub fn printable_lines(text: &str) -> String {
    text.chars().map(|letter| if letter == '\n' { letter } else { printable(letter) }).collect()
}

fn printable(letter: char) -> char {
    // Besides control characters, those that change the direction of writing or are invisible.
    let steers =
        matches!(letter, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}');
    if letter.is_control() || steers { char::REPLACEMENT_CHARACTER } else { letter }
}

/// How many of something there are: "1 part", "3 parts".
pub fn counted<N: Copy + Display + PartialEq + From<u8>>(count: N, one: &str, many: &str) -> String {
    let word = if count == N::from(1) { one } else { many };
    format!("{count} {word}")
}

/// The first `shown` of some names, and how many more there are: "a, b and 3 more".
pub fn listed(names: impl ExactSizeIterator<Item = String>, shown: usize) -> String {
    let more = names.len().saturating_sub(shown);
    let first = names.take(shown).collect::<Vec<_>>().join(", ");
    if more > 0 { format!("{first} and {more} more") } else { first }
}

/// Returns the number of letters to insert, remove or exchange between two words (Levenshtein).
pub fn distance(from: &str, to: &str) -> usize {
    let to: Vec<char> = to.chars().collect();
    let mut row: Vec<usize> = (0..=to.len()).collect();
    for (i, a) in from.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, &b) in to.iter().enumerate() {
            let exchanged = diagonal + usize::from(a != b);
            diagonal = row[j + 1];
            row[j + 1] = exchanged.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[to.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_list_is_cut_and_the_rest_counted() {
        let list = |count: usize| listed((0..count).map(|number| number.to_string()), 3);
        assert_eq!([0, 1, 3, 4, 9].map(list), ["", "0", "0, 1, 2", "0, 1, 2 and 1 more", "0, 1, 2 and 6 more"]);
    }

    #[test]
    fn a_strangers_text_is_short_and_steers_nothing() {
        assert_eq!(echo("käse.obj"), "käse.obj", "ordinary text stays");
        assert_eq!(echo("a\u{1b}[2J\rb\n\u{202e}c\u{9b}"), "a\u{fffd}[2J\u{fffd}b\u{fffd}\u{fffd}c\u{fffd}");
        assert_eq!(echo(&"é".repeat(200)), "é".repeat(200), "as long as may be");
        assert_eq!(echo(&"é".repeat(201)), "é".repeat(200) + "…", "cut between letters");
        let deep = format!("{}/cow.obj", "a".repeat(300));
        let shown = echo_path(Path::new(&deep));
        assert!(shown.starts_with("…aaa") && shown.ends_with("/cow.obj") && shown.chars().count() == 201, "{shown}");
        assert_eq!(printable_lines("two\nlines\t\u{7}"), "two\nlines\u{fffd}\u{fffd}", "lines stay");
    }

    #[test]
    fn one_of_something_is_no_plural() {
        assert_eq!([0_usize, 1, 2].map(|count| counted(count, "body", "bodies")), ["0 bodies", "1 body", "2 bodies"]);
    }
}
