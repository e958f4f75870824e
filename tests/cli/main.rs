//! The command line, driven as a user or a script drives it: arguments in, files and codes out.

mod brdf;
mod experiment;
mod info;
#[cfg(unix)]
mod limits;
mod measure;
mod outputs;
mod sheet;

use burnish::math::simd::Isa;
use image::GenericImageView;
use serde_json::Value;
use std::collections::HashMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
#[cfg(unix)]
use std::{
    io::{BufRead, BufReader, Lines},
    process::{Child, ChildStderr},
};

fn burnish() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_burnish"));
    for display in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
        command.env_remove(display);
    }
    command.stdin(Stdio::null());
    command
}

fn run(args: &[&str]) -> Output {
    burnish().args(args).output().unwrap()
}

fn code(output: &Output) -> i32 {
    output.status.code().unwrap()
}

fn out(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn err(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// Runs what must succeed and gives its stdout.
fn must(args: &[&str]) -> String {
    let output = run(args);
    assert_eq!(code(&output), 0, "{args:?}: {}", err(&output));
    out(&output)
}

/// Begins a command that says on stderr what it does, and waits for the line in which this stands; the
/// lines after that one are still to come.
#[cfg(unix)]
fn until_told(mut command: Command, text: &str) -> (Child, Lines<BufReader<ChildStderr>>) {
    let mut child = command.stderr(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
    let told: Vec<String> =
        lines.by_ref().map(|line| line.unwrap()).take_while(|line| !line.contains(text)).collect();
    assert!(child.try_wait().unwrap().is_none(), "it has ended: {told:?}");
    (child, lines)
}

/// Sends a signal, as `-INT`.
#[cfg(unix)]
fn signal(child: &Child, name: &str) {
    let pid = child.id().to_string();
    assert!(Command::new("kill").args([name, &pid]).status().unwrap().success());
}

/// A file's path in a folder as an argument.
fn at(folder: &tempfile::TempDir, name: &str) -> String {
    folder.path().join(name).to_str().unwrap().to_owned()
}

fn json(path: &str) -> Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

fn table(csv: &str) -> Vec<HashMap<String, String>> {
    let mut reader = csv::Reader::from_reader(csv.as_bytes());
    reader.deserialize().map(|row| row.unwrap()).collect()
}

/// Nothing but sky of radiance 1.
const SKY: &str = "screen 32 24\ncamera 0 0 0 1 x 0\nenvironment 1 1 1\n\
                   brdf 0.5 0.5 0.5  0 0 0  1\nsphere 0 0 50  1\n";

#[test]
fn every_help_has_an_example_that_names_its_subcommand() {
    for (args, example) in [
        (&["--help"][..], "burnish render table.scn -o table.png"),
        (&["render", "--help"], "burnish render table.scn -o table.exr"),
        (&["brdf", "--help"], "burnish brdf --eval"),
        (&["report", "--help"], "burnish report latency"),
        (&["report", "--help"], "burnish report speed table.scn --plot"),
        (&["render", "--help"], "-o out/{name}-{model}.png"),
        (&["compare", "--help"], "burnish compare fast.exr"),
        (&["check", "--help"], "burnish check --model"),
        (&["completions", "--help"], "burnish completions fish"),
        (&["sheet", "--help"], "burnish sheet -o sheet.png"),
    ] {
        let help = must(args);
        assert!(help.contains("Examples:") && help.contains(example), "{args:?}: {help}");
    }
    assert_eq!(must(&["--version"]).trim(), concat!("burnish ", env!("CARGO_PKG_VERSION")));
}

#[test]
fn bad_arguments_are_code_2_and_named() {
    let o = ["render", "-o", "never-written.png"];
    for (more, named) in [
        (&["--nonsense"][..], "--nonsense"),
        (&["--model", "lambert"], "phong, beckmann, ggx"),
        (&["--alpha", "0"], "0.0001 to 1"),
        (&["--alpha", "-0.5"], "--alpha"),
        (&["--exponent", "-1"], "--exponent"),
        (&["--alpha", "0.1", "--exponent", "10"], "cannot be used with"),
        (&["--passes", "0"], "--passes"),
        (&["--passes", "4294967297"], "--passes"),
        (&["--time", "0"], "--time"),
        (&["--time", "1", "--passes", "1"], "cannot be used with"),
        (&["--size", "0x10"], "WIDTHxHEIGHT"),
        (&["--size", "640"], "WIDTHxHEIGHT"),
        (&["--camera", "1 2 3"], "--camera"),
        (&["--camera", "0 0 0 -1 x 0"], "--camera"),
        (&["--seed", "-1"], "--seed"),
        (&["--threads", "100000"], "--threads"),
        (&["--max-depth", "0"], "--max-depth"),
        (&["--exposure", "31"], "-30 to 30"),
        (&["--exposure", "nan"], "--exposure"),
        (&["--tone", "gamma"], "srgb, reinhard, filmic"),
        (&["-o", "picture.jpg"], ".exr"),
        (&["a.scn", "b.scn"], "put {name} into its name"),
        (&["--model", "all"], "put {model} into its name"),
        (&["-o", "{seed}.png"], "{name}"),
        (&["-o", "never-written.png"], "written twice"),
        (&["--quiet", "--verbose"], "cannot be used with"),
    ] {
        let output = run(&[&o[..], more].concat());
        assert_eq!(code(&output), 2, "{more:?}: {}", err(&output));
        assert!(err(&output).contains(named), "{more:?}: {}", err(&output));
    }
    for args in [
        &["render"][..],
        &["compare", "a.exr"],
        &["table.scn", "render", "-o", "never-written.png"],
        &["--threads", "2", "render", "-o", "never-written.png"],
        &["report", "speed", "--model", "lambert"],
        &["report", "speed", "--strategy", "mis,"],
        &["report", "speed", "--exact", "-1"],
        &["report", "speed", "--exact", "1", "--reference-passes", "64"],
        &["report", "latency", "--passes", "4"],
        &["report", "speed", "--changes", "4"],
        &["brdf"],
        &["brdf", "--albedo", "--ks", "1.5"],
    ] {
        assert_eq!(code(&run(args)), 2, "{args:?}");
    }
    assert!(!Path::new("never-written.png").exists());
}

/// Of every subcommand, so that none is forgotten.
#[test]
fn every_subcommand_has_examples() {
    let help = must(&["--help"]);
    let list = help.split_once("Commands:\n").unwrap().1.split("\n\n").next().unwrap();
    // A name stands two columns in, the text that goes on further.
    let names = list.lines().filter(|l| l.starts_with("  ") && !l.starts_with("   "));
    let names: Vec<&str> = names.map(|l| l.split_whitespace().next().unwrap()).collect();
    assert!(names.contains(&"render") && names.len() >= 6, "{names:?}");
    for name in names.into_iter().filter(|name| *name != "help") {
        let help = must(&[name, "--help"]);
        let examples = help.split_once("Examples:\n").unwrap_or_else(|| panic!("{help}")).1;
        assert!(examples.contains(&format!("  burnish {name}")), "{examples}");
        assert!(help.contains("--quiet") && help.contains("--verbose"), "{help}");
    }
}

#[test]
fn completions_know_the_arguments() {
    for shell in ["bash", "zsh", "fish"] {
        let script = must(&["completions", shell]);
        for word in ["burnish", "render", "completions", "exposure", "quiet", "filmic"] {
            assert!(script.contains(word), "{word} is not in the script for {shell}");
        }
    }
    assert_eq!(code(&run(&["completions", "command.com"])), 2);
}

#[test]
fn quiet_says_nothing_and_verbose_more() {
    let folder = tempfile::tempdir().unwrap();
    let png = at(&folder, "a.png");
    // Something to remark on, in the scene and of the render.
    let scene = at(&folder, "a.scn");
    fs::write(&scene, "environment 1 1 1\nbrdf 0.5 0.5 0.5 0 0 0 1\nsphere 0 0 0 1\n").unwrap();
    let small = ["render", &scene, "-o", &png, "--size", "32x24", "--passes", "2"];
    let said = |more: &[&str]| {
        let output = run(&[&small[..], &["--erratum", "double-direct"], more].concat());
        assert_eq!((code(&output), out(&output).as_str()), (0, ""));
        err(&output)
    };
    let normal = said(&[]);
    assert!(normal.contains("warning: ") && normal.contains("wrong on purpose"), "{normal}");
    assert_eq!((said(&["--quiet"]), said(&["-q"])), (String::new(), String::new()));
    let verbose = said(&["-v", "--threads", "2"]);
    for part in ["1 spheres", "tree built in", "2 worker threads", "rays/s", "a.png", "seed 0"] {
        assert!(verbose.contains(part) && !normal.contains(part), "{part} in {verbose}");
    }
    // Errors are always told.
    let output = run(&["render", "-q", "no-such.scn", "-o", &png]);
    assert!(code(&output) == 1 && err(&output).contains("no-such.scn"), "{}", err(&output));
}

#[test]
fn colours_are_for_terminals() {
    let folder = tempfile::tempdir().unwrap();
    let missing = at(&folder, "missing.scn");
    let said = |variables: &[(&str, &str)]| {
        let mut command = burnish();
        for name in ["NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE", "TERM"] {
            command.env_remove(name);
        }
        command.envs(variables.iter().copied()).args(["render", &missing, "-o"]);
        let output = command.arg(at(&folder, "a.png")).output().unwrap();
        assert_eq!(code(&output), 1);
        err(&output)
    };
    let plain = said(&[("TERM", "xterm-256color")]);
    assert!(plain.starts_with("burnish: ") && !plain.contains('\x1b'), "{plain:?}");
    // Asked for in so many words, they are there also without a terminal.
    let forced = said(&[("CLICOLOR_FORCE", "1")]);
    assert!(forced.starts_with('\x1b') && forced.contains("missing.scn"), "{forced:?}");
    let refused = said(&[("NO_COLOR", "1"), ("TERM", "xterm-256color")]);
    assert_eq!(refused, plain);
}

#[test]
fn several_scenes_and_models_are_several_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let scene = at(&folder, "sky.scn");
    fs::write(&scene, SKY).unwrap();
    let small = ["--size", "24x18", "--passes", "2"];
    let [pattern, stats] = ["{model}-{name}.exr", "{name}.{model}.json"].map(|n| at(&folder, n));
    let many = ["render", "cornell", "plates", &scene, "--model", "ggx,phong", "-o", &pattern];
    let output = run(&[&many[..], &["--stats", &stats], &small].concat());
    assert_eq!(code(&output), 0, "{}", err(&output));
    assert!(err(&output).contains("6 of 6: "), "{}", err(&output));
    for (name, path) in [("cornell", "cornell"), ("plates", "plates"), ("sky", &scene)] {
        for model in ["ggx", "phong"] {
            // The same bits as by itself.
            let alone = at(&folder, "alone.exr");
            must(&[&["render", path, "--model", model, "-o", &alone][..], &small].concat());
            let file = at(&folder, &format!("{model}-{name}.exr"));
            let [one, many] = [&alone, &file].map(|p| burnish::picture::read_exr(p.as_ref()));
            assert!(one.unwrap() == many.unwrap(), "{file}");
            let j = json(&at(&folder, &format!("{name}.{model}.json")));
            assert_eq!((&j["model"], &j["passes"]), (&model.into(), &2.into()));
        }
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 14);

    // A scene that is not there is found out before the first one is rendered.
    let never = at(&folder, "never-{name}.exr");
    let output = run(&["render", "cornell", "no-such.scn", "-o", &never]);
    assert!(code(&output) == 1 && err(&output).contains("no-such.scn"), "{}", err(&output));
    assert!(!Path::new(&at(&folder, "never-cornell.exr")).exists());
}

#[test]
fn a_missing_scene_is_code_1_and_named_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, picture) = (at(&folder, "no-such.scn"), at(&folder, "a.png"));
    for args in [
        &["render", &scene, "-o", &picture][..],
        &["report", "latency", &scene],
        &["report", "speed", &scene],
        &[&scene],
    ] {
        let output = run(args);
        assert_eq!(code(&output), 1, "{args:?}");
        let text = err(&output);
        assert!(text.contains("no-such.scn") && text.lines().count() == 1, "{args:?}: {text}");
    }
    assert!(!Path::new(&picture).exists());
}

#[test]
fn a_broken_scene_is_code_1_with_file_and_line() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, picture) = (at(&folder, "broken.scn"), at(&folder, "a.png"));
    fs::write(&scene, "screen 64 48\nlight 1 1 1\nsphere 0 0 0 banana\n").unwrap();
    let output = run(&["render", &scene, "-o", &picture]);
    assert_eq!(code(&output), 1);
    assert!(err(&output).contains("broken.scn:3"), "{}", err(&output));
    // Of several errors each has a line of its own.
    fs::write(&scene, "screen 64 48\nlight 1 1\nsphere 0 0 0 banana\nbox 1\n").unwrap();
    let text = err(&run(&["render", &scene, "-o", &picture]));
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 3, "{text}");
    for (line, number) in lines.iter().zip(2..) {
        assert!(line.starts_with("burnish: "), "{text}");
        assert!(line.contains(&format!("broken.scn:{number}: ")), "{text}");
    }
}

#[test]
fn where_nothing_can_be_written_nothing_is_rendered() {
    let folder = tempfile::tempdir().unwrap();
    let (good, bad) = (at(&folder, "a.png"), at(&folder, "missing/b.exr"));
    // So many passes that rendering first would show in the test's time.
    for bad in [&["-o", &bad][..], &["--stats", &bad]] {
        let output = run(&[&["render", "-o", &good, "--passes", "1000000"][..], bad].concat());
        assert_eq!(code(&output), 1);
        assert!(err(&output).contains("missing"), "{}", err(&output));
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn without_a_display_the_window_is_one_line_that_names_the_way_out() {
    let output = run(&[]);
    let text = err(&output);
    assert_eq!(code(&output), 1);
    assert_eq!(text.lines().count(), 1, "{text}");
    assert!(text.contains("burnish render -o picture.png"), "{text}");
}

#[test]
fn the_window_takes_a_shipped_scene_by_name_as_render_does() {
    let output = run(&["gallery"]);
    assert!(err(&output).contains("burnish render gallery -o"), "{}", err(&output));
    let output = run(&["galery"]);
    let text = err(&output);
    assert_eq!((code(&output), text.lines().count()), (1, 1), "{text}");
    assert!(text.contains("galery: there is no such file, and no shipped scene"), "{text}");
}

#[test]
fn render_writes_pictures_and_their_figures() {
    let folder = tempfile::tempdir().unwrap();
    let [exr, png, stats] = ["a.exr", "a.png", "a.json"].map(|name| at(&folder, name));
    let output = run(&[
        "render",
        "-o",
        &exr,
        "-o",
        &png,
        "--stats",
        &stats,
        "--size",
        "80x60",
        "--passes",
        "8",
        "--model",
        "beckmann",
        "--alpha",
        "0.2",
        "--seed",
        "5",
        "--threads",
        "2",
        "--exposure",
        "-1",
    ]);
    assert_eq!(code(&output), 0, "{}", err(&output));
    assert!(out(&output).is_empty(), "results go to files alone");
    assert!(err(&output).contains("8 passes"), "{}", err(&output));

    let exr = burnish::picture::read_exr(exr.as_ref()).unwrap();
    assert_eq!((exr.width, exr.height), (80, 60));
    assert_eq!(image::open(&png).unwrap().dimensions(), (80, 60));

    let j = json(&stats);
    let number = |name: &str| j[name].as_f64().unwrap_or_else(|| panic!("{name} in {j}"));
    assert_eq!([number("passes"), number("paths")], [8.0, 8.0 * 80.0 * 60.0]);
    assert_eq!([number("width"), number("height"), number("threads")], [80.0, 60.0, 2.0]);
    assert_eq!([number("seed"), number("nonfinite")], [5.0, 0.0]);
    assert_eq!(
        (&j["model"], &j["version"]),
        (&"beckmann".into(), &env!("CARGO_PKG_VERSION").into())
    );
    assert_eq!(j["isa"], Isa::detect().name());
    assert!(number("rays") > number("paths"));
    assert!(number("load_s") >= 0.0 && number("build_s") >= 0.0 && number("capped") >= 0.0);
    assert!(number("render_s") > 0.0 && number("render_s") < 60.0);
    assert!(number("first_image_s") > 0.0 && number("first_image_s") < 60.0);
    assert!(number("est_rel_error") > 0.0 && number("est_rel_error") < 10.0);
    if cfg!(target_os = "linux") {
        assert!((1.0..4096.0).contains(&number("peak_mib")));
    }
    // The mean that is told is that of the file.
    for channel in 0..3 {
        let sum: f64 = exr.pixels.iter().map(|p| f64::from(p[channel])).sum();
        let mean = j["mean"][channel].as_f64().unwrap();
        assert!(mean > 0.0 && (mean - sum / 4800.0).abs() <= 1e-12 * mean, "{mean}");
    }
}

/// The pixels of two renders at 48x36 with these further arguments.
fn two_renders(a: &[&str], b: &[&str]) -> [Vec<[f32; 3]>; 2] {
    let folder = tempfile::tempdir().unwrap();
    let path = at(&folder, "a.exr");
    [a, b].map(|more| {
        must(&[&["render", "-o", &path, "--size", "48x36", "--passes", "2"][..], more].concat());
        burnish::picture::read_exr(path.as_ref()).unwrap().pixels
    })
}

#[test]
fn the_picture_depends_on_what_it_should_and_on_nothing_else() {
    let same = |a: &[&str], b: &[&str]| {
        let [a, b] = two_renders(a, b);
        a == b
    };
    assert!(same(&["--threads", "1"], &["--threads", "3"]));
    assert!(same(&["--alpha", "1"], &["--exponent", "0"]));
    assert!(same(&["--exposure", "3", "--tone", "filmic"], &[]), "an EXR file is the radiance");
    assert!(!same(&["--seed", "1"], &["--seed", "2"]));
    assert!(!same(&["--model", "phong"], &["--model", "ggx"]));
    assert!(!same(&["--alpha", "0.1"], &["--alpha", "0.4"]));
    assert!(!same(&["--max-depth", "1"], &[]));
    for (strategy, alike) in [("mis", true), ("light", false), ("bsdf", false)] {
        assert_eq!(same(&["--strategy", strategy], &[]), alike, "{strategy}");
    }
    for isa in Isa::available() {
        let (name, best) = (isa.name(), Isa::detect());
        // The wide sets give the same bits, the portable one has no fused sums.
        let alike = isa == best || isa != Isa::Portable;
        assert_eq!(same(&["--isa", name], &[]), alike, "{name}");
    }
    assert!(same(&["--normals", "visible"], &[]));
    assert!(!same(&["--normals", "distribution"], &[]));
    assert!(!same(&["--erratum", "ggx-g-sum"], &[]));
    assert!(same(&["--model", "phong", "--erratum", "ggx-g-sum"], &["--model", "phong"]));
}

#[test]
fn a_picture_that_is_wrong_on_purpose_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let [exr, stats] = ["a.exr", "a.json"].map(|name| at(&folder, name));
    let small = ["render", "-o", &exr, "--stats", &stats, "--size", "32x24", "--passes", "2"];
    let with = |more: &[&str]| {
        let output = run(&[&small[..], more].concat());
        assert_eq!(code(&output), 0, "{}", err(&output));
        (err(&output), json(&stats))
    };
    let (said, j) = with(&["--erratum", "double-direct", "--normals", "distribution"]);
    assert!(said.contains("wrong on purpose: double-direct: a light counts in full"), "{said}");
    let named = ["strategy", "normals", "erratum"].map(|name| j[name].as_str());
    assert_eq!(named, [Some("mis"), Some("distribution"), Some("double-direct")]);
    let (said, j) = with(&["--strategy", "bsdf"]);
    assert!(!said.contains("wrong"), "{said}");
    assert_eq!((j["strategy"].as_str(), j["erratum"].is_null()), (Some("bsdf"), true));
    let (said, _) = with(&["--model", "phong", "--erratum", "ggx-g-sum"]);
    assert!(said.contains("about GGX and has no effect on Phong"), "{said}");
    let help = must(&["render", "--help"]);
    for erratum in burnish::brdf::Erratum::ALL {
        assert!(help.contains(erratum.name()), "{} is not in the help", erratum.name());
    }
}

#[test]
fn a_time_ends_a_render_and_keeps_what_is_done() {
    let folder = tempfile::tempdir().unwrap();
    let [png, stats] = ["a.png", "a.json"].map(|name| at(&folder, name));
    // Without a plan every pass is a sample of every pixel. Cells of a plan have theirs rounded to pairs of
    // samples in either half of the replicates: four samples a pixel at most are ahead or behind.
    for (more, behind) in [(&["--uniform"][..], 0.0), (&[], 4.0)] {
        // A machine with much else to do may have no sample by then: in that case later.
        let (mut time, mut most) = (0.5, 0.0);
        loop {
            let text = time.to_string();
            // This clock runs before and after the other: no load makes a figure fail that is true.
            let limited = ["render", "-o", &png, "--stats", &stats, "--size", "64x48"];
            let start = std::time::Instant::now();
            let output = run(&[&limited[..], &["--time", &text], more].concat());
            most += start.elapsed().as_secs_f64();
            if code(&output) == 0 {
                break;
            }
            let told = err(&output);
            assert!(told.contains("before the first sample") && time < 500.0, "{told}");
            time *= 2.0;
        }
        let j = json(&stats);
        let (passes, seconds) = (j["passes"].as_f64().unwrap(), j["render_s"].as_f64().unwrap());
        assert!(passes >= 1.0, "{j}");
        assert!((0.6 * time..most).contains(&seconds), "{most} s, {j}");
        assert!(j["paths"].as_f64().unwrap() >= (passes - behind) * 64.0 * 48.0, "{j}");
        assert!(Path::new(&png).exists());
    }
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_a_render_early_and_writes_it() {
    let folder = tempfile::tempdir().unwrap();
    let [exr, stats, kept] = ["a.exr", "a.json", "kept.exr"].map(|name| at(&folder, name));
    let mut command = burnish();
    command.args(["render", "-v", "-o", &exr, "--stats", &stats, "--size", "64x48"]).args([
        "--passes",
        "1000000000",
        "--checkpoint",
        &kept,
        "--every",
        "0",
    ]);
    // Then every pixel has a sample. All passes would take days.
    let (mut child, lines) = until_told(command, "checkpoint:");
    signal(&child, "-INT");
    let told: Vec<_> = lines.collect();
    let status = child.wait().unwrap();
    assert_eq!(status.code(), Some(0), "{told:?}");
    assert!(told.iter().flatten().any(|line| line.contains("stopped by a signal")), "{told:?}");
    let passes = json(&stats)["passes"].as_u64().unwrap();
    assert!((1..1_000_000_000).contains(&passes), "{passes}");
    assert_eq!(burnish::picture::read_exr(exr.as_ref()).unwrap().width, 64);
}

#[test]
fn a_scene_that_gains_light_is_remarked_on() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, picture) = (at(&folder, "room.scn"), at(&folder, "room.png"));
    fs::write(&scene, "screen 8 6\nbrdf 1 1 1 0.04 0.04 0.04 198\nsphere 0 0 0 1\n").unwrap();
    let output = run(&["render", &scene, "-o", &picture, "--passes", "1"]);
    assert_eq!(code(&output), 0, "{}", err(&output));
    let said = err(&output);
    assert!(said.contains("reflects 1.071 of what arrives on average"), "{said}");
}

/// A part of a picture is what the whole shows there; its recipe knows it, and its command makes it again.
#[test]
fn a_crop_is_a_part_of_the_picture() {
    let folder = tempfile::tempdir().unwrap();
    let [whole, part, again] = ["whole.exr", "part.exr", "again.exr"].map(|name| at(&folder, name));
    let small = ["render", "--passes", "64", "--seed", "5"];
    must(&[&small[..], &["-o", &whole, "--size", "96x72"]].concat());
    let crop = ["--size", "48x36", "--crop", "0.25,0.375,0.5"];
    must(&[&small[..], &["-o", &part], &crop].concat());
    let [of_whole, of_part] =
        [&whole, &part].map(|file| burnish::picture::read_exr(file.as_ref()).unwrap());
    // The same pixels of the same size, by other samples.
    let (mut apart, mut mean) = (0.0, 0.0);
    for y in 0..36 {
        for x in 0..48 {
            let [a, b] = [of_whole.pixels[(27 + y) * 96 + 24 + x], of_part.pixels[y * 48 + x]];
            apart += f64::from((a[1] - b[1]).abs());
            mean += f64::from(a[1]);
        }
    }
    assert!(apart < 0.15 * mean, "{apart} of {mean}");
    let told = must(&["info", &part]);
    assert!(told.contains("crop       0.25,0.375,0.5"), "{told}");
    let line = told.lines().find_map(|line| line.strip_prefix("again      burnish ")).unwrap();
    let words: Vec<&str> = line
        .split(' ')
        .map(|word| if word.ends_with(".exr") { again.as_str() } else { word })
        .collect();
    must(&words);
    assert!(burnish::picture::read_exr(again.as_ref()).unwrap() == of_part);
    for bad in ["0.6,0,0.5", "0,0,0", "0,0", "a,b,c"] {
        let output = run(&["render", "-o", &part, "--crop", bad]);
        assert_eq!(code(&output), 2, "{bad}");
        assert!(err(&output).contains("--crop"), "{}", err(&output));
    }
}
