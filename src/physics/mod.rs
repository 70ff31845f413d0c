//! The core: a mass-spring lattice that moves, meets obstacles and comes to rest (GC §2–§7).
//!
//! A scene and the lattices of its bodies are compiled into a constant [`Model`] and the [`Plan`] of a step; a
//! [`Simulation`] owns both with the mutable [`State`]. The core does no input or output, reads no clock, never fails and
//! does not allocate once it runs, but the first time that a body comes near another or itself. It is generic over the scalar: `f32` to run, `f64` as reference.
//!
//! # Rooms
//!
//! ```text
//! simulation   the owner: of a scene, steps, edits while it runs, the motion of a body taken out and put in
//! compile      scene → model and plan: materials to constants, obstacles, how far a value may safely go; the only room
//!              that names the document, as `tests/tidy.rs` sees to
//! model        bodies, links, obstacles, and the plan: constant from one compilation to the next
//! state        what changes: positions, velocities, what is remembered; sleep, fallen bodies, the fingerprint
//! stepping     how a step is divided in time, and has its parts taken
//! step         a part: its stages, one function each, in the order of GC Algorithm 1
//! forces       gravity, links, recovery from inversion
//! share, team  who works out what: bodies cut into shares of as much work, shared out among the threads of a pool
//! kernels      many at a time: the forces of links again, which those of `forces` are the oracle of; boxes around vectors
//! schemes      how velocities follow from forces: explicit ones, and the implicit one with its energy balance
//! modes        modal bodies, at a cost that no cell adds to
//! contact      obstacles: where they are, who meets them, what they do to velocities; bodies that meet each other
//! limits       how large a step may be: waves, cells, states
//! interaction  a hand that pulls
//! observe      energies, a number for every particle, whether a step ran away
//! report       what a step tells
//! memory       how much a scene takes, counted before it is made
//! ```
//!
//! # One step
//!
//! ```text
//! simulation.step()   substep by substep; steps that a longer substep covers are counted
//!   stepping          part by part, where obstacles are in it (Placed): (model, plan, part, inputs, &mut state)
//!     find_forces     F = gravity + links (by kernels) + cells near inversion, at the state; the thesis's contact
//!     predict         v* = v + dt F/m, and a hand's pull
//!     meet_bodies     v* of bodies that meet each other or themselves, then meet_obstacles: v*; the implicit scheme has
//!                     solved_velocities instead, all at once
//!     refine          v' and the paths by which x moves, with more forces where the scheme has stages; then meet_on_paths
//!     is_sound        else the state stays the last good one and the report says so
//!     accept          x += dt u, v = v'; sides and recovery are settled before, who sleeps or has fallen out after
//!     pass            obstacles that come, or are swept, are as much nearer
//!   modes             modal bodies over the whole substep
//!   StepReport        sums over substeps, and what held at the end of the last
//! ```
//!
//! # How a change while it runs looks
//!
//! ```
//! use gelatin::physics::{Arrival, Simulation};
//! use gelatin::scene::{path, presets};
//!
//! let mut scene = (presets::preset("cube-on-plane").unwrap().build)();
//! let mut jelly = Simulation::<f32>::from_scene(&scene, "".as_ref()).unwrap();
//! jelly.run_for(0.2);
//! let before = jelly.state().velocity[0];
//! path::set(&mut scene, "bodies.0.material.springs.shear.stiffness", "60").unwrap();
//! let lattices = [jelly.model().bodies[0].lattice.clone()];
//! jelly.set_parameters(&scene, &lattices, &[Some(0)], Arrival::Placed);
//! assert_eq!(jelly.state().velocity[0], before, "it goes on as it was");
//! ```

mod compile;
mod contact;
mod forces;
mod interaction;
mod kernels;
mod limits;
pub mod memory;
mod model;
mod modes;
mod observe;
mod report;
mod schemes;
mod share;
mod simulation;
mod state;
mod step;
mod stepping;
mod team;

pub use compile::SceneError;
pub use compile::other_form::OtherForm;
pub use compile::safe_values::{MaterialOf, SafeValue, largest_safe};
pub use compile::stability_plane::{Place, StabilityPlane};
pub use compile::step_loads::{ContactLoad, StepSettings};
pub use contact::{BodyContact, ContactRecord, DEPTH_SHARE, Placed, SampleContact, WeightedParticles};
pub use interaction::Grab;
pub use kernels::SimdLevel;
pub use limits::{LinkLoad, SAFETY, SceneLimits, Term};
pub use model::plan::{
    BodyContactPlan, MOST_HALVINGS, MOST_PARTS_BETWEEN_BODIES, MOST_WORK_A_FRAME, Plan, SOLVE_WORK, SchemeCost, Stage,
    StageRates,
};
pub use model::{
    BodyModel, ContactModel, ContactRule, Inertia, Link, LinkFamily, MeshModel, ModalModel, Model, ObstacleModel,
    ObstacleShape, OrientedForm, OrientedModel, PlaneModel, RecoveryModel, Scheme, Values,
};
pub use observe::diagnostics::{Diagnostics, Energy};
pub use observe::scalars::Quantity;
pub use report::{Counters, LastSubstep, StageTimer, StepReport};
pub use simulation::{Arrival, BodyMotion, Simulation};
pub use state::moving::{Approach, Sweep};
pub use state::press::{BodyPoint, Press};
pub use state::touch::SampleTouch;
pub use state::{BodyMemory, ModalState, RecoveryAccount, RigidState, State, Strain};
pub use team::{choose_step_threads, step_threads};
