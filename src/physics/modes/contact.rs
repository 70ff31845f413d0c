//! Which points of a modal body meet which obstacles within a substep, and what their springs have to do.

use glam::{DMat3, DVec3};

use super::oscillator::Oscillator;
use crate::math::{Aabb, Real, Vector};
use crate::physics::contact::{GENTLE_SHARE, Known, Placed, Swept};
use crate::physics::model::plan::{Plan, Stage};
use crate::physics::model::{BodyModel, ModalBody, Model, ObstacleModel, ObstacleShape};
use crate::physics::report::Recorder;

/// The most contacts that are solved for at once: where there are more, the deepest ones.
const MOST: usize = 256;

/// Boxes are grown by this share of the body's size, for what rounding takes off them.
const MARGIN: f64 = 1e-5;

/// A mode moves a point by less than rounding where its mobility is below this, 1/kg.
const HELD: f64 = 1e-12;

/// Where modes are at the end of a substep.
#[derive(Clone, Copy)]
pub(super) struct Ends<'a> {
    /// m √kg.
    pub(super) amplitude: &'a [f64],
    /// m √kg / s.
    pub(super) rate: &'a [f64],
}

/// A body over a substep, as its modes would move it without what pushes at points.
pub(super) struct Motion<'a, R: Real> {
    pub(super) body: &'a BodyModel<R>,
    /// Its place among the bodies.
    pub(super) number: usize,
    pub(super) modal: &'a ModalBody,
    /// Its modes over the substep.
    pub(super) oscillators: &'a [Oscillator],
    /// The amplitudes when it begins.
    pub(super) now: &'a [f64],
    /// Where modes are at its end.
    pub(super) free: Ends<'a>,
    /// How long it is, s.
    pub(super) secs: f64,
}

impl<R: Real> Motion<'_, R> {
    /// How fast a point is at the end that moves like this by the modes, m/s, in the body's coordinates.
    pub(super) fn speed(&self, row: &[DVec3]) -> DVec3 {
        sum(row, self.free.rate)
    }
}

/// How far a point is moved by these amplitudes, m.
pub(super) fn sum(row: &[DVec3], amplitude: &[f64]) -> DVec3 {
    row.iter().zip(amplitude).fold(DVec3::ZERO, |sum, (way, q)| sum + *way * *q)
}

/// A point at an obstacle. All in the body's coordinates.
#[derive(Clone, Debug)]
pub(super) struct ModalContact {
    /// Unit normal, away from the obstacle.
    pub(super) normal: DVec3,
    /// The velocity of the surface, m/s.
    surface: DVec3,
    /// How deep the point is at the end of the substep without what pushes, m.
    depth: f64,
    /// How fast it is past the surface then, m/s.
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
}

impl ModalContacts {
    /// Room for so many, of a body of so many modes, among so many meshes.
    pub(super) fn new(points: usize, modes: usize, meshes: usize) -> Self {
        let most = points.min(MOST);
        Self {
            all: Vec::with_capacity(most),
            rows: Vec::with_capacity(most * modes),
            modes,
            row: vec![DVec3::ZERO; modes],
            known: vec![Known::default(); meshes],
            most,
        }
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

    /// Finds all that points of a body meet.
    pub(super) fn find<R: Real>(
        &mut self,
        motion: &Motion<'_, R>,
        model: &Model<R>,
        obstacles: &Placed<R>,
        plan: &Plan,
        recorder: &mut Recorder<'_>,
    ) {
        self.modes = motion.now.len();
        self.all.clear();
        self.rows.clear();
        let points = &motion.modal.points;
        for number in 0..model.obstacles.len() {
            let obstacle = obstacles.met(motion.number, number);
            let bounds = [obstacle.bounds.min, obstacle.bounds.max].map(Vector::to_dvec3);
            let is_near = |around: Aabb<f64>| !plan.broad_phase || reaches(motion, around, bounds);
            recorder.enter(Stage::BroadPhase);
            let before = recorder.counters.narrow_tests;
            let looks = points.near([motion.now, motion.free.amplitude], is_near, |point| {
                recorder.counters.narrow_tests += 1;
                self.meet(motion, model, number, obstacle, point);
            });
            let tests = recorder.counters.narrow_tests - before;
            recorder.counters.narrow_tests_saved += (points.count() as u64).saturating_sub(tests);
            recorder.counters.modal_work += looks + tests;
        }
    }

    /// Writes down whether a point meets an obstacle.
    fn meet<R: Real>(
        &mut self,
        motion: &Motion<'_, R>,
        model: &Model<R>,
        number: usize,
        obstacle: &ObstacleModel<R>,
        point: usize,
    ) {
        let Motion { body, modal, secs, .. } = *motion;
        let row = &mut self.row[..self.modes];
        modal.points.row(&modal.modes, point, row);
        let rest = modal.points.rest(point);
        let scene = |at: DVec3| modal.place + modal.turn * at;
        let [from, way] = [rest + sum(row, motion.now), sum(row, motion.free.amplitude) - sum(row, motion.now)];
        let swept = Swept {
            from: R::Vec3::from_dvec3(scene(from)),
            path: R::Vec3::from_dvec3(modal.turn * way),
            side: side(&obstacle.shape, R::Vec3::from_dvec3(scene(rest)), R::Vec3::from_dvec3(modal.place)),
            widest: None,
        };
        self.known.fill(Known::default());
        let Some((surface, velocity)) = swept.meet(obstacle, R::from_f64(secs), &mut self.known) else { return };
        let back: DMat3 = modal.turn.transpose();
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
        let depth = -(surface.gap.to_f64() + (way - velocity * secs).dot(normal));
        let (contact, rubs) = (&body.contacts[number], &model.obstacles[number]);
        let stiffness = contact.stiffness.to_f64();
        let contact = ModalContact {
            normal,
            surface: velocity,
            depth,
            past: sum(row, motion.free.rate) - velocity,
            stiffness,
            damping: 2.0 * (stiffness / along).sqrt(),
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

/// Whether points in a box in the body's coordinates may come to an obstacle in these bounds, m, in the scene.
fn reaches<R: Real>(motion: &Motion<'_, R>, around: Aabb<f64>, [min, max]: [DVec3; 2]) -> bool {
    let ModalBody { turn, place, .. } = motion.modal;
    let half = 0.5 * (around.max - around.min);
    let middle = *place + *turn * (around.min + half);
    let half = turn.x_axis.abs() * half.x + turn.y_axis.abs() * half.y + turn.z_axis.abs() * half.z;
    let half = half + DVec3::splat(MARGIN * (motion.body.size.to_f64() + middle.length()));
    ((middle - half).cmple(max) & (middle + half).cmpge(min)).all()
}

/// The side of a plane on which a point rests; where it rests in the plane, that of the middle of its body. Nothing of other
/// obstacles.
fn side<R: Real>(shape: &ObstacleShape<R>, rest: R::Vec3, middle: R::Vec3) -> i8 {
    let ObstacleShape::Plane(plane) = shape else { return 0 };
    let height = |at: R::Vec3| (at - plane.center).dot(plane.normal).to_f64();
    let in_plane = MARGIN * (rest - plane.center).length().to_f64();
    let height = if height(rest).abs() > in_plane { height(rest) } else { height(middle) };
    if height >= 0.0 { 1 } else { -1 }
}
