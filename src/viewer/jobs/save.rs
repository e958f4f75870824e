//! Writing what is shown, and the scene itself, to files, in the background.

use burnish::measure::lobe::LobeCurves;
use burnish::measure::plot::{Panel, Style, lobe, log_log};
use burnish::picture::{Picture, Tone, replace_file, write};
use burnish::progressive::{Params, Recipe, Snapshot};
use burnish::scene::write::scn;
use egui::{Color32, ColorImage, Context, Rgba};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, channel};

/// Files being written.
pub(crate) struct Saving {
    what: &'static str,
    result: Receiver<Result<String, String>>,
}

impl Saving {
    /// Starts to write a snapshot; repaints once the files are there.
    pub(crate) fn snapshot(ctx: &Context, job: Job) -> Result<Saving, String> {
        Saving::start(ctx, "snapshot", move || job.run())
    }

    /// Starts to write an edited scene.
    pub(crate) fn scene(ctx: &Context, job: SceneJob) -> Result<Saving, String> {
        Saving::start(ctx, "scene", move || job.run())
    }

    /// Starts to write a plot.
    pub(crate) fn plot(ctx: &Context, job: PlotJob) -> Result<Saving, String> {
        Saving::start(ctx, "plot", move || job.run())
    }

    fn start(
        ctx: &Context,
        what: &'static str,
        run: impl FnOnce() -> Result<String, String> + Send + 'static,
    ) -> Result<Saving, String> {
        let (send, result) = channel();
        let ctx = ctx.clone();
        std::thread::Builder::new()
            .name(what.to_owned())
            .spawn(move || {
                // Nobody listens when the window has been closed; the files are written anyway.
                let _ = send.send(run().map_err(|why| format!("no {what}: {why}")));
                drop(send);
                ctx.request_repaint();
            })
            .map_err(|e| format!("no {what}: could not start a thread to write it: {e}"))?;
        Ok(Saving { what, result })
    }

    /// The place it was written to, or why it was not; `None` while it is being written.
    pub(crate) fn poll(&self) -> Option<Result<String, String>> {
        match self.result.try_recv() {
            Ok(result) => Some(result),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => {
                Some(Err(format!("no {}: writing it ended in a fault of burnish", self.what)))
            }
        }
    }
}

/// A snapshot to write, and the place it goes to.
pub(crate) struct Job {
    pub(crate) snapshot: Snapshot,
    /// The recipe to make it again; none for a picture that is older than the last change.
    pub(crate) recipe: Option<Recipe>,
    pub(crate) tone: Tone,
    pub(crate) folder: PathBuf,
    /// The name before the number, such as "table_ggx".
    pub(crate) stem: String,
}

impl Job {
    fn run(&self) -> Result<String, String> {
        let [png, exr] = free_names(&self.folder, &self.stem)
            .ok_or_else(|| format!("{} is full of them", self.folder.display()))?;
        let picture = self.snapshot.mean();
        for path in [&png, &exr] {
            match &self.recipe {
                Some(recipe) => {
                    let samples = self.snapshot.samples();
                    recipe.save_with_samples(path, &picture, &samples, self.tone)
                }
                None => write(path, &picture, self.tone),
            }
            .map_err(|e| e.to_string())?;
        }
        let plural = if self.snapshot.passes == 1 { "pass" } else { "passes" };
        Ok(format!("Wrote {} and .exr ({} {plural})", png.display(), self.snapshot.passes))
    }
}

/// An edited scene to be written, and where.
pub(crate) struct SceneJob {
    pub(crate) params: Params,
    pub(crate) folder: PathBuf,
}

impl SceneJob {
    fn run(&self) -> Result<String, String> {
        let Params { scene, materials, camera, size, .. } = &self.params;
        let text = scn(scene, materials, camera, *size, &self.folder).map_err(|e| e.to_string())?;
        let stem = plain(scene.name());
        let path = free_name(&self.folder, &stem)
            .ok_or_else(|| format!("{} is full of them", self.folder.display()))?;
        replace_file(&path, |file| file.write_all(text.as_bytes())).map_err(|e| e.to_string())?;
        Ok(format!("Wrote {}", path.display()))
    }
}

/// A plot to be written, and where.
pub(crate) struct PlotJob {
    pub(crate) plot: Plot,
    pub(crate) folder: PathBuf,
    /// The name before the number.
    pub(crate) stem: String,
}

pub(crate) enum Plot {
    /// Lobes over angle, as SVG.
    Lobes(LobeCurves, Style),
    /// Errors over time, as SVG.
    Errors(Panel),
    /// As it was on the screen.
    Png(ColorImage),
}

impl PlotJob {
    fn run(&self) -> Result<String, String> {
        let kind = if matches!(self.plot, Plot::Png(_)) { "png" } else { "svg" };
        let path = (1..100_000)
            .map(|n| self.folder.join(format!("{}_{n:04}.{kind}", self.stem)))
            .find(|path| !path.exists())
            .ok_or_else(|| format!("{} is full of them", self.folder.display()))?;
        let svg = |text: String| replace_file(&path, |file| file.write_all(text.as_bytes()));
        match &self.plot {
            Plot::Lobes(curves, style) => svg(lobe(curves, *style)?),
            Plot::Errors(panel) => svg(log_log(std::slice::from_ref(panel))?),
            Plot::Png(image) => write(&path, &as_picture(image)?, Tone::default()),
        }
        .map_err(|e| e.to_string())?;
        Ok(format!("Wrote {}", path.display()))
    }
}

/// Codes become light, which the default tones make the same codes again: the file holds what was on
/// the screen.
pub(crate) fn as_picture(image: &ColorImage) -> Result<Picture, String> {
    let side = |s: usize| u32::try_from(s).map_err(|_| "too large a window".to_owned());
    Ok(Picture {
        width: side(image.size[0])?,
        height: side(image.size[1])?,
        pixels: image.pixels.iter().map(|&code| light(code)).collect(),
    })
}

fn light(code: Color32) -> [f32; 3] {
    let [r, g, b, _] = Rgba::from(code).to_array();
    [r, g, b]
}

/// The first name for an edited scene that no file has: "table-edited.scn", "table-edited-2.scn".
fn free_name(folder: &Path, stem: &str) -> Option<PathBuf> {
    // An edited scene that was edited again.
    let unnumbered = stem.trim_end_matches(|c: char| c == '-' || c.is_ascii_digit());
    let stem = unnumbered.strip_suffix("-edited").unwrap_or(stem);
    let numbers = (2..100_000).map(|n| format!("-{n}"));
    std::iter::once(String::new())
        .chain(numbers)
        .map(|number| folder.join(format!("{stem}-edited{number}.scn")))
        .find(|path| !path.exists())
}

/// The first number of which there is neither a PNG nor an EXR.
pub(crate) fn free_names(folder: &Path, stem: &str) -> Option<[PathBuf; 2]> {
    (1..100_000)
        .map(|n| ["png", "exr"].map(|kind| folder.join(format!("{stem}_{n:04}.{kind}"))))
        .find(|names| names.iter().all(|name| !name.exists()))
}

/// Beginning of a picture's file names: the scene's name, the model's and, if the picture is wrong
/// on purpose, the erratum's.
pub(crate) fn stem(params: &Params) -> String {
    let wrong = params.erratum.filter(|e| e.concerns(params.model));
    let wrong = wrong.map_or(String::new(), |e| format!("_{}", e.name()));
    format!("{}_{}{wrong}", plain(params.scene.name()), params.model.name())
}

/// A scene's name as part of a file's: no folder, no extension, nothing unusual.
pub(crate) fn plain(scene: &str) -> String {
    let name = Path::new(scene).file_stem().map_or(scene.into(), |s| s.to_string_lossy());
    let plain: String = name
        .chars()
        .map(|c| if c.is_alphanumeric() || c == '-' || c == '_' { c } else { '-' })
        .take(80)
        .collect();
    let plain = plain.trim_matches('-');
    if plain.is_empty() { "scene".to_owned() } else { plain.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_comes_back() {
        for code in 0..=255 {
            assert_eq!(Tone::default().exact(light(Color32::from_gray(code))), [code; 3]);
        }
    }

    #[test]
    fn a_scene_gives_a_plain_file_name() {
        for (scene, expected) in [
            ("table.scn", "table"),
            ("/some/where/my scene.obj", "my-scene"),
            ("../..", "scene"),
            ("", "scene"),
            ("three balls", "three-balls"),
        ] {
            assert_eq!(plain(scene), expected, "{scene:?}");
        }
    }

    #[test]
    fn an_edited_scene_never_takes_a_name_that_is_in_use() {
        let folder = tempfile::tempdir().unwrap();
        let place = |name: &str| folder.path().join(name);
        for (stem, expected) in [
            ("two", "two-edited.scn"),
            ("two", "two-edited-2.scn"),
            ("two-edited", "two-edited-3.scn"),
            ("two-edited-2", "two-edited-4.scn"),
            ("scene-7", "scene-7-edited.scn"),
            ("7", "7-edited.scn"),
        ] {
            let free = free_name(folder.path(), stem).unwrap();
            assert_eq!(free, place(expected));
            std::fs::write(free, "").unwrap();
        }
    }

    #[test]
    fn a_number_is_free_when_neither_file_is_there() {
        let folder = tempfile::tempdir().unwrap();
        let name = |n: u32, kind: &str| folder.path().join(format!("a_ggx_{n:04}.{kind}"));
        std::fs::write(name(1, "png"), "").unwrap();
        std::fs::write(name(2, "exr"), "").unwrap();
        let free = free_names(folder.path(), "a_ggx").unwrap();
        assert_eq!(free, [name(3, "png"), name(3, "exr")]);
    }
}
