//! A scene with its edits, as `.scn` text.
//!
//! A scene knows triangles, not what they were made of, and its author's comments are nowhere but
//! in his file. So the text that was read is what is written: the numbers that changed are
//! replaced, word by word, and all else stays as it was, line ends and spaces included.
//!
//! ```
//! use burnish::scene::read::{Memory, read_scn};
//! use burnish::scene::write::scn;
//!
//! let text = "screen 64 48\nenvironment 1 1 1\ncamera 0 -9 0 0.2 x 90\n\
//!             # Clay\nbrdf 0.60 0.40 0.30  0 0 0  1\nsphere 0 0 0 1\n";
//! let scene = read_scn(text.as_bytes(), "clay.scn".as_ref(), &Memory(&[]))?.0.build();
//! let mut materials = scene.materials().to_vec();
//! materials[0].kd[1] = 0.5;
//! let edited = scn(&scene, &materials, &scene.camera(), [64, 48], "".as_ref())?;
//! assert_eq!(edited, text.replace("0.40", "0.5"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use super::read::parse_camera;
use super::read::text::{leading_number, lines};
use super::{Axis, Camera, Material, ModelStage, Scene, SourceFile, StageLight};
use crate::brdf::Roughness;
use std::fmt::Write;
use std::path::{Path, absolute};
use thiserror::Error;

/// Edits that the format has no words for.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum WriteError {
    /// The scene was put together by calls.
    #[error("this scene does not come from a file, so there is no text to edit")]
    NoFile,
    /// A model by itself with materials of its own.
    #[error(
        "{0} brings materials of its own, and a .scn file gives a model only one: edit the model's \
         MTL file instead"
    )]
    OwnMaterials(String),
    /// A surface that emits and reflects.
    #[error(
        "the material `{0}` both emits and reflects, which a .scn file cannot say: make its Kd and \
         Ks 0, or its emission"
    )]
    Both(String),
    /// A path that would be taken for two arguments.
    #[error("`{0}` has a space in it, which a .scn file cannot say: save beside the model instead")]
    Space(String),
}

/// What is to be different in a text.
#[derive(Clone, Debug, Default)]
pub struct Edits<'a> {
    /// Materials, each with the line that gives it ([`Source::line`](super::Source::line)).
    pub materials: Vec<(Option<usize>, &'a Material)>,
    /// The camera, if it is another.
    pub camera: Option<Camera>,
    /// Width and height in pixels, if they are others.
    pub screen: Option<[u32; 2]>,
    /// Models by the names in the text, with their new ones.
    pub models: Vec<(String, String)>,
}

/// The scene as `.scn` text for a file in `folder`, with these materials, as many as it has, this
/// camera, and a picture of `size` pixels.
///
/// It reads back to the same scene, but for roughnesses that no one sees: a line without a
/// specular lobe keeps its own if it is a light's. Models are named so that they are found from
/// `folder`. The roughness is written as the exponent a_p, which may round alpha by a part in
/// 1e15.
pub fn scn(
    scene: &Scene,
    materials: &[Material],
    camera: &Camera,
    size: [u32; 2],
    folder: &Path,
) -> Result<String, WriteError> {
    let source = scene.source();
    let Some(text) = &source.text else {
        return alone(scene, materials, camera, size, folder);
    };
    let changed = |(_, (now, read)): &(usize, (&Material, &Material))| now != read;
    let pairs = materials.iter().zip(scene.materials()).enumerate().filter(changed);
    let screen = (size != scene.screen()).then_some(size);
    // Without a line of its own the camera frames the scene, in a way that depends on the size.
    let moved = *camera != scene.camera() || (screen.is_some() && place(text, "camera").is_none());
    let mut models = Vec::new();
    if source.example.is_none() {
        for file in source.files.iter().skip(1) {
            let name = from_folder(file, folder)?;
            if name != file.name {
                models.push((file.name.clone(), name));
            }
        }
    }
    let edits = Edits {
        materials: pairs.map(|(i, (now, _))| (source.line(i as u32), now)).collect(),
        camera: moved.then_some(*camera),
        screen,
        models,
    };
    edit(text, &edits)
}

/// The text with these edits made.
pub fn edit(text: &str, edits: &Edits) -> Result<String, WriteError> {
    let camera_line = place(text, "camera");
    let screen_line = place(text, "screen");
    let screen_text = |[w, h]: [u32; 2]| format!("screen {w} {h}");
    let mut out = String::with_capacity(text.len() + 256);
    for (_, material) in edits.materials.iter().filter(|(line, _)| line.is_none()) {
        // What shapes have before any line; the comment gives it its name.
        let _ = write!(out, "# {}{end}{}{end}", material.name, whole(material)?, end = end(text));
    }
    for (number, line) in lines(text) {
        let material = edits.materials.iter().find(|(at, _)| *at == Some(number));
        if let Some((_, material)) = material {
            out.push_str(&with_material(line, material)?);
        } else if let (Some(camera), true) = (edits.camera, camera_line == Some(number)) {
            out.push_str(&with_camera(line, &camera));
        } else if let (Some(size), true) = (edits.screen, screen_line == Some(number)) {
            let _ = write!(out, "{}{}", indent(line), screen_text(size));
        } else {
            out.push_str(&with_model(line, &edits.models));
        }
        // Whatever ends the line, up to where the next one starts.
        let past = line.as_ptr() as usize - text.as_ptr() as usize + line.len();
        let rest = &text[past..];
        let ends = ["\r\n", "\n", "\r"].into_iter().find(|e| rest.starts_with(e));
        out.push_str(ends.unwrap_or_default());
    }
    let camera = edits.camera.filter(|_| camera_line.is_none()).map(|c| c.scn_line());
    let screen = edits.screen.filter(|_| screen_line.is_none()).map(screen_text);
    for added in [screen, camera].into_iter().flatten() {
        if !out.is_empty() && !out.ends_with(['\n', '\r']) {
            out.push_str(end(text));
        }
        out.push_str(&added);
        out.push_str(end(text));
    }
    Ok(out)
}

/// A model that was opened by itself.
fn alone(
    scene: &Scene,
    materials: &[Material],
    camera: &Camera,
    [w, h]: [u32; 2],
    folder: &Path,
) -> Result<String, WriteError> {
    let file = scene.source().files.first().ok_or(WriteError::NoFile)?;
    let stage = scene.stage();
    let own = materials.len().saturating_sub(stage.map_or(0, |_| ModelStage::MATERIALS));
    let (own, of_stage) = materials.split_at(own);
    let [material] = own else { return Err(WriteError::OwnMaterials(file.name.clone())) };
    let [r, g, b] = scene.environment();
    let mut out = format!("screen {w} {h}\n{}\n", camera.scn_line());
    if [r, g, b] != [0.0; 3] {
        let _ = writeln!(out, "environment {r} {g} {b}");
    }
    let model = from_folder(file, folder)?;
    let turn = scene.source().up.map_or("", Axis::orient);
    let mesh = format!("mesh {model} 0 0 0 1 {turn}");
    let _ = writeln!(out, "# {}\n{}\n{}", material.name, whole(material)?, mesh.trim_end());
    if let Some(stage) = stage {
        for (material, shape) in of_stage.iter().zip(stage_shapes(&stage)) {
            let _ = writeln!(out, "# {}\n{}\n{shape}", material.name, whole(material)?);
        }
    }
    Ok(out)
}

/// The lines of what a stage adds, in the order of its materials.
fn stage_shapes(stage: &ModelStage) -> Vec<String> {
    let (b, a, radius) = stage.ground();
    let ground = format!("cylinder {} {} {}  {} {} {}  {radius}", b.x, b.y, b.z, a.x, a.y, a.z);
    let sphere = |light: StageLight| {
        let c = light.centre;
        format!("sphere {} {} {}  {}", c.x, c.y, c.z, light.radius)
    };
    [ground].into_iter().chain(stage.lights().map(sphere)).collect()
}

/// What to call a file in a text that lies in `folder`: its name where that is enough, or the
/// whole path.
fn from_folder(file: &SourceFile, folder: &Path) -> Result<String, WriteError> {
    let whole = |path: &Path| absolute(path).unwrap_or_else(|_| path.to_owned());
    let path = whole(&file.path);
    let name = if whole(&folder.join(&file.name)) == path {
        file.name.clone()
    } else {
        path.to_string_lossy().into_owned()
    };
    if name.contains(char::is_whitespace) { Err(WriteError::Space(name)) } else { Ok(name) }
}

/// The number of the last line with this command: the one that counts.
fn place(text: &str, command: &str) -> Option<usize> {
    let with = lines(text).filter(|(_, line)| line.split_whitespace().next() == Some(command));
    with.last().map(|(number, _)| number)
}

/// How the lines of a text end.
fn end(text: &str) -> &'static str {
    if text.contains("\r\n") {
        "\r\n"
    } else if text.contains('\r') && !text.contains('\n') {
        "\r"
    } else {
        "\n"
    }
}

fn indent(line: &str) -> &str {
    &line[..line.len() - line.trim_start().len()]
}

/// A line's words with the numbers among its arguments that differ from these replaced; the
/// arguments beyond them stay.
fn with_numbers(line: &str, numbers: &[(String, bool)]) -> String {
    let mut out = String::with_capacity(line.len() + 16);
    let mut rest = line;
    for (index, word) in line.split_whitespace().enumerate() {
        let at = rest.find(word).unwrap_or_default();
        out.push_str(&rest[..at]);
        let new = index.checked_sub(1).and_then(|i| numbers.get(i));
        out.push_str(new.filter(|(_, differs)| *differs).map_or(word, |(text, _)| text));
        rest = &rest[at + word.len()..];
    }
    out + rest
}

/// A `brdf` or `light` line that gives this material.
fn with_material(line: &str, material: &Material) -> Result<String, WriteError> {
    let new = whole(material)?;
    let mut words = line.split_whitespace();
    let command = words.next();
    // A black surface that emits nothing is either; it stays what it was.
    let light = match command {
        Some("light") => !reflects(material),
        _ => material.emits(),
    };
    let kind = if light { "light" } else { "brdf" };
    if command != Some(kind) {
        return Ok(format!("{}{new}", indent(line)));
    }
    let old: Vec<f64> = words.filter_map(|word| Some(leading_number(word)?.0)).collect();
    let differs = |i: usize, now: f32| old.get(i).is_none_or(|&x| x as f32 != now);
    let colours =
        if light { material.emission.to_vec() } else { [material.kd, material.ks].concat() };
    let mut numbers: Vec<_> =
        colours.iter().enumerate().map(|(i, &x)| (x.to_string(), differs(i, x))).collect();
    if !light {
        let as_read = old.get(6).and_then(|&a_p| Roughness::from_exponent(a_p).ok());
        let differs = as_read != Some(material.roughness);
        numbers.push((exponent(material.roughness), differs));
    }
    Ok(with_numbers(line, &numbers))
}

fn reflects(material: &Material) -> bool {
    [material.kd, material.ks].as_flattened().iter().any(|&c| c > 0.0)
}

/// A line that gives this material.
fn whole(material: &Material) -> Result<String, WriteError> {
    let triple = |[r, g, b]: [f32; 3]| format!("{r} {g} {b}");
    if !material.emits() {
        let a_p = exponent(material.roughness);
        Ok(format!("brdf {}  {}  {a_p}", triple(material.kd), triple(material.ks)))
    } else if reflects(material) {
        Err(WriteError::Both(material.name.clone()))
    } else {
        Ok(format!("light {}", triple(material.emission)))
    }
}

/// The exponent a_p in as few decimals as give the alpha: 198, not 197.99999999999997.
fn exponent(roughness: Roughness) -> String {
    let same = |text: &String| {
        let read = text.parse().ok().and_then(|a_p| Roughness::from_exponent(a_p).ok());
        read.is_some_and(|r| (r.alpha() / roughness.alpha() - 1.0).abs() < 1e-15)
    };
    let rounded = |decimals| format!("{:.decimals$}", roughness.exponent());
    let [low, high] = Roughness::EXPONENT;
    let full = || roughness.exponent().clamp(low, high).to_string();
    (0..16).map(rounded).find(same).unwrap_or_else(full)
}

fn with_camera(line: &str, camera: &Camera) -> String {
    if parse_camera(line) == Ok(*camera) {
        line.to_owned()
    } else {
        format!("{}{}", indent(line), camera.scn_line())
    }
}

/// A line whose model, if it places one, has its new name.
fn with_model(line: &str, models: &[(String, String)]) -> String {
    let mut words = line.split_whitespace();
    let file = words.next().filter(|word| *word == "mesh").and_then(|_| words.next());
    match models.iter().find(|(old, _)| Some(old.as_str()) == file) {
        Some((_, new)) => with_numbers(line, &[(new.clone(), true)]),
        None => line.to_owned(),
    }
}
