//! Going on with a picture from a file, in the background: its scene is read again, and its parameters
//! are those of the recipe in the file.

use crate::viewer::jobs::load::{self, Loaded, Source};
use crate::viewer::jobs::reading::Reading;
use burnish::picture::read_recipe;
use burnish::plain;
use burnish::progressive::{Experiment, ExperimentError, Params, Recipe};
use burnish::scene::Axis;
use burnish::scene::builtin::Example;
use egui::Context;
use std::path::{Path, PathBuf};

/// A picture ready to go on.
pub(crate) struct Resumed {
    pub(crate) loaded: Loaded,
    pub(crate) params: Params,
    /// Its sums, if they are in the file; without them it is traced again, to the same bits.
    pub(crate) experiment: Option<Experiment>,
    pub(crate) passes: u64,
}

/// One on its way.
pub(crate) type Resuming = Reading<Resumed>;

/// Whether a file of this name is gone on with as soon as it is opened: it has a recipe, but is no
/// picture to compare with.
pub(crate) fn is_for(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"))
}

/// Starts to read; a scene of the same name among those `known` is taken for its own, if there is no
/// nearer one.
pub(crate) fn start(ctx: &Context, path: PathBuf, known: Vec<PathBuf>) -> Result<Resuming, String> {
    Reading::start(ctx, "resume", path, move |path| read(path, &known))
}

fn read(path: &Path, known: &[PathBuf]) -> Result<Resumed, String> {
    let about = |e: &dyn std::fmt::Display| format!("{}: {e}", plain::path(path));
    let experiment = match Experiment::read(path) {
        _ if is_for(path) => None,
        Ok(experiment) => Some(experiment),
        Err(ExperimentError::NoSums(_)) => None,
        Err(e) => return Err(e.to_string()),
    };
    let recipe = match &experiment {
        Some(experiment) => experiment.recipe().clone(),
        None => {
            let text = read_recipe(path).map_err(|e| e.to_string())?;
            let text = text.ok_or_else(|| about(&"has no recipe to go on by"))?;
            Recipe::parse(&text).map_err(|e| about(&e))?
        }
    };
    let called = experiment.as_ref().and_then(|e| e.goal.scene.clone());
    let source = scene_of(&recipe, called.as_deref(), path, known).ok_or_else(|| {
        about(&format!("its scene, {}, is not there", plain::start(&recipe.scene.name)))
    })?;
    let up = recipe.scene.up.as_deref().and_then(Axis::named);
    let loaded = load::build(source, false, up).map_err(|failed| failed.why)?;
    let scene = loaded.scene.clone();
    let params = match &experiment {
        Some(experiment) => experiment.params(scene),
        None => recipe.params(scene),
    };
    let params = params.map_err(|e| about(&e))?;
    Ok(Resumed { loaded, params, experiment, passes: recipe.passes })
}

/// Where the scene of a picture is: as it was called when it was begun, from here or from beside the
/// picture; or one of that name among those known. Whether it is the same is seen by its content.
fn scene_of(
    recipe: &Recipe,
    called: Option<&str>,
    file: &Path,
    known: &[PathBuf],
) -> Option<Source> {
    if let Some(example) = recipe.scene.example.as_deref().and_then(Example::named) {
        return Some(Source::Example(example));
    }
    let own = recipe.scene.files.first().map(|own| own.name.as_str());
    let folder = file.parent().unwrap_or(Path::new(""));
    let places = called.into_iter().chain(own).flat_map(|name| {
        let beside = Path::new(name).file_name().map(|name| folder.join(name));
        [Some(PathBuf::from(name)), Some(folder.join(name)), beside]
    });
    let named =
        |place: &&PathBuf| place.file_name().is_some_and(|name| own.is_some_and(|own| name == own));
    let known = known.iter().filter(named).cloned();
    places.flatten().chain(known).find(|place| place.is_file()).map(Source::File)
}
