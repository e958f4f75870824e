//! `burnish info`: what a picture was made of, or what is in a scene.

use super::{Failure, print, scene, talk, values};
use crate::shell::{file as file_of, line as line_of, quoted};
use burnish::picture::{Format, contents as picture_contents, read_recipe_of};
use burnish::plain;
use burnish::progressive::{MaterialRecipe, Recipe, RecipeError};
use burnish::scene::presets::PRESETS;
use burnish::scene::{Axis, Crop, Material, Report, Scene, SourceFile};
use serde::Serialize;
use std::fmt::Display;
use std::path::{Path, PathBuf};

/// Tells how a picture was made, or what is in a scene, or which material presets there are.
///
/// Pictures that burnish writes carry their recipe: all that is needed to make them again, and how
/// far they are from the truth.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  burnish info table.png                    how it was made, and the command that makes it again
  burnish info table.exr --json             the same for a script
  burnish info table.png --scene > new.scn  its scene, with the materials and camera of the picture
  burnish info cornell                      what is in a scene: shapes, materials, warnings
  burnish info bunny.ply --up y             a model, stood on another of its sides
  burnish info --presets                    gold, copper, ...: Kd, Ks, alpha and where they come from")]
pub(super) struct Args {
    /// Picture (.png, .exr) written by burnish, scene (.scn, .obj, .ply), or shipped scene's name.
    #[arg(required_unless_present = "presets")]
    file: Option<PathBuf>,
    /// Prints JSON instead of text.
    #[arg(long)]
    json: bool,
    /// Prints the text of a picture's scene, with its materials, camera and size in it.
    #[arg(long, conflicts_with = "json")]
    scene: bool,
    /// The part of an OpenEXR picture that is meant, by its name. Without it, the first that has a
    /// recipe.
    #[arg(long, value_name = "NAME")]
    part: Option<String>,
    /// The axis of an OBJ or PLY file that points up, instead of the one that is guessed.
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true, value_parser = values::axis())]
    up: Option<Axis>,
    /// Prints the material presets: Kd and Ks in linear Rec. 709, a roughness alpha, and their source.
    #[arg(long, conflicts_with_all = ["file", "json", "scene", "part", "up"])]
    presets: bool,
}

/// Finds out and prints.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let Some(path) = args.file.as_deref() else { return presets() };
    if Format::of(path).is_ok() {
        picture(path, args)
    } else if args.scene || args.part.is_some() {
        let (path, option) = (plain::path(path), if args.scene { "--scene" } else { "--part" });
        Err(Failure::new(format_args!("{path}: {option} is about pictures: .png or .exr files")))
    } else {
        describe_scene(path, args)
    }
}

/// The material presets, a line each.
fn presets() -> Result<(), Failure> {
    for preset in &PRESETS {
        let [kd, ks] = [preset.kd, preset.ks].map(|c| c.map(|x| format!("{x:<6}")).concat());
        let (name, alpha) = (preset.name, preset.alpha);
        print(format_args!("{name:<10} Kd {kd} Ks {ks} alpha {alpha:<5} {}", preset.source))?;
    }
    Ok(())
}

fn picture(path: &Path, args: &Args) -> Result<(), Failure> {
    let about = |e: &dyn Display| Failure::new(format_args!("{}: {e}", plain::path(path)));
    let found = read_recipe_of(path, args.part.as_deref()).map_err(Failure::new)?;
    let found = found.ok_or_else(|| {
        let has = picture_contents(path).map_or(String::new(), |has| format!("; it has {has}"));
        about(&format_args!(
            "there is no recipe in it: it was written by another program, or saved again by one, or is a \
             contact sheet, whose .exr file has one for each picture{has}"
        ))
    })?;
    if let Some(part) = &found.part {
        talk::note(format_args!("{}: this is about its part `{part}`", plain::path(path)));
    }
    let text = found.text;
    let recipe = match Recipe::parse(&text) {
        // What it cannot understand it can still hand out.
        Ok(_) | Err(RecipeError::Version(_)) if args.json => return print(text.trim_end()),
        read => read.map_err(|e| about(&e))?,
    };
    if args.scene {
        let text = recipe.scene_text().map_err(|e| about(&e))?;
        return print(text.replace("\r\n", "\n").replace('\r', "\n").trim_end());
    }
    describe_picture(path, &recipe)
}

/// A line of two columns.
fn line(label: &str, text: impl Display) -> Result<(), Failure> {
    print(plain::line(&format!("{label:<10} {text}")).trim_end())
}

fn describe_picture(path: &Path, recipe: &Recipe) -> Result<(), Failure> {
    let [width, height] = recipe.size;
    line("picture", format_args!("{width}x{height} pixels, by burnish {}", recipe.burnish))?;
    line("scene", &recipe.scene.name)?;
    for file in &recipe.scene.files {
        line("", file_line(&file.name, file.bytes, &file.sha256))?;
    }
    let moved = if recipe.moved { "" } else { "  (the scene's)" };
    line("camera", format_args!("{}{moved}", recipe.camera.trim_start_matches("camera ")))?;
    if let Some([x, y, side]) = recipe.crop.map(Crop::parts) {
        line("crop", format_args!("{x},{y},{side}  (left, top and side in parts of the whole)"))?;
    }
    line("materials", materials(recipe))?;
    for material in recipe.materials.iter().filter(|_| common(recipe).is_none()) {
        line("", edited_line(material))?;
    }
    line("model", &recipe.model)?;
    line("method", format_args!("{}, {} normals", recipe.strategy, recipe.normals))?;
    if let Some(erratum) = &recipe.erratum {
        line("erratum", format_args!("{erratum}: this picture is wrong on purpose"))?;
    }
    let depth = recipe.max_depth.map_or("none".to_owned(), |depth| depth.to_string());
    line("seed", format_args!("{}, depth limit {depth}", recipe.seed))?;
    line("passes", passes(recipe))?;
    line("error", error(recipe))?;
    if recipe.nonfinite > 0 {
        line("", format_args!("{} samples were NaN or infinite", recipe.nonfinite))?;
    }
    if recipe.capped > 0 {
        line("", format_args!("{} paths were ended by the safety caps", recipe.capped))?;
    }
    if let Some(tone) = &recipe.tone {
        line("tone", format_args!("{}, exposure {} EV", tone.curve, tone.exposure))?;
    }
    let tracer = if recipe.reference { "reference, " } else { "" };
    let group = match recipe.group {
        0 | 1 => "every path for itself".to_owned(),
        paths => format!("{paths} paths share"),
    };
    line("tracer", format_args!("{tracer}{}, {group}", recipe.isa))?;
    line("again", again(path, recipe))
}

fn file_line(name: &str, bytes: u64, sha256: &str) -> String {
    format!("{name}  {bytes} bytes  SHA-256 {sha256}")
}

/// The roughness that all materials have, as the option that sets it.
fn common(recipe: &Recipe) -> Option<String> {
    let alpha = recipe.alpha.map(|alpha| format!("alpha {alpha}"));
    alpha.or_else(|| recipe.exponent.map(|a_p| format!("a_p {a_p}")))
}

fn materials(recipe: &Recipe) -> String {
    match (recipe.materials.len(), common(recipe)) {
        (0, _) => "the scene's".to_owned(),
        (_, Some(roughness)) => format!("the scene's, all with {roughness}"),
        (1, None) => "one edited".to_owned(),
        (n, None) => format!("{n} edited"),
    }
}

fn edited_line(m: &MaterialRecipe) -> String {
    // A material without a comment above it is called by its line already.
    let line = m.line.map(|line| format!("line {line}")).filter(|line| !m.name.ends_with(line));
    let place = line.map_or(String::new(), |line| format!(" ({line})"));
    format!("{}{place}: {}", m.name, numbers(m.kd, m.ks, m.exponent, m.emission))
}

fn numbers(kd: [f32; 3], ks: [f32; 3], exponent: f64, emission: [f32; 3]) -> String {
    let triple = |[r, g, b]: [f32; 3]| format!("{r} {g} {b}");
    let mut parts = Vec::new();
    let black = [0.0; 3];
    if emission != black {
        parts.push(format!("emits {}", triple(emission)));
    }
    if emission == black || kd != black {
        parts.push(format!("Kd {}", triple(kd)));
    }
    if ks != black {
        parts.push(format!("Ks {}", triple(ks)));
        parts.push(format!("a_p {exponent}"));
    }
    parts.join("  ")
}

fn passes(recipe: &Recipe) -> String {
    let Recipe { passes, paths, rays, .. } = recipe;
    let part = if recipe.is_whole() {
        ""
    } else {
        "; ended within a pass: the same number of passes gives a picture that differs in its noise"
    };
    let span = |[from, to]: &[u64; 2]| format!("{from} to {}", to.saturating_sub(1));
    let mut parts: Vec<String> = recipe.parts.iter().take(MOST_PARTS).map(span).collect();
    if parts.len() < recipe.parts.len() {
        parts.push("...".to_owned());
    }
    let gaps = if parts.is_empty() { "" } else { "; some are missing: it has passes " };
    format!("{passes} ({paths} paths, {rays} rays{part}{gaps}{})", parts.join(", "))
}

fn error(recipe: &Recipe) -> String {
    let Some(error) = &recipe.error else { return "not known: too few passes".to_owned() };
    let percent = |x: f64| format!("{:.2}", 100.0 * x);
    let high = error.high.map_or("no upper limit".to_owned(), |high| percent(high) + " %");
    let doubt = if error.reliable { "" } else { "; not yet reliable" };
    format!(
        "{} % relative, estimated (95 % limits {} to {high}{doubt})",
        percent(error.relative),
        percent(error.low)
    )
}

/// The command that makes the picture again.
fn again(path: &Path, recipe: &Recipe) -> String {
    let edited = !recipe.materials.is_empty() && common(recipe).is_none();
    let own = recipe.scene.files.first().map(|file| file.name.clone());
    let scene = if edited {
        "edited.scn".to_owned()
    } else {
        file_of(&recipe.scene.example.clone().or(own).unwrap_or_else(|| "SCENE".to_owned()))
    };
    let kind = path.extension().map_or("png".into(), |kind| kind.to_string_lossy().into_owned());
    let output = format!("again.{kind}");
    let command = if recipe.parts.is_empty() {
        let words = ["burnish", "render", &scene, "-o", &output].map(str::to_owned);
        line_of(words.into_iter().chain(recipe.arguments()))
    } else {
        part_by_part(recipe, &scene, &output)
    };
    let first = if edited {
        format!("burnish info {} --scene > edited.scn; ", quoted(&file_of(&path.to_string_lossy())))
    } else {
        String::new()
    };
    first + &command
}

/// Most parts that are told one by one.
const MOST_PARTS: usize = 16;

/// The commands that make the passes there are, and put them together.
fn part_by_part(recipe: &Recipe, scene: &str, output: &str) -> String {
    let parts = recipe.parts.iter().take(MOST_PARTS);
    let mut files = Vec::new();
    let mut commands: Vec<String> = parts
        .map(|&part| {
            let file = format!("again-{}.exr", part[0]);
            let words = ["burnish", "render", scene, "--checkpoint", &file].map(str::to_owned);
            files.push(file);
            line_of(words.into_iter().chain(recipe.of_part(part).arguments()))
        })
        .collect();
    if files.len() < recipe.parts.len() {
        commands.push(format!(": and {} more", recipe.parts.len() - files.len()));
        files = vec!["again-*.exr".to_owned()];
    }
    commands.push(format!("burnish merge {} -o {}", files.join(" "), quoted(output)));
    commands.join("; ")
}

/// What is in a scene, for scripts.
#[derive(Serialize)]
struct Contents<'a> {
    name: &'a str,
    caption: Option<&'a str>,
    /// The axis of a model's file that points up.
    up: Option<&'static str>,
    triangles: usize,
    spheres: usize,
    cylinders: usize,
    /// Shapes left out because another is in the same place.
    duplicates: usize,
    screen: [u32; 2],
    camera: String,
    environment: [f32; 3],
    /// Lowest and highest corner in world units.
    bounds: [[f64; 3]; 2],
    materials: Vec<MaterialRecipe>,
    files: Vec<burnish::progressive::FileRecipe>,
    warnings: Vec<String>,
    notes: &'a [String],
}

fn describe_scene(path: &Path, args: &Args) -> Result<(), Failure> {
    let (builder, mut report) = scene::read(Some(path), args.up)?;
    let scene = builder.try_build().map_err(Failure::new)?;
    scene.report(&mut report);
    if args.json {
        let contents = contents(&scene, &report);
        return print(serde_json::to_string_pretty(&contents).map_err(Failure::new)?);
    }
    let counts = scene.counts();
    line("scene", scene.name())?;
    if let Some(caption) = scene.caption() {
        line("caption", caption)?;
    }
    for SourceFile { name, bytes, sha256, .. } in &scene.source().files {
        line("", file_line(name, *bytes, sha256))?;
    }
    let some = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
    let shapes = [
        some(counts.triangles, "triangle"),
        some(counts.spheres, "sphere"),
        some(counts.cylinders, "cylinder"),
    ];
    line("shapes", shapes.join(", "))?;
    if counts.duplicates > 0 {
        line("", format_args!("{} left out: they repeat others", counts.duplicates))?;
    }
    let [width, height] = scene.screen();
    line("screen", format_args!("{width}x{height} pixels"))?;
    line("camera", scene.camera().scn_line().trim_start_matches("camera "))?;
    let [low, high] = scene.bounds();
    line("bounds", format_args!("{low} to {high}"))?;
    if let Some(up) = scene.source().up {
        line("up", format_args!("{} of its file", up.name()))?;
    }
    if scene.environment() != [0.0; 3] {
        let [r, g, b] = scene.environment();
        line("sky", format_args!("{r} {g} {b} W/(m\u{b2} sr)"))?;
    }
    line("materials", scene.materials().len())?;
    for material in scene.materials() {
        let Material { name, kd, ks, roughness, emission } = material;
        let numbers = numbers(*kd, *ks, roughness.exponent(), *emission);
        line("", format_args!("{name}: {numbers}"))?;
    }
    for warning in &report.warnings {
        line("warning", warning)?;
    }
    for note in &report.notes {
        line("note", note)?;
    }
    Ok(())
}

fn contents<'a>(scene: &'a Scene, report: &'a Report) -> Contents<'a> {
    let counts = scene.counts();
    let source = scene.source();
    let [low, high] = scene.bounds();
    let materials = scene.materials().iter().enumerate();
    Contents {
        name: scene.name(),
        caption: scene.caption(),
        up: source.up.map(Axis::name),
        triangles: counts.triangles,
        spheres: counts.spheres,
        cylinders: counts.cylinders,
        duplicates: counts.duplicates,
        screen: scene.screen(),
        camera: scene.camera().scn_line(),
        environment: scene.environment(),
        bounds: [low.to_array(), high.to_array()],
        materials: materials
            .map(|(index, material)| MaterialRecipe::new(index, material, source))
            .collect(),
        files: source.files.iter().map(Into::into).collect(),
        warnings: report.warnings.iter().map(|warning| warning.to_string()).collect(),
        notes: &report.notes,
    }
}
