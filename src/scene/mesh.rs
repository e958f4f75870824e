//! A triangle mesh as readers hand it over.

use glam::DVec3;

/// Largest coordinate accepted, in world units.
pub const MAX_COORDINATE: f64 = 1e18;

/// A triangle mesh as a file holds it: model space, not yet placed.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Vertex positions.
    pub positions: Vec<DVec3>,
    /// One normal a vertex, of any length, or empty: then they are made, by `smoothing`. A zero or
    /// non-finite one falls back to the face's.
    pub normals: Vec<DVec3>,
    /// Three indices into `positions` a triangle. Indices out of range drop the triangle.
    pub triangles: Vec<[u32; 3]>,
    /// How normals are made where none are given: one a triangle, or empty, where nothing is said.
    pub smoothing: Vec<Smooth>,
}

/// How a face's normals are made where a file gives none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Smooth {
    /// Smooth over shared vertices across edges whose faces meet below 45 degrees.
    #[default]
    Unsaid,
    /// The face's own normal.
    Flat,
    /// Smooth over shared vertices within the group of this number.
    Group(u32),
}
