//! Bodies that move by their modes: each mode is an oscillator of its own, whatever the number of cells (A. Pentland,
//! J. Williams, "Good vibrations: modal dynamics for graphics and animation", SIGGRAPH 1989; SC §5).
//!
//! ```text
//!   u = Σ qᵢ φᵢ       q'' + c q' + ω² q = φᵀ F        c = φᵀ C φ
//! ```
//!
//! The modes themselves come from outside (`modal` finds them); a body that has them is a modal body. Its particles sleep as
//! far as all other rooms know, and are put where the modes have them when someone looks: so a substep costs as much as there
//! are modes, and contact as much as comes near.
//!
//! ```text
//! oscillator   one mode over a step in which the force stays the same, exactly
//! flight       a free body as a whole over a substep: what weight and its spin do
//! motion       both together: where points are, how fast, and how what pushes at them moves the body
//! candidate    points that meet obstacles, alone or as the mean of neighbours
//! contact      which points meet which obstacles, and their springs
//! hold         the hand and all contacts together, taken implicitly
//! among        what contact with other bodies asks of modal ones
//! substep      all of it, one body after another
//! workspace    what they work in
//! particles    of a modal body: where modes have them, and what modes take up of their motion
//! ```
//!
//! What is constant of them (frequencies, shapes, the points that meet obstacles, inertia) is in `model`, how far each is from
//! rest and how fast it goes, and where a free body is, in `state`.
//!
//! # A substep
//!
//! The free solution `q*` is exact for gravity, so no step is too long and no frequency too high. What pushes at points is
//! taken implicitly, as in `step::pull` and `contact::response`: an impulse `J` at points that modes move by `P` changes the end
//! of the substep by
//!
//! ```text
//!   Δq' = w Pᵀ J,   Δq = dt Δq'       w = 1 / (1 + dt c + dt² ω²)
//! ```
//!
//! Contact is a penalty at surface points with critical damping, Coulomb friction, and no push that moves a point out of what
//! it is in faster than half the body's size in a second. A plane is met by a held body from the side on which a point rests.
//!
//! At rest on something the impulse takes back what weight did in the substep, so that the rate is not zero where nothing moves;
//! what is seen to move and told to rest is the mean rate over a substep, `(q_end − q) / dt`.
//!
//! # Free bodies
//!
//! A body that nothing holds swings about a place that moves and turns with it (D. Terzopoulos, A. Witkin, "Physically based models
//! with rigid and deformable components", IEEE CG&A 8(6), 1988; A. Shabana, *Dynamics of Multibody Systems*, ch. 5):
//!
//! ```text
//!   x = c + R (r + u − r_c)       u = Σ qᵢ φᵢ,   r at rest,   r_c the centre of mass at rest
//! ```
//!
//! Modes have no part of the motion as a whole, so weight acts on that alone, and exactly. To an impulse moving and turning
//! are six more modes without frequency, `P = e_k / √m` and `P = a_k × (r + u − r_c) / √I_k` of the principal axes `a_k`, in the
//! frame in which the substep begins: momentum and angular momentum change by just the impulse and its moment.
//!
//! Left out, as all of it is of second order in the swing or grows with the square of the spin: the Coriolis, centrifugal
//! and Euler forces on modes (what spins is not stretched by it), what the swing itself has of angular momentum, and what it
//! changes of the moments of inertia.
//!
//! Contact differs in four things. A free body remembers on which side of planes and open meshes its points touch them. Where
//! more of its points touch something than can be solved for, each group of neighbours is one contact, as stiff as all of
//! them. Springs are damped as the highest mode is, as they stand for the give about a point that still higher ones would
//! have: critical damping, which takes little from the particle of a cell, would take its bounce from the whole body. Friction
//! and damping are against how fast a point is on the whole in the substep: at its end weight would have it creep.
//!
//! # Other bodies
//!
//! Contact between bodies is that of their cells (`contact::bodies`): particles of the outside of a modal body in the cells of
//! another, and the other way round. What it weighs of a modal body moves by all of its motions, and an impulse changes
//! all of them at once: a row, as of a point at an obstacle. The rounds in which contacts between bodies are
//! solved go through obstacles and hand of modal bodies too: what lies on a modal body that lies on a slope stays there. What
//! is at rest is as good as held.
//!
//! Modal bodies move after the particles of a substep or a part of it have, against obstacles where these are then. It
//! follows from the state alone and is worked out by one thread: the same bits everywhere.

mod among;
mod candidate;
mod contact;
mod flight;
mod hold;
mod motion;
mod oscillator;
mod particles;
mod substep;
mod workspace;

pub(in crate::physics) use among::Among;
pub(in crate::physics) use particles::place;
pub(in crate::physics) use substep::{Inputs, advance};
pub(in crate::physics) use workspace::ModalWorkspace;
