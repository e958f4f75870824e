//! A part of a camera's picture.

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// The part of the picture that is taken: from its top left corner, in widths and heights of the whole,
/// of the whole's proportions. Its pixels are those of the picture taken, so that a small part is a
/// magnified one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "[f64; 3]", try_from = "[f64; 3]")]
pub struct Crop {
    x: f64,
    y: f64,
    side: f64,
}

/// A part that is none of the picture.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[error(
    "a crop is X, Y and SIDE in parts of the picture: SIDE from {least} to 1, X and Y from 0 to 1 - SIDE, not \
     {0}, {1}, {2}",
    least = Crop::LEAST
)]
pub struct CropError(f64, f64, f64);

impl Crop {
    /// All of the picture.
    pub const WHOLE: Crop = Crop { x: 0.0, y: 0.0, side: 1.0 };
    /// The smallest side: single precision tells some 5,000 directions apart there.
    pub const LEAST: f64 = 1e-3;

    /// The square of `side` in parts of the whole whose top left corner is at `x`, `y`.
    pub fn new(x: f64, y: f64, side: f64) -> Result<Crop, CropError> {
        let inside = |at: f64| at >= 0.0 && at + side <= 1.0 + 1e-9;
        if !(Crop::LEAST..=1.0).contains(&side) || !inside(x) || !inside(y) {
            return Err(CropError(x, y, side));
        }
        Ok(Crop { x, y, side })
    }

    /// The part of this part, with that of [`Crop::LEAST`] at least.
    pub fn of(self, inner: Crop) -> Crop {
        let side = (self.side * inner.side).max(Crop::LEAST);
        let at = |from: f64, inner: f64| (from + self.side * inner).clamp(0.0, 1.0 - side);
        Crop { x: at(self.x, inner.x), y: at(self.y, inner.y), side }
    }

    /// Column of the left edge, row of the upper one, and the extent, in parts of the whole.
    pub fn parts(self) -> [f64; 3] {
        [self.x, self.y, self.side]
    }

    /// Where its middle is, in -1..=1 to the right and upwards.
    pub(super) fn middle(self) -> [f64; 2] {
        [2.0 * self.x + self.side - 1.0, 1.0 - 2.0 * self.y - self.side]
    }
}

impl Default for Crop {
    fn default() -> Crop {
        Crop::WHOLE
    }
}

impl From<Crop> for [f64; 3] {
    fn from(crop: Crop) -> [f64; 3] {
        crop.parts()
    }
}

impl TryFrom<[f64; 3]> for Crop {
    type Error = CropError;
    fn try_from([x, y, side]: [f64; 3]) -> Result<Crop, CropError> {
        Crop::new(x, y, side)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Camera, CameraRays, Placement};
    use super::*;
    use crate::math::numbers::Numbers;
    use glam::DVec3;

    /// A ray of the part is the ray of the whole through the same place, and a world point is drawn there.
    #[test]
    fn a_part_is_the_same_place_of_the_whole() {
        let mut numbers = Numbers(11);
        for _ in 0..1000 {
            let side = 0.02 + 0.9 * numbers.next();
            let [x, y] = [0, 1].map(|_| (1.0 - side) * numbers.next());
            let mut point = || DVec3::new(numbers.next(), numbers.next(), numbers.next()) - 0.5;
            let (eye, target) = (point() * 4.0, point());
            let whole = Camera::look_at(eye, target, 0.2 + point().x.abs()).unwrap();
            let part = Camera { crop: Crop::new(x, y, side).unwrap(), ..whole };
            let placement = Placement::fitting(DVec3::splat(-1.0), DVec3::splat(1.0));
            let size = [300, 200];
            let at = [300.0 * numbers.next() as f32, 200.0 * numbers.next() as f32];
            let of_whole = [0, 1].map(|i| {
                let size = f64::from(size[i]);
                ([x, y][i] * size + f64::from(at[i]) * side) as f32
            });
            let near = CameraRays::new(&part, placement, size).ray(at[0], at[1]).d;
            let far = CameraRays::new(&whole, placement, size).ray(of_whole[0], of_whole[1]).d;
            assert!((near - far).length() < 3e-6, "{near:?} {far:?}");
            let d = DVec3::new(near.x.into(), near.y.into(), near.z.into());
            let [drawn, _] = part.project(eye + d, eye + d * 2.0, size).unwrap();
            let error = (drawn[0] - f64::from(at[0])).hypot(drawn[1] - f64::from(at[1]));
            assert!(error * side < 2e-3, "{at:?} {drawn:?}");
        }
    }

    #[test]
    fn a_part_of_a_part_is_a_part() {
        let part = Crop::new(0.25, 0.5, 0.5).unwrap();
        assert_eq!(part.of(part).parts(), [0.375, 0.75, 0.25]);
        assert_eq!(Crop::WHOLE.of(part), part);
        let mut smaller = part;
        for _ in 0..30 {
            smaller = smaller.of(Crop::new(0.5, 0.5, 0.5).unwrap());
            let [x, y, side] = smaller.parts();
            assert!(Crop::new(x, y, side).is_ok(), "{smaller:?}");
        }
        for [x, y, side] in [
            [0.0, 0.0, 0.0],
            [0.6, 0.0, 0.5],
            [-0.1, 0.0, 0.5],
            [0.0, f64::NAN, 0.5],
            [0.0, 0.0, 2.0],
        ] {
            assert!(Crop::new(x, y, side).is_err());
        }
    }
}
