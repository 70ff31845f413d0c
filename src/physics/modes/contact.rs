//! Finds which points of a modal body meet which obstacles within a substep, and solves their contacts.

use glam::DVec3;

use super::candidate::{Candidate, Met, Touch};
use super::motion::{MARGIN, Motion, Way, sum};
use super::oscillator::Oscillator;
use crate::math::{Aabb, Real, Vector};
use crate::physics::contact::{
    NearestPointCache, PARTING_SPEED_SHARE, Placed, SweptPoint, contact_side, pressed_at_end,
};
use crate::physics::model::plan::{Plan, Stage};
use crate::physics::model::{Model, ObstacleModel, ObstacleShape};
use crate::physics::report::Recorder;
use crate::physics::state::touch::SampleTouch;

/// The most contacts of a held body that are solved for at once: where there are more, the deepest ones.
const MOST: usize = 256;

/// About the most contacts of a free body, which may lie on all of a side: where more of its points meet something, groups
/// of neighbours are solved for, each by the mean of its points. The deepest points would change all the time, and the body
/// would never rest.
const MOST_GROUPS: usize = 64;

/// The least cosine between the normals of neighbours in one group.
const ONE_WAY: f64 = 0.9;

/// The least damping ratio of a free body's contacts, so that it comes to rest.
const LEAST_DAMPING: f64 = 0.05;

/// A point whose mobility is below this (1/kg) counts as held: modes move it by no more than rounding errors.
const HELD: f64 = 1e-12;

/// The contact of a point, or of a group of points, with an obstacle. All in the body's coordinates.
#[derive(Clone, Debug)]
pub(super) struct ModalContact {
    /// Unit normal, away from the obstacle.
    pub(super) normal: DVec3,
    /// The velocity of the surface, m/s.
    surface: DVec3,
    /// How deep the point is at the end of the substep without impulses, m.
    depth: f64,
    /// How much deeper the deepest point of the group is, m.
    below: f64,
    /// How far its spring is pressed when the substep begins, m; negative outside.
    pressed: f64,
    /// How much deeper the point is than its spring is pressed, m.
    beyond: f64,
    /// Its velocity relative to the surface at the end of the substep without impulses, m/s; of a free body, the mean
    /// velocity.
    pub(super) past: DVec3,
    /// N/m and N·s/m.
    stiffness: f64,
    damping: f64,
    /// The mobility (inverse effective mass) of the point along the normal and across it, 1/kg.
    mobility: [f64; 2],
    /// Coulomb's coefficients, at rest and sliding.
    friction: [f64; 2],
    /// The largest speed at which a point leaves that is deeper than its spring is pressed, m/s.
    gentle: f64,
    /// The range of candidates that it stands for.
    candidates: [usize; 2],
    /// The impulse so far along the normal, N·s, and across it.
    pushed: f64,
    rubbed: DVec3,
}

impl ModalContact {
    /// How far its spring is pressed at the end of a substep of `dt` (s) in which impulses change the point's velocity by
    /// `change` (m/s), m.
    fn pressed_at_end(&self, change: DVec3, dt: f64) -> f64 {
        let way = dt * (self.past + change).dot(self.normal);
        pressed_at_end(self.pressed, way, self.pushed / (dt * self.stiffness))
    }

    /// Solves the contact while all impulses so far change the point's velocity by `change` (m/s). Returns the change of its
    /// own impulse, N·s.
    pub(super) fn solve(&mut self, change: DVec3, dt: f64) -> DVec3 {
        let past = self.past + change;
        let [along, across] = self.mobility;
        let speed = past.dot(self.normal);
        // Without its own impulse.
        let alone = speed - along * self.pushed;
        let depth = self.depth - dt * (change.dot(self.normal) - along * self.pushed);
        let resistance = dt * (dt * self.stiffness + self.damping);
        let [sprung, parted] = [depth - self.beyond, depth].map(|pressed| {
            let push = dt * (self.stiffness * pressed - self.damping * alone);
            push / (1.0 + resistance * along)
        });
        let parted = parted.min((self.gentle - alone) / along);
        let pushed = if depth > 0.0 { sprung.max(parted).max(0.0) } else { 0.0 };
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

/// The contacts of a body in a substep, and room to find them in.
#[derive(Clone, Debug, Default)]
pub(super) struct ModalContacts {
    all: Vec<ModalContact>,
    /// The row of each contact's point, one after another: its displacement by each mode.
    rows: Vec<DVec3>,
    modes: usize,
    row: Vec<DVec3>,
    mean: Vec<DVec3>,
    known: Vec<NearestPointCache>,
    most: usize,
    /// All candidates of a free body.
    candidates: Vec<Candidate>,
    /// The candidates' springs at the end of the substep, as touches and in their order.
    pressed: Vec<SampleTouch>,
    touches: Vec<SampleTouch>,
}

impl ModalContacts {
    /// Room for `points` pairs of a point and an obstacle, of a body with `modes` modes and rigid motions among `meshes`
    /// meshes; a free body remembers up to `touches` touches.
    pub(super) fn new(points: usize, modes: usize, meshes: usize, touches: usize) -> Self {
        let most = points.min(MOST);
        Self {
            all: Vec::with_capacity(most),
            rows: Vec::with_capacity(most * modes),
            modes,
            row: vec![DVec3::ZERO; modes],
            mean: vec![DVec3::ZERO; modes],
            known: vec![NearestPointCache::default(); meshes],
            most,
            candidates: Vec::with_capacity(touches),
            pressed: Vec::with_capacity(touches),
            touches: Vec::with_capacity(touches),
        }
    }

    /// Resets all impulses.
    pub(super) fn reset(&mut self) {
        self.all.iter_mut().for_each(|contact| (contact.pushed, contact.rubbed) = (0.0, DVec3::ZERO));
    }

    pub(super) fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// The contacts, each with the row of its point.
    pub(super) fn each(&mut self) -> impl Iterator<Item = (&mut ModalContact, &[DVec3])> {
        self.all.iter_mut().zip(self.rows.chunks_exact(self.modes.max(1)))
    }

    /// How many push.
    pub(super) fn pushing(&self) -> usize {
        self.all.iter().filter(|contact| contact.pushed > 0.0).count()
    }

    /// The largest depth at the end of the substep, m.
    pub(super) fn deepest(&self, secs: f64, change: &[f64]) -> f64 {
        let rows = self.rows.chunks_exact(self.modes.max(1));
        let depths = self.all.iter().zip(rows).map(|(met, row)| {
            let depth = met.depth - secs * sum(row, change).dot(met.normal);
            depth + met.below
        });
        depths.fold(0.0, f64::max)
    }

    /// Counts the work, the frictions and the surface speeds of obstacles.
    pub(super) fn count_work(&self, recorder: &mut Recorder<'_>) {
        for contact in &self.all {
            let impulse = contact.normal * contact.pushed + contact.rubbed;
            recorder.counters.obstacle_work_j += impulse.dot(contact.surface);
            recorder.counters.frictions += u64::from(contact.pushed > 0.0 && contact.friction[0] > 0.0);
            let fastest = &mut recorder.counters.fastest_surface_m_s;
            *fastest = fastest.max(contact.surface.length());
        }
    }

    /// Finds all contacts of a body's points with obstacles. `touches` are those of a free body before.
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
            let obstacle = obstacles.for_body(motion.number, number);
            recorder.enter(Stage::BroadPhase);
            let before = recorder.counters.narrow_tests;
            let looks = each_near(motion, number, obstacle, touches, plan, |point, known| {
                recorder.counters.narrow_tests += 1;
                let Some(met) = self.meet(motion, obstacle, point, known) else { return };
                let candidate = Candidate::new(motion, (point, number), known, &met);
                if motion.flight.is_none() {
                    self.constrain(motion, model, &[candidate], [0, 1]);
                } else {
                    self.candidates.push(candidate);
                }
            });
            let tests = recorder.counters.narrow_tests - before;
            recorder.counters.narrow_tests_saved += (points.count() as u64).saturating_sub(tests);
            recorder.counters.modal_work += looks + tests;
        }
        self.gather(motion, model);
    }

    /// Makes contacts of all candidates of a free body, alone or in groups of neighbours.
    fn gather<R: Real>(&mut self, motion: &Motion<'_, R>, model: &Model<R>) {
        let mut candidates = std::mem::take(&mut self.candidates);
        candidates.sort_unstable_by_key(|candidate| (candidate.obstacle, candidate.place));
        // The group of a candidate: a larger shift puts more neighbours in the tree's order into the same group.
        let group = |of: &Candidate, shift: u32| (of.obstacle, of.place >> shift);
        let are_few = |shift: &u32| {
            let groups = candidates.chunk_by(|one, next| group(one, *shift) == group(next, *shift));
            groups.take(MOST_GROUPS + 1).count() <= MOST_GROUPS
        };
        let shift = (0..usize::BITS).find(are_few).unwrap_or(0);
        let (mut first, all) = (0, candidates.len());
        for neighbours in candidates.chunk_by(|one, next| group(one, shift) == group(next, shift)) {
            for alike in neighbours.chunk_by(|one, next| one.normal.dot(next.normal) > ONE_WAY) {
                self.take_mean_row(motion, alike);
                self.constrain(motion, model, alike, [first, all]);
                first += alike.len();
            }
        }
        self.candidates = candidates;
    }

    /// Sets the row to the mean of these points' rows.
    fn take_mean_row<R: Real>(&mut self, motion: &Motion<'_, R>, candidates: &[Candidate]) {
        let share = 1.0 / candidates.len() as f64;
        self.mean.fill(DVec3::ZERO);
        for candidate in candidates {
            self.go(motion, candidate.point);
            self.mean.iter_mut().zip(&self.row).for_each(|(mean, way)| *mean += *way * share);
        }
        self.row.copy_from_slice(&self.mean);
    }

    /// Finds which points of a free body touch obstacles after a motion: planes and open meshes, each on the side that the
    /// point came from; other obstacles where the point's spring is pressed ([`Self::press`]).
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
            let obstacle = obstacles.for_body(motion.number, number);
            if obstacle.shape.side_row().is_none() {
                let pressed = self.pressed.iter().filter(|touch| touch.obstacle == number && touch.depth_m > 0.0);
                self.touches.extend(pressed);
                continue;
            }
            let mut tests = 0;
            let looks = each_near(motion, number, obstacle, touches, plan, |point, known| {
                tests += 1;
                let Some(met) = self.meet(motion, obstacle, point, known) else { return };
                let at = R::Vec3::from_dvec3(motion.in_scene(met.way.from));
                let side = contact_side(&obstacle.shape, at, met.surface.normal);
                let touch = SampleTouch { body: motion.number, sample: point, obstacle: number, side, depth_m: 0.0 };
                let pressed = self.pressed.binary_search_by_key(&touch.place(), SampleTouch::place);
                let depth_m = pressed.map_or(0.0, |place| self.pressed[place].depth_m);
                self.touches.push(SampleTouch { depth_m, ..touch });
            });
            recorder.counters.narrow_tests += tests;
            recorder.counters.modal_work += looks + tests;
        }
        self.touches.sort_unstable_by_key(SampleTouch::place);
    }

    /// Finds how far the springs of all candidates are pressed at the end, each as that of its group; `change` is the change
    /// of the rates.
    pub(super) fn press<R: Real>(&mut self, motion: &Motion<'_, R>, change: &[f64]) {
        self.pressed.clear();
        let rows = self.rows.chunks_exact(self.modes.max(1));
        for (contact, row) in self.all.iter().zip(rows) {
            let depth_m = contact.pressed_at_end(sum(row, change), motion.secs);
            let [first, end] = contact.candidates;
            self.pressed.extend(self.candidates[first..end].iter().map(|candidate| {
                let Candidate { point: sample, obstacle, .. } = *candidate;
                SampleTouch { body: motion.number, sample, obstacle, side: 0, depth_m }
            }));
        }
        self.pressed.sort_unstable_by_key(SampleTouch::place);
    }

    /// Forgets all touches.
    pub(super) fn forget_touches(&mut self) {
        self.touches.clear();
    }

    /// The touches that were found last.
    pub(super) fn touches(&self) -> &[SampleTouch] {
        &self.touches
    }

    /// The motion of a point; sets the row to that of the point.
    fn go<R: Real>(&mut self, motion: &Motion<'_, R>, point: usize) -> Way {
        let Motion { modal, .. } = *motion;
        let row = &mut self.row[..self.modes];
        modal.points.row(&modal.modes, point, row);
        motion.way(modal.points.rest(point), row)
    }

    /// How a point meets an obstacle, if it does; sets the row to that of the point.
    fn meet<R: Real>(
        &mut self,
        motion: &Motion<'_, R>,
        obstacle: &ObstacleModel<R>,
        point: usize,
        known: Option<Touch>,
    ) -> Option<Met<R>> {
        let Motion { modal, secs, .. } = *motion;
        let (way, rest) = (self.go(motion, point), modal.points.rest(point));
        let from = R::Vec3::from_dvec3(motion.in_scene(way.from));
        // Of a held body the side of the place at rest; of a free one that of the present place.
        let side = match (known, motion.flight) {
            (Some(known), _) => known.side,
            (None, None) => {
                side_of(&obstacle.shape, R::Vec3::from_dvec3(motion.in_scene(rest)), R::Vec3::from_dvec3(modal.place))
            }
            (None, Some(flight)) => side_of(&obstacle.shape, from, R::Vec3::from_dvec3(flight.start())),
        };
        let swept =
            SweptPoint { from, path: R::Vec3::from_dvec3(motion.turn * way.path), side, largest_coordinates: None };
        self.known.fill(NearestPointCache::default());
        let (surface, velocity) = swept.meet(obstacle, R::from_f64(secs), &mut self.known)?;
        Some(Met { way, surface, velocity })
    }

    /// Makes one contact of these candidates. `first` is the place of the first of them among `all` candidates; the row is
    /// the mean of theirs.
    fn constrain<R: Real>(
        &mut self,
        motion: &Motion<'_, R>,
        model: &Model<R>,
        candidates: &[Candidate],
        [first, all]: [usize; 2],
    ) {
        let Motion { body, secs, .. } = *motion;
        let Some(mean) = Candidate::mean(candidates) else { return };
        let Candidate { obstacle, normal, .. } = mean;
        let row = &self.row[..self.modes];
        let (mut along, mut across) = (0.0, 0.0);
        for (way, Oscillator { yields, .. }) in row.iter().zip(motion.oscillators) {
            let part = way.dot(normal);
            along += yields * part * part;
            across += yields * (*way - normal * part).length_squared();
        }
        if along <= HELD {
            return;
        }
        let depth = mean.depth(secs);
        let deepest = candidates.iter().fold(depth, |deepest, one| deepest.max(one.depth(secs)));
        let (contact, rubs) = (&body.contacts[obstacle], &model.obstacles[obstacle]);
        let points = candidates.len() as f64;
        let stiffness = points * contact.stiffness.to_f64();
        // Together the springs of a free body have the damping ratio of one.
        let share = points / all as f64;
        let contact = ModalContact {
            normal,
            surface: mean.velocity,
            depth,
            below: deepest - depth,
            pressed: mean.pressed,
            beyond: -mean.gap - mean.pressed,
            past: mean.way.speed - mean.velocity,
            stiffness,
            damping: 2.0 * damping_ratio(motion) * (share * stiffness / along).sqrt(),
            mobility: [along, across],
            friction: [rubs.friction_static.to_f64(), rubs.friction_dynamic.to_f64()],
            gentle: PARTING_SPEED_SHARE * body.size.to_f64(),
            candidates: [first, first + candidates.len()],
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

/// The damping ratio of a contact's spring. In a free body the spring stands for the local give that its few modes lack: it
/// has the damping ratio of the highest mode, so that a body bounces as high as its solid lets it.
pub(super) fn damping_ratio<R: Real>(motion: &Motion<'_, R>) -> f64 {
    let highest = motion.modal.modes.rates().last().filter(|_| motion.flight.is_some());
    highest.map_or(1.0, |[omega, damping]| (0.5 * damping / omega).clamp(LEAST_DAMPING, 1.0))
}

/// Calls `with` for every point that may come to the obstacle of this number: first for those that touch it, then for others
/// whose box comes near. Returns how many boxes were looked at.
fn each_near<R: Real>(
    motion: &Motion<'_, R>,
    number: usize,
    obstacle: &ObstacleModel<R>,
    touches: &[SampleTouch],
    plan: &Plan,
    mut with: impl FnMut(usize, Option<Touch>),
) -> u64 {
    for touch in touches.iter().filter(|touch| touch.obstacle == number) {
        with(touch.sample, Some(Touch { side: touch.side, pressed: touch.depth_m }));
    }
    let bounds = [obstacle.bounds.min, obstacle.bounds.max].map(Vector::to_dvec3);
    let is_near = |around: Aabb<f64>| !plan.broad_phase || motion.reaches(around, bounds);
    motion.modal.points.near([motion.now, motion.free.amplitude], is_near, |point| {
        let place = (motion.number, point, number);
        if touches.binary_search_by_key(&place, SampleTouch::place).is_err() {
            with(point, None);
        }
    })
}

/// The side of a plane on which a point is; for a point in the plane, that of the middle of its body. Zero for other
/// obstacles.
fn side_of<R: Real>(shape: &ObstacleShape<R>, at: R::Vec3, middle: R::Vec3) -> i8 {
    let ObstacleShape::Plane(plane) = shape else { return 0 };
    let height = |at: R::Vec3| (at - plane.center).dot(plane.normal).to_f64();
    let in_plane = MARGIN * (at - plane.center).length().to_f64();
    let height = if height(at).abs() > in_plane { height(at) } else { height(middle) };
    if height >= 0.0 { 1 } else { -1 }
}
