//! What a person should know before wondering at the motion: a sentence each.

use super::Session;
use super::pin_warnings::pin_warnings;
use super::step_words::step_text;
use crate::math::{Aabb, Real, Vector};
use crate::physics::{BodyMemory, MOST_PARTS_BETWEEN_BODIES};
use crate::physics::{BodyModel, Model};
use crate::physics::{Plan, State};
use crate::scene::settings::{ContactRule, Integrator, Settings, Stepping};
use crate::scene::{self, Body, ContactOn, Scene, named};
use crate::view::legend::three_digits;

impl Session {
    /// Returns the warnings about the models of its bodies, a sentence each.
    pub fn model_warnings(&self) -> Vec<String> {
        self.bodies.warnings(self.scene())
    }

    /// Returns all warnings about the scene, a sentence each.
    pub fn warnings(&self) -> Vec<String> {
        let (model, state) = (self.simulation().model(), self.simulation().state());
        let mut warnings = scene::warnings(self.scene());
        warnings.extend(self.modes_warnings());
        warnings.extend(self.model_warnings());
        warnings.extend(never_stable(&self.scene().settings));
        warnings.extend(taken_over(&self.scene().settings, self.simulation().plan()));
        warnings.extend(pin_warnings(self.scene(), model));
        warnings.extend(small_obstacles(self.scene(), self.simulation().plan(), model));
        warnings.extend(no_body_contact(&self.scene().settings, self.simulation().plan(), model));
        warnings.extend(not_on_mesh(self.scene(), self.simulation().plan(), model));
        warnings.extend(overlaps(self.scene(), model, state));
        warnings.extend(unresolved(self.scene(), model, state));
        warnings
    }
}

/// Warns of a scheme that no division of a step makes stable: its steps are not divided.
fn never_stable(settings: &Settings) -> Option<String> {
    let Settings { integrator, stepping, dt, .. } = settings;
    (*stepping == Stepping::Auto && !integrator.has_stable_step()).then(|| {
        format!(
            "{} makes undamped vibrations grow at any step, so automatic stepping has nothing to divide by: steps of {} \
             are taken as asked for",
            integrator.words(),
            step_text(*dt)
        )
    })
}

/// Warns of another scheme in place of the chosen one: the implicit integrator quiets vibrations.
fn taken_over(settings: &Settings, plan: &Plan) -> Option<String> {
    let taken = Integrator::from(plan.scheme);
    if settings.integrator == Integrator::Stabilised && taken == Integrator::SemiImplicit {
        return Some(format!(
            "{} has no long step for vibrations with hardly any damping: {} takes its place, with steps of {}",
            settings.integrator.words(),
            taken.words(),
            step_text(plan.substep_secs())
        ));
    }
    (taken != settings.integrator && taken == Integrator::Implicit).then(|| {
        format!(
            "{} would need {} substeps in every step of {} with {}: {} has taken over, with steps of {}; it quiets \
             vibrations sooner (without “Other schemes where cheaper” they stay, in slow motion)",
            plan.limits.limited_by(settings.dt).words(),
            plan.limits.substeps(settings.dt),
            step_text(settings.dt),
            settings.integrator.words(),
            taken.words(),
            step_text(plan.substep_secs())
        )
    })
}

/// Warns of obstacles smaller than a cell that pass through a body unnoticed between its particles, as they have no edges that
/// meet its cells, or nothing meets these.
fn small_obstacles<R: Real>(scene: &Scene, plan: &Plan, model: &Model<R>) -> Vec<String> {
    let meets_edges = plan.on_mesh.is_some() && model.bodies.iter().all(|body| body.modes().is_none());
    let largest_cell = model.bodies.iter().map(|body| body.lattice.grid.cell_size).fold(0.0, f64::max);
    let sizes = scene.obstacles.iter().map(|obstacle| obstacle.shape.width()).enumerate();
    sizes
        .filter(|(_, size)| *size < largest_cell)
        .filter(|(index, _)| !(meets_edges && model.obstacles[*index].has_edges()))
        .map(|(index, size)| {
            format!(
                "{} is {} m small, less than a cell of {} m: it can slip between particles",
                named(&scene.obstacles[index].name, "obstacle", index),
                three_digits(size),
                three_digits(largest_cell)
            )
        })
        .collect()
}

/// Warns of bodies so far from the origin that positions do not resolve their cells: rounding error in the lengths of the
/// links then pushes.
fn unresolved<R: Real>(scene: &Scene, model: &Model<R>, state: &State<R>) -> Vec<String> {
    // Of a cell; a strain of a hundredth of that is seen.
    const COARSE: f64 = 0.01;
    let bodies = model.bodies.iter().zip(&state.bodies).enumerate();
    let there = bodies.filter(|(_, (_, memory))| !memory.gone);
    there
        .filter_map(|(index, (body, _))| {
            let Aabb { min, max } = bounds(body, state);
            let known_to = R::EPSILON.to_f64() * min.abs().max(max.abs()).max_element();
            let cell = body.lattice.grid.cell_size;
            (known_to > COARSE * cell).then(|| {
                format!(
                    "{} has cells of {} m and is so far from the origin that positions are known to {} m: it shakes by \
                     itself; nearer the origin, or larger, it would not",
                    named(&scene.bodies[index].name, "body", index),
                    three_digits(cell),
                    three_digits(known_to)
                )
            })
        })
        .collect()
}

/// Warns of bodies that are to meet each other but cannot with the scheme in use.
fn no_body_contact<R: Real>(settings: &Settings, plan: &Plan, model: &Model<R>) -> Option<String> {
    let are_to_meet = model.bodies.iter().filter(|body| body.meets_others()).count() > 1;
    (are_to_meet && plan.between_bodies.is_none()).then(|| {
        if settings.stepping == Stepping::Auto {
            return format!(
                "bodies pass through each other: they are so stiff that a step of {} would be taken in more than \
                 {MOST_PARTS_BETWEEN_BODIES} parts where they meet; softer or heavier ones collide",
                step_text(plan.substep_secs())
            );
        }
        format!(
            "bodies pass through each other with {} in manual steps: automatic stepping leaves bodies that meet to {}",
            settings.integrator.words(),
            Integrator::SemiImplicit.words()
        )
    })
}

/// Warns of bodies that are to meet obstacles with their mesh but do so with their cells.
fn not_on_mesh<R: Real>(scene: &Scene, plan: &Plan, model: &Model<R>) -> Vec<String> {
    let asked = scene.bodies.iter().enumerate().filter(|(_, body)| body.contact_on == ContactOn::Mesh);
    let words = |(index, body): (usize, &Body)| {
        let name = named(&body.name, "body", index);
        if model.bodies[index].sample_count() == 0 {
            return Some(format!(
                "{name} meets obstacles with its cells: it is no model, so there is no mesh to meet them with"
            ));
        }
        let moves_by_cells = model.bodies[index].modes().is_none();
        let is_met = !scene.obstacles.is_empty() && plan.on_mesh.is_none() && moves_by_cells;
        is_met.then(|| {
            let why = match &scene.settings {
                Settings { contact: ContactRule::Thesis, .. } => "the thesis's rule knows particles alone".to_owned(),
                Settings { stepping: Stepping::Manual, integrator, .. } => format!(
                    "{} in manual steps has no place for its mesh; automatic stepping leaves such steps to {}",
                    integrator.words(),
                    Integrator::SemiImplicit.words()
                ),
                _ => format!(
                    "it is so stiff that a step of {} would be taken in more than {MOST_PARTS_BETWEEN_BODIES} parts",
                    step_text(plan.substep_secs())
                ),
            };
            format!("{name} meets obstacles with its cells: {why}")
        })
    };
    asked.filter_map(words).collect()
}

/// Warns of pairs of bodies that overlap but do not collide, as contact is switched off for one of them: of each pair where
/// there are few, of their number otherwise.
fn overlaps<R: Real>(scene: &Scene, model: &Model<R>, state: &State<R>) -> Vec<String> {
    const NAMED: usize = 3;
    // A body that is gone overlaps no other.
    let there = |(body, memory): (_, &BodyMemory)| if memory.gone { Aabb::empty() } else { bounds(body, state) };
    let boxes: Vec<Aabb<f64>> = model.bodies.iter().zip(&state.bodies).map(there).collect();
    let pairs = (1..boxes.len()).flat_map(|second| (0..second).map(move |first| [first, second]));
    let is_let_through = |pair: &[usize; 2]| pair.iter().any(|body| !model.bodies[*body].meets_others());
    let overlap = |&[first, second]: &[usize; 2]| boxes[first].overlaps(&boxes[second]);
    let met: Vec<[usize; 2]> = pairs.filter(|pair| is_let_through(pair) && overlap(pair)).collect();
    let both = |pair: &[usize; 2]| pair.map(|index| named(&scene.bodies[index].name, "body", index)).join(" and ");
    match met.as_slice() {
        few if few.len() <= NAMED => {
            let words = |pair| format!("{} are in each other's way, and their contact is switched off", both(pair));
            few.iter().map(words).collect()
        }
        many => vec![format!(
            "{} pairs of bodies are in each other's way, {} among them, and their contact is switched off",
            many.len(),
            both(&many[0])
        )],
    }
}

fn bounds<R: Real>(body: &BodyModel<R>, state: &State<R>) -> Aabb<f64> {
    Aabb::around(state.position[body.particles.clone()].iter().map(|at| at.to_dvec3()))
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::scene::body::ModelShape;
    use crate::scene::obstacle::Sphere;
    use crate::scene::{Material, Obstacle, ObstacleShape, Shape};
    use crate::session::Simulation;

    fn warnings(change: impl FnOnce(&mut Scene)) -> Vec<String> {
        let mut scene = Scene { bodies: vec![Body::default()], ..Scene::default() };
        change(&mut scene);
        Session::new(scene, PathBuf::new(), String::new()).expect("cubes resolve").warnings()
    }

    #[test]
    fn a_plain_scene_has_none() {
        assert_eq!(warnings(|_| {}), Vec::<String>::new(), "nothing to say");
    }

    #[test]
    fn a_body_too_small_for_where_it_is_says_that_it_shakes() {
        let at = |height: f64| warnings(|scene| scene.bodies[0].pose.position[1] = height);
        assert_eq!(at(1e3), Vec::<String>::new(), "a ninth of a metre is resolved a kilometre out");
        let far = at(1e5);
        assert!(far.len() == 1 && far[0].contains("cells of 0.111 m") && far[0].contains("shakes"), "{far:?}");
    }

    #[test]
    fn a_scheme_that_was_replaced_says_so() {
        let stiff = |scene: &mut Scene| {
            let Material::Springs(springs) = &mut scene.bodies[0].material else { return };
            springs.shear.stiffness = 1e6;
        };
        let said = warnings(stiff);
        assert!(said.len() == 1 && said[0].contains("shear stiffness") && said[0].contains("implicit"), "{said:?}");
        let slow = warnings(|scene| {
            stiff(scene);
            scene.settings.allow_implicit = false;
        });
        assert_eq!(slow, Vec::<String>::new(), "slow motion says so itself, while it runs");
    }

    #[test]
    fn a_scheme_that_is_never_stable_says_why_it_is_not_divided() {
        let said = warnings(|scene| scene.settings.integrator = Integrator::Rk2);
        assert!(said.len() == 1 && said[0].contains("Runge–Kutta 2"), "{said:?}");
        let manual = warnings(|scene| {
            scene.settings.integrator = Integrator::Rk2;
            scene.settings.stepping = Stepping::Manual;
        });
        assert_eq!(manual, Vec::<String>::new(), "who steps by hand knows");
    }

    #[test]
    fn bodies_in_one_place_whose_contact_is_off_say_so() {
        let twin = || Body { name: "Twin".to_owned(), collides: false, ..Body::default() };
        let said = warnings(|scene| scene.bodies.push(twin()));
        assert!(said.len() == 1 && said[0].contains("body 1 and Twin"), "both are named: {said:?}");
        let said = warnings(|scene| {
            scene.bodies = vec![Body::default(); 20];
            scene.settings.body_contact = false;
        });
        assert!(said.len() == 1 && said[0].contains("190 pairs of bodies"), "a crowd is counted: {said:?}");
        let said = warnings(|scene| scene.bodies.push(Body::default()));
        assert_eq!(said, Vec::<String>::new(), "they collide");
    }

    #[test]
    fn a_body_that_meets_obstacles_with_its_cells_though_its_mesh_was_asked_for_says_why() {
        let said = warnings(|scene| scene.bodies[0].contact_on = ContactOn::Mesh);
        assert!(said.len() == 1 && said[0].contains("it is no model"), "{said:?}");
        let on_mesh = |change: fn(&mut Settings)| {
            warnings(|scene| {
                let path = "builtin:spot.obj".to_owned();
                scene.bodies[0].shape = Shape::Model(ModelShape { path, divisions: 8, ..ModelShape::default() });
                scene.bodies[0].contact_on = ContactOn::Mesh;
                scene.obstacles = vec![Obstacle::default()];
                change(&mut scene.settings);
            })
        };
        assert_eq!(on_mesh(|_| ()), Vec::<String>::new(), "a model has one");
        let told = |said: &[String], words: &str| said.iter().any(|said| said.contains(words));
        let said = on_mesh(|settings| {
            (settings.stepping, settings.integrator) = (Stepping::Manual, Integrator::Stabilised);
        });
        assert!(told(&said, "manual steps has no place for its mesh"), "{said:?}");
        let said = on_mesh(|settings| settings.contact = ContactRule::Thesis);
        assert!(told(&said, "particles alone"), "{said:?}");
    }

    #[test]
    fn an_obstacle_smaller_than_a_cell_says_so_where_no_edge_of_it_meets_cells() {
        let said_of_ball = |change: fn(&mut Settings)| {
            let said = warnings(|scene| {
                let pea = ObstacleShape::Sphere(Sphere { center: [0.0, -5.0, 0.0], radius: 0.05 });
                scene.obstacles = vec![Obstacle { name: "Pea".to_owned(), shape: pea, ..Obstacle::default() }];
                change(&mut scene.settings);
            });
            said.iter().any(|said| said.contains("Pea is 0.1 m small, less than a cell of 0.111 m"))
        };
        assert!(!said_of_ball(|_| ()), "points on it meet cells");
        let by_hand: fn(&mut Settings) =
            |settings| (settings.stepping, settings.integrator) = (Stepping::Manual, Integrator::Stabilised);
        assert!(said_of_ball(by_hand), "manual steps of the stabilised scheme have no place for that");
        assert!(said_of_ball(|settings| settings.contact = ContactRule::Thesis), "the thesis knows particles alone");
    }

    #[test]
    fn bodies_that_a_scheme_lets_pass_say_so() {
        let by_hand = |scene: &mut Scene| {
            (scene.settings.stepping, scene.settings.integrator) = (Stepping::Manual, Integrator::Stabilised);
        };
        let said = warnings(|scene| {
            scene.bodies.push(Body::default());
            by_hand(scene);
        });
        assert!(said.len() == 1 && said[0].contains("pass through each other with"), "{said:?}");
        assert_eq!(warnings(by_hand), Vec::<String>::new(), "one body meets none");
        // Modal bodies keep the implicit scheme from solving for stiff ones beside them.
        let scene = Scene { bodies: vec![Body::default(); 2], ..Scene::default() };
        let simulation = Simulation::<f32>::from_scene(&scene, "".as_ref()).expect("a sound scene");
        let mut plan = simulation.plan().clone();
        plan.between_bodies = None;
        let said = no_body_contact(&scene.settings, &plan, simulation.model());
        assert!(said.is_some_and(|said| said.contains("so stiff that a step of")));
        assert_eq!(no_body_contact(&scene.settings, simulation.plan(), simulation.model()), None);
    }
}
