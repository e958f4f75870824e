//! Layers of a picture: itself, its noise, its numbers of samples, the latter two in false
//! colour.

use crate::viewer::keys::{self, Action};
use crate::viewer::style::labels::{self, Control};
use crate::viewer::style::numbers::{digits, short};
use burnish::film::{CELL, REL_MSE_FLOOR};
use burnish::progressive::{TileImage, TileRect};
use egui::Color32;

/// A layer of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Layer {
    #[default]
    Picture,
    /// The relative standard error of each pixel.
    Noise,
    /// Samples of each pixel.
    Samples,
}

impl Layer {
    pub(crate) const ALL: [Layer; 3] = [Layer::Picture, Layer::Noise, Layer::Samples];

    pub(crate) fn control(self) -> Control {
        match self {
            Layer::Picture => labels::LAYER_PICTURE,
            Layer::Noise => labels::LAYER_NOISE,
            Layer::Samples => labels::LAYER_SAMPLES,
        }
    }

    pub(crate) fn next(self) -> Layer {
        let at = Layer::ALL.iter().position(|&l| l == self).unwrap_or(0);
        Layer::ALL[(at + 1) % Layer::ALL.len()]
    }

    /// The value of a pixel of a tile, by its column and row there; `None` while it is not known.
    pub(super) fn value(self, tile: &TileImage, rect: TileRect, [x, y]: [usize; 2]) -> Option<f32> {
        let pixel = y * rect.width() + x;
        match self {
            Layer::Picture => None,
            Layer::Noise => {
                let (mean, error) = (tile.mean.get(pixel)?, tile.standard_error.get(pixel)?);
                Some(relative(mean, error)).filter(|v| v.is_finite())
            }
            Layer::Samples => {
                let cell = y / CELL * rect.width().div_ceil(CELL) + x / CELL;
                tile.samples.get(cell).map(|&n| n as f32)
            }
        }
    }

    /// A value in words, with its unit.
    pub(super) fn words(self, value: f32) -> String {
        match self {
            Layer::Picture => String::new(),
            Layer::Noise => {
                let words = digits(100.0 * f64::from(value), 3);
                // A range's ends are round.
                let words = match words.contains('.') && !words.contains('e') {
                    true => words.trim_end_matches('0').trim_end_matches('.'),
                    false => &words,
                };
                format!("{words} %")
            }
            Layer::Samples if value < 1e6 => format!("{value:.0}"),
            Layer::Samples => short(value.into()),
        }
    }
}

/// `sqrt(mean(s^2 / (x^2 + 0.01)))` over the channels, s being the standard error of the radiance x: as
/// the picture's relative error is measured.
fn relative(mean: &[f32; 3], error: &[f32; 3]) -> f32 {
    let term = |c: usize| error[c] * error[c] / (mean[c] * mean[c] + REL_MSE_FLOOR as f32);
    ((term(0) + term(1) + term(2)) / 3.0).sqrt()
}

/// Values as colours, equal ratios equally far apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scale {
    pub(crate) layer: Layer,
    /// The values of the first and of the last colour, above 0.
    pub(crate) ends: [f32; 2],
}

/// Number of pixels by which the range of a picture's values is found.
const PROBES: usize = 16_384;
/// The part of the pixels that may lie beyond either end.
const BEYOND: f32 = 0.02;
/// No more than this from one end to the other, or all that matters would have one colour.
const SPAN: f32 = 50.0;

impl Scale {
    /// The scale for these tiles, of which nothing is known yet where there is none. It stays as it
    /// was where that still fits, so that colours keep their meaning for a while.
    pub(crate) fn of<'a>(
        layer: Layer,
        tiles: impl Iterator<Item = (&'a TileImage, TileRect)> + Clone,
        before: Option<Scale>,
    ) -> Scale {
        let pixels: usize = tiles.clone().map(|(_, rect)| rect.area()).sum();
        // An odd step, which does not keep to the same columns.
        let step = (pixels / PROBES).max(1) | 1;
        let mut values = Vec::with_capacity(pixels / step + 1);
        let mut skip = 0;
        for (tile, rect) in tiles {
            let mut i = skip;
            while i < rect.area() {
                values.extend(layer.value(tile, rect, [i % rect.width(), i / rect.width()]));
                i += step;
            }
            skip = i - rect.area();
        }
        values.retain(|&v| v > 0.0);
        values.sort_unstable_by(f32::total_cmp);
        let before = before.filter(|b| b.layer == layer);
        let Some(last) = values.len().checked_sub(1) else {
            let ends = if layer == Layer::Noise { [0.01, 1.0] } else { [1.0, 16.0] };
            return before.unwrap_or(Scale { layer, ends });
        };
        let quantile = |part: f32| values[(part * last as f32).round() as usize];
        let high = quantile(1.0 - BEYOND);
        let seen = [quantile(BEYOND).max(high / SPAN), high];
        match before {
            Some(before) if before.fits(seen) => before,
            _ => Scale { layer, ends: layer.round(seen) },
        }
    }

    /// Whether these values fill it, or nearly so.
    fn fits(&self, [low, high]: [f32; 2]) -> bool {
        let [first, last] = self.ends;
        let spare = if self.layer == Layer::Noise { 5.0 } else { 4.0 };
        first <= low && low < first * spare && high <= last && high > last / spare
    }

    /// Place of a value on the scale, from 0 to 1.
    pub(super) fn share(&self, value: f32) -> f32 {
        let [low, high] = self.ends.map(f32::ln);
        ((value.ln() - low) / (high - low)).clamp(0.0, 1.0)
    }

    /// The colours of a tile's pixels, row by row.
    pub(crate) fn colours(&self, tile: &TileImage, rect: TileRect) -> Vec<Color32> {
        let pixels = (0..rect.height()).flat_map(|y| (0..rect.width()).map(move |x| [x, y]));
        let colour = |at| match self.layer.value(tile, rect, at) {
            Some(value) => viridis(self.share(value)),
            None => UNKNOWN,
        };
        pixels.map(colour).collect()
    }
}

impl Layer {
    /// The round numbers about a range: 1, 2 and 5 times a power of ten, or powers of 2.
    fn round(self, [low, high]: [f32; 2]) -> [f32; 2] {
        let (low, high) = match self {
            Layer::Samples => (low.log2().floor().exp2(), high.log2().ceil().exp2()),
            Layer::Picture | Layer::Noise => {
                let low = low.max(1e-9);
                let steps = |x: f32| {
                    let decade = x.log10().floor() as i32;
                    let all = [decade, decade + 1].into_iter();
                    let step = |d: i32| [1.0, 2.0, 5.0].map(|f| (f * 10f64.powi(d)) as f32);
                    all.flat_map(step).collect::<Vec<_>>()
                };
                let below = steps(low).into_iter().rfind(|&s| s <= low).unwrap_or(low);
                let above = steps(high).into_iter().find(|&s| s >= high).unwrap_or(high);
                (below, above)
            }
        };
        [low, if high > low { high } else { 2.0 * low }]
    }
}

/// Colour of pixels whose value is not known.
pub(crate) const UNKNOWN: Color32 = Color32::from_gray(0x68);

/// Every eighth of the map "viridis" of van der Walt and Smith 2015, made to be even in perceived
/// lightness, also for the colour-blind, and published without rights reserved (CC0).
const VIRIDIS: [[u8; 3]; 9] = [
    [0x44, 0x01, 0x54],
    [0x47, 0x2d, 0x7b],
    [0x3b, 0x52, 0x8b],
    [0x2c, 0x72, 0x8e],
    [0x21, 0x90, 0x8c],
    [0x27, 0xad, 0x81],
    [0x5d, 0xc8, 0x63],
    [0xaa, 0xdc, 0x32],
    [0xfd, 0xe7, 0x25],
];

/// The colour of a part of the scale, 0 to 1.
pub(super) fn viridis(share: f32) -> Color32 {
    let at = share.clamp(0.0, 1.0) * (VIRIDIS.len() - 1) as f32;
    let i = (at as usize).min(VIRIDIS.len() - 2);
    let t = at - i as f32;
    let [r, g, b] = [0, 1, 2].map(|c: usize| {
        let [from, to] = [VIRIDIS[i][c], VIRIDIS[i + 1][c]].map(f32::from);
        (from + t * (to - from)).round() as u8
    });
    Color32::from_rgb(r, g, b)
}

/// The tooltip of a layer's button.
pub(crate) fn tip(ctx: &egui::Context, layer: Layer) -> String {
    let keys = keys::keys_text(ctx, keys::binding(Action::Layer));
    format!("{}\nKey: {keys}, for the next of the three", layer.control().tip)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// CIE 1976 lightness.
    fn lightness(colour: Color32) -> f32 {
        let [r, g, b, _] = egui::Rgba::from(colour).to_array();
        let y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        if y > 0.008856 { 116.0 * y.cbrt() - 16.0 } else { 903.3 * y }
    }

    #[test]
    fn colours_grow_lighter_evenly() {
        let all: Vec<f32> = (0..=64).map(|i| lightness(viridis(i as f32 / 64.0))).collect();
        let mean = (all[64] - all[0]) / 64.0;
        assert!(mean > 1.0, "{all:?}");
        for pair in all.windows(2) {
            let step = pair[1] - pair[0];
            assert!((0.5 * mean..1.7 * mean).contains(&step), "{step} of {mean}: {all:?}");
        }
        let grey = [UNKNOWN.r(), UNKNOWN.g(), UNKNOWN.b()];
        assert!(grey.iter().all(|&c| c == grey[0]), "no colour of the map is grey");
    }

    fn tile(relative: &[f32], samples: u64) -> TileImage {
        TileImage {
            passes: 8,
            samples: vec![samples; relative.len().div_ceil(CELL)],
            mean: vec![[1.0; 3]; relative.len()],
            standard_error: relative.iter().map(|&r| [r * 1.01f32.sqrt(); 3]).collect(),
            block: 1,
        }
    }

    const ROW: TileRect = TileRect { x0: 0, y0: 0, x1: 32, y1: 1 };

    fn scale(layer: Layer, tile: &TileImage, before: Option<Scale>) -> Scale {
        Scale::of(layer, [(tile, ROW)].into_iter(), before)
    }

    #[test]
    fn a_scale_has_round_ends_and_stays_while_it_fits() {
        let falling = |from: f32| (0..32).map(|i| from * 0.93f32.powi(i)).collect::<Vec<_>>();
        // From 0.3 to about 0.032.
        let first = scale(Layer::Noise, &tile(&falling(0.3), 8), None);
        assert_eq!(first.ends, [0.02, 0.5]);
        let same = scale(Layer::Noise, &tile(&falling(0.2), 8), Some(first));
        assert_eq!(same, first, "a little less noise does not change the colours");
        let next = scale(Layer::Noise, &tile(&falling(0.09), 8), Some(first));
        assert_eq!(next.ends, [0.01, 0.1]);
        let samples = scale(Layer::Samples, &tile(&falling(0.3), 24), Some(first));
        assert_eq!(samples.ends, [16.0, 32.0]);
        let equal = scale(Layer::Samples, &tile(&falling(0.3), 16), None);
        assert_eq!(equal.ends, [16.0, 32.0], "never empty");
    }

    #[test]
    fn pixels_get_the_colours_of_their_values_and_unknown_ones_none() {
        let mut values = vec![0.1; 32];
        (values[0], values[31]) = (0.01, 1.0);
        let scale = Scale { layer: Layer::Noise, ends: [0.01, 1.0] };
        let colours = scale.colours(&tile(&values, 8), ROW);
        assert_eq!([colours[0], colours[1], colours[31]], [0.0, 0.5, 1.0].map(viridis));
        let mut young = tile(&values, 8);
        young.standard_error.clear();
        assert!(scale.colours(&young, ROW).iter().all(|&c| c == UNKNOWN));
        let black = TileImage { mean: vec![[0.0; 3]; 32], ..tile(&[0.0; 32], 8) };
        assert_eq!(scale.colours(&black, ROW)[3], viridis(0.0), "without noise, not unknown");
    }

    #[test]
    fn values_are_told_with_their_units() {
        let words = [0.001, 0.02, 0.5, 1.0, 0.1234].map(|v| Layer::Noise.words(v));
        assert_eq!(words, ["0.1 %", "2 %", "50 %", "100 %", "12.3 %"]);
        let small = [2e-5, 1e-7, 3e-9].map(|v| Layer::Noise.words(v));
        assert_eq!(small, ["0.002 %", "1.00e-5 %", "3.00e-7 %"]);
        assert_eq!([16.0, 4096.0].map(|v| Layer::Samples.words(v)), ["16", "4096"]);
    }
}
