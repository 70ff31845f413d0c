//! Where things of a list are after some were put into it or taken out of it, by undo or otherwise. What is chosen is known by its
//! place in the list.

use crate::app::hand::Target;
use crate::scene::Scene;
use crate::scene::edit::{BodyId, ObstacleId};

/// The names of the bodies and the obstacles that were there last.
#[derive(Clone, Debug, Default)]
pub struct KnownNames {
    bodies: Vec<String>,
    obstacles: Vec<String>,
}

impl KnownNames {
    /// Returns what a thing of the scene before is in this one; none where it is gone.
    pub(super) fn moved(&self, scene: &Scene, target: Target) -> Option<Target> {
        let (bodies, obstacles) = names(scene);
        match target {
            Target::Body(BodyId(place)) => moved(&self.bodies, &bodies, place).map(|to| Target::Body(BodyId(to))),
            Target::Obstacle(ObstacleId(place)) => {
                moved(&self.obstacles, &obstacles, place).map(|to| Target::Obstacle(ObstacleId(to)))
            }
        }
    }

    /// Whether as many things are there as were.
    pub(super) fn are_as_many_as_in(&self, scene: &Scene) -> bool {
        [self.bodies.len(), self.obstacles.len()] == [scene.bodies.len(), scene.obstacles.len()]
    }

    /// Takes over the names of a scene.
    pub(super) fn update(&mut self, scene: &Scene) {
        let (bodies, obstacles) = names(scene);
        let differ = |known: &[String], names: &[&str]| !known.iter().eq(names);
        if differ(&self.bodies, &bodies) || differ(&self.obstacles, &obstacles) {
            let owned = |names: Vec<&str>| names.into_iter().map(str::to_owned).collect();
            *self = Self { bodies: owned(bodies), obstacles: owned(obstacles) };
        }
    }
}

fn names(scene: &Scene) -> (Vec<&str>, Vec<&str>) {
    let bodies = scene.bodies.iter().map(|body| body.name.as_str());
    (bodies.collect(), scene.obstacles.iter().map(|obstacle| obstacle.name.as_str()).collect())
}

/// Returns the place of a thing in a list from which things were taken out, or into which they were put, at one place; none where
/// it was taken out. Lists that differ otherwise are of different scenes: the place stays.
fn moved(before: &[String], now: &[&str], place: usize) -> Option<usize> {
    let same = |(known, name): &(&String, &&str)| known.as_str() == **name;
    let first = before.iter().zip(now).take_while(same).count();
    let last = before.iter().rev().zip(now.iter().rev()).take_while(same).count();
    let shorter = before.len().min(now.len());
    if place >= before.len() || before.len() == now.len() || first + last < shorter || place < first {
        return Some(place);
    }
    if now.len() > before.len() {
        return Some(place + now.len() - before.len());
    }
    let taken = before.len() - now.len();
    (place >= first + taken).then(|| place - taken)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_follow_what_is_put_in_and_taken_out() {
        let list = |names: &'static str| names.chars().map(String::from).collect::<Vec<_>>();
        let to = |before: &'static str, now: &'static str| {
            let (before, now) = (list(before), list(now));
            let names: Vec<&str> = now.iter().map(String::as_str).collect();
            (0..before.len()).map(|place| moved(&before, &names, place)).collect::<Vec<_>>()
        };
        assert_eq!(to("ac", "abc"), [Some(0), Some(2)], "one comes back between them");
        assert_eq!(to("abc", "ac"), [Some(0), None, Some(1)], "and goes");
        assert_eq!(to("abcd", "ad"), [Some(0), None, None, Some(1)], "two go");
        assert_eq!(to("ab", "abc"), [Some(0), Some(1)], "one is added at the end");
        assert_eq!(to("abc", "axc"), [Some(0), Some(1), Some(2)], "a name is another");
        assert_eq!(to("ab", "xyz"), [Some(0), Some(1)], "another scene");
    }
}
