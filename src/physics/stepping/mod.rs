//! How time is divided.

pub(in crate::physics) mod strain;
