//! Pictures written where they are wanted, or else where they can be.

use super::outputs::Failures;
use super::talk::detail;
use burnish::picture::{Picture, SaveError, Tone};
use burnish::plain;
use burnish::progressive::{Recipe, Snapshot};
use std::path::{Path, PathBuf};

/// Writes a snapshot to all of these files.
pub(super) fn write(
    outputs: &[PathBuf],
    recipe: &Recipe,
    snapshot: &Snapshot,
    picture: &Picture,
    tone: Tone,
    failures: &mut Failures,
) {
    let samples = snapshot.samples();
    for path in outputs {
        match recipe.save_with_samples(path, picture, &samples, tone) {
            Ok(()) => detail(format_args!("written: {}", plain::path(path))),
            Err(e) => {
                let again = |place: &Path| recipe.save(place, picture, tone);
                failures.add(format_args!("{e}; {}", rescue(path, again)));
            }
        }
    }
}

/// Puts a picture that could not be written where it was wanted into the temporary folder, and says
/// where or why not: what was rendered is not thrown away.
pub(super) fn rescue(path: &Path, save: impl Fn(&Path) -> Result<(), SaveError>) -> String {
    let ending = path.extension().map_or("exr".into(), |ending| ending.to_string_lossy());
    let place = tempfile::Builder::new()
        .prefix("burnish-")
        .suffix(&format!(".{ending}"))
        .tempfile()
        .and_then(|file| file.into_temp_path().keep().map_err(|e| e.error));
    let kept = place.map_err(|e| e.to_string()).and_then(|place| {
        save(&place).map(|()| place.clone()).map_err(|e| {
            // It is empty.
            let _ = std::fs::remove_file(&place);
            e.to_string()
        })
    });
    match kept {
        Ok(place) => format!("the picture is kept as {}", plain::path(&place)),
        Err(why) => format!("nor could it be kept in the temporary folder: {why}"),
    }
}
