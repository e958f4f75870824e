//! The tone curve: linear radiance becomes 8-bit sRGB codes.
//!
//! radiance × 2^exposure → [`Curve`] → sRGB transfer curve (IEC 61966-2-1) → rounded to 0..=255.
//!
//! A curve is a mix of the three channels (none for most curves) and then a function of each
//! channel on its own. All that comes after the mix rises with its input, so a code is decided by
//! comparing with 255 thresholds. Those are found once, by bisection, from the exact formula; whole
//! tiles then need no `powf`, and get the very codes that the formula gives. The mix has no `powf`
//! in it: both ways compute it, by the same operations in single precision.

use super::{Picture, dither, neutral};
use std::sync::LazyLock;

/// How radiance beyond what a screen can show is brought into 0..=1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Curve {
    /// `min(x, 1)`: plain sRGB; what is too bright is clipped.
    #[default]
    Srgb,
    /// `x / (1 + x)`: never clips, lowers contrast (Reinhard et al. 2002, equation 3, applied to
    /// each channel rather than to luminance).
    Reinhard,
    /// `x (2.51 x + 0.03) / (x (2.43 x + 0.59) + 0.14)`, clipped at 1: Narkowicz's 2016 fit of
    /// the ACES film curve. Has a toe and a shoulder; 1 becomes 0.80.
    Filmic,
    /// The Khronos PBR Neutral tone mapper of 2024: colours up to 0.76 keep their hue, less what a
    /// dielectric's specular adds to all channels alike (0.04, and less where it is darker); the largest channel beyond is
    /// compressed, the others with it, and ever more towards white. Highlights keep their shape and
    /// coloured ones their hue.
    Neutral,
}

/// What a pixel shows that is NaN in any channel: magenta.
pub const NAN_COLOUR: [u8; 3] = [255, 0, 255];

/// Exposure and curve: all that lies between a radiance and the code on the screen.
///
/// Every input has an output: negative values and minus infinity show as 0, infinity as 255, a
/// pixel with a NaN in it as [`NAN_COLOUR`].
///
/// ```
/// use burnish::picture::Tone;
///
/// let mut codes = [[0; 3]; 2];
/// Tone::default().rgb8(&[[0.0, 0.5, 1.0], [f32::NAN, 0.0, 0.0]], &mut codes);
/// assert_eq!(codes, [[0, 188, 255], [255, 0, 255]]);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tone {
    /// In stops: 1 doubles the brightness. Taken as the nearest end of [`Tone::EXPOSURE`] beyond
    /// it, as 0 where it is NaN.
    pub exposure: f32,
    /// How bright values are brought into range.
    pub curve: Curve,
}

impl Curve {
    /// All of them, in the order of the window's list.
    pub const ALL: [Curve; 4] = [Curve::Srgb, Curve::Reinhard, Curve::Filmic, Curve::Neutral];

    /// Lower-case name, as the command line takes it.
    pub fn name(self) -> &'static str {
        match self {
            Curve::Srgb => "srgb",
            Curve::Reinhard => "reinhard",
            Curve::Filmic => "filmic",
            Curve::Neutral => "neutral",
        }
    }

    /// As a person writes it.
    pub fn title(self) -> &'static str {
        match self {
            Curve::Srgb => "sRGB",
            Curve::Reinhard => "Reinhard",
            Curve::Filmic => "Filmic",
            Curve::Neutral => "Neutral",
        }
    }

    /// Exposed radiance, none of it NaN, with its channels mixed.
    fn mix(self, exposed: [f32; 3]) -> [f32; 3] {
        match self {
            Curve::Neutral => neutral::mix(exposed),
            Curve::Srgb | Curve::Reinhard | Curve::Filmic => exposed,
        }
    }

    /// A channel of at least 0, mixed, to display light in 0..=1.
    fn apply(self, x: f64) -> f64 {
        match self {
            Curve::Srgb | Curve::Neutral => x.min(1.0),
            Curve::Reinhard => x / (1.0 + x),
            Curve::Filmic => (x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)).min(1.0),
        }
    }

    fn table(self) -> &'static ToneTable {
        static TABLES: [LazyLock<ToneTable>; 3] = [
            LazyLock::new(|| ToneTable::new(Curve::Srgb)),
            LazyLock::new(|| ToneTable::new(Curve::Reinhard)),
            LazyLock::new(|| ToneTable::new(Curve::Filmic)),
        ];
        match self {
            Curve::Srgb | Curve::Neutral => &TABLES[0],
            Curve::Reinhard => &TABLES[1],
            Curve::Filmic => &TABLES[2],
        }
    }
}

impl Tone {
    /// Lowest and highest exposure in stops.
    pub const EXPOSURE: [f32; 2] = [-30.0, 30.0];

    /// The factor before the curve.
    fn gain(self) -> f32 {
        let [low, high] = Self::EXPOSURE;
        if self.exposure.is_nan() { 1.0 } else { self.exposure.clamp(low, high).exp2() }
    }

    /// The codes of one pixel by the formula itself. For many pixels, [`Tone::map`] gives the
    /// same a good deal faster.
    pub fn exact(self, pixel: [f32; 3]) -> [u8; 3] {
        if pixel.iter().any(|c| c.is_nan()) {
            return NAN_COLOUR;
        }
        let gain = self.gain();
        self.curve.mix(pixel.map(|c| c * gain)).map(|c| code(self.curve, c))
    }

    /// The codes of a run of pixels, each made into a `T`, which is whatever the caller's screen
    /// or file wants. As many as the shorter of the two slices has.
    pub fn map<T>(self, pixels: &[[f32; 3]], out: &mut [T], make: impl Fn([u8; 3]) -> T) {
        // One loop a kind of curve.
        match self.curve {
            Curve::Neutral => self.map_mixed(pixels, out, neutral::mix, make),
            Curve::Srgb | Curve::Reinhard | Curve::Filmic => {
                self.map_mixed(pixels, out, |exposed| exposed, make);
            }
        }
    }

    /// [`Tone::map`] whose mix is known.
    #[inline(always)]
    fn map_mixed<T>(
        self,
        pixels: &[[f32; 3]],
        out: &mut [T],
        mix: impl Fn([f32; 3]) -> [f32; 3],
        make: impl Fn([u8; 3]) -> T,
    ) {
        let (gain, table) = (self.gain(), self.curve.table());
        // A coarse preview has the same colour many times in a row.
        let (mut last, mut codes) = ([0.0; 3], [table.code(0.0); 3]);
        for (slot, &[r, g, b]) in out.iter_mut().zip(pixels) {
            if [r, g, b] != last {
                // One comparison catches every NaN, and now and then two opposite infinities.
                codes = if (r + g + b).is_nan() {
                    self.exact([r, g, b])
                } else {
                    mix([r * gain, g * gain, b * gain]).map(|c| table.code(c))
                };
                last = [r, g, b];
            }
            *slot = make(codes);
        }
    }

    /// Red, green, blue.
    pub fn rgb8(self, pixels: &[[f32; 3]], out: &mut [[u8; 3]]) {
        self.map(pixels, out, |rgb| rgb);
    }

    /// The codes of a whole picture for a file, rounded up or down so that the mean over some
    /// pixels is that of the exact values, where plain rounding would show bands. What lies on a
    /// code, black and white among it, keeps it.
    ///
    /// The window rounds plainly instead: it maps every tile thirty times a second, by a table that
    /// knows codes alone, and a picture that has noise in it is dithered by that.
    pub fn dithered(self, picture: &Picture) -> Vec<[u8; 3]> {
        let gain = self.gain();
        let width = picture.width.max(1) as usize;
        let code = |i: usize, pixel: &[f32; 3]| {
            if pixel.iter().any(|c| c.is_nan()) {
                return NAN_COLOUR;
            }
            // The same for all channels: a grey stays grey.
            let up = dither::threshold(i % width, i / width);
            let mixed = self.curve.mix(pixel.map(|c| c * gain));
            mixed.map(|c| (signal(self.curve, c) + up) as u8)
        };
        picture.pixels.iter().enumerate().map(|(i, pixel)| code(i, pixel)).collect()
    }

    /// Red, green, blue, and an alpha of 255.
    pub fn rgba8(self, pixels: &[[f32; 3]], out: &mut [[u8; 4]]) {
        self.map(pixels, out, |[r, g, b]| [r, g, b, 255]);
    }
}

/// Beyond this every curve shows 255; it keeps the formulas away from infinity.
const BRIGHTEST: f64 = 1e9;

/// The code nearest to the formula.
fn code(curve: Curve, exposed: f32) -> u8 {
    (signal(curve, exposed) + 0.5) as u8
}

/// The formula, in 0..=255, in double precision so that it rises without a wobble between any two
/// floats. `exposed` is not NaN.
fn signal(curve: Curve, exposed: f32) -> f64 {
    let light = curve.apply(f64::from(exposed).clamp(0.0, BRIGHTEST));
    let signal =
        if light <= 0.0031308 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 };
    255.0 * signal
}

/// Codes by look-up. A cell is 1/256 of an octave, narrower than any code is, so the code of its
/// lower end is right or one short.
///
/// A cell holds that code times `STEP`, plus as much as makes the low bits of a float at or above
/// the next threshold carry: one addition gives the code.
struct ToneTable([u32; CELLS]);

/// Low mantissa bits that do not choose the cell.
const SHIFT: u32 = 15;
const STEP: u32 = 1 << SHIFT;
/// 32 octaves of 256 cells.
const CELLS: usize = 1 << 13;
/// Bits of 2^-16, which every curve shows as 0; the last cell ends at 2^16, shown as 255.
const LOWEST: u32 = (127 - 16) << 23;
const HIGHEST: u32 = LOWEST + CELLS as u32 * STEP - 1;

impl ToneTable {
    fn new(curve: Curve) -> ToneTable {
        let mut cells = [0; CELLS];
        let mut below = 0;
        let mut next = first_above(curve, below);
        for (cell, entry) in cells.iter_mut().enumerate() {
            let start = LOWEST + cell as u32 * STEP;
            while below < 255 && next <= start {
                below += 1;
                next = first_above(curve, below);
            }
            *entry = u32::from(below) * STEP + STEP.saturating_sub(next - start);
        }
        ToneTable(cells)
    }

    #[inline(always)]
    fn code(&self, exposed: f32) -> u8 {
        let (low, high) = (f32::from_bits(LOWEST), f32::from_bits(HIGHEST));
        let x = if exposed > low { exposed } else { low };
        let x = if x < high { x } else { high };
        let place = x.to_bits() - LOWEST;
        let entry = self.0[(place / STEP) as usize & (CELLS - 1)];
        ((entry + place % STEP) / STEP) as u8
    }
}

/// Bits of the smallest float whose code is above `below`; beyond `HIGHEST` for 255.
fn first_above(curve: Curve, below: u8) -> u32 {
    // The bits of floats of at least 0 are in the order of the floats.
    let (mut dark, mut bright) = (0, HIGHEST + 1);
    while bright - dark > 1 {
        let middle = dark + (bright - dark) / 2;
        if code(curve, f32::from_bits(middle)) > below { bright = middle } else { dark = middle }
    }
    bright
}

#[cfg(test)]
mod tests {
    use super::*;

    fn both(curve: Curve, bits: u32) -> [u8; 2] {
        let (tone, x) = (Tone { exposure: 0.0, curve }, f32::from_bits(bits));
        let mut fast = [[0; 3]];
        tone.rgb8(&[[x; 3]], &mut fast);
        [tone.exact([x; 3])[0], fast[0][0]]
    }

    /// Colours of which no two channels are alike, from black to far beyond white.
    #[test]
    fn look_up_is_the_formula_for_colours() {
        let steps = |i: u32| (2f32).powf((i * 7919 % 1009) as f32 / 1009.0 * 30.0 - 15.0);
        let colours: Vec<[f32; 3]> =
            (0..60_000).map(|i| [steps(3 * i), steps(5 * i + 1), steps(7 * i + 2)]).collect();
        for curve in Curve::ALL {
            let tone = Tone { exposure: -0.3, curve };
            let mut fast = vec![[0; 3]; colours.len()];
            tone.rgb8(&colours, &mut fast);
            for (colour, fast) in colours.iter().zip(fast) {
                assert_eq!(tone.exact(*colour), fast, "{curve:?} {colour:?}");
            }
        }
    }

    #[test]
    fn no_cell_holds_two_thresholds_and_the_ends_are_black_and_white() {
        for curve in Curve::ALL {
            let thresholds: Vec<_> = (0..255).map(|below| first_above(curve, below)).collect();
            assert!(thresholds[0] > LOWEST && thresholds[254] < HIGHEST, "{curve:?}");
            let cell = |bits: &u32| (bits - LOWEST) / STEP;
            assert!(thresholds.windows(2).all(|w| cell(&w[0]) < cell(&w[1])), "{curve:?}");
        }
    }

    #[test]
    fn look_up_is_the_formula_at_every_threshold_and_over_all_floats() {
        for curve in Curve::ALL {
            let near = (0..255).map(|below| first_above(curve, below)).flat_map(|t| t - 2..=t + 2);
            // A stride coprime to the cells' width, from 0 through the denormals to infinity.
            let all = (0..=f32::INFINITY.to_bits()).step_by(1999);
            for bits in near.chain(all) {
                let [exact, fast] = both(curve, bits);
                assert_eq!(exact, fast, "{curve:?} {}", f32::from_bits(bits));
            }
        }
    }
}
