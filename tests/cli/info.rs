//! Recipes from the command line: what `burnish render` writes beside its pixels, what
//! `burnish info` says about it, and that a recipe makes the same picture again.

use burnish::picture::{Picture, Tone, read_exr, read_recipe, write};
use burnish::progressive::{Params, Recipe, render};
use burnish::scene::builtin::{EXAMPLES, Example, default_scene};
use burnish::scene::presets::PRESETS;
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::sync::Arc;
use tempfile::TempDir;

fn run(folder: &TempDir, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_burnish"));
    command.current_dir(folder.path()).stdin(Stdio::null()).args(args).output().unwrap()
}

fn must(folder: &TempDir, args: &[&str]) -> String {
    let output = run(folder, args);
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{args:?}: {error}");
    String::from_utf8(output.stdout).unwrap()
}

/// What must fail with code 1, in one line.
fn must_not(folder: &TempDir, args: &[&str]) -> String {
    let output = run(folder, args);
    assert_eq!(output.status.code(), Some(1), "{args:?}");
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(error.trim_end().lines().count(), 1, "{error}");
    error
}

fn recipe(path: &Path) -> Recipe {
    Recipe::parse(&read_recipe(path).unwrap().unwrap()).unwrap()
}

/// The words of a command that `burnish info` prints, as a shell splits them.
fn shell_words(line: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    for (i, part) in line.split('\'').enumerate() {
        if i % 2 == 1 {
            words.last_mut().unwrap().push_str(part);
            continue;
        }
        for (j, piece) in part.split(' ').enumerate() {
            if j > 0 {
                words.push(String::new());
            }
            words.last_mut().unwrap().push_str(piece);
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

const SCENE: &str = "# Two balls\nscreen 40 30\ncamera 0 -6 1 0.3 x 80\n\
    light 9 8 7\nsphere 2 -2 3 0.5\n# Red\nbrdf 0.6 0.1 0.1 0.2 0.2 0.2 50\nsphere -1 0 0 1\n\
    # Blue\nbrdf 0.1 0.1 0.6 0.1 0.1 0.1 9\nsphere 1 0 0 1\nenvironment 0.1 0.2 0.3\n";

#[test]
fn the_command_in_a_recipe_makes_the_same_picture_again() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("two balls.scn"), SCENE).unwrap();
    for more in [
        &["two balls.scn", "--passes", "5"][..],
        &[
            "two balls.scn",
            "--passes",
            "4",
            "--alpha",
            "0.3",
            "--model",
            "beckmann",
            "--seed",
            "18446744073709551615",
        ],
        &[
            "two balls.scn",
            "--passes",
            "4",
            "--exponent",
            "200",
            "--model",
            "phong",
            "--max-depth",
            "2",
        ],
        &[
            "two balls.scn",
            "--passes",
            "4",
            "--camera",
            "1 -7 2 0.31 z 9 x 78",
            "--size",
            "31x17",
            "--normals",
            "distribution",
        ],
        &[
            "plates",
            "--passes",
            "2",
            "--size",
            "24x18",
            "--strategy",
            "bsdf",
            "--erratum",
            "below-horizon",
        ],
    ] {
        let mut args = [&["render"], more, &["-o", "first.exr", "-o", "first.png"]].concat();
        args.extend(["--exposure", "-1.5", "--tone", "filmic"]);
        must(&folder, &args);
        for kind in ["exr", "png"] {
            let first = format!("first.{kind}");
            let text = must(&folder, &["info", &first]);
            let again = text.lines().find_map(|line| line.strip_prefix("again ")).unwrap();
            let words = shell_words(again);
            assert_eq!(words[0], "burnish", "{again}");
            must(&folder, &words[1..].iter().map(String::as_str).collect::<Vec<_>>());
            let [a, b] = [first, format!("again.{kind}")]
                .map(|name| fs::read(folder.path().join(name)).unwrap());
            assert!(a == b, "{more:?} {kind}: {again}");
        }
    }
}

/// With the arguments of a picture's recipe, whichever file it is from, `burnish pixel` finds what
/// the picture has, to the digits that it prints.
#[test]
fn the_arguments_in_a_recipe_replay_its_pixels() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("two balls.scn"), SCENE).unwrap();
    for options in [
        "--model beckmann --alpha 0.3 --seed 18446744073709551615",
        "--model phong --exponent 200 --max-depth 3 --group 64 --size 31x17",
        "--normals distribution --exponent 3 --seed 4",
        "--strategy light --no-reuse",
        "--strategy bsdf --erratum below-horizon --size 20x30",
        "--erratum phong-exponent --group 32",
        "--reference --seed 7",
        "--isa portable",
    ] {
        let more: Vec<&str> =
            options.split(' ').chain(["--camera", "1 -7 2 0.31 z 9 x 78"]).collect();
        let render = ["render", "two balls.scn", "--passes", "1", "-o", "one.exr", "-o", "one.png"];
        must(&folder, &[&render[..], &["--exposure", "-1.5", "--tone", "filmic"], &more].concat());
        let picture = read_exr(&folder.path().join("one.exr")).unwrap();
        for kind in ["exr", "png"] {
            let text = must(&folder, &["info", &format!("one.{kind}")]);
            let again = text.lines().find_map(|line| line.strip_prefix("again ")).unwrap();
            let words = shell_words(again);
            assert_eq!(
                words[..5],
                ["burnish", "render", "two balls.scn", "-o", &format!("again.{kind}")]
            );
            let arguments: Vec<&str> = words[5..].iter().map(String::as_str).collect();
            for [x, y] in [[0, 0], [13, 11], [8, 16]] {
                let place = [x, y].map(|place: usize| place.to_string());
                let pixel = ["pixel", "two balls.scn", &place[0], &place[1], "0"];
                let text = must(&folder, &[&pixel[..], &arguments].concat());
                let line = text.lines().find(|line| line.ends_with("<- asked for")).unwrap();
                let cells: Vec<f64> =
                    line.split_whitespace().map_while(|c| c.parse().ok()).collect();
                assert_eq!(cells[..2], [x as f64, y as f64], "{line}");
                let exact = picture.pixels[y * picture.width as usize + x].map(f64::from);
                for (shown, exact) in cells[2..5].iter().zip(exact) {
                    assert!(
                        (shown - exact).abs() <= 5e-7 * exact,
                        "{options}: {line}, not {exact}"
                    );
                }
            }
        }
    }
    let beyond = ["pixel", "two balls.scn", "0", "0", "1", "--passes", "1"];
    let output = run(&folder, &beyond);
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(2) && error.contains("no pass 1 of 1"), "{error}");
}

#[test]
fn edited_materials_come_back_by_way_of_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("a.scn"), SCENE).unwrap();
    let scene = Arc::new(burnish::scene::read::open(&at("a.scn")).unwrap().0.build());
    let mut params = Params::new(scene);
    let materials = Arc::make_mut(&mut params.materials);
    materials[0].emission = [1.0, 20.0, 0.3];
    materials[2].kd = [0.123, 0.7, 0.0];
    materials[2].roughness = burnish::brdf::Roughness::from_alpha(0.05).unwrap();
    params.size = [33, 21];
    let snapshot = render(params.clone(), 3, 0).unwrap();
    let written = Recipe::new(&params, &snapshot);
    written.save(&at("edited.exr"), &snapshot.mean(), Tone::default()).unwrap();
    assert_eq!(recipe(&at("edited.exr")), written);

    let text = must(&folder, &["info", "edited.exr"]);
    for part in ["2 edited", "Blue (line 10): Kd 0.123 0.7 0", "emits 1 20 0.3", "a.scn  "] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let again = text.lines().find_map(|line| line.strip_prefix("again ")).unwrap().trim();
    let (first, second) = again.split_once("; ").unwrap();
    assert_eq!(first, "burnish info edited.exr --scene > edited.scn");
    fs::write(at("edited.scn"), must(&folder, &["info", "edited.exr", "--scene"])).unwrap();
    let words = shell_words(second);
    must(&folder, &words[1..].iter().map(String::as_str).collect::<Vec<_>>());
    assert_eq!(read_exr(&at("again.exr")).unwrap(), snapshot.mean());
}

#[test]
fn a_recipe_names_scene_models_error_and_tone() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["render", "-o", "a.png", "-o", "a.exr", "--size", "32x24", "--passes", "16"];
    must(&folder, &[&args[..], &["--exposure", "0.5", "--tone", "reinhard"]].concat());
    let json: Value = serde_json::from_str(&must(&folder, &["info", "a.png", "--json"])).unwrap();
    assert_eq!((&json["recipe"], &json["passes"]), (&Value::from(1), &Value::from(16)));
    assert_eq!(json["paths"], 32 * 24 * 16);
    assert_eq!(
        (&json["tone"]["exposure"], &json["tone"]["curve"]),
        (&Value::from(0.5), &Value::from("reinhard"))
    );
    assert_eq!(json["scene"]["example"], "default");
    let files = json["scene"]["files"].as_array().unwrap();
    let source = default_scene().unwrap().0.source;
    assert_eq!(files.len(), 3);
    for (file, known) in files.iter().zip(&source.files) {
        assert_eq!(file["name"], known.name.as_str());
        assert_eq!(file["sha256"], known.sha256.as_str());
    }
    assert_eq!(json["scene"]["text"].as_str(), source.text.as_deref());
    let [value, low, high] =
        ["relative", "low", "high"].map(|k| json["error"][k].as_f64().unwrap());
    assert!(0.0 < low && low < value && value < high);

    let text = must(&folder, &["info", "a.png"]);
    for part in
        ["Brass knot", "knot.ply", "16 (12288 paths", "reinhard, exposure 0.5 EV", "% relative"]
    {
        assert!(text.contains(part), "{part}: {text}");
    }
    // Nothing of the screen is in what is for measuring.
    let exr: Value = serde_json::from_str(&must(&folder, &["info", "a.exr", "--json"])).unwrap();
    assert!(exr["tone"].is_null());
    let png = Recipe { tone: None, ..recipe(&folder.path().join("a.png")) };
    assert_eq!(png, recipe(&folder.path().join("a.exr")));
}

#[test]
fn a_time_that_ends_within_a_pass_is_said_to() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["render", "--size", "2000x1500", "--time", "0.2", "-o", "a.png"];
    // A machine so slow or so fast that a pass ends on time says nothing here.
    if run(&folder, &args).status.success() {
        let whole = recipe(&folder.path().join("a.png")).is_whole();
        let text = must(&folder, &["info", "a.png"]);
        assert_eq!(text.contains("ended within a pass"), !whole, "{text}");
    }
}

#[test]
fn what_has_no_recipe_is_code_1_and_says_why() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    write(&at("bare.png"), &Picture::black(4, 4), Tone::default()).unwrap();
    fs::write(at("broken.exr"), "no picture").unwrap();
    let newer = format!("{{\"recipe\": {}}}", Recipe::VERSION + 1);
    for (name, text) in [("newer.png", newer.as_str()), ("odd.exr", "{}"), ("odd.png", "tea")] {
        let black = Picture::black(4, 4);
        burnish::picture::write_with_recipe(&at(name), &black, Tone::default(), text).unwrap();
    }
    for (name, says) in [
        ("bare.png", "no recipe"),
        ("broken.exr", "only .png and .exr files have recipes"),
        ("newer.png", "newer"),
        ("odd.exr", "cannot be read"),
        ("odd.png", "cannot be read"),
        ("missing.png", "cannot be opened"),
        ("missing.scn", "missing.scn"),
        ("picture.jpg", "only .scn, .obj and .ply"),
        ("nonsense", "must end in"),
    ] {
        let error = must_not(&folder, &["info", name]);
        assert!(error.contains(name) && error.contains(says), "{name}: {error}");
    }
    // What it cannot understand it can still hand out.
    assert_eq!(must(&folder, &["info", "newer.png", "--json"]).trim(), newer);
    fs::write(at("a.scn"), SCENE).unwrap();
    assert!(must_not(&folder, &["info", "a.scn", "--scene"]).contains("--scene is about pictures"));
}

/// Kind: text of a picture that steers the terminal, in each of the ways that it can be shown.
#[test]
fn no_control_character_of_a_picture_reaches_the_terminal() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.scn"), SCENE).unwrap();
    must(&folder, &["render", "a.scn", "--passes", "1", "--size", "8x6", "-o", "a.png"]);
    let good = read_recipe(&folder.path().join("a.png")).unwrap().unwrap();
    let evil = "x\\u001b[31m\\u0007\\n\\u009b5m\u{202e}\u{9b}evil";
    let write = |name: &str, text: &str| {
        let (path, black) = (folder.path().join(name), Picture::black(4, 4));
        burnish::picture::write_with_recipe(&path, &black, Tone::default(), text).unwrap();
    };
    write("good.png", &good);
    let lines = must(&folder, &["info", "good.png"]).lines().count();
    for (from, to) in [
        ("\"a.scn\"", format!("\"{evil}\"")),
        ("# Two balls", format!("# {evil}")),
        ("\"isa\":", format!("\"{evil}\": 1, \"isa\":")),
        ("{", "\u{1b}]0;title\u{7}{".to_owned()),
        ("\"recipe\": 1", format!("\"recipe\": \"{evil}\"")),
    ] {
        let text = good.replacen(from, &to, 1);
        assert_ne!(text, good, "{from}");
        for kind in ["png", "exr"] {
            let name = format!("evil.{kind}");
            write(&name, &text);
            for option in [&[][..], &["--json"], &["--scene"]] {
                let output = run(&folder, &[&["info", &name], option].concat());
                for stream in [&output.stdout, &output.stderr] {
                    let shown = String::from_utf8(stream.clone()).unwrap();
                    let odd = |c: char| c.is_control() && c != '\n' || c == '\u{202e}';
                    assert!(!shown.contains(odd), "{from} {option:?}: {shown:?}");
                }
                // What has no line ends of its own gets none: no line can be made up.
                let told = String::from_utf8_lossy(&output.stdout).lines().count();
                assert!(!option.is_empty() || told == 0 || told == lines, "{from}: {told}");
            }
        }
    }
    // JSON stays the same JSON.
    let text = good.replacen("\"a.scn\"", &format!("\"{evil}\""), 1);
    write("evil.png", &text);
    let shown: Value =
        serde_json::from_str(&must(&folder, &["info", "evil.png", "--json"])).unwrap();
    assert_eq!(shown, serde_json::from_str::<Value>(&text).unwrap());
}

/// Kind: a picture of another program. What it has is listed, in the one line of the error.
#[test]
fn a_picture_without_a_recipe_says_what_it_has() {
    use exr::prelude::*;
    let folder = tempfile::tempdir().unwrap();
    let layer = |name: &str| {
        let sample = |_: Vec2<usize>| (1.0f32, 2.0f32, 3.0f32);
        let size = Vec2(5, 3);
        let name = LayerAttributes::named(name);
        Layer::new(size, name, Encoding::FAST_LOSSLESS, SpecificChannels::rgb(sample))
    };
    let image = Image::empty(ImageAttributes::new(IntegerBounds::from_dimensions((5, 3))));
    let path = folder.path().join("a.exr");
    image.with_layer(layer("left")).with_layer(layer("right")).write().to_file(&path).unwrap();
    let error = must_not(&folder, &["info", "a.exr"]);
    assert!(error.contains("no recipe"), "{error}");
    assert!(error.contains("5x3 pixels, part `left` (B, G, R), part `right` (B, G, R)"), "{error}");
    let error = must_not(&folder, &["info", "a.exr", "--part", "middle"]);
    assert!(error.contains("no part") && error.contains("part `left` (B, G, R)"), "{error}");
    write(&folder.path().join("b.png"), &Picture::black(7, 2), Tone::default()).unwrap();
    assert!(must_not(&folder, &["info", "b.png"]).contains("7x2 pixels"));
    fs::write(folder.path().join("a.scn"), SCENE).unwrap();
    let error = must_not(&folder, &["info", "a.scn", "--part", "left"]);
    assert!(error.contains("--part is about pictures"), "{error}");

    // Compare tells which it takes.
    let output =
        run(&folder, &["compare", "a.exr", "a.exr", "--part", "right", "--reference-part", "left"]);
    let told = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success() && !told.contains("chooses"), "{told}");
    assert!(told.contains("`right` is read") && told.contains("`left` is read"), "{told}");
    let output = run(&folder, &["compare", "a.exr", "a.exr"]);
    let told = String::from_utf8(output.stderr).unwrap();
    assert!(
        told.contains("`left` is read") && told.contains("--part NAME chooses another"),
        "{told}"
    );
    let error = must_not(&folder, &["compare", "a.exr", "a.exr", "--part", "middle"]);
    assert!(error.contains("part `left` (B, G, R), part `right` (B, G, R)"), "{error}");
}

#[test]
fn a_scene_is_described() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.scn"), SCENE.to_owned() + "cube 1 2 3\n").unwrap();
    let text = must(&folder, &["info", "a.scn"]);
    for part in [
        "0 triangles, 3 spheres, 0 cylinders",
        "40x30 pixels",
        "Red: Kd 0.6 0.1 0.1  Ks 0.2 0.2 0.2  a_p 50",
        "emits 9 8 7",
        "0.1 0.2 0.3 W/(m\u{b2} sr)",
        "a.scn:13: unknown command `cube`",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let json: Value = serde_json::from_str(&must(&folder, &["info", "a.scn", "--json"])).unwrap();
    assert_eq!((&json["spheres"], &json["materials"][1]["line"]), (&3.into(), &7.into()));
    assert_eq!(json["warnings"].as_array().unwrap().len(), 1);
    let shipped = must(&folder, &["info", "cornell"]);
    assert!(shipped.contains("Cornell box") && shipped.contains("cornell-lamp.ply"), "{shipped}");
}

#[test]
fn the_help_has_an_example_of_each_use() {
    let folder = tempfile::tempdir().unwrap();
    let help = must(&folder, &["info", "--help"]);
    for example in ["table.png", "table.exr --json", "table.png --scene > new.scn", "cornell"] {
        assert!(help.contains(&format!("burnish info {example} ")), "{example}: {help}");
    }
}

/// A file-size limit stands in for the full disk: writing fails on the way, in the system, after
/// the first kilobytes. The old files stay and nothing is left beside them.
#[cfg(unix)]
#[test]
fn a_disk_that_fills_up_costs_no_file() {
    let folder = tempfile::tempdir().unwrap();
    for kind in ["png", "exr"] {
        let name = format!("old.{kind}");
        fs::write(folder.path().join(&name), "old").unwrap();
        // Without the trap the signal ends the program instead of failing its write.
        let script = format!(
            "trap '' XFSZ; ulimit -f 8; exec {} render cornell --size 200x150 --passes 1 -o {name}",
            env!("CARGO_BIN_EXE_burnish")
        );
        let mut shell = Command::new("sh");
        let output = shell.current_dir(folder.path()).args(["-c", &script]).output().unwrap();
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{error}");
        let last = error.trim_end().lines().last().unwrap();
        assert!(last.contains(&name) && last.contains("could not be written"), "{error}");
        assert!(last.contains("untouched") && !last.contains(".part"), "{error}");
        assert_eq!(fs::read(folder.path().join(&name)).unwrap(), b"old");
    }
    let mut names: Vec<_> = fs::read_dir(folder.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    assert_eq!(names, ["old.exr", "old.png"]);
}

#[test]
fn presets_are_listed_with_their_sources() {
    let folder = tempfile::tempdir().unwrap();
    let text = must(&folder, &["info", "--presets"]);
    assert_eq!(text.lines().count(), PRESETS.len());
    for (line, preset) in text.lines().zip(&PRESETS) {
        assert!(line.starts_with(preset.name) && line.ends_with(preset.source), "{line}");
        for number in preset.ks.iter().chain([&preset.alpha]) {
            assert!(line.split_whitespace().any(|word| word == number.to_string()), "{line}");
        }
    }
}

#[test]
fn captions_of_shipped_scenes_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let help = must(&folder, &["--help"]);
    for example in &EXAMPLES {
        let caption = example.caption().unwrap();
        let listed = |l: &str| l.trim_start().starts_with(example.name) && l.ends_with(caption);
        assert!(help.lines().any(listed), "{}: {help}", example.name);
    }
    let text = must(&folder, &["info", "plates"]);
    assert!(text.contains(Example::named("plates").unwrap().caption().unwrap()), "{text}");
}

/// A model's axis is in the recipe, and the command that makes the picture again gives it.
#[test]
fn the_axis_of_a_model_is_in_its_recipe() {
    let folder = tempfile::tempdir().unwrap();
    let model = "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nv 0 0 2\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    fs::write(folder.path().join("m.obj"), model).unwrap();
    let small = ["--size", "24x18", "--passes", "2"];
    for (up, told) in [(&["--up", "-x"][..], "-x"), (&["--up=y"], "y"), (&[], "z")] {
        let render = [&["render", "m.obj", "-o", "a.exr"][..], &small, up].concat();
        must(&folder, &render);
        let recipe = recipe(&folder.path().join("a.exr"));
        assert_eq!(recipe.scene.up.as_deref(), Some(told));
        let again: Vec<String> = recipe.arguments();
        let at = again.iter().position(|word| word == "--up").unwrap();
        assert_eq!(again[at + 1], told);
        let words = ["render", "m.obj", "-o", "b.exr"].map(str::to_owned);
        let words: Vec<String> = words.into_iter().chain(again).collect();
        must(&folder, &words.iter().map(String::as_str).collect::<Vec<_>>());
        let [a, b] = ["a.exr", "b.exr"].map(|n| read_exr(&folder.path().join(n)).unwrap());
        assert_eq!(a, b, "{told}");
        let text = must(&folder, &[&["info", "m.obj"][..], up].concat());
        assert!(text.lines().any(|l| l.starts_with("up ") && l.contains(told)), "{text}");
    }
}
