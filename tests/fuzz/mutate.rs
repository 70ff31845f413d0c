//! Good inputs made bad: a few random changes of bytes, words and numbers.

use gelatin::math::rng::Rng;

/// Numbers at which programs break.
const NUMBERS: [&str; 24] = [
    "0",
    "-0",
    "1",
    "-1",
    "2",
    "127",
    "128",
    "199",
    "255",
    "256",
    "65536",
    "2147483648",
    "4294967295",
    "4294967296",
    "18446744073709551616",
    "1e-320",
    "1e-38",
    "1e38",
    "1e39",
    "1e308",
    "1e999",
    "-1e308",
    "nan",
    "inf",
];

/// Draws a number below `end`, which is not zero.
pub(crate) fn below(rng: &mut Rng, end: usize) -> usize {
    usize::try_from(rng.next_u64() % end as u64).expect("it fits")
}

/// Picks one of some things.
pub(crate) fn pick<'a, T>(rng: &mut Rng, of: &'a [T]) -> &'a T {
    &of[below(rng, of.len())]
}

/// One of some good texts with a few changes; `words` are the words of its language.
pub(crate) fn text(rng: &mut Rng, good: &[&str], words: &[&str]) -> Vec<u8> {
    let mut text = good[below(rng, good.len())].as_bytes().to_vec();
    // Half of the texts keep their form, as hardly any of the others are read to their end.
    let kinds = if below(rng, 2) == 0 { 8..11 } else { 0..11 };
    for _ in 0..=below(rng, 6) {
        match kinds.start + below(rng, kinds.len()) {
            0 => bytes(rng, &mut text),
            1 => {
                let piece = piece(rng, &text);
                text.drain(piece);
            }
            2 => {
                let copied = text[piece(rng, &text)].to_vec();
                insert(rng, &mut text, &copied);
            }
            3 => {
                let other = good[below(rng, good.len())].as_bytes();
                let taken = &other[piece(rng, other)];
                insert(rng, &mut text, taken);
            }
            4 => text.truncate(below(rng, text.len() + 1)),
            5 => {
                // This makes the text deep or long.
                let repeated = pick(rng, words).repeat(1 << below(rng, 14));
                insert(rng, &mut text, repeated.as_bytes());
            }
            6 | 7 => {
                let word = *pick(rng, words);
                insert(rng, &mut text, word.as_bytes());
            }
            _ => number(rng, &mut text),
        }
    }
    text
}

/// Changes, adds or removes single bytes.
pub(crate) fn bytes(rng: &mut Rng, text: &mut Vec<u8>) {
    for _ in 0..=below(rng, 4) {
        let byte = u8::try_from(below(rng, 256)).expect("a byte");
        if text.is_empty() {
            text.push(byte);
            continue;
        }
        let at = below(rng, text.len());
        match below(rng, 4) {
            0 => text[at] = byte,
            1 => text[at] ^= 1 << below(rng, 8),
            2 => text.insert(at, byte),
            _ => drop(text.remove(at)),
        }
    }
}

/// Replaces a number by another one.
pub(crate) fn number(rng: &mut Rng, text: &mut Vec<u8>) {
    let is_part = |byte: u8| byte.is_ascii_digit() || matches!(byte, b'.' | b'-' | b'e');
    let starts: Vec<usize> =
        (0..text.len()).filter(|&at| text[at].is_ascii_digit() && (at == 0 || !is_part(text[at - 1]))).collect();
    if starts.is_empty() {
        return;
    }
    let start = *pick(rng, &starts);
    let length = text[start..].iter().take_while(|byte| is_part(**byte)).count();
    text.splice(start..start + length, extreme(rng).bytes());
}

fn insert(rng: &mut Rng, text: &mut Vec<u8>, piece: &[u8]) {
    let at = below(rng, text.len() + 1);
    text.splice(at..at, piece.iter().copied());
}

/// The range of a short piece.
pub(crate) fn piece(rng: &mut Rng, of: &[u8]) -> std::ops::Range<usize> {
    let start = below(rng, of.len() + 1);
    start..start + below(rng, (of.len() - start).min(40) + 1)
}

/// A number at which programs break, as text.
pub(crate) fn extreme(rng: &mut Rng) -> &'static str {
    NUMBERS[below(rng, NUMBERS.len())]
}
