//! One sample of one pixel, traced again with those that it shared with.

use super::{Params, choose_group, plan};
use crate::math::Rgb;
use crate::trace::{Contribution, PixelGrouping, ReuseGroup};

/// A pixel's sample of a pass, and the group of pixels that it came from.
#[derive(Clone, Debug, PartialEq)]
pub struct Replay {
    /// How many paths share.
    pub group: ReuseGroup,
    /// Columns and rows of the group's pixels, from the top left; the pixel's alone where none
    /// share. Fewer than the group's size at the picture's edges.
    pub pixels: Vec<[u32; 2]>,
    /// What each of them found, in the same order.
    pub samples: Vec<Sample>,
    /// The pixel's own place among them.
    pub own: usize,
}

/// Radiance of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// As the picture's pixel gets it.
    pub whole: Rgb,
    /// Of that, what came by the points that are shared.
    pub shared: Rgb,
}

impl Replay {
    /// Traces pass `pass` (from 0) of the pixel in column `x`, row `y` from the top, again: the same
    /// bits as in any render of these parameters. `None` for a pixel outside the picture.
    pub fn new(params: &Params, [x, y]: [u32; 2], pass: u64) -> Option<Replay> {
        let [width, height] = params.size;
        if x >= width || y >= height {
            return None;
        }
        let tracer = params.tracer();
        let mut scratch = tracer.scratch();
        let group = choose_group::decide(params, &tracer, &mut scratch);
        let uniform = params.uniform || pass < plan::UNIFORM;
        let mut batch = match uniform {
            true => PixelGrouping::new(params.size, params.seed, pass, group).group_of([x, y]),
            false => plan::group_of(params.size, params.seed, pass, group, [x, y]),
        };
        let mut trace = |part: Contribution| {
            batch.contribution = part;
            tracer.samples_of(&batch, pass, &mut scratch)
        };
        let whole = trace(Contribution::Whole);
        let shared = match group {
            ReuseGroup::None => vec![Rgb::BLACK; whole.len()],
            _ => trace(Contribution::Shared),
        };
        let samples =
            whole.into_iter().zip(shared).map(|(whole, shared)| Sample { whole, shared }).collect();
        let own = batch.pixels.iter().position(|&pixel| pixel == [x, y])?;
        Some(Replay { group, pixels: batch.pixels, samples, own })
    }
}
