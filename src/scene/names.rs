//! Names of bodies and obstacles: no two alike, so that a list and the words of undo say which one is meant.

use super::Scene;
use super::edit::Edit;

impl Scene {
    /// Makes the name that an edit gives to a body or an obstacle unique: a second "ogre" becomes "ogre 2". An unchanged
    /// name and an empty one are left alone.
    pub fn make_names_unique(&self, edit: &mut Edit) {
        let own_body = if let Edit::Body(id, _) = edit { Some(id.0) } else { None };
        let own_obstacle = if let Edit::Obstacle(id, _) = edit { Some(id.0) } else { None };
        let bodies = self.bodies.iter().map(|body| body.name.as_str()).enumerate();
        let obstacles = self.obstacles.iter().map(|obstacle| obstacle.name.as_str()).enumerate();
        let others = |own: Option<usize>| move |&(place, _): &(usize, &str)| Some(place) != own;
        let taken: Vec<&str> = bodies
            .filter(others(own_body))
            .chain(obstacles.filter(others(own_obstacle)))
            .map(|(_, name)| name)
            .collect();
        let (old, name) = match edit {
            Edit::Body(id, new) => (self.bodies.get(id.0).map(|old| &old.name), &mut new.name),
            Edit::Obstacle(id, new) => (self.obstacles.get(id.0).map(|old| &old.name), &mut new.name),
            Edit::InsertBody(_, new) => (None, &mut new.name),
            Edit::InsertObstacle(_, new) => (None, &mut new.name),
            Edit::Settings(_) | Edit::View(_) | Edit::RemoveBody(_) | Edit::RemoveObstacle(_) => return,
        };
        if old != Some(name) && !name.is_empty() {
            *name = unused_name(name, &taken);
        }
    }
}

/// Returns the name or, where it is taken, the first numbered form of it that is free.
fn unused_name(name: &str, taken: &[&str]) -> String {
    if !taken.contains(&name) {
        return name.to_owned();
    }
    let stem = name.trim_end_matches(|letter: char| letter.is_ascii_digit());
    let stem = stem.strip_suffix(' ').filter(|stem| !stem.is_empty() && stem.len() + 1 < name.len()).unwrap_or(name);
    let is_free = |name: &String| !taken.contains(&name.as_str());
    (2..=taken.len() + 2).map(|number| format!("{stem} {number}")).find(is_free).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::edit::{BodyId, ObstacleId};
    use crate::scene::{Body, Obstacle};

    fn scene() -> Scene {
        let body = |name: &str| Body { name: name.into(), ..Body::default() };
        let obstacles = vec![Obstacle { name: "Ground".into(), ..Obstacle::default() }];
        Scene { bodies: vec![body("ogre"), body("ogre 2"), body("")], obstacles, ..Scene::default() }
    }

    fn inserted(name: &str) -> String {
        let mut edit = Edit::InsertBody(BodyId(3), Box::new(Body { name: name.into(), ..Body::default() }));
        scene().make_names_unique(&mut edit);
        let Edit::InsertBody(_, body) = edit else { panic!("still the same edit") };
        body.name
    }

    fn renamed(place: usize, name: &str) -> String {
        let scene = scene();
        let mut edit = Edit::Body(BodyId(place), Box::new(Body { name: name.into(), ..scene.bodies[place].clone() }));
        scene.make_names_unique(&mut edit);
        let Edit::Body(_, body) = edit else { panic!("still the same edit") };
        body.name
    }

    #[test]
    fn what_comes_gets_a_name_of_its_own() {
        assert_eq!(inserted("cow"), "cow", "nobody has it");
        assert_eq!(inserted("ogre"), "ogre 3", "the first number that is free");
        assert_eq!(inserted("ogre 2"), "ogre 3", "a number counts on");
        assert_eq!(inserted("Ground"), "Ground 2", "obstacles count too");
        assert_eq!(inserted(""), "", "no name is no name");
        assert_eq!([inserted("2"), inserted("R2D2")], ["2", "R2D2"], "digits of a name are left alone");
    }

    #[test]
    fn a_new_name_differs_from_those_of_others_and_an_old_one_stays() {
        assert_eq!(renamed(1, "ogre 2"), "ogre 2", "its own");
        assert_eq!(renamed(1, "ogre"), "ogre 2", "nobody else has that");
        assert_eq!(renamed(0, "ogre 2"), "ogre 3", "another has that: a number counts on");
        let mut twins = scene();
        twins.bodies[1].name = "ogre".into();
        let mut edit = Edit::Body(BodyId(1), Box::new(Body { hidden: true, ..twins.bodies[1].clone() }));
        twins.make_names_unique(&mut edit);
        assert!(
            matches!(&edit, Edit::Body(_, body) if body.name == "ogre"),
            "a file's names stay as they are: {edit:?}"
        );
        let mut edit = Edit::Obstacle(ObstacleId(0), Box::new(Obstacle { name: "ogre".into(), ..Obstacle::default() }));
        scene().make_names_unique(&mut edit);
        assert!(matches!(&edit, Edit::Obstacle(_, obstacle) if obstacle.name == "ogre 3"), "{edit:?}");
    }
}
