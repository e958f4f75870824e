//! Error measures against numbers worked out by hand, against plain loops, and against noise whose
//! size is known; the experiment of speed against error on scenes whose answer is known.

use crate::support::Random;
use burnish::brdf::{Model, Normals, Roughness};
use burnish::measure::difference::PictureDifference;
use burnish::measure::error::{self, Measure, Pair, PairError, Reference, mean_margin};
use burnish::measure::flip::Flip;
use burnish::measure::plot::{Dot, Panel, PlotCurve, log_log};
use burnish::measure::speed::{Fit, SpeedExperiment, SpeedPlan, Spread, Truth, Variant};
use burnish::picture::{Picture, Tone};
use burnish::progressive::{Params, Strategy};
use burnish::scene::{Material, SceneBuilder};
use burnish::trace::ReuseGroup;
use glam::DVec3;
use std::sync::Arc;

fn picture(width: u32, pixels: Vec<[f32; 3]>) -> Picture {
    Picture { width, height: pixels.len() as u32 / width, pixels }
}

fn value(measure: Measure, x: &Picture, r: &Reference) -> f64 {
    measure.of(&Pair::new(x, r).unwrap())
}

/// Uniform in `[-1, 1)` with variance 1/3.
fn noise(random: &mut Random) -> f32 {
    random.within(-1.0, 1.0) as f32
}

/// A picture of random radiance with some dark and some very bright pixels.
fn lively(random: &mut Random, width: u32, height: u32) -> Picture {
    let mut channel = || {
        let u = random.unit();
        if u < 0.1 { 0.0 } else { (8.0 * u * u * u).exp() * 0.01 }
    };
    let pixels = (0..width * height).map(|_| [channel(), channel(), channel()]).collect();
    Picture { width, height, pixels }
}

#[test]
fn two_pixels_by_hand() {
    let x = picture(2, vec![[0.5, 1.0, 0.0], [2.0, 0.2, 0.0]]);
    let r = Reference::known(picture(2, vec![[0.4, 1.0, 0.0], [1.0, 0.3, 0.0]]));
    // Differences 0.1, 0, 0, 1, -0.1, 0.
    let close = |measure, expected: f64| {
        let found = value(measure, &x, &r);
        assert!((found - expected).abs() < 1e-7, "{}: {found}, not {expected}", measure.name);
    };
    let rel_mse = (0.01 / 0.17 + 1.0 / 1.01 + 0.01 / 0.10) / 6.0;
    close(error::MSE, 1.02 / 6.0);
    close(error::REL_MSE, rel_mse);
    close(error::REL_RMSE, rel_mse.sqrt());
    close(error::SMAPE, (0.1 / 0.91 + 1.0 / 3.01 + 0.1 / 0.51) / 6.0);
    close(error::MEAN_ERROR, 1.0 / 6.0);
    close(error::REL_MEAN_ERROR, 1.0 / 2.7);
    close(error::REFERENCE_NOISE, 0.0);
    let floor = 0.01 * (2.7f64 / 6.0).powi(2);
    let scale_free = 0.01 / (0.16 + floor) + 1.0 / (1.0 + floor) + 0.01 / (0.09 + floor);
    close(error::SCALE_FREE, scale_free / 6.0);
    // Of two pixels the worse one is left out.
    close(error::MSE_TRIMMED, 0.01 / 3.0);
    close(error::REL_MSE_TRIMMED, 0.01 / 0.17 / 3.0);
}

#[test]
fn the_formulas_are_those_of_plain_loops() {
    let mut random = Random::new(1);
    let x = lively(&mut random, 61, 47);
    let r = lively(&mut random, 61, 47);
    let s = lively(&mut random, 61, 47);
    let reference = Reference { picture: r.clone(), standard_error: Some(s.clone()) };
    let n = 61.0 * 47.0;
    let mut sums = [0.0; 6];
    let mut of_pixels = Vec::new();
    for i in 0..x.pixels.len() {
        let mut pixel = 0.0;
        for c in 0..3 {
            let [x, r, s] = [&x, &r, &s].map(|p| f64::from(p.pixels[i][c]));
            let squared = (x - r) * (x - r) - s * s;
            sums[0] += squared;
            sums[1] += squared / (r * r + 0.01);
            sums[2] += (x - r).abs() / (x.abs() + r.abs() + 0.01);
            sums[3] += x - r;
            sums[4] += r;
            sums[5] += s * s / (r * r + 0.01);
            pixel += squared / (r * r + 0.01) / 3.0;
        }
        of_pixels.push(pixel);
    }
    of_pixels.sort_by(f64::total_cmp);
    // 2,867 pixels: three are 0.1 % of them, rounded up.
    let trimmed = of_pixels[..2864].iter().sum::<f64>() / 2864.0;
    let [mse, rel_mse, smape, mean_error, mean, own] = sums.map(|sum| sum / (3.0 * n));
    for (measure, expected) in [
        (error::MSE, mse),
        (error::REL_MSE, rel_mse),
        (error::REL_MSE_TRIMMED, trimmed),
        (error::SMAPE, smape),
        (error::MEAN_ERROR, mean_error),
        (error::REL_MEAN_ERROR, mean_error / mean),
        (error::REFERENCE_NOISE, own),
    ] {
        let found = value(measure, &x, &reference);
        let close = (found - expected).abs() <= 1e-9 * expected.abs();
        assert!(close, "{}: {found}, not {expected}", measure.name);
    }
}

#[test]
fn equal_pictures_have_no_error_and_names_are_distinct() {
    let x = lively(&mut Random::new(2), 40, 30);
    let r = Reference::known(x.clone());
    let pair = Pair::new(&x, &r).unwrap();
    for measure in error::ALL {
        assert_eq!(measure.of(&pair), 0.0, "{}", measure.name);
        let same = |m: &&Measure| m.column == measure.column || m.formula == measure.formula;
        assert_eq!(error::ALL.iter().filter(same).count(), 1, "{}", measure.name);
    }
    assert_eq!(pair.mean_error_margin(), Some(0.0));
    assert_eq!(Flip::tone_mapped(&pair, Tone::default()).unwrap().mean(), 0.0);
    assert_eq!(Flip::hdr(&pair).unwrap().mean(), 0.0);
    let white = PictureDifference::new(&pair).false_colour(1.0);
    assert!(white.pixels.iter().all(|p| *p == [1.0; 3]));
}

/// relMSE depends on the unit of radiance, the scale-free form does not.
#[test]
fn the_scale_free_form_is_free_of_scale() {
    let mut random = Random::new(3);
    let (x, r) = (lively(&mut random, 30, 30), lively(&mut random, 30, 30));
    let scaled = |p: &Picture, by: f32| {
        let pixels = p.pixels.iter().map(|c| c.map(|v| v * by)).collect();
        Picture { pixels, ..*p }
    };
    let both = |measure, by| value(measure, &scaled(&x, by), &Reference::known(scaled(&r, by)));
    let ratio = |measure| both(measure, 1024.0) / both(measure, 1.0);
    assert!((ratio(error::SCALE_FREE) - 1.0).abs() < 1e-6, "{}", ratio(error::SCALE_FREE));
    assert!(ratio(error::REL_MSE) > 2.0, "{}", ratio(error::REL_MSE));
}

#[test]
fn pictures_that_cannot_be_compared_say_why() {
    let black = |w, h| Picture::black(w, h);
    let new = |x: &Picture, r: &Reference| Pair::new(x, r).map(|_| ()).unwrap_err();
    let text = new(&black(4, 3), &Reference::known(black(3, 4))).to_string();
    assert!(text.contains("4x3") && text.contains("3x4"), "{text}");
    let odd = Reference { picture: black(4, 3), standard_error: Some(black(4, 4)) };
    assert!(matches!(new(&black(4, 3), &odd), PairError::Size { .. }));
    let short = Picture { pixels: vec![[0.0; 3]; 5], ..black(2, 3) };
    assert!(matches!(new(&short, &Reference::known(black(2, 3))), PairError::Pixels { .. }));
    let nan = Reference::known(picture(2, vec![[f32::NAN, 0.0, 0.0]; 4]));
    assert_eq!(new(&black(2, 2), &nan), PairError::Nothing);
    assert_eq!(new(&black(0, 0), &Reference::known(black(0, 0))), PairError::Nothing);
}

#[test]
fn pixels_that_are_not_finite_are_left_out_and_counted() {
    let mut random = Random::new(4);
    let (mut x, mut r) = (lively(&mut random, 20, 20), lively(&mut random, 20, 20));
    let without = {
        let rest = |p: &Picture| picture(1, p.pixels[3..].to_vec());
        (rest(&x), Reference::known(rest(&r)))
    };
    x.pixels[0][1] = f32::NAN;
    x.pixels[1][2] = f32::INFINITY;
    r.pixels[2][0] = f32::NEG_INFINITY;
    let r = Reference::known(r);
    let pair = Pair::new(&x, &r).unwrap();
    assert_eq!(pair.left_out(), 3);
    for measure in error::ALL {
        let (all, rest) = (measure.of(&pair), value(measure, &without.0, &without.1));
        assert!((all - rest).abs() <= 1e-12 * rest.abs(), "{}", measure.name);
    }
    // What a person sees has an answer, the radiance has not.
    assert!(Flip::tone_mapped(&pair, Tone::default()).unwrap().mean() > 0.0);
    assert!(Flip::hdr(&pair).unwrap_err().contains("nonfinite"));
    assert_eq!(PictureDifference::new(&pair).false_colour(1.0).pixels[0], [1.0, 0.0, 1.0]);
}

/// A picture and a reference with independent noise: what is found is the picture's alone, within
/// four standard errors of the mean of so many squares; without the subtraction it would be twice
/// as much.
#[test]
fn the_references_noise_is_not_the_pictures() {
    let mut random = Random::new(5);
    let truth = lively(&mut random, 128, 96);
    let sigma = |t: f32| 0.2 * (t * t + 0.01).sqrt();
    let mut noisy = || {
        let mut p = truth.clone();
        for c in p.pixels.iter_mut().flatten() {
            *c += sigma(*c) * 3f32.sqrt() * noise(&mut random);
        }
        p
    };
    let (x, r) = (noisy(), noisy());
    let errors = truth.pixels.iter().map(|p| p.map(sigma)).collect();
    let known = Reference { picture: r.clone(), standard_error: Some(picture(128, errors)) };
    let exact = Reference::known(truth.clone());
    let [against_truth, against_noisy] = [&exact, &known].map(|r| value(error::REL_MSE, &x, r));
    assert!((against_truth - 0.04).abs() < 0.001, "{against_truth}");
    // The noisy r in the denominator alone makes a little difference: 1 + 3 sigma² of its mean.
    let raw = value(error::REL_MSE, &x, &Reference::known(r));
    assert!((against_noisy / 0.04 - 1.0).abs() < 0.2, "{against_noisy}");
    assert!(raw > 0.07, "{raw}");
}

#[test]
fn the_margin_of_the_mean_is_students() {
    // t(0.975, 4 degrees) = 2.776445; s = sqrt(2.5), n = 5.
    let margin = mean_margin(&[1.0, 2.0, 3.0, 4.0, 5.0]).unwrap();
    assert!((margin - 2.776_445 * 0.5f64.sqrt()).abs() < 1e-5, "{margin}");
    assert_eq!((mean_margin(&[1.0]), mean_margin(&[])), (None, None));
}

/// Of 400 pictures that are right on average, how many have 0 within the margin of their mean
/// error: 95 % of them, within four binomial standard deviations (4.4 %). One that is wrong by a
/// tenth never has.
#[test]
fn the_margin_of_a_right_picture_covers_zero_as_often_as_it_says() {
    let mut random = Random::new(6);
    let truth = lively(&mut random, 32, 24);
    let exact = Reference::known(truth.clone());
    let mut covered = [0, 0];
    for _ in 0..400 {
        let mut x = truth.clone();
        for pixel in &mut x.pixels {
            // The channels of a pixel err alike, as those of a path do.
            let e = noise(&mut random);
            *pixel = pixel.map(|c| c + 0.3 * c * e);
        }
        for (share, covered) in [0.0f32, 0.1].into_iter().zip(&mut covered) {
            let mut wrong = x.clone();
            wrong.pixels.iter_mut().flatten().for_each(|c| *c *= 1.0 + share);
            let pair = Pair::new(&wrong, &exact).unwrap();
            let inside = error::MEAN_ERROR.of(&pair).abs() <= pair.mean_error_margin().unwrap();
            *covered += u32::from(inside);
        }
    }
    assert!((362..=397).contains(&covered[0]), "{covered:?} of 400");
    assert_eq!(covered[1], 0);
}

#[test]
fn flip_sees_what_the_tone_curve_leaves() {
    let mut x = picture(48, vec![[0.5; 3]; 48 * 32]);
    let r = Reference::known(x.clone());
    let seen = |x: &Picture| {
        let pair = Pair::new(x, &r).unwrap();
        let tone = Flip::tone_mapped(&pair, Tone::default()).unwrap().mean();
        (tone, Flip::hdr(&pair).unwrap().mean())
    };
    x.pixels[40 * 16] = [0.55; 3];
    let slight = seen(&x);
    x.pixels[40 * 16] = [5.0; 3];
    let bright = seen(&x);
    x.pixels[40 * 16] = [500.0; 3];
    let brighter = seen(&x);
    assert!(0.0 < slight.0 && slight.0 < bright.0, "{slight:?} {bright:?}");
    // Beyond 1 the 8-bit picture is white, however bright; exposures tell them apart.
    assert_eq!(bright.0, brighter.0);
    assert!(slight.1 < bright.1 && bright.1 <= brighter.1, "{bright:?} {brighter:?}");
    // White against black is as far apart as FLIP goes.
    let (white, black) = ([1.0; 3], [0.0; 3]);
    let r = Reference::known(picture(48, vec![black; 48 * 32]));
    let x = picture(48, vec![white; 48 * 32]);
    let pair = Pair::new(&x, &r).unwrap();
    let map = Flip::tone_mapped(&pair, Tone::default()).unwrap();
    assert!(map.mean() > 0.95 && map.mean() <= 1.0, "{}", map.mean());
    // The palette's pale yellow, and no answer about the exposures of a black picture.
    let [red, green, blue] = map.false_colour().unwrap().pixels[0];
    assert!(red > green && green > blue && blue > 0.3, "{red} {green} {blue}");
    assert!(Flip::hdr(&pair).unwrap_err().contains("black"));
}

#[test]
fn the_difference_is_red_where_too_bright_and_full_at_its_scale() {
    let r = Reference::known(picture(4, vec![[1.0; 3]; 4]));
    let root = 1.01f32.sqrt();
    let x =
        picture(4, [1.0, 1.0 + root, 1.0 - 0.5 * root, 1.0 + 9.0 * root].map(|v| [v; 3]).into());
    let difference = PictureDifference::new(&Pair::new(&x, &r).unwrap());
    assert!((difference.scale() - 9.0).abs() < 1e-5, "{}", difference.scale());
    let colours = difference.false_colour(1.0).pixels;
    assert_eq!(colours[0], [1.0; 3]);
    assert!(colours[1][0] > 2.0 * colours[1][2], "red: {:?}", colours[1]);
    assert!(colours[2][2] > colours[2][0], "blue: {:?}", colours[2]);
    let close = colours[1].iter().zip(&colours[3]).all(|(a, b)| (a - b).abs() < 1e-5);
    assert!(close, "beyond the scale nothing gets redder: {colours:?}");
    assert!(colours[2].iter().zip(&colours[1]).all(|(half, full)| half >= full || half > &0.5));
}

#[test]
fn a_fitted_slope_is_the_least_squares_one() {
    // By hand: slope 0.7, residuals 0.2, -0.5, 0.8, -0.9, 0.4; their squares sum to 1.9.
    let fit = Fit::line([[0.0, 1.2], [1.0, 1.2], [2.0, 3.2], [3.0, 2.2], [4.0, 4.2]]).unwrap();
    assert!((fit.slope - 0.7).abs() < 1e-12, "{fit:?}");
    assert!((fit.standard_error - (1.9f64 / 3.0 / 10.0).sqrt()).abs() < 1e-12, "{fit:?}");
    // Points on a line, one of which cannot be drawn.
    let fit = Fit::line([[1.0, 3.0], [2.0, 2.5], [5.0, f64::NAN], [3.0, 2.0]]).unwrap();
    assert!((fit.slope + 0.5).abs() < 1e-12 && fit.standard_error < 1e-12, "{fit:?}");
    assert!(Fit::line([[1.0, 3.0], [2.0, 2.5]]).unwrap().standard_error.is_nan());
    assert_eq!(Fit::line([[1.0, 3.0], [1.0, 2.0]]), None);
    assert_eq!(Fit::line([]), None);
}

/// 300 noisy lines: their fitted slopes spread as wide as their standard errors say.
#[test]
fn a_fitted_slopes_error_is_its_spread() {
    let mut random = Random::new(7);
    let fits: Vec<Fit> = (0..300)
        .map(|_| {
            let y = |x: f64| 2.0 - 0.5 * x + 0.1 * f64::from(noise(&mut random));
            Fit::line(
                [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
                    .map(y)
                    .into_iter()
                    .enumerate()
                    .map(|(x, y)| [x as f64, y]),
            )
            .unwrap()
        })
        .collect();
    let mean = fits.iter().map(|f| f.slope).sum::<f64>() / 300.0;
    let variance = fits.iter().map(|f| (f.slope + 0.5).powi(2)).sum::<f64>() / 300.0;
    let claimed = fits.iter().map(|f| f.standard_error.powi(2)).sum::<f64>() / 300.0;
    // True standard error: 0.1 / sqrt(3) / sqrt(28) = 0.0109.
    assert!((mean + 0.5).abs() < 4.0 * 0.0109 / 300f64.sqrt(), "{mean}");
    assert!((0.7..1.4).contains(&(claimed / variance)), "{claimed} {variance}");
}

#[test]
fn medians_are_in_the_middle() {
    let spread = Spread::of([3.0, f64::NAN, 1.0, 10.0]);
    assert_eq!(spread, Spread { median: 3.0, min: 1.0, max: 10.0 });
    assert_eq!(Spread::of([1.0, 4.0, 2.0, 9.0]).median, 3.0);
    assert!(Spread::of([]).median.is_nan());
}

/// The inside of a ball that shines with 1/2 and reflects half: 1 everywhere and in every direction.
fn furnace() -> Params {
    let mut builder = SceneBuilder::new("furnace");
    let mut wall = Material::reflecting("wall", [0.5; 3], [0.0; 3], 10.0).unwrap();
    wall.emission = [0.5; 3];
    let wall = builder.material(wall);
    builder.sphere(DVec3::ZERO, 10.0, wall).unwrap();
    builder.camera = Some(burnish::scene::read::parse_camera("0 0 0 1 x 0").unwrap());
    builder.screen = [24, 16];
    Params::new(Arc::new(builder.build()))
}

fn measured(plan: &SpeedPlan, truth: &Truth) -> SpeedExperiment {
    plan.run(truth, |_| {}).unwrap()
}

fn plan(base: Params, strategies: &[Strategy], passes: u64, repeats: u32) -> SpeedPlan {
    let mut variants = Variant::all(&[Model::Ggx], strategies, &[Normals::Visible]);
    variants.retain(|variant| !variant.engine);
    SpeedPlan { base, variants, passes, seconds: None, repeats, threads: 2 }
}

/// A furnace against its exact answer and against a reference as noisy as itself: the same error
/// once the noise is subtracted, within 15 %; and the mean is right.
#[test]
fn a_rendered_reference_measures_what_the_exact_one_does() {
    let base = Params { group: Some(ReuseGroup::None), ..furnace() };
    let exact = Truth::Given(Reference::exact(base.size, [1.0; 3]));
    let plan = plan(base, &[Strategy::Mis], 16, 5);
    let by_exact = measured(&plan, &exact).summaries();
    let by_rendered = measured(&plan, &Truth::Rendered { passes: 16 }).summaries();
    let last = |s: &[burnish::measure::speed::Summary], m| {
        s[0].checkpoints.last().unwrap().error(m).median
    };
    let [a, b] = [&by_exact, &by_rendered].map(|s| last(s, error::REL_MSE));
    assert!(a > 1e-5 && (b / a - 1.0).abs() < 0.15, "{a} {b}");
    let own = last(&by_rendered, error::REFERENCE_NOISE);
    assert!((own / a - 1.0).abs() < 0.3, "{own} {a}");
    assert!(own > 0.5 * a, "without the subtraction the two would differ by half: {own} {a}");
    for summary in by_exact.iter().chain(&by_rendered) {
        let (mean, margin) = summary.mean_error;
        // 95 % intervals of two fixed seeds; one three times as wide would miss once in 300 runs.
        assert!(mean.abs() < 3.0 * margin.unwrap(), "{mean} {margin:?}");
        assert!(margin.unwrap() < 0.02, "{margin:?}");
    }
}

#[test]
fn an_experiment_has_a_point_for_every_checkpoint_of_every_repeat() {
    let plan = plan(furnace(), &Strategy::ALL, 6, 2);
    let truth = Truth::Given(Reference::exact(plan.base.size, [1.0; 3]));
    let done = measured(&plan, &truth);
    // A B C A B C.
    let order: Vec<_> = done.runs.iter().map(|run| (run.repeat, run.variant.strategy)).collect();
    let expected = [0, 1].iter().flat_map(|&r| Strategy::ALL.map(|s| (r, s)));
    assert_eq!(order, expected.collect::<Vec<_>>());
    for run in &done.runs {
        assert_eq!(run.points.iter().map(|p| p.passes).collect::<Vec<_>>(), [1, 2, 4, 6]);
        assert_eq!(run.seed, u64::from(run.repeat));
        for pair in run.points.windows(2) {
            assert!(pair[0].seconds < pair[1].seconds && pair[0].rays < pair[1].rays);
        }
        let last = run.points.last().unwrap();
        let product = last.efficiency() * last.error(error::REL_MSE) * last.seconds;
        assert!((product - 1.0).abs() < 1e-12, "{product}");
        assert!(run.flip.iter().all(|f| f.is_some_and(|f| f > 0.0)), "{:?}", run.flip);
    }
    // Another seed is another picture; the same seed is the same one.
    let error = |run: usize| done.runs[run].points[3].error(error::MSE);
    assert_ne!(error(0), error(3));
    let again = measured(&plan, &truth);
    assert_eq!(error(0), again.runs[0].points[3].error(error::MSE));
    assert_eq!(done.summaries().len(), 3);
}

/// A budget that is gone after the first pass leaves one point; all repeats follow the first.
#[test]
fn a_budget_of_seconds_ends_a_curve() {
    let mut plan = plan(furnace(), &[Strategy::Mis], 1 << 20, 3);
    plan.seconds = Some(1e-9);
    let truth = Truth::Given(Reference::exact(plan.base.size, [1.0; 3]));
    let done = measured(&plan, &truth);
    let lengths: Vec<usize> = done.runs.iter().map(|run| run.points.len()).collect();
    assert_eq!(lengths, [1, 1, 1]);
    assert_eq!(done.summaries()[0].slope, None);
}

#[test]
fn a_reference_of_another_size_is_an_error() {
    let plan = plan(furnace(), &[Strategy::Mis], 1, 1);
    let truth = Truth::Given(Reference::exact([10, 10], [1.0; 3]));
    let text = plan.run(&truth, |_| {}).unwrap_err().to_string();
    assert!(text.contains("24x16") && text.contains("10x10"), "{text}");
}

/// Phong has no visible normals, so there is nothing to hold beside.
#[test]
fn variants_are_distinct() {
    let all = Variant::all(&Model::ALL, &Strategy::ALL, &Normals::ALL);
    assert_eq!(all.len(), 18);
    assert_eq!(all.iter().filter(|v| v.engine).count(), 3);
    let mut titles: Vec<String> = all.iter().map(|v| v.title()).collect();
    titles.sort();
    titles.dedup();
    assert_eq!(titles.len(), 18);
    let base = furnace().with_roughness(Roughness::from_alpha(0.3).unwrap());
    for variant in all {
        let params = variant.params(&base);
        assert_eq!((params.model, params.strategy), (variant.model, variant.strategy));
        assert_eq!((params.normals, params.seed), (variant.normals, base.seed));
        assert_eq!(params.reference, !variant.engine);
    }
}

/// Every tag that is opened is closed, in order, and no text breaks out of it.
fn is_well_formed(svg: &str) -> bool {
    let mut open = Vec::new();
    let mut tags = svg.split('<');
    if !tags.next().unwrap().trim().is_empty() {
        return false;
    }
    for part in tags {
        let Some((tag, text)) = part.split_once('>') else { return false };
        let quotes = tag.matches('"').count() % 2 == 0;
        let escapes = ["&lt;", "&gt;", "&amp;", "&quot;", "&apos;"];
        let bare = escapes.iter().fold(text.to_owned(), |text, escape| text.replace(escape, ""));
        if !quotes || bare.contains(['>', '&']) {
            return false;
        }
        if let Some(name) = tag.strip_prefix('/') {
            if open.pop() != Some(name) {
                return false;
            }
        } else if !tag.ends_with('/') {
            open.push(tag.split_whitespace().next().unwrap());
        }
    }
    open.is_empty()
}

#[test]
fn a_plot_is_well_formed_whatever_the_numbers() {
    let dot = |x: f64, y: f64| Dot { x, y, range: [0.5 * y, 2.0 * y] };
    let curve = |label: &str, dots: Vec<Dot>| PlotCurve {
        label: label.into(),
        colour: 7,
        mark: 3,
        last_only: dots.len() == 6,
        dashed: true,
        dots,
    };
    let panel = |dots: Vec<Dot>| Panel {
        title: "<\"A\" & 'B'>".into(),
        x: "seconds".into(),
        y: "error".into(),
        upright: ["95 %", "limits"],
        curves: vec![curve("first & last", dots), curve("none", vec![])],
    };
    let good =
        panel((0..8).map(|i| dot(0.1 * f64::from(1 << i), 1.0 / f64::from(i + 1))).collect());
    let empty = panel(vec![]);
    let odd = panel(vec![
        dot(1.0, 1e-9),
        dot(1e9, 1e9),
        dot(f64::NAN, 1.0),
        dot(1.0, 0.0),
        dot(-1.0, f64::INFINITY),
        Dot { x: 2.0, y: 1.0, range: [f64::NAN, f64::NEG_INFINITY] },
    ]);
    let one = panel(vec![dot(1.0, 1.0)]);
    for panels in [vec![], vec![good.clone()], vec![empty], vec![odd], vec![one.clone(), good, one]]
    {
        let svg = log_log(&panels).unwrap();
        assert!(svg.starts_with("<svg") && is_well_formed(&svg), "{svg}");
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        assert_eq!(svg.matches("first &amp; last").count(), panels.len());
    }
    assert!(!is_well_formed("<svg><a></svg></a>") && !is_well_formed("<svg>a > b</svg>"));
}
