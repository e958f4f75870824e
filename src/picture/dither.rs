//! Where a picture's pixels are rounded up.
//!
//! Thresholds that neighbours share little of: the multiples of (1/p, 1/p²), p³ = p + 1, along the
//! columns and rows, modulo 1 (Roberts 2018, the R2 sequence). Any few neighbouring pixels have
//! thresholds spread evenly over 0..1, so that a flat colour between two codes becomes a fine,
//! regular mixture of both, without the grain of white noise or the crosses of a Bayer matrix. They
//! depend on the place alone: equal pictures make equal files.

/// 1/p and 1/p² of the plastic number p = 1.3247...
const STEPS: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];

/// Values this near to a code, in codes, are that code: sRGB's inverse in single precision is not
/// exact.
const MARGIN: f64 = 1e-3;

/// What to add to the value of the pixel in column `x`, row `y` before its fraction is cut off.
/// Evenly spread within 0..1.
pub(super) fn threshold(x: usize, y: usize) -> f64 {
    let place = (x as f64 * STEPS[0] + y as f64 * STEPS[1]).fract();
    MARGIN + (1.0 - 2.0 * MARGIN) * place
}
