//! Reading an OpenEXR picture in the background, to be compared with.

use crate::viewer::document::comparison::Frozen;
use crate::viewer::jobs::reading::Reading;
use crate::viewer::picture::frozen;
use burnish::picture::{read_exr_part, read_recipe};
use burnish::progressive::Recipe;
use egui::Context;
use std::path::{Path, PathBuf};

/// A picture on its way.
pub(crate) type ReadingPicture = Reading<Frozen>;

/// Whether a file of this name is read as a picture.
pub(crate) fn is_for(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr"))
}

/// Starts to read.
pub(crate) fn start(ctx: &Context, path: PathBuf) -> Result<ReadingPicture, String> {
    Reading::start(ctx, "picture", path, read)
}

fn read(path: &Path) -> Result<Frozen, String> {
    let read = read_exr_part(path, None).map_err(|e| e.to_string())?;
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    let recipe = read_recipe(path).ok().flatten();
    let resumable = recipe.as_ref().map(|_| path.to_path_buf());
    let noise = recipe.and_then(|text| Recipe::parse(&text).ok()?.error).map(|e| e.relative);
    Ok(Frozen { name, snapshot: frozen::snapshot(&read.picture), resumable, noise })
}
