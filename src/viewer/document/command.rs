//! The command line that makes a picture again without a window.

use crate::viewer::document::has_lobe;
use crate::viewer::jobs::load::Source;
use crate::viewer::jobs::save::{plain, stem};
use burnish::picture::Tone;
use burnish::progressive::{Params, Recipe, Snapshot, ToneRecipe};
use burnish::scene::write::{WriteError, scn};
use std::path::Path;

/// Ends the scene's text; no line of a scene is this.
const END: &str = "END-OF-SCENE";

/// The command for a picture of these parameters, shown with this tone. Where materials were
/// edited in ways that no argument says, it is preceded by lines that write the edited scene.
pub(crate) fn again(
    params: &Params,
    snapshot: &Snapshot,
    tone: Tone,
    source: &Source,
) -> Result<String, WriteError> {
    let params = &in_one_argument(params);
    let shown = ToneRecipe { exposure: tone.exposure, curve: tone.curve.name().to_owned() };
    let recipe = Recipe { tone: Some(shown), ..Recipe::new(params, snapshot) };
    let output = format!("{}.png", stem(params));
    let said = recipe.materials.is_empty() || recipe.alpha.or(recipe.exponent).is_some();
    if said {
        let scene = match source {
            Source::Example(example) => example.name.to_owned(),
            Source::File(path) => crate::shell::file(&path.display().to_string()),
        };
        return Ok(command(&recipe, &scene, &output));
    }
    let Params { scene, materials, camera, size, .. } = params;
    // Into the working directory, from where the command finds it and it finds its models.
    let text = scn(scene, materials, camera, *size, Path::new(""))?;
    let name = format!("{}-edited.scn", plain(scene.name()));
    let (text, command) = (text.trim_end(), command(&recipe, &name, &output));
    Ok(format!("cat > {name} <<'{END}'\n{text}\n{END}\n{command}"))
}

fn command(recipe: &Recipe, scene: &str, output: &str) -> String {
    let (scene, output) = (&crate::shell::file(scene), &crate::shell::file(output));
    let words = ["burnish", "render", scene, "-o", output].map(str::to_owned);
    crate::shell::line(words.into_iter().chain(recipe.arguments()))
}

/// The same pixels, with one roughness for all materials where those that have a lobe agree on
/// one: the others' is seen by nobody.
fn in_one_argument(params: &Params) -> Params {
    let mut lobes = params.materials.iter().filter(|m| has_lobe(m)).map(|m| m.roughness);
    match lobes.next() {
        Some(first) if params.materials.as_slice() != params.scene.materials() => {
            if lobes.all(|r| r == first) {
                params.clone().with_roughness(first)
            } else {
                params.clone()
            }
        }
        _ => params.clone(),
    }
}
