//! `--shard K/N`: one of several parts of a measurement, so that several processes or machines can share it.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// The most parts of a measurement.
const MAX_PARTS: usize = 100_000;

/// Part `number` of `of`, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) struct Shard {
    number: usize,
    of: usize,
}

impl Shard {
    /// The pieces of work, out of `count`, that belong to this part: every `of`th, so that long ones are spread over the
    /// parts.
    pub(super) fn pieces(self, count: usize) -> impl Iterator<Item = usize> {
        (0..count).skip(self.number - 1).step_by(self.of)
    }

    /// The part of the same division that holds a piece of work.
    pub(super) fn of_piece(self, piece: usize) -> Self {
        Self { number: piece % self.of + 1, of: self.of }
    }

    /// The part as written in the name of a file.
    pub(super) fn in_name(self) -> String {
        format!("shard-{}-of-{}", self.number, self.of)
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wanted = || format!("write K/N, part K of N, with K from 1 to N and N up to {MAX_PARTS}");
        let (number, of) = text.split_once('/').ok_or_else(wanted)?;
        let [number, of] = [number, of].map(|digits| digits.parse::<usize>().unwrap_or(0));
        if number == 0 || number > of || of > MAX_PARTS { Err(wanted()) } else { Ok(Self { number, of }) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shard(text: &str) -> Shard {
        text.parse().expect("a shard")
    }

    #[test]
    fn the_parts_are_everything_and_nothing_twice() {
        for of in 1..=5 {
            let mut all: Vec<usize> =
                (1..=of).flat_map(|number| shard(&format!("{number}/{of}")).pieces(7).collect::<Vec<_>>()).collect();
            all.sort_unstable();
            assert_eq!(all, (0..7).collect::<Vec<_>>(), "{of} parts");
        }
        let third = shard("3/4");
        assert!(third.pieces(20).all(|piece| shard("1/4").of_piece(piece) == third), "a piece tells its part");
        assert_eq!(shard("9/9").pieces(7).count(), 0, "more parts than pieces");
    }

    #[test]
    fn what_is_no_part_is_refused() {
        for text in ["", "1", "0/3", "4/3", "1/0", "-1/3", "a/b", "1/2/3", "1/999999"] {
            assert!(text.parse::<Shard>().is_err_and(|why| why.contains("K/N")), "{text}");
        }
    }
}
