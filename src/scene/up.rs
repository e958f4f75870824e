//! Which axis of a model's file points up, and the turn that stands it upright.
//!
//! Scenes are Z up. Model files do not say what they are: OBJ files are Y up by custom, PLY files of
//! some programs Z up, of others Y up. So the axis is guessed by the model's foot, told, and a reader's
//! [`ReadOptions`](super::read::ReadOptions) choose another.

use super::Mesh;
use glam::{DQuat, DVec3};

/// A direction along an axis of a file's coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Axis {
    /// Along +X.
    X,
    /// Along +Y.
    Y,
    /// Along +Z.
    Z,
    /// Along -X.
    NegX,
    /// Along -Y.
    NegY,
    /// Along -Z.
    NegZ,
}

/// Vertices count as foot up to this part of the height above the lowest.
const FOOT: f64 = 0.01;
/// A model stands on the axis that is not its format's custom if its foot is this many times as large.
const CLEARLY: f64 = 2.0;

impl Axis {
    /// All of them.
    pub const ALL: [Axis; 6] = [Axis::X, Axis::Y, Axis::Z, Axis::NegX, Axis::NegY, Axis::NegZ];

    /// As the command line takes it: `x`, `y`, `z`, `-x`, `-y`, `-z`.
    pub fn name(self) -> &'static str {
        match self {
            Axis::X => "x",
            Axis::Y => "y",
            Axis::Z => "z",
            Axis::NegX => "-x",
            Axis::NegY => "-y",
            Axis::NegZ => "-z",
        }
    }

    /// The one of this name.
    pub fn named(name: &str) -> Option<Axis> {
        Self::ALL.into_iter().find(|axis| axis.name() == name)
    }

    /// The rotation that takes this direction to +Z, as an ORIENT of the `.scn` format.
    pub fn orient(self) -> &'static str {
        match self {
            Axis::X => "y -90",
            Axis::Y => "x 90",
            Axis::Z => "",
            Axis::NegX => "y 90",
            Axis::NegY => "x -90",
            Axis::NegZ => "x 180",
        }
    }

    /// The same rotation; the bits are those that [`Axis::orient`] reads to.
    pub fn rotation(self) -> DQuat {
        match self {
            Axis::X => DQuat::from_rotation_y((-90f64).to_radians()),
            Axis::Y => DQuat::from_rotation_x(90f64.to_radians()),
            Axis::Z => DQuat::IDENTITY,
            Axis::NegX => DQuat::from_rotation_y(90f64.to_radians()),
            Axis::NegY => DQuat::from_rotation_x((-90f64).to_radians()),
            Axis::NegZ => DQuat::from_rotation_x(180f64.to_radians()),
        }
    }

    /// +Y or +Z, whichever the model has the larger foot for: its format's `custom`, unless the foot
    /// along the other is at least twice as large.
    ///
    /// The foot is the bounding rectangle of the vertices within 1 % of the height above the lowest
    /// one, as a part of the bounding rectangle of all: four legs of a table span a large one, the
    /// bottom of a ball a small one.
    pub(super) fn guess(mesh: &Mesh, custom: Axis) -> Axis {
        let other = if custom == Axis::Y { Axis::Z } else { Axis::Y };
        let feet = [custom, other].map(|axis| foot(mesh, if axis == Axis::Y { 1 } else { 2 }));
        if feet[1] >= CLEARLY * feet[0] && feet[1] > 0.0 { other } else { custom }
    }
}

/// How large the foot is, 0 to 1, where the coordinate of this index is the height.
fn foot(mesh: &Mesh, height: usize) -> f64 {
    let corners = || {
        let all = mesh.triangles.iter().flatten();
        all.filter_map(|&i| mesh.positions.get(i as usize)).filter(|p| p.is_finite())
    };
    let [low, high] = bounds(corners());
    let top = low[height] + FOOT * (high[height] - low[height]);
    let [foot_low, foot_high] = bounds(corners().filter(|p| p[height] <= top));
    let side = |axis: usize| {
        let whole = high[axis] - low[axis];
        // A model without any width there stands on all that it has.
        if whole > 0.0 { (foot_high[axis] - foot_low[axis]) / whole } else { 1.0 }
    };
    let share = side((height + 1) % 3) * side((height + 2) % 3);
    if share.is_finite() { share.max(0.0) } else { 0.0 }
}

fn bounds<'a>(points: impl Iterator<Item = &'a DVec3>) -> [DVec3; 2] {
    points
        .fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], p| [low.min(*p), high.max(*p)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_axis_is_turned_to_z_and_stays_right_handed() {
        for axis in Axis::ALL {
            let sign = if axis.name().starts_with('-') { -1.0 } else { 1.0 };
            let unit = match axis {
                Axis::X | Axis::NegX => DVec3::X,
                Axis::Y | Axis::NegY => DVec3::Y,
                Axis::Z | Axis::NegZ => DVec3::Z,
            };
            let up = axis.rotation() * (unit * sign);
            assert!((up - DVec3::Z).length() < 1e-15, "{axis:?}: {up}");
            let line = format!("camera 0 0 0 0.3 {}", axis.orient());
            let read = crate::scene::read::parse_camera(&line).unwrap().orientation;
            assert_eq!(read, axis.rotation(), "{axis:?}");
            assert_eq!(Axis::named(axis.name()), Some(axis));
        }
        assert_eq!(Axis::named("+z"), None);
    }

    /// A mesh whose triangles name its points, three by three.
    fn mesh(points: &[[f64; 3]]) -> Mesh {
        let n = points.len() as u32;
        Mesh {
            positions: points.iter().map(|&p| p.into()).collect(),
            triangles: (0..n).map(|i| [i, (i + 1) % n, (i + 2) % n]).collect(),
            ..Mesh::default()
        }
    }

    #[test]
    fn a_pyramid_stands_on_its_base_whatever_its_format() {
        let base = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let tip_up = mesh(&[&base[..], &[[0.5, 0.5, 1.0]]].concat());
        let lying = base.map(|[x, y, z]| [x, z, y]);
        let tip_along_y = mesh(&[&lying[..], &[[0.5, 1.0, 0.5]]].concat());
        for custom in [Axis::Y, Axis::Z] {
            assert_eq!(Axis::guess(&tip_up, custom), Axis::Z);
            assert_eq!(Axis::guess(&tip_along_y, custom), Axis::Y);
        }
    }

    #[test]
    fn what_stands_as_well_on_either_side_stands_by_custom() {
        let cube: Vec<[f64; 3]> =
            (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(f64::from)).collect();
        let odd = mesh(&[[f64::NAN; 3], [0.0; 3], [f64::INFINITY, 0.0, 0.0]]);
        for model in [mesh(&cube), odd, Mesh::default()] {
            for custom in [Axis::Y, Axis::Z] {
                assert_eq!(Axis::guess(&model, custom), custom);
            }
        }
    }
}
