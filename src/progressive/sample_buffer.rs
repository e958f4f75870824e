//! Samples of a few passes, between those who trace them and the films that they belong to.
//!
//! Batches of paths lie elsewhere in every pass, films always in the same tiles: so samples are put
//! down here by whoever has traced them, each in a place of its own, and are taken up tile by tile
//! once all are there. Films so add them in the order of the passes, and to the same sums on any
//! number of threads.

use super::TileRect;
use crate::math::Rgb;
use std::sync::atomic::{AtomicU32, Ordering};

/// One colour a pixel and pass.
#[derive(Default)]
pub(super) struct SampleBuffer {
    width: usize,
    pixels: usize,
    samples: Vec<[AtomicU32; 3]>,
}

impl SampleBuffer {
    /// Makes room for some passes of a picture. What was there is of no use any more.
    pub(super) fn prepare(&mut self, size: [u32; 2], passes: usize) {
        let [width, height] = size.map(|s| s as usize);
        (self.width, self.pixels) = (width, width * height);
        let wanted = self.pixels * passes;
        // A smaller picture after a large one gives its memory back, and a larger one takes no more than it needs.
        if self.samples.len() > 4 * wanted || self.samples.len() < wanted {
            self.samples = Vec::new();
            self.samples.reserve_exact(wanted);
            self.samples.resize_with(wanted, Default::default);
        }
    }

    /// Puts down the sample of a pixel of the `pass`th of the passes.
    #[inline]
    pub(super) fn put(&self, pass: usize, [x, y]: [u32; 2], sample: Rgb) {
        let place = &self.samples[pass * self.pixels + y as usize * self.width + x as usize];
        // The threads meet before anyone reads.
        for (place, x) in place.iter().zip(<[f32; 3]>::from(sample)) {
            place.store(x.to_bits(), Ordering::Relaxed);
        }
    }

    /// The samples of a tile in the `pass`th of the passes, row by row.
    pub(super) fn tile(&self, pass: usize, tile: TileRect) -> impl Iterator<Item = Rgb> {
        let start = pass * self.pixels;
        (tile.y0..tile.y1).flat_map(move |y| {
            let row = start + y as usize * self.width;
            let places = &self.samples[row + tile.x0 as usize..row + tile.x1 as usize];
            places.iter().map(|p| {
                let [r, g, b] = [0, 1, 2].map(|c: usize| p[c].load(Ordering::Relaxed));
                Rgb::new(f32::from_bits(r), f32::from_bits(g), f32::from_bits(b))
            })
        })
    }

    /// The sample of one pixel in the first of the passes.
    pub(super) fn at(&self, [x, y]: [u32; 2]) -> Rgb {
        let p = &self.samples[y as usize * self.width + x as usize];
        let [r, g, b] = [0, 1, 2].map(|c: usize| f32::from_bits(p[c].load(Ordering::Relaxed)));
        Rgb::new(r, g, b)
    }
}
