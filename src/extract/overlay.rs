//! Overlays of a simulation: links, particles, pins, cells, contact forces, the boxes of the broad phase. Overlays that are
//! switched off are neither computed nor kept.

use std::sync::Arc;

use glam::Vec3;

use crate::geometry::Lattice;
use crate::math::Aabb;
use crate::physics::BodyModel;
use crate::physics::Simulation;
use crate::scene::settings::EARTH_GRAVITY;
use crate::scene::view_settings::Overlays;
use crate::scene::{Body, Obstacle};
use crate::view::overlay::{CellFrames, LineEnds, Lines, PointPlaces, Points, Segment};
use crate::view::style::Tint;
use crate::view::{Overlay, Selected};

/// How much a body fades when its inside is shown.
const SEE_THROUGH: f32 = 0.8;
/// How much of boxes shows behind other things.
const BOX_HIDDEN_OPACITY: f32 = 0.3;
/// How much of arrows shows behind other things: the body that is pushed hides most of them.
const ARROW_HIDDEN_OPACITY: f32 = 0.75;
/// The length of the arrow for the force that carries one particle of a body at rest, in sizes of the body.
const WEIGHT_ARROW_LENGTH: f32 = 0.2;
/// How much of pins shows behind other things.
const PIN_HIDDEN_OPACITY: f32 = 0.3;
/// The longest arrow, in sizes of the body.
const MAX_ARROW_LENGTH: f32 = 1.0;
/// The length of an arrow's head in lengths of the arrow, and at most in sizes of the body.
const ARROW_HEAD_LENGTH: [f32; 2] = [0.35, 0.05];

/// Index lists of the lattices that are drawn. Each is made once and kept as long as its lattice is drawn.
#[derive(Debug, Default)]
pub struct OverlaySource {
    lattices: Vec<LatticeLists>,
}

/// The index lists of one lattice that have been needed so far.
#[derive(Debug)]
struct LatticeLists {
    lattice: Arc<Lattice>,
    links: [Option<Arc<Vec<[u32; 2]>>>; 3],
    cells: Option<Arc<Vec<[u32; 8]>>>,
}

impl OverlaySource {
    /// Returns the wanted overlays of the present state. `bodies` are the scene's; the draw list has the skins of the
    /// visible ones in the same order.
    pub fn fill(&mut self, simulation: &Simulation<f32>, bodies: &[Body], wanted: Overlays) -> Overlay {
        let mut overlay = Overlay::default();
        let inside = wanted.structural || wanted.shear || wanted.bending || wanted.particles || wanted.cells;
        let models = &simulation.model().bodies;
        if inside {
            overlay.see_through = SEE_THROUGH;
            self.lattices.retain(|lists| models.iter().any(|body| Arc::ptr_eq(&body.lattice, &lists.lattice)));
        } else {
            self.lattices.clear();
        }
        for (skin, (body, _)) in models.iter().zip(bodies).filter(|(_, body)| !body.hidden).enumerate() {
            if inside {
                self.add_inside(&mut overlay, body, wanted);
            }
            if wanted.pins {
                overlay.points.extend(pins(simulation, body));
            }
            if wanted.wireframe {
                let ends = LineEnds::Skin(skin);
                overlay.lines.push(Lines { ends, tint: Tint::Wireframe, opacity: 0.8, width: 1.0, hidden: 0.0 });
            }
        }
        if wanted.boxes {
            overlay.lines.extend(boxes(simulation));
        }
        if wanted.contacts {
            add_contacts(&mut overlay, simulation);
        }
        overlay
    }

    fn add_inside(&mut self, overlay: &mut Overlay, body: &BodyModel<f32>, wanted: Overlays) {
        let first = index(body.particles.start);
        let lists = self.lists(&body.lattice);
        let families = [wanted.structural, wanted.shear, wanted.bending];
        for (family, _) in families.into_iter().enumerate().filter(|&(_, wanted)| wanted) {
            let links = &lists.lattice.links[family];
            let ends = Arc::clone(lists.links[family].get_or_insert_with(|| Arc::new(links.clone())));
            let ends = LineEnds::Particles { ends, first };
            overlay.lines.push(Lines { ends, tint: Tint::Link(family), opacity: 1.0, width: 1.4, hidden: 0.0 });
        }
        if wanted.cells {
            let cells = Arc::clone(lists.cells.get_or_insert_with(|| Arc::new(lists.lattice.cells.clone())));
            overlay.cells.push(CellFrames { cells, first, width: 1.0 });
        }
        if wanted.particles {
            let places = PointPlaces::Particles { first, count: index(body.particles.len()) };
            overlay.points.push(Points { places, tint: Tint::Particle, size: 5.0, hidden: 0.0 });
        }
    }

    fn lists(&mut self, lattice: &Arc<Lattice>) -> &mut LatticeLists {
        let known = self.lattices.iter().position(|lists| Arc::ptr_eq(&lists.lattice, lattice));
        let place = known.unwrap_or_else(|| {
            self.lattices.push(LatticeLists { lattice: Arc::clone(lattice), links: [None, None, None], cells: None });
            self.lattices.len() - 1
        });
        &mut self.lattices[place]
    }
}

/// The pinned particles of a body; `None` if all move.
fn pins(simulation: &Simulation<f32>, body: &BodyModel<f32>) -> Option<Points> {
    let own = &simulation.state().position[body.particles.clone()];
    let held = own.iter().enumerate().filter(|(local, _)| body.is_pinned(*local));
    let places: Vec<[f32; 3]> = held.map(|(_, place)| place.to_array()).collect();
    let places = (!places.is_empty()).then(|| PointPlaces::Placed(Arc::new(places)))?;
    Some(Points { places, tint: Tint::Pin, size: 8.0, hidden: PIN_HIDDEN_OPACITY })
}

/// The force per metre of arrow, N/m. The weight that one particle carries when the body rests on one face of the box around
/// it becomes a fifth of the body's size. Without gravity, that of the Earth is used.
#[expect(clippy::cast_possible_truncation, reason = "a length on the screen needs no more")]
pub fn newtons_per_metre(body: &BodyModel<f32>, gravity: Vec3) -> f32 {
    let gravity = if gravity == Vec3::ZERO { EARTH_GRAVITY as f32 } else { gravity.length() };
    let count = body.particles.len().max(1) as f32;
    let weight = body.particle_mass * count * gravity;
    weight / libm::powf(count, 2.0 / 3.0) / (WEIGHT_ARROW_LENGTH * body.size)
}

/// A body of the scene as the draw list names it; `None` if it is hidden or does not exist.
pub fn selected_body(bodies: &[Body], index: usize) -> Option<Selected> {
    bodies.get(index).filter(|body| !body.hidden)?;
    Some(Selected::Skin(bodies[..index].iter().filter(|body| !body.hidden).count()))
}

/// An obstacle of the scene as the draw list names it; `None` if it is hidden or does not exist.
pub fn selected_obstacle(obstacles: &[Obstacle], index: usize) -> Option<Selected> {
    obstacles.get(index).filter(|obstacle| !obstacle.hidden)?;
    Some(Selected::Solid(obstacles[..index].iter().filter(|obstacle| !obstacle.hidden).count()))
}

/// Draws a pull from the grabbed point to its target: a line that shows through everything, with a dot at either end.
pub fn add_grab(overlay: &mut Overlay, grabbed: Vec3, target: Vec3) {
    let tint = Tint::Accent;
    overlay.lines.push(placed_lines(vec![Segment::plain(grabbed, target, 2.5)], tint, 0.7));
    for (place, size) in [(grabbed, 9.0), (target, 6.0)] {
        let places = PointPlaces::Placed(Arc::new(vec![place.to_array()]));
        overlay.points.push(Points { places, tint, size, hidden: 0.7 });
    }
}

/// Draws the edges of a face under a brush; hidden parts show through.
pub fn add_face(overlay: &mut Overlay, corners: [Vec3; 4]) {
    let edges = (0..4).map(|place| Segment::plain(corners[place], corners[(place + 1) % 4], 3.0)).collect();
    overlay.lines.push(placed_lines(edges, Tint::Accent, 0.5));
}

/// Marks the contacts of particles or mesh points with obstacles or other bodies, with the force on each as an arrow. The
/// arrow's length is proportional to the force, see [`newtons_per_metre`], up to the body's size.
fn add_contacts(overlay: &mut Overlay, simulation: &Simulation<f32>) {
    let model = simulation.model();
    let (mut places, mut arrows) = (Vec::new(), Vec::new());
    let state = simulation.state();
    let of = |particle: usize, force: Vec3| (model.body_of(particle), state.position[particle], force);
    let with_obstacles = simulation.contacts().iter().map(|contact| of(contact.particle, contact.force));
    let with_bodies = simulation.body_contacts().iter();
    let with_bodies = with_bodies
        .map(|contact| (Some(contact.bodies[0]), contact.own.place(state).as_vec3(), contact.force.as_vec3()));
    let on_meshes = simulation.sample_contacts().iter();
    let on_meshes =
        on_meshes.map(|contact| (Some(contact.body), contact.own.place(state).as_vec3(), contact.force.as_vec3()));
    for (body, place, force) in with_obstacles.chain(with_bodies).chain(on_meshes) {
        let Some(body) = body.map(|body| &model.bodies[body]) else { continue };
        if force == Vec3::ZERO || !force.is_finite() {
            continue;
        }
        let arrow = (force / newtons_per_metre(body, model.gravity)).clamp_length_max(MAX_ARROW_LENGTH * body.size);
        places.push(place.to_array());
        let head =
            arrow.clamp_length_max((ARROW_HEAD_LENGTH[0] * arrow.length()).min(ARROW_HEAD_LENGTH[1] * body.size));
        let neck = place + arrow - head;
        arrows.push(Segment::plain(place, neck, 2.0));
        let head = Segment { widths: [8.0, 0.0], ..Segment::plain(neck, place + arrow, 0.0) };
        arrows.push(head);
    }
    overlay.lines.push(placed_lines(arrows, Tint::Contact, ARROW_HIDDEN_OPACITY));
    let places = PointPlaces::Placed(Arc::new(places));
    overlay.points.push(Points { places, tint: Tint::Contact, size: 4.5, hidden: ARROW_HIDDEN_OPACITY });
}

/// The boxes around all bodies and around all obstacles. An obstacle's box is stronger if it overlaps that of a body: such
/// pairs pass the broad phase.
fn boxes(simulation: &Simulation<f32>) -> [Lines; 2] {
    let (model, state) = (simulation.model(), simulation.state());
    let around = |body: &BodyModel<f32>| Aabb::around(body.particles.clone().map(|particle| state.position[particle]));
    let bodies: Vec<Aabb<f32>> = model.bodies.iter().map(around).collect();
    let [mut of_bodies, mut of_obstacles] = [Vec::new(), Vec::new()];
    for bounds in &bodies {
        add_box(&mut of_bodies, bounds, 1.0, 1.6);
    }
    for obstacle in simulation.obstacles().all() {
        let meets = bodies.iter().any(|body| body.overlaps(&obstacle.bounds));
        let (opacity, width) = if meets { (1.0, 2.2) } else { (0.55, 1.2) };
        add_box(&mut of_obstacles, &obstacle.bounds, opacity, width);
    }
    [
        placed_lines(of_bodies, Tint::BodyBox, BOX_HIDDEN_OPACITY),
        placed_lines(of_obstacles, Tint::ObstacleBox, BOX_HIDDEN_OPACITY),
    ]
}

pub(super) fn placed_lines(segments: Vec<Segment>, tint: Tint, hidden: f32) -> Lines {
    Lines { ends: LineEnds::Placed(Arc::new(segments)), tint, opacity: 1.0, width: 1.0, hidden }
}

fn add_box(edges: &mut Vec<Segment>, bounds: &Aabb<f32>, opacity: f32, width: f32) {
    let corners = bounds.corners();
    let edge = |[from, to]: [usize; 2]| Segment::new(corners[from], corners[to], [1.0, 1.0, 1.0, opacity], width);
    edges.extend(box_edges().map(edge));
}

/// The edges of a box, as pairs of its corners.
pub(super) fn box_edges() -> impl Iterator<Item = [usize; 2]> {
    let along = (0..8_usize).flat_map(|place| [1, 2, 4].map(|bit| (place, bit)));
    along.filter(|(place, bit)| place & bit == 0).map(|(place, bit)| [place, place | bit])
}

fn index(count: usize) -> u32 {
    u32::try_from(count).unwrap_or(u32::MAX)
}

#[cfg(test)]
#[path = "overlay_tests.rs"]
mod tests;
