//! FLIP: the difference that a person sees when two pictures alternate in one place.
//!
//! Andersson et al., *FLIP: A Difference Evaluator for Alternating Images*, HPG 2020, on the
//! tone-mapped 8-bit pictures; HDR-FLIP (Andersson et al., Eurographics 2021) on the radiance: the
//! largest FLIP of a pixel over exposures a stop or less apart, through the ACES curve, from where
//! the reference's brightest pixel is just not clipped to where its median pixel is just not.
//! Either way the viewer sits 0.7 m from a screen of 3840 pixels on 0.7 m, 67 pixels a degree.

use super::error::Pair;
use crate::picture::{Picture, Tone};
use flip_rs::{DEFAULT_PPD, ErrorMap, FlipError, HdrOptions, RgbImage, hdr_flip, ldr_flip};

/// What FLIP's number is, for tables.
pub const FORMULA: &str = "mean over pixels of FLIP, tone-mapped to 8-bit sRGB, 67 pixels a degree";

/// What HDR-FLIP's number is, for tables.
pub const HDR_FORMULA: &str =
    "mean over pixels of the largest FLIP over the exposures chosen from r, ACES curve";

/// How visible the difference is, pixel by pixel.
#[derive(Clone, Debug)]
pub struct Flip(ErrorMap);

impl Flip {
    /// Of the tone-mapped pictures. NaN shows, as on the screen, in magenta.
    ///
    /// An error says in words why there is no answer, such as a picture too large.
    pub fn tone_mapped(pair: &Pair, tone: Tone) -> Result<Flip, String> {
        let codes = |picture: &Picture| {
            let mut codes = vec![[0; 3]; picture.pixels.len()];
            tone.rgb8(&picture.pixels, &mut codes);
            image(picture, codes.into_flattened())
        };
        let (r, x) = (codes(&pair.reference().picture)?, codes(pair.picture())?);
        ldr_flip(&r, &x, DEFAULT_PPD).map(Flip).map_err(words)
    }

    /// Of the radiance itself. There is no answer for pictures with NaN or infinity in them, nor
    /// for a black reference, which says nothing about exposures.
    pub fn hdr(pair: &Pair) -> Result<Flip, String> {
        let radiance = |picture: &Picture| image(picture, picture.pixels.as_flattened().to_vec());
        let (r, x) = (radiance(&pair.reference().picture)?, radiance(pair.picture())?);
        let mut options = HdrOptions::default();
        options.return_exposure_map = false;
        hdr_flip(&r, &x, options).map(|result| Flip(result.error_map)).map_err(words)
    }

    /// Mean over pixels, from 0, no difference to be seen, to 1, black against white.
    pub fn mean(&self) -> f64 {
        let pixels = self.0.pixels();
        pixels.iter().map(|&e| f64::from(e)).sum::<f64>() / pixels.len() as f64
    }

    /// The map in false colours, from black, where nothing is seen, over violet and orange to a
    /// pale yellow at 1 (the palette "magma"), as linear radiance for [`Tone::default`].
    pub fn false_colour(&self) -> Result<Picture, String> {
        let colours = self.0.colorize().map_err(words)?;
        let (pixels, _) = colours.pixels().as_chunks();
        Ok(Picture {
            width: colours.width() as u32,
            height: colours.height() as u32,
            pixels: pixels.iter().map(|p| p.map(linear)).collect(),
        })
    }
}

fn image<T>(picture: &Picture, channels: Vec<T>) -> Result<RgbImage<T>, String> {
    RgbImage::new(picture.width as usize, picture.height as usize, channels).map_err(words)
}

fn words(e: FlipError) -> String {
    e.to_string()
}

/// The inverse of the sRGB transfer curve (IEC 61966-2-1).
fn linear(signal: f32) -> f32 {
    if signal <= 0.04045 { signal / 12.92 } else { ((signal + 0.055) / 1.055).powf(2.4) }
}
