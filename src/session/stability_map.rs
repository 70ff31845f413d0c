//! Where the step of a scene is stable over the stiffness and damping of one body: predicted at once, while someone looks,
//! and measured when a person asks for it (R2). The measurement works on the caller's thread; it tells how far it is and
//! stops through [`Progress`].

use std::path::Path;
use std::sync::Arc;

use super::background::{BackgroundError, Paced};
use super::document::Opened;
use super::progress::Progress;
use crate::geometry::watch::{CancelOnly, Portion};
use crate::geometry::{Lattice, Watch};
use crate::physics::{BodyModel, Simulation, StabilityPlane};
pub use crate::physics::{Place, StepSettings};
use crate::report::stability::limit::alone;
use crate::report::stability::map::{Survival, Tried, values};
use crate::scene::body::CubeShape;
use crate::scene::edit::BodyId;
use crate::scene::material::{Solid, Spring};
use crate::scene::settings::Integrator;
use crate::scene::{Body, Family, Material, Scene, Shape};

/// Values along each axis that are measured.
const VALUES: usize = 13;
/// Powers of ten that are shown below the end of the border on each axis, and above it.
const BELOW: f64 = 2.3;
const ABOVE: f64 = 0.6;
/// Places of the border that are looked for between columns at most, where it falls by more than this many times.
const MOST_BETWEEN: usize = 6;
const STEEP: f64 = 2.0;
/// Points of a border that is predicted.
const POINTS: usize = 96;
/// How often the way between two of them is halved where a border falls steeply.
const HALVINGS: usize = 6;
/// Steps that are watched, at most and at least.
const STEPS: [usize; 2] = [600, 200];
/// Link forces that are spent on a map at most, about: ten seconds of work.
const MOST_LINK_FORCES: usize = 1_500_000_000;
/// Runs that go through all their steps, about.
const WHOLE_RUNS: usize = VALUES * (VALUES / 2 + 3);
/// Cells an edge of the cube that stands in for a body whose map would be too much work.
const STAND_IN_CELLS: u32 = 5;

/// Which body is looked at.
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
    /// Where it stands.
    pub now: Place,
    /// The largest stiffness that is stable at rest over the damping; empty where every step is stable.
    pub border: Vec<Place>,
    /// The same with the margin that automatic stepping keeps.
    pub safe: Vec<Place>,
    /// From which power of ten to which the axes go: damping, stiffness.
    pub decades: [[i32; 2]; 2],
    plane: Arc<StabilityPlane>,
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
    /// Of a body of a scene whose bodies were compiled to `models`.
    pub(super) fn of_body(of: StabilityOf, scene: &Scene, models: &[BodyModel<f32>]) -> Self {
        let plane_of = |index: usize| Some((index, plane(scene, index, models.get(index)?)));
        let chosen = match of {
            StabilityOf::Chosen(id) if id.0 < scene.bodies.len() => plane_of(id.0),
            _ => {
                let planes = (0..scene.bodies.len()).filter_map(plane_of);
                planes.max_by(|(_, a), (_, b)| a.load().total_cmp(&b.load()))
            }
        };
        Self { of, plane: chosen.map(|(index, plane)| PlaneShown::new(BodyId(index), plane)) }
    }
}

fn plane(scene: &Scene, index: usize, model: &BodyModel<f32>) -> StabilityPlane {
    StabilityPlane::of(&scene.bodies[index], model, StepSettings::of(scene))
}

impl PlaneShown {
    fn new(body: BodyId, plane: StabilityPlane) -> Self {
        let (now, ends) = (plane.place(), plane.ends());
        let decades = decades(now, ends);
        let [[from, to], _] = decades.map(|ends| ends.map(f64::from));
        let (mut border, mut safe) = (Vec::new(), Vec::new());
        if ends.is_some() {
            let both = |damping| [plane.stable_stiffness(damping), plane.safe_stiffness(damping)];
            let least = libm::pow(10.0, f64::from(decades[1][0]));
            for (damping, [stable, margin]) in closer_where_steep(values([from, to], POINTS), least, both) {
                border.push(Place { damping, stiffness: stable });
                safe.push(Place { damping, stiffness: margin });
            }
        }
        Self { body, now, border, safe, decades, plane: Arc::new(plane) }
    }

    /// The step that is looked at.
    pub fn step(&self) -> StepSettings {
        self.plane.step()
    }

    /// The family of springs whose values the axes are; none of a solid.
    pub fn family(&self) -> Option<Family> {
        self.plane.family()
    }

    /// The body with the values of a place, as near as its parameters go.
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

/// Two borders at these values and at more between them where one falls steeply above the least value that is shown.
fn closer_where_steep(across: Vec<f64>, least: f64, of: impl Fn(f64) -> [f64; 2]) -> Vec<(f64, [f64; 2])> {
    let at = |x: f64| (x, of(x));
    let mut points: Vec<(f64, [f64; 2])> = across.into_iter().map(at).collect();
    for _ in 0..HALVINGS {
        let mut closer = Vec::with_capacity(2 * points.len());
        for pair in points.windows(2) {
            let [(from, before), (to, after)] = [pair[0], pair[1]];
            let falls = |border: usize| before[border].max(least) > STEEP * after[border].max(least);
            closer.push(pair[0]);
            closer.extend((falls(0) || falls(1)).then(|| at(libm::sqrt(from * to))));
        }
        closer.extend(points.last());
        points = closer;
    }
    points
}

/// Whole decades around the end of the border and the place, on both axes.
fn decades(now: Place, ends: Option<Place>) -> [[i32; 2]; 2] {
    let of = |now: f64, end: Option<f64>| {
        let now = (now > 0.0).then(|| libm::log10(now));
        let end = end.map(libm::log10).or(now).unwrap_or(0.0);
        let low = now.map_or(f64::INFINITY, |now| now - 0.2).min(end - BELOW);
        let high = now.map_or(f64::NEG_INFINITY, |now| now + 0.2).max(end + ABOVE);
        #[expect(clippy::cast_possible_truncation, reason = "exponents of ten")]
        [libm::floor(low) as i32, libm::ceil(high) as i32]
    };
    [of(now.damping, ends.map(|ends| ends.damping)), of(now.stiffness, ends.map(|ends| ends.stiffness))]
}

/// A map that was measured.
#[derive(Clone, Debug)]
pub struct StabilityMap {
    /// The body, but for the values of the axes.
    body: Body,
    id: BodyId,
    step: StepSettings,
    family: Option<Family>,
    /// The damping of every column and the stiffness of every row, per unit mass.
    pub damping: Vec<f64>,
    /// Rising.
    pub stiffness: Vec<f64>,
    /// What became of every column.
    pub columns: Vec<Survival>,
    /// The border that was measured, the damping rising.
    pub border: Vec<Place>,
    /// Steps that each was watched for.
    pub watched: usize,
    /// Cells an edge of the cube that stood in for the body; none where it was the body itself.
    pub stand_in: Option<u32>,
}

impl StabilityMap {
    /// Whether it was measured for what is shown, whatever the values of its axes are now.
    pub fn is_of(&self, scene: &Scene, shown: &PlaneShown) -> bool {
        let body = scene.bodies.get(shown.body.0);
        (self.id, self.step, self.family) == (shown.body, shown.step(), shown.family())
            && body.is_some_and(|body| self.body == without_values(body, shown.family()))
    }
}

/// A body with one and the same values on the axes of its plane, name, place and looks.
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
    let Body { shape, inlays, pins, .. } = body.clone();
    Body { shape, material, inlays, pins, ..Body::default() }
}

/// Measures the map of a body of a scene; relative model paths start at `base_dir`. `pause` is called between two steps,
/// for who leaves the processors to others.
pub fn stability_map(
    scene: &Scene,
    base_dir: &Path,
    of: StabilityOf,
    progress: &Progress,
    pause: &(dyn Fn() + Sync),
) -> Result<StabilityMap, BackgroundError> {
    let watch = Paced { progress, pause };
    let opened = Opened::without_file(scene.clone(), String::new(), base_dir.to_owned());
    let lattices = opened.lattices(&CancelOnly(&watch))?;
    let simulation = Simulation::new(scene, &lattices);
    let shown = StabilityShown::of_body(of, scene, &simulation.model().bodies).plane;
    let shown = shown.ok_or(BackgroundError::Nothing("the scene has no body"))?;
    if shown.border.is_empty() {
        return Err(BackgroundError::Nothing("every step of this scheme is stable: there is no border"));
    }
    let index = shown.body.0;
    let mut subject = Subject::new(scene, index, Arc::clone(&lattices[index]));
    if subject.steps < STEPS[1] {
        subject = subject.stand_in(scene)?;
    }
    let own = plane(&subject.scene, 0, &Simulation::new(&subject.scene, &subject.lattices).model().bodies[0]);
    let material = |damping: f64, stiffness: f64| own.material_at(Place { damping, stiffness });
    let tried = Tried {
        scene: &subject.scene,
        lattices: &subject.lattices,
        material: &material,
        steps: subject.steps.clamp(STEPS[1], STEPS[0]),
    };
    let [damping, stiffness] = shown.decades.map(|ends| values(ends.map(f64::from), VALUES));
    let column = |(index, damping): (usize, &f64)| {
        let span = [index, index + 1].map(|column| column as f64 / VALUES as f64);
        tried.survival(*damping, &stiffness, &Portion::new(&watch, span))
    };
    let columns: Option<Vec<_>> = damping.iter().enumerate().map(column).collect();
    let columns = columns.ok_or(BackgroundError::Cancelled)?;
    let border = border(&tried, &columns, [&damping, &stiffness], &watch);
    if watch.cancelled() {
        return Err(BackgroundError::Cancelled);
    }
    Ok(StabilityMap {
        body: without_values(&scene.bodies[index], shown.family()),
        id: shown.body,
        step: shown.step(),
        family: shown.family(),
        watched: tried.steps,
        columns,
        border,
        damping,
        stiffness,
        stand_in: subject.stand_in,
    })
}

/// The border through what is known of the columns, and between them where it falls off the map.
fn border(tried: &Tried<'_>, columns: &[Survival], [damping, stiffness]: [&[f64]; 2], watch: &dyn Watch) -> Vec<Place> {
    let middle = |[good, bad]: [f64; 2]| (good * bad).sqrt();
    let known =
        |(column, damping): (&Survival, &f64)| Some(Place { damping: *damping, stiffness: middle(column.border?) });
    let mut border: Vec<Place> = columns.iter().zip(damping).filter_map(known).collect();
    let stays = |column: &Survival| column.survived.first() == Some(&tried.steps);
    let falls = (1..columns.len()).find(|&index| stays(&columns[index - 1]) && !stays(&columns[index]));
    let watch = CancelOnly(watch);
    if let (Some(index), Some(&low)) = (falls, stiffness.first()) {
        let end = middle(tried.damping_border([damping[index - 1], damping[index]], low, &watch));
        border.push(Place { damping: end, stiffness: low });
    }
    for _ in 0..MOST_BETWEEN {
        let fall = |index: &usize| border[index - 1].stiffness / border[*index].stiffness;
        let steepest = (1..border.len()).max_by(|a, b| fall(a).total_cmp(&fall(b)));
        let Some(index) = steepest.filter(|index| fall(index) > STEEP) else { break };
        let [above, below] = [border[index - 1], border[index]];
        let damping = middle([above.damping, below.damping]);
        let ends = [0.9 * below.stiffness, 1.1 * above.stiffness];
        border.insert(index, Place { damping, stiffness: middle(tried.stiffness_border(damping, ends, &watch)) });
    }
    border
}

/// The body that is tried, by itself.
struct Subject {
    scene: Scene,
    lattices: Vec<Arc<Lattice>>,
    /// Steps that there is work for.
    steps: usize,
    stand_in: Option<u32>,
}

impl Subject {
    fn new(scene: &Scene, index: usize, lattice: Arc<Lattice>) -> Self {
        let mut own = alone(scene);
        own.bodies = vec![own.bodies.swap_remove(index)];
        let evaluations = match scene.settings.integrator {
            Integrator::Rk2 => 2,
            Integrator::Rk4 => 4,
            _ => 1,
        };
        let work_of_a_step = lattice.counts().all_links().max(1) * evaluations * WHOLE_RUNS;
        let steps = MOST_LINK_FORCES / work_of_a_step;
        Self { scene: own, lattices: vec![lattice], steps, stand_in: None }
    }

    /// A small cube of the same cells and material, which has the same bound.
    fn stand_in(mut self, scene: &Scene) -> Result<Self, BackgroundError> {
        let size = self.lattices[0].grid.cell_size * f64::from(STAND_IN_CELLS);
        let mut cube = scene.clone();
        cube.bodies = vec![self.scene.bodies.swap_remove(0)];
        cube.bodies[0].shape = Shape::Cube(CubeShape { cells: STAND_IN_CELLS, size });
        (cube.bodies[0].pins, cube.bodies[0].inlays) = (Vec::new(), Vec::new());
        let opened = Opened::without_file(cube.clone(), String::new(), std::path::PathBuf::new());
        let lattice = opened.lattices(&())?.swap_remove(0);
        Ok(Self { stand_in: Some(STAND_IN_CELLS), ..Self::new(&cube, 0, lattice) })
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::scene::edit::Edit;
    use crate::scene::presets;
    use crate::session::{Command, Session};

    fn scene() -> Scene {
        let mut scene = (presets::preset("cube-on-plane").expect("a preset").build)();
        scene.bodies[0].shape = Shape::Cube(CubeShape { cells: 3, size: 1.0 });
        scene
    }

    fn watched(scene: &Scene) -> Session {
        let mut session = Session::new(scene.clone(), PathBuf::new(), "test".into()).expect("it resolves");
        session.handle(Command::WatchStability(Some(StabilityOf::Limiting))).expect("it looks");
        session
    }

    fn shown(session: &Session) -> PlaneShown {
        session.status().stability.and_then(|shown| shown.plane.clone()).expect("a body is looked at")
    }

    fn measured(scene: &Scene) -> StabilityMap {
        stability_map(scene, Path::new(""), StabilityOf::Limiting, &Progress::default(), &|| ()).expect("a map")
    }

    /// How often what is predicted to be stable blew up, and stable places in all.
    fn broken_promises(map: &StabilityMap, border: impl Fn(f64) -> f64) -> [usize; 2] {
        let mut found = [0, 0];
        for (column, &damping) in map.columns.iter().zip(&map.damping) {
            for (&survived, &stiffness) in column.survived.iter().zip(&map.stiffness) {
                if stiffness <= border(damping) {
                    found[0] += usize::from(survived < map.watched);
                    found[1] += 1;
                }
            }
        }
        found
    }

    #[test]
    fn what_is_predicted_to_be_stable_stays_and_a_border_that_promises_too_much_is_found_out() {
        let scene = scene();
        let map = measured(&scene);
        let plane = shown(&watched(&scene)).plane;
        let [broken, stable] = broken_promises(&map, |damping| plane.stable_stiffness(damping));
        assert!(broken == 0 && stable > 20, "{broken} of {stable}");
        let [broken, _] = broken_promises(&map, |damping| 6.0 * plane.stable_stiffness(damping));
        assert!(broken > 0, "six times the stiffness is not stable");
        let nearest = map
            .border
            .iter()
            .take_while(|at| at.stiffness > map.stiffness[1])
            .map(|at| plane.stable_stiffness(at.damping) / at.stiffness)
            .fold(0.0, f64::max);
        assert!((0.5..=1.0).contains(&nearest), "the borders come near each other: {nearest}");
    }

    #[test]
    fn an_edit_moves_the_dot_and_a_map_stays_that_of_its_scene() {
        let scene = scene();
        let mut session = watched(&scene);
        let (before, map) = (shown(&session), measured(&scene));
        assert!(map.is_of(&scene, &before), "just measured");
        let wanted = Place { damping: 2.0 * before.now.damping, stiffness: 0.5 * before.now.stiffness };
        let moved = before.moved(&scene.bodies[0], wanted);
        session.handle(Command::Edit(Edit::Body(BodyId(0), Box::new(moved)))).expect("it is moved");
        let after = shown(&session);
        assert!((after.now.stiffness / wanted.stiffness - 1.0).abs() < 1e-9, "{:?} for {wanted:?}", after.now);
        assert!(map.is_of(session.scene(), &after), "whatever the values of the axes");
        let mut other = session.scene().clone();
        other.settings.dt *= 2.0;
        assert!(!map.is_of(&other, &shown(&watched(&other))), "of another step");
        session.handle(Command::WatchStability(None)).expect("it looks away");
        assert!(session.status().stability.is_none(), "nobody looks");
    }

    #[test]
    fn a_large_body_is_measured_on_a_small_cube_of_its_cells() {
        let mut large = scene();
        large.bodies[0].shape = Shape::Cube(CubeShape { cells: 24, size: 1.0 });
        let lattice = crate::report::extremes::lattices(&large).expect("a cube").swap_remove(0);
        let cell_m = lattice.grid.cell_size;
        let subject = Subject::new(&large, 0, lattice);
        assert!(subject.steps < STEPS[1], "too much work: {} steps", subject.steps);
        let cube = subject.stand_in(&large).expect("a cube");
        assert!(cube.steps > STEPS[1] && cube.stand_in == Some(5), "{} steps", cube.steps);
        assert!((cube.lattices[0].grid.cell_size - cell_m).abs() < 1e-12, "the same cells");
    }

    #[test]
    fn what_has_no_border_is_refused_in_words() {
        let refused = |scene: &Scene| {
            let map = stability_map(scene, Path::new(""), StabilityOf::Limiting, &Progress::default(), &|| ());
            map.expect_err("nothing to measure").to_string()
        };
        assert_eq!(refused(&Scene::default()), "the scene has no body");
        let mut implicit = scene();
        implicit.settings.integrator = Integrator::Implicit;
        assert!(refused(&implicit).contains("every step of this scheme is stable"), "the implicit scheme");
        let progress = Progress::default();
        progress.cancel();
        let cancelled = stability_map(&scene(), Path::new(""), StabilityOf::Limiting, &progress, &|| ());
        assert!(matches!(cancelled, Err(BackgroundError::Cancelled | BackgroundError::Session(_))), "{cancelled:?}");
    }

    #[test]
    fn a_border_is_looked_at_closely_where_it_falls_and_only_there() {
        // It falls to nothing at 2, as those of a damping that is too large do.
        let border = |x: f64| [(4.0 - x * x).max(0.0), 1.0];
        let points = closer_where_steep(vec![0.5, 1.0, 3.0], 1e-3, border);
        let far = |pair: &[(f64, [f64; 2])]| pair[1].0 / pair[0].0;
        let falls = points.windows(2).filter(|pair| pair[0].1[0] > 2.0 * pair[1].1[0].max(1e-3));
        let widest = falls.map(far).fold(1.0, f64::max);
        assert!(widest < 1.05, "the fall is seen to {widest}");
        assert!((far(&points[..2]) - 2.0).abs() < 1e-9 && points.len() < 20, "and nothing else: {}", points.len());
    }
}
