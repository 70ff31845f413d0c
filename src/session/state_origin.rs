//! The scene that a saved state belongs to, in words: what must be alike so that a state fits, and what a person is told
//! where it does not. One line of JSON at the head of a state.

use serde::{Deserialize, Serialize};

use crate::physics::BodyModel;
use crate::physics::Simulation;
use crate::scene::{Body, Scene, named};
use crate::text::counted;

/// What a state says of the scene that it was saved from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Origin {
    /// The scene's title.
    scene: String,
    bodies: Vec<OriginBody>,
    planes: usize,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct OriginBody {
    name: String,
    particles: usize,
}

impl Origin {
    /// Describes a scene with this title as it is now.
    pub(super) fn of(title: &str, scene: &Scene, simulation: &Simulation<f32>) -> Self {
        let bodies = scene.bodies.iter().zip(&simulation.model().bodies);
        let body = |(body, model): (&Body, &BodyModel<f32>)| OriginBody {
            name: body.name.clone(),
            particles: model.particles.len(),
        };
        Self { scene: title.to_owned(), bodies: bodies.map(body).collect(), planes: simulation.state().side.len() }
    }

    /// The scene's title.
    pub(super) fn scene(&self) -> &str {
        &self.scene
    }

    /// Returns the first reason why a state of this scene does not fit `here`, in words; none where it fits. Names, places
    /// and materials may differ: a state can go on under other values too.
    pub(super) fn difference(&self, here: &Self) -> Option<String> {
        let (saved, present) = (self.bodies.len(), here.bodies.len());
        if saved != present {
            return Some(format!("it has {}, this scene has {present}", counted(saved, "body", "bodies")));
        }
        let pairs = self.bodies.iter().zip(&here.bodies).enumerate();
        if let Some((place, (saved, present))) = { pairs }.find(|(_, (saved, here))| saved.particles != here.particles)
        {
            let name = |body: &OriginBody| named(&body.name, "body", place);
            let kind = if saved.name.is_empty() { "" } else { "body " };
            return Some(format!(
                "its {kind}{} has {} particles, {} in this scene has {}",
                name(saved),
                saved.particles,
                name(present),
                present.particles
            ));
        }
        (self.planes != here.planes)
            .then(|| format!("it has {}, this scene has {}", counted(self.planes, "plane", "planes"), here.planes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn origin(bodies: &[(&str, usize)], planes: usize) -> Origin {
        let body = |&(name, particles): &(&str, usize)| OriginBody { name: name.to_owned(), particles };
        Origin { scene: "tower".to_owned(), bodies: bodies.iter().map(body).collect(), planes }
    }

    #[test]
    fn the_first_difference_is_named_by_what_a_person_sees() {
        let saved = origin(&[("Cube", 1000), ("Spot", 1750)], 1);
        assert_eq!(saved.difference(&origin(&[("Red", 1000), ("Cow", 1750)], 1)), None, "names are free");
        let fewer = saved.difference(&origin(&[("Cube", 1000)], 1));
        assert_eq!(fewer.as_deref(), Some("it has 2 bodies, this scene has 1"));
        let finer = saved.difference(&origin(&[("Cube", 1000), ("Cow", 9000)], 1));
        assert_eq!(finer.as_deref(), Some("its body Spot has 1750 particles, Cow in this scene has 9000"));
        let nameless = origin(&[("", 8)], 1).difference(&origin(&[("", 27)], 1));
        assert_eq!(nameless.as_deref(), Some("its body 1 has 8 particles, body 1 in this scene has 27"));
        let planes = saved.difference(&origin(&[("Cube", 1000), ("Spot", 1750)], 0));
        assert_eq!(planes.as_deref(), Some("it has 1 plane, this scene has 0"));
    }
}
