//! What red, green, blue and white of a picture are, and the way from there to Rec. 709.

use std::fmt;

/// Chromaticities x and y of three colours and of their white.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Primaries {
    pub(super) colours: [[f64; 2]; 3],
    pub(super) white: [f64; 2],
}

/// ITU-R BT.709, with D65.
pub(super) const REC_709: Primaries =
    Primaries { colours: [[0.64, 0.33], [0.3, 0.6], [0.15, 0.06]], white: [0.3127, 0.329] };

/// Files give three or four digits, and some give D65 by other digits than the standard.
const SAME: f64 = 5e-4;

/// Rows of a linear map.
#[derive(Clone, Copy, Debug)]
pub(super) struct Matrix([[f64; 3]; 3]);

/// XYZ to the responses of the eye's cones by Bradford, in which whites are adapted.
const BRADFORD: Matrix =
    Matrix([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]]);

impl Matrix {
    /// A colour through it.
    pub(super) fn of(&self, rgb: [f32; 3]) -> [f32; 3] {
        self.apply(rgb.map(f64::from)).map(|x| x as f32)
    }

    fn apply(&self, v: [f64; 3]) -> [f64; 3] {
        self.0.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
    }

    fn column(&self, i: usize) -> [f64; 3] {
        self.0.map(|row| row[i])
    }

    fn from_columns(columns: [[f64; 3]; 3]) -> Matrix {
        Matrix([0, 1, 2].map(|row| columns.map(|column| column[row])))
    }

    fn after(&self, first: &Matrix) -> Matrix {
        Matrix::from_columns([0, 1, 2].map(|i| self.apply(first.column(i))))
    }

    fn diagonal(v: [f64; 3]) -> Matrix {
        Matrix([[v[0], 0.0, 0.0], [0.0, v[1], 0.0], [0.0, 0.0, v[2]]])
    }

    fn inverse(&self) -> Option<Matrix> {
        let [a, b, c] = [0, 1, 2].map(|i| self.column(i));
        let cross = |u: [f64; 3], v: [f64; 3]| {
            [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
        };
        let rows = [cross(b, c), cross(c, a), cross(a, b)];
        let volume = a[0] * rows[0][0] + a[1] * rows[0][1] + a[2] * rows[0][2];
        let inverse = Matrix(rows.map(|row| row.map(|x| x / volume)));
        let good = volume.abs() > 1e-6 && inverse.0.as_flattened().iter().all(|x| x.is_finite());
        good.then_some(inverse)
    }
}

impl Primaries {
    /// The same but for the digits that files leave out.
    pub(super) fn is(&self, other: &Primaries) -> bool {
        let points = |p: &Primaries| [p.colours[0], p.colours[1], p.colours[2], p.white];
        let pairs = points(self).into_iter().zip(points(other));
        pairs.into_iter().all(|(a, b)| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= SAME))
    }

    /// XYZ of white, whose Y is 1.
    fn white_xyz(&self) -> Option<[f64; 3]> {
        let [x, y] = self.white;
        (y > 1e-6).then(|| [x / y, 1.0, (1.0 - x - y) / y])
    }

    /// From red, green and blue to XYZ: 1 1 1 becomes white.
    fn to_xyz(self) -> Option<Matrix> {
        let colours = Matrix::from_columns(self.colours.map(|[x, y]| [x, y, 1.0 - x - y]));
        let shares = colours.inverse()?.apply(self.white_xyz()?);
        Some(colours.after(&Matrix::diagonal(shares)))
    }

    /// The map to Rec. 709, in which white stays white; `None` where these are no colours.
    pub(super) fn to_rec_709(self) -> Option<Matrix> {
        let cones = |p: &Primaries| p.white_xyz().map(|white| BRADFORD.apply(white));
        let (from, to) = (cones(&self)?, cones(&REC_709)?);
        let adapt = Matrix::diagonal([0, 1, 2].map(|i| to[i] / from[i]));
        let adapt = BRADFORD.inverse()?.after(&adapt).after(&BRADFORD);
        let map = REC_709.to_xyz()?.inverse()?.after(&adapt).after(&self.to_xyz()?);
        map.0.as_flattened().iter().all(|x| x.is_finite()).then_some(map)
    }
}

impl fmt::Display for Primaries {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let [[rx, ry], [gx, gy], [bx, by]] = self.colours.map(|p| p.map(digits));
        let [x, y] = self.white.map(digits);
        write!(f, "red {rx} {ry}, green {gx} {gy}, blue {bx} {by}, white {x} {y}")
    }
}

/// Files hold single precision: its noise is not shown.
fn digits(x: f64) -> f64 {
    (x * 1e5).round() / 1e5
}

#[cfg(test)]
mod tests {
    use super::*;

    const REC_2020: Primaries = Primaries {
        colours: [[0.708, 0.292], [0.17, 0.797], [0.131, 0.046]],
        white: [0.3127, 0.329],
    };
    const ACES_CG: Primaries = Primaries {
        colours: [[0.713, 0.293], [0.165, 0.83], [0.128, 0.044]],
        white: [0.32168, 0.33767],
    };

    /// BT.2087 publishes the matrix from Rec. 2020; that from ACEScg by Bradford is in the ACES
    /// documents.
    #[test]
    fn the_maps_are_the_published_ones() {
        for (primaries, expected) in [
            (
                REC_2020,
                [
                    [1.6605, -0.5876, -0.0728],
                    [-0.1246, 1.1329, -0.0083],
                    [-0.0182, -0.1006, 1.1187],
                ],
            ),
            (
                ACES_CG,
                [
                    [1.7051, -0.6218, -0.0833],
                    [-0.1302, 1.1408, -0.0106],
                    [-0.0240, -0.1290, 1.1530],
                ],
            ),
        ] {
            let map = primaries.to_rec_709().unwrap();
            for (got, wanted) in map.0.as_flattened().iter().zip(expected.as_flattened()) {
                assert!((got - wanted).abs() < 2e-4, "{map:?}");
            }
            assert!(map.of([1.0; 3]).iter().all(|x| (x - 1.0).abs() < 1e-6), "white stays white");
        }
    }

    #[test]
    fn what_makes_no_colours_has_no_map() {
        let line = [[0.1, 0.1], [0.2, 0.2], [0.3, 0.3]];
        for (colours, white) in [
            (line, REC_709.white),
            (REC_709.colours, [0.3, 0.0]),
            (REC_709.colours, [f64::NAN, 0.3]),
            ([[f64::INFINITY, 0.0]; 3], REC_709.white),
            ([[0.0; 2]; 3], [0.0; 2]),
        ] {
            assert!(Primaries { colours, white }.to_rec_709().is_none(), "{colours:?} {white:?}");
        }
    }
}
