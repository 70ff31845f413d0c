//! The lowest modes of vibration of a body's lattice about rest. With them the physics can move the body at a cost that does
//! not depend on the number of its cells (A. Pentland, J. Williams, "Good vibrations: modal dynamics for graphics and
//! animation", SIGGRAPH 1989; SC §5).
//!
//! # Theory
//!
//! Displacements `u` of the particles about rest, so small that no link turns, obey `M u'' + C u' + K u = f`. A link of
//! rest length `l`, constant `k` (N) and direction `n` at rest adds `k/l n nᵀ` to `K`; masses are those of the particles.
//! The modes are the solutions of
//!
//! ```text
//!   K φ = ω² M φ,   φᵢᵀ M φⱼ = 1 where i = j, else 0,      u = Σ qᵢ φᵢ,      f = ω / 2π
//! ```
//!
//! Held particles are left out of the equations. Rigid motions of pieces that nothing holds have no frequency; they are
//! known beforehand and are kept apart from the modes.
//!
//! # How they are found
//!
//! ```text
//!   stiffness   the equations of a compiled body, in its own coordinates
//!   ordering    the order in which particles are eliminated: nested dissection of the grid
//!   rigid       the motions without frequency
//!   factor      sparse Cholesky of M^-½ K M^-½ + σ (faer), after its size was predicted
//!   lanczos     block Lanczos on the inverse, which sees the lowest frequencies first (shift and invert)
//!   reduced     the modes as the physics takes them, to move a body with ([`crate::physics::ModalModel`])
//! ```
//!
//! The equations are linear: **a large turn of a part looks wrong**, as the part grows instead of turning.
//!
//! ```
//! use gelatin::{modal::{self, Wanted}, physics::Simulation, scene::presets};
//!
//! let scene = (presets::preset("cube-on-plane").unwrap().build)();
//! let jelly = Simulation::<f32>::from_scene(&scene, "".as_ref()).unwrap();
//! let found = modal::modes(&jelly.model().bodies[0], Wanted { count: 3, ..Wanted::default() }, &()).unwrap();
//! assert_eq!(found.rigid, 6, "a free body moves and turns without any frequency");
//! assert!(found.modes[0].frequency_hz > 0.1 && found.residual < 1e-6);
//! ```

mod error;
mod factor;
mod lanczos;
mod mode;
mod ordering;
mod reduced;
mod rigid;
mod stiffness;

pub use error::ModalError;
pub use lanczos::modes;
pub use mode::{COUNTS, Mode, Modes, Wanted};
pub use reduced::masses;

#[cfg(test)]
mod tests;
