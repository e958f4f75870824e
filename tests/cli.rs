//! The command line, driven as a user or a script drives it: arguments in, files and codes out.

use burnish::math::lanes::Isa;
use image::GenericImageView;
use serde_json::Value;
use std::collections::HashMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

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

#[test]
fn every_help_has_an_example_that_names_its_subcommand() {
    for (args, example) in [
        (&["--help"][..], "burnish render table.scn -o table.png"),
        (&["render", "--help"], "burnish render table.scn -o table.exr"),
        (&["brdf", "--help"], "burnish brdf --eval"),
        (&["report", "--help"], "burnish report --latency"),
        (&["report", "--help"], "burnish report table.scn --plot"),
        (&["render", "--help"], "-o out/{name}-{model}.png"),
        (&["compare", "--help"], "burnish compare fast.exr"),
        (&["check", "--help"], "burnish check --model"),
        (&["completions", "--help"], "burnish completions fish"),
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
        &["report", "--model", "lambert"],
        &["report", "--strategy", "mis,"],
        &["report", "--exact", "-1"],
        &["report", "--exact", "1", "--reference-passes", "64"],
        &["report", "--latency", "--passes", "4"],
        &["report", "--changes", "4"],
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
        &["report", "--latency", &scene],
        &["report", &scene],
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

/// Small and short: the table's form, and the one effect that no noise can hide.
#[test]
fn the_report_measures_every_erratum() {
    let small = ["--size", "40x30", "--passes", "8", "--repeats", "3"];
    let text = must(&[&["report", "--errata"][..], &small].concat());
    for erratum in burnish::brdf::Erratum::ALL {
        assert!(text.lines().any(|l| l.starts_with(erratum.name())), "{text}");
    }
    let row = text.lines().find(|l| l.starts_with("double-direct")).unwrap();
    let change: f64 = row.split_whitespace().nth(2).unwrap().parse().unwrap();
    assert!(change > 20.0, "{row}");
    for other in ["--latency", "--model=ggx", "--csv=never-written.csv"] {
        assert_eq!(code(&run(&["report", "--errata", other])), 2, "{other}");
    }
}

#[test]
fn a_time_ends_a_render_and_keeps_what_is_done() {
    let folder = tempfile::tempdir().unwrap();
    let [png, stats] = ["a.png", "a.json"].map(|name| at(&folder, name));
    must(&["render", "-o", &png, "--stats", &stats, "--size", "64x48", "--time", "0.5"]);
    let j = json(&stats);
    let (passes, seconds) = (j["passes"].as_f64().unwrap(), j["render_s"].as_f64().unwrap());
    assert!(passes >= 1.0, "{j}");
    assert!((0.3..10.0).contains(&seconds), "{j}");
    assert!(j["paths"].as_f64().unwrap() >= passes * 64.0 * 48.0);
    assert!(Path::new(&png).exists());
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_a_render_early_and_writes_it() {
    use std::io::{BufRead, BufReader};
    use std::time::{Duration, Instant};
    let folder = tempfile::tempdir().unwrap();
    let [exr, stats] = ["a.exr", "a.json"].map(|name| at(&folder, name));
    let mut child = burnish()
        .args(["render", "-o", &exr, "--stats", &stats, "--size", "64x48"])
        .args(["--passes", "1000000000"])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_millis(1500));
    let start = Instant::now();
    let pid = child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &pid]).status().unwrap().success());
    let told: Vec<_> = BufReader::new(child.stderr.take().unwrap()).lines().collect();
    let status = child.wait().unwrap();
    assert_eq!(status.code(), Some(0), "{told:?}");
    assert!(start.elapsed() < Duration::from_secs(20));
    assert!(told.iter().flatten().any(|line| line.contains("stopped by Ctrl-C")), "{told:?}");
    let passes = json(&stats)["passes"].as_u64().unwrap();
    assert!((1..1_000_000_000).contains(&passes), "{passes}");
    assert_eq!(burnish::picture::read_exr(exr.as_ref()).unwrap().width, 64);
}

#[test]
fn latency_is_reported_with_what_it_leaves_out() {
    let text = must(&["report", "--latency", "--size", "96x64", "--changes", "5"]);
    for part in ["5 changes", "96x64", "p50", "p95", "max", "window system is not included"] {
        assert!(text.contains(part), "{part} in {text}");
    }
    let after = |name: &str| -> f64 {
        let rest = text.split_once(name).unwrap().1;
        rest.split_whitespace().next().unwrap().parse().unwrap()
    };
    let (p50, p95, max) = (after("p50"), after("p95"), after("max"));
    assert!(0.0 < p50 && p50 <= p95 && p95 <= max, "{text}");
}

/// The number in a line of `burnish compare` that begins with this name.
fn compared(text: &str, name: &str) -> f64 {
    let line = text.lines().find(|l| l.starts_with(&format!("{name}  ")));
    let line = line.unwrap_or_else(|| panic!("no {name} in {text}"));
    line[name.len()..].split_whitespace().next().unwrap().parse().unwrap()
}

const COMPARED: [&str; 11] = [
    "MSE",
    "MSE of 99.9 %",
    "relMSE",
    "relMSE of 99.9 %",
    "relative RMSE",
    "scale-free MSE",
    "SMAPE",
    "mean error",
    "relative mean error",
    "FLIP",
    "HDR-FLIP",
];

/// A picture of one grey, written as EXR.
fn grey(path: &str, size: [u32; 2], value: f32) {
    let mut picture = burnish::picture::Picture::black(size[0], size[1]);
    picture.pixels.fill([value; 3]);
    burnish::picture::write(path.as_ref(), &picture, Default::default()).unwrap();
}

#[test]
fn compared_with_itself_a_picture_has_no_error() {
    let folder = tempfile::tempdir().unwrap();
    let exr = at(&folder, "a.exr");
    must(&["render", "-o", &exr, "--size", "48x36", "--passes", "2"]);
    let text = must(&["compare", &exr, &exr]);
    for name in COMPARED {
        assert_eq!(compared(&text, name), 0.0, "{name} in {text}");
    }
}

#[test]
fn compared_greys_differ_by_what_they_should() {
    let folder = tempfile::tempdir().unwrap();
    let [a, b, difference, flip] = ["a.exr", "b.exr", "d.png", "f.png"].map(|n| at(&folder, n));
    grey(&a, [40, 30], 0.75);
    grey(&b, [40, 30], 0.5);
    let text = must(&["compare", &a, &b, "-o", &difference, "--flip", &flip, "--scale", "0.25"]);
    let near = |name: &str, expected: f64| {
        let found = compared(&text, name);
        assert!((found - expected).abs() <= 1e-4 * expected, "{name}: {found}, not {expected}");
    };
    near("MSE", 0.0625);
    near("MSE of 99.9 %", 0.0625);
    near("relMSE", 0.0625 / 0.26);
    near("relative RMSE", (0.0625f64 / 0.26).sqrt());
    near("scale-free MSE", 0.0625 / 0.2525);
    near("SMAPE", 0.25 / 1.26);
    near("mean error", 0.25);
    near("relative mean error", 0.5);
    assert!(text.contains("mean(((x - r)^2 - s^2) / (r^2 + 0.01))"), "{text}");
    assert!(text.contains("red +0.250") && text.contains("40x30"), "{text}");
    // Beyond the scale on the bright side: red all over. FLIP sees it too.
    let [r, g, b] = image::open(&difference).unwrap().to_rgb8().get_pixel(20, 15).0;
    assert!(r > 2 * g && r > 2 * b, "{r} {g} {b}");
    assert!(image::open(&flip).unwrap().to_rgb8().pixels().all(|p| p.0 != [0; 3]));
}

#[test]
fn what_cannot_be_compared_is_code_1_and_says_why() {
    let folder = tempfile::tempdir().unwrap();
    let [a, b, png, none] = ["a.exr", "b.exr", "c.png", "d.exr"].map(|n| at(&folder, n));
    grey(&a, [40, 30], 0.5);
    grey(&b, [30, 40], 0.5);
    must(&["render", "-o", &png, "--size", "40x30", "--passes", "1"]);
    for (args, parts) in [
        ([&a, &b], ["40x30", "30x40"]),
        ([&a, &png], ["c.png", "only OpenEXR"]),
        ([&none, &a], ["d.exr", "cannot be opened"]),
    ] {
        let output = run(&["compare", args[0], args[1]]);
        let text = err(&output);
        assert_eq!((code(&output), text.lines().count()), (1, 1), "{text}");
        assert!(parts.iter().all(|part| text.contains(part)), "{parts:?} in {text}");
    }
    let mut picture = burnish::picture::read_exr(a.as_ref()).unwrap();
    picture.pixels[7][1] = f32::NAN;
    burnish::picture::write(b.as_ref(), &picture, Default::default()).unwrap();
    let text = must(&["compare", &b, &a]);
    assert!(text.contains("left out: 1 pixels"), "{text}");
    assert_eq!(compared(&text, "MSE"), 0.0);
    assert!(text.lines().any(|l| l.starts_with("HDR-FLIP") && l.contains("no answer")), "{text}");
}

#[test]
fn speed_against_error_is_a_table_a_sheet_and_a_plot() {
    let folder = tempfile::tempdir().unwrap();
    let [csv, svg] = ["a.csv", "a.svg"].map(|name| at(&folder, name));
    let text = must(&[
        "report",
        "--size",
        "32x24",
        "--passes",
        "4",
        "--repeats",
        "2",
        "--model",
        "ggx,phong",
        "--normals",
        "all",
        "--seed",
        "3",
        "--csv",
        &csv,
        "--plot",
        &svg,
    ]);
    for part in [
        "32x24",
        "medians of 2 repeats",
        "64 passes with MIS",
        "Phong, BSDF only",
        "GGX, MIS, all normals",
        "mean(((x - r)^2 - s^2) / (r^2 + 0.01))",
        "1 / (relMSE seconds)",
        "HDR-FLIP",
        "+-",
    ] {
        assert!(text.contains(part), "{part} in {text}");
    }
    let rows = table(&fs::read_to_string(&csv).unwrap());
    // Two repeats of GGX by six ways and Phong by three, and both by the engine, at 1, 2 and 4 passes.
    assert_eq!(rows.len(), 2 * (9 + 2) * 3);
    let number = |row: &HashMap<String, String>, name: &str| -> f64 {
        row[name].parse().unwrap_or_else(|_| panic!("{name} in {row:?}"))
    };
    for rows in rows.chunks_exact(3) {
        let same = |name: &str| rows.iter().all(|row| row[name] == rows[0][name]);
        assert!(["model", "strategy", "normals", "tracer", "repeat", "seed"].into_iter().all(same));
        assert_eq!(number(&rows[0], "seed"), 3.0 + number(&rows[0], "repeat"));
        assert_eq!([0, 1, 2].map(|i| number(&rows[i], "passes")), [1.0, 2.0, 4.0]);
        for row in rows {
            assert_eq!((number(row, "width"), number(row, "height")), (32.0, 24.0));
            for name in ["seconds", "rays", "mse", "smape", "reference_noise", "threads"] {
                assert!(number(row, name) > 0.0, "{name} in {row:?}");
            }
            assert!(number(row, "mse_trimmed") < number(row, "mse"));
            let product = ["efficiency", "rel_mse", "seconds"].map(|name| number(row, name));
            assert!((product.iter().product::<f64>() - 1.0).abs() < 1e-9, "{row:?}");
        }
        assert!(number(&rows[2], "flip") > 0.0 && number(&rows[2], "hdr_flip") > 0.0);
        assert!(rows[0]["flip"].is_empty());
    }
    let svg = fs::read_to_string(&svg).unwrap();
    for part in ["<svg", "</svg>", "seconds of tracing", "relative RMSE in %", "Phong, light only"]
    {
        assert!(svg.contains(part), "{part}");
    }
}

/// Nothing but sky of radiance 1.
const SKY: &str = "screen 32 24\ncamera 0 0 0 1 x 0\nenvironment 1 1 1\n\
                   brdf 0.5 0.5 0.5  0 0 0  1\nsphere 0 0 50  1\n";

/// A given picture and an exact answer stand in for the rendered reference.
#[test]
fn a_report_takes_other_references() {
    let folder = tempfile::tempdir().unwrap();
    let [scene, exr, csv] = ["furnace.scn", "r.exr", "a.csv"].map(|name| at(&folder, name));
    fs::write(&scene, SKY).unwrap();
    grey(&exr, [32, 24], 0.5);
    let few = ["--size", "32x24", "--passes", "1", "--repeats", "1", "--csv", &csv];
    for (given, expected) in [
        (["--exact", "0.5"], 0.25 / 0.26),
        (["--reference", &exr], 0.25 / 0.26),
        (["--exact", "1"], 0.0),
        (["--reference-passes", "2"], 0.0),
    ] {
        must(&[&["report", &scene, "--model", "ggx"][..], &few, &given].concat());
        for row in table(&fs::read_to_string(&csv).unwrap()) {
            let found: f64 = row["rel_mse"].parse().unwrap();
            assert!((found - expected).abs() < 1e-6, "{given:?}: {found}, not {expected}");
        }
    }
    let output = run(&["report", &scene, "--size", "40x24", "--reference", &exr]);
    let text = err(&output);
    assert!(code(&output) == 1 && text.contains("--size 32x24"), "{text}");
}

const HEADER: &str = "Ks,model,ignored,param,wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,Kd";

#[test]
fn eval_gives_the_textbook_values_at_normal_incidence() {
    use std::f64::consts::PI;
    let folder = tempfile::tempdir().unwrap();
    let path = at(&folder, "rows.csv");
    let rows = "0.5,ggx,x,0.5,0,0,1,0,0,1,0.3\n\
                0.5,beckmann,x,0.5,0,0,1,0,0,1,0.3\n\
                0.5,phong,x,6,0,0,1,0,0,1,0.3\n\
                0,ggx,x,0.5,0,0,1,0,0,1,0.3\n\
                0.5,ggx,x,0.5,0,0,-1,0,0,1,0.3\n\
                0.5,ggx,x,9.999999747378752e-05,0,0,1,0,0,1,0.3\n";
    fs::write(&path, format!("{HEADER}\n{rows}")).unwrap();
    let rows = table(&must(&["brdf", "--eval", &path]));
    assert_eq!(rows.len(), 6);
    let near = |row: usize, name: &str, expected: f64| {
        let value: f64 = rows[row][name].parse().unwrap();
        let close = (value - expected).abs() <= 1e-5 * expected.abs();
        assert!(close, "row {row}, {name}: {value}, not {expected}");
    };
    // D of GGX and Beckmann at the normal is 1 / (pi alpha²), Phong's (a_p + 2) / (2 pi).
    for (row, d) in [(0, 4.0 / PI), (1, 4.0 / PI), (2, 4.0 / PI), (5, 1e8 / PI)] {
        near(row, "D", d);
        near(row, "G1i", 1.0);
        near(row, "G", 1.0);
        near(row, "F", 0.5);
        near(row, "spec", d / 8.0);
        near(row, "brdf", 0.3 / PI + d / 8.0);
        near(row, "fcos", 0.3 / PI + d / 8.0);
        near(row, "pdf_diffuse", 1.0 / PI);
        near(row, "pdf_spec", d / 4.0);
        near(row, "p_spec", 0.5 / 0.8);
        near(row, "pdf", 0.625 * d / 4.0 + 0.375 / PI);
    }
    near(3, "spec", 0.0);
    near(3, "brdf", 0.3 / PI);
    near(3, "pdf", 1.0 / PI);
    for name in ["brdf", "fcos", "pdf", "spec"] {
        near(4, name, 0.0);
    }
    assert_eq!(
        (rows[0]["model"].as_str(), rows[5]["param"].as_str()),
        ("ggx", "9.999999747378752e-05")
    );
}

#[test]
fn eval_names_file_line_and_column_of_what_is_wrong() {
    let folder = tempfile::tempdir().unwrap();
    let path = at(&folder, "rows.csv");
    let good = "0.5,ggx,x,0.5,0,0,1,0,0,1,0.3";
    for (text, parts) in [
        (format!("{HEADER}\n{good}\n\n0.5,ggx,x,0.5,0,zero,1,0,0,1,0.3\n"), [":4:", "wi_y"]),
        (format!("{HEADER}\r\n{good}\r\n0.5,ggx,x,0.5,0,0,1,0,0,1,1.5"), [":3:", "Kd"]),
        (format!("{HEADER}\n0.5,ward,x,0.5,0,0,1,0,0,1,0.3\n"), [":2:", "model"]),
        (format!("{HEADER}\n0.5,ggx,x,5,0,0,1,0,0,1,0.3\n"), [":2:", "param"]),
        (format!("{HEADER}\n0.5,ggx,x,0.5,0,0,1,0,0,2,0.3\n"), [":2:", "wo_x, wo_y, wo_z"]),
        (format!("{HEADER}\n0.5,ggx,x,0.5,0,0,1,0,0,nan,0.3\n"), [":2:", "wo_z"]),
        (format!("{HEADER}\n{good}\n0.5,ggx\n"), [":3:", "expected 11 columns"]),
        ("model,param\n".into(), [":1:", "wi_x"]),
        (String::new(), [":1:", "model"]),
    ] {
        fs::write(&path, &text).unwrap();
        let output = run(&["brdf", "--eval", &path]);
        assert_eq!(code(&output), 1, "{text}");
        for part in ["rows.csv"].iter().chain(&parts) {
            assert!(err(&output).contains(part), "{part} in {} for {text}", err(&output));
        }
    }
    let output = run(&["brdf", "--eval", &at(&folder, "none.csv")]);
    assert!(code(&output) == 1 && err(&output).contains("none.csv"), "{}", err(&output));
}

#[test]
fn albedo_of_a_lambertian_is_kd_and_its_error_is_honest() {
    let args = |more: &[&str]| must(&[&["brdf", "--albedo"][..], more].concat());
    let rows = table(&args(&["--kd", "0.6", "--ks", "0", "--samples", "1024"]));
    assert!(rows.len() > 300, "{}", rows.len());
    for row in &rows {
        let albedo: f64 = row["albedo"].parse().unwrap();
        assert!((albedo - 0.6).abs() < 1e-6, "{row:?}");
    }
    // At alpha 1 D is constant, and GGX seen from the normal sends back the integral of
    // cos / (1 + cos) over 0..1, which is 1 - ln 2: the rest is lost to shadowing.
    let rows = table(&args(&["--samples", "4096", "--seed", "7"]));
    let row = rows.iter().find(|r| r["model"] == "ggx" && r["param"] == "1").unwrap();
    let [albedo, error] =
        ["albedo", "standard_error"].map(|name| row[name].parse::<f64>().unwrap());
    assert!(error > 0.0 && error < 0.01, "{row:?}");
    // 15 degrees of freedom: chance goes beyond 6 standard errors once in forty thousand.
    assert!((albedo - (1.0 - 2f64.ln())).abs() < 6.0 * error, "{row:?}");
}

#[cfg(unix)]
#[test]
fn a_reader_of_stdout_that_leaves_is_no_error_to_talk_about() {
    let mut child = burnish()
        .args(["brdf", "--albedo"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert!(output.stderr.is_empty(), "{}", err(&output));
    assert!(output.status.code().is_some(), "not killed, not panicked");
}

#[test]
fn check_prints_a_table_and_fails_with_a_proof() {
    let right = must(&["check", "--model", "beckmann", "--alpha", "0.3"]);
    assert!(right.starts_with("Beckmann at alpha 0.3"), "{right}");
    assert!(right.lines().filter(|l| l.contains(" holds ")).count() >= 22, "{right}");
    // 1 - 0.0410, from the table of means.
    assert!(right.contains("keeps 95.9 %") && !right.contains("FAILS"), "{right}");

    // Of the model that the mistake is about, without being told which.
    let wrong = run(&["check", "--erratum", "ggx-g-sum"]);
    assert_eq!(code(&wrong), 1);
    assert!(err(&wrong).contains("proofs fail"), "{}", err(&wrong));
    let table = out(&wrong);
    let limits = table.lines().find(|l| l.contains("limits of G")).unwrap();
    assert!(table.starts_with("GGX at alpha 0.1") && limits.contains("FAILS"), "{table}");
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
