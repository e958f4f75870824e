//! Several pictures by one command: each scene with each model, and the files of each.

use burnish::brdf::Model;
use burnish::plain;
use burnish::scene::builtin::EXAMPLES;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// One picture to render.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Job {
    /// The default scene without one.
    pub(super) scene: Option<PathBuf>,
    pub(super) model: Model,
    /// Pictures to write.
    pub(super) outputs: Vec<PathBuf>,
    /// Where `--stats` go.
    pub(super) stats: Option<PathBuf>,
    /// Where `--checkpoint` goes.
    pub(super) checkpoint: Option<PathBuf>,
}

impl Job {
    /// All that it writes.
    pub(super) fn files(&self) -> impl Iterator<Item = &PathBuf> {
        self.outputs.iter().chain(&self.stats).chain(&self.checkpoint)
    }

    /// "table.scn, GGX"
    pub(super) fn title(&self) -> String {
        let scene = self.scene.as_deref().unwrap_or(Path::new(EXAMPLES[0].name));
        format!("{}, {}", plain::path(scene), self.model.title())
    }
}

/// Scene by scene, each with all models, the patterns in the files' names filled in. An error says
/// which two would write one file, or which pattern is not known.
pub(super) fn jobs(
    scenes: &[PathBuf],
    models: &[Model],
    outputs: &[PathBuf],
    (stats, checkpoint): (Option<&Path>, Option<&Path>),
) -> Result<Vec<Job>, String> {
    let scenes: Vec<Option<&PathBuf>> =
        if scenes.is_empty() { vec![None] } else { scenes.iter().map(Some).collect() };
    let mut jobs = Vec::new();
    for scene in scenes {
        for &model in models {
            let name = scene.map_or(EXAMPLES[0].name.into(), |s| stem(s));
            let fill = |pattern: &Path| filled(pattern, &name, model.name());
            jobs.push(Job {
                scene: scene.cloned(),
                model,
                outputs: outputs.iter().map(|p| fill(p)).collect::<Result<_, _>>()?,
                stats: stats.map(fill).transpose()?,
                checkpoint: checkpoint.map(fill).transpose()?,
            });
        }
    }
    match twice(&jobs) {
        Some(clash) => Err(clash),
        None => Ok(jobs),
    }
}

/// A scene's name without folder and ending.
fn stem(scene: &Path) -> String {
    scene.file_stem().unwrap_or(scene.as_os_str()).to_string_lossy().into_owned()
}

/// Replaces `{name}` and `{model}`.
fn filled(pattern: &Path, name: &str, model: &str) -> Result<PathBuf, String> {
    // A path that is not Unicode is taken as it is.
    let Some(text) = pattern.to_str() else { return Ok(pattern.to_owned()) };
    let mut parts = text.split('{');
    let mut path = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (word, rest) = part.split_once('}').ok_or_else(|| unknown(text))?;
        path += match word {
            "name" => name,
            "model" => model,
            _ => return Err(unknown(text)),
        };
        path += rest;
    }
    Ok(path.into())
}

fn unknown(pattern: &str) -> String {
    format!("{pattern}: in braces only {{name}}, the scene's, and {{model}} are known")
}

/// A file that would be written twice.
fn twice(jobs: &[Job]) -> Option<String> {
    let mut first: HashMap<&PathBuf, &Job> = HashMap::new();
    for job in jobs {
        for file in job.files() {
            if let Some(other) = first.insert(file, job) {
                let file = plain::path(file);
                return Some(if std::ptr::eq(other, job) {
                    format!("{file} is to be written twice")
                } else {
                    format!(
                        "{} and {} would both write {file}: put {} into its name",
                        other.title(),
                        job.title(),
                        if other.scene == job.scene { "{model}" } else { "{name}" }
                    )
                });
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn made(scenes: &[&str], models: &[Model], outputs: &[&str]) -> Result<Vec<Job>, String> {
        let paths = |texts: &[&str]| texts.iter().map(PathBuf::from).collect::<Vec<_>>();
        jobs(&paths(scenes), models, &paths(outputs), (None, None))
    }

    #[test]
    fn every_scene_meets_every_model() {
        let jobs = made(&["a/x.scn", "y.ply"], &Model::ALL, &["o/{model}-{name}.png"]).unwrap();
        let files: Vec<_> = jobs.iter().flat_map(|j| &j.outputs).map(|p| p.to_str()).collect();
        let expected = ["phong-x", "beckmann-x", "ggx-x", "phong-y", "beckmann-y", "ggx-y"];
        assert_eq!(files, expected.map(|f| format!("o/{f}.png")).each_ref().map(|f| Some(&f[..])));
        let alone = &made(&[], &[Model::Ggx], &["{name}.exr", "{name}.png"]).unwrap()[0];
        assert_eq!(alone.outputs, ["default.exr", "default.png"].map(PathBuf::from));
        assert_eq!((&alone.scene, alone.title()), (&None, "default, GGX".to_owned()));
    }

    #[test]
    fn clashes_are_found_and_say_what_would_help() {
        for (scenes, models, output, word) in [
            (&["a.scn", "b.scn"][..], &Model::ALL[..1], "x.png", "{name}"),
            (&["a.scn", "b.scn"], &Model::ALL[..], "{name}.png", "{model}"),
            (&["a.scn", "b/a.scn"], &Model::ALL[..1], "{name}.png", "b/a.scn"),
            (&["a.scn"], &Model::ALL[..2], "x.png", "{model}"),
            (&["a.scn"], &Model::ALL[..1], "{seed}.png", "{seed}"),
            (&["a.scn"], &Model::ALL[..1], "{name.png", "{model}"),
        ] {
            let error = made(scenes, models, &[output]).unwrap_err();
            assert!(error.contains(word), "{word} in {error}");
        }
        assert!(
            made(&["a.scn"], &[Model::Ggx], &["x.png", "x.png"]).unwrap_err().contains("twice")
        );
        assert!(made(&["a.scn", "b.scn"], &[Model::Ggx], &["x.png"]).is_err());
    }
}
