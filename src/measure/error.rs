//! Error measures between a picture and a reference, each with its formula.
//!
//! `x` is the picture, `r` the reference and `s` the reference's standard error, 0 where it is not
//! known; means run over pixels and channels. A reference that was itself rendered is wrong by its
//! own noise, `E|x - r|² = Var x + Var r`, so `s²` is subtracted wherever a square is summed. What
//! is left can be negative: then the reference is too noisy for this picture, and says so by a NaN
//! where a root is asked for.
//!
//! A pixel that is not finite in any channel of either picture is left out and counted.

use crate::film::{REL_MSE_FLOOR, student};
use crate::picture::Picture;
use thiserror::Error;

/// A measure: one number about two pictures, with all that a table needs to print it.
#[derive(Clone, Copy, Debug)]
pub struct Measure {
    /// What people call it.
    pub name: &'static str,
    /// What a table's column is called: a word of lower-case letters, digits and `_`.
    pub column: &'static str,
    /// How it is computed, in plain text.
    pub formula: &'static str,
    compute: fn(&Pair) -> f64,
}

/// Mean squared error: what the few brightest pixels make of it.
pub const MSE: Measure = Measure {
    name: "MSE",
    column: "mse",
    formula: "mean((x - r)^2 - s^2)",
    compute: |pair| pair.mean(squared),
};

/// [`MSE`] without its largest pixels, in which one bright path can outweigh all others.
pub const MSE_TRIMMED: Measure = Measure {
    name: "MSE of 99.9 %",
    column: "mse_trimmed",
    formula: "MSE without the 0.1 % of pixels that add most",
    compute: |pair| pair.trimmed_mean(squared),
};

/// Relative squared error as most papers and renderers have it, its floor fixed in W/(m² sr):
/// made for scenes whose radiance is about 1.
pub const REL_MSE: Measure = Measure {
    name: "relMSE",
    column: "rel_mse",
    formula: "mean(((x - r)^2 - s^2) / (r^2 + 0.01))",
    compute: |pair| pair.mean(relative_squared),
};

/// [`REL_MSE`] without its largest pixels.
pub const REL_MSE_TRIMMED: Measure = Measure {
    name: "relMSE of 99.9 %",
    column: "rel_mse_trimmed",
    formula: "relMSE without the 0.1 % of pixels that add most",
    compute: |pair| pair.trimmed_mean(relative_squared),
};

/// The root of [`REL_MSE`]: about what "so many per cent wrong" means. NaN where the reference's
/// noise is the larger.
pub const REL_RMSE: Measure = Measure {
    name: "relative RMSE",
    column: "rel_rmse",
    formula: "sqrt(relMSE)",
    compute: |pair| (REL_MSE.compute)(pair).sqrt(),
};

/// [`REL_MSE`] with a floor that follows the scene's brightness: the same for a scene a thousand
/// times as bright. Another number than relMSE, so it has another name.
pub const SCALE_FREE: Measure = Measure {
    name: "scale-free MSE",
    column: "scale_free_mse",
    formula: "mean(((x - r)^2 - s^2) / (r^2 + 0.01 mean(r)^2))",
    compute: |pair| {
        let floor = 0.01 * pair.mean_reference().powi(2);
        // A black reference has no scale.
        pair.mean(|v| squared(v) / (v.r * v.r + floor))
    },
};

/// Symmetric relative error, within 0..=1 and thus deaf to how bright a bright pixel is. Contains
/// the noise of both pictures.
pub const SMAPE: Measure = Measure {
    name: "SMAPE",
    column: "smape",
    formula: "mean(|x - r| / (|x| + |r| + 0.01))",
    compute: |pair| pair.mean(|v| (v.x - v.r).abs() / (v.x.abs() + v.r.abs() + REL_MSE_FLOOR)),
};

/// Signed error: a picture that is noisy but right has 0 within [`Pair::mean_error_margin`].
pub const MEAN_ERROR: Measure = Measure {
    name: "mean error",
    column: "mean_error",
    formula: "mean(x - r)",
    compute: |pair| pair.mean(|v| v.x - v.r),
};

/// [`MEAN_ERROR`] as a share of the reference's mean. NaN or infinite where that is 0.
pub const REL_MEAN_ERROR: Measure = Measure {
    name: "relative mean error",
    column: "rel_mean_error",
    formula: "mean(x - r) / mean(r)",
    compute: |pair| (MEAN_ERROR.compute)(pair) / pair.mean_reference(),
};

/// What [`REL_MSE`] has had subtracted: below this a picture cannot be told from the reference.
pub const REFERENCE_NOISE: Measure = Measure {
    name: "reference's own relMSE",
    column: "reference_noise",
    formula: "mean(s^2 / (r^2 + 0.01)), subtracted above",
    compute: |pair| pair.mean(|v| v.s * v.s / (v.r * v.r + REL_MSE_FLOOR)),
};

/// All of them, in the order in which tables have them.
pub const ALL: [Measure; 10] = [
    MSE,
    MSE_TRIMMED,
    REL_MSE,
    REL_MSE_TRIMMED,
    REL_RMSE,
    SCALE_FREE,
    SMAPE,
    MEAN_ERROR,
    REL_MEAN_ERROR,
    REFERENCE_NOISE,
];

fn squared(v: Value) -> f64 {
    (v.x - v.r).powi(2) - v.s * v.s
}

fn relative_squared(v: Value) -> f64 {
    squared(v) / (v.r * v.r + REL_MSE_FLOOR)
}

impl Measure {
    /// Its value.
    pub fn of(&self, pair: &Pair) -> f64 {
        (self.compute)(pair)
    }
}

/// What pictures are held against.
#[derive(Clone, Debug)]
pub struct Reference {
    /// The radiance held to be right.
    pub picture: Picture,
    /// The standard error of each of its values; `None` where it has none, or none is known.
    pub standard_error: Option<Picture>,
}

impl Reference {
    /// The same radiance everywhere, exactly: a furnace.
    pub fn exact([width, height]: [u32; 2], radiance: [f32; 3]) -> Reference {
        let mut picture = Picture::black(width, height);
        picture.pixels.fill(radiance);
        Reference { picture, standard_error: None }
    }

    /// A picture of which nothing more is known.
    pub fn known(picture: Picture) -> Reference {
        Reference { picture, standard_error: None }
    }

    /// The mean of two pictures of equal cost whose noise is independent. Half their difference is
    /// the standard error of each value, of one degree of freedom: useless for a pixel by itself,
    /// and just right for a mean over many.
    pub fn halves(a: &Picture, b: &Picture) -> Result<Reference, PairError> {
        let size = |p: &Picture| [p.width, p.height];
        if size(a) != size(b) {
            return Err(PairError::Size { picture: size(a), reference: size(b) });
        }
        let both = |f: fn(f32, f32) -> f32| {
            let values = |(a, b): (&[f32; 3], &[f32; 3])| std::array::from_fn(|c| f(a[c], b[c]));
            Picture { pixels: a.pixels.iter().zip(&b.pixels).map(values).collect(), ..*a }
        };
        let standard_error = Some(both(|a, b| 0.5 * (a - b).abs()));
        Ok(Reference { picture: both(|a, b| 0.5 * (a + b)), standard_error })
    }

    /// The standard error of its mean over pixels and channels, as a share of that mean; 0 where
    /// none is known. Pixels are independent; the channels of a pixel are taken to err alike, which
    /// is never too little.
    pub fn relative_error_of_mean(&self) -> f64 {
        let Some(errors) = &self.standard_error else { return 0.0 };
        let sum = |pixel: &[f32; 3]| pixel.iter().map(|&c| f64::from(c)).sum::<f64>();
        let squares: f64 = errors.pixels.iter().map(|s| sum(s).powi(2)).sum();
        squares.sqrt() / self.picture.pixels.iter().map(sum).sum::<f64>()
    }
}

/// Pictures that cannot be compared.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum PairError {
    /// Their sizes differ.
    #[error(
        "the picture has {}x{} pixels, the reference {}x{}: only pictures of one size can be \
         compared", .picture[0], .picture[1], .reference[0], .reference[1]
    )]
    Size {
        /// Width and height of the picture.
        picture: [u32; 2],
        /// Width and height of the reference.
        reference: [u32; 2],
    },
    /// The pixels of a picture are not as many as its sides say.
    #[error("{pixels} pixels do not make a picture of {}x{}", .size[0], .size[1])]
    Pixels {
        /// Width and height.
        size: [u32; 2],
        /// Pixels given.
        pixels: usize,
    },
    /// Nothing is left to compare.
    #[error("no pixel is finite in both pictures: there is nothing to compare")]
    Nothing,
}

/// A picture beside its reference: of one size, and not without finite pixels.
#[derive(Clone, Copy, Debug)]
pub struct Pair<'a> {
    picture: &'a Picture,
    reference: &'a Reference,
    finite: usize,
}

/// One channel of one pixel.
#[derive(Clone, Copy)]
struct Value {
    x: f64,
    r: f64,
    s: f64,
}

impl<'a> Pair<'a> {
    /// Checks that the two can be compared.
    pub fn new(picture: &'a Picture, reference: &'a Reference) -> Result<Pair<'a>, PairError> {
        let size = |p: &Picture| [p.width, p.height];
        let expected = size(&reference.picture);
        for other in [Some(picture), reference.standard_error.as_ref()].into_iter().flatten() {
            if size(other) != expected {
                return Err(PairError::Size { picture: size(other), reference: expected });
            }
        }
        let parts = [Some(picture), Some(&reference.picture), reference.standard_error.as_ref()];
        for part in parts.into_iter().flatten() {
            let pixels = part.pixels.len();
            if pixels as u64 != u64::from(part.width) * u64::from(part.height) {
                return Err(PairError::Pixels { size: size(part), pixels });
            }
        }
        let mut pair = Pair { picture, reference, finite: 0 };
        pair.finite = (0..picture.pixels.len()).filter(|&i| pair.pixel(i).is_some()).count();
        if pair.finite == 0 { Err(PairError::Nothing) } else { Ok(pair) }
    }

    /// The picture.
    pub fn picture(&self) -> &'a Picture {
        self.picture
    }

    /// What it is held against.
    pub fn reference(&self) -> &'a Reference {
        self.reference
    }

    /// Pixels left out because a channel of either is NaN or infinite.
    pub fn left_out(&self) -> usize {
        self.picture.pixels.len() - self.finite
    }

    /// Half the width of the 95 % interval about [`MEAN_ERROR`], from the spread of the mean errors
    /// of 8x8 blocks; `None` for a picture of fewer than two blocks.
    ///
    /// Of a mere pair of pictures nothing tells how the noise of one pixel depends on the next:
    /// filters wider than a pixel and denoisers tie them together. Blocks are wide against either,
    /// and means of many pixels are nearly normal, so Student's t of 63 degrees of freedom fits. If
    /// the error differs by place, that adds to the spread: the interval is too wide rather than
    /// too narrow. Where several independent renders are to be had, their spread is the better
    /// answer.
    pub fn mean_error_margin(&self) -> Option<f64> {
        mean_margin(&self.block_errors())
    }

    /// The mean of x - r in each block of a grid of at most 8 by 8.
    fn block_errors(&self) -> Vec<f64> {
        let [width, height] = [self.picture.width as usize, self.picture.height as usize];
        let [columns, rows] = [width.min(BLOCKS), height.min(BLOCKS)];
        let mut sums = vec![[0.0, 0.0]; columns * rows];
        for index in 0..self.picture.pixels.len() {
            let Some(values) = self.pixel(index) else { continue };
            let [x, y] = [index % width, index / width];
            let sum = &mut sums[y * rows / height * columns + x * columns / width];
            sum[0] += values.iter().map(|v| v.x - v.r).sum::<f64>() / 3.0;
            sum[1] += 1.0;
        }
        sums.into_iter().filter(|[_, n]| *n > 0.0).map(|[sum, n]| sum / n).collect()
    }

    /// The three channels of a pixel, if all of them are finite.
    fn pixel(&self, index: usize) -> Option<[Value; 3]> {
        let (x, r) = (self.picture.pixels[index], self.reference.picture.pixels[index]);
        let s = self.reference.standard_error.as_ref().map_or([0.0; 3], |s| s.pixels[index]);
        let finite = x.iter().chain(&r).chain(&s).all(|v| v.is_finite());
        let value = |c: usize| Value { x: x[c].into(), r: r[c].into(), s: s[c].into() };
        finite.then(|| [0, 1, 2].map(value))
    }

    /// The mean of the channels' terms, a number a pixel.
    fn terms(&self, term: impl Fn(Value) -> f64) -> impl Iterator<Item = f64> {
        let pixels = (0..self.picture.pixels.len()).filter_map(|i| self.pixel(i));
        pixels.map(move |values| values.into_iter().map(&term).sum::<f64>() / 3.0)
    }

    fn mean(&self, term: impl Fn(Value) -> f64) -> f64 {
        self.terms(term).sum::<f64>() / self.finite as f64
    }

    /// The mean without the pixels of the largest terms: 0.1 % of them, rounded up.
    fn trimmed_mean(&self, term: impl Fn(Value) -> f64) -> f64 {
        let mut terms: Vec<f64> = self.terms(term).collect();
        let kept = terms.len() - terms.len().div_ceil(1000).min(terms.len() - 1);
        terms.sort_unstable_by(f64::total_cmp);
        terms[..kept].iter().sum::<f64>() / kept as f64
    }

    fn mean_reference(&self) -> f64 {
        self.mean(|v| v.r)
    }
}

/// Blocks in each direction.
const BLOCKS: usize = 8;

/// Half the width of the 95 % Student interval about the mean of independent numbers: `t s / sqrt n`
/// with n - 1 degrees of freedom. `None` for fewer than two numbers.
pub fn mean_margin(values: &[f64]) -> Option<f64> {
    if values.len() < 2 {
        return None;
    }
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
    (n > 1.0).then(|| student(n - 1.0) * (squares / (n - 1.0) / n).sqrt())
}
