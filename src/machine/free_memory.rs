//! What is left of the memory.

/// Memory that this process may still take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FreeMemory {
    /// How much, bytes.
    pub bytes: u64,
    /// What limits it, for a sentence.
    pub whose: &'static str,
}
