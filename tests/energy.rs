//! Albedo by quadrature against tables, and what is told of it.

use burnish::brdf::{Model, Roughness};
use burnish::measure::check::quadrature::{Effort, albedo, cosine_mean};
use burnish::measure::check::reference::Reference;

/// Made in other variables at 3e-14, and checked against brute force and 2e7 samples.
const ALBEDO: &str = include_str!("data/albedo.csv");
const MEANS: &str = include_str!("data/albedo_avg.csv");

/// A row's model, parameter and the numbers after them.
fn rows(table: &str) -> impl Iterator<Item = (Reference, Vec<f64>)> {
    table.lines().skip(1).map(|line| {
        let mut cells = line.split(',');
        let model = cells.next().unwrap();
        let model = Model::ALL.into_iter().find(|m| m.name() == model).unwrap();
        let numbers: Vec<f64> = cells.map(|c| c.parse().unwrap()).collect();
        (Reference::new(model, roughness(model, numbers[0])), numbers)
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
        for (k, effort) in [Effort::QUICK, Effort::FINE].into_iter().enumerate() {
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
        let mean = cosine_mean(16, |cos| albedo(&lobe, cos, Effort::QUICK));
        let off = (mean.white - row[2]).abs().max((mean.rim - row[3]).abs());
        assert!(off < 2e-4, "{lobe:?}: {mean:?}");
    }
}
