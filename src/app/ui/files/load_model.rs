//! The assistant that makes a model into jelly: the file, how finely it is divided, and a preview of the result before
//! anything is changed. Every change of a value starts the work anew; the work itself is done elsewhere.

use egui::{ComboBox, DragValue, Grid, ProgressBar, RichText, ScrollArea, Ui, Vec2};

use super::assistant::{LoadModel, ModelSource, Work};
use super::dialog::{buttons_ui, dialog_ui, main_button_ui};
use super::path_field::PathUse;
use super::{FileRequest, Running, UiState};
use crate::app::hand::Target;
use crate::app::ui::entry::entry_ui;
use crate::app::ui::words::capitalised;
use crate::app::ui::{adding, theme};
use crate::machine::bytes_text;
use crate::scene::body::{Keep, MAX_DIVISIONS, MODEL_FORMATS, ModelShape, OccupancyChoice, UpAxis};
use crate::scene::edit::BodyId;
use crate::session::jellify::{Preview, occupancy_word, up_axis_word};
use crate::session::predict::speed_in_window;
use crate::session::step_words::limit_text;
use crate::session::{Command, Status};
use crate::text::counted;
use crate::view::legend::three_digits;

/// The heights of the list of files and of the preview, and the height of the rest of the dialog, points.
const HEIGHTS: [f32; 2] = [140.0, 236.0];
const REST: f32 = 350.0;
/// The dialog's width and that of the picture in it, points.
const WIDTH: f32 = 760.0;
const PICTURE_WIDTH: f32 = 290.0;
/// The height of the text below the picture, points.
const BELOW_PICTURE: f32 = 100.0;
/// The time between two looks at the progress.
const REFRESH_INTERVAL: std::time::Duration = std::time::Duration::from_millis(60);

/// The assistant, when it is open.
pub(super) fn load_model_ui(ui: &mut Ui, running: Running<'_>, state: &mut UiState, commands: &mut Vec<Command>) {
    let Some(mut model) = state.files.model.take() else { return };
    let mut done = !model.is_sound(running);
    let title = if let ModelSource::Body(_) = model.source { "Fill model" } else { "Load model" };
    let escaped = dialog_ui(ui, title, WIDTH, |ui| {
        let room = (ui.ctx().content_rect().height() - REST).max(0.0);
        let [list, work] = HEIGHTS.map(|height| height * (room / HEIGHTS.iter().sum::<f32>()).clamp(0.25, 1.0));
        let mut entered = false;
        if let ModelSource::File(field) = &mut model.source {
            let response = field.ui(ui, "Model", !state.files.no_browser, list);
            if response.browse {
                state.files.requests.push(FileRequest::Browse(PathUse::OpenModel, field.folder()));
            }
            entered = response.entered;
        } else if let Some(body) = model.body(running) {
            ui.label(RichText::new(&body.name).color(theme::of(ui).strong));
        }
        ui.separator();
        model.follow(ui, running, &mut state.files.requests);
        let work = if let ModelSource::Body(_) = model.source { work + list } else { work };
        ui.horizontal_top(|ui| {
            let width = (ui.available_width() - PICTURE_WIDTH - ui.spacing().item_spacing.x).max(0.0);
            let left = ui.allocate_ui(Vec2::new(width, 0.0), |ui| {
                ui.vertical(|ui| {
                    values_ui(ui, &mut model.shape);
                    ui.separator();
                    work_ui(ui, &model, work, running.status, &mut state.files.requests);
                });
            });
            let height = left.response.rect.height();
            ui.vertical(|ui| {
                if let Work::Ready(body) = &model.work {
                    let size = Vec2::new(PICTURE_WIDTH, (height - BELOW_PICTURE).max(0.5 * PICTURE_WIDTH));
                    model.inset.ui(ui, &body.picture, &body.preview, size);
                }
            });
        });
        ui.add_space(6.0);
        buttons_ui(ui, |ui| {
            let ready = matches!(model.work, Work::Ready(_));
            let is_new = matches!(model.source, ModelSource::File(_));
            let main = if is_new { "Add to scene" } else { "Apply" };
            let add = main_button_ui(ui, main, ready).clicked() || (entered && ready);
            let replace = is_new && ui.add_enabled(ready, egui::Button::new("Replace scene")).clicked();
            done |= ui.button("Close").clicked();
            if (add || replace)
                && let Work::Ready(body) = std::mem::take(&mut model.work)
            {
                done = true;
                match &model.source {
                    ModelSource::Body(id) => commands.push(body.refill(*id)),
                    ModelSource::File(field) => {
                        state.files.folders.model = std::path::absolute(field.folder()).ok();
                        if add {
                            state.awaited = Some(Target::Body(BodyId(running.scene.bodies.len())));
                            commands.push(body.add_to(&adding::surroundings(running), state.look));
                        } else {
                            commands.extend(body.replace());
                        }
                    }
                }
            }
        });
    });
    if escaped || done {
        state.files.requests.push(FileRequest::StopJellifying);
    } else {
        state.files.model = Some(model);
    }
}

fn values_ui(ui: &mut Ui, shape: &mut ModelShape) {
    Grid::new("model values").num_columns(4).spacing([12.0, 8.0]).show(ui, |ui| {
        let label = ui.label(RichText::new("Divisions").color(theme::of(ui).weak));
        ui.add(DragValue::new(&mut shape.divisions).range(1..=MAX_DIVISIONS).speed(0.2))
            .labelled_by(label.id)
            .on_hover_text("Cells along the longest extent");
        let label = ui.label(RichText::new("Length").color(theme::of(ui).weak));
        ui.add(DragValue::new(&mut shape.length).range(0.0..=1000.0).speed(0.01).max_decimals(3).suffix(" m"))
            .labelled_by(label.id)
            .on_hover_text("The longest extent; 0 keeps the file's own size");
        ui.end_row();
        let label = ui.label(RichText::new("Fill").color(theme::of(ui).weak));
        let combo = ComboBox::from_id_salt("occupancy").width(140.0).selected_text(occupancy_word(shape.occupancy));
        let response = combo.show_ui(ui, |ui| {
            for (choice, help) in [
                (OccupancyChoice::Auto, "By what the model is like"),
                (OccupancyChoice::Centre, "Cells whose centre is inside"),
                (OccupancyChoice::Surface, "Cells that the surface touches"),
                (OccupancyChoice::Solid, "Cells that the surface touches, and all that they enclose"),
            ] {
                let entry = entry_ui(ui, shape.occupancy == choice, occupancy_word(choice)).on_hover_text(help);
                if entry.clicked() {
                    shape.occupancy = choice;
                }
            }
        });
        response.response.labelled_by(label.id);
        let label = ui.label(RichText::new("Keep").color(theme::of(ui).weak));
        let word = |keep: Keep| if keep == Keep::All { "all pieces" } else { "the largest piece" };
        let combo = ComboBox::from_id_salt("keep").width(140.0).selected_text(word(shape.keep));
        let response = combo.show_ui(ui, |ui| {
            for keep in [Keep::Largest, Keep::All] {
                if entry_ui(ui, shape.keep == keep, word(keep)).clicked() {
                    shape.keep = keep;
                }
            }
        });
        response.response.labelled_by(label.id);
        ui.end_row();
        let label = ui.label(RichText::new("Up axis").color(theme::of(ui).weak));
        let combo = ComboBox::from_id_salt("up axis").width(140.0).selected_text(up_axis_word(shape.up));
        let response = combo.show_ui(ui, |ui| {
            for up in UpAxis::ALL {
                let choice = entry_ui(ui, shape.up == up, up_axis_word(up));
                if choice.clicked() {
                    shape.up = up;
                }
                if up == UpAxis::Auto {
                    choice.on_hover_text("z where the model stands only that way, y otherwise");
                }
            }
        });
        response.response.labelled_by(label.id);
        ui.end_row();
    });
}

/// The progress of the work and its result, always at the same height, so that the buttons below do not move.
fn work_ui(ui: &mut Ui, model: &LoadModel, height: f32, status: &Status, requests: &mut Vec<FileRequest>) {
    let area = ScrollArea::vertical().max_height(height).min_scrolled_height(height).auto_shrink([false, false]);
    area.show(ui, |ui| match &model.work {
        Work::Idle => {
            let choose = format!("Choose a model file: {MODEL_FORMATS}.");
            let words = if model.wanted_shape.is_some() { "…".to_owned() } else { choose };
            ui.label(RichText::new(words).color(theme::of(ui).weak));
        }
        Work::Running(progress) => {
            ui.ctx().request_repaint_after(REFRESH_INTERVAL);
            ui.horizontal(|ui| {
                let bar = ProgressBar::new(progress.fraction()).desired_width(380.0).show_percentage();
                ui.add(bar);
                if ui.button("Stop").clicked() {
                    requests.push(FileRequest::StopJellifying);
                }
            });
        }
        Work::Failed(why) => {
            ui.add(egui::Label::new(RichText::new(why).color(theme::of(ui).error)).wrap());
        }
        Work::Ready(body) => preview_ui(ui, &body.preview, status),
    });
}

fn preview_ui(ui: &mut Ui, preview: &Preview, status: &Status) {
    // Warnings come before the numbers, which do not all fit in the dialog.
    for warning in &preview.warnings {
        let text = RichText::new(capitalised(warning)).color(theme::of(ui).warning);
        ui.add(egui::Label::new(text).wrap());
    }
    Grid::new("preview").num_columns(2).spacing([16.0, 5.0]).min_row_height(18.0).show(ui, |ui| {
        for (name, value) in rows(preview, status) {
            ui.label(RichText::new(name).color(theme::of(ui).weak));
            ui.add(egui::Label::new(RichText::new(value).color(theme::of(ui).strong)).wrap());
            ui.end_row();
        }
    });
}

fn rows(preview: &Preview, status: &Status) -> Vec<(&'static str, String)> {
    let Preview { triangles, parts, joined_parts, thin_parts, components, dropped_cells, .. } = preview;
    let (triangles, parts) = (counted(*triangles, "triangle", "triangles"), counted(*parts, "part", "parts"));
    let dropped = counted(*dropped_cells, "cell", "cells");
    let closed = if preview.closed { "closed" } else { "open" };
    let [occupancy, why] = &preview.occupancy;
    let [x, y, z] = preview.size_m.map(three_digits);
    let safe = match preview.dt_safe_secs {
        secs if secs.is_finite() => format!("{}, limited by {}", limit_text(secs), preview.dt_limited_by),
        _ => "no limit".to_owned(),
    };
    let up = match up_axis_word(preview.up) {
        word if preview.up_guessed => format!("{word}, guessed"),
        word => word.to_owned(),
    };
    vec![
        ("Mesh", format!("{triangles}, {closed}, {parts} ({joined_parts} joined, {thin_parts} thin)")),
        ("Up axis", up),
        ("Filled", format!("{occupancy}: {why}")),
        ("Cells", format!("{} of {} m", preview.cells, three_digits(preview.cell_size_m))),
        ("Components", format!("{components} ({dropped} dropped)")),
        ("Particles", preview.particles.to_string()),
        ("Links", preview.links.to_string()),
        ("Mass", format!("{} kg", three_digits(preview.mass_kg))),
        ("Memory", format!("about {}", bytes_text(preview.memory_bytes))),
        ("Box", format!("{x} × {y} × {z} m")),
        ("Safe step", safe),
        ("Speed", preview.speed_alone.map_or_else(|| "it explodes".to_owned(), |alone| speed_words(alone, status))),
    ]
}

/// The speed that the window will show with the body alone, and beside everything that moves now.
fn speed_words(alone: f64, status: &Status) -> String {
    let words = |beside| match speed_in_window(alone, beside, status.processor_share) {
        factor if factor >= 1.0 => format!("real time (up to {factor:.1}×)"),
        factor => format!("{factor:.2}× real time"),
    };
    let by_itself = words(f64::INFINITY);
    if status.speed_alone.is_finite() && !status.at_rest {
        format!("{by_itself} by itself, {} beside what is there", words(status.speed_alone))
    } else {
        by_itself
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_speed_is_said_as_the_window_will_show_it() {
        let said = |alone, status: &Status| speed_words(alone, status);
        let still = Status { processor_share: 0.5, speed_alone: f64::INFINITY, ..Status::default() };
        assert_eq!(said(0.8, &still), "0.40× real time");
        assert_eq!(said(6.4, &still), "real time (up to 3.2×)");
        let busy = Status { speed_alone: 0.8, ..still };
        assert_eq!(said(0.8, &busy), "0.40× real time by itself, 0.20× real time beside what is there");
        assert_eq!(said(0.8, &Status { at_rest: true, ..busy }), "0.40× real time", "what rests costs nothing");
    }
}
