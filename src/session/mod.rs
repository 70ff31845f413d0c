//! The running sandbox with no window, no GPU and no thread of its own: commands go in, time goes in, a status and
//! a picture come out. Synchronous and deterministic, so that everything a person can do is a test.
