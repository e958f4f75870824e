//! Albedo by quadrature against tables, and what is told of it.

use burnish::brdf::{Model, Roughness};
use burnish::measure::check::quadrature::{QuadratureGrid, albedo, cosine_mean};
use burnish::measure::check::reference::ReferenceBrdf;
use burnish::measure::energy::{LobeEnergy, Remark, remarks};
use burnish::scene::Material;

/// Made in other variables at 3e-14, and checked against brute force and 2e7 samples.
const ALBEDO: &str = include_str!("../data/albedo.csv");
const MEANS: &str = include_str!("../data/albedo_avg.csv");

/// A row's model, parameter and the numbers after them.
fn rows(table: &str) -> impl Iterator<Item = (ReferenceBrdf, Vec<f64>)> {
    table.lines().skip(1).map(|line| {
        let mut cells = line.split(',');
        let model = cells.next().unwrap();
        let model = Model::ALL.into_iter().find(|m| m.name() == model).unwrap();
        let numbers: Vec<f64> = cells.map(|c| c.parse().unwrap()).collect();
        (ReferenceBrdf::new(model, roughness(model, numbers[0])), numbers)
    })
}

fn roughness(model: Model, parameter: f64) -> Roughness {
    match model {
        Model::Phong => Roughness::from_exponent(parameter).unwrap(),
        _ => Roughness::from_alpha(parameter).unwrap(),
    }
}

#[test]
fn quadrature_gives_the_table() {
    let mut worst = [0.0f64; 2];
    let mut checked = 0;
    for (i, (lobe, row)) in rows(ALBEDO).enumerate() {
        for (k, effort) in [QuadratureGrid::QUICK, QuadratureGrid::FINE].into_iter().enumerate() {
            // The slow one for a row in five.
            if k == 1 && i % 5 > 0 {
                continue;
            }
            let a = albedo(&lobe, row[1], effort);
            let off = (a.white - row[2]).abs().max((a.rim - row[3]).abs());
            worst[k] = worst[k].max(off);
            checked += 1;
        }
    }
    assert!(worst[0] < 2e-4 && worst[1] < 1e-9, "{worst:?}");
    assert!(checked > 800, "{checked}");
}

#[test]
fn cosine_means_are_the_table_s() {
    for (lobe, row) in rows(MEANS) {
        let mean = cosine_mean(16, |cos| albedo(&lobe, cos, QuadratureGrid::QUICK));
        let off = (mean.white - row[2]).abs().max((mean.rim - row[3]).abs());
        assert!(off < 2e-4, "{lobe:?}: {mean:?}");
    }
}

/// model, parameter, then largest over angle and cosine mean of the whole albedo with
/// Kd = 1 - Ks, for Ks of 0 (in the limit), 0.04, 0.5 and 1: made by the same tables' program.
#[allow(clippy::approx_constant)] // 1.0471 is an albedo
const WHOLE: [(Model, f64, [f64; 8]); 15] = [
    (Model::Ggx, 0.001, [1.950, 1.0476, 1.912, 1.0457, 1.470, 1.0238, 1.000, 1.0000]),
    (Model::Ggx, 0.01, [1.777, 1.0471, 1.743, 1.0452, 1.361, 1.0233, 1.000, 0.9995]),
    (Model::Ggx, 0.1, [1.347, 1.0337, 1.330, 1.0312, 1.138, 1.0026, 0.988, 0.9716]),
    (Model::Ggx, 0.3, [1.125, 1.0149, 1.115, 1.0080, 1.005, 0.9288, 0.884, 0.8428]),
    (Model::Ggx, 0.5, [1.063, 1.0075, 1.053, 0.9947, 0.939, 0.8484, 0.815, 0.6894]),
    (Model::Ggx, 1.0, [1.020, 1.0020, 1.003, 0.9770, 0.817, 0.6893, 0.614, 0.3766]),
    (Model::Beckmann, 0.001, [1.977, 1.0476, 1.938, 1.0457, 1.488, 1.0238, 1.000, 1.0000]),
    (Model::Beckmann, 0.1, [1.615, 1.0417, 1.589, 1.0398, 1.289, 1.0185, 1.000, 0.9953]),
    (Model::Beckmann, 0.5, [1.147, 1.0142, 1.139, 1.0093, 1.052, 0.9535, 0.957, 0.8929]),
    (Model::Beckmann, 1.0, [1.050, 1.0047, 1.045, 0.9907, 0.988, 0.8304, 0.925, 0.6562]),
    (Model::Phong, 1e6, [1.969, 1.0476, 1.930, 1.0457, 1.483, 1.0238, 1.000, 1.0000]),
    (Model::Phong, 100.0, [1.518, 1.0378, 1.496, 1.0359, 1.245, 1.0143, 1.000, 0.9908]),
    (Model::Phong, 10.0, [1.189, 1.0176, 1.183, 1.0138, 1.109, 0.9704, 1.028, 0.9231]),
    (Model::Phong, 2.0, [1.085, 1.0080, 1.089, 0.9986, 1.132, 0.8905, 1.179, 0.7730]),
    (Model::Phong, 0.0, [1.048, 1.0040, 1.060, 0.9869, 1.194, 0.7897, 1.341, 0.5754]),
];

#[test]
fn whole_albedos_are_those_of_the_table() {
    for (model, parameter, expected) in WHOLE {
        let lobe = LobeEnergy::of(model, roughness(model, parameter));
        for (ks, pair) in [1e-12, 0.04, 0.5, 1.0].into_iter().zip(expected.chunks(2)) {
            let got = lobe.reflected(1.0 - ks, ks);
            let case = format!("{model:?} {parameter} {ks}: {got:?}, not {pair:?}");
            // The table's largest comes from 1,000 angles, printed to three digits.
            assert!((got.most - pair[0]).abs() < 3.5e-3, "{case}");
            assert!((got.mean - pair[1]).abs() < 2e-4, "{case}");
        }
        assert!((lobe.loss() - (1.0 - expected[7])).abs() < 2e-4, "{model:?} {parameter}");
    }
}

#[test]
fn the_most_that_a_lobe_reflects_is_the_table_s() {
    for (lobe, row) in rows(MEANS) {
        let got = LobeEnergy::of(lobe.model, roughness(lobe.model, row[0])).most();
        assert!((got - row[4]).abs() < 4e-3, "{lobe:?}: {got}, not {}", row[4]);
    }
}

fn material(name: &str, kd: f64, ks: f64, alpha: f64) -> Material {
    let exponent = Roughness::from_alpha(alpha).unwrap().exponent();
    Material::reflecting(name, [kd, 0.1, 0.1], [ks, 0.0, 0.0], exponent).unwrap()
}

#[test]
fn a_material_is_named_when_light_would_grow_in_a_room_of_it() {
    let white = material("white lacquer", 1.0, 0.04, 0.1);
    let said = remarks(std::slice::from_ref(&white), Model::Ggx);
    // 1 + 0.04 E1 + 0.96 E5 with the table's E1 and E5 of GGX at 0.1: 1.0712 on average.
    let [Remark::Grows { reflected, .. }] = said.as_slice() else { panic!("{said:?}") };
    let mean = 1.0 + 0.04 * 0.971_559 + 0.96 * 0.033_733;
    assert!((reflected.mean - mean).abs() < 2e-4, "{reflected:?}, not {mean}");
    let words = said[0].to_string();
    for part in ["white lacquer", "1.071", "up to 1.37", "no finite answer", "alpha 0.1"] {
        assert!(words.contains(part), "no {part} in: {words}");
    }
    // The same paint darker is fine on average; many such share a line.
    let dark = [material("grey", 0.8, 0.04, 0.1), material("brighter grey", 0.9, 0.04, 0.1)];
    let said = remarks(&dark, Model::Ggx);
    let [Remark::AtGrazing { count: 2, name, .. }] = said.as_slice() else { panic!("{said:?}") };
    assert_eq!(name, "brighter grey");
    assert!(said[0].to_string().starts_with("2 materials reflect up to 1.27 (\"brighter grey\")"));
}

/// The bounds that keep a closed room finite at Ks = 0.04, from the same table: at the bound it is
/// silent on average, above it not.
#[test]
fn the_largest_diffuse_reflectance_of_a_closed_room() {
    for (model, alpha, most) in [
        (Model::Ggx, 0.1, 0.929),
        (Model::Ggx, 0.5, 0.965),
        (Model::Beckmann, 0.1, 0.920),
        (Model::Phong, 0.140_028, 0.924),
    ] {
        let grows = |kd| {
            let said = remarks(&[material("wall", kd, 0.04, alpha)], model);
            said.iter().any(|r| matches!(r, Remark::Grows { .. }))
        };
        assert!(!grows(most - 1e-3) && grows(most + 1e-3), "{model:?} {alpha}");
    }
}

#[test]
fn what_gains_nothing_is_not_remarked_on() {
    let gold = Material::reflecting("gold", [0.0; 3], [1.0, 0.77, 0.34], 200.0).unwrap();
    let matt = Material::reflecting("matt", [1.0; 3], [0.0; 3], 10.0).unwrap();
    let mirror = Material::reflecting("mirror", [0.0; 3], [1.0; 3], 2e8 - 2.0).unwrap();
    for model in Model::ALL {
        let materials = [gold.clone(), matt.clone(), mirror.clone()];
        assert_eq!(remarks(&materials, model), vec![], "{model:?}");
    }
}

#[test]
fn phongs_own_gain_is_named() {
    let said = remarks(&[material("rough", 0.0, 0.5, 0.534_522)], Model::Phong);
    let Some(Remark::Lobe { most, .. }) = said.last() else { panic!("{said:?}") };
    assert!((most - 1.0797).abs() < 4e-3, "{most}");
    assert!(said.last().unwrap().to_string().contains("(a_p 5)"), "{said:?}");
    // At an exponent where it has gone, as in other models, nothing is said of the lobe.
    for (model, alpha) in [(Model::Phong, 0.25), (Model::Beckmann, 0.53), (Model::Ggx, 0.53)] {
        let said = remarks(&[material("rough", 0.0, 0.5, alpha)], model);
        assert!(!said.iter().any(|r| matches!(r, Remark::Lobe { .. })), "{model:?}: {said:?}");
    }
}
