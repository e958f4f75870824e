//! Elementary and special functions against f64.

use crate::support::erfc;
use burnish::math::special::{
    atan_ratio, erf, erfc_inv, erfc_scaled, exp, exp_m1, ln, ln_1p, sin_cos_2pi,
};

/// Largest of `f`'s relative errors over an even sweep of `[a, b]`.
fn worst(a: f64, b: f64, f: impl Fn(f32) -> f32, truth: impl Fn(f64) -> f64) -> f64 {
    let n = 200_000;
    (0..=n)
        .map(|i| {
            let x = (a + (b - a) * i as f64 / n as f64) as f32;
            let t = truth(x as f64);
            (f(x) as f64 - t).abs() / t.abs().max(1e-30)
        })
        .fold(0.0, f64::max)
}

#[test]
fn exponential_and_logarithm() {
    assert!(worst(-86.5, 88.6, exp, f64::exp) < 1.3e-7);
    assert!(worst(-1.0, 1.0, exp, f64::exp) < 1.3e-7);
    assert_eq!(exp(-100.0f32), 0.0);
    assert_eq!(exp(0.0f32), 1.0);
    assert!(worst(1e-6, 0.9, ln, f64::ln) < 2e-7);
    assert!(worst(1.1, 1e9, ln, f64::ln) < 2e-7);
    assert!(worst(0.999, 0.999_999, ln, f64::ln) < 2e-7);
    assert!(worst(1.000_001, 1.001, ln, f64::ln) < 2e-7);
    assert_eq!(ln(1.0f32), 0.0);
    for scale in [1e-12, 1e-6, 1e-3, 1.0, 1e6, 1e20] {
        assert!(worst(0.01 * scale, scale, ln_1p, f64::ln_1p) < 3e-7, "{scale}");
    }
    for scale in [1e-12, 1e-6, 1e-3, 1.0, 30.0] {
        assert!(worst(-scale, -0.01 * scale, exp_m1, f64::exp_m1) < 3e-7, "{scale}");
    }
    assert_eq!(exp_m1(0.0f32), 0.0);
    assert_eq!(ln_1p(0.0f32), 0.0);
    assert_eq!(ln_1p(f32::MAX), ln(f32::MAX));
}

#[test]
fn sine_and_cosine() {
    for i in 0..=1_000_000 {
        let u = i as f32 / 1e6;
        let (s, c) = sin_cos_2pi(u);
        let (ts, tc) = (u as f64 * std::f64::consts::TAU).sin_cos();
        assert!((s as f64 - ts).abs() < 1.2e-7 && (c as f64 - tc).abs() < 1.2e-7, "{u}");
    }
    assert_eq!(sin_cos_2pi(0.25f32).0, 1.0);
    assert_eq!(sin_cos_2pi(0.5f32).1, -1.0);
}

#[test]
fn arc_tangents_of_ratios() {
    for i in -1000..=1000 {
        let y = i as f32 / 300.0;
        for x in [0.0, 1e-30, 1e-3, 0.1, 0.999, 1.0, 3.0, 1e30] {
            let truth = f64::from(y).atan2(f64::from(x));
            let off = (f64::from(atan_ratio(y, x)) - truth).abs();
            assert!(off < 2e-7, "{y} / {x}: {off}");
        }
    }
    assert_eq!(atan_ratio(0.0f32, 0.0), 0.0);
}

#[test]
fn error_function_and_inverse() {
    assert!(worst(1e-6, 4.0, erf, |x| 1.0 - erfc(x)) < 3e-7);
    assert!(worst(0.0, 8.0, erfc_scaled, |x| erfc(x) * (x * x).exp()) < 5e-7);
    assert_eq!(erf(-0.5f32), -erf(0.5f32));
    for i in 1..100_000 {
        let c = 2.0 * i as f32 / 1e5;
        let x = erfc_inv(c) as f64;
        // Compare in c, divided by the slope: the error of x that explains the difference.
        let slope = 2.0 / std::f64::consts::PI.sqrt() * (-x * x).exp();
        let dx = ((erfc(x) - c as f64) / slope).abs();
        assert!(dx < 1e-6 * x.abs().max(0.1), "{c}: {x} is off by {dx}");
    }
    for c in [3e-8f32, 1e-7, 1e-6, 1e-5] {
        let x = erfc_inv(c) as f64;
        let slope = 2.0 / std::f64::consts::PI.sqrt() * (-x * x).exp();
        assert!(((erfc(x) - c as f64) / slope).abs() < 2e-6 * x, "{c}");
    }
}
