//! The core: a mass-spring lattice that moves, meets obstacles and comes to rest (GC §2–§7).
//!
//! A scene and the lattices of its bodies are compiled into a constant [`Model`] and the [`Plan`] of a step; a
//! [`Simulation`] owns both with the mutable [`State`]. The core does no input or output, reads no clock and never fails.
//! Once it runs it allocates only the first time that a body comes near another or itself. It is generic over the scalar:
//! `f32` to run, `f64` as reference.
//!
//! # Modules
//!
//! ```text
//! simulation   owns model, plan and state: takes steps, takes edits while it runs, takes out and puts back a body's motion
//! compile      scene → model and plan: materials to constants, obstacles, safe ranges of values; the only module that
//!              names the document (`tests/tidy.rs` checks that)
//! model        bodies, links, obstacles, and the plan: constant from one compilation to the next
//! state        all that changes: positions, velocities, memory of contacts; sleep, fallen bodies, the state's hash
//! stepping     divides a step in time and takes its parts
//! step         takes one part: its stages, one function each, in the order of GC Algorithm 1
//! forces       gravity, links, recovery from inversion
//! share, team  threads: bodies are cut into shares of equal work, which the threads of a pool take
//! kernels      vectorised code: link forces of many links at a time, tested against `forces`; boxes around vectors
//! schemes      time integration: the explicit schemes, and the implicit one with its energy balance
//! modes        modal bodies, at a cost that does not grow with their cells
//! contact      obstacles: their places, contact candidates, contact response; contact between bodies
//! limits       the largest stable step, from plane waves, cells and states
//! interaction  a hand that pulls
//! observe      energies, a scalar for every particle, detection of explosions
//! report       the report of a step, and its timer
//! memory       the memory that a scene takes, counted before it is made
//! ```
//!
//! # One step
//!
//! ```text
//! simulation.step()   the substeps that end within the step; where a substep covers several steps, most are only counted
//!   stepping          part by part, with obstacles placed for the part (Placed): (model, plan, part, inputs, &mut state)
//!     find_forces     F at the state: gravity, links (by kernels), cells near inversion, contact by the thesis's rule
//!     predict         v* = v + dt F/m, and a hand's pull
//!     meet_bodies     contact of bodies with each other and themselves changes v*, then meet_obstacles does; the implicit
//!                     scheme solves for pull, obstacles and v' at once instead (step::solved)
//!     refine          v' and the velocity u that moves x, with more forces where the scheme has stages; then correct_paths
//!     is_sound        unless all numbers are finite, the state stays the last good one and the report says so
//!     accept          x += dt u, v = v'; before it, sides and recovery are settled; after it, sleep and fallen bodies
//!     modes           modal bodies over the same part
//!     advance         moves approaching and swept obstacles on by the part
//!   StepReport        sums over substeps, and what held at the end of the last
//! ```
//!
//! # How to change a running simulation
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
