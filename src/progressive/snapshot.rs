//! What the workers hand out.

use crate::film::{CELL, ErrorEstimate};
use crate::picture::Picture;
use crate::trace::ReuseGroup;
use std::sync::Arc;

/// Side of a tile in pixels. Tiles on the right and bottom edge may be smaller.
pub const TILE: u32 = 32;

/// The grid of tiles over a picture, row by row from the top left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TileGrid {
    /// Width and height in pixels.
    pub size: [u32; 2],
}

/// A tile's place: pixels `x0..x1` by `y0..y1`, y counted from the top row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TileRect {
    /// First column.
    pub x0: u32,
    /// First row.
    pub y0: u32,
    /// One past the last column.
    pub x1: u32,
    /// One past the last row.
    pub y1: u32,
}

impl TileGrid {
    /// Columns and rows of tiles.
    pub fn columns_rows(&self) -> [u32; 2] {
        self.size.map(|s| s.div_ceil(TILE))
    }
    /// Number of tiles.
    pub fn len(&self) -> usize {
        let [columns, rows] = self.columns_rows();
        columns as usize * rows as usize
    }
    /// True for a picture without pixels.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// Where tile `index` lies.
    pub fn rect(&self, index: usize) -> TileRect {
        let columns = self.columns_rows()[0] as usize;
        let x0 = (index % columns) as u32 * TILE;
        let y0 = (index / columns) as u32 * TILE;
        TileRect { x0, y0, x1: (x0 + TILE).min(self.size[0]), y1: (y0 + TILE).min(self.size[1]) }
    }
}

impl TileRect {
    /// Width in pixels.
    pub fn width(&self) -> usize {
        (self.x1 - self.x0) as usize
    }
    /// Height in pixels.
    pub fn height(&self) -> usize {
        (self.y1 - self.y0) as usize
    }
    /// Number of pixels.
    pub fn area(&self) -> usize {
        self.width() * self.height()
    }
}

/// The picture of one tile at one moment. Never changes once made.
#[derive(Debug, PartialEq)]
pub struct TileImage {
    /// Passes in it; 0 for the coarse preview that stands in until pass 1 is there.
    pub passes: u64,
    /// Samples that each pixel has, by cell of [`CELL`] x [`CELL`] pixels, row by row; empty in the
    /// preview.
    pub samples: Vec<u64>,
    /// Mean radiance of each pixel, row by row within the tile.
    pub mean: Vec<[f32; 3]>,
    /// Standard error of each mean, pooled over touching pixels of the tile; empty before every
    /// replicate has a sample.
    pub standard_error: Vec<[f32; 3]>,
    /// Pixels of a block with one value in the coarse preview; 1 otherwise.
    pub block: u32,
}

impl TileImage {
    /// Bytes of memory that it holds.
    pub(super) fn bytes(&self) -> usize {
        8 * self.samples.capacity() + 12 * (self.mean.capacity() + self.standard_error.capacity())
    }

    /// Samples of the pixel in this column and row of the picture, which lies in this tile of the
    /// grid; 0 in the preview.
    pub fn samples_of(&self, grid: TileGrid, [x, y]: [u32; 2]) -> u64 {
        let columns = grid.columns_rows()[0] as usize;
        let rect = grid.rect((y / TILE) as usize * columns + (x / TILE) as usize);
        let across = rect.width().div_ceil(CELL);
        let cell = [x - rect.x0, y - rect.y0].map(|i| i as usize / CELL);
        self.samples.get(cell[1] * across + cell[0]).copied().unwrap_or(0)
    }
}

/// Counts over the epoch so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Camera paths.
    pub paths: u64,
    /// Rays traced, camera and shadow rays included.
    pub rays: u64,
    /// Samples that were NaN or infinite; they are left out of the sums and their pixels are wrong.
    pub nonfinite: u64,
    /// Paths ended by the safety caps on their length and on their throughput, which has grown beyond
    /// 1e12 where more light leaves surfaces than comes to them.
    pub capped: u64,
}

impl std::ops::Add for Counts {
    type Output = Counts;
    fn add(self, o: Counts) -> Counts {
        Counts {
            paths: self.paths + o.paths,
            rays: self.rays + o.rays,
            nonfinite: self.nonfinite + o.nonfinite,
            capped: self.capped + o.capped,
        }
    }
}

/// What the workers are doing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum State {
    /// Tracing.
    Running,
    /// Stopped by the user; goes on where it stood.
    Paused,
    /// The pass limit is reached.
    Done,
    /// The parameters could not be rendered, or a worker panicked; the text says how to repeat it.
    Failed(String),
}

/// An immutable, complete picture of one epoch, cheap to clone.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// Which change of parameters it belongs to. Nothing of another epoch is in it.
    pub epoch: u64,
    /// Its tiles.
    pub grid: TileGrid,
    /// One image a tile; `None` where nothing has been traced yet.
    pub tiles: Vec<Option<Arc<TileImage>>>,
    /// Tiles that differ from those of the last snapshot that was received.
    pub dirty: Vec<u32>,
    /// Whole passes: pixels have this many samples, each if the passes are
    /// [uniform](super::Params::uniform), else on the mean.
    pub passes: u64,
    /// Whether these are all of the samples: not while a pass is traced.
    pub whole: bool,
    /// Counts over the epoch.
    pub counts: Counts,
    /// Error of the picture, once the replicates allow one.
    pub error: Option<ErrorEstimate>,
    /// How many neighbouring paths share what they find.
    pub group: ReuseGroup,
    /// Seconds spent tracing in this epoch.
    pub seconds: f64,
    /// What the workers are doing.
    pub state: State,
}

impl Snapshot {
    /// The mean radiance as one picture; black where nothing has been traced yet.
    pub fn mean(&self) -> Picture {
        self.gather(|tile| &tile.mean)
    }

    /// The standard error of every pixel and channel as one picture; zero where not known yet.
    pub fn standard_error(&self) -> Picture {
        self.gather(|tile| &tile.standard_error)
    }

    /// Samples of every pixel, row by row; 0 where nothing has been traced yet.
    pub fn samples(&self) -> Vec<u64> {
        let width = self.grid.size[0] as usize;
        let mut samples = vec![0; width * self.grid.size[1] as usize];
        for (index, tile) in self.tiles.iter().enumerate() {
            let rect = self.grid.rect(index);
            let across = rect.width().div_ceil(CELL);
            let Some(tile) = tile.as_deref().filter(|tile| !tile.samples.is_empty()) else {
                continue;
            };
            for y in 0..rect.height() {
                let start = (rect.y0 as usize + y) * width + rect.x0 as usize;
                let row = &tile.samples[y / CELL * across..];
                for (x, place) in samples[start..start + rect.width()].iter_mut().enumerate() {
                    *place = row[x / CELL];
                }
            }
        }
        samples
    }

    fn gather(&self, pixels: impl Fn(&TileImage) -> &Vec<[f32; 3]>) -> Picture {
        let [width, height] = self.grid.size;
        let mut picture = Picture::black(width, height);
        for (index, tile) in self.tiles.iter().enumerate() {
            let Some(source) = tile.as_deref().map(&pixels).filter(|p| !p.is_empty()) else {
                continue;
            };
            let rect = self.grid.rect(index);
            for (row, line) in source.chunks_exact(rect.width()).enumerate() {
                let start = (rect.y0 as usize + row) * width as usize + rect.x0 as usize;
                picture.pixels[start..start + rect.width()].copy_from_slice(line);
            }
        }
        picture
    }
}
