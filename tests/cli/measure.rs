//! `report`, `compare` and `check`: what is measured, on the command line.

use super::*;

/// Small and short: the table's form, and the one effect that no noise can hide.
#[test]
fn the_report_measures_every_erratum() {
    let small = ["--size", "40x30", "--passes", "8", "--repeats", "3"];
    let text = must(&[&["report", "errata"][..], &small].concat());
    for erratum in burnish::brdf::Erratum::ALL {
        assert!(text.lines().any(|l| l.starts_with(erratum.name())), "{text}");
    }
    let row = text.lines().find(|l| l.starts_with("double-direct")).unwrap();
    let change: f64 = row.split_whitespace().nth(2).unwrap().parse().unwrap();
    assert!(change > 20.0, "{row}");
    for other in ["--latency", "--model=ggx", "--csv=never-written.csv"] {
        assert_eq!(code(&run(&["report", "errata", other])), 2, "{other}");
    }
}

#[test]
fn latency_is_reported_with_what_it_leaves_out() {
    let text = must(&["report", "latency", "--size", "96x64", "--changes", "5"]);
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

#[test]
fn rays_of_every_kind_are_counted_and_timed() {
    let text = must(&["report", "rays", "cornell", "--count", "500", "--repeats", "2"]);
    for kind in ["camera", "bounce", "shadow"] {
        let row = text.lines().find(|l| l.starts_with(kind)).unwrap_or_else(|| panic!("{text}"));
        let cells: Vec<&str> = row.split_whitespace().collect();
        let number = |at: usize| cells[at].parse::<f64>().unwrap();
        assert!((1.0..=500.0).contains(&number(1)) && number(2) <= 100.0, "{row}");
        assert!(number(4) > 0.0 && number(6) > 0.0, "{row}");
    }
    assert!(text.contains("38 triangles") && text.contains("bytes a shape"), "{text}");
    for other in ["--latency", "--scaling", "--threads=1", "--passes=3"] {
        assert_eq!(code(&run(&["report", "rays", other])), 2, "{other}");
    }
}

#[test]
fn growth_is_reported_with_triangles_lights_pixels_and_threads() {
    let text = must(&["report", "scaling", "--largest", "1000", "--repeats", "1"]);
    for part in ["triangles", "lights", "pixels", "threads", "speed-up", "bytes", "power"] {
        assert!(text.contains(part), "{part} in {text}");
    }
    let fits = text.lines().filter(|l| l.starts_with("power ") && l.contains(" ns"));
    assert_eq!(fits.count(), 4, "{text}");
    for wrong in ["--largest=10", "--rays", "--size=10x10", "cornell"] {
        assert_eq!(code(&run(&["report", "scaling", wrong])), 2, "{wrong}");
    }
    assert_eq!(code(&run(&["report", "speed", "--largest", "5000"])), 2);
}

/// The number in a line of `burnish compare` that begins with this name.
fn compared(text: &str, name: &str) -> f64 {
    let line = text.lines().find(|l| l.starts_with(&format!("{name}  ")));
    let line = line.unwrap_or_else(|| panic!("no {name} in {text}"));
    line[name.len()..].split_whitespace().next().unwrap().parse().unwrap()
}

const COMPARED: [&str; 12] = [
    "MSE",
    "MSE of 99.9 %",
    "relMSE",
    "relMSE of 99.9 %",
    "relative RMSE",
    "scale-free MSE",
    "SMAPE",
    "mean error",
    "relative mean error",
    "changed pixels",
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
        "speed",
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
        must(&[&["report", "speed", &scene, "--model", "ggx"][..], &few, &given].concat());
        for row in table(&fs::read_to_string(&csv).unwrap()) {
            let found: f64 = row["rel_mse"].parse().unwrap();
            assert!((found - expected).abs() < 1e-6, "{given:?}: {found}, not {expected}");
        }
    }
    let output = run(&["report", "speed", &scene, "--size", "40x24", "--reference", &exr]);
    let text = err(&output);
    assert!(code(&output) == 1 && text.contains("--size 32x24"), "{text}");
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
fn the_profile_says_where_the_time_went() {
    let small = ["--size", "40x30", "--passes", "2"];
    let text = must(&[&["report", "profile", "cornell"][..], &small].concat());
    let row = |name: &str| {
        let line = text.lines().find(|l| l.starts_with(name)).unwrap_or_else(|| panic!("{text}"));
        let cells: Vec<&str> = line[name.len()..].split_whitespace().collect();
        cells[0].parse::<f64>().unwrap()
    };
    let stages =
        ["start", "trace", "shade", "shadow", "visibility", "gather", "grouping pixels"].map(row);
    assert!((stages.iter().sum::<f64>() - 100.0).abs() < 0.5, "{text}");
    assert!(row("nearest hit") > 1.0 && row("between points shared") > 1.0, "{text}");
    assert!(text.contains("lanes in use"), "{text}");
    for other in ["--latency", "--rays", "--threads=1"] {
        assert_eq!(code(&run(&["report", "profile", other])), 2, "{other}");
    }
}

/// A sample by itself is what the picture of one pass has there.
#[test]
fn a_pixel_is_replayed_with_its_group() {
    let home = tempfile::tempdir().unwrap();
    let file = home.path().join("one.exr");
    let options = ["--size", "40x30", "--seed", "5", "--group", "32"];
    let file_name = file.to_str().unwrap();
    let render = ["render", "cornell", "--passes", "1", "-o", file_name];
    must(&[&render[..], &options].concat());
    let picture = burnish::picture::read_exr(&file).unwrap();
    let text = must(&[&["pixel", "cornell", "21", "17", "0"][..], &options].concat());
    assert!(text.contains("groups of 32"), "{text}");
    let mut members = 0;
    for line in text.lines().skip(2) {
        let cells: Vec<f64> = line.split_whitespace().map_while(|c| c.parse().ok()).collect();
        let [x, y, light @ ..] = cells.as_slice() else { panic!("{line}") };
        let pixel = picture.pixels[*y as usize * 40 + *x as usize];
        for (shown, exact) in light.iter().zip(pixel) {
            assert!((shown - f64::from(exact)).abs() <= 1e-6 * f64::from(exact), "{line}");
        }
        members += 1;
    }
    assert!(members > 8 && text.contains("<- asked for"), "{text}");
    let apart = must(&["pixel", "cornell", "3", "4", "9", "--no-reuse"]);
    assert!(apart.contains("every path for itself") && apart.lines().count() == 3, "{apart}");
    let outside = run(&["pixel", "cornell", "512", "0", "0"]);
    assert_eq!(code(&outside), 1);
}

/// What was a flag says what it is now.
#[test]
fn old_flags_of_the_report_name_their_commands() {
    for kind in ["latency", "errata", "rays", "scaling", "profile"] {
        let output = run(&["report", &format!("--{kind}"), "cornell"]);
        let text = err(&output);
        assert_eq!(code(&output), 2, "{text}");
        assert!(text.contains(&format!("burnish report {kind}")), "{text}");
    }
}
