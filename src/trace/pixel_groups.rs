//! Which pixels of a picture are traced side by side in a pass, and which of them share.
//!
//! Pixels are grouped to batches of a fixed number of places. A batch is a rectangle of a grid that
//! lies elsewhere in every pass, cut into groups of neighbours. Before that the pixels are mixed a
//! little, by turning short strips of rows and then of columns: errors within a group are alike, and
//! groups with straight edges would be seen as blocks.
//!
//! All of it follows from seed and pass: who shares with whom can be told for any pixel alone.

use crate::math::simd::U32;
use crate::math::sobol::mix;
use std::ops::Range;

/// Places of a batch, across and down.
const PLACES: [u32; 2] = [32, 16];
/// Places of a part of it: one of the largest groups.
const PART: [u32; 2] = [16, 8];
/// Length of a strip in the first passes, where the groups of a few could be seen, and in all others,
/// where nearer neighbours leave an eighth less of the error. In the first passes strips begin
/// elsewhere in every line as well; doing so in all of them would cost 4 %.
const STRIPS: [u32; 2] = [8, 4];
/// How many passes are the first.
const FIRST_PASSES: u64 = 8;

/// How many paths share what they find.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum ReuseGroup {
    /// Each path for itself.
    #[default]
    None,
    /// 4 x 4 neighbours.
    Sixteen,
    /// 8 x 4 neighbours.
    ThirtyTwo,
    /// 8 x 8 neighbours.
    SixtyFour,
    /// 16 x 8 neighbours.
    OneTwentyEight,
}

impl ReuseGroup {
    /// All of them, the smallest first.
    pub const ALL: [ReuseGroup; 5] = [
        ReuseGroup::None,
        ReuseGroup::Sixteen,
        ReuseGroup::ThirtyTwo,
        ReuseGroup::SixtyFour,
        ReuseGroup::OneTwentyEight,
    ];

    /// How many paths it is.
    pub fn paths(self) -> u32 {
        let [across, down] = self.shape();
        across * down
    }

    /// How many paths it is, as the command line takes it.
    pub fn name(self) -> &'static str {
        match self {
            ReuseGroup::None => "1",
            ReuseGroup::Sixteen => "16",
            ReuseGroup::ThirtyTwo => "32",
            ReuseGroup::SixtyFour => "64",
            ReuseGroup::OneTwentyEight => "128",
        }
    }

    fn shape(self) -> [u32; 2] {
        match self {
            ReuseGroup::None => [1, 1],
            ReuseGroup::Sixteen => [4, 4],
            ReuseGroup::ThirtyTwo => [8, 4],
            ReuseGroup::SixtyFour => [8, 8],
            ReuseGroup::OneTwentyEight => [16, 8],
        }
    }
}

/// The grouping of the pixels of one pass.
#[derive(Clone, Copy, Debug)]
pub struct PixelGrouping {
    size: [u32; 2],
    group: ReuseGroup,
    /// Where the grid's first batch begins, before the picture's corner.
    offset: [u32; 2],
    /// How long strips are, and where the first ones begin if that is not by line.
    strip: u32,
    strips: Option<[u32; 2]>,
    salt: u32,
}

/// The pixels of a batch.
#[derive(Clone, Debug, Default)]
pub struct PixelBatch {
    /// Columns and rows from the top left.
    pub pixels: Vec<[u32; 2]>,
    /// Where each group of them ends; nothing where no pixels share.
    pub ends: Vec<u32>,
    /// Where the pixels of each pass end, and the passes; nothing where all are of one that is told
    /// otherwise. No group is of two passes.
    pub passes: Vec<(u32, u64)>,
    /// Which light is wanted.
    pub contribution: Contribution,
}

/// Deals the pixels of a small rectangle by themselves, columns and rows of which are given, into
/// groups that are all of it: adds them to a batch as those of `pass`. The groups are rectangles that
/// lie elsewhere in every pass; what reaches over an edge goes on at the opposite one.
pub fn group_cell(
    [xs, ys]: [Range<u32>; 2],
    seed: u64,
    pass: u64,
    group: ReuseGroup,
    batch: &mut PixelBatch,
) {
    let (roughness, height) = (xs.end - xs.start, ys.end - ys.start);
    let hash = |salt: u32, x: u32| mix(U32(salt ^ x)).0;
    let words = [seed as u32, (seed >> 32) as u32, pass as u32, (pass >> 32) as u32];
    let words = words.into_iter().chain([xs.start, ys.start]);
    let salt = words.fold(0x6365_6c6c, hash);
    let offset = [hash(salt, 1) % roughness.max(1), hash(salt, 2) % height.max(1)];
    // In a narrow rectangle groups are as many pixels, if not as wide.
    let across = group.shape()[0].min(roughness).max(1);
    let down = (group.paths() / across).clamp(1, height.max(1));
    for top in (0..height).step_by(down as usize) {
        for left in (0..roughness).step_by(across as usize) {
            for y in top..(top + down).min(height) {
                for x in left..(left + across).min(roughness) {
                    let (x, y) = ((x + offset[0]) % roughness, (y + offset[1]) % height);
                    batch.pixels.push([xs.start + x, ys.start + y]);
                }
            }
            if group != ReuseGroup::None {
                batch.ends.push(batch.pixels.len() as u32);
            }
        }
    }
    batch.passes.push((batch.pixels.len() as u32, pass));
}

impl PixelBatch {
    /// The group that a pixel of a batch is in, as a batch of its own; the pixel alone if none share.
    pub fn group_of(&self, pixel: [u32; 2]) -> PixelBatch {
        let at = self.pixels.iter().position(|&p| p == pixel).unwrap_or(0);
        let which = self.ends.partition_point(|&end| end as usize <= at);
        let Some(&end) = self.ends.get(which) else {
            return PixelBatch { pixels: vec![pixel], ..PixelBatch::default() };
        };
        let start = which.checked_sub(1).map_or(0, |before| self.ends[before] as usize);
        let pixels = self.pixels[start..end as usize].to_vec();
        PixelBatch { ends: vec![pixels.len() as u32], pixels, ..PixelBatch::default() }
    }

    /// Takes all pixels out.
    pub fn clear(&mut self) {
        self.pixels.clear();
        self.ends.clear();
        self.passes.clear();
    }

    /// Places and their passes: `pass` where it has none of its own.
    pub(super) fn passes(&self, pass: u64) -> impl Iterator<Item = (Range<usize>, u64)> {
        let one = self.passes.is_empty().then_some((self.pixels.len() as u32, pass));
        let mut start = 0;
        self.passes.iter().copied().chain(one).map(move |(end, pass)| {
            let places = start..end as usize;
            start = end as usize;
            (places, pass)
        })
    }
}

/// Light by the way it came.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Contribution {
    /// All of it.
    #[default]
    Whole,
    /// What each path of those that share finds by itself.
    Own,
    /// What comes by way of the points that are shared.
    Shared,
}

impl PixelGrouping {
    /// The grouping in a pass (from 0) of a picture of this size.
    pub fn new(size: [u32; 2], seed: u64, pass: u64, group: ReuseGroup) -> PixelGrouping {
        let hash = |salt: u32, x: u32| mix(U32(salt ^ x)).0;
        let words = [seed as u32, (seed >> 32) as u32, pass as u32, (pass >> 32) as u32];
        let salt = words.into_iter().fold(0x6465_616c, hash);
        let still = group == ReuseGroup::None;
        let draw = |what: u32, below: u32| if still { 0 } else { hash(salt, what) % below };
        let late = pass >= FIRST_PASSES;
        let strip = STRIPS[usize::from(late)];
        PixelGrouping {
            size,
            group,
            offset: [draw(1, PLACES[0]), draw(2, PLACES[1])],
            strip,
            strips: late.then(|| [draw(3, strip), draw(4, strip)]),
            salt,
        }
    }

    /// Columns and rows of batches.
    pub fn batches(&self) -> [u32; 2] {
        [0, 1].map(|axis| (self.size[axis] + self.offset[axis]).div_ceil(PLACES[axis]))
    }

    /// The rows of batches that hold all pixels of these rows of the picture.
    pub fn batch_rows(&self, rows: Range<u32>) -> Range<u32> {
        let place = |y: u32| (y + self.offset[1]) / PLACES[1];
        let last = (rows.end + self.strip - 2).min(self.size[1] - 1);
        place(rows.start.saturating_sub(self.strip - 1))..place(last) + 1
    }

    /// The pixels of the batch in this column and row. Every pixel is in one batch.
    pub fn batch(&self, at: [u32; 2], batch: &mut PixelBatch) {
        self.fill(at, PLACES, batch);
    }

    /// A quarter of that batch, which is whole groups of any size: away from the picture's edges the same
    /// pixels for all of them.
    pub fn part_of_batch(&self, at: [u32; 2], batch: &mut PixelBatch) {
        self.fill(at, PART, batch);
    }

    /// The pixels in the first places of a batch, across and down.
    fn fill(&self, at: [u32; 2], places: [u32; 2], batch: &mut PixelBatch) {
        batch.clear();
        let [across, down] = self.group.shape();
        if self.group == ReuseGroup::None {
            let [xs, ys] =
                [0, 1].map(|axis| self.range(axis, at[axis] * PLACES[axis], places[axis]));
            batch.pixels.extend(ys.flat_map(|y| xs.clone().map(move |x| [x, y])));
            return;
        }
        for top in (0..places[1]).step_by(down as usize) {
            for left in (0..places[0]).step_by(across as usize) {
                let xs = self.range(0, at[0] * PLACES[0] + left, across);
                let ys = self.range(1, at[1] * PLACES[1] + top, down);
                for y in ys {
                    batch.pixels.extend(xs.clone().map(|x| self.pixel([x, y])));
                }
                let end = batch.pixels.len() as u32;
                if batch.ends.last().copied().unwrap_or(0) < end {
                    batch.ends.push(end);
                }
            }
        }
    }

    /// Where a pixel's batch is.
    pub fn batch_of(&self, pixel: [u32; 2]) -> [u32; 2] {
        let place = self.place(pixel);
        [0, 1].map(|axis| (place[axis] + self.offset[axis]) / PLACES[axis])
    }

    /// The pixels that this one, which must be in the picture, shares with.
    pub fn group_of(&self, pixel: [u32; 2]) -> PixelBatch {
        if self.group == ReuseGroup::None {
            return PixelBatch { pixels: vec![pixel], ..PixelBatch::default() };
        }
        let mut batch = PixelBatch::default();
        self.batch(self.batch_of(pixel), &mut batch);
        batch.group_of(pixel)
    }

    /// Columns or rows of the picture that some of the grid are.
    fn range(&self, axis: usize, start: u32, length: u32) -> Range<u32> {
        let inside = |at: u32| at.saturating_sub(self.offset[axis]).min(self.size[axis]);
        inside(start)..inside(start + length)
    }

    /// Where a pixel comes to lie.
    fn place(&self, [x, y]: [u32; 2]) -> [u32; 2] {
        if self.group == ReuseGroup::None {
            return [x, y];
        }
        let x = self.turned(0, x, y, false);
        [x, self.turned(1, y, x, false)]
    }

    /// The pixel that comes to lie here.
    fn pixel(&self, [x, y]: [u32; 2]) -> [u32; 2] {
        let y = self.turned(1, y, x, true);
        [self.turned(0, x, y, true), y]
    }

    /// A coordinate along an axis after its strip was turned by as much as strip and line say.
    #[inline(always)]
    fn turned(&self, axis: usize, along: u32, line: u32, back: bool) -> u32 {
        let of_line = mix(U32(self.salt ^ (axis as u32) << 31 ^ line)).0;
        let before = self.strips.map_or(of_line % self.strip, |strips| strips[axis]);
        let strip = (along + before) / self.strip;
        let start = (strip * self.strip).saturating_sub(before);
        let end = ((strip + 1) * self.strip - before).min(self.size[axis]);
        let length = end - start;
        let number = mix(U32(of_line ^ strip << 16)).0;
        let by = ((u64::from(number) * u64::from(length)) >> 32) as u32;
        let turn = along - start + if back { length - by } else { by };
        start + if turn >= length { turn - length } else { turn }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZES: [[u32; 2]; 6] = [[1, 1], [3, 70], [33, 17], [64, 48], [100, 31], [257, 129]];

    #[test]
    fn every_pixel_is_dealt_once_and_found_again() {
        for size in SIZES {
            for group in ReuseGroup::ALL {
                for pass in [0, 7, 8, 31] {
                    let grouping = PixelGrouping::new(size, 5, pass, group);
                    let mut seen = vec![0; (size[0] * size[1]) as usize];
                    let [columns, rows] = grouping.batches();
                    let mut batch = PixelBatch::default();
                    for at in (0..rows).flat_map(|y| (0..columns).map(move |x| [x, y])) {
                        grouping.batch(at, &mut batch);
                        assert!(batch.pixels.len() <= 512);
                        for &[x, y] in &batch.pixels {
                            seen[(y * size[0] + x) as usize] += 1;
                            assert_eq!(grouping.batch_of([x, y]), at);
                            assert!(grouping.batch_rows(y..y + 1).contains(&at[1]));
                        }
                        let ends: Vec<u32> = std::iter::once(0).chain(batch.ends.clone()).collect();
                        for group_ends in ends.windows(2) {
                            let members = group_ends[1] - group_ends[0];
                            assert!(members > 0 && members <= group.paths());
                        }
                        if group != ReuseGroup::None && !batch.pixels.is_empty() {
                            assert_eq!(*batch.ends.last().unwrap() as usize, batch.pixels.len());
                        }
                    }
                    assert!(seen.iter().all(|&n| n == 1), "{size:?} {group:?}");
                }
            }
        }
    }

    /// What the sizes of groups are compared by.
    #[test]
    fn a_part_of_a_batch_is_the_same_pixels_in_whole_groups_of_any_size() {
        for (seed, pass, at) in [(5, 1 << 40, [1, 1]), (9, 3, [6, 5]), (77, 8, [3, 2])] {
            let part = |group: ReuseGroup| {
                let grouping = PixelGrouping::new([257, 129], seed, pass, group);
                let mut batch = PixelBatch::default();
                grouping.part_of_batch(at, &mut batch);
                let starts = std::iter::once(0).chain(batch.ends.iter().copied());
                for (start, end) in starts.zip(batch.ends.iter().copied()) {
                    assert_eq!(end - start, group.paths());
                }
                for &pixel in &batch.pixels {
                    assert_eq!(grouping.batch_of(pixel), at);
                }
                batch.pixels.sort_unstable();
                batch.pixels
            };
            let sizes: Vec<_> = ReuseGroup::ALL.into_iter().skip(1).map(part).collect();
            assert_eq!(sizes[0].len(), 128);
            assert!(sizes.iter().all(|pixels| *pixels == sizes[0]));
        }
    }

    /// While groups could be seen no line is an edge of many of them: of the 400 pairs of touching
    /// pixels across each, the share that is apart exceeds the mean by less than 0.25.
    #[test]
    fn groups_have_no_straight_edges_while_they_could_be_seen() {
        let size = [400; 2];
        let (lines, along) = (100..300, 0..400);
        for group in ReuseGroup::ALL.into_iter().skip(1) {
            for pass in 0..FIRST_PASSES {
                let grouping = PixelGrouping::new(size, 1, pass, group);
                let group_of = |pixel| {
                    let (place, shape) = (grouping.place(pixel), group.shape());
                    [0, 1].map(|axis| (place[axis] + grouping.offset[axis]) / shape[axis])
                };
                for axis in 0..2 {
                    let at = |line, k| if axis == 0 { [line, k] } else { [k, line] };
                    let apart = |line: u32| {
                        let differ = |&k: &u32| group_of(at(line, k)) != group_of(at(line + 1, k));
                        along.clone().filter(differ).count() as f64 / 400.0
                    };
                    let shares: Vec<f64> = lines.clone().map(apart).collect();
                    let mean = shares.iter().sum::<f64>() / shares.len() as f64;
                    let most = shares.into_iter().fold(0.0, f64::max);
                    assert!(most - mean < 0.25, "{group:?} {pass} {axis}: {mean} {most}");
                }
            }
        }
    }

    /// Over many passes a pair of touching pixels shares about as often wherever it lies: no edge of
    /// a block stands still. The standard deviation of a share p over n passes is at most
    /// 0.5 / sqrt n; 5 of them over some three hundred pairs.
    #[test]
    fn groups_leave_no_pattern_behind() {
        let size = [64, 48];
        let passes = 2000;
        for group in ReuseGroup::ALL.into_iter().skip(1) {
            let mut together = vec![0u32; (size[0] * size[1]) as usize];
            let mut of = vec![0u32; together.len()];
            let mut batch = PixelBatch::default();
            for pass in 0..passes {
                let grouping = PixelGrouping::new(size, 1, pass, group);
                let [columns, rows] = grouping.batches();
                let mut number = 0;
                for at in (0..rows).flat_map(|y| (0..columns).map(move |x| [x, y])) {
                    grouping.batch(at, &mut batch);
                    let mut start = 0;
                    for &end in &batch.ends {
                        for [x, y] in &batch.pixels[start..end as usize] {
                            of[(y * size[0] + x) as usize] = number;
                        }
                        (start, number) = (end as usize, number + 1);
                    }
                }
                for i in 0..together.len() - 1 {
                    together[i] += u32::from(of[i] == of[i + 1]);
                }
            }
            // Columns and rows away from the picture's edge.
            let shares: Vec<f64> = (20..44)
                .flat_map(|x| (12..36).step_by(3).map(move |y| y * 64 + x))
                .map(|i| f64::from(together[i]) / passes as f64)
                .collect();
            let mean = shares.iter().sum::<f64>() / shares.len() as f64;
            let bound = 5.0 * 0.5 / (passes as f64).sqrt();
            assert!(shares.iter().all(|s| (s - mean).abs() < bound), "{group:?} {mean} {shares:?}");
            assert!(mean > 0.3, "neighbours share: {mean}");
        }
    }
}
