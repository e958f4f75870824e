//! Files. Every reader: what it makes of good ones, what it says of odd ones, and that no input at all
//! makes it panic; and scenes and pictures as they are written.

#[path = "../support/bounded.rs"]
mod bounded;
mod broken;
mod coincide;
mod files;
mod mtl;
#[path = "../support/mutate.rs"]
mod mutate;
mod normals;
mod obj;
mod pictures;
mod ply;
mod scn;
mod stage;
#[path = "../support/mod.rs"]
mod support;
mod write;

use burnish::scene::read::{self, Files, Memory, ReadError, ReadOptions};
use burnish::scene::{Report, Scene, SceneBuilder};
use glam::DVec3;

type Read = Result<(SceneBuilder, Report), ReadError>;

/// Reads this text, which refers to no other files.
fn text(name: &str, text: &str) -> Read {
    bare(text.as_bytes(), name, &Memory(&[]))
}

/// Reads a model as it is, without a stage: what is read is all that there is.
fn bare(bytes: &[u8], name: &str, files: &dyn Files) -> Read {
    let options = ReadOptions { bare: true, up: None };
    read::read_with_options(bytes, name.as_ref(), files, options)
}

/// The same from disk.
fn open_bare(path: &std::path::Path) -> Read {
    let options = ReadOptions { bare: true, up: None };
    read::open_with_options(path, &read::Disk::beside(path), options)
}

/// The message of something that must not be read.
fn message(result: Read) -> String {
    result.expect_err("this must not be read").to_string()
}

fn warnings(report: &Report) -> Vec<String> {
    report.warnings.iter().map(|w| w.to_string()).collect()
}

/// All triangles in world units.
fn triangles(scene: &Scene) -> Vec<[DVec3; 3]> {
    let geometry = scene.geometry();
    let world = |p: [f32; 3]| scene.placement().to_world(DVec3::from_array(p.map(f64::from)));
    (0..geometry.faces().len()).map(|i| geometry.corners(i).map(|p| world(p.into()))).collect()
}

/// Equal up to the rounding of coordinates to single precision.
fn close(a: DVec3, b: DVec3) -> bool {
    (a - b).abs().max_element() <= 4.0 * f64::from(f32::EPSILON) * (1.0 + b.length())
}
