//! Finds which points of a modal body meet which obstacles within a substep, and solves their contacts.

use glam::DVec3;

use super::candidate::{Candidate, PriorTouch, SweptContact};
use super::motion::{Motion, PointMotion, ROUNDING_MARGIN, superpose};
use super::oscillator::Oscillator;
use crate::math::{Aabb, Real, Vector};
use crate::physics::contact::{
    MIN_MOBILITY, NearestPointCache, PARTING_SPEED_SHARE, Placed, SweptPoint, contact_side, coulomb_impulse,
    pressed_at_end,
};
use crate::physics::model::plan::{Plan, Stage};
use crate::physics::model::{Model, ObstacleModel, ObstacleShape};
use crate::physics::report::Recorder;
use crate::physics::state::touch::SampleTouch;

/// The most contacts of a held body that are solved for at once: where there are more, the deepest ones.
const MAX_CONTACTS: usize = 256;

/// About the most contacts of a free body, which may lie on all of a side: where more of its points meet something, groups
/// of neighbours are solved for, each by the mean of its points. The deepest points would change all the time, and the body
/// would never rest.
const MAX_GROUPS: usize = 64;

/// The least cosine between the normals of neighbours in one group.
const MIN_GROUP_COSINE: f64 = 0.9;

/// The least damping ratio of a free body's contacts, so that it comes to rest.
const MIN_DAMPING_RATIO: f64 = 0.05;

/// The contact of a point, or of a group of points, with an obstacle. All in the body's coordinates.
#[derive(Clone, Debug)]
pub(super) struct ModalContact {
    /// Unit normal, away from the obstacle.
    pub(super) normal: DVec3,
    /// The velocity of the surface, m/s.
    surface_velocity: DVec3,
    /// How deep the point is at the end of the substep without impulses, m.
    depth: f64,
    /// How much deeper the deepest point of the group is, m.
    deepest_offset: f64,
    /// How far its spring is pressed when the substep begins, m; negative outside.
    pressed: f64,
    /// How much deeper the point is than its spring is pressed, m.
    excess_depth: f64,
    /// Its velocity relative to the surface at the end of the substep without impulses, m/s; of a free body, the mean
    /// velocity.
    pub(super) relative_velocity: DVec3,
    /// N/m and N·s/m.
    stiffness: f64,
    damping: f64,
    /// The mobility (inverse effective mass) of the point along the normal and across it, 1/kg.
    mobility: [f64; 2],
    /// Coulomb's coefficients, at rest and sliding.
    friction: [f64; 2],
    /// The largest speed at which a point leaves that is deeper than its spring is pressed, m/s.
    max_parting_speed: f64,
    /// The range of candidates that it stands for.
    candidates: [usize; 2],
    /// The impulse so far along the normal, N·s, and across it.
    normal_impulse: f64,
    friction_impulse: DVec3,
}

impl ModalContact {
    /// How far its spring is pressed at the end of a substep of `dt` (s) in which impulses change the point's velocity by
    /// `change` (m/s), m.
    fn pressed_at_end(&self, change: DVec3, dt: f64) -> f64 {
        let way = dt * (self.relative_velocity + change).dot(self.normal);
        pressed_at_end(self.pressed, way, self.normal_impulse / (dt * self.stiffness))
    }

    /// Solves the contact while all impulses so far change the point's velocity by `change` (m/s). Returns the change of its
    /// own impulse, N·s.
    pub(super) fn solve(&mut self, change: DVec3, dt: f64) -> DVec3 {
        let relative_velocity = self.relative_velocity + change;
        let [along, across] = self.mobility;
        let normal_velocity = relative_velocity.dot(self.normal);
        // Without its own impulse.
        let free_velocity = normal_velocity - along * self.normal_impulse;
        let depth = self.depth - dt * (change.dot(self.normal) - along * self.normal_impulse);
        let resistance = dt * (dt * self.stiffness + self.damping);
        let [spring_impulse, parting_impulse] = [depth - self.excess_depth, depth].map(|pressed| {
            let push = dt * (self.stiffness * pressed - self.damping * free_velocity);
            push / (1.0 + resistance * along)
        });
        let parting_impulse = parting_impulse.min((self.max_parting_speed - free_velocity) / along);
        let normal_impulse = if depth > 0.0 { spring_impulse.max(parting_impulse).max(0.0) } else { 0.0 };
        let mut impulse = self.normal * (normal_impulse - self.normal_impulse);
        self.normal_impulse = normal_impulse;
        if self.friction[0] > 0.0 && across > MIN_MOBILITY {
            let stopping = self.friction_impulse - (relative_velocity - self.normal * normal_velocity) / across;
            let friction_impulse = coulomb_impulse(stopping, self.friction, normal_impulse);
            impulse += friction_impulse - self.friction_impulse;
            self.friction_impulse = friction_impulse;
        }
        impulse
    }
}

/// The contacts of a body in a substep, and room to find them in.
#[derive(Clone, Debug, Default)]
pub(super) struct ModalContacts {
    contacts: Vec<ModalContact>,
    /// The row of each contact's point, one after another: its displacement by each mode.
    rows: Vec<DVec3>,
    modes: usize,
    row: Vec<DVec3>,
    mean_row: Vec<DVec3>,
    caches: Vec<NearestPointCache>,
    max_contacts: usize,
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
        let max_contacts = points.min(MAX_CONTACTS);
        Self {
            contacts: Vec::with_capacity(max_contacts),
            rows: Vec::with_capacity(max_contacts * modes),
            modes,
            row: vec![DVec3::ZERO; modes],
            mean_row: vec![DVec3::ZERO; modes],
            caches: vec![NearestPointCache::default(); meshes],
            max_contacts,
            candidates: Vec::with_capacity(touches),
            pressed: Vec::with_capacity(touches),
            touches: Vec::with_capacity(touches),
        }
    }

    /// Resets all impulses.
    pub(super) fn reset(&mut self) {
        self.contacts
            .iter_mut()
            .for_each(|contact| (contact.normal_impulse, contact.friction_impulse) = (0.0, DVec3::ZERO));
    }

    pub(super) fn is_empty(&self) -> bool {
        self.contacts.is_empty()
    }

    /// The contacts, each with the row of its point.
    pub(super) fn each(&mut self) -> impl Iterator<Item = (&mut ModalContact, &[DVec3])> {
        self.contacts.iter_mut().zip(self.rows.chunks_exact(self.modes.max(1)))
    }

    /// How many push.
    pub(super) fn pushing_count(&self) -> usize {
        self.contacts.iter().filter(|contact| contact.normal_impulse > 0.0).count()
    }

    /// The largest depth at the end of the substep, m.
    pub(super) fn max_depth(&self, secs: f64, change: &[f64]) -> f64 {
        let rows = self.rows.chunks_exact(self.modes.max(1));
        let depths = self.contacts.iter().zip(rows).map(|(contact, row)| {
            let depth = contact.depth - secs * superpose(row, change).dot(contact.normal);
            depth + contact.deepest_offset
        });
        depths.fold(0.0, f64::max)
    }

    /// Counts the work, the frictions and the surface speeds of obstacles.
    pub(super) fn count_work(&self, recorder: &mut Recorder<'_>) {
        for contact in &self.contacts {
            let impulse = contact.normal * contact.normal_impulse + contact.friction_impulse;
            let work = impulse.dot(contact.surface_velocity);
            recorder.counters.add_obstacle_work(work, contact.surface_velocity.length());
            recorder.counters.frictions += u64::from(contact.normal_impulse > 0.0 && contact.friction[0] > 0.0);
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
        self.contacts.clear();
        self.rows.clear();
        self.candidates.clear();
        let points = &motion.modal.points;
        for number in 0..model.obstacles.len() {
            let obstacle = obstacles.for_body(motion.number, number);
            recorder.enter(Stage::BroadPhase);
            let before = recorder.counters.narrow_tests;
            let boxes_tested = for_each_near_point(motion, number, obstacle, touches, plan, |point, prior| {
                recorder.counters.narrow_tests += 1;
                let Some(contact) = self.sweep_point(motion, obstacle, point, prior) else { return };
                let candidate = Candidate::new(motion, (point, number), prior, &contact);
                if motion.flight.is_none() {
                    self.add_contact(motion, model, &[candidate], [0, 1]);
                } else {
                    self.candidates.push(candidate);
                }
            });
            let tests = recorder.counters.narrow_tests - before;
            recorder.counters.narrow_tests_saved += (points.count() as u64).saturating_sub(tests);
            recorder.counters.modal_work += boxes_tested + tests;
        }
        self.group_candidates(motion, model);
    }

    /// Makes contacts of all candidates of a free body, alone or in groups of neighbours.
    fn group_candidates<R: Real>(&mut self, motion: &Motion<'_, R>, model: &Model<R>) {
        let mut candidates = std::mem::take(&mut self.candidates);
        candidates.sort_unstable_by_key(|candidate| (candidate.obstacle, candidate.place));
        // The group of a candidate: a larger shift puts more neighbours in the tree's order into the same group.
        let group = |of: &Candidate, shift: u32| (of.obstacle, of.place >> shift);
        let are_few = |shift: &u32| {
            let groups = candidates.chunk_by(|one, next| group(one, *shift) == group(next, *shift));
            groups.take(MAX_GROUPS + 1).count() <= MAX_GROUPS
        };
        let shift = (0..usize::BITS).find(are_few).unwrap_or(0);
        let (mut first, all) = (0, candidates.len());
        for neighbours in candidates.chunk_by(|one, next| group(one, shift) == group(next, shift)) {
            for alike in neighbours.chunk_by(|one, next| one.normal.dot(next.normal) > MIN_GROUP_COSINE) {
                self.set_mean_row(motion, alike);
                self.add_contact(motion, model, alike, [first, all]);
                first += alike.len();
            }
        }
        self.candidates = candidates;
    }

    /// Sets the row to the mean of these points' rows.
    fn set_mean_row<R: Real>(&mut self, motion: &Motion<'_, R>, candidates: &[Candidate]) {
        let share = 1.0 / candidates.len() as f64;
        self.mean_row.fill(DVec3::ZERO);
        for candidate in candidates {
            self.load_point(motion, candidate.point);
            self.mean_row.iter_mut().zip(&self.row).for_each(|(mean, way)| *mean += *way * share);
        }
        self.row.copy_from_slice(&self.mean_row);
    }

    /// Finds which points of a free body touch obstacles after a motion: planes and open meshes, each on the side that the
    /// point came from; other obstacles where the point's spring is pressed ([`Self::find_spring_depths`]).
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
            let boxes_tested = for_each_near_point(motion, number, obstacle, touches, plan, |point, prior| {
                tests += 1;
                let Some(contact) = self.sweep_point(motion, obstacle, point, prior) else { return };
                let at = R::Vec3::from_dvec3(motion.in_scene(contact.point_motion.start));
                let side = contact_side(&obstacle.shape, at, contact.surface.normal);
                let touch = SampleTouch { body: motion.number, sample: point, obstacle: number, side, depth_m: 0.0 };
                let pressed = self.pressed.binary_search_by_key(&touch.place(), SampleTouch::place);
                let depth_m = pressed.map_or(0.0, |place| self.pressed[place].depth_m);
                self.touches.push(SampleTouch { depth_m, ..touch });
            });
            recorder.counters.narrow_tests += tests;
            recorder.counters.modal_work += boxes_tested + tests;
        }
        self.touches.sort_unstable_by_key(SampleTouch::place);
    }

    /// Finds how far the springs of all candidates are pressed at the end, each as that of its group; `change` is the change
    /// of the rates.
    pub(super) fn find_spring_depths<R: Real>(&mut self, motion: &Motion<'_, R>, change: &[f64]) {
        self.pressed.clear();
        let rows = self.rows.chunks_exact(self.modes.max(1));
        for (contact, row) in self.contacts.iter().zip(rows) {
            let depth_m = contact.pressed_at_end(superpose(row, change), motion.secs);
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
    fn load_point<R: Real>(&mut self, motion: &Motion<'_, R>, point: usize) -> PointMotion {
        let Motion { modal, .. } = *motion;
        let row = &mut self.row[..self.modes];
        modal.points.row(&modal.modes, point, row);
        motion.point_motion(modal.points.rest(point), row)
    }

    /// How a point meets an obstacle, if it does; sets the row to that of the point.
    fn sweep_point<R: Real>(
        &mut self,
        motion: &Motion<'_, R>,
        obstacle: &ObstacleModel<R>,
        point: usize,
        prior: Option<PriorTouch>,
    ) -> Option<SweptContact<R>> {
        let Motion { modal, secs, .. } = *motion;
        let (point_motion, rest) = (self.load_point(motion, point), modal.points.rest(point));
        let from = R::Vec3::from_dvec3(motion.in_scene(point_motion.start));
        // Of a held body the side of the place at rest; of a free one that of the present place.
        let side = match (prior, motion.flight) {
            (Some(prior), _) => prior.side,
            (None, None) => {
                side_of(&obstacle.shape, R::Vec3::from_dvec3(motion.in_scene(rest)), R::Vec3::from_dvec3(modal.origin))
            }
            (None, Some(flight)) => side_of(&obstacle.shape, from, R::Vec3::from_dvec3(flight.start_center())),
        };
        let swept = SweptPoint {
            from,
            path: R::Vec3::from_dvec3(motion.turn * point_motion.displacement),
            side,
            largest_coordinates: None,
        };
        self.caches.fill(NearestPointCache::default());
        let (surface, surface_velocity) = swept.meet(obstacle, R::from_f64(secs), &mut self.caches)?;
        Some(SweptContact { point_motion, surface, surface_velocity })
    }

    /// Makes one contact of these candidates. `first` is the place of the first of them among `all` candidates; the row is
    /// the mean of theirs.
    fn add_contact<R: Real>(
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
        for (way, Oscillator { mobility, .. }) in row.iter().zip(motion.oscillators) {
            let part = way.dot(normal);
            along += mobility * part * part;
            across += mobility * (*way - normal * part).length_squared();
        }
        if along <= MIN_MOBILITY {
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
            surface_velocity: mean.surface_velocity,
            depth,
            deepest_offset: deepest - depth,
            pressed: mean.pressed,
            excess_depth: -mean.gap - mean.pressed,
            relative_velocity: mean.point_motion.velocity - mean.surface_velocity,
            stiffness,
            damping: 2.0 * damping_ratio(motion) * (share * stiffness / along).sqrt(),
            mobility: [along, across],
            friction: [rubs.friction_static.to_f64(), rubs.friction_dynamic.to_f64()],
            max_parting_speed: PARTING_SPEED_SHARE * body.size.to_f64(),
            candidates: [first, first + candidates.len()],
            normal_impulse: 0.0,
            friction_impulse: DVec3::ZERO,
        };
        if self.contacts.len() < self.max_contacts {
            self.contacts.push(contact);
            self.rows.extend_from_slice(row);
            return;
        }
        let places = self.contacts.iter().enumerate();
        let shallowest = places.min_by(|(_, one), (_, other)| one.depth.total_cmp(&other.depth));
        if let Some((place, _)) = shallowest.filter(|(_, shallowest)| shallowest.depth < depth) {
            self.contacts[place] = contact;
            self.rows[place * self.modes..][..self.modes].copy_from_slice(row);
        }
    }
}

/// The damping ratio of a contact's spring. In a free body the spring stands for the local give that its few modes lack: it
/// has the damping ratio of the highest mode, so that a body bounces as high as its solid lets it.
pub(super) fn damping_ratio<R: Real>(motion: &Motion<'_, R>) -> f64 {
    let highest = motion.modal.modes.rates().last().filter(|_| motion.flight.is_some());
    highest.map_or(1.0, |[omega, damping]| (0.5 * damping / omega).clamp(MIN_DAMPING_RATIO, 1.0))
}

/// Calls `with` for every point that may come to the obstacle of this number: first for those that touch it, then for others
/// whose box comes near. Returns how many boxes were looked at.
fn for_each_near_point<R: Real>(
    motion: &Motion<'_, R>,
    number: usize,
    obstacle: &ObstacleModel<R>,
    touches: &[SampleTouch],
    plan: &Plan,
    mut with: impl FnMut(usize, Option<PriorTouch>),
) -> u64 {
    for touch in touches.iter().filter(|touch| touch.obstacle == number) {
        with(touch.sample, Some(PriorTouch { side: touch.side, pressed: touch.depth_m }));
    }
    let bounds = [obstacle.bounds.min, obstacle.bounds.max].map(Vector::to_dvec3);
    let is_near = |around: Aabb<f64>| !plan.broad_phase || motion.reaches(around, bounds);
    motion.modal.points.for_each_near([motion.start_amplitude, motion.free.amplitude], is_near, |point| {
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
    let in_plane = ROUNDING_MARGIN * (at - plane.center).length().to_f64();
    let height = if height(at).abs() > in_plane { height(at) } else { height(middle) };
    if height >= 0.0 { 1 } else { -1 }
}
