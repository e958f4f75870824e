//! Sine, cosine and exponential by + - * / alone.
//!
//! Those four are exact to the last bit by IEEE 754 on every machine; the functions of the
//! system's library are not, and the files would differ between machines.

/// Cosine and sine of `turns` full turns.
pub(crate) fn cos_sin(turns: f64) -> [f64; 2] {
    // To the nearest quarter turn, so that the series sees at most an eighth.
    let quarters = (turns * 4.0).round();
    let x = (turns - quarters / 4.0) * std::f64::consts::TAU;
    let (c, s) = (series(x, 0), series(x, 1));
    match (quarters as i64).rem_euclid(4) {
        0 => [c, s],
        1 => [-s, c],
        2 => [-c, -s],
        _ => [s, -c],
    }
}

/// Terms `first`, `first` + 2, ... of the Taylor series of e^x with alternating signs.
fn series(x: f64, first: u32) -> f64 {
    let mut term = if first == 0 { 1.0 } else { x };
    let mut sum = term;
    let mut n = f64::from(first);
    for _ in 0..12 {
        term *= -x * x / ((n + 1.0) * (n + 2.0));
        sum += term;
        n += 2.0;
    }
    sum
}

/// e^x.
pub(crate) fn exp(x: f64) -> f64 {
    let small = x / 64.0;
    let mut term = 1.0;
    let mut sum = 1.0;
    for n in 1..16 {
        term *= small / f64::from(n);
        sum += term;
    }
    (0..6).fold(sum, |e, _| e * e)
}

#[test]
fn agrees_with_the_systems_functions() {
    for i in -4000..4000 {
        let t = f64::from(i) * 0.00173;
        let [c, s] = cos_sin(t);
        let (sin, cos) = (t * std::f64::consts::TAU).sin_cos();
        assert!((c - cos).abs() < 1e-13 && (s - sin).abs() < 1e-13, "{t}: {c} {s}");
        assert!((exp(t) / t.exp() - 1.0).abs() < 1e-13, "exp({t})");
    }
}
