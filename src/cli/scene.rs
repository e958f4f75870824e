//! The scene that the command line names, read and built.

use super::{Failure, talk};
use burnish::math::simd::Isa;
use burnish::plain;
use burnish::scene::builtin::{Example, default_scene};
use burnish::scene::read::{Disk, ReadOptions, open_with_options};
use burnish::scene::{Axis, Camera, Light, Report, Scene, SceneBuilder};
use std::fmt;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// A scene and how long it took.
pub(super) struct Loaded {
    pub(super) scene: Arc<Scene>,
    /// Seconds from the file's first byte to its shapes.
    pub(super) load_s: f64,
    /// Seconds for recentring them and building the tree.
    pub(super) build_s: f64,
}

/// Reads and builds the file, or the shipped scene of that name; the default scene without either.
/// The reader's remarks go to stderr.
pub(super) fn load(path: Option<&Path>) -> Result<Loaded, Failure> {
    load_for(path, None, None)
}

/// [`load`], to be traced with this instruction set, or the widest; with this axis of a model up, or
/// the one that the reader guesses.
pub(super) fn load_for(
    path: Option<&Path>,
    isa: Option<Isa>,
    up: Option<Axis>,
) -> Result<Loaded, Failure> {
    let start = Instant::now();
    let (builder, mut report) = read(path, up)?;
    let load_s = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let mut scene = builder.try_build().map_err(Failure::new)?;
    let build_s = start.elapsed().as_secs_f64();
    scene.report(&mut report);
    for warning in &report.warnings {
        talk::warning(warning);
    }
    for note in &report.notes {
        talk::note(note);
    }
    if let Some(isa) = isa {
        scene.set_isa(isa);
    }
    let scene = Arc::new(scene);
    let loaded = Loaded { scene, load_s, build_s };
    talk::detail(&loaded);
    Ok(loaded)
}

impl fmt::Display for Loaded {
    /// What there is in the scene and how long it took, in two lines.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let (scene, counts) = (&self.scene, self.scene.counts());
        let emits = |light: &&Light| scene.materials()[light.material as usize].emits();
        let lights = scene.surfaces().iter().filter(emits).count();
        writeln!(
            f,
            "{}: {} triangles, {} spheres, {} cylinders, {} materials, {} shapes that emit",
            scene.name(),
            counts.triangles,
            counts.spheres,
            counts.cylinders,
            scene.materials().len(),
            lights
        )?;
        write!(
            f,
            "read in {:.3} s, tree built in {:.3} s: {:.1} MiB, {} levels, traced by {}",
            self.load_s,
            self.build_s,
            scene.bvh().bytes() as f64 / 1048576.0,
            scene.bvh().depth(),
            scene.isa().name()
        )
    }
}

/// Whether there is such a file or shipped scene, before the work for others begins.
pub(super) fn exists(path: &Path) -> Result<(), Failure> {
    if is_there(path) { Ok(()) } else { read(Some(path), None).map(drop) }
}

/// Whether there is such a file or shipped scene.
pub(super) fn is_there(path: &Path) -> bool {
    path.exists() || example(path).is_some()
}

fn example(path: &Path) -> Option<&'static Example> {
    // A file of that name comes first.
    path.to_str().and_then(Example::named).filter(|_| !path.exists())
}

/// Reads the same without building it; the remarks are the caller's.
pub(super) fn read(
    path: Option<&Path>,
    up: Option<Axis>,
) -> Result<(SceneBuilder, Report), Failure> {
    let read = match path.map(|path| (path, example(path))) {
        None => default_scene(),
        Some((_, Some(example))) => example.read(),
        Some((path, None)) => {
            open_with_options(path, &Disk::beside(path), ReadOptions { up, bare: false })
        }
    };
    let (builder, report) = read.map_err(Failure::new)?;
    if up.is_some() && builder.source.up.is_none() {
        let name = plain::line(&builder.name);
        talk::warning(format_args!("{name}: --up is for OBJ and PLY files; a .scn file is Z up"));
    }
    Ok((builder, report))
}

/// The text after the keyword `camera` of a `.scn` file.
pub(super) fn camera(text: &str) -> Result<Camera, String> {
    burnish::scene::read::parse_camera(text)
}
