//! The parts of a model, by the names in its file, as lines for a person.

use super::out;
use crate::geometry::part_cells::PartCount;
use crate::text::counted;

/// This many parts have a line each; the rest is only counted.
const MAX_LINES: usize = 24;

/// Prints the parts of a model and how many cells each has; prints nothing if there are none.
pub(super) fn print(of: &str, parts: &[PartCount]) -> anyhow::Result<()> {
    if parts.is_empty() {
        return Ok(());
    }
    out::figures(&format!("parts of {of}"))?;
    for PartCount { name, cells } in parts.iter().take(MAX_LINES) {
        out::figures(&format!("  {name:<22} {}", counted(*cells, "cell", "cells")))?;
    }
    if parts.len() > MAX_LINES {
        out::figures(&format!("  and {} more", parts.len() - MAX_LINES))?;
    }
    Ok(())
}
