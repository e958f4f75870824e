//! Settings that the window remembers from one day to the next: looks and goal, but
//! nothing of a scene.

use crate::viewer::document::goal::{Goal, Stop};
use crate::viewer::document::recent::Recent;
use burnish::picture::{Curve, replace_file};
use egui::ThemePreference;
use serde_json::{Map, Value, json};
use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};

/// Bytes of the longest file that is read: some hundred times one that the window writes.
const LONGEST: u64 = 1 << 20;

/// All of it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Settings {
    pub(super) theme: ThemePreference,
    /// Exposure belongs to the scene.
    pub(super) curve: Curve,
    pub(super) goal: Goal,
    pub(super) recent: Recent,
    /// Whether the picture is as large as the window has room for.
    pub(super) follow: bool,
    /// Whether changed files are read again.
    pub(super) watch: bool,
    pub(super) switching: Switching,
    pub(super) place: Place,
}

/// Settings for pictures that are left for others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Switching {
    /// Memory for pictures that may be wanted again, in MiB.
    pub(super) keep: u64,
    /// Whether the other models are refined while there is nothing else to do.
    pub(super) refine: bool,
    /// The old picture stays until the new one has this many passes; 0 for its first blocks.
    pub(super) hold: u64,
}

impl Switching {
    /// Most memory that can be set, in MiB.
    pub(super) const KEEP: u64 = 1 << 20;
    /// Most passes that can be waited for.
    pub(super) const HOLD: u64 = 64;
}

impl Default for Switching {
    /// A quarter of the machine's memory, or 1 GiB where the system does not tell.
    fn default() -> Switching {
        let keep = burnish::limits::machine().map_or(1 << 10, |bytes| (bytes / 4) >> 20);
        Switching { keep: keep.min(Switching::KEEP), refine: true, hold: 1 }
    }
}

/// Place of the window on the screen, in points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Place {
    /// Width and height of its inside.
    pub(super) size: Option<[f32; 2]>,
    /// Position of its upper left corner.
    pub(super) position: Option<[f32; 2]>,
}

impl Default for Settings {
    fn default() -> Settings {
        Settings {
            theme: ThemePreference::System,
            curve: Curve::Neutral,
            goal: Goal::default(),
            recent: Recent::default(),
            follow: true,
            watch: true,
            switching: Switching::default(),
            place: Place::default(),
        }
    }
}

/// Names in the file.
const THEMES: [(ThemePreference, &str); 3] = [
    (ThemePreference::System, "system"),
    (ThemePreference::Dark, "dark"),
    (ThemePreference::Light, "light"),
];

impl Settings {
    /// Path of the file; `None` where the system does not say.
    pub(super) fn path() -> Option<PathBuf> {
        dirs::config_dir().map(|folder| folder.join("burnish").join("window.json"))
    }

    /// Reads the file. What is missing in it, broken or out of range is as on the first day: no
    /// file keeps the window from opening, and none that is longer than [`LONGEST`] is read.
    pub(super) fn read(path: &Path) -> Settings {
        let mut text = String::new();
        let all = |file: File| file.take(LONGEST + 1).read_to_string(&mut text);
        let is_whole = File::open(path).and_then(all).is_ok_and(|bytes| bytes as u64 <= LONGEST);
        match serde_json::from_str(&text) {
            Ok(Value::Object(file)) if is_whole => Settings::of(&file),
            _ => Settings::default(),
        }
    }

    fn of(file: &Map<String, Value>) -> Settings {
        let first = Settings::default();
        let text = |name: &str| file.get(name).and_then(Value::as_str);
        let number = |name: &str, [low, high]: [f64; 2]| {
            file.get(name).and_then(Value::as_f64).filter(|x| (low..=high).contains(x))
        };
        let whole =
            |name: &str, most: u64| file.get(name).and_then(Value::as_u64).filter(|n| *n <= most);
        let pair = |name: &str, [low, high]: [f32; 2]| {
            let values = file.get(name)?.as_array()?.iter().map(|v| v.as_f64().map(|x| x as f32));
            let pair: [f32; 2] = values.collect::<Option<Vec<f32>>>()?.try_into().ok()?;
            pair.iter().all(|x| (low..=high).contains(x)).then_some(pair)
        };
        let theme = text("theme").and_then(|t| THEMES.iter().find(|(_, name)| *name == t));
        let curve = text("curve").and_then(|t| Curve::ALL.into_iter().find(|c| c.name() == t));
        let stop = text("stop").and_then(|t| Stop::ALL.into_iter().find(|s| s.title() == t));
        let passes = file.get("passes").and_then(Value::as_u64);
        let recent = file.get("recent").and_then(Value::as_array).into_iter().flatten();
        Settings {
            theme: theme.map_or(first.theme, |(theme, _)| *theme),
            curve: curve.unwrap_or(first.curve),
            goal: Goal {
                stop: stop.unwrap_or(first.goal.stop),
                passes: passes
                    .filter(|p| (1..=Goal::PASSES).contains(p))
                    .unwrap_or(first.goal.passes),
                error: number("error", Goal::ERROR).unwrap_or(first.goal.error),
                seconds: number("seconds", Goal::SECONDS).unwrap_or(first.goal.seconds),
            },
            recent: Recent::new(recent.filter_map(Value::as_str).map(PathBuf::from)),
            follow: file.get("follow").and_then(Value::as_bool).unwrap_or(first.follow),
            watch: file.get("watch").and_then(Value::as_bool).unwrap_or(first.watch),
            switching: Switching {
                keep: whole("keep", Switching::KEEP).unwrap_or(first.switching.keep),
                refine: file
                    .get("refine")
                    .and_then(Value::as_bool)
                    .unwrap_or(first.switching.refine),
                hold: whole("hold", Switching::HOLD).unwrap_or(first.switching.hold),
            },
            place: Place {
                size: pair("size", [100.0, 32_768.0]),
                position: pair("position", [-32_768.0, 32_768.0]),
            },
        }
    }

    fn text(&self) -> String {
        let theme = THEMES.iter().find(|(t, _)| *t == self.theme).map(|(_, name)| *name);
        // A path that is no Unicode is not remembered.
        let recent: Vec<&str> = self.recent.paths().iter().filter_map(|p| p.to_str()).collect();
        let value = json!({
            "theme": theme,
            "curve": self.curve.name(),
            "stop": self.goal.stop.title(),
            "passes": self.goal.passes,
            "error": self.goal.error,
            "seconds": self.goal.seconds,
            "recent": recent,
            "follow": self.follow,
            "watch": self.watch,
            "keep": self.switching.keep,
            "refine": self.switching.refine,
            "hold": self.switching.hold,
            "size": self.place.size,
            "position": self.place.position,
        });
        format!("{value:#}\n")
    }

    /// Writes them, whole or not at all; makes the folder.
    pub(super) fn write(&self, path: &Path) -> Result<(), String> {
        let failed = |e: io::Error| format!("{}: {e}", path.display());
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(failed)?;
        }
        let text = self.text();
        replace_file(path, |file| file.write_all(text.as_bytes())).map_err(|e| e.to_string())
    }

    /// Forgets all.
    pub(super) fn reset(path: &Path) -> Result<(), String> {
        match fs::remove_file(path) {
            Err(e) if e.kind() != ErrorKind::NotFound => Err(format!("{}: {e}", path.display())),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounded::{EACH, FREE, bounded, is_alone};
    use crate::mutate;

    fn changed() -> Settings {
        Settings {
            theme: ThemePreference::Light,
            curve: Curve::Filmic,
            goal: Goal { stop: Stop::Error, passes: 77, error: 0.02, seconds: 5.5 },
            recent: Recent::new(["/a/b.scn".into(), "/c d.obj".into()]),
            follow: false,
            watch: false,
            switching: Switching { keep: 77, refine: false, hold: 16 },
            place: Place { size: Some([900.0, 700.5]), position: Some([-20.0, 30.0]) },
        }
    }

    #[test]
    fn what_is_written_is_read_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/folder/window.json");
        assert_eq!(Settings::read(&path), Settings::default(), "there is none yet");
        for settings in [changed(), Settings::default()] {
            settings.write(&path).unwrap();
            assert_eq!(Settings::read(&path), settings);
        }
        Settings::reset(&path).unwrap();
        Settings::reset(&path).unwrap();
        assert!(!path.exists());
    }

    #[test]
    fn a_broken_file_is_as_the_first_day_and_a_broken_value_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("window.json");
        for text in ["", "{", "[]", "null", "\u{0}\u{1}", "{\"theme\": 7, \"size\": [1]}"] {
            fs::write(&path, text).unwrap();
            assert_eq!(Settings::read(&path), Settings::default(), "{text:?}");
        }
        fs::write(&path, [0xff, 0xfe, 0x00]).unwrap();
        assert_eq!(Settings::read(&path), Settings::default());
        let whole: Value = serde_json::from_str(&changed().text()).unwrap();
        for (name, bad) in [
            ("curve", json!("neon")),
            ("passes", json!(0)),
            ("error", json!("small")),
            ("seconds", json!(-1)),
            ("keep", json!(1u64 << 40)),
            ("refine", json!(1)),
            ("hold", json!(-1)),
            ("follow", json!("yes")),
            ("recent", json!([1, null, "/a/b.scn", "/c d.obj"])),
            ("size", json!([1, 2, 3])),
            ("unknown", json!({})),
        ] {
            let mut file = whole.clone();
            file[name] = bad;
            let Value::Object(file) = file else { unreachable!() };
            let read = Settings::of(&file);
            let first = Settings::default();
            let mut expected = changed();
            match name {
                "curve" => expected.curve = first.curve,
                "passes" => expected.goal.passes = first.goal.passes,
                "error" => expected.goal.error = first.goal.error,
                "keep" => expected.switching.keep = first.switching.keep,
                "refine" => expected.switching.refine = first.switching.refine,
                "follow" => expected.follow = first.follow,
                "hold" => expected.switching.hold = first.switching.hold,
                "seconds" => expected.goal.seconds = first.goal.seconds,
                "size" => expected.place.size = None,
                _ => {}
            }
            assert_eq!(read, expected, "{name}");
        }
    }

    /// Whatever is in the file, the window opens, with values that it could have had: what was read
    /// is the same once it is written and read again. In a second, and in memory by its length.
    #[test]
    fn broken_files_open_a_window_all_the_same() {
        if !is_alone(concat!(module_path!(), "::broken_files_open_a_window_all_the_same")) {
            return;
        }
        let mut files = mutate::corpus(include_str!("../../tests/fuzz/corpus/settings.txt"));
        assert!(files.len() >= 60, "{}", files.len());
        files.insert(0, changed().text().into_bytes());
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("window.json");
        let words = ["null", "-1", "1e999", "\"", "[", "{", ",", "true", "\"dark\"", "4294967296"];
        let mut kept = 0;
        mutate::try_all(&files, 1, &words, 9, |bytes, _| {
            fs::write(&path, bytes).unwrap();
            let most = FREE + EACH * bytes.len();
            let read = bounded(most, bytes, 9, || Settings::read(&path));
            fs::write(&path, read.text()).unwrap();
            assert_eq!(Settings::read(&path), read, "{:?}", String::from_utf8_lossy(bytes));
            kept += u64::from(read != Settings::default());
        });
        assert!(kept > 20, "{kept}");
        // One that is longer than any of its kind is not read.
        File::create(&path).unwrap().set_len(1 << 32).unwrap();
        let most = FREE + 2 * LONGEST as usize;
        assert_eq!(bounded(most, b"4 GiB", 9, || Settings::read(&path)), Settings::default());
    }
}
