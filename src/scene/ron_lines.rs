//! Finds the line of a RON text that holds the value of a path, so that a value outside its range can be pointed at. Also
//! finds the path of a place in the text, so that unreadable text has a path, too. Reads brackets, names and commas only; a
//! place that it cannot follow has no line.

use std::collections::HashMap;

/// The lines, from 1, of the values at some paths ("bodies.0.pose.position.1"), or of the first values below them, in
/// the order of the paths. The text is read once, however many paths there are.
pub(super) fn lines_of<'a>(text: &str, paths: impl Iterator<Item = &'a str> + Clone) -> Vec<Option<usize>> {
    let mut lines: HashMap<&str, Option<usize>> = paths.clone().map(|path| (path, None)).collect();
    let mut position = TreePosition::default();
    let mut tokens = Tokens::of(text).peekable();
    while let Some((token, begin)) = tokens.next() {
        let is_value = position.follow(token, tokens.peek().map(|(next, _)| *next));
        if is_value {
            let path = position.path();
            let mut above = Some(path.as_str());
            while let Some(path) = above {
                if let Some(first) = lines.get_mut(path) {
                    first.get_or_insert(begin.line);
                }
                above = path.rsplit_once('.').map(|(above, _)| above);
            }
        }
    }
    paths.map(|path| lines.get(path).copied().flatten()).collect()
}

/// The value at a line and column, both from 1, or right before it, and its path.
pub(super) fn value_at(text: &str, line: usize, column: usize) -> Option<(String, &str)> {
    let at = byte_at(text, line, column);
    // The place may be before the blanks that precede the value.
    let at = text.len() - text[at..].trim_start().len();
    let mut position = TreePosition::default();
    let mut tokens = Tokens::of(text).peekable();
    while let Some((token, begin)) = tokens.next_if(|(_, begin)| begin.byte <= at) {
        let is_value = position.follow(token, tokens.peek().map(|(next, _)| *next));
        if let (true, Token::Word(word)) = (is_value, token)
            && at <= begin.byte + word.len()
        {
            return Some((position.path(), word));
        }
    }
    None
}

/// The place of a line and column, both from 1, in a text.
fn byte_at(text: &str, line: usize, column: usize) -> usize {
    let lines_before: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
    let in_line = text[lines_before..].char_indices().nth(column.saturating_sub(1));
    in_line.map_or(text.len(), |(at, _)| lines_before + at)
}

/// The path of the last name or value that begins before a line and column, both from 1.
pub(super) fn path_before(text: &str, line: usize, column: usize) -> String {
    let end = byte_at(text, line, column);
    let mut position = TreePosition::default();
    let mut tokens = Tokens::of(text).peekable();
    while let Some((token, _)) = tokens.next_if(|(_, begin)| begin.byte < end) {
        position.follow(token, tokens.peek().map(|(next, _)| *next));
    }
    position.path()
}

/// Where in the tree the reader is.
#[derive(Default)]
struct TreePosition<'a> {
    frames: Vec<Frame<'a>>,
    /// The word before a bracket: the form of an enum.
    variant: Option<&'a str>,
}

/// One open bracket.
struct Frame<'a> {
    variant: Option<&'a str>,
    name: Option<&'a str>,
    index: usize,
}

impl<'a> TreePosition<'a> {
    /// Takes a token, with the one after it. Returns whether it is a value.
    fn follow(&mut self, token: Token<'a>, next: Option<Token<'a>>) -> bool {
        match token {
            Token::Word(word) if next == Some(Token::Mark(':')) => self.name(word),
            Token::Word(word) if next == Some(Token::Mark('(')) => self.variant = Some(word),
            Token::Word(_) => return true,
            Token::Mark('(' | '[' | '{') => self.enter(),
            Token::Mark(')' | ']' | '}') => {
                self.frames.pop();
            }
            Token::Mark(',') => self.next(),
            Token::Mark(_) => {}
        }
        false
    }

    fn enter(&mut self) {
        // `Some(` is not one of the scene's forms, and the word before the outermost bracket names the whole scene.
        let variant = self.variant.take().filter(|word| *word != "Some" && !self.frames.is_empty());
        self.frames.push(Frame { variant, name: None, index: 0 });
    }

    fn name(&mut self, word: &'a str) {
        if let Some(frame) = self.frames.last_mut() {
            frame.name = Some(word);
        }
    }

    fn next(&mut self) {
        if let Some(frame) = self.frames.last_mut() {
            frame.index += 1;
            frame.name = None;
        }
    }

    fn path(&self) -> String {
        let mut parts = Vec::new();
        for frame in &self.frames {
            parts.extend(frame.variant.map(str::to_owned));
            parts.push(frame.name.map_or_else(|| frame.index.to_string(), str::to_owned));
        }
        parts.join(".")
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Token<'a> {
    /// A name, number or quoted text.
    Word(&'a str),
    /// A bracket, comma or colon.
    Mark(char),
}

/// Where a token begins.
#[derive(Clone, Copy)]
struct TokenStart {
    /// From 1.
    line: usize,
    /// From 0.
    byte: usize,
}

/// Tokens with where they begin; white space and comments are passed over.
struct Tokens<'a> {
    rest: &'a str,
    begin: TokenStart,
}

impl<'a> Tokens<'a> {
    fn of(text: &'a str) -> Self {
        Self { rest: text, begin: TokenStart { line: 1, byte: 0 } }
    }

    fn take(&mut self, bytes: usize) -> &'a str {
        let (taken, rest) = self.rest.split_at(bytes);
        self.begin.line += taken.matches('\n').count();
        self.begin.byte += bytes;
        self.rest = rest;
        taken
    }

    fn skip_blank(&mut self) {
        loop {
            let blank = self.rest.len() - self.rest.trim_start().len();
            let skipped = match &self.rest[blank..] {
                rest if rest.starts_with("//") => blank + rest.find('\n').unwrap_or(rest.len()),
                rest if rest.starts_with("/*") => blank + rest.find("*/").map_or(rest.len(), |end| end + 2),
                rest if rest.starts_with("#![") => blank + rest.find(']').map_or(rest.len(), |end| end + 1),
                _ => blank,
            };
            if skipped == 0 {
                return;
            }
            self.take(skipped);
        }
    }
}

impl<'a> Iterator for Tokens<'a> {
    type Item = (Token<'a>, TokenStart);

    fn next(&mut self) -> Option<Self::Item> {
        self.skip_blank();
        let begin = self.begin;
        let first = self.rest.chars().next()?;
        let token = match first {
            '(' | ')' | '[' | ']' | '{' | '}' | ',' | ':' => {
                self.take(1);
                Token::Mark(first)
            }
            '"' => {
                let mut escaped = false;
                let end = self.rest.char_indices().skip(1).find(|&(_, c)| {
                    let closes = c == '"' && !escaped;
                    escaped = c == '\\' && !escaped;
                    closes
                });
                Token::Word(self.take(end.map_or(self.rest.len(), |(at, _)| at + 1)))
            }
            _ => {
                let ends = |c: char| c.is_whitespace() || "()[]{},:\"".contains(c);
                Token::Word(self.take(self.rest.find(ends).unwrap_or(self.rest.len())))
            }
        };
        Some((token, begin))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r#"// A scene, with a comma in its comment.
#![enable(implicit_some)]
(
    version: 1,
    settings: (dt: 9.0, gravity: (0,
        -9.81, 0)),
    bodies: [
        (name: "a, (b", shape: cube(cells: 3)),
        (
            shape: cube(
                cells: 500, /* too
                many */ size: 1.0),
        ),
    ],
)"#;

    fn line_of(text: &str, path: &str) -> Option<usize> {
        lines_of(text, [path].into_iter())[0]
    }

    #[test]
    fn values_are_found_on_their_lines() {
        let cases = [
            ("version", 4),
            ("settings.dt", 5),
            ("settings.gravity", 5),
            ("settings.gravity.1", 6),
            ("bodies.0.name", 8),
            ("bodies.0.shape.cube.cells", 8),
            ("bodies.1.shape.cube.cells", 11),
            ("bodies.1.shape.cube.size", 12),
        ];
        for (path, line) in cases {
            assert_eq!(line_of(TEXT, path), Some(line), "{path}");
        }
        let all = lines_of(TEXT, cases.iter().map(|(path, _)| *path));
        assert_eq!(all, cases.map(|(_, line)| Some(line)), "all at once");
    }

    #[test]
    fn what_is_not_there_has_no_line() {
        for path in ["bodies.2.name", "settings", "settings.d", "view.color", ""] {
            let found = line_of(TEXT, path);
            assert!(path == "settings" || found.is_none(), "{path}: {found:?}");
        }
        assert_eq!(line_of("(((", "a"), None, "broken text is no trouble");
    }
}
