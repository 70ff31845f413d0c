//! A field for a path that reports errors while a person types, with the matching files of the folder below it. It works on
//! every system, with or without file dialogs. Looks at the file system only when the text changes.

use std::ops::Range;
use std::path::{Path, PathBuf};

use egui::{Button, Key, Label, RichText, ScrollArea, Sense, TextEdit, Ui, UiBuilder, WidgetInfo, vec2};

use super::super::theme;
use super::super::typed_text::select;
use crate::app::sentence::sentence;
use crate::disk::{check_new_folder, folder_of};
use crate::scene::Scene;
use crate::scene::body::MODEL_ENDINGS;
use crate::session::document::is_scene_path;
use crate::session::state_file;
use crate::text::counted;

/// The most entries of a folder that are listed; typing the name of a file to open narrows them down.
const MAX_LISTED_ENTRIES: usize = 200;
/// The height reserved for the verdict on a path, so that nothing below it moves, points.
const VERDICT_HEIGHT: f32 = 38.0;
/// The reason why there may be no file dialog of the system.
const NO_BROWSER: &str = "No window of the desktop to choose files in has answered; on Linux a portal shows it, for \
                          example the package xdg-desktop-portal-gtk. Type the path, or choose below.";

/// The purpose of the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathUse {
    /// A scene is read from it.
    OpenScene,
    /// The scene is written to it.
    SaveScene,
    /// A model is read from it.
    OpenModel,
    /// The model of an obstacle is read from it.
    OpenMesh,
    /// A state is read from it.
    OpenState,
    /// The state is written to it.
    SaveState,
    /// A folder with the scene and its models is created there.
    Collect,
}

/// The verdict on the typed path.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Verdict {
    /// Nothing or a folder was typed: there is no verdict yet.
    Unfinished,
    /// It cannot be used; the reason as a sentence.
    Unusable(String),
    /// It can be used; a description in a few words.
    Usable(PathBuf, String),
    /// It can be written, but the file exists already.
    Replaces(PathBuf),
    /// It leads to a model, but a scene is wanted.
    Model(PathBuf),
}

/// A path being typed.
#[derive(Debug)]
pub(super) struct PathField {
    text: String,
    purpose: PathUse,
    judged: Option<String>,
    verdict: Verdict,
    listed: Vec<Entry>,
    focus: bool,
}

#[derive(Clone, Debug, PartialEq, Eq)]
struct Entry {
    name: String,
    is_folder: bool,
}

impl PathField {
    /// A field that begins with a path.
    pub(super) fn new(purpose: PathUse, start: &Path) -> Self {
        let mut text = start.to_string_lossy().into_owned();
        if start.is_dir() && !text.ends_with(std::path::MAIN_SEPARATOR) {
            text.push(std::path::MAIN_SEPARATOR);
        }
        Self { text, purpose, judged: None, verdict: Verdict::Unfinished, listed: Vec::new(), focus: true }
    }

    /// Puts another path into the field.
    pub(super) fn set(&mut self, path: &Path) {
        self.text = path.to_string_lossy().into_owned();
        self.judged = None;
    }

    /// The folder of the path.
    pub(super) fn folder(&self) -> PathBuf {
        folder_typed(&self.text)
    }

    /// The verdict on the path.
    pub(super) fn verdict(&mut self) -> &Verdict {
        if self.judged.as_ref() != Some(&self.text) {
            self.verdict = judge(self.purpose, &self.text);
            self.listed = entries(self.purpose, &self.text);
            self.judged = Some(self.text.clone());
        }
        &self.verdict
    }

    /// The field with its list. Returns whether Enter was pressed in it, and whether the button beside it was. `can_browse`:
    /// the system has a file dialog. The height below the field is always `height`.
    pub(super) fn ui(&mut self, ui: &mut Ui, label: &str, can_browse: bool, height: f32) -> PathResponse {
        let mut response = PathResponse::default();
        let field = ui.horizontal(|ui| {
            let name = ui.label(RichText::new(label).color(theme::of(ui).weak));
            let width = (ui.available_width() - 92.0).max(120.0);
            let edit = TextEdit::singleline(&mut self.text).desired_width(width).hint_text("type a path");
            let field = ui.add(edit).labelled_by(name.id);
            if std::mem::take(&mut self.focus) {
                field.request_focus();
                select(ui, field.id, name_letters(&self.text));
            }
            let entered = ui.input(|input| input.key_pressed(Key::Enter));
            // Enter also counts after a click beside everything, which takes the keyboard from the field.
            response.entered = entered && (field.lost_focus() || ui.memory(|memory| memory.focused().is_none()));
            let browse = ui.add_enabled(can_browse, Button::new("Browse…"));
            let browse = browse.on_hover_text("Choose in a window of the system").on_disabled_hover_text(NO_BROWSER);
            response.browse = browse.clicked();
            field
        });
        if response.entered && matches!(self.verdict(), Verdict::Unfinished | Verdict::Unusable(_)) {
            // A person can continue typing.
            field.inner.request_focus();
        }
        self.verdict();
        let below = vec2(ui.available_width(), VERDICT_HEIGHT + height);
        ui.allocate_ui(below, |ui| {
            ui.set_min_size(below);
            self.verdict_ui(ui);
            if !can_browse {
                ui.add(Label::new(RichText::new(NO_BROWSER).small().color(theme::of(ui).weak)).wrap());
            }
            self.list_ui(ui);
        });
        response
    }

    fn verdict_ui(&self, ui: &mut Ui) {
        let (text, color) = match &self.verdict {
            Verdict::Unfinished => ("Choose from the list, or type or paste a path".to_owned(), theme::of(ui).weak),
            Verdict::Unusable(why) => (why.clone(), theme::of(ui).error),
            Verdict::Usable(_, what) => (what.clone(), theme::of(ui).weak),
            Verdict::Model(_) => ("A model, not a scene: it can be made into jelly".to_owned(), theme::of(ui).weak),
            Verdict::Replaces(_) => {
                ("There is a file of this name; it will be replaced".to_owned(), theme::of(ui).warning)
            }
        };
        let size = vec2(ui.available_width(), VERDICT_HEIGHT);
        let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
        let mut inside = ui.new_child(UiBuilder::new().max_rect(rect));
        inside.shrink_clip_rect(rect);
        let shown = inside.add(Label::new(RichText::new(&text).color(color)).wrap());
        if shown.rect.height() > VERDICT_HEIGHT {
            shown.on_hover_text(text);
        }
    }

    /// The subfolders and matching files of the typed folder; a click opens an entry.
    fn list_ui(&mut self, ui: &mut Ui) {
        let mut chosen = None;
        let height = ui.available_height().max(40.0);
        let area = ScrollArea::vertical().max_height(height).min_scrolled_height(40.0).auto_shrink([false, false]);
        area.show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 1.0;
            let folder = folder_typed(&self.text);
            let folder = std::path::absolute(&folder).unwrap_or(folder);
            if let Some(above) = folder.parent()
                && row_ui(ui, "../", "Up one folder").clicked()
            {
                chosen = Some((above.to_owned(), true));
            }
            for entry in &self.listed {
                let shown = if entry.is_folder { format!("{}/", entry.name) } else { entry.name.clone() };
                if row_ui(ui, &shown, &entry.name).clicked() {
                    chosen = Some((folder.join(&entry.name), entry.is_folder));
                }
            }
        });
        if let Some((path, is_folder)) = chosen {
            self.set(&path);
            if is_folder && !self.text.ends_with(std::path::MAIN_SEPARATOR) {
                self.text.push(std::path::MAIN_SEPARATOR);
            }
            // Typing and Enter continue from here.
            self.focus = true;
        }
    }
}

/// The interaction with a path field.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PathResponse {
    /// Enter was pressed in the field.
    pub(super) entered: bool,
    /// The system's file dialog was requested.
    pub(super) browse: bool,
}

fn row_ui(ui: &mut Ui, shown: &str, name: &str) -> egui::Response {
    let button = Button::new(RichText::new(shown).color(theme::of(ui).strong)).frame(false).truncate();
    let response = ui.add_sized([ui.available_width(), 20.0], button.right_text(""));
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, name));
    response
}

/// The path of a text; `~` is the home folder.
fn expanded(text: &str) -> PathBuf {
    let text = text.trim();
    let home = || directories::BaseDirs::new().map(|folders| folders.home_dir().to_owned());
    match text.strip_prefix('~') {
        Some("") => home().unwrap_or_else(|| text.into()),
        Some(rest) if rest.starts_with(['/', '\\']) => {
            home().map_or_else(|| text.into(), |home| home.join(rest.trim_start_matches(['/', '\\'])))
        }
        _ => text.into(),
    }
}

/// The letters of a path that are the name of its file, without the ending.
fn name_letters(text: &str) -> Range<usize> {
    let first = text.rfind(['/', '\\']).map_or(0, |at| at + 1);
    let name = &text[first..];
    let end = first + name.rfind('.').filter(|at| *at > 0).unwrap_or(name.len());
    let letters = |end: usize| text[..end].chars().count();
    letters(first)..letters(end)
}

/// The folder that a text names, or that of the file it names.
fn folder_typed(text: &str) -> PathBuf {
    let path = expanded(text);
    if text.trim().ends_with(['/', '\\']) { path } else { folder_of(&path) }
}

fn judge(purpose: PathUse, text: &str) -> Verdict {
    let path = expanded(text);
    if text.trim().is_empty() || (path.is_dir() && text.trim().ends_with(['/', '\\'])) {
        return Verdict::Unfinished;
    }
    match purpose {
        PathUse::SaveScene => judge_target(path, "ron"),
        PathUse::SaveState => judge_target(path, "state"),
        PathUse::Collect => match check_new_folder(&path) {
            Ok(()) => Verdict::Usable(path.clone(), format!("Makes the folder {}", path.display())),
            Err(error) => Verdict::Unusable(error.to_string()),
        },
        _ if !path.exists() => Verdict::Unusable(format!("{} does not exist", path.display())),
        _ if path.is_dir() => Verdict::Unusable(format!("{} is a folder", path.display())),
        PathUse::OpenModel | PathUse::OpenMesh if is_scene_path(&path) => {
            Verdict::Unusable(format!("{} is a scene, not a model; use Open…", path.display()))
        }
        PathUse::OpenModel => Verdict::Usable(path, String::new()),
        PathUse::OpenMesh => Verdict::Usable(path, "A model: it will stop bodies and keep its form".to_owned()),
        PathUse::OpenScene if is_model_path(&path) => Verdict::Model(path),
        PathUse::OpenState => match state_file::summary(&path) {
            Ok(state) => Verdict::Usable(path, format!("A state of {} at {:.3} s", state.scene, state.time_secs)),
            Err(error) => Verdict::Unusable(sentence(&error)),
        },
        PathUse::OpenScene => match Scene::load(&path) {
            Ok(scene) => Verdict::Usable(path, words(&scene)),
            Err(error) => Verdict::Unusable(sentence(&error)),
        },
    }
}

fn judge_target(path: PathBuf, ending: &str) -> Verdict {
    let folder = folder_of(&path);
    let path = if has_ending(&path, ending) { path } else { with_ending(path, ending) };
    if !folder.is_dir() {
        Verdict::Unusable(format!("the folder {} does not exist", folder.display()))
    } else if path.is_dir() {
        Verdict::Unusable(format!("{} is a folder", path.display()))
    } else if path.exists() {
        Verdict::Replaces(path)
    } else {
        let what = format!("Saves {}", path.display());
        Verdict::Usable(path, what)
    }
}

fn has_ending(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|own| own.eq_ignore_ascii_case(ending))
}

fn with_ending(path: PathBuf, ending: &str) -> PathBuf {
    let mut name = path.into_os_string();
    name.push(".");
    name.push(ending);
    name.into()
}

/// Whether a file's name is that of a model.
fn is_model_path(path: &Path) -> bool {
    MODEL_ENDINGS.iter().any(|ending| has_ending(path, ending))
}

fn words(scene: &Scene) -> String {
    let bodies = counted(scene.bodies.len(), "body", "bodies");
    let obstacles = counted(scene.obstacles.len(), "obstacle", "obstacles");
    format!("A scene of {bodies} and {obstacles}")
}

/// The matching entries of the typed folder: folders first, by name. For a path to open, the typed name narrows them down. A
/// name to save under is mostly new, and would leave the list empty.
fn entries(purpose: PathUse, text: &str) -> Vec<Entry> {
    let folder = folder_typed(text);
    let typed = expanded(text);
    let is_new = matches!(purpose, PathUse::SaveScene | PathUse::SaveState | PathUse::Collect);
    let narrowed = if is_new || text.trim().ends_with(['/', '\\']) || typed.is_file() {
        String::new()
    } else {
        typed.file_name().map(|name| name.to_string_lossy().to_lowercase()).unwrap_or_default()
    };
    let fits = |path: &Path| match purpose {
        PathUse::OpenModel | PathUse::OpenMesh => is_model_path(path),
        PathUse::OpenScene | PathUse::SaveScene => is_scene_path(path),
        // Folders are always listed.
        PathUse::Collect => false,
        PathUse::OpenState | PathUse::SaveState => has_ending(path, "state"),
    };
    let Ok(all) = std::fs::read_dir(folder) else { return Vec::new() };
    let mut found: Vec<Entry> = all
        .filter_map(Result::ok)
        .filter_map(|entry| {
            // A name that is not valid Unicode cannot be typed.
            let name = entry.file_name().into_string().ok()?;
            let is_folder = entry.path().is_dir();
            let wanted = is_folder || fits(&entry.path());
            let shown = !name.starts_with('.') && name.to_lowercase().starts_with(&narrowed);
            (wanted && shown).then_some(Entry { name, is_folder })
        })
        .collect();
    found.sort_by_key(|entry| (!entry.is_folder, entry.name.to_lowercase()));
    found.truncate(MAX_LISTED_ENTRIES);
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder() -> tempfile::TempDir {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path();
        std::fs::create_dir(path.join("sub")).expect("a folder");
        Scene::default().save(&path.join("a.ron")).expect("a scene");
        std::fs::write(path.join("bad.ron"), "(version: 1,\n bodis: [])").expect("a file");
        for model in ["cow.obj", "hat.STL", "pot.glb", "pot.bin"] {
            std::fs::write(path.join(model), "v 0 0 0\n").expect("a file");
        }
        folder
    }

    fn verdict(purpose: PathUse, folder: &tempfile::TempDir, name: &str) -> Verdict {
        judge(purpose, &folder.path().join(name).to_string_lossy())
    }

    #[test]
    fn typing_replaces_the_name_of_a_file() {
        for (text, name) in [
            ("/home/zoë/cube-on-plane.ron", "cube-on-plane"),
            ("a.b.ron", "a.b"),
            ("/x.y/scene", "scene"),
            ("/x/.hidden", ".hidden"),
            ("/x/", ""),
            ("", ""),
        ] {
            let letters = name_letters(text);
            let selected: String = text.chars().skip(letters.start).take(letters.len()).collect();
            assert_eq!(selected, name, "of {text}");
        }
    }

    #[test]
    fn a_path_to_open_is_judged_as_it_is_typed() {
        let folder = folder();
        let judged = |name| verdict(PathUse::OpenScene, &folder, name);
        assert_eq!(judged(""), Verdict::Unfinished, "a folder with its slash");
        let says = |name, words: &str| matches!(judged(name), Verdict::Unusable(why) if why.contains(words));
        assert!(says("x.ron", "does not exist"));
        assert!(says("sub", "is a folder"));
        for model in ["cow.obj", "hat.STL", "pot.glb"] {
            assert!(matches!(judged(model), Verdict::Model(_)), "{model} is told from a scene");
        }
        assert!(says("bad.ron", "bad.ron:2"), "the line is named: {:?}", judged("bad.ron"));
        assert!(matches!(judged("a.ron"), Verdict::Usable(_, what) if what == "A scene of 0 bodies and 0 obstacles"));
    }

    #[test]
    fn a_path_to_save_to_gets_its_ending_and_a_warning_where_a_file_is() {
        let folder = folder();
        let judged = |name| verdict(PathUse::SaveScene, &folder, name);
        assert!(matches!(judged("new"), Verdict::Usable(path, _) if path.ends_with("new.ron")));
        assert!(matches!(judged("a"), Verdict::Replaces(path) if path.ends_with("a.ron")));
        assert!(matches!(judged("none/a.ron"), Verdict::Unusable(why) if why.contains("folder")));
    }

    #[test]
    fn a_state_says_what_it_is_of_and_gets_its_own_ending() {
        let folder = folder();
        std::fs::write(folder.path().join("old.state"), "gelatin-state 1\n").expect("a file");
        let judged = |name| verdict(PathUse::OpenState, &folder, name);
        assert!(matches!(judged("old.state"), Verdict::Unusable(why) if why.contains("another version")));
        assert!(matches!(judged("a.ron"), Verdict::Unusable(why) if why.contains("no state")));
        let saved = |name| verdict(PathUse::SaveState, &folder, name);
        assert!(matches!(saved("moment"), Verdict::Usable(path, _) if path.ends_with("moment.state")));
        assert!(matches!(saved("old"), Verdict::Replaces(path) if path.ends_with("old.state")));
        let text = format!("{}/", folder.path().display());
        let names = entries(PathUse::OpenState, &text).into_iter().map(|entry| entry.name);
        assert_eq!(names.collect::<Vec<_>>(), ["sub", "old.state"]);
    }

    #[test]
    fn a_name_to_save_under_hides_nothing_of_the_list() {
        let folder = folder();
        let names = |purpose, typed: &str| {
            let text = format!("{}/{typed}", folder.path().display());
            entries(purpose, &text).into_iter().map(|entry| entry.name).collect::<Vec<_>>()
        };
        std::fs::write(folder.path().join("old.state"), "").expect("a file");
        assert_eq!(names(PathUse::SaveScene, "cube-on-plane.ron"), ["sub", "a.ron", "bad.ron"]);
        assert_eq!(names(PathUse::SaveState, "cube-on-plane.state"), ["sub", "old.state"]);
        assert_eq!(names(PathUse::Collect, "cube-on-plane"), ["sub"]);
    }

    #[test]
    fn the_list_shows_folders_and_what_fits_narrowed_by_what_is_typed() {
        let folder = folder();
        let names = |purpose, typed: &str| {
            let text = format!("{}/{typed}", folder.path().display());
            entries(purpose, &text).into_iter().map(|entry| entry.name).collect::<Vec<_>>()
        };
        assert_eq!(names(PathUse::OpenScene, ""), ["sub", "a.ron", "bad.ron"]);
        assert_eq!(names(PathUse::OpenScene, "B"), ["bad.ron"]);
        assert_eq!(names(PathUse::OpenModel, ""), ["sub", "cow.obj", "hat.STL", "pot.glb"]);
        assert_eq!(names(PathUse::OpenModel, "nowhere/"), [""; 0]);
    }
}
