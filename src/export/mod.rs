//! Finished pictures and shapes as files.

#[cfg(feature = "render")]
pub mod legend;
#[cfg(feature = "render")]
pub mod png;
