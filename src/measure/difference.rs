//! Where two pictures differ, in false colours.

use super::error::Pair;
use crate::picture::{NAN_COLOUR, Picture, Tone};

/// What [`PictureDifference`] shows in each pixel, in plain text: relMSE's root with a sign.
pub const FORMULA: &str = "mean over channels of (x - r) / sqrt(r^2 + 0.01)";

/// What [`changed`] counts, in plain text.
pub const CHANGED_FORMULA: &str = "share of pixels with a channel whose code differs by more";

/// The share of the pixels, 0 to 1, that differ on the screen: those with a channel whose 8-bit code,
/// given by this tone, differs by more than `threshold` of the display's range, 255 codes. 0 without
/// any pixel.
pub fn changed(pair: &Pair, tone: Tone, threshold: f64) -> f64 {
    let codes = |picture: &Picture| {
        let mut codes = vec![[0; 3]; picture.pixels.len()];
        tone.rgb8(&picture.pixels, &mut codes);
        codes
    };
    let (x, r) = (codes(pair.picture()), codes(&pair.reference().picture));
    let differs = |(x, r): &(&[u8; 3], &[u8; 3])| {
        x.iter().zip(*r).any(|(x, r)| f64::from(x.abs_diff(*r)) > threshold * 255.0)
    };
    let count = x.iter().zip(&r).filter(differs).count();
    count as f64 / x.len().max(1) as f64
}

/// The signed relative difference of every pixel.
#[derive(Clone, Debug)]
pub struct PictureDifference {
    size: [u32; 2],
    values: Vec<f32>,
}

impl PictureDifference {
    /// Of a picture and its reference.
    pub fn new(pair: &Pair) -> PictureDifference {
        let (picture, reference) = (pair.picture(), &pair.reference().picture);
        let value = |(x, r): (&[f32; 3], &[f32; 3])| {
            let channel = |c: usize| (x[c] - r[c]) / (r[c] * r[c] + 0.01).sqrt();
            (channel(0) + channel(1) + channel(2)) / 3.0
        };
        let values = picture.pixels.iter().zip(&reference.pixels).map(value).collect();
        PictureDifference { size: [picture.width, picture.height], values }
    }

    /// A scale that shows most of it: 99 % of the pixels differ by no more. 1 where that is 0.
    pub fn scale(&self) -> f32 {
        let finite = self.values.iter().map(|v| v.abs()).filter(|v| v.is_finite());
        let mut sizes: Vec<f32> = finite.collect();
        sizes.sort_unstable_by(f32::total_cmp);
        let place = (sizes.len() * 99).div_ceil(100);
        let scale = sizes.get(place.saturating_sub(1)).copied().unwrap_or(0.0);
        if scale > 0.0 { scale } else { 1.0 }
    }

    /// White where there is no difference, ever redder up to `scale` where the picture is too
    /// bright, ever bluer where it is too dark, magenta where either is not a number; as linear
    /// radiance for the default tone curve. `scale` is above 0.
    pub fn false_colour(&self, scale: f32) -> Picture {
        let colour = |&value: &f32| {
            let share = (value / scale).clamp(-1.0, 1.0);
            let end = if share > 0.0 { BRIGHTER } else { DARKER };
            if share.is_nan() {
                return NAN_COLOUR.map(|code| f32::from(code) / 255.0);
            }
            end.map(|c| 1.0 + (c - 1.0) * share.abs())
        };
        let [width, height] = self.size;
        Picture { width, height, pixels: self.values.iter().map(colour).collect() }
    }
}

/// A red and a blue of the same lightness, which the colour-blind tell apart.
const BRIGHTER: [f32; 3] = [0.45, 0.03, 0.02];
const DARKER: [f32; 3] = [0.02, 0.10, 0.45];
