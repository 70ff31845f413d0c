//! Measurements that explain: how exact a scheme is for its time, how large steps may be, what a scene costs stage
//! by stage, and what it does not need. Takes scenes and returns figures and tables; knows no files, no arguments and
//! no window.

pub mod cost;
pub mod disturb;
pub mod error;
pub mod extremes;
pub mod judge;
pub mod matrix;
#[cfg(any(test, feature = "peers"))]
pub mod peers;
mod random_source;
pub mod single;
pub mod speed;
pub mod stability;
pub mod statics;
pub mod timer;
