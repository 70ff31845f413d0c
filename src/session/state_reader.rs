//! Reads the numbers of a saved state and checks each, so that a simulation goes on only from a state that one can have had.

use std::fmt::Display;

use glam::{DQuat, DVec3, Vec3};

use super::state_error::{MESH_POINT_FLAG, StateFileError};
use crate::modal::COUNTS;
use crate::physics::Approach;
use crate::physics::BodyMemory;
use crate::physics::LinkLoad;
use crate::physics::MOST_HALVINGS;
use crate::physics::ModalState;
use crate::physics::RigidState;
use crate::physics::SampleTouch;
use crate::physics::Sweep;
use crate::physics::{BodyModel, Model};
use crate::physics::{BodyPoint, Press};
use crate::physics::{RecoveryAccount, Strain};
use crate::physics::{Simulation, State};

/// More steps than this are not counted one by one.
const MAX_STEPS: u64 = 1 << 53;

/// The limit of a mode's amplitude and rate, m √kg and m √kg / s, and of the distance and speed of a free body, m and m/s:
/// beyond it a body has exploded.
const MAX_MODAL_VALUE: f64 = 1e12;

/// Takes numbers off the front of bytes.
pub(super) struct Reader<'a> {
    rest: &'a [u8],
    features: FormatFeatures,
}

/// Which things a version of the file holds.
#[derive(Clone, Copy, Debug)]
#[expect(clippy::struct_excessive_bools, reason = "each is what a version was the first to tell of")]
pub(super) struct FormatFeatures {
    /// Points of meshes that meet other bodies.
    pub(super) meshes_meet: bool,
    /// Points of meshes that touch obstacles.
    pub(super) touches: bool,
    /// Modal bodies.
    pub(super) modes: bool,
    /// Modal bodies that nothing holds.
    pub(super) free_modes: bool,
}

/// The numbers that a state begins with.
pub(super) struct Counts {
    particles: u64,
    planes: u64,
    steps: u64,
    substep: u32,
    pub(super) time_secs: f64,
    velocity_lag_secs: f64,
    accelerations: u64,
    part: u64,
    halvings: u32,
    work: u64,
}

impl<'a> Reader<'a> {
    pub(super) fn new(bytes: &'a [u8], features: FormatFeatures) -> Self {
        Self { rest: bytes, features }
    }

    /// Reads the numbers that a state begins with.
    pub(super) fn counts(&mut self) -> Result<Counts, StateFileError> {
        let [particles, planes] = [self.u64("the counts")?, self.u64("the counts")?];
        let steps = self.u64("the counts")?;
        let substep = self.u64("the counts")?;
        let [time_secs, velocity_lag_secs] = [self.f64("the time")?, self.f64("the velocities' lag")?];
        let accelerations = self.u64("the counts")?;
        let _unused = self.u64("the counts")?;
        let [part, halvings] = [self.u64("the counts")?, self.u64("the counts")?];
        let work = self.u64("the counts")?;
        require(steps < MAX_STEPS, "the count of steps", steps, "a count below 2^53")?;
        require((0.0..f64::INFINITY).contains(&time_secs), "the time", time_secs, "a time of 0 s or more")?;
        let lag_fits = (0.0..=0.1).contains(&velocity_lag_secs);
        require(lag_fits, "the velocities' lag", velocity_lag_secs, "a time from 0 to 0.1 s")?;
        let halvings = require_at_most(halvings, "the count of halvings", u64::from(MOST_HALVINGS))?;
        let whole = 1_u64 << MOST_HALVINGS;
        let length = whole >> halvings;
        let needed = format!("a multiple of {length} below {whole} after {halvings} halvings");
        require(part < whole && part.is_multiple_of(length), "the part of the substep that is done", part, &needed)?;
        let most = u64::from(u32::MAX) - 1;
        Ok(Counts {
            particles,
            planes,
            steps,
            substep: require_at_most(substep, "the count of substeps", most)?,
            time_secs,
            velocity_lag_secs,
            accelerations,
            part,
            halvings,
            work,
        })
    }

    /// Reads a whole state of the scene that is simulated.
    pub(super) fn state(mut self, simulation: &Simulation<f32>) -> Result<State<f32>, StateFileError> {
        let counts = self.counts()?;
        let (model, plan, present) = (simulation.model(), simulation.plan(), simulation.state());
        let (particles, planes) = (present.position.len(), present.side.len());
        require_same(counts.particles, particles, "the count of particles")?;
        require_same(counts.planes, planes, "the count of planes")?;
        let accelerated = if counts.accelerations == 0 { 0 } else { particles };
        require_same(counts.accelerations, accelerated, "the count of accelerations")?;
        let position = self.vectors(particles, "the position", "m")?;
        let position_residual = self.vectors(particles, "the residual of the position", "m")?;
        let velocity = self.vectors(particles, "the velocity", "m/s")?;
        let acceleration = self.vectors(accelerated, "the acceleration", "m/s²")?;
        let side = (0..planes).map(|_| self.sides(particles)).collect::<Result<_, _>>()?;
        let (bodies, anchor) = self.body_memories(model)?;
        let approaches = self.approaches(model)?;
        let sweeps = self.sweeps(model)?;
        let presses = self.presses(model)?;
        let touches = if self.features.touches { self.touches(model)? } else { Vec::new() };
        let modal = if self.features.modes { self.modal(model)? } else { Vec::new() };
        if !self.rest.is_empty() {
            return Err(StateFileError::Length { field: "all the numbers".to_owned() });
        }
        Ok(State {
            position,
            position_residual,
            velocity,
            acceleration: (accelerated > 0).then_some(acceleration),
            velocity_lag_secs: counts.velocity_lag_secs,
            side,
            anchor,
            bodies,
            approaches,
            sweeps,
            presses,
            touches,
            modal,
            steps: counts.steps,
            // A state saved with more substeps in a step is put at the last substep here.
            substep: counts.substep.min(plan.substeps_after(counts.steps).saturating_sub(1)),
            part: counts.part,
            halvings: counts.halvings,
            work: counts.work,
            time_secs: counts.time_secs,
        })
    }

    /// Reads the memory of every body, and the anchors of the still ones.
    fn body_memories(&mut self, model: &Model<f32>) -> Result<(Vec<BodyMemory>, Vec<Vec3>), StateFileError> {
        let mut anchor = vec![Vec3::ZERO; model.particle_count()];
        let mut memories = Vec::new();
        for (number, body) in model.bodies.iter().enumerate() {
            memories.push(self.body_memory(number, body, &mut anchor[body.particles.clone()])?);
        }
        Ok((memories, anchor))
    }

    fn body_memory(
        &mut self,
        number: usize,
        body: &BodyModel<f32>,
        anchor: &mut [Vec3],
    ) -> Result<BodyMemory, StateFileError> {
        let cells = body.lattice.cells.len();
        let of_body = |what: &str| format!("{what} of body {number}");
        let field = of_body("the list of cells that may invert");
        let count = self.u64(&field)?;
        require(count <= cells as u64, &field, format!("{count} long"), &format!("at most {cells}"))?;
        let near_inversion: Vec<u32> = (0..count).map(|_| self.u32(&field)).collect::<Result<_, _>>()?;
        let ascends = near_inversion.is_sorted_by(|a, b| a < b);
        require(ascends, &field, "out of order", "every cell once, in their order")?;
        let last = near_inversion.last().copied().unwrap_or_default();
        require(last == 0 || (last as usize) < cells, &field, format!("one with cell {last}"), "a cell of the body")?;
        let field = of_body("the memory");
        let [flags, knotted_nanos, calm_substeps] = [self.u32(&field)?, self.u32(&field)?, self.u32(&field)?];
        require(flags < 256, &field, flags, "a sum of 1, 2, 4, 8, 16, 32, 64 and 128")?;
        let [asleep, large, stuck, gone, near_itself, is_modal, taut, is_known] =
            [1, 2, 4, 8, 16, 32, 64, 128].map(|flag| flags & flag != 0);
        require(!(large && taut), &field, "one of two strains", "one of them")?;
        let strain = match (large, taut) {
            (true, _) => Strain::Large,
            (_, true) => Strain::Taut,
            _ => Strain::Small,
        };
        require(
            strain > Strain::Small || calm_substeps == 0,
            &field,
            "one that is calm after no strain",
            "0 substeps",
        )?;
        require(asleep || !gone, &field, "one of a body that has fallen out and is awake", "one that sleeps")?;
        require(asleep || !is_modal, &field, "one of a modal body that is awake", "one that sleeps")?;
        let load = if is_known { self.link_load(&of_body("what links add"))? } else { LinkLoad::default() };
        let field = of_body("the account of recovery");
        let [taken_j, pull_share] = [self.f64(&field)?, self.f64(&field)?];
        require(taken_j.is_finite(), &field, format!("{taken_j} J"), "a finite number")?;
        require((0.0..=1.0).contains(&pull_share), &field, format!("a share of {pull_share}"), "0 to 1")?;
        let account = RecoveryAccount { taken_j, pull_share };
        let field = of_body("the way to the next look at folds");
        let apart = self.f64(&field)?;
        require(apart.is_finite(), &field, format!("{apart} cells"), "a finite number")?;
        let field = of_body("the count of still substeps");
        let still_substeps = self.u64(&field)?;
        require(still_substeps < MAX_STEPS, &field, still_substeps, "a count below 2^53")?;
        if still_substeps > 0 {
            let was = self.vectors(anchor.len(), &of_body("the place at rest"), "m")?;
            anchor.copy_from_slice(&was);
        }
        Ok(BodyMemory {
            near_inversion,
            strain,
            calm_substeps,
            load,
            knotted_nanos,
            stuck,
            account,
            still_substeps,
            asleep,
            gone,
            is_modal,
            near_itself,
            apart,
        })
    }

    /// Reads what the links of a strained body add.
    fn link_load(&mut self, field: &str) -> Result<LinkLoad, StateFileError> {
        let [stiffness, damping] = [self.f64(field)?, self.f64(field)?];
        for rate in [stiffness, damping] {
            require(rate.is_finite() && rate >= 0.0, field, rate, "a finite number that is not negative")?;
        }
        Ok(LinkLoad { stiffness, damping })
    }

    /// Reads how modal bodies move, by body.
    fn modal(&mut self, model: &Model<f32>) -> Result<Vec<ModalState>, StateFileError> {
        let field = "the modal bodies";
        let mut modal = vec![ModalState::default(); model.bodies.len()];
        let mut last = None;
        for _ in 0..self.u64(field)? {
            let [body, count] = [self.u64(field)?, self.u64(field)?];
            let body = require_index((body, model.bodies.len()))?;
            require(last < Some(body), field, "out of order", "every body once, in their order")?;
            let most = COUNTS[1] as u64;
            require((1..=most).contains(&count), field, format!("{count} modes"), &format!("1 to {most}"))?;
            let mut numbers = Vec::new();
            for _ in 0..3 * count {
                let number = self.f64(field)?;
                require(number.abs() <= MAX_MODAL_VALUE, "a mode", number, "a number from -1e12 to 1e12")?;
                numbers.push(number);
            }
            let mut rate = numbers.split_off(numbers.len() / 3);
            let mean_rate = rate.split_off(rate.len() / 2);
            let rigid = if self.features.free_modes { self.rigid()? } else { None };
            modal[body] = ModalState { amplitude: numbers, rate, mean_rate, rigid };
            last = Some(body);
        }
        Ok(modal)
    }

    /// Reads how a modal body moves as a whole, where nothing holds it.
    fn rigid(&mut self) -> Result<Option<RigidState>, StateFileError> {
        let field = "a modal body as a whole";
        let is_free = self.u64(field)?;
        require(is_free < 2, "whether a modal body is free", is_free, "0 or 1")?;
        if is_free == 0 {
            return Ok(None);
        }
        let mut numbers = [0.0; RigidState::NUMBERS];
        for number in &mut numbers {
            *number = self.f64(field)?;
            require(number.is_finite(), field, *number, "a finite number")?;
        }
        let rigid = RigidState::from_numbers(numbers);
        let RigidState { center, turn, velocity, .. } = rigid;
        require(turn.is_normalized(), "the turn of a modal body", turn, "a quaternion of length 1")?;
        let is_near = [center, velocity].iter().all(|of| of.abs().max_element() <= MAX_MODAL_VALUE);
        require(
            is_near,
            "the centre of a modal body",
            center,
            "a place and a velocity with numbers from -1e12 to 1e12",
        )?;
        Ok(Some(rigid))
    }

    /// The obstacles on their way to bodies.
    fn approaches(&mut self, model: &Model<f32>) -> Result<Vec<Approach>, StateFileError> {
        let field = "the obstacles on their way";
        let count = self.u64(field)?;
        let mut approaches: Vec<Approach> = Vec::new();
        for _ in 0..count {
            let [body, obstacle, waits] = [self.u64(field)?, self.u64(field)?, self.u64(field)?];
            let way = DVec3::new(self.f64(field)?, self.f64(field)?, self.f64(field)?);
            let [left_m, speed] = [self.f64(field)?, self.f64(field)?];
            require(way.is_normalized(), "the way of an obstacle", way, "a direction of length 1")?;
            require(left_m > 0.0 && left_m.is_finite(), "the way left of an obstacle", left_m, "a length above 0 m")?;
            let goes = (0.0..f64::INFINITY).contains(&speed);
            require(goes, "the speed of an obstacle", speed, "a speed of 0 m/s or more")?;
            require(waits < 2, "the waiting of an obstacle", waits, "0 or 1")?;
            let [body, obstacle] = [(body, model.bodies.len()), (obstacle, model.obstacles.len())].map(require_index);
            let (body, obstacle) = (body?, obstacle?);
            let ascends = approaches.last().is_none_or(|last| (last.body, last.obstacle) < (body, obstacle));
            require(ascends, field, "out of order", "every pair of body and obstacle once, in their order")?;
            approaches.push(Approach { body, obstacle, way, left_m, speed, waits: waits == 1 });
        }
        Ok(approaches)
    }

    /// The obstacles that sweep.
    fn sweeps(&mut self, model: &Model<f32>) -> Result<Vec<Sweep>, StateFileError> {
        let field = "the obstacles that sweep";
        let mut sweeps: Vec<Sweep> = Vec::new();
        for _ in 0..self.u64(field)? {
            let obstacle = require_index((self.u64(field)?, model.obstacles.len()))?;
            let center = DVec3::new(self.f64(field)?, self.f64(field)?, self.f64(field)?);
            let [x, y, z, w] = [self.f64(field)?, self.f64(field)?, self.f64(field)?, self.f64(field)?];
            let (rotation, left_secs) = (DQuat::from_xyzw(x, y, z, w), self.f64(field)?);
            require(center.is_finite(), "the middle of an obstacle that sweeps", center, "a place in m")?;
            require(
                rotation.is_normalized(),
                "the turn of an obstacle that sweeps",
                rotation,
                "a quaternion of length 1",
            )?;
            let in_time = left_secs > 0.0 && left_secs <= Sweep::SECS;
            require(in_time, "the time left of a sweep", left_secs, "a time above 0 s, at most 1/60 s")?;
            let ascends = sweeps.last().is_none_or(|last| last.obstacle < obstacle);
            require(ascends, field, "out of order", "every obstacle once, in their order")?;
            sweeps.push(Sweep { obstacle, center, rotation, left_secs });
        }
        Ok(sweeps)
    }

    /// The springs between bodies.
    fn presses(&mut self, model: &Model<f32>) -> Result<Vec<Press>, StateFileError> {
        let field = "the springs between bodies";
        let mut presses: Vec<Press> = Vec::new();
        for _ in 0..self.u64(field)? {
            let point = self.u64(field)?;
            let point = if point & MESH_POINT_FLAG == 0 {
                BodyPoint::Particle(require_index((point, model.particle_count()))?)
            } else {
                BodyPoint::OfMesh(require_index((point & !MESH_POINT_FLAG, model.sample_count()))?)
            };
            let bodies = [
                require_index((self.u64(field)?, model.bodies.len()))?,
                require_index((self.u64(field)?, model.bodies.len()))?,
            ];
            let depth_m = self.f64(field)?;
            let press = Press { bodies, point, depth_m };
            // A body that meets itself is both bodies.
            let (said, right) = match point {
                BodyPoint::Particle(particle) => {
                    (format!("one of particle {particle} and bodies {bodies:?}"), "a particle of the first")
                }
                BodyPoint::OfMesh(number) => (
                    format!("one of point {number} of a mesh and bodies {bodies:?}"),
                    "a point of the first one's mesh",
                ),
            };
            if !self.features.meshes_meet && !press.fits(model) {
                continue;
            }
            require(press.fits(model), field, said, right)?;
            let is_depth = (0.0..f64::INFINITY).contains(&depth_m);
            require(is_depth, "how far a spring between bodies is pressed", depth_m, "a length of 0 m or more")?;
            let order = |press: &Press| (press.bodies[0], press.point, press.bodies[1]);
            let ascends = presses.last().is_none_or(|last| order(last) < order(&press));
            require(ascends, field, "out of order", "every point in a body once, in their order")?;
            presses.push(press);
        }
        Ok(presses)
    }

    /// The points of meshes that touch obstacles.
    fn touches(&mut self, model: &Model<f32>) -> Result<Vec<SampleTouch>, StateFileError> {
        let field = "the points of meshes that touch obstacles";
        let mut touches: Vec<SampleTouch> = Vec::new();
        for _ in 0..self.u64(field)? {
            let body = require_index((self.u64(field)?, model.bodies.len()))?;
            let sample = self.u64(field)?;
            let obstacle = require_index((self.u64(field)?, model.obstacles.len()))?;
            let side = self.u64(field)?;
            let depth_m = self.f64(field)?;
            let side = [-1, 0, 1].get(usize::try_from(side).unwrap_or(usize::MAX)).copied();
            let side = side.ok_or_else(|| value_error("the side of a point of a mesh", "another", "-1, 0 or 1"))?;
            let is_depth = (0.0..f64::INFINITY).contains(&depth_m);
            require(is_depth, "how far the spring of a point is pressed", depth_m, "a length of 0 m or more")?;
            let sample = usize::try_from(sample).unwrap_or(usize::MAX);
            let key = (body, sample, obstacle);
            let ascends = touches.last().is_none_or(|last| (last.body, last.sample, last.obstacle) < key);
            require(ascends, field, "out of order", "every point at an obstacle once, in their order")?;
            touches.push(SampleTouch { body, sample, obstacle, side, depth_m });
        }
        Ok(touches)
    }

    fn chunk<const N: usize>(&mut self, field: &str) -> Result<[u8; N], StateFileError> {
        let Some((chunk, rest)) = self.rest.split_first_chunk::<N>() else {
            return Err(StateFileError::Length { field: field.to_owned() });
        };
        self.rest = rest;
        Ok(*chunk)
    }

    fn u32(&mut self, field: &str) -> Result<u32, StateFileError> {
        self.chunk(field).map(u32::from_le_bytes)
    }

    fn u64(&mut self, field: &str) -> Result<u64, StateFileError> {
        self.chunk(field).map(u64::from_le_bytes)
    }

    fn f64(&mut self, field: &str) -> Result<f64, StateFileError> {
        self.chunk(field).map(f64::from_le_bytes)
    }

    /// Reads this many vectors of finite numbers.
    fn vectors(&mut self, count: usize, field: &str, unit: &str) -> Result<Vec<Vec3>, StateFileError> {
        if self.rest.len() / 12 < count {
            return Err(StateFileError::Length { field: format!("{field} of every particle") });
        }
        let mut vectors = Vec::with_capacity(count);
        for number in 0..count {
            let mut next = || self.chunk(field).map(f32::from_le_bytes);
            let vector = Vec3::new(next()?, next()?, next()?);
            if !vector.is_finite() {
                let field = format!("{field} of particle {number}");
                return Err(value_error(&field, format!("{vector} {unit}"), "three finite numbers"));
            }
            vectors.push(vector);
        }
        Ok(vectors)
    }

    fn sides(&mut self, count: usize) -> Result<Vec<i8>, StateFileError> {
        let field = "the side of a plane";
        let (sides, rest) =
            self.rest.split_at_checked(count).ok_or_else(|| StateFileError::Length { field: field.to_owned() })?;
        self.rest = rest;
        let sides: Vec<i8> = sides.iter().map(|side| side.cast_signed()).collect();
        match sides.iter().find(|side| !(-1..=1).contains(*side)) {
            Some(side) => Err(value_error(field, side, "-1, 0 or 1")),
            None => Ok(sides),
        }
    }
}

/// Refuses a number that does not fit.
fn require(fits: bool, field: &str, value: impl Display, needed: &str) -> Result<(), StateFileError> {
    if fits { Ok(()) } else { Err(value_error(field, value, needed)) }
}

fn value_error(field: &str, value: impl Display, needed: &str) -> StateFileError {
    StateFileError::Value { field: field.to_owned(), value: value.to_string(), needed: needed.to_owned() }
}

fn require_same(saved: u64, here: usize, field: &str) -> Result<(), StateFileError> {
    require(saved == here as u64, field, saved, &here.to_string())
}

fn require_at_most(word: u64, field: &str, most: u64) -> Result<u32, StateFileError> {
    require(word <= most, field, word, &format!("at most {most}"))?;
    u32::try_from(word).map_err(|_too_many| StateFileError::Length { field: field.to_owned() })
}

/// Checks the number of a body or an obstacle against the count of them.
fn require_index((word, count): (u64, usize)) -> Result<usize, StateFileError> {
    let found = usize::try_from(word).ok().filter(|&place| place < count);
    found.ok_or_else(|| value_error("the number of a body or an obstacle", word, &format!("a number below {count}")))
}
