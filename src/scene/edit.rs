//! Changing a scene: every edit replaces, inserts or removes one node of the document, so that its inverse is an edit
//! of the same kind and a later edit of the same node stands for both. Knows nothing of how a change is carried out;
//! it only says how deep it goes ([`Impact`]).

use thiserror::Error;

use super::body::MovesBy;
use super::param::{self, Problem};
use super::{Body, ContactOn, Obstacle, Scene, Settings, ViewSettings};

/// A body's place in [`Scene::bodies`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct BodyId(pub usize);

/// An obstacle's place in [`Scene::obstacles`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ObstacleId(pub usize);

/// One change of a scene.
#[derive(Clone, Debug, PartialEq)]
pub enum Edit {
    /// Replaces the settings.
    Settings(Settings),
    /// Replaces how the scene is looked at.
    View(ViewSettings),
    /// Replaces a body.
    Body(BodyId, Box<Body>),
    /// Inserts a body; the ones from this place on move up. The place after the last one is allowed.
    InsertBody(BodyId, Box<Body>),
    /// Removes a body; the ones after it move down.
    RemoveBody(BodyId),
    /// Replaces an obstacle.
    Obstacle(ObstacleId, Box<Obstacle>),
    /// Inserts an obstacle; the ones from this place on move up. The place after the last one is allowed.
    InsertObstacle(ObstacleId, Box<Obstacle>),
    /// Removes an obstacle; the ones after it move down.
    RemoveObstacle(ObstacleId),
}

impl Edit {
    /// Whether both replace the same node, so that the later one alone has the effect of both.
    pub fn replaces_same_node_as(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Settings(_), Self::Settings(_)) | (Self::View(_), Self::View(_)) => true,
            (Self::Body(a, _), Self::Body(b, _)) => a == b,
            (Self::Obstacle(a, _), Self::Obstacle(b, _)) => a == b,
            _ => false,
        }
    }

    /// Whether bodies or obstacles get other places in their lists.
    pub fn moves_places(&self) -> bool {
        match self {
            Self::InsertBody(..) | Self::RemoveBody(_) | Self::InsertObstacle(..) | Self::RemoveObstacle(_) => true,
            Self::Settings(_) | Self::View(_) | Self::Body(..) | Self::Obstacle(..) => false,
        }
    }

    /// Whether it replaces a node that the scene has.
    pub fn replaces_a_node_of(&self, scene: &Scene) -> bool {
        match self {
            Self::Settings(_) | Self::View(_) => true,
            Self::Body(id, _) => id.0 < scene.bodies.len(),
            Self::Obstacle(id, _) => id.0 < scene.obstacles.len(),
            _ => false,
        }
    }
}

/// How deep a change goes; a deeper one includes all before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Impact {
    /// Only the picture or a name changes.
    Appearance,
    /// Constants of the model change; the motion goes on.
    Parameters,
    /// A body's start changes: it moves there; nothing is rebuilt.
    Motion,
    /// Particles or links change, or pins of a body that moves by modes: the model is compiled anew.
    Topology,
}

/// What applying an edit did.
#[derive(Clone, Debug, PartialEq)]
#[must_use = "the inverse is the only way back"]
pub struct Applied {
    /// The edit that takes the change back, exactly.
    pub inverse: Edit,
    /// How deep the change goes.
    pub impact: Impact,
}

/// Why an edit was refused. The scene is then unchanged.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum EditError {
    /// The body does not exist.
    #[error("there is no body {}: the scene has {count}", id.0)]
    NoSuchBody {
        /// The body asked for.
        id: BodyId,
        /// How many there are.
        count: usize,
    },
    /// The obstacle does not exist.
    #[error("there is no obstacle {}: the scene has {count}", id.0)]
    NoSuchObstacle {
        /// The obstacle asked for.
        id: ObstacleId,
        /// How many there are.
        count: usize,
    },
    /// A value is not allowed.
    #[error("{0}")]
    BadValue(Problem),
}

impl Scene {
    /// Applies an edit; on an error nothing changes.
    pub fn apply(&mut self, edit: Edit) -> Result<Applied, EditError> {
        self.check(&edit)?;
        let (inverse, impact) = match edit {
            Edit::Settings(settings) => {
                let impact = leaf_impact(self.settings != settings, Impact::Parameters);
                (Edit::Settings(std::mem::replace(&mut self.settings, settings)), impact)
            }
            Edit::View(view) => (Edit::View(std::mem::replace(&mut self.view, view)), Impact::Appearance),
            Edit::Body(id, body) => {
                let impact = body_impact(&self.bodies[id.0], &body);
                let old = std::mem::replace(&mut self.bodies[id.0], *body);
                (Edit::Body(id, Box::new(old)), impact)
            }
            Edit::InsertBody(id, body) => {
                self.bodies.insert(id.0, *body);
                (Edit::RemoveBody(id), Impact::Topology)
            }
            Edit::RemoveBody(id) => {
                let old = self.bodies.remove(id.0);
                (Edit::InsertBody(id, Box::new(old)), Impact::Topology)
            }
            Edit::Obstacle(id, obstacle) => {
                let impact = obstacle_impact(&self.obstacles[id.0], &obstacle);
                let old = std::mem::replace(&mut self.obstacles[id.0], *obstacle);
                (Edit::Obstacle(id, Box::new(old)), impact)
            }
            Edit::InsertObstacle(id, obstacle) => {
                self.obstacles.insert(id.0, *obstacle);
                (Edit::RemoveObstacle(id), Impact::Parameters)
            }
            Edit::RemoveObstacle(id) => {
                let old = self.obstacles.remove(id.0);
                (Edit::InsertObstacle(id, Box::new(old)), Impact::Parameters)
            }
        };
        Ok(Applied { inverse, impact })
    }

    fn check(&self, edit: &Edit) -> Result<(), EditError> {
        let (bodies, obstacles) = (self.bodies.len(), self.obstacles.len());
        let body =
            |id: BodyId, end: usize| if id.0 < end { Ok(()) } else { Err(EditError::NoSuchBody { id, count: bodies }) };
        let obstacle = |id: ObstacleId, end: usize| {
            if id.0 < end { Ok(()) } else { Err(EditError::NoSuchObstacle { id, count: obstacles }) }
        };
        let problem = match edit {
            Edit::Settings(settings) => param::first_problem("settings", settings),
            Edit::View(view) => param::first_problem("view", view),
            Edit::Body(id, new) | Edit::InsertBody(id, new) => {
                body(*id, bodies + usize::from(matches!(edit, Edit::InsertBody(..))))?;
                param::first_problem(&format!("bodies.{}", id.0), new)
            }
            Edit::Obstacle(id, new) | Edit::InsertObstacle(id, new) => {
                obstacle(*id, obstacles + usize::from(matches!(edit, Edit::InsertObstacle(..))))?;
                param::first_problem(&format!("obstacles.{}", id.0), new)
            }
            Edit::RemoveBody(id) => return body(*id, bodies),
            Edit::RemoveObstacle(id) => return obstacle(*id, obstacles),
        };
        problem.map_or(Ok(()), |problem| Err(EditError::BadValue(problem)))
    }
}

fn leaf_impact(changed: bool, impact: Impact) -> Impact {
    if changed { impact } else { Impact::Appearance }
}

/// How deep the change of a body goes.
pub fn body_impact(old: &Body, new: &Body) -> Impact {
    // The modes of a body depend on where it is held.
    let moves_by_modes = [old, new].iter().any(|body| body.moves_by == MovesBy::Modes);
    let pins = if moves_by_modes { Impact::Topology } else { Impact::Parameters };
    leaf_impact(old.shape != new.shape, Impact::Topology)
        .max(leaf_impact(!old.has_same_pins(new), pins))
        .max(leaf_impact((old.pose, old.velocity) != (new.pose, new.velocity), Impact::Motion))
        .max(leaf_impact(old.material != new.material, Impact::Parameters))
        .max(leaf_impact(old.inlays != new.inlays || old.parts != new.parts, Impact::Parameters))
        .max(leaf_impact(contact_between_bodies(old) != contact_between_bodies(new), Impact::Parameters))
        .max(leaf_impact((old.moves_by, old.mode_count) != (new.moves_by, new.mode_count), Impact::Parameters))
}

/// Returns the values that decide how a body meets others and itself.
fn contact_between_bodies(body: &Body) -> ([bool; 2], [f64; 2], ContactOn) {
    ([body.collides, body.self_collides], [body.friction_static, body.friction_dynamic], body.contact_on)
}

fn obstacle_impact(old: &Obstacle, new: &Obstacle) -> Impact {
    let same_to_physics = Obstacle { name: old.name.clone(), hidden: old.hidden, ..new.clone() } == *old;
    leaf_impact(!same_to_physics, Impact::Parameters)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;
    use crate::scene::body::{CubeShape, Inlay, Part, PinBox};
    use crate::scene::material::Springs;
    use crate::scene::{ColorBy, Material, MovesBy, Pose, Shape};

    fn impact_of(change: impl FnOnce(&mut Body)) -> Impact {
        let mut scene = param::specimen();
        let mut body = scene.bodies[0].clone();
        change(&mut body);
        scene.apply(Edit::Body(BodyId(0), Box::new(body))).expect("the change is allowed").impact
    }

    #[test]
    fn the_impact_follows_from_what_changed() {
        assert_eq!(impact_of(|_| ()), Impact::Appearance, "nothing changed");
        assert_eq!(impact_of(|body| body.name = "jelly".into()), Impact::Appearance, "a name");
        let heavy = Material::Springs(Springs { particle_mass: 1.0, ..Springs::default() });
        assert_eq!(impact_of(|body| body.material = heavy), Impact::Parameters, "a mass");
        assert_eq!(impact_of(|body| body.inlays.push(Inlay::default())), Impact::Parameters, "another solid within");
        assert_eq!(impact_of(|body| body.parts.push(Part::default())), Impact::Parameters, "and by the name of a part");
        assert_eq!(impact_of(|body| body.collides = false), Impact::Parameters, "others");
        assert_eq!(impact_of(|body| body.self_collides = false), Impact::Parameters, "itself");
        assert_eq!(impact_of(|body| body.contact_on = ContactOn::Mesh), Impact::Parameters, "its mesh");
        assert_eq!(impact_of(|body| body.moves_by = MovesBy::Modes), Impact::Parameters, "by what it moves");
        assert_eq!(impact_of(|body| body.mode_count = 7), Impact::Parameters, "and how many modes");
        assert_eq!(impact_of(|body| body.friction_dynamic = 0.1), Impact::Parameters, "friction among bodies");
        assert_eq!(impact_of(|body| body.velocity[1] = 2.0), Impact::Motion, "a velocity");
        assert_eq!(impact_of(|body| body.pins.push(PinBox::default())), Impact::Parameters, "pins");
        assert_eq!(impact_of(|body| body.pinned_cells.push([0; 3])), Impact::Parameters, "pins by cells");
        let held = |body: &mut Body| (body.moves_by, body.pinned_cells) = (MovesBy::Modes, vec![[0; 3]]);
        assert_eq!(impact_of(held), Impact::Topology, "pins that modes are about");
        let cube = Shape::Cube(CubeShape { cells: 3, size: 1.0 });
        let all = impact_of(|body| *body = Body { shape: cube, name: "other".into(), ..Body::default() });
        assert_eq!(all, Impact::Topology, "the deepest of several");
    }

    #[test]
    fn a_refused_edit_changes_nothing() {
        let mut scene = param::specimen();
        let before = scene.clone();
        let count = scene.bodies.len();
        let heavy = Material::Springs(Springs { particle_mass: -1.0, ..Springs::default() });
        let bad = [
            Edit::RemoveBody(BodyId(count)),
            Edit::InsertBody(BodyId(count + 1), Box::default()),
            Edit::Obstacle(ObstacleId(99), Box::default()),
            Edit::Body(BodyId(0), Box::new(Body { material: heavy, ..Body::default() })),
            Edit::Settings(Settings { dt: f64::NAN, ..Settings::default() }),
        ];
        for edit in bad {
            scene.apply(edit.clone()).expect_err(&format!("{edit:?} is refused"));
            assert_eq!(scene, before, "{edit:?} left its mark");
        }
    }

    #[test]
    fn any_run_of_edits_undoes_to_the_same_bytes() {
        for seed in 0..50 {
            let mut rng = Rng::new(seed);
            let mut scene = param::specimen();
            let before = serde_json::to_string(&scene).expect("a scene serialises");
            let mut inverses = Vec::new();
            for _ in 0..60 {
                if let Ok(applied) = scene.apply(random_edit(&mut rng, &scene)) {
                    inverses.push(applied.inverse);
                }
            }
            assert!(inverses.len() > 20, "most random edits are allowed");
            for inverse in inverses.into_iter().rev() {
                let applied = scene.apply(inverse);
                assert!(applied.is_ok(), "an inverse applies: {applied:?}");
            }
            assert_eq!(serde_json::to_string(&scene).expect("a scene serialises"), before, "seed {seed}");
        }
    }

    fn random_edit(rng: &mut Rng, scene: &Scene) -> Edit {
        let mut below = |end: usize| usize::try_from(rng.next_u64() % end as u64).expect("small");
        let (body_id, obstacle_id) = (BodyId(below(scene.bodies.len() + 2)), ObstacleId(below(5)));
        let body = Body {
            name: format!("body {}", below(100)),
            shape: Shape::Cube(CubeShape { cells: u32::try_from(below(5)).expect("small"), size: 1.0 }),
            pose: Pose { position: [0.0, below(10) as f64 * 0.1, 0.0], ..Pose::default() },
            ..Body::default()
        };
        let obstacle = Obstacle { friction_static: below(12) as f64, ..Obstacle::default() };
        match below(8) {
            0 => Edit::Settings(Settings { dt: below(9) as f64 * 1e-3, ..Settings::default() }),
            1 => Edit::View(ViewSettings { color: ColorBy::ALL[below(8)], ..ViewSettings::default() }),
            2 => Edit::Body(body_id, Box::new(body)),
            3 => Edit::InsertBody(body_id, Box::new(body)),
            4 => Edit::RemoveBody(body_id),
            5 => Edit::Obstacle(obstacle_id, Box::new(obstacle)),
            6 => Edit::InsertObstacle(obstacle_id, Box::new(obstacle)),
            _ => Edit::RemoveObstacle(obstacle_id),
        }
    }
}
