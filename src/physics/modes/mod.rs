//! Bodies that move by their modes: each mode is an oscillator of its own, whatever the number of cells (A. Pentland,
//! J. Williams, "Good vibrations: modal dynamics for graphics and animation", SIGGRAPH 1989; SC §5).
//!
//! ```text
//!   u = Σ qᵢ φᵢ       q'' + c q' + ω² q = φᵀ F        c = φᵀ C φ
//! ```
//!
//! The modes come from outside (`modal` finds them); a body that has them is a modal body. For all other modules its
//! particles sleep; they are placed by the modes only when they are looked at. So the cost of a substep is that of the
//! modes, and the cost of contact that of the points near obstacles.
//!
//! ```text
//! oscillator   one mode over a step with a constant force: the exact solution
//! flight       the rigid motion of a free body over a substep, by weight and spin
//! motion       modes and rigid motion together: places and velocities of points, and how impulses there move the body
//! candidate    contact candidates: points that meet obstacles, alone or as the mean of neighbours
//! contact      finds the contacts of points with obstacles, and solves each
//! solver       solves the hand and all contacts together, implicitly
//! body_contact the side of modal bodies in contact between bodies
//! substep      takes a substep of all modal bodies, one after another
//! workspace    the buffers
//! particles    places particles by the modes, and projects their motion onto modes
//! ```
//!
//! Constants (frequencies, shapes, the points that meet obstacles, inertia) are in `model`; amplitudes, rates and the rigid
//! motion of free bodies are in `state`.
//!
//! # A substep
//!
//! The solution `q*` without impulses is exact for gravity, so no step is too long and no frequency too high. The hand and
//! contacts are taken implicitly, as in `step::pull` and `contact::response`: an impulse `J` at points that modes move by
//! `P` changes the end of the substep by
//!
//! ```text
//!   Δq' = w Pᵀ J,   Δq = dt Δq'       w = 1 / (1 + dt c + dt² ω²)
//! ```
//!
//! Contact is a penalty at surface points with critical damping and Coulomb friction. A point that is deep in an obstacle is
//! moved out no faster than half the body's size in a second. A held body meets a plane from the side on which the point is
//! at rest.
//!
//! Where a body rests on something, the impulse takes back what weight did in the substep, so that the rate is not zero
//! although nothing moves. The motion shown, and that by which rest is decided, is the mean rate over a substep,
//! `(q_end − q) / dt`.
//!
//! # Free bodies
//!
//! A body that nothing holds vibrates about a frame that moves and turns with it (D. Terzopoulos, A. Witkin, "Physically
//! based models with rigid and deformable components", IEEE CG&A 8(6), 1988; A. Shabana, *Dynamics of Multibody Systems*,
//! ch. 5):
//!
//! ```text
//!   x = c + R (r + u − r_c)       u = Σ qᵢ φᵢ,   r at rest,   r_c the centre of mass at rest
//! ```
//!
//! Modes contain no rigid motion, so weight acts on the rigid motion alone, and exactly. For an impulse, moving and turning
//! are six more modes without frequency, `P = e_k / √m` and `P = a_k × (r + u − r_c) / √I_k` with the principal axes `a_k`,
//! in the frame in which the substep begins: momentum and angular momentum change by just the impulse and its moment.
//!
//! Left out, as they are of second order in the vibration or grow with the square of the spin: the Coriolis, centrifugal and
//! Euler forces on modes (spin does not stretch a body), the angular momentum of the vibration itself, and its effect on the
//! moments of inertia.
//!
//! Contact of free bodies differs in four things. A free body remembers on which side of planes and open meshes its points
//! touch them. Where more of its points touch something than can be solved for, each group of neighbours is one contact, as
//! stiff as all of them. Contact springs have the damping ratio of the highest mode, as they stand for the local give that
//! still higher modes would have: critical damping, which takes little from the particle of a cell, would take its bounce
//! from the whole body. Friction and damping act against the mean velocity of a point in the substep: against that at the
//! end, weight would make the body creep.
//!
//! # Other bodies
//!
//! Contact between bodies is that of their cells (`contact::bodies`): outer particles of a modal body in the cells of
//! another, and the other way round. A weighted point of a modal body moves by all modes and rigid motions, and an impulse
//! changes all of them at once: it has a row, as a point at an obstacle has. The rounds that solve contacts between bodies
//! also go through obstacles and hand of modal bodies: a body that lies on a modal body on a slope stays there. A modal body
//! at rest counts as held.
//!
//! Modal bodies move after the particles in each part of a substep, against obstacles where these are in that part. Their
//! motion follows from the state alone and is computed by one thread: the same bits everywhere.

mod body_contact;
mod candidate;
mod contact;
mod flight;
mod motion;
mod oscillator;
mod particles;
mod solver;
mod substep;
mod workspace;

pub(in crate::physics) use body_contact::ModalBodiesInContact;
pub(in crate::physics) use particles::place_particles;
pub(in crate::physics) use substep::{Inputs, advance};
pub(in crate::physics) use workspace::ModalWorkspace;
