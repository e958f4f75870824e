//! Readers: a file becomes a [`SceneBuilder`] and a [`Report`], or an error with its line.
//!
//! | ending | reader | what it brings |
//! | --- | --- | --- |
//! | `.scn` | [`read_scn`], by lines | camera, materials, lights, shapes, and the models it names |
//! | `.obj` | `tobj`, on text checked beforehand | a mesh, its parts, the materials of its MTL |
//! | `.ply` | `ply-rs-bw`, one element at a time | a mesh |
//!
//! **Whose word counts.** What would make the geometry a guess (a radius of 0, a word for a
//! coordinate) is an error with file and line. What can be shown, though perhaps not as its author
//! meant it, is a [`Warning`](super::Warning). Nothing is left out in silence.
//!
//! **No input may panic, hang or take more memory than its own size explains.** The two crates
//! that know the model formats trust their input in places; each is given only what its reader
//! here has checked. No tree is built: that is for the caller, who may want to do it elsewhere.
//!
//! ```
//! use burnish::scene::read::{self, Memory};
//!
//! let text = b"light 1 1 1\nsphere 0 0 5 1\nbrdf 0.5 0.5 0.5 0 0 0 10\nsphere 0 0 0 2";
//! let (builder, report) = read::read_scn(text, "two.scn".as_ref(), &Memory(&[]))?;
//! assert_eq!(builder.shapes(), 2);
//! assert_eq!(report.warnings.len(), 2); // neither `screen` nor `camera` was given
//! # Ok::<(), read::ReadError>(())
//! ```

mod advice;
mod files;
mod log;
mod obj;
mod ply;
mod polygon;
mod scn;
pub(super) mod text;

pub use files::{Disk, Files, Memory};
pub use log::{Fault, ReadError};
pub use scn::{parse_camera, read_scn};

use super::doubles::Origin;
use super::{
    Axis, Camera, Material, Mesh, MeshCounts, ModelStage, Report, SceneBuilder, StageError,
};
use files::FileRecorder;
use glam::{DAffine3, DVec3};
use log::Log;
use std::path::Path;

/// Reads the scene or model in this file, by its ending.
///
/// A model alone is stood upright and framed by the camera, 640 by 480 pixels; if nothing in it
/// emits, it is put on a [`ModelStage`]. The report's notes say so.
pub fn open(path: &Path) -> Result<(SceneBuilder, Report), ReadError> {
    open_with(path, &Disk::beside(path))
}

/// The same, with other `files` than those on disk.
pub fn open_with(path: &Path, files: &dyn Files) -> Result<(SceneBuilder, Report), ReadError> {
    open_with_options(path, files, ReadOptions::default())
}

/// What a reader does with a model that is opened by itself. A `.scn` file is not affected: it says
/// all of this itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ReadOptions {
    /// The axis of the file that points up, instead of the one that is guessed: Y for OBJ and Z for PLY
    /// files, unless the model has a foot at least twice as large along the other of these two.
    pub up: Option<Axis>,
    /// Leaves it as it is: no guess of an axis and no stage. If nothing in it emits, a uniform white
    /// environment of radiance 1 lights it.
    pub bare: bool,
}

/// [`open_with`] these options.
pub fn open_with_options(
    path: &Path,
    files: &dyn Files,
    options: ReadOptions,
) -> Result<(SceneBuilder, Report), ReadError> {
    let name = |text: String| ReadError::whole_file(path, text);
    if path.is_dir() {
        return Err(name("this is a directory; expected a .scn, .obj or .ply file".to_owned()));
    }
    Format::of(path).map_err(name)?;
    let bytes = files::load(path).map_err(|e| name(format!("cannot read the file: {e}")))?;
    read_with_options(&bytes, path, files, options)
}

/// Like [`open`], from bytes: `name` tells the format and stands in messages, `files` brings the
/// models and materials that the file refers to.
pub fn read(
    bytes: &[u8],
    name: &Path,
    files: &dyn Files,
) -> Result<(SceneBuilder, Report), ReadError> {
    read_with_options(bytes, name, files, ReadOptions::default())
}

/// [`read`] with these options.
pub fn read_with_options(
    bytes: &[u8],
    name: &Path,
    files: &dyn Files,
    options: ReadOptions,
) -> Result<(SceneBuilder, Report), ReadError> {
    match Format::of(name).map_err(|text| ReadError::whole_file(name, text))? {
        Format::Scn => read_scn(bytes, name, files),
        Format::Obj => read_obj(bytes, name, files, options),
        Format::Ply => read_ply(bytes, name, options),
    }
}

/// What the ending of a file's name says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Scn,
    Obj,
    Ply,
}

impl Format {
    /// The format, or what to do about a file of another one.
    fn of(path: &Path) -> Result<Format, String> {
        let ending = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
        match ending.as_deref() {
            Some("scn") => Ok(Format::Scn),
            Some("obj") => Ok(Format::Obj),
            Some("ply") => Ok(Format::Ply),
            Some(ending) => Err(advice::on(path, ending)),
            None => Err("the name must end in .scn, .obj or .ply".to_owned()),
        }
    }
}

/// Reads the geometry of a model alone; its own materials are not even looked for.
fn model(format: Format, bytes: &[u8], log: &mut Log) -> Result<Mesh, ReadError> {
    match format {
        Format::Scn => Err(log.error(None, "a scene cannot be a part of another scene")),
        Format::Obj => Ok(obj::read(bytes, log)?.mesh),
        Format::Ply => ply::read(bytes, log),
    }
}

fn read_obj(
    bytes: &[u8],
    name: &Path,
    files: &dyn Files,
    options: ReadOptions,
) -> Result<(SceneBuilder, Report), ReadError> {
    let mut log = Log::new(name);
    let mut builder = SceneBuilder::new(title(name));
    let model = obj::read(bytes, &mut log)?;
    let record = FileRecorder::new(name, bytes, files);
    let parts = obj::materials(&model, &record, &mut builder, &mut log)?;
    record.remarks().into_iter().for_each(|note| log.note(note));
    builder.source = record.finish();
    let lines = model.lines();
    let parts: Vec<_> = parts
        .into_iter()
        .zip(lines)
        .map(|((range, material), line)| (range, Origin { material, line }))
        .collect();
    let upright = stand(&mut builder, &model.mesh, Axis::Y, options, &mut log);
    let counts =
        builder.place(&model.mesh, upright, &parts).map_err(|e| log.error(None, e.to_string()))?;
    alone(builder, counts, options, log)
}

fn read_ply(
    bytes: &[u8],
    name: &Path,
    options: ReadOptions,
) -> Result<(SceneBuilder, Report), ReadError> {
    let mut log = Log::new(name);
    let mut builder = SceneBuilder::new(title(name));
    let mesh = ply::read(bytes, &mut log)?;
    builder.source = FileRecorder::new(name, bytes, &Memory(&[])).finish();
    log.note(format!("a PLY file has no material: {GREY_IS}"));
    let grey = builder.material(grey(&log)?);
    let upright = stand(&mut builder, &mesh, Axis::Z, options, &mut log);
    let counts = builder.mesh(&mesh, upright, grey).map_err(|e| log.error(None, e.to_string()))?;
    alone(builder, counts, options, log)
}

/// The turn that stands a model upright; the builder knows of it, the log tells it. `custom` is what
/// files of this format have up.
fn stand(
    builder: &mut SceneBuilder,
    mesh: &Mesh,
    custom: Axis,
    options: ReadOptions,
    log: &mut Log,
) -> DAffine3 {
    let up = match options {
        ReadOptions { up: Some(up), .. } => up,
        ReadOptions { bare: true, .. } => return DAffine3::IDENTITY,
        _ => {
            let up = Axis::guess(mesh, custom);
            let why = if up == custom { "the custom of such files" } else { "its larger foot" };
            log.note(format!("its axis {} points up, by {why}; another can be chosen", up.name()));
            up
        }
    };
    builder.source.up = Some(up);
    DAffine3::from_quat(up.rotation())
}

/// Completes a model that is looked at by itself.
fn alone(
    mut builder: SceneBuilder,
    counts: MeshCounts,
    options: ReadOptions,
    mut log: Log,
) -> Result<(SceneBuilder, Report), ReadError> {
    if let Some(text) = left_out(counts) {
        log.warn(None, text.clone());
        if counts.kept == 0 {
            return Err(log.error(None, format!("nothing is left to show: {text}")));
        }
    }
    settle(&mut builder, &mut log);
    if !builder.is_lit() {
        let (low, high) = builder.bounds();
        let stage = if options.bare { None } else { ModelStage::around(low, high) };
        match stage {
            Some(stage) => {
                put_up(stage, [low, high], &mut builder)
                    .map_err(|e| log.error(None, e.to_string()))?;
                log.note("nothing in the file emits: put on a stage with two lights");
            }
            None => {
                builder.environment = [1.0; 3];
                log.note(
                    "nothing in the file emits: lit by a uniform white environment of radiance 1",
                );
            }
        }
    }
    Ok((builder, log.finish()))
}

/// Puts a model of these bounds on a stage and frames it.
fn put_up(
    stage: ModelStage,
    [low, high]: [DVec3; 2],
    builder: &mut SceneBuilder,
) -> Result<(), StageError> {
    let [width, height] = builder.screen.map(f64::from);
    builder.camera = Some(Camera::framing(low, high, width / height.max(1.0)));
    builder.focus = Some([low, high]);
    stage.put_up(builder)
}

/// Ends reading: what coincides is left out, and told.
fn settle(builder: &mut SceneBuilder, log: &mut Log) {
    let remarks = builder.settle();
    for (line, text) in remarks.warnings {
        log.warn(line, text);
    }
    for text in remarks.notes {
        log.note(text);
    }
}

const GREY_IS: &str = "a glossy grey of Kd 0.3, Ks 0.2, alpha 0.25 is used";

/// The surface of a model that brings none: glossy, so that models and roughness act on it.
fn grey(log: &Log) -> Result<Material, ReadError> {
    Material::reflecting("grey", [0.3; 3], [0.2; 3], 30.0)
        .map_err(|e| log.error(None, e.to_string()))
}

/// One sentence on the triangles and normals that could not be used; `None` if all could.
fn left_out(counts: MeshCounts) -> Option<String> {
    let dropped = counts.degenerate + counts.out_of_range + counts.bad_index;
    let reasons: Vec<String> = [
        (counts.degenerate, "without area"),
        (counts.out_of_range, "with a vertex that is not finite or beyond 1e18"),
        (counts.bad_index, "with an index that names no vertex"),
    ]
    .into_iter()
    .filter(|(n, _)| *n > 0)
    .map(|(n, why)| format!("{n} {why}"))
    .collect();
    let mut sentences = Vec::new();
    if dropped > 0 {
        let all = dropped + counts.kept;
        sentences
            .push(format!("{dropped} of {all} triangles are left out: {}", reasons.join(", ")));
    }
    if counts.bad_normals > 0 {
        sentences.push(format!(
            "the normal of {} vertices is zero or not finite: that of the face is used",
            counts.bad_normals
        ));
    }
    if sentences.is_empty() { None } else { Some(sentences.join("; ")) }
}

/// What the window calls a scene: the name of its file.
fn title(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}
