//! `brdf`: values and albedos of the formulas, row by row.

use super::*;

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
