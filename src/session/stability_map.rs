//! Shows where the step of a scene is stable over the stiffness and damping of one body: predicted at once, while someone
//! looks, and measured when a person asks for it. The measurement works on the caller's thread; it reports and stops
//! through [`Progress`].

use std::path::Path;
use std::sync::Arc;

use super::background::{BackgroundError, PausingWatch};
use super::document::Opened;
use super::progress::Progress;
use crate::geometry::watch::{CancelOnly, Portion};
use crate::geometry::{Lattice, Watch};
use crate::physics::{BodyModel, Simulation, StabilityPlane};
pub use crate::physics::{Place, StepSettings};
use crate::report::stability::limit::isolated_bodies;
use crate::report::stability::map::{StabilityTrial, Survival, values};
use crate::scene::body::CubeShape;
use crate::scene::edit::BodyId;
use crate::scene::material::{Solid, Spring};
use crate::scene::settings::Integrator;
use crate::scene::{Body, Family, Material, Scene, Shape};

/// Values along each axis that are measured.
const VALUES_PER_AXIS: usize = 13;
/// Powers of ten that each axis shows below the end of the border, and above it.
const DECADES_BELOW: f64 = 2.3;
const DECADES_ABOVE: f64 = 0.6;
/// The most places of the border that are sought between columns, and the factor by which the border must fall there.
const MAX_REFINED_PLACES: usize = 6;
const STEEP_RATIO: f64 = 2.0;
/// Points of a predicted border.
const BORDER_POINTS: usize = 96;
/// How often the gap between two of these points is halved where a border falls steeply.
const MAX_HALVINGS: usize = 6;
/// The most and the least steps for which a run is watched.
const WATCHED_STEPS: [usize; 2] = [600, 200];
/// The approximate limit of the link forces evaluated for a map: ten seconds of work.
const MAX_LINK_FORCES: usize = 1_500_000_000;
/// The approximate number of runs that go through all their steps.
const FULL_RUNS: usize = VALUES_PER_AXIS * (VALUES_PER_AXIS / 2 + 3);
/// Cells an edge of the cube that stands in for a body whose map would be too much work.
const STAND_IN_CELLS: u32 = 5;

/// The body whose stability is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StabilityOf {
    /// One that was chosen.
    Chosen(BodyId),
    /// The one that limits the step most.
    Limiting,
}

/// What is shown of a body's stability: the plane of its stiffness and damping per unit mass.
#[derive(Clone, Debug)]
pub struct StabilityShown {
    /// What was asked for.
    pub of: StabilityOf,
    /// The plane; none where there is no body.
    pub plane: Option<PlaneShown>,
}

/// The plane of a body.
#[derive(Clone, Debug)]
pub struct PlaneShown {
    /// The body.
    pub body: BodyId,
    /// The place of its present values.
    pub now: Place,
    /// The largest stiffness that is stable at rest, for rising damping; empty where every step is stable.
    pub border: Vec<Place>,
    /// The same with the margin that automatic stepping keeps.
    pub safe: Vec<Place>,
    /// The powers of ten at which the axes begin and end: damping, stiffness.
    pub decades: [[i32; 2]; 2],
    plane: Arc<StabilityPlane>,
    lattice: Arc<Lattice>,
}

impl PartialEq for StabilityShown {
    fn eq(&self, other: &Self) -> bool {
        self.of == other.of && self.plane == other.plane
    }
}

impl PartialEq for PlaneShown {
    fn eq(&self, other: &Self) -> bool {
        // What is shown follows from the plane, which is made anew for every change.
        self.body == other.body && Arc::ptr_eq(&self.plane, &other.plane)
    }
}

/// Which side of its borders a place is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Zone {
    /// Stable, with the margin that automatic stepping keeps.
    Safe,
    /// Stable at rest, without the margin.
    Stable,
    /// Vibrations grow.
    Unstable,
}

impl StabilityShown {
    /// Shows a body of a scene whose bodies were compiled to `models`. If the body was shown `before` with the same lattice,
    /// the axes stay those of the same family of springs until the values of another family change, so that the dot follows
    /// its slider and never jumps.
    pub(super) fn of_body(
        of: StabilityOf,
        scene: &Scene,
        models: &[BodyModel<f32>],
        before: Option<&PlaneShown>,
    ) -> Self {
        let plane_of = |index: usize| {
            let model = models.get(index)?;
            let same = before.filter(|before| before.body.0 == index && Arc::ptr_eq(&before.lattice, &model.lattice));
            let family = same.and_then(|before| before.plane.family_after(&scene.bodies[index].material));
            Some((index, plane(scene, index, model, family)))
        };
        let chosen = match of {
            StabilityOf::Chosen(id) if id.0 < scene.bodies.len() => plane_of(id.0),
            _ => {
                let planes = (0..scene.bodies.len()).filter_map(plane_of);
                planes.max_by(|(_, a), (_, b)| a.load().total_cmp(&b.load()))
            }
        };
        let shown =
            chosen.map(|(index, plane)| PlaneShown::new(BodyId(index), plane, Arc::clone(&models[index].lattice)));
        Self { of, plane: shown }
    }
}

fn plane(scene: &Scene, index: usize, model: &BodyModel<f32>, family: Option<Family>) -> StabilityPlane {
    StabilityPlane::of(&scene.bodies[index], model, StepSettings::of(scene), family)
}

impl PlaneShown {
    fn new(body: BodyId, plane: StabilityPlane, lattice: Arc<Lattice>) -> Self {
        let (now, ends) = (plane.place(), plane.ends());
        let decades = decades(now, ends);
        let [[from, to], _] = decades.map(|ends| ends.map(f64::from));
        let (mut border, mut safe) = (Vec::new(), Vec::new());
        if ends.is_some() {
            let both = |damping| [plane.stable_stiffness(damping), plane.safe_stiffness(damping)];
            let least = libm::pow(10.0, f64::from(decades[1][0]));
            for (damping, [stable, margin]) in refine_where_steep(values([from, to], BORDER_POINTS), least, both) {
                border.push(Place { damping, stiffness: stable });
                safe.push(Place { damping, stiffness: margin });
            }
        }
        Self { body, now, border, safe, decades, plane: Arc::new(plane), lattice }
    }

    /// The step settings that the plane is computed for.
    pub fn step(&self) -> StepSettings {
        self.plane.step()
    }

    /// The family of springs whose values the axes show; none for a solid.
    pub fn family(&self) -> Option<Family> {
        self.plane.family()
    }

    /// The family of springs that limits the step most; none for a solid.
    pub fn limiting_family(&self) -> Option<Family> {
        self.plane.limiting_family()
    }

    /// Returns the body with the values of a place, as near as the ranges of its parameters allow.
    pub fn moved(&self, body: &Body, to: Place) -> Body {
        Body { material: self.plane.material_at(to), ..body.clone() }
    }

    /// Which side of the borders a place is on.
    pub fn zone(&self, at: Place) -> Zone {
        if at.stiffness <= self.plane.safe_stiffness(at.damping) {
            Zone::Safe
        } else if at.stiffness <= self.plane.stable_stiffness(at.damping) {
            Zone::Stable
        } else {
            Zone::Unstable
        }
    }
}

/// Computes two borders at these values, and at more values where one of them falls steeply above the least value that is
/// shown.
fn refine_where_steep(across: Vec<f64>, least: f64, of: impl Fn(f64) -> [f64; 2]) -> Vec<(f64, [f64; 2])> {
    let at = |x: f64| (x, of(x));
    let mut points: Vec<(f64, [f64; 2])> = across.into_iter().map(at).collect();
    for _ in 0..MAX_HALVINGS {
        let mut closer = Vec::with_capacity(2 * points.len());
        for pair in points.windows(2) {
            let [(from, before), (to, after)] = [pair[0], pair[1]];
            let falls = |border: usize| before[border].max(least) > STEEP_RATIO * after[border].max(least);
            closer.push(pair[0]);
            closer.extend((falls(0) || falls(1)).then(|| at(libm::sqrt(from * to))));
        }
        closer.extend(points.last());
        points = closer;
    }
    points
}

/// Returns the whole decades around the end of the border and the place, on both axes.
fn decades(now: Place, ends: Option<Place>) -> [[i32; 2]; 2] {
    let of = |now: f64, end: Option<f64>| {
        let now = (now > 0.0).then(|| libm::log10(now));
        let end = end.map(libm::log10).or(now).unwrap_or(0.0);
        let low = now.map_or(f64::INFINITY, |now| now - 0.2).min(end - DECADES_BELOW);
        let high = now.map_or(f64::NEG_INFINITY, |now| now + 0.2).max(end + DECADES_ABOVE);
        #[expect(clippy::cast_possible_truncation, reason = "exponents of ten")]
        [libm::floor(low) as i32, libm::ceil(high) as i32]
    };
    [of(now.damping, ends.map(|ends| ends.damping)), of(now.stiffness, ends.map(|ends| ends.stiffness))]
}

/// A map that was measured.
#[derive(Clone, Debug)]
pub struct StabilityMap {
    /// The body, without the values on the axes.
    body: Body,
    id: BodyId,
    step: StepSettings,
    family: Option<Family>,
    /// The damping of every column, per unit mass, rising.
    pub damping: Vec<f64>,
    /// The stiffness of every row, per unit mass, rising.
    pub stiffness: Vec<f64>,
    /// The outcome of every column.
    pub columns: Vec<Survival>,
    /// The measured border, with rising damping.
    pub border: Vec<Place>,
    /// Steps for which each run was watched.
    pub watched: usize,
    /// Cells an edge of the cube that stood in for the body; none where it was the body itself.
    pub stand_in: Option<u32>,
}

impl StabilityMap {
    /// Whether it was measured for the plane that is shown, whatever the present values on its axes are.
    pub fn is_of(&self, scene: &Scene, shown: &PlaneShown) -> bool {
        let body = scene.bodies.get(shown.body.0);
        (self.id, self.step, self.family) == (shown.body, shown.step(), shown.family())
            && body.is_some_and(|body| self.body == without_values(body, shown.family()))
    }
}

/// Returns a body with fixed values on the axes of its plane, and the default name, place and looks.
fn without_values(body: &Body, family: Option<Family>) -> Body {
    let material = match (&body.material, family) {
        (Material::Springs(springs), Some(family)) => {
            let mut springs = *springs;
            *springs.family_mut(family) = Spring { stiffness: 0.0, damping: 0.0 };
            Material::Springs(springs)
        }
        (Material::Solid(solid), _) => Material::Solid(Solid { young_modulus: 1.0, damping_ratio: 0.0, ..*solid }),
        (material, None) => material.clone(),
    };
    let Body { shape, inlays, parts, pins, pinned_cells, .. } = body.clone();
    Body { shape, material, inlays, parts, pins, pinned_cells, ..Body::default() }
}

/// What a map is measured of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MapOf {
    /// The body.
    pub body: StabilityOf,
    /// The family of springs on the axes; none for a solid, or for the family that limits the step most.
    pub family: Option<Family>,
}

/// Measures the map of a body of a scene; relative model paths start at `base_dir`. `pause` is called between two steps, so
/// that a caller can leave the processors to others.
pub fn stability_map(
    scene: &Scene,
    base_dir: &Path,
    of: MapOf,
    progress: &Progress,
    pause: &(dyn Fn() + Sync),
) -> Result<StabilityMap, BackgroundError> {
    let watch = PausingWatch { progress, pause };
    let opened = Opened::without_file(scene.clone(), String::new(), base_dir.to_owned());
    let lattices = opened.lattices(&CancelOnly(&watch))?;
    let simulation = Simulation::new(scene, &lattices);
    let models = &simulation.model().bodies;
    let shown = StabilityShown::of_body(of.body, scene, models, None).plane;
    let mut shown = shown.ok_or(BackgroundError::NotPossible("the scene has no body"))?;
    let index = shown.body.0;
    if of.family.is_some() && of.family != shown.family() {
        shown = PlaneShown::new(shown.body, plane(scene, index, &models[index], of.family), shown.lattice);
    }
    if shown.border.is_empty() {
        return Err(BackgroundError::NotPossible("every step of this scheme is stable: there is no border"));
    }
    let mut subject = Subject::new(scene, index, Arc::clone(&lattices[index]));
    if subject.steps < WATCHED_STEPS[1] {
        subject = subject.stand_in(scene)?;
    }
    let of_own = Simulation::new(&subject.scene, &subject.lattices);
    let own = plane(&subject.scene, 0, &of_own.model().bodies[0], shown.family());
    let material = |damping: f64, stiffness: f64| own.material_at(Place { damping, stiffness });
    let trial = StabilityTrial {
        scene: &subject.scene,
        lattices: &subject.lattices,
        material: &material,
        steps: subject.steps.clamp(WATCHED_STEPS[1], WATCHED_STEPS[0]),
    };
    let [damping, stiffness] = shown.decades.map(|ends| values(ends.map(f64::from), VALUES_PER_AXIS));
    let column = |(index, damping): (usize, &f64)| {
        let span = [index, index + 1].map(|column| column as f64 / VALUES_PER_AXIS as f64);
        trial.survival(*damping, &stiffness, &Portion::new(&watch, span))
    };
    let columns: Option<Vec<_>> = damping.iter().enumerate().map(column).collect();
    let columns = columns.ok_or(BackgroundError::Cancelled)?;
    let border = border(&trial, &columns, [&damping, &stiffness], &watch);
    if watch.cancelled() {
        return Err(BackgroundError::Cancelled);
    }
    Ok(StabilityMap {
        body: without_values(&scene.bodies[index], shown.family()),
        id: shown.body,
        step: shown.step(),
        family: shown.family(),
        watched: trial.steps,
        columns,
        border,
        damping,
        stiffness,
        stand_in: subject.stand_in,
    })
}

/// Traces the border through the results of the columns, and refines it between them where it is steep or falls off the map.
fn border(
    trial: &StabilityTrial<'_>,
    columns: &[Survival],
    [damping, stiffness]: [&[f64]; 2],
    watch: &dyn Watch,
) -> Vec<Place> {
    let middle = |[good, bad]: [f64; 2]| (good * bad).sqrt();
    let known =
        |(column, damping): (&Survival, &f64)| Some(Place { damping: *damping, stiffness: middle(column.border?) });
    let mut border: Vec<Place> = columns.iter().zip(damping).filter_map(known).collect();
    let stays = |column: &Survival| column.survived.first() == Some(&trial.steps);
    let falls = (1..columns.len()).find(|&index| stays(&columns[index - 1]) && !stays(&columns[index]));
    let watch = CancelOnly(watch);
    if let (Some(index), Some(&low)) = (falls, stiffness.first()) {
        let end = middle(trial.damping_border([damping[index - 1], damping[index]], low, &watch));
        border.push(Place { damping: end, stiffness: low });
    }
    for _ in 0..MAX_REFINED_PLACES {
        let fall = |index: &usize| border[index - 1].stiffness / border[*index].stiffness;
        let steepest = (1..border.len()).max_by(|a, b| fall(a).total_cmp(&fall(b)));
        let Some(index) = steepest.filter(|index| fall(index) > STEEP_RATIO) else { break };
        let [above, below] = [border[index - 1], border[index]];
        let damping = middle([above.damping, below.damping]);
        let ends = [0.9 * below.stiffness, 1.1 * above.stiffness];
        border.insert(index, Place { damping, stiffness: middle(trial.stiffness_border(damping, ends, &watch)) });
    }
    border
}

/// The body that is tried, alone in a scene.
struct Subject {
    scene: Scene,
    lattices: Vec<Arc<Lattice>>,
    /// The steps that the allowed work is enough for.
    steps: usize,
    stand_in: Option<u32>,
}

impl Subject {
    fn new(scene: &Scene, index: usize, lattice: Arc<Lattice>) -> Self {
        let mut own = isolated_bodies(scene);
        own.bodies = vec![own.bodies.swap_remove(index)];
        let evaluations = match scene.settings.integrator {
            Integrator::Rk2 => 2,
            Integrator::Rk4 | Integrator::Stabilised => 4,
            _ => 1,
        };
        let work_of_a_step = lattice.counts().all_links().max(1) * evaluations * FULL_RUNS;
        let steps = MAX_LINK_FORCES / work_of_a_step;
        Self { scene: own, lattices: vec![lattice], steps, stand_in: None }
    }

    /// Replaces the body by a small cube of the same cells and material, which has the same bound.
    fn stand_in(mut self, scene: &Scene) -> Result<Self, BackgroundError> {
        let size = self.lattices[0].grid.cell_size * f64::from(STAND_IN_CELLS);
        let mut cube = scene.clone();
        cube.bodies = vec![self.scene.bodies.swap_remove(0)];
        cube.bodies[0].shape = Shape::Cube(CubeShape { cells: STAND_IN_CELLS, size });
        let Body { pins, pinned_cells, inlays, parts, .. } = &mut cube.bodies[0];
        pins.clear();
        pinned_cells.clear();
        inlays.clear();
        parts.clear();
        let opened = Opened::without_file(cube.clone(), String::new(), std::path::PathBuf::new());
        let lattice = opened.lattices(&())?.swap_remove(0);
        Ok(Self { stand_in: Some(STAND_IN_CELLS), ..Self::new(&cube, 0, lattice) })
    }
}

#[cfg(test)]
mod tests;
