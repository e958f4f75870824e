//! `burnish sheet`: a labelled picture and the radiance of its cells.

use super::{at, burnish, code, err, must, run};
#[cfg(unix)]
use super::{signal, until_told};
use burnish::picture::{read_exr, read_exr_part, read_recipe_of};
use burnish::progressive::Recipe;
use image::GenericImageView;
use std::fs;
use std::path::Path;

const SCENE: &str = "screen 48 36
camera 0 -6 0 0.4 x 90
environment 0.2 0.2 0.2
# ball
brdf 0.5 0.1 0.1 0.2 0.2 0.2 50
sphere 0 0 0 1
# wall
brdf 0.5 0.5 0.5 0 0 0 1
sphere 0 9 0 6
light 9 9 9
sphere 0 -3 5 1
";

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(at(&folder, "ball.scn"), SCENE).unwrap();
    folder
}

const SMALL: [&str; 6] = ["--model", "beckmann,ggx", "--alpha", "0.1,0.4", "--error", "10%"];

/// Both files are there; each cell is named, says how it was made, and is what `render` makes of that.
#[test]
fn a_sheet_is_a_labelled_picture_and_its_cells() {
    let folder = folder();
    let [scene, png, exr] = ["ball.scn", "sheet.png", "sheet.exr"].map(|name| at(&folder, name));
    let output = run(&[&["sheet", &scene, "-o", &png][..], &SMALL].concat());
    let told = err(&output);
    assert_eq!(code(&output), 0, "{told}");
    assert!(told.contains("3 of 4: GGX, alpha 0.1") && told.contains("relative error"), "{told}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 3);

    let seen = image::open(&png).unwrap();
    let (width, height) = seen.dimensions();
    assert!(width > 2 * 48 && height > 2 * 36, "{width}x{height}");
    // Its ground is one grey to the corners; there are letters and pictures on it.
    let ground = seen.get_pixel(0, 0);
    assert!(ground.0[0] == ground.0[1] && ground.0[1] == ground.0[2]);
    assert_eq!(seen.get_pixel(width - 1, height - 1), ground);
    let other = seen.pixels().filter(|(_, _, pixel)| *pixel != ground).count();
    assert!(other > 4 * 48 * 36 + 500, "{other} pixels");

    for (model, alpha, name) in [
        ("beckmann", "0.1", "beckmann_alpha_0p1"),
        ("beckmann", "0.4", "beckmann_alpha_0p4"),
        ("ggx", "0.1", "ggx_alpha_0p1"),
        ("ggx", "0.4", "ggx_alpha_0p4"),
    ] {
        let cell = read_exr_part(Path::new(&exr), Some(name)).unwrap().picture;
        let recipe = read_recipe_of(Path::new(&exr), Some(name)).unwrap().unwrap().text;
        let recipe = Recipe::parse(&recipe).unwrap();
        let error = recipe.error.as_ref().unwrap();
        assert!(error.high.unwrap() <= 0.1 && error.relative <= 0.1, "{name}: {error:?}");
        let (alone, passes) = (at(&folder, "alone.exr"), recipe.passes.to_string());
        must(&[
            "render", "-q", &scene, "-o", &alone, "--model", model, "--alpha", alpha, "--passes",
            &passes,
        ]);
        assert!(read_exr(Path::new(&alone)).unwrap() == cell, "{name}");
    }
    // The other commands read it.
    let same = ["compare", &exr, &exr, "--part", "ggx_alpha_0p1", "--reference-part"];
    let told = must(&[&same[..], &["beckmann_alpha_0p1"]].concat());
    assert!(told.contains("changed pixels"), "{told}");
    let told = must(&["info", &exr, "--part", "ggx_alpha_0p4"]);
    assert!(told.contains("--model ggx") && told.contains("alpha 0.4"), "{told}");
    let output = run(&["info", &png]);
    assert!(code(&output) == 1 && err(&output).contains("contact sheet"), "{}", err(&output));
}

#[test]
fn one_material_alone_by_exponents_and_named_by_either_file() {
    let folder = folder();
    let [scene, exr] = ["ball.scn", "s.exr"].map(|name| at(&folder, name));
    let rest = ["--model", "ggx", "--exponent", "98,10", "--material", "Ball", "--size", "20x15"];
    must(&[&["sheet", "-q", &scene, "-o", &exr, "--max-passes", "4"][..], &rest].concat());
    assert!(Path::new(&at(&folder, "s.png")).exists());
    let cell = read_exr_part(Path::new(&exr), Some("ggx_ap_98")).unwrap();
    assert_eq!((cell.picture.width, cell.choices), (20, 2));
    let recipe = read_recipe_of(Path::new(&exr), Some("ggx_ap_98")).unwrap().unwrap();
    let recipe = Recipe::parse(&recipe.text).unwrap();
    assert_eq!(recipe.passes, 4, "no more than it may");
    let edited: Vec<_> = recipe.materials.iter().map(|m| (m.index, m.exponent)).collect();
    assert_eq!(edited, [(0, 98.0)]);
}

#[test]
fn what_cannot_be_done_is_told_and_writes_nothing() {
    let folder = folder();
    let before = fs::read_dir(folder.path()).unwrap().count();
    let [scene, png] = ["ball.scn", "sheet.png"].map(|name| at(&folder, name));
    for (args, expected, named) in [
        (&["--exposure", "31"][..], 2, "-30 to 30"),
        (&["--alpha", "0.1,2"], 2, "0.0001 to 1"),
        (&["--alpha", "0.1", "--exponent", "9"], 2, "cannot be used with"),
        (&["--model", "lambert"], 2, "phong, beckmann, ggx"),
        (&["--error", "0"], 2, "--error"),
        (&["--max-passes", "0"], 2, "--max-passes"),
        (&["--size", "9"], 2, "WIDTHxHEIGHT"),
        (&["--material", "gold"], 1, "it has ball, "),
        (&["--material", "wall"], 1, "no specular lobe"),
        (&["--size", "32768x2"], 1, "32768 a side"),
    ] {
        let output = run(&[&["sheet", &scene, "-o", &png][..], args].concat());
        assert_eq!(code(&output), expected, "{args:?}: {}", err(&output));
        assert!(err(&output).contains(named), "{args:?}: {}", err(&output));
    }
    assert_eq!(code(&run(&["sheet", &scene])), 2, "without a name for it");
    let output = run(&["sheet", &scene, "-o", "sheet.jpg"]);
    assert!(code(&output) == 2 && err(&output).contains(".exr"), "{}", err(&output));
    let missing = at(&folder, "missing/sheet.png");
    let output = run(&["sheet", &scene, "-o", &missing]);
    assert!(code(&output) == 1 && err(&output).contains("missing"), "{}", err(&output));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), before);
    let output = run(&["sheet", &at(&folder, "none.scn"), "-o", &png]);
    assert!(code(&output) == 1 && err(&output).contains("none.scn"), "{}", err(&output));
    let broken = at(&folder, "broken.scn");
    fs::write(&broken, "screen 64 48\nsphere 0 0 0 banana\n").unwrap();
    let output = run(&["sheet", &broken, "-o", &png]);
    assert!(code(&output) == 1 && err(&output).contains("broken.scn:2"), "{}", err(&output));
    assert!(!Path::new(&png).exists());
}

/// The second file is as little written over what is read as the first.
#[cfg(unix)]
#[test]
fn a_sheet_is_not_written_over_what_it_reads() {
    let folder = folder();
    std::os::unix::fs::symlink(at(&folder, "ball.scn"), at(&folder, "sheet.exr")).unwrap();
    let output = run(&["sheet", &at(&folder, "ball.scn"), "-o", &at(&folder, "sheet.png")]);
    assert_eq!(code(&output), 1);
    assert!(err(&output).contains("would be written over"), "{}", err(&output));
    assert_eq!(fs::read_to_string(at(&folder, "ball.scn")).unwrap(), SCENE);
    assert!(!Path::new(&at(&folder, "sheet.png")).exists());
}

/// What is done when it is stopped is written, and the rest is told.
#[cfg(unix)]
#[test]
fn an_early_end_writes_what_is_done() {
    let folder = folder();
    let [scene, png] = ["ball.scn", "sheet.png"].map(|name| at(&folder, name));
    // Its error is out of reach in the time of this test.
    let mut command = burnish();
    command
        .args(["sheet", "-v", &scene, "-o", &png, "--error", "0.0001%"])
        .args(["--max-passes", "4294967296"])
        .args(["--alpha", "0.1,0.4", "--model", "ggx", "--size", "48x36"]);
    let (mut child, lines) = until_told(command, "every pixel has a sample");
    signal(&child, "-INT");
    let rest = lines.map(|line| line.unwrap()).collect::<Vec<_>>().join("\n");
    assert_eq!(child.wait().unwrap().code(), Some(1), "{rest}");
    assert!(rest.contains("2 of 2 pictures are not done"), "{rest}");
    let exr = at(&folder, "sheet.exr");
    let cell = read_exr_part(Path::new(&exr), Some("ggx_alpha_0p1")).unwrap();
    assert_eq!(cell.choices, 1, "the other was not begun");
    assert!(image::open(&png).is_ok());
}
