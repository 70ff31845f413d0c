//! Where things of a list are after some were put into it or taken out of it, by undo or otherwise. What is chosen is known by
//! its place in the list.

use crate::app::hand::Target;
use crate::scene::Scene;
use crate::scene::edit::{BodyId, ObstacleId};

/// The bodies and the obstacles of a scene, as far as is needed to find them again.
#[derive(Clone, Debug, Default)]
pub struct KnownThings {
    bodies: Vec<Known>,
    obstacles: Vec<Known>,
}

/// What a thing is known by: its name, or where it is if it shares its name with others or has none.
#[derive(Clone, Debug, PartialEq)]
struct Known {
    name: String,
    position: [f64; 3],
}

impl KnownThings {
    /// The things of a scene.
    pub(super) fn of(scene: &Scene) -> Self {
        let bodies = scene.bodies.iter().map(|body| Known { name: body.name.clone(), position: body.pose.position });
        let obstacles = scene.obstacles.iter();
        let obstacles = obstacles.map(|thing| Known { name: thing.name.clone(), position: thing.shape.center() });
        Self { bodies: bodies.collect(), obstacles: obstacles.collect() }
    }

    /// Whether these are the things of a scene, as they are now.
    pub(super) fn are_of(&self, scene: &Scene) -> bool {
        let is = |known: &Known, name: &str, position: [f64; 3]| {
            known.name == name && known.position.map(f64::to_bits) == position.map(f64::to_bits)
        };
        let [bodies, obstacles] = [&self.bodies, &self.obstacles];
        bodies.len() == scene.bodies.len()
            && obstacles.len() == scene.obstacles.len()
            && bodies.iter().zip(&scene.bodies).all(|(known, body)| is(known, &body.name, body.pose.position))
            && obstacles.iter().zip(&scene.obstacles).all(|(known, thing)| is(known, &thing.name, thing.shape.center()))
    }

    /// Returns what one of these things is among those that are there now; none where it is gone.
    pub(super) fn moved(&self, now: &Self, target: Target) -> Option<Target> {
        match target {
            Target::Body(id) => moved(&self.bodies, &now.bodies, id.0).map(|to| Target::Body(BodyId(to))),
            Target::Obstacle(id) => {
                moved(&self.obstacles, &now.obstacles, id.0).map(|to| Target::Obstacle(ObstacleId(to)))
            }
        }
    }
}

fn moved(before: &[Known], now: &[Known], place: usize) -> Option<usize> {
    // What was chosen before its list was seen is where it is.
    let Some(thing) = before.get(place) else { return Some(place) };
    by_name(before, now, &thing.name).or_else(|| by_neighbours(before, now, place))
}

/// Returns the place of the thing of this name, if there was one of it and there is one now.
fn by_name(before: &[Known], now: &[Known], name: &str) -> Option<usize> {
    let only_place = |list: &[Known]| {
        let mut places = (0..list.len()).filter(|&place| list[place].name == name);
        places.next().filter(|_| !name.is_empty() && places.next().is_none())
    };
    only_place(before).and_then(|_| only_place(now))
}

/// Returns the place of a thing by what the two lists have in common at their beginnings and their ends.
fn by_neighbours(before: &[Known], now: &[Known], place: usize) -> Option<usize> {
    let shorter = before.len().min(now.len());
    let is_same = |(old, new): &(&Known, &Known)| old == new;
    let first = before.iter().zip(now).take_while(is_same).count();
    let last = before.iter().rev().zip(now.iter().rev()).take(shorter - first).take_while(is_same).count();
    if place < first {
        return Some(place);
    }
    if place + last >= before.len() {
        return Some(place + now.len() - before.len());
    }
    // Between them, a thing of which only a value is another is still the same.
    let is_changed =
        before.len() == now.len() && (first + last + 1 == shorter || before[place].name == now[place].name);
    is_changed.then_some(place)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Things by their names, of which a digit is none, each with its own position.
    fn list(names: &str) -> Vec<Known> {
        let name = |letter: char| if letter.is_ascii_digit() { String::new() } else { letter.to_string() };
        names.chars().map(|letter| Known { name: name(letter), position: [f64::from(u32::from(letter)); 3] }).collect()
    }

    fn places(before: &[Known], now: &[Known]) -> Vec<Option<usize>> {
        (0..before.len()).map(|place| moved(before, now, place)).collect()
    }

    #[test]
    fn places_follow_what_is_put_in_and_taken_out() {
        let to = |before: &str, now: &str| places(&list(before), &list(now));
        assert_eq!(to("ac", "abc"), [Some(0), Some(2)], "one comes back between them");
        assert_eq!(to("abc", "ac"), [Some(0), None, Some(1)], "and goes");
        assert_eq!(to("abcd", "ad"), [Some(0), None, None, Some(1)], "two go");
        assert_eq!(to("ab", "abc"), [Some(0), Some(1)], "one is added at the end");
        assert_eq!(to("abc", "axc"), [Some(0), Some(1), Some(2)], "a name is another");
        assert_eq!(to("bcd", "abc"), [Some(1), Some(2), None], "one comes and one goes");
    }

    #[test]
    fn things_without_names_are_known_by_where_they_are() {
        let to = |before: &str, now: &str| places(&list(before), &list(now));
        assert_eq!(to("23", "123"), [Some(1), Some(2)], "one comes back before them");
        assert_eq!(to("123", "13"), [Some(0), None, Some(1)], "and goes");
        assert_eq!(to("123", "193"), [Some(0), Some(1), Some(2)], "one is elsewhere");
        let mut twins = list("abc");
        twins[1].name = "a".to_owned();
        assert_eq!(places(&twins[1..], &twins), [Some(1), Some(2)], "nor by a name that two have");
    }
}
