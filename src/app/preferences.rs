//! The settings that a person finds again at the next start: colours, panels, the size of text, folders. Kept in the state
//! folder as soon as they change.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::kept_file::KeptFile;
use super::theme::Theme;
use super::ui::{Panels, Widths};

/// The smallest and largest magnification of text.
const ZOOM: [f32; 2] = [0.5, 3.0];

/// The settings found again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Preferences {
    /// The colours of the interface and the view.
    pub theme: Theme,
    /// Which panels are open.
    pub panels: Panels,
    /// How wide the panels beside the view are.
    pub widths: Widths,
    /// The magnification of everything.
    pub zoom: f32,
    /// Where scenes and models were last looked for.
    pub folders: Folders,
}

/// The folders that dialogs start in.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Folders {
    /// Where a scene was last opened or saved.
    pub scene: Option<PathBuf>,
    /// Where the last model came from.
    pub model: Option<PathBuf>,
}

impl Default for Preferences {
    fn default() -> Self {
        Self {
            theme: Theme::default(),
            panels: Panels::default(),
            widths: Widths::default(),
            zoom: 1.0,
            folders: Folders::default(),
        }
    }
}

/// The preferences and their file.
#[derive(Debug)]
pub(super) struct PreferencesFile {
    file: KeptFile,
    kept: Preferences,
}

impl PreferencesFile {
    /// Reads the file in a state folder. Without a folder or with a damaged file, the defaults hold.
    pub(super) fn open(folder: Option<&Path>) -> Self {
        let file = KeptFile::new(folder, "preferences.json", "the preferences");
        let mut kept: Preferences = file.read();
        kept.widths = kept.widths.allowed();
        kept.zoom = kept.zoom.clamp(ZOOM[0], ZOOM[1]);
        Self { file, kept }
    }

    /// The last preferences kept.
    pub(super) fn preferences(&self) -> &Preferences {
        &self.kept
    }

    /// Writes the preferences if they have changed.
    pub(super) fn keep(&mut self, now: Preferences) {
        if now != self.kept {
            self.kept = now;
            self.file.write(&self.kept);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arranged() -> Preferences {
        Preferences {
            theme: Theme::Light,
            panels: Panels { tree: false, ..Panels::default() },
            widths: Widths { list: 240.0, values: 400.0 },
            zoom: 1.3,
            folders: Folders { scene: Some("/home/a/scenes".into()), model: Some("/home/a/models".into()) },
        }
    }

    fn read(folder: &Path) -> Preferences {
        PreferencesFile::open(Some(folder)).preferences().clone()
    }

    #[test]
    fn what_was_arranged_is_found_again() {
        let folder = tempfile::tempdir().expect("a folder");
        assert_eq!(read(folder.path()), Preferences::default(), "nothing at first");
        PreferencesFile::open(Some(folder.path())).keep(arranged());
        assert_eq!(read(folder.path()), arranged());
    }

    #[test]
    fn nothing_is_written_while_nothing_changes() {
        let folder = tempfile::tempdir().expect("a folder");
        PreferencesFile::open(Some(folder.path())).keep(Preferences::default());
        assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 0);
    }

    #[test]
    fn a_damaged_file_gives_the_usual_and_is_written_anew() {
        let folder = tempfile::tempdir().expect("a folder");
        for damaged in ["", "{\"theme\": \"Li", "[1, 2]", "{\"theme\": \"pink\"}", "{\"zoom\": 1e999}"] {
            std::fs::write(folder.path().join("preferences.json"), damaged).expect("a file");
            assert_eq!(read(folder.path()), Preferences::default(), "{damaged}");
        }
        PreferencesFile::open(Some(folder.path())).keep(arranged());
        assert_eq!(read(folder.path()), arranged(), "mended");
    }

    #[test]
    fn what_no_window_could_show_is_brought_back_into_its_range() {
        let folder = tempfile::tempdir().expect("a folder");
        let text = "{\"zoom\": 1000, \"widths\": {\"list\": -4, \"values\": 1e9}, \"of a later version\": 1}";
        std::fs::write(folder.path().join("preferences.json"), text).expect("a file");
        let Preferences { zoom, widths, theme, .. } = read(folder.path());
        assert_eq!((zoom, theme), (3.0, Theme::Dark));
        assert_eq!(widths, widths.allowed());
    }
}
