//! Which points of a modal body meet which obstacles within a substep, and what their springs have to do.

use glam::{DMat3, DVec3};

use super::motion::{MARGIN, Motion, Way, sum};
use super::oscillator::Oscillator;
use crate::math::{Aabb, Real, Vector};
use crate::physics::contact::{GENTLE_SHARE, Known, Placed, Surface, Swept, met_side};
use crate::physics::model::plan::{Plan, Stage};
use crate::physics::model::{Model, ObstacleModel, ObstacleShape};
use crate::physics::report::Recorder;
use crate::physics::state::touch::SampleTouch;

/// The most contacts of a held body that are solved for at once: where there are more, the deepest ones.
const MOST: usize = 256;

/// The same of a free body, which may lie on all of a side: where more of its points meet something, as many groups of
/// neighbours, each by its deepest point.
const MOST_GROUPS: usize = 64;

/// Contacts of a free body are damped by no less of the critical damping, so that it comes to rest.
const LEAST_DAMPING: f64 = 0.05;

/// A mode moves a point by less than rounding where its mobility is below this, 1/kg.
const HELD: f64 = 1e-12;

/// A point at an obstacle. All in the body's coordinates.
#[derive(Clone, Debug)]
pub(super) struct ModalContact {
    /// Unit normal, away from the obstacle.
    pub(super) normal: DVec3,
    /// The velocity of the surface, m/s.
    surface: DVec3,
    /// How deep the point is at the end of the substep without what pushes, m.
    depth: f64,
    /// How fast it is past the surface then, m/s; of a free body, on the whole.
    pub(super) past: DVec3,
    /// N/m and N·s/m.
    stiffness: f64,
    damping: f64,
    /// Of the point along the normal and across it, 1/kg.
    mobility: [f64; 2],
    /// Coulomb's coefficients, at rest and sliding.
    friction: [f64; 2],
    /// What it is pushed out with at most, m/s.
    gentle: f64,
    /// The impulse so far along the normal, N·s, and across it.
    pushed: f64,
    rubbed: DVec3,
}

impl ModalContact {
    /// Does what all others leave it to do, which change the point's speed by `change` (m/s). Tells the change of its impulse,
    /// N·s.
    pub(super) fn solve(&mut self, change: DVec3, dt: f64) -> DVec3 {
        let past = self.past + change;
        let [along, across] = self.mobility;
        let speed = past.dot(self.normal);
        // Without what it does itself.
        let alone = speed - along * self.pushed;
        let depth = self.depth - dt * (change.dot(self.normal) - along * self.pushed);
        let resistance = dt * (dt * self.stiffness + self.damping);
        let sprung = dt * (self.stiffness * depth - self.damping * alone) / (1.0 + resistance * along);
        let pushed = if depth > 0.0 { sprung.min((self.gentle - alone) / along).max(0.0) } else { 0.0 };
        let mut impulse = self.normal * (pushed - self.pushed);
        self.pushed = pushed;
        if self.friction[0] > 0.0 && across > HELD {
            let wanted = self.rubbed - (past - self.normal * speed) / across;
            let strength = wanted.length();
            let held = strength <= self.friction[0] * pushed;
            let most = if held { strength } else { (self.friction[1] * pushed).min(strength) };
            let rubbed = if strength > 0.0 { wanted * (most / strength) } else { DVec3::ZERO };
            impulse += rubbed - self.rubbed;
            self.rubbed = rubbed;
        }
        impulse
    }
}

/// What a body meets in a substep, and room to find it in.
#[derive(Clone, Debug, Default)]
pub(super) struct ModalContacts {
    all: Vec<ModalContact>,
    /// How each of their points moves by the modes, one after another.
    rows: Vec<DVec3>,
    modes: usize,
    row: Vec<DVec3>,
    known: Vec<Known>,
    most: usize,
    /// All that points of a free body meet.
    candidates: Vec<Candidate>,
    touches: Vec<SampleTouch>,
}

impl ModalContacts {
    /// Room for so many, of a body of so many modes, among so many meshes, of which free bodies remember so many.
    pub(super) fn new(points: usize, modes: usize, meshes: usize, touches: usize) -> Self {
        let most = points.min(MOST);
        Self {
            all: Vec::with_capacity(most),
            rows: Vec::with_capacity(most * modes),
            modes,
            row: vec![DVec3::ZERO; modes],
            known: vec![Known::default(); meshes],
            most,
            candidates: Vec::with_capacity(touches),
            touches: Vec::with_capacity(touches),
        }
    }

    /// Forgets what they did.
    pub(super) fn reset(&mut self) {
        self.all.iter_mut().for_each(|contact| (contact.pushed, contact.rubbed) = (0.0, DVec3::ZERO));
    }

    pub(super) fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// The contacts, each with how its point moves.
    pub(super) fn each(&mut self) -> impl Iterator<Item = (&mut ModalContact, &[DVec3])> {
        self.all.iter_mut().zip(self.rows.chunks_exact(self.modes.max(1)))
    }

    /// How many push.
    pub(super) fn pushing(&self) -> usize {
        self.all.iter().filter(|contact| contact.pushed > 0.0).count()
    }

    /// How deep the deepest is at the end of the substep, m.
    pub(super) fn deepest(&self, secs: f64, change: &[f64]) -> f64 {
        let rows = self.rows.chunks_exact(self.modes.max(1));
        let depths = self.all.iter().zip(rows).map(|(met, row)| met.depth - secs * sum(row, change).dot(met.normal));
        depths.fold(0.0, f64::max)
    }

    /// Counts what obstacles did.
    pub(super) fn count_work(&self, recorder: &mut Recorder<'_>) {
        for contact in &self.all {
            let impulse = contact.normal * contact.pushed + contact.rubbed;
            recorder.counters.obstacle_work_j += impulse.dot(contact.surface);
            recorder.counters.frictions += u64::from(contact.pushed > 0.0 && contact.friction[0] > 0.0);
            let fastest = &mut recorder.counters.fastest_surface_m_s;
            *fastest = fastest.max(contact.surface.length());
        }
    }

    /// Finds all that points of a body meet. `touches` are those of a free body that touched planes and open meshes before.
    pub(super) fn find<R: Real>(
        &mut self,
        motion: &Motion<'_, R>,
        model: &Model<R>,
        obstacles: &Placed<R>,
        touches: &[SampleTouch],
        plan: &Plan,
        recorder: &mut Recorder<'_>,
    ) {
        self.modes = motion.count();
        self.all.clear();
        self.rows.clear();
        self.candidates.clear();
        let points = &motion.modal.points;
        for number in 0..model.obstacles.len() {
            let obstacle = obstacles.met(motion.number, number);
            recorder.enter(Stage::BroadPhase);
            let before = recorder.counters.narrow_tests;
            let looks = each_near(motion, number, obstacle, touches, plan, |point, side| {
                recorder.counters.narrow_tests += 1;
                let Some(met) = self.meet(motion, obstacle, point, side) else { return };
                if motion.flight.is_none() {
                    self.constrain(motion, model, number, &met, 1.0);
                } else {
                    self.candidates.push(Candidate { point, side, obstacle: number, depth: met.depth(motion) });
                }
            });
            let tests = recorder.counters.narrow_tests - before;
            recorder.counters.narrow_tests_saved += (points.count() as u64).saturating_sub(tests);
            recorder.counters.modal_work += looks + tests;
        }
        let groups = self.candidates.len().min(MOST_GROUPS);
        for group in 0..groups {
            let [first, end] = [group, group + 1].map(|group| group * self.candidates.len() / groups);
            let deepest = self.candidates[first..end].iter().max_by(|one, other| one.depth.total_cmp(&other.depth));
            let Some(&Candidate { point, side, obstacle, .. }) = deepest else { continue };
            if let Some(met) = self.meet(motion, obstacles.met(motion.number, obstacle), point, side) {
                self.constrain(motion, model, obstacle, &met, (end - first) as f64);
            }
        }
    }

    /// Finds where points of a free body touch planes and open meshes in a motion, each on the side that it came from.
    pub(super) fn find_touches<R: Real>(
        &mut self,
        motion: &Motion<'_, R>,
        model: &Model<R>,
        obstacles: &Placed<R>,
        touches: &[SampleTouch],
        plan: &Plan,
        recorder: &mut Recorder<'_>,
    ) {
        for number in 0..model.obstacles.len() {
            let obstacle = obstacles.met(motion.number, number);
            if obstacle.shape.side_row().is_none() {
                continue;
            }
            let mut tests = 0;
            let looks = each_near(motion, number, obstacle, touches, plan, |point, side| {
                tests += 1;
                let Some(met) = self.meet(motion, obstacle, point, side) else { return };
                let at = R::Vec3::from_dvec3(motion.in_scene(met.way.from));
                let side = met_side(&obstacle.shape, at, met.surface.normal);
                self.touches.push(SampleTouch {
                    body: motion.number,
                    sample: point,
                    obstacle: number,
                    side,
                    depth_m: 0.0,
                });
            });
            recorder.counters.narrow_tests += tests;
            recorder.counters.modal_work += looks + tests;
        }
        self.touches.sort_unstable_by_key(SampleTouch::place);
    }

    /// Nothing touches until it is found to.
    pub(super) fn forget_touches(&mut self) {
        self.touches.clear();
    }

    /// What was found last to touch.
    pub(super) fn touches(&self) -> &[SampleTouch] {
        &self.touches
    }

    /// How a point meets an obstacle, if it does; the row is that of the point then.
    fn meet<R: Real>(
        &mut self,
        motion: &Motion<'_, R>,
        obstacle: &ObstacleModel<R>,
        point: usize,
        side: Side,
    ) -> Option<Met<R>> {
        let Motion { modal, secs, .. } = *motion;
        let row = &mut self.row[..self.modes];
        modal.points.row(&modal.modes, point, row);
        let rest = modal.points.rest(point);
        let way = motion.way(rest, row);
        let from = R::Vec3::from_dvec3(motion.in_scene(way.from));
        let side = match (side, motion.flight) {
            (Side::Known(side), _) => side,
            (Side::Resting, None) => {
                side_of(&obstacle.shape, R::Vec3::from_dvec3(motion.in_scene(rest)), R::Vec3::from_dvec3(modal.place))
            }
            (Side::Resting, Some(flight)) => side_of(&obstacle.shape, from, R::Vec3::from_dvec3(flight.start())),
        };
        let swept = Swept { from, path: R::Vec3::from_dvec3(motion.turn * way.path), side, widest: None };
        self.known.fill(Known::default());
        let (surface, velocity) = swept.meet(obstacle, R::from_f64(secs), &mut self.known)?;
        Some(Met { way, surface, velocity })
    }

    /// Has what was met last be a contact, which stands for so many points.
    fn constrain<R: Real>(
        &mut self,
        motion: &Motion<'_, R>,
        model: &Model<R>,
        number: usize,
        met: &Met<R>,
        points: f64,
    ) {
        let Motion { body, secs, .. } = *motion;
        let row = &self.row[..self.modes];
        let Met { way: Way { path, speed, .. }, surface, velocity } = *met;
        let back: DMat3 = motion.turn.transpose();
        let (normal, velocity) = (back * surface.normal.to_dvec3(), back * velocity.to_dvec3());
        let (mut along, mut across) = (0.0, 0.0);
        for (way, Oscillator { yields, .. }) in row.iter().zip(motion.oscillators) {
            let part = way.dot(normal);
            along += yields * part * part;
            across += yields * (*way - normal * part).length_squared();
        }
        if along <= HELD {
            return;
        }
        let depth = -(surface.gap.to_f64() + (path - velocity * secs).dot(normal));
        let (contact, rubs) = (&body.contacts[number], &model.obstacles[number]);
        let stiffness = points * contact.stiffness.to_f64();
        // Together the springs of a free body are damped as one is.
        let share = points / self.candidates.len().max(1) as f64;
        let contact = ModalContact {
            normal,
            surface: velocity,
            depth,
            past: speed - velocity,
            stiffness,
            damping: 2.0 * damping_ratio(motion) * (share * stiffness / along).sqrt(),
            mobility: [along, across],
            friction: [rubs.friction_static.to_f64(), rubs.friction_dynamic.to_f64()],
            gentle: GENTLE_SHARE * body.size.to_f64(),
            pushed: 0.0,
            rubbed: DVec3::ZERO,
        };
        if self.all.len() < self.most {
            self.all.push(contact);
            self.rows.extend_from_slice(row);
            return;
        }
        let places = self.all.iter().enumerate();
        let shallowest = places.min_by(|(_, one), (_, other)| one.depth.total_cmp(&other.depth));
        if let Some((place, _)) = shallowest.filter(|(_, shallowest)| shallowest.depth < depth) {
            self.all[place] = contact;
            self.rows[place * self.modes..][..self.modes].copy_from_slice(row);
        }
    }
}

/// Damping of a contact's spring over the critical one. That of a free body's point stands for the give of the body about it,
/// which its few modes lack: it is damped as the highest of them is, so that a body bounces as high as its solid lets it.
pub(super) fn damping_ratio<R: Real>(motion: &Motion<'_, R>) -> f64 {
    let highest = motion.modal.modes.rates().last().filter(|_| motion.flight.is_some());
    highest.map_or(1.0, |[omega, damping]| (0.5 * damping / omega).clamp(LEAST_DAMPING, 1.0))
}

/// On which side of a plane or an open mesh a point is.
#[derive(Clone, Copy, Debug)]
enum Side {
    /// Of a held body, where it rests; of a free one, where it is.
    Resting,
    /// Where it came from that touches.
    Known(i8),
}

/// A point of a free body that meets an obstacle.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    point: usize,
    side: Side,
    obstacle: usize,
    /// How deep it is at the end of the substep without what pushes, m.
    depth: f64,
}

/// How a point meets an obstacle.
struct Met<R: Real> {
    way: Way,
    surface: Surface<R>,
    /// That of the surface, m/s.
    velocity: R::Vec3,
}

impl<R: Real> Met<R> {
    /// How deep the point is at the end of the substep without what pushes, m.
    fn depth(&self, motion: &Motion<'_, R>) -> f64 {
        let past = motion.turn * self.way.path - self.velocity.to_dvec3() * motion.secs;
        -(self.surface.gap.to_f64() + past.dot(self.surface.normal.to_dvec3()))
    }
}

/// Calls with every point that may come to the obstacle of a number: first those that touch it, then others whose
/// box comes near. Tells how many boxes were looked at.
fn each_near<R: Real>(
    motion: &Motion<'_, R>,
    number: usize,
    obstacle: &ObstacleModel<R>,
    touches: &[SampleTouch],
    plan: &Plan,
    mut with: impl FnMut(usize, Side),
) -> u64 {
    for touch in touches.iter().filter(|touch| touch.obstacle == number) {
        with(touch.sample, Side::Known(touch.side));
    }
    let bounds = [obstacle.bounds.min, obstacle.bounds.max].map(Vector::to_dvec3);
    let is_near = |around: Aabb<f64>| !plan.broad_phase || motion.reaches(around, bounds);
    motion.modal.points.near([motion.now, motion.free.amplitude], is_near, |point| {
        let place = (motion.number, point, number);
        if touches.binary_search_by_key(&place, SampleTouch::place).is_err() {
            with(point, Side::Resting);
        }
    })
}

/// The side of a plane on which a point is; where it is in the plane, that of the middle of its body. Nothing of other
/// obstacles.
fn side_of<R: Real>(shape: &ObstacleShape<R>, at: R::Vec3, middle: R::Vec3) -> i8 {
    let ObstacleShape::Plane(plane) = shape else { return 0 };
    let height = |at: R::Vec3| (at - plane.center).dot(plane.normal).to_f64();
    let in_plane = MARGIN * (at - plane.center).length().to_f64();
    let height = if height(at).abs() > in_plane { height(at) } else { height(middle) };
    if height >= 0.0 { 1 } else { -1 }
}
