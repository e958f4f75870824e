//! A picture from a file in the form of one that was traced, so that both are shown in the same way.

use burnish::picture::Picture;
use burnish::progressive::{Counts, Snapshot, State, TileGrid, TileImage};
use burnish::trace::ReuseGroup;
use std::sync::Arc;

/// A snapshot of no passes and no paths: taken as exact.
pub(crate) fn snapshot(picture: &Picture) -> Snapshot {
    let grid = TileGrid { size: [picture.width, picture.height] };
    let tile = |index| {
        let rect = grid.rect(index);
        let row = |y: u32| y as usize * picture.width as usize;
        let lines = (rect.y0..rect.y1).filter_map(|y| {
            picture.pixels.get(row(y) + rect.x0 as usize..row(y) + rect.x1 as usize)
        });
        Some(Arc::new(TileImage {
            passes: 0,
            samples: Vec::new(),
            mean: lines.flatten().copied().collect(),
            standard_error: Vec::new(),
            block: 1,
        }))
    };
    Snapshot {
        epoch: 0,
        grid,
        tiles: (0..grid.len()).map(tile).collect(),
        dirty: Vec::new(),
        passes: 0,
        whole: true,
        counts: Counts::default(),
        error: None,
        seconds: 0.0,
        group: ReuseGroup::None,
        state: State::Done,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_the_mean_of_its_snapshot() {
        let (width, height) = (75, 41);
        let pixels = (0..width * height).map(|i| [i as f32, 0.5 * i as f32, -1.0]).collect();
        let picture = Picture { width, height, pixels };
        assert_eq!(snapshot(&picture).mean(), picture);
    }
}
