//! Proofs of the sampler: its normals and directions against its own density, its mean weight
//! against the albedo.
//!
//! Normals are looked at in the unit square of `y = cos of the angle once stretched by alpha` and
//! the azimuth from the viewer's, in which every lobe is wide, however narrow it is on the surface.

use super::code::Code;
use super::formulas::{direction, grey, most};
use super::quadrature::{self, gauss, soft_points};
use super::reference::ReferenceBrdf;
use super::statistics::{Mean, Random, chi_square};
use super::{EFFECT, Proof, ProofWork};
use crate::brdf::{Alpha, BrdfParams, Formulas};
use crate::math::V3;
use crate::math::simd::U32;
use crate::math::sobol::{Slot, Stream, pair};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Independent randomisations of a low-discrepancy stream; their spread is the standard error.
pub const BATCHES: u32 = 16;

/// Viewers, by their cosine.
const COSINES: [f64; 7] = [1.0, 0.95, 0.5, 0.1, 1e-3, 1e-5, 1e-7];
/// Those for whom the whole weight is resolved in single precision.
const OPEN_COSINES: [f64; 4] = [1.0, 0.7, 0.3, 0.1];
/// The viewers' azimuth: none of the axes'.
const AZIMUTH: f64 = 0.7;

/// All of them.
pub(super) fn prove(work: &mut ProofWork) {
    let viewers: Vec<Viewer> = COSINES.map(|cos| Viewer::new(work, cos)).into();
    work.add(Proof::at_most(
        "samples against density",
        "largest distance of the normals' distribution function from the density's",
        most(viewers.iter().map(|v| v.distance)),
        1e-3,
    ));
    let says = "independent normals fall into 16 x 16 cells as the density says";
    work.add(Proof::by_chance(
        "samples, chi-square",
        says,
        least(viewers.iter().map(|v| v.chance)),
    ));
    work.add(Proof::at_most(
        "lost below the horizon",
        "share of samples seen and reflected upwards, against the density's integral",
        most(viewers.iter().map(|v| v.lost)),
        1e-3,
    ));
    if work.roughness.alpha >= 0.1 {
        let chance = least([0.999, 0.7, 0.3].map(|cos| directions(work, cos)));
        let says = "directions of both lobes fall into 24 x 32 cells as the density says";
        work.add(Proof::by_chance("directions, chi-square", says, chance));
    }
    albedo(work);
}

/// The normals that one viewer samples.
struct Viewer {
    distance: f64,
    chance: f64,
    lost: f64,
}

/// Cells in y and in the azimuth, and how many of each make a cell of chi-square.
const CELLS: [usize; 2] = [128, 64];
const COARSE: usize = 16;

impl Viewer {
    fn new(work: &mut ProofWork, cos: f64) -> Viewer {
        let (code, roughness) = (work.code, work.roughness);
        let wo = direction(cos, AZIMUTH);
        let cells = cells(&code, roughness, wo);
        // Evenly spread samples: their distribution function is known to 1e-4.
        let stream = if work.full { 1 << 20 } else { 1 << 17 };
        let mut found = vec![0.0; CELLS[0] * CELLS[1]];
        let (mut seen, mut up) = (0.0, 0.0);
        for pass in 0..stream {
            let u = pair(&Stream::new(1, U32(0), U32(0), pass), Slot::direction(0));
            let m = (code.sample_wm)(roughness, wo, u);
            let dot = wo.dot(m);
            if !m.length2().is_finite() || (m.length2() - 1.0).abs() > 1e-4 {
                work.strange += 1;
                continue;
            }
            found[cell_of(roughness, m)] += 1.0;
            seen += f64::from(u8::from(dot > 0.0));
            up += f64::from(u8::from(dot > 0.0 && 2.0 * dot * m.z - wo.z > 0.0));
        }
        let n = stream as f64;
        let [in_seen, in_up] = masses(&code, roughness, wo);
        let lost = (seen / n - in_seen).abs().max((up / n - in_up).abs());
        found.iter_mut().for_each(|f| *f /= n);
        let distance = distance(&found, &cells);

        let mut random = Random::new(2);
        let n = if work.full { 200_000 } else { 20_000 };
        let (mut observed, mut expected) = (vec![0.0; COARSE * COARSE], vec![0.0; COARSE * COARSE]);
        for _ in 0..n {
            let m = (code.sample_wm)(roughness, wo, random.pair());
            observed[coarse(cell_of(roughness, m))] += 1.0;
        }
        for (cell, share) in cells.iter().enumerate() {
            expected[coarse(cell)] += share * f64::from(n);
        }
        Viewer { distance, chance: chi_square(&observed, &expected), lost }
    }
}

fn coarse(cell: usize) -> usize {
    let (y, turn) = (cell / CELLS[1], cell % CELLS[1]);
    y * COARSE / CELLS[0] * COARSE + turn * COARSE / CELLS[1]
}

/// The cell of a normal.
fn cell_of(roughness: Alpha, m: V3) -> usize {
    let [x, y, z] = [m.x, m.y, m.z].map(f64::from);
    let stretched = f64::from(roughness.alpha) * z;
    let height = stretched / (x * x + y * y + stretched * stretched).sqrt();
    let turn = ((y.atan2(x) - AZIMUTH) / TAU).rem_euclid(1.0);
    let index = |share: f64, cells: usize| ((share * cells as f64) as usize).min(cells - 1);
    index(height, CELLS[0]) * CELLS[1] + index(turn, CELLS[1])
}

/// A normal of the square, and its solid angle per area of the square.
fn normal(roughness: Alpha, y: f64, turn: f64) -> (V3, f64) {
    let alpha = f64::from(roughness.alpha);
    let tan = alpha * (1.0 - y * y).max(0.0).sqrt() / y;
    let phi = AZIMUTH + TAU * turn;
    let cos = 1.0 / (1.0 + tan * tan).sqrt();
    let sin = tan * cos;
    let m = V3::new((sin * phi.cos()) as f32, (sin * phi.sin()) as f32, cos as f32);
    // dw = sin dtheta dphi, with tan dtan = alpha² dy / y³ and dtheta = cos² dtan.
    (m, TAU * cos.powi(3) * alpha * alpha / y.powi(3))
}

/// The density's share of every cell.
fn cells(code: &Code, roughness: Alpha, wo: V3) -> Vec<f64> {
    let points = gauss(2);
    let mut shares = vec![0.0; CELLS[0] * CELLS[1]];
    for (cell, share) in shares.iter_mut().enumerate() {
        for &[a, wa] in &points {
            for &[b, wb] in &points {
                let y = ((cell / CELLS[1]) as f64 + a) / CELLS[0] as f64;
                let turn = ((cell % CELLS[1]) as f64 + b) / CELLS[1] as f64;
                let (m, area) = normal(roughness, y, turn);
                *share += wa * wb * area * f64::from((code.normal_pdf)(roughness, wo, m));
            }
        }
        *share /= (CELLS[0] * CELLS[1]) as f64;
    }
    shares
}

/// The largest distance between the two distribution functions of y, and of the azimuth.
fn distance(found: &[f64], expected: &[f64]) -> f64 {
    let along = |step: &dyn Fn(usize) -> usize, bins: usize| {
        let mut difference = vec![0.0; bins];
        for (cell, (f, e)) in found.iter().zip(expected).enumerate() {
            difference[step(cell)] += f - e;
        }
        let mut sum = 0.0;
        most(difference.into_iter().map(|d| {
            sum += d;
            f64::abs(sum)
        }))
    };
    let y = along(&|cell| cell / CELLS[1], CELLS[0]);
    y.max(along(&|cell| cell % CELLS[1], CELLS[1]))
}

/// The density's integral over the normals that face the viewer, and over those of them that
/// reflect it upwards. Both end within a ring of normals, at azimuths that are known; panels of
/// rings end where a ring first meets the horizon, leaves it, or first faces away.
fn masses(code: &Code, roughness: Alpha, wo: V3) -> [f64; 2] {
    let (rings, around) = (soft_points(16), soft_points(12));
    let alpha = f64::from(roughness.alpha);
    let cos_o = f64::from(wo.z);
    let sin_o = f64::from(wo.x).hypot(f64::from(wo.y));
    let low = cos_o.atan2(sin_o);
    let mut edges = vec![0.0, 0.3, 0.6, 0.9, 1.0];
    edges.extend(
        [low / 2.0, low, FRAC_PI_2 - low / 2.0].map(|a| 1.0 / (a.tan() / alpha).hypot(1.0)),
    );
    edges.sort_by(f64::total_cmp);
    let (mut seen, mut up) = (0.0, 0.0);
    for panel in edges.windows(2) {
        let (start, wide) = (panel[0], panel[1] - panel[0]);
        for &[place, _, weight] in &rings {
            let y = start + wide * place;
            let tan = alpha * (1.0 - y * y).max(0.0).sqrt() / y;
            let cos = 1.0 / (1.0 + tan * tan).sqrt();
            let sin = tan * cos;
            let turn_to = |c: f64| if c.is_nan() { 0.0 } else { c.clamp(-1.0, 1.0).acos() / TAU };
            let horizon = turn_to((cos_o / (2.0 * cos) - cos_o * cos) / (sin_o * sin));
            let facing = turn_to(-cos_o * cos / (sin_o * sin)).max(horizon);
            for (from, to, reflects) in [(0.0, horizon, true), (horizon, facing, false)] {
                for &[x, _, w] in &around {
                    let turn = from + (to - from) * x;
                    let (m, area) = normal(roughness, y, turn);
                    let both_sides = 2.0 * (to - from) * w * weight * wide * area;
                    let mass = both_sides * f64::from((code.normal_pdf)(roughness, wo, m));
                    seen += mass;
                    up += if reflects { mass } else { 0.0 };
                }
            }
        }
    }
    [seen, up]
}

/// The chance of the directions that both lobes sample.
fn directions(work: &mut ProofWork, cos: f64) -> f64 {
    const RINGS: usize = 24;
    const SECTORS: usize = 32;
    const FINE: usize = 12;
    let (code, wo) = (work.code, direction(cos, AZIMUTH));
    let brdf = (code.formulas.at_wo)(&grey(0.5, 0.2, work.roughness), wo);
    let n: u32 = if work.full { 400_000 } else { 40_000 };
    let mut random = Random::new(3);
    let mut observed = vec![0.0; RINGS * SECTORS + 1];
    for _ in 0..n {
        let s = (code.formulas.sample)(&brdf, random.pair()[0], random.pair());
        let strange = !s.pdf.is_finite() || s.pdf < 0.0 || !s.f.is_finite() || s.f.r < 0.0;
        work.strange += u64::from(strange);
        let ring = (f64::from(s.wi.z) * RINGS as f64).max(0.0) as usize;
        let turn = (f64::from(s.wi.y).atan2(f64::from(s.wi.x)) / TAU).rem_euclid(1.0);
        let sector = (turn * SECTORS as f64) as usize;
        let cell = ring.min(RINGS - 1) * SECTORS + sector.min(SECTORS - 1);
        observed[if s.pdf > 0.0 { cell } else { RINGS * SECTORS }] += 1.0;
    }
    let mut expected = vec![0.0; RINGS * SECTORS + 1];
    let mut total = 0.0;
    for (cell, share) in expected[..RINGS * SECTORS].iter_mut().enumerate() {
        let (ring, sector) = ((cell / SECTORS) as f64, (cell % SECTORS) as f64);
        for i in 0..FINE * FINE {
            let place = |i: usize| (i as f64 + 0.5) / FINE as f64;
            let z = (ring + place(i / FINE)) / RINGS as f64;
            let phi = (sector + place(i % FINE)) / SECTORS as f64 * TAU;
            *share += f64::from((code.formulas.eval)(&brdf, direction(z, phi)).pdf);
        }
        *share *= TAU / (RINGS * SECTORS * FINE * FINE) as f64 * f64::from(n);
        total += *share;
    }
    // What is missing from the integral is what the samples lose.
    expected[RINGS * SECTORS] = (f64::from(n) - total).max(0.0);
    chi_square(&observed, &expected)
}

/// The mean weight of samples against the albedo by quadrature: of the lobe alone with F = 1, and
/// of a lacquer.
fn albedo(work: &mut ProofWork) {
    let lobe = ReferenceBrdf::of_width(work.subject.model, work.roughness);
    let per_batch = if work.full { 1 << 16 } else { 1 << 14 };
    let (mut off, mut chance) = (0.0f64, 1.0f64);
    for (row, cos) in OPEN_COSINES.into_iter().enumerate() {
        let exact = quadrature::albedo(&lobe, cos, quadrature::QuadratureGrid::FINE);
        for (kd, ks) in [(0.0, 1.0), (0.5, 0.04)] {
            let params = grey(kd, ks, work.roughness);
            let wo = direction(cos, AZIMUTH);
            let batches =
                sampled_albedo(&work.code.formulas, &params, wo, 7, row as u32, per_batch);
            work.strange += batches.iter().filter(|b| b.is_nan() || **b < 0.0).count() as u64;
            let mean = Mean::of(batches);
            let expected = exact.of(kd.into(), ks.into());
            // Of the mixture chance alone judges: how even it is depends on the choice of a lobe.
            if kd == 0.0 {
                off = most([off, (mean.mean - expected).abs()]);
            }
            // What is rarer than one sample in all shows in no spread: narrow lobes lose that.
            chance = least([chance, mean.chance(expected, 5e-5)]);
        }
    }
    let says = "mean weight of samples against the albedo by quadrature";
    work.add(Proof::at_most("albedo", says, off, EFFECT));
    work.add(Proof::by_chance("albedo, Student", says, chance));
}

/// The albedo of these lobes seen from `wo`, by their own sampler: the mean of `f cos / pdf` of
/// `per_batch` samples in each of 16 independent batches. `row` picks one of 2^16 independent
/// streams of a seed. What is rarer than one in all samples shows in neither mean nor spread.
pub fn sampled_albedo(
    formulas: &Formulas,
    params: &BrdfParams,
    wo: V3,
    seed: u64,
    row: u32,
    per_batch: u64,
) -> [f64; BATCHES as usize] {
    let brdf = (formulas.at_wo)(params, wo);
    std::array::from_fn(|batch| {
        let mut sum = 0.0;
        for pass in 0..per_batch {
            let stream = Stream::new(seed, U32(batch as u32), U32(row), pass);
            let [choice, _] = pair::<f32>(&stream, Slot::choice(0));
            let s = (formulas.sample)(&brdf, choice, pair::<f32>(&stream, Slot::direction(0)));
            if s.pdf > 0.0 {
                let cos = (formulas.cosine)(s.wi.z);
                sum += f64::from(s.f.r) * f64::from(cos) / f64::from(s.pdf);
            }
        }
        sum / per_batch as f64
    })
}

/// The smallest; not a number if any is not.
fn least(values: impl IntoIterator<Item = f64>) -> f64 {
    let lower = |least: f64, x: f64| if x < least || x.is_nan() { x } else { least };
    values.into_iter().fold(f64::INFINITY, lower)
}
