//! What a picture was made of, as text that travels in its file.
//!
//! Equal recipes make equal pixels: nothing is in a recipe that depends on the machine's speed, the
//! hour or the number of threads, so files of equal pictures are equal too.

mod possible;

use super::{Counts, ErrorEstimate, Figure, Params, Snapshot};
use crate::brdf::{Erratum, Roughness};
use crate::math::simd::Isa;
use crate::picture::{Format, Picture, SaveError, Tone, write_with_samples};
use crate::scene::write::{Edits, WriteError, edit};
use crate::scene::{Camera, Crop, Material, MaterialError, MaterialId, Source, SourceFile};
use crate::trace::ReuseGroup;
use serde::{Deserialize, Serialize};
use std::path::Path;
use thiserror::Error;

/// Everything needed to make a picture again, and what is known about its error.
///
/// Names are those of the command line.
///
/// ```
/// use burnish::picture::{Tone, read_recipe};
/// use burnish::progressive::{Params, Recipe, render};
/// use burnish::scene::builtin;
/// use std::sync::Arc;
///
/// let scene = Arc::new(builtin::default_scene()?.0.build());
/// let params = Params { size: [16, 12], seed: 7, ..Params::new(scene) };
/// let snapshot = render(params.clone(), 4, 0)?;
/// let path = std::env::temp_dir().join(format!("recipe-{}.png", std::process::id()));
/// Recipe::new(&params, &snapshot).save(&path, &snapshot.mean(), Tone::default())?;
/// let recipe = Recipe::parse(&read_recipe(&path)?.unwrap())?;
/// assert_eq!((recipe.seed, recipe.passes), (7, 4));
/// assert!(recipe.scene.text.unwrap().starts_with("# A knot"));
/// # std::fs::remove_file(&path)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Recipe {
    /// Version of this form, [`Recipe::VERSION`].
    pub recipe: u32,
    /// Version of the program.
    pub burnish: String,
    /// Instruction set of the traversal.
    pub isa: String,
    /// What is seen.
    pub scene: SceneRecipe,
    /// The materials that differ from the scene's text.
    pub materials: Vec<MaterialRecipe>,
    /// The roughness alpha that all materials were given, if nothing else about them was changed.
    pub alpha: Option<f64>,
    /// The same where it was given as the Phong exponent a_p.
    pub exponent: Option<f64>,
    /// The camera as a line of a `.scn` file.
    pub camera: String,
    /// Whether it is another than the scene's.
    pub moved: bool,
    /// The part of the camera's picture that it is, if not the whole: left, top and side in parts of that.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub crop: Option<Crop>,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Which BRDF.
    pub model: String,
    /// How light was found.
    pub strategy: String,
    /// Which microfacet normals were drawn.
    pub normals: String,
    /// The mistake made on purpose.
    pub erratum: Option<String>,
    /// Whether the reference tracer was asked for.
    #[serde(default)]
    pub reference: bool,
    /// How many neighbouring paths shared what they found; 1 for none.
    #[serde(default = "alone")]
    pub group: u32,
    /// Which of the independent pictures.
    pub seed: u64,
    /// Whether all pixels got the same number of samples, as those of older pictures did.
    #[serde(default = "yes")]
    pub uniform: bool,
    /// Most scattering events.
    pub max_depth: Option<u32>,
    /// Samples that every pixel has: at least, or on the mean where they are not uniform.
    pub passes: u64,
    /// The number of the first pass: another than 0 in a part of a picture.
    #[serde(default)]
    pub first_pass: u64,
    /// Passes that it has where some between are missing, as parts put together may have them: each from
    /// its first to before its second. Such a picture is made again part by part.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<[u64; 2]>,
    /// Whether there are no others: there are when time ran out within a pass. Such a picture cannot
    /// be made again exactly.
    #[serde(default)]
    pub whole: Option<bool>,
    /// Camera paths.
    pub paths: u64,
    /// Rays of all kinds.
    pub rays: u64,
    /// Samples left out because they were NaN or infinite.
    pub nonfinite: u64,
    /// Paths ended by the safety caps on their length and throughput.
    pub capped: u64,
    /// The estimated error, once there is an estimate.
    pub error: Option<ErrorRecipe>,
    /// How radiance became colour; in 8-bit pictures alone.
    pub tone: Option<ToneRecipe>,
}

/// Pictures from before samples went where they are wanted.
fn yes() -> bool {
    true
}

/// Pictures from before paths shared.
fn alone() -> u32 {
    1
}

/// A scene by what was read.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SceneRecipe {
    /// What the window calls it.
    pub name: String,
    /// What the command line calls it, if it came with the program.
    pub example: Option<String>,
    /// The axis of a model alone that points up, by its name.
    #[serde(default)]
    pub up: Option<String>,
    /// The text of its `.scn` file; `None` for a model alone, a scene put together by calls, or
    /// one of more than [`Recipe::MOST_TEXT`] bytes.
    pub text: Option<String>,
    /// Its own file, then the models and material libraries that it names.
    pub files: Vec<FileRecipe>,
}

/// A file by its content.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileRecipe {
    /// As the scene calls it.
    pub name: String,
    /// Its length.
    pub bytes: u64,
    /// SHA-256, hexadecimal.
    pub sha256: String,
}

/// A material as it was rendered.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MaterialRecipe {
    /// Its number in the scene.
    pub index: usize,
    /// What the window calls it.
    pub name: String,
    /// The line of the scene's text that gives it; `None` where no line does.
    pub line: Option<usize>,
    /// Diffuse reflectance.
    pub kd: [f32; 3],
    /// Specular reflectance at normal incidence.
    pub ks: [f32; 3],
    /// The Phong exponent a_p.
    pub exponent: f64,
    /// Emitted radiance in W/(m² sr).
    pub emission: [f32; 3],
}

/// The picture's relative error; see [`ErrorEstimate`](super::ErrorEstimate).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ErrorRecipe {
    /// The estimate, as a part of one.
    pub relative: f64,
    /// Lower 95 % limit.
    pub low: f64,
    /// Upper 95 % limit; `None` where there is none.
    pub high: Option<f64>,
    /// Whether these figures can be relied on.
    pub reliable: bool,
}

/// Exposure and curve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ToneRecipe {
    /// In stops.
    pub exposure: f32,
    /// The curve's name.
    pub curve: String,
}

/// A recipe that cannot be followed.
#[derive(Debug, Error)]
pub enum RecipeError {
    /// It is not one, or not whole.
    #[error("the recipe cannot be read: {0}")]
    Parse(#[from] serde_json::Error),
    /// A later program wrote it.
    #[error("the recipe has version {0}, this burnish knows {known}: use a newer one", known = Recipe::VERSION)]
    Version(u32),
    /// The scene's text is not in it.
    #[error("the recipe holds no scene text: the scene was {0}")]
    NoText(&'static str),
    /// It has a value that no render has.
    #[error("the recipe has {0}: no burnish wrote it, or a newer one")]
    Impossible(String),
    /// A material has numbers that none can have.
    #[error("the recipe has a material that cannot be: {0}")]
    Material(#[from] MaterialError),
    /// The camera's line makes no sense.
    #[error("the recipe has a camera that cannot be: {0}")]
    Camera(String),
    /// The edits cannot be put into words.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// What came of some parameters.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Outcome {
    pub(super) passes: u64,
    pub(super) whole: bool,
    pub(super) counts: Counts,
    pub(super) error: Option<ErrorEstimate>,
    pub(super) group: ReuseGroup,
}

impl Recipe {
    /// The version of this form: raised when an older program would misread it.
    pub const VERSION: u32 = 1;
    /// Longest text of a scene, in bytes, that goes into a picture: readers of PNG begin to refuse
    /// longer chunks. Its SHA-256 always does.
    pub const MOST_TEXT: usize = 1 << 20;

    /// What this snapshot of these parameters was made of.
    pub fn new(params: &Params, snapshot: &Snapshot) -> Recipe {
        let Snapshot { passes, whole, counts, error, group, .. } = *snapshot;
        Recipe::of(params, Outcome { passes, whole, counts, error, group })
    }

    pub(super) fn of(params: &Params, outcome: Outcome) -> Recipe {
        let scene = &params.scene;
        let Outcome { passes, whole, counts, error, group } = outcome;
        let common = common_roughness(params);
        let by_alpha = |r: Roughness| Roughness::from_alpha(r.alpha()) == Ok(r);
        Recipe {
            recipe: Self::VERSION,
            burnish: env!("CARGO_PKG_VERSION").to_owned(),
            isa: scene.isa().name().to_owned(),
            scene: SceneRecipe::new(params),
            materials: edited(params),
            alpha: common.filter(|r| by_alpha(*r)).map(Roughness::alpha),
            exponent: common.filter(|r| !by_alpha(*r)).map(Roughness::exponent),
            camera: params.camera.scn_line(),
            moved: Camera { crop: Crop::WHOLE, ..params.camera } != scene.camera(),
            crop: Some(params.camera.crop).filter(|&crop| crop != Crop::WHOLE),
            size: params.size,
            model: params.model.name().to_owned(),
            strategy: params.strategy.name().to_owned(),
            normals: params.normals.name().to_owned(),
            erratum: params.erratum.map(Erratum::name).map(str::to_owned),
            reference: params.reference,
            group: group.paths(),
            seed: params.seed,
            max_depth: params.max_depth,
            uniform: params.uniform,
            passes,
            first_pass: params.first_pass,
            parts: Vec::new(),
            whole: Some(whole),
            paths: counts.paths,
            rays: counts.rays,
            nonfinite: counts.nonfinite,
            capped: counts.capped,
            error: error.and_then(|e| ErrorRecipe::new(&e)),
            tone: None,
        }
    }

    /// From the text in a file. Values that no render can have are refused.
    pub fn parse(text: &str) -> Result<Recipe, RecipeError> {
        #[derive(Deserialize)]
        struct Version {
            recipe: u32,
        }
        match serde_json::from_str(text)? {
            Version { recipe } if recipe > Self::VERSION => Err(RecipeError::Version(recipe)),
            _ => {
                let recipe: Recipe = serde_json::from_str(text)?;
                match recipe.impossible() {
                    Some(what) => Err(RecipeError::Impossible(what)),
                    None => Ok(recipe),
                }
            }
        }
    }

    /// As it stands in files; [`Recipe::parse`] reads it.
    pub fn text(&self) -> Result<String, serde_json::Error> {
        serde_json::to_string_pretty(self)
    }

    /// Writes a picture with its recipe, to a `.png` file toned by `tone` or to an `.exr` file.
    pub fn save(&self, path: &Path, picture: &Picture, tone: Tone) -> Result<(), SaveError> {
        self.save_with_samples(path, picture, &[], tone)
    }

    /// The same with the number of samples of each pixel, as [`Snapshot::samples`] has them, in an
    /// `.exr` file; nothing where they are all the same.
    pub fn save_with_samples(
        &self,
        path: &Path,
        picture: &Picture,
        samples: &[u64],
        tone: Tone,
    ) -> Result<(), SaveError> {
        let toned = ToneRecipe { exposure: tone.exposure, curve: tone.curve.name().to_owned() };
        let tone_used = (Format::of(path)? == Format::Png).then_some(toned);
        let recipe = Recipe { tone: tone_used, ..self.clone() };
        let failed =
            |e: serde_json::Error| SaveError::Write { path: path.to_path_buf(), source: e.into() };
        let text = recipe.text().map_err(failed)?;
        let uneven = samples.iter().any(|n| *n != samples[0]);
        let samples = if uneven { samples } else { &[] };
        write_with_samples(path, picture, tone, &text, samples)
    }

    /// Whether the passes are all that is in it, so that the picture can be made again.
    pub fn is_whole(&self) -> bool {
        let [width, height] = self.size.map(u64::from);
        let pixels = width.checked_mul(height);
        let by_paths = || pixels.and_then(|n| n.checked_mul(self.passes)) == Some(self.paths);
        self.whole.unwrap_or_else(by_paths)
    }

    /// What to give `burnish render` besides the scene and the file, and `burnish pixel` besides the
    /// scene and the place. Changes of materials other
    /// than one roughness for all are not among them: those need [`Recipe::scene_text`]. A picture of several
    /// [`parts`](Recipe::parts) is made by those of [`Recipe::of_part`] for each.
    pub fn arguments(&self) -> Vec<String> {
        let [width, height] = self.size;
        let mut all = Vec::new();
        let mut add = |name: &str, value: String| all.extend([format!("--{name}"), value]);
        add("model", self.model.clone());
        add("size", format!("{width}x{height}"));
        add("passes", self.passes.max(1).to_string());
        if self.first_pass > 0 {
            add("first-pass", self.first_pass.to_string());
        }
        add("seed", self.seed.to_string());
        if let Some(up) = &self.scene.up {
            add("up", up.clone());
        }
        if let Some(alpha) = self.alpha {
            add("alpha", alpha.to_string());
        }
        if let Some(exponent) = self.exponent {
            add("exponent", exponent.to_string());
        }
        if self.moved {
            add("camera", self.camera.trim_start_matches("camera ").to_owned());
        }
        if let Some([x, y, side]) = self.crop.map(Crop::parts) {
            add("crop", format!("{x},{y},{side}"));
        }
        if let Some(depth) = self.max_depth {
            add("max-depth", depth.to_string());
        }
        add("strategy", self.strategy.clone());
        add("normals", self.normals.clone());
        if let Some(erratum) = &self.erratum {
            add("erratum", erratum.clone());
        }
        if let Some(tone) = &self.tone {
            add("exposure", tone.exposure.to_string());
            add("tone", tone.curve.clone());
        }
        match self.group {
            0 | 1 => all.push("--no-reuse".to_owned()),
            paths => all.extend(["--group".to_owned(), paths.to_string()]),
        }
        if self.uniform {
            all.push("--uniform".to_owned());
        }
        if self.reference {
            all.push("--reference".to_owned());
        }
        // The others give the same bits as the widest set of any machine that has one of them.
        if self.isa == Isa::Portable.name() {
            all.extend(["--isa".to_owned(), self.isa.clone()]);
        }
        all
    }

    /// The recipe of the passes from the first to before the second, which are one of its parts.
    pub fn of_part(&self, [from, to]: [u64; 2]) -> Recipe {
        let passes = to.saturating_sub(from);
        Recipe { first_pass: from, passes, parts: Vec::new(), ..self.clone() }
    }

    /// The scene's text with the materials, the camera and the size of the picture in it.
    pub fn scene_text(&self) -> Result<String, RecipeError> {
        let Some(text) = &self.scene.text else {
            return Err(RecipeError::NoText(match self.scene.files.as_slice() {
                [] => "put together by calls",
                [own, ..] if own.name.to_ascii_lowercase().ends_with(".scn") => "too long",
                _ => "a model alone",
            }));
        };
        let materials: Vec<(Option<usize>, Material)> = self
            .materials
            .iter()
            .map(|m| Ok((m.line, m.material()?)))
            .collect::<Result<_, MaterialError>>()?;
        let camera = crate::scene::read::parse_camera(&self.camera).map_err(RecipeError::Camera)?;
        let edits = Edits {
            materials: materials.iter().map(|(line, material)| (*line, material)).collect(),
            camera: self.moved.then_some(camera),
            screen: Some(self.size),
            models: Vec::new(),
        };
        Ok(edit(text, &edits)?)
    }
}

impl ErrorRecipe {
    /// None of an error that is not finite.
    pub(super) fn new(error: &ErrorEstimate) -> Option<ErrorRecipe> {
        let Figure { value: relative, interval } = error.relative;
        let high = Some(interval.high).filter(|high| high.is_finite());
        let known = ErrorRecipe { relative, low: interval.low, high, reliable: error.reliable };
        relative.is_finite().then_some(known)
    }
}

impl SceneRecipe {
    fn new(params: &Params) -> SceneRecipe {
        let (name, source) = (params.scene.name().to_owned(), params.scene.source());
        SceneRecipe {
            name,
            example: source.example.map(str::to_owned),
            up: source.up.map(|axis| axis.name().to_owned()),
            text: source.text.clone().filter(|text| text.len() <= Recipe::MOST_TEXT),
            files: source.files.iter().map(FileRecipe::from).collect(),
        }
    }
}

impl From<&SourceFile> for FileRecipe {
    fn from(file: &SourceFile) -> FileRecipe {
        let SourceFile { name, bytes, sha256, .. } = file.clone();
        FileRecipe { name, bytes, sha256 }
    }
}

impl MaterialRecipe {
    /// Material number `index` of a scene.
    pub fn new(index: usize, material: &Material, source: &Source) -> MaterialRecipe {
        MaterialRecipe {
            index,
            name: material.name.clone(),
            line: source.line(index as MaterialId),
            kd: material.kd,
            ks: material.ks,
            exponent: material.roughness.exponent(),
            emission: material.emission,
        }
    }

    pub(super) fn material(&self) -> Result<Material, MaterialError> {
        let wide = |c: [f32; 3]| c.map(f64::from);
        let name = self.name.as_str();
        Material::reflecting(name, wide(self.kd), wide(self.ks), self.exponent)?
            .emitting(wide(self.emission))
    }
}

fn edited(params: &Params) -> Vec<MaterialRecipe> {
    let pairs = params.materials.iter().zip(params.scene.materials()).enumerate();
    let changed = pairs.filter(|(_, (now, read))| now != read);
    changed
        .map(|(index, (now, _))| MaterialRecipe::new(index, now, params.scene.source()))
        .collect()
}

/// What all materials have, if nothing but their roughness was changed.
fn common_roughness(params: &Params) -> Option<Roughness> {
    let pairs = || params.materials.iter().zip(params.scene.materials());
    let roughness = params.materials.first()?.roughness;
    let same = params.materials.iter().all(|m| m.roughness == roughness);
    let rest = |(now, read): (&Material, &Material)| {
        Material { roughness: now.roughness, ..read.clone() } == *now
    };
    let changed = pairs().any(|(now, read)| now != read);
    (changed && same && pairs().all(rest)).then_some(roughness)
}
