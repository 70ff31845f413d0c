//! The place of an obstacle with a mesh.

use egui::{Label, RichText, Ui};

use crate::app::ui::theme;
use crate::app::ui::value::{AXES, Interaction, field_ui, vector_ui};
use crate::scene::builtin;
use crate::scene::obstacle::Mesh;

/// The name and kind of the mesh, and its place.
pub(super) fn mesh_ui(ui: &mut Ui, path: impl Fn(&str) -> String, mesh: &mut Mesh) -> Interaction {
    let name = mesh.path.strip_prefix(builtin::PREFIX).unwrap_or(&mesh.path);
    let name = name.rsplit(['/', '\\']).next().unwrap_or(name);
    let what = mesh.surface().map_or_else(String::new, |surface| {
        let sides = if surface.is_closed() { "closed" } else { "open: it stops bodies on both its sides" };
        format!("{} triangles, {sides}", surface.triangles().len())
    });
    let weak = theme::of(ui).weak;
    ui.add(Label::new(name).truncate()).on_hover_text(&mesh.path);
    ui.add(Label::new(RichText::new(what).small().color(weak)).wrap());
    let mut interaction = vector_ui(ui, &path("center"), "Centre", &AXES, &mut mesh.center);
    interaction.and(vector_ui(ui, &path("rotation_deg"), "Rotation", &AXES, &mut mesh.rotation_deg));
    interaction.and(field_ui(ui, &path("length"), "Length", &mut mesh.length));
    interaction
}
