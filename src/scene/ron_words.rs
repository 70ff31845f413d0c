//! Says what is wrong with a scene's text in the words of a scene: RON's own messages name Rust types, which do not concern
//! the author of a scene.

use ron::Error;

use crate::text::echo;

/// What is wrong and what would be right, as half a sentence.
pub(super) fn words(error: &Error) -> String {
    match error {
        Error::Eof => "the text ends too early; a bracket is not closed".to_owned(),
        Error::TrailingCharacters => "there is more text behind the scene's last bracket".to_owned(),
        Error::ExpectedIdentifier | Error::SuggestRawIdentifier(_) | Error::InvalidIdentifier(_) => {
            let found = match error {
                Error::SuggestRawIdentifier(found) | Error::InvalidIdentifier(found) => {
                    format!(", not {}", echo(found))
                }
                _ => String::new(),
            };
            format!("a name without quotes is expected here{found}: a field such as `dt:`, or a form such as `cube(…)`")
        }
        Error::ExpectedStructLike | Error::ExpectedNamedStructLike(_) | Error::ExpectedStructName(_) => {
            "an opening ( is expected here".to_owned()
        }
        Error::ExpectedDifferentStructName { found, .. } => {
            format!("an opening ( is expected here, before {}", echo(found))
        }
        Error::ExpectedStructLikeEnd | Error::ExpectedOptionEnd => "a closing ) is expected here".to_owned(),
        Error::ExpectedArray => "an opening [ of a list is expected here".to_owned(),
        Error::ExpectedArrayEnd => "a closing ] of a list is expected here".to_owned(),
        Error::ExpectedMap | Error::ExpectedMapEnd => "fields in ( ) are expected here, not in { }".to_owned(),
        Error::ExpectedMapColon => "a : is expected between a field and its value".to_owned(),
        Error::ExpectedComma => "a comma is expected here".to_owned(),
        Error::ExpectedBoolean => "true or false is expected here".to_owned(),
        Error::ExpectedFloat | Error::ExpectedInteger | Error::FloatUnderscore | Error::UnderscoreAtBeginning => {
            "a number is expected here".to_owned()
        }
        Error::IntegerOutOfBounds => "the whole number is outside what fits here".to_owned(),
        Error::InvalidIntegerDigit { digit, .. } => format!("{} is no digit of a number", digit.escape_default()),
        Error::ExpectedString | Error::ExpectedByteString | Error::ExpectedChar => {
            "a text in quotes is expected here".to_owned()
        }
        Error::ExpectedStringEnd => "a text's closing quote is missing".to_owned(),
        Error::InvalidEscape(_) => "a text holds a \\ that means nothing; write \\\\ for a \\".to_owned(),
        Error::UnexpectedChar(found) => format!("{} means nothing here", found.escape_default()),
        Error::UnclosedBlockComment => "a comment is not closed by */".to_owned(),
        Error::ExceededRecursionLimit => "there are too many brackets within each other".to_owned(),
        Error::InvalidValueForType { expected, found } => {
            format!("{} is expected here, not {}", echo(expected), echo(found))
        }
        Error::ExpectedDifferentLength { expected, found } => match expected.strip_prefix("an array of length ") {
            Some(count) => format!("{} values in ( ) are expected here, not {found}", echo(count)),
            None => format!("{} is expected here, not {found} of them", echo(expected)),
        },
        Error::NoSuchStructField { expected, found, .. } => {
            format!("there is no field `{}` here; there {}", echo(found), choices(expected))
        }
        Error::NoSuchEnumVariant { expected, found, .. } => {
            format!("`{}` is no choice here; there {}", echo(found), choices(expected))
        }
        Error::MissingStructField { field, .. } => format!("the field `{field}` is missing"),
        Error::DuplicateStructField { field, .. } => format!("the field `{field}` is given twice"),
        Error::Message(text) => echo(text),
        other => echo(&other.to_string()),
    }
}

fn choices(names: &[&str]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    match quoted.split_last() {
        None => "are none".to_owned(),
        Some((only, [])) => format!("is {only}"),
        Some((last, rest)) => format!("are {} and {last}", rest.join(", ")),
    }
}
