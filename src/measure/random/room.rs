//! Rooms: what is around the things of a scene.

use super::super::draw::Draw;
use super::EmitterKind;
use glam::DVec3;

/// A flat part of the surroundings: a parallelogram seen from one side.
#[derive(Clone, Debug)]
pub(super) struct Wall {
    pub(super) centre: DVec3,
    /// Half-edges, at right angles.
    pub(super) edges: [DVec3; 2],
    /// Into the room.
    pub(super) normal: DVec3,
    /// What is left open, in half-edges from the centre.
    pub(super) hole: Option<[[f64; 2]; 2]>,
}

impl Wall {
    pub(super) fn at(&self, a: f64, b: f64) -> DVec3 {
        self.centre + self.edges[0] * a + self.edges[1] * b
    }

    pub(super) fn corners(&self, [a0, a1]: [f64; 2], [b0, b1]: [f64; 2]) -> [DVec3; 4] {
        [self.at(a0, b0), self.at(a1, b0), self.at(a1, b1), self.at(a0, b1)]
    }

    /// A place on it at least `margin` from its edges; now and then no farther.
    pub(super) fn place(&self, draw: &mut Draw, margin: f64) -> DVec3 {
        let mut along = |edge: DVec3| {
            let most = (1.0 - margin / edge.length()).max(0.0);
            let at = draw.within(-most, most);
            if draw.chance(0.15) { most.copysign(at) } else { at }
        };
        let (a, b) = (along(self.edges[0]), along(self.edges[1]));
        self.at(a, b)
    }

    /// A unit direction in its plane.
    pub(super) fn along(&self, draw: &mut Draw) -> DVec3 {
        let [u, v] = self.edges.map(DVec3::normalize);
        if draw.chance(0.3) {
            return u;
        }
        let (sin, cos) = draw.within(0.0, std::f64::consts::TAU).sin_cos();
        u * cos + v * sin
    }
}

/// The kinds of surroundings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Form {
    /// Six walls.
    Box(DVec3),
    /// The inside of a sphere.
    Sphere(f64),
    /// The inside of a capped cylinder: radius and half its height.
    Cylinder(f64, f64),
    /// A floor, and now and then a wall, under a sky.
    Ground,
    /// Two plates that face each other.
    ParallelPlanes(f64),
    /// Nothing.
    Sky,
}

#[derive(Clone, Debug)]
pub(super) struct Room {
    pub(super) form: Form,
    pub(super) centre: DVec3,
    /// What things may touch. A round room has none but a cylinder's ends, which are parts of it.
    pub(super) walls: Vec<Wall>,
}

impl Room {
    /// One that has flat walls, or is two plates, where the kind of its emitters wants that.
    pub(super) fn draw(draw: &mut Draw, kind: EmitterKind) -> Room {
        let mut size = || draw.within(0.6, 1.4);
        let (half, spare) = (DVec3::new(size(), size(), size()), size());
        let centre = draw.direction() * draw.unit();
        let forms = match kind {
            EmitterKind::Flush | EmitterKind::Coincident => 6,
            EmitterKind::Glowing => 13,
            _ => 10,
        };
        let form = match draw.below(forms) {
            0..=3 => Form::Box(half),
            4 | 5 => Form::Ground,
            6 => Form::Sphere(spare),
            7 => Form::Cylinder(spare, half.z),
            8 => Form::Sky,
            _ => Form::ParallelPlanes(half.z),
        };
        let wall = |at: DVec3, u: DVec3, v: DVec3, normal: DVec3| Wall {
            centre: centre + at,
            edges: [u, v],
            normal,
            hole: None,
        };
        let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
        let walls = match form {
            Form::Box(h) => (0..6)
                .map(|i| {
                    let (axis, side) = (i / 2, (i % 2) as f64 * 2.0 - 1.0);
                    let unit = [x, y, z];
                    let edge = |k: usize| unit[(axis + k) % 3] * h[(axis + k) % 3];
                    wall(unit[axis] * (side * h[axis]), edge(1), edge(2), unit[axis] * -side)
                })
                .collect(),
            Form::Ground => {
                let [far, wide] = [draw.within(1.5, 4.0), draw.within(1.5, 4.0)];
                let mut walls = vec![wall(z * -half.z, x * wide, y * far, z)];
                if draw.chance(0.4) {
                    walls.push(wall(y * far + z * (spare - half.z), x * wide, z * spare, -y));
                }
                walls
            }
            Form::Cylinder(radius, h) => {
                let r = radius * std::f64::consts::FRAC_1_SQRT_2;
                [-1.0, 1.0].map(|side| wall(z * (side * h), x * r, y * r, z * -side)).into()
            }
            Form::ParallelPlanes(h) => {
                let edges = [draw.within(0.5, 2.0), draw.within(0.5, 2.0)];
                let other = [draw.within(0.5, 2.0), draw.within(0.5, 2.0)];
                vec![
                    wall(z * -h, x * edges[0], y * edges[1], z),
                    wall(z * h, x * other[0], y * other[1], -z),
                ]
            }
            Form::Sphere(_) | Form::Sky => Vec::new(),
        };
        Room { form, centre, walls }
    }

    /// Whether light has no way out.
    pub(super) fn is_closed(&self) -> bool {
        matches!(self.form, Form::Box(_) | Form::Sphere(_) | Form::Cylinder(..))
    }

    /// Whether a sphere lies in it, touching nothing.
    pub(super) fn holds(&self, p: DVec3, radius: f64) -> bool {
        let p = p - self.centre;
        let far = |limit: f64| p.length() + radius < limit;
        match self.form {
            Form::Box(h) => (p.abs() + radius).cmplt(h).all(),
            Form::Sphere(r) => far(r),
            Form::Cylinder(r, h) => p.truncate().length() + radius < r && p.z.abs() + radius < h,
            Form::Ground => {
                let in_front = |w: &Wall| w.normal.dot(p + self.centre - w.centre) > radius;
                far(2.0) && self.walls.iter().all(in_front)
            }
            Form::ParallelPlanes(h) => far(2.0) && p.z.abs() + radius < h,
            Form::Sky => far(1.5),
        }
    }

    /// Any place in it.
    pub(super) fn somewhere(&self, draw: &mut Draw, radius: f64) -> Option<DVec3> {
        let most = match self.form {
            Form::Box(h) => h,
            Form::Sphere(r) => DVec3::splat(r),
            Form::Cylinder(r, h) => DVec3::new(r, r, h),
            _ => DVec3::splat(1.5),
        };
        let mut part = || draw.within(-1.0, 1.0);
        let places: Vec<DVec3> =
            (0..64).map(|_| self.centre + DVec3::new(part(), part(), part()) * most).collect();
        places.into_iter().find(|&p| self.holds(p, radius))
    }
}
