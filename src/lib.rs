//! Gelatin: an interactive sandbox for soft bodies, and the library under it.
//!
//! # The idea in one line
//!
//! **description → constant model → mutable state → abstract picture → GPU**, one word for each:
//! [`scene::Scene`] → [`physics::Model`] (+ [`physics::Plan`]) → [`physics::State`] → [`view::DrawList`] →
//! `render::Renderer`.
//!
//! # As a library
//!
//! Drop a cube of jelly:
//!
//! ```
//! use gelatin::{physics::Simulation, scene::presets};
//!
//! let scene = (presets::preset("cube-on-plane").unwrap().build)();
//! let mut jelly = Simulation::<f32>::from_scene(&scene, "".as_ref()).unwrap();
//! let height = jelly.diagnostics().center.y;
//! let report = jelly.run_for(1.0);
//! assert!(!report.diverged && report.last.contacts > 0, "it has landed");
//! assert!(jelly.diagnostics().center.y < height);
//! ```
//!
//! Jellify a model:
//!
//! ```
//! use gelatin::{physics::Simulation, scene::presets};
//!
//! let scene = presets::drop_model("assets/spot.obj");
//! let spot = Simulation::<f32>::from_scene(&scene, "".as_ref()).unwrap();
//! let (particles, links) = (spot.model().particle_count(), spot.model().link_counts());
//! assert!(particles > 1000 && links.iter().sum::<usize>() > 10 * particles, "{particles}, {links:?}");
//! ```
//!
//! Measure an error: the same fall in steps a quarter as long, and in double precision.
//!
//! ```
//! use gelatin::{math::Real, physics::Simulation, scene::{Scene, presets, settings::Stepping}};
//!
//! fn middle<R: Real>(dt: f64) -> f64 {
//!     let mut scene: Scene = (presets::preset("cube-on-plane").unwrap().build)();
//!     (scene.settings.dt, scene.settings.stepping) = (dt, Stepping::Manual);
//!     let mut jelly = Simulation::<R>::from_scene(&scene, "".as_ref()).unwrap();
//!     jelly.run_for(0.1);
//!     jelly.diagnostics().center.y
//! }
//! let reference = middle::<f64>(5e-5);
//! let [coarse, fine] = [8e-4, 2e-4].map(|dt| (middle::<f32>(dt) - reference).abs());
//! assert!(fine < 0.5 * coarse && coarse < 1e-3, "{coarse} m and {fine} m off");
//! ```
//!
//! # Layers
//!
//! Layers name only those above them in this table; `tests/tidy.rs` reads the sources and fails on anything else.
//!
//! | module | names | its job |
//! |---|---|---|
//! | [`math`] | – | scalars, bounding boxes, rotations, linear colours, texels, seeded random numbers, the length of a frame |
//! | [`text`] | – | text from files and arguments made safe to print; counts in words |
//! | [`disk`] | text | reading and writing whole files |
//! | [`machine`] | – | free memory; threads kept awake while there is work |
//! | [`geometry`] | math, disk, text | model file → mesh → cells of a grid → particles and links; points embedded in cells; the named parts of a model; its colours and textures |
//! | [`scene`] | math, disk, text, geometry | the document: bodies, materials, obstacles, settings; edits, files, presets, one definition per parameter |
//! | [`physics`] | math, machine, geometry, scene (in `compile` alone) | the core: forces, contact, stability limits, the step; no input, output or clock |
//! | [`modal`] | math, machine, geometry, physics | the lowest vibration modes of a body about rest; the physics can move a body by them at a cost that does not grow with its cells |
//! | [`view`] | math | camera, draw list, colours, legend: a picture as plain data |
//! | [`extract`] | math, geometry, scene, physics, view | bodies and obstacles → skins and solids of a draw list; links, contacts and boxes → overlays; what a model loses by its cells → a picture |
//! | `render` | math, view | wgpu: draws a draw list to a window's surface or an image; has never heard of a spring |
//! | [`report`] | math, machine, geometry, scene, physics | measurements: error against run time, cost of a scene stage by stage, speed of a step, stability limits, contact against theory, random extreme scenes, another engine beside ours |
//! | [`session`] | all of the above but render | the running sandbox: commands and time in, status and draw list out; no window |
//! | [`export`] | math, disk, text, geometry, view | writes pictures to files |
//! | `app` | all but geometry, physics, modal and report | winit and egui: the window, its panels, the thread the session runs on |
//! | `cli` | all but physics | the command line; opens the window |
//!
//! # Data flow
//!
//! ```text
//!  winit event ─ app::input ─┐
//!  egui panel  ─ app::ui ────┼─► Command ─► Session::handle ─► Edit ─► Scene::apply ─► Applied { inverse, impact }
//!  command line, test ───────┘                                         undo, redo ◄─ history ┘ │
//!       Impact::Appearance → skins and colours only                                           ▼
//!       Impact::Parameters → Simulation::set_parameters: the motion goes on; a dragged obstacle sweeps to its place, one
//!                            that a value puts into a body comes gently and moves the body out
//!       Impact::Motion     → the body is moved, turned or thrown; nothing is rebuilt
//!       Impact::Topology   → compiled anew; bodies that stay keep their motion
//!  wall time ─► Session::advance ─► whole steps, m substeps in n of them ─► StepReport ─► Status ─► panels
//!       (nine in eight steps of the default cube, one in four of the implicit integrator; a substep that is strained or would
//!        gain energy is taken in parts, up to a limit of work in 1/60 s; beyond that the motion is slowed and the report says so)
//!  Session::draw_list ─► DrawList ─► Renderer ─► surface or image
//! ```
//!
//! A frame uploads the positions of particles, and one scalar each when colours are on: skins are evaluated on the
//! GPU from eight particles and weights a vertex. The window never waits for a step: the session runs on a thread of
//! its own and publishes its newest picture. Long work for a panel runs on another thread; a change that makes large bodies
//! shows its progress and can be stopped. While the simulation is paused a body may be shown displaced by its modes
//! (`Command::ShowModes`): its state stays as it is. A frame is drawn only if it differs from the last one. In software
//! rendering, frame rate and resolution are limited so that the simulation keeps its share of the processors
//! (`app::frame_pacer`); a frame that a person waits for gets all of them.
//!
//! A body that is to move by its modes waits for them, and time with it (`session::modal`). The window computes them on another
//! thread, with progress and a stop; the command line at once. Both keep them in a folder beside the scene. The result is a
//! `Command::TakeModes`; from then on the body is a modal body (`physics::modes`) and its cells are not simulated.
//!
//! # Two walks through the code
//!
//! Each file is entered once, by the function beside it (`tests/tidy.rs` checks that it exists). The first walk follows
//! a step length from `--dt` to the loop that integrates:
//!
//! ```text
//! cli/scene_args.rs               apply           --dt is the step of the scene
//! session/mod.rs                  open            a sandbox at the start of the scene
//! physics/compile/mod.rs          compile         Scene → Model, Plan
//! physics/compile/plan.rs         plan            as many substeps as are stable
//! physics/model/plan.rs           substep_secs    how long each is
//! physics/simulation.rs           substep         the owner of model, plan and state takes one
//! physics/stepping/mod.rs         advance         in parts, each with its length
//! physics/stepping/division.rs    next            how long the next part is
//! physics/step/mod.rs             move_particles  what is awake moves
//! physics/kernels/motion.rs       advance         x += dt u
//! ```
//!
//! The second follows `bodies.0.material.springs.shear.stiffness` from its slider to the picture, which is a draw list:
//!
//! ```text
//! app/ui/inspector/springs.rs     springs_ui      the sliders of a body's springs
//! app/ui/value/track.rs           slider_ui       a hand → a value
//! app/ui/value/interaction.rs     send            a value → Command::Edit
//! app/shell/panels.rs             lay_out_panels  what the panels ask for goes to
//! app/worker.rs                   send            the thread of the sandbox
//! session/handle.rs               handle          a command does what it says
//! session/editing.rs              apply_edit      an edit and all that follows from it
//! scene/edit.rs                   apply           the document has the value, and its inverse is known
//! physics/compile/mod.rs          set_parameters  Scene → Model, while everything goes on moving
//! physics/compile/assembly.rs     uniform         the constants of a family of links
//! physics/kernels/boxed.rs        new             the same, as the kernel reads them
//! physics/simulation.rs           replace_model   the next substep is taken by them
//! session/mod.rs                  advance         as much time as has passed
//! physics/stepping/mod.rs         advance         part by part
//! physics/step/mod.rs             take_part       the stages of a part
//! physics/forces/mod.rs           evaluate        all forces: those of links by a thread's shares
//! physics/kernels/sweep.rs        add_forces      piece by piece
//! physics/kernels/block.rs        add_forces      the force of a link
//! app/worker/publish.rs           publish         what leaves the thread, once a frame
//! session/draw.rs                 draw_list       particles → DrawList
//! ```
//!
//! What draws it knows nothing of springs: `app::shell` takes the list and draws it on `app::canvas`.
//!
//! # Invariants, and the test that holds each
//!
//! 1. The core builds and passes its unit tests without the features of the program; no graphics or window crate is in its
//!    tree (`.ci/run`).
//! 2. Only `app` names egui and winit; only `render` and `app::canvas` name wgpu (`tests/tidy.rs`).
//! 3. A step cannot fail, reads no clock, logs nothing, and does not allocate once bodies have been near each other. A step
//!    that would make a number infinite is abandoned and the last good state kept (`tests/physics/determinism.rs`, `stability.rs`).
//! 4. The same scene gives the same bits at every level of vector instructions and by any number of threads; what a plan
//!    leaves out changes nothing but time (`tests/physics/determinism.rs`, `economy.rs`). Sleep changes the motion: bodies at
//!    rest and bodies that fell out of the scene stop, as a function of the state alone (`tests/physics/sleep.rs`,
//!    `fallen.rs`).
//! 5. In automatic stepping no value of a parameter within its range makes a body explode, but the schemes without a stable
//!    step, explicit Euler and RK2 (`tests/physics/stability.rs`).
//! 6. Every change to a scene is a [`scene::edit::Edit`]; its inverse takes it back byte for byte, with the motion of the body
//!    that it moved or removed (`scene::edit`, `session`: ten thousand random commands).
//! 7. Every struct shared with a shader has its layout (`tests/render`).
//! 8. Whatever a file, a graphics driver or a person does wrong becomes a typed error with a sentence (`tests/cli`), in bounded
//!    memory and time (`tests/fuzz`, `tests/cli/limits.rs`).
//!
//! # Features
//!
//! `app` (default): the program. `render`: pictures without a window. `peers`: another engine's soft body beside ours
//! (`report::peers`). Without features: the core, all but `render`, `cli` and `app`.
//!
//! # Words
//!
//! particle · link (a spring between two particles, of the family structural, shear or bending) · cell (a filled
//! voxel) · lattice (particles and links of a body at rest) · body · obstacle (plane, sphere, box, capsule, cylinder or mesh) ·
//! material · scene · edit · command · model · plan · state · step (one dt) · substep · span (steps that end with a
//! substep) · part (of a substep that is divided further) · frame (one picture) · contact (of a particle, or of a point
//! that several particles carry) · edge (points of an obstacle that cells meet, as particles may pass it by) · island (bodies
//! that touch each other, or others that do) · broad and narrow phase · skin (the drawn surface) · overlay (what explains a
//! picture) · draw list · pass · preset · report.
//!
//! Sources: *Gelatin Cubes: Soft Body Simulation* (G. Solaro, USI 2023), cited as GC with its section, and *Squashing
//! Cubes: Automating Deformable Model Construction for Graphics* (James, Barbič, Twigg 2004), cited as SC.

pub mod disk;
pub mod geometry;
pub mod machine;
pub mod math;
pub mod modal;
pub mod physics;
pub mod scene;
pub mod text;
pub mod view;

pub mod export;
pub mod extract;
pub mod report;
pub mod session;

#[cfg(feature = "render")]
pub mod render;

#[cfg(feature = "app")]
pub mod app;
#[cfg(feature = "app")]
pub mod cli;
