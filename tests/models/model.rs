//! A polygon model, its PLY file and what must hold for it.

use std::collections::HashMap;

pub(crate) type Point = [f64; 3];

/// Polygons that share vertices, counter-clockwise seen from outside.
#[derive(Default)]
pub(crate) struct Model {
    pub(crate) positions: Vec<Point>,
    /// One a vertex, or none at all.
    pub(crate) normals: Vec<Point>,
    /// Convex polygons.
    pub(crate) faces: Vec<Vec<u32>>,
}

impl Model {
    /// Adds a vertex without a normal.
    pub(crate) fn vertex(&mut self, p: Point) -> u32 {
        self.positions.push(p);
        u32::try_from(self.positions.len() - 1).unwrap()
    }

    /// Adds a vertex with a normal.
    pub(crate) fn vertex_with_normal(&mut self, p: Point, n: Point) -> u32 {
        self.normals.push(n);
        self.vertex(p)
    }

    /// The model as a little-endian binary PLY file.
    pub(crate) fn ply(&self, name: &str) -> Vec<u8> {
        let properties = |names: &[&str]| -> String {
            names.iter().map(|n| format!("property float {n}\n")).collect()
        };
        let mut header = format!(
            "ply\nformat binary_little_endian 1.0\ncomment {name}, made by burnish's tests/models\n\
             element vertex {}\n{}",
            self.positions.len(),
            properties(&["x", "y", "z"])
        );
        if !self.normals.is_empty() {
            header += &properties(&["nx", "ny", "nz"]);
        }
        header += &format!("element face {}\n", self.faces.len());
        // Sixteen bits an index where they suffice.
        let short = self.positions.len() <= 1 << 16;
        let index = if short { "ushort" } else { "uint" };
        header += &format!("property list uchar {index} vertex_indices\nend_header\n");
        let mut bytes = header.into_bytes();
        for (i, p) in self.positions.iter().enumerate() {
            for x in p.iter().chain(self.normals.get(i).into_iter().flatten()) {
                bytes.extend((*x as f32).to_le_bytes());
            }
        }
        for face in &self.faces {
            bytes.push(u8::try_from(face.len()).unwrap());
            for i in face {
                bytes.extend(&i.to_le_bytes()[..if short { 2 } else { 4 }]);
            }
        }
        bytes
    }

    /// The polygons as fans of triangles.
    fn triangles(&self) -> impl Iterator<Item = [Point; 3]> {
        self.faces.iter().flat_map(|face| {
            let p = |i: usize| self.positions[face[i] as usize];
            (2..face.len()).map(move |i| [p(0), p(i - 1), p(i)])
        })
    }

    /// Edges, by place, that are not run once each way: 0 for a closed surface.
    pub(crate) fn open_edges(&self) -> usize {
        let key = |i: u32| self.positions[i as usize].map(|x| (x as f32).to_bits());
        let mut balance = HashMap::new();
        for face in &self.faces {
            for (i, &a) in face.iter().enumerate() {
                let (a, b) = (key(a), key(face[(i + 1) % face.len()]));
                *balance.entry((a.min(b), a.max(b))).or_insert(0) += if a < b { 1 } else { -1 };
            }
        }
        balance.values().filter(|&&b| b != 0).count()
    }

    /// How many triangles the polygons make.
    pub(crate) fn count(&self) -> usize {
        self.faces.iter().map(|face| face.len() - 2).sum()
    }

    /// Enclosed volume; negative when the faces look inwards.
    pub(crate) fn volume(&self) -> f64 {
        self.triangles().map(|[a, b, c]| dot(a, cross(b, c)) / 6.0).sum()
    }

    /// Triangles whose corners lie on one line at the precision of the file.
    pub(crate) fn flat_faces(&self) -> usize {
        let flat = |t: [Point; 3]| {
            let [a, b, c] = t.map(|p| p.map(|x| f64::from(x as f32)));
            let n = cross(minus(b, a), minus(c, a));
            dot(n, n) == 0.0
        };
        self.triangles().filter(|&t| flat(t)).count()
    }

    /// Smallest cosine between a vertex' normal and the normal of a face that uses it.
    pub(crate) fn least_agreement(&self) -> f64 {
        let agreement = |face: &Vec<u32>| {
            let p = |i: usize| self.positions[face[i] as usize];
            let n = unit(cross(minus(p(1), p(0)), minus(p(2), p(0))));
            let cosines = face.iter().map(|&i| dot(n, self.normals[i as usize]));
            cosines.fold(f64::INFINITY, f64::min)
        };
        self.faces.iter().map(agreement).fold(f64::INFINITY, f64::min)
    }
}

pub(crate) fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn unit(a: Point) -> Point {
    let length = dot(a, a).sqrt();
    a.map(|x| x / length)
}
