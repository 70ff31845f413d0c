//! Whatever a person does, in any order: nothing panics, nothing stops being finite, and everything can be taken back.

use std::path::{Path, PathBuf};

use super::{Command, Pull, Session};
use crate::math::rng::Rng;
use crate::scene::body::{CubeShape, Inlay, PinBox, Pose};
use crate::scene::edit::{BodyId, Edit, ObstacleId};
use crate::scene::material::{Solid, Spring, Springs};
use crate::scene::obstacle::{Capsule, Cuboid, Cylinder, ObstacleShape, Plane, Sphere};
use crate::scene::presets::preset;
use crate::scene::resolve::resolve;
use crate::scene::settings::{ContactRule, Stepping};
use crate::scene::{Body, ColorBy, Material, Obstacle, Scene, Settings, Shape, ViewSettings};

/// Rounds, and commands in each: fewer than can be taken back.
const ROUNDS: u64 = 20;
const COMMANDS: usize = 500;

#[test]
fn ten_thousand_random_commands_leave_everything_whole_and_can_be_taken_back() {
    let mut taken = 0;
    for seed in 0..ROUNDS {
        let mut hand = Hand(Rng::new(seed));
        let mut session = Session::new(start(), PathBuf::new(), String::new()).expect("a preset resolves");
        let before = bytes(&session);
        for _ in 0..COMMANDS {
            let command = hand.command(session.scene());
            let refused = session.handle(command.clone()).is_err();
            taken += usize::from(!refused);
            if session.playing && session.status().substeps < 20 {
                session.step();
            }
            let sound = session.simulation().state().position.iter().all(|at| at.is_finite());
            assert!(sound && session.simulation().diagnostics().finite, "seed {seed}: not finite after {command:?}");
            let picture = session.draw_list();
            assert!(picture.color_range.iter().all(|end| end.is_finite()), "seed {seed}: no colours after {command:?}");
        }
        while !session.status().undo.is_empty() {
            session.handle(Command::Undo).expect("what was done can be undone");
        }
        assert_eq!(bytes(&session), before, "seed {seed}: taken back to the same bytes");
    }
    assert!(taken > 5000, "most commands are allowed: {taken}");
}

fn start() -> Scene {
    let mut scene = (preset("cube-on-plane").expect("a preset").build)();
    scene.bodies[0].shape = Shape::Cube(CubeShape { cells: 3, size: 1.0 });
    scene
}

fn bytes(session: &Session) -> String {
    serde_json::to_string(session.scene()).expect("a scene serialises")
}

/// Somebody who does anything.
struct Hand(Rng);

impl Hand {
    fn below(&mut self, end: usize) -> usize {
        usize::try_from(self.0.next_u64() % end as u64).expect("small")
    }

    /// Anything from the least to the most, and now and then something that is no number.
    fn number(&mut self, least: f64, most: f64) -> f64 {
        let wild = [f64::NAN, f64::INFINITY, -1e300];
        match self.below(40) {
            0 => wild[self.below(wild.len())],
            1 => least,
            2 => most,
            _ => least + (most - least) * (self.below(1000) as f64 / 999.0),
        }
    }

    fn vector(&mut self, reach: f64) -> [f64; 3] {
        std::array::from_fn(|_| self.number(-reach, reach))
    }

    fn command(&mut self, scene: &Scene) -> Command {
        match self.below(22) {
            21 => Command::CancelEdit,
            20 => Command::Teleport(self.body_id(scene), self.vector(3.0)),
            0 => Command::Play,
            1 => Command::Pause,
            2 => Command::StepOnce,
            3 => Command::Restart,
            4 => Command::SetSpeed(self.number(0.0, 12.0)),
            5 => Command::EndEdit,
            6 => Command::Undo,
            7 => Command::Redo,
            8 => Command::Grab(self.pull()),
            9 => {
                let body = self.body();
                match resolve(&body.shape, Path::new("."), &()) {
                    Ok(jelly) if scene.bodies.len() < 4 => {
                        Command::AddBody { body: Box::new(body), jelly: Box::new(jelly) }
                    }
                    _ => Command::EndEdit,
                }
            }
            10 => Command::Drag(self.edit(scene)),
            _ => Command::Edit(self.edit(scene)),
        }
    }

    fn body_id(&mut self, scene: &Scene) -> BodyId {
        BodyId(self.below(scene.bodies.len() + 2))
    }

    fn pull(&mut self) -> Option<Pull> {
        let target = self.vector(5.0).map(|x| {
            #[expect(clippy::cast_possible_truncation, reason = "any place will do")]
            let x = x as f32;
            x
        });
        let weights = (0..4).map(|_| (u32::try_from(self.below(80)).expect("small"), 0.25)).collect();
        (self.below(3) > 0).then(|| Pull { body: BodyId(self.below(2)), weights, target })
    }

    fn edit(&mut self, scene: &Scene) -> Edit {
        let body_id = self.body_id(scene);
        let obstacle_id = ObstacleId(self.below(scene.obstacles.len() + 2));
        let full = scene.bodies.len() > 3;
        match self.below(8) {
            0 => Edit::Settings(Settings {
                dt: self.number(1e-4, 0.02),
                stepping: if self.below(4) == 0 { Stepping::Manual } else { Stepping::Auto },
                contact: if self.below(6) == 0 { ContactRule::Thesis } else { ContactRule::Implicit },
                gravity: self.vector(50.0),
                ..scene.settings.clone()
            }),
            1 => Edit::View(ViewSettings { color: ColorBy::ALL[self.below(8)], ..scene.view.clone() }),
            2 => Edit::RemoveBody(body_id),
            3 if !full => Edit::InsertBody(body_id, Box::new(self.body())),
            4 => Edit::Obstacle(obstacle_id, Box::new(self.obstacle())),
            5 => Edit::InsertObstacle(obstacle_id, Box::new(self.obstacle())),
            6 => Edit::RemoveObstacle(obstacle_id),
            _ => {
                let Some(mut body) = scene.bodies.get(body_id.0).cloned() else { return Edit::RemoveBody(body_id) };
                let other = self.body();
                match self.below(7) {
                    0 => body.material = other.material,
                    1 => body.pose = other.pose,
                    2 => body.velocity = other.velocity,
                    3 => (body.pins, body.inlays) = (other.pins, other.inlays),
                    4 => body.hidden = !body.hidden,
                    5 => body.name.push('x'),
                    _ => body = other,
                }
                Edit::Body(body_id, Box::new(body))
            }
        }
    }

    fn body(&mut self) -> Body {
        let spring = |hand: &mut Self| Spring { stiffness: hand.number(0.0, 200.0), damping: hand.number(0.0, 1.0) };
        let springs = Springs {
            structural: spring(self),
            shear: spring(self),
            bending: spring(self),
            particle_mass: self.number(0.01, 1.0),
        };
        let cells = u32::try_from(self.below(4)).expect("small");
        let solid = Solid { young_modulus: self.number(1e3, 1e5), ..Solid::default() };
        let material = if self.below(3) == 0 { Material::Solid(solid) } else { Material::Springs(springs) };
        let inlays =
            vec![Inlay { min: self.vector(1.0), max: self.vector(1.0), solid, ..Inlay::default() }; self.below(2)];
        let pins = vec![PinBox { min: self.vector(1.0), max: self.vector(1.0) }; self.below(2)];
        Body {
            name: format!("body {}", self.below(9)),
            shape: Shape::Cube(CubeShape { cells, size: self.number(0.2, 2.0) }),
            pose: Pose { position: self.vector(3.0), rotation_deg: self.vector(180.0) },
            velocity: self.vector(20.0),
            material,
            inlays,
            pins,
            ..Body::default()
        }
    }

    fn obstacle(&mut self) -> Obstacle {
        let (center, rotation_deg) = (self.vector(2.0), self.vector(90.0));
        let [radius, half_height] = [0; 2].map(|_| self.number(0.1, 1.0));
        let shape = match self.below(5) {
            0 => ObstacleShape::Sphere(Sphere { center, radius }),
            1 => ObstacleShape::Box(Cuboid { center, rotation_deg, half_extents: [radius, half_height, radius] }),
            2 => ObstacleShape::Capsule(Capsule { center, rotation_deg, radius, half_height }),
            3 => ObstacleShape::Cylinder(Cylinder { center, rotation_deg, radius, half_height }),
            _ => {
                let half_extents = [self.number(0.1, 5.0), self.number(0.1, 5.0)];
                ObstacleShape::Plane(Plane { center, rotation_deg, half_extents })
            }
        };
        Obstacle { shape, friction_static: self.number(0.0, 1.0), ..Obstacle::default() }
    }
}
