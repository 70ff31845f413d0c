//! The picture of the present state.

use std::ops::Range;
use std::sync::Arc;

use super::{Session, color_range};
use crate::extract;
use crate::scene::ColorBy;
use crate::view::DrawList;

impl Session {
    /// The picture of the present state, from the scene's own camera.
    #[expect(clippy::cast_possible_truncation, reason = "a picture needs no more than single precision")]
    pub fn draw_list(&mut self) -> DrawList {
        let view = &self.scene.view;
        let now = (self.picture.revision, view.color, view.overlays, self.marked_box);
        if self.picture.drawn != Some(now) {
            let positions = self.simulation.state().position.iter().map(glam::Vec3::to_array);
            let mut positions: Vec<_> = positions.collect();
            self.displace_by_modes(&mut positions);
            self.picture.particles = Arc::new(positions);
            let scalars = extract::scalars::scalars(&self.simulation, view.color);
            let shown = scalars.as_deref().unwrap_or_default();
            self.picture.automatic_range = color_range::automatic(&self.simulation, view.color, shown);
            self.picture.scalars = scalars.map(Arc::new);
            let (simulation, bodies) = (&self.simulation, &self.scene.bodies);
            let source = &mut self.picture.overlay_source;
            self.picture.overlay = source.fill(simulation, bodies, view.overlays);
            if let Some((marked, model)) =
                self.marked_box.and_then(|marked| Some((marked, self.simulation.model().bodies.get(marked.body.0)?)))
            {
                let particles = &self.picture.particles[model.particles.clone()];
                let corners = [marked.min, marked.max];
                extract::own_box::add_own_box(&mut self.picture.overlay, &model.lattice, particles, corners);
            }
            if let Some(trouble) = &self.trouble {
                extract::guilty::mark_links(&mut self.picture.overlay, &trouble.guilty_links);
            }
            self.picture.drawn = Some(now);
        }
        DrawList {
            camera: extract::view::orbit(&view.camera).camera(),
            light: extract::view::light(&view.light),
            skins: self.bodies.skins(|body| !self.simulation.state().bodies[body].gone),
            absent: self.absent(),
            particles: Arc::clone(&self.picture.particles),
            painted: view.color == ColorBy::Model,
            scalars: self.picture.scalars.clone(),
            color_range: view.color_range.map_or(self.picture.automatic_range, |range| range.map(|end| end as f32)),
            solids: extract::solid::solids(
                &self.scene.obstacles,
                self.simulation.state().time_secs,
                &mut self.picture.solid_meshes,
            ),
            overlay: self.picture.overlay.clone(),
            ..DrawList::default()
        }
    }

    /// The particles of bodies that are hidden or gone.
    fn absent(&self) -> Vec<Range<usize>> {
        let memories = &self.simulation.state().bodies;
        let bodies = self.simulation.model().bodies.iter().zip(&self.scene.bodies).zip(memories);
        let absent = bodies.filter(|((_, body), memory)| body.hidden || memory.gone);
        absent.map(|((model, _), _)| model.particles.clone()).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::scene::edit::{BodyId, Edit};
    use crate::scene::presets;
    use crate::scene::view_settings::Overlays;
    use crate::session::{BoxOfBody, Command};
    use crate::view::overlay::LineEnds;

    fn toggle(session: &mut Session, overlays: Overlays) {
        let mut view = session.scene().view.clone();
        view.overlays = overlays;
        session.handle(Command::Edit(Edit::View(view))).expect("a view can be changed");
    }

    #[test]
    fn a_box_of_a_body_is_marked_as_long_as_it_is_asked_for() {
        let scene = (presets::presets()[0].build)();
        let mut session = Session::new(scene, PathBuf::new(), String::new()).expect("a preset is sound");
        session.draw_list();
        let mut lines = |marked| {
            session.handle(Command::MarkBox(marked)).expect("anyone may look");
            assert_eq!(session.status().marked_box, marked);
            session.draw_list().overlay.lines.len()
        };
        let marked = BoxOfBody { body: BodyId(0), min: [-0.1; 3], max: [0.2; 3] };
        let none = BoxOfBody { body: BodyId(7), ..marked };
        let empty = BoxOfBody { min: [0.3; 3], ..marked };
        assert_eq!([Some(marked), Some(none), Some(empty), None].map(&mut lines), [1, 0, 0, 0]);
    }

    #[test]
    fn overlays_come_and_go_by_edits_and_leave_the_motion_alone() {
        let scene = (presets::presets()[0].build)();
        let mut session = Session::new(scene, PathBuf::new(), String::new()).expect("a preset is sound");
        assert!(session.draw_list().overlay.is_empty(), "none at first");
        session.step();
        let before = session.simulation().hash();
        toggle(&mut session, Overlays { structural: true, ..Overlays::default() });
        let links = |session: &mut Session| match &session.draw_list().overlay.lines[..] {
            [lines] => match &lines.ends {
                LineEnds::Particles { ends, .. } => Arc::clone(ends),
                other => panic!("links hang on particles, not {other:?}"),
            },
            lines => panic!("one family, not {}", lines.len()),
        };
        let first = links(&mut session);
        assert_eq!(session.simulation().hash(), before, "nothing has moved");
        session.step();
        assert!(Arc::ptr_eq(&first, &links(&mut session)), "a step copies no links");
        toggle(&mut session, Overlays::default());
        assert!(session.draw_list().overlay.is_empty(), "and none at last");
    }
}
