//! Shapes and the tree over them, in the scene's local units (half-extent about 1).
//!
//! **The rule at edges and vertices.** A triangle is tested in the ray's own sheared frame, where
//! each shared vertex gets the same two numbers in every triangle that has it; the side of an edge
//! is then decided exactly. A ray through an edge or vertex hits all triangles that share it, so no
//! ray slips between them; of hits at the same distance the lowest primitive index wins.

mod bvh;
mod cylinder;
mod extent;
mod offset;
mod plates;
mod shaft;
mod sphere;
mod stream;
mod traverse;
mod treelets;
mod triangle;
mod widen;

pub use bvh::Bvh;
pub use cylinder::Cylinder;
pub(crate) use extent::{Extent, Passing};
pub use offset::offset_origin;
pub(crate) use plates::{NO_PLATE, PlateHits};
pub(crate) use shaft::{Leaves, Rays, Shaft};
pub use sphere::Sphere;
pub(crate) use sphere::intersect as intersect_spheres;
pub use stream::Query;
pub use traverse::{Ray, Stack};
pub(crate) use triangle::{flat_surface, resolve, shading_normal};

use crate::math::V3;
use std::ops::Range;

/// All shapes of a scene. Primitives are numbered triangles first, then spheres, then cylinders.
#[derive(Debug, Default)]
pub struct Geometry {
    /// Vertex positions.
    pub positions: Vec<V3>,
    /// Unit shading normal of each vertex; zero where the face's is to be used.
    pub normals: Vec<V3>,
    /// Three vertices a triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Exact spheres.
    pub spheres: Vec<Sphere>,
    /// Exact capped cylinders.
    pub cylinders: Vec<Cylinder>,
    /// One material a primitive.
    pub material_of: Vec<u32>,
}

/// Consecutive primitives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PrimitiveRange {
    /// Index of the first one.
    pub first: u32,
    /// How many.
    pub count: u32,
}

impl PrimitiveRange {
    /// The range of these triangles.
    pub fn triangles(range: Range<usize>) -> PrimitiveRange {
        PrimitiveRange { first: range.start as u32, count: range.len() as u32 }
    }
    /// True for a primitive inside.
    pub fn contains(&self, primitive: u32) -> bool {
        primitive.wrapping_sub(self.first) < self.count
    }
}

/// Which kind of shape a primitive is, with its index among that kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Index into [`Geometry::triangles`].
    Triangle(usize),
    /// Index into [`Geometry::spheres`].
    Sphere(usize),
    /// Index into [`Geometry::cylinders`].
    Cylinder(usize),
}

/// Where a ray met a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hit {
    /// Distance in units of the ray's direction.
    pub t: f32,
    /// The primitive.
    pub primitive: u32,
    /// Barycentric weights of a triangle's second and third vertex; 0 for other shapes.
    pub b: [f32; 2],
}

/// A point on a surface.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint<L = f32> {
    /// The point, rebuilt from the shape rather than from the ray.
    pub p: V3<L>,
    /// Unit geometric normal, either side.
    pub ng: V3<L>,
    /// Unit shading normal, either side.
    pub ns: V3<L>,
    /// Bound on the error of `p`, in each component.
    pub error: V3<L>,
}

impl Geometry {
    /// Number of primitives.
    pub fn len(&self) -> usize {
        self.triangles.len() + self.spheres.len() + self.cylinders.len()
    }
    /// True without any primitive.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// Bytes held by positions, normals, indices, materials and exact shapes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.positions[..])
            + size_of_val(&self.normals[..])
            + size_of_val(&self.triangles[..])
            + size_of_val(&self.spheres[..])
            + size_of_val(&self.cylinders[..])
            + size_of_val(&self.material_of[..])
    }
    /// Which shape a primitive index names; it must be below [`Geometry::len`].
    #[inline(always)]
    pub fn kind(&self, primitive: u32) -> Kind {
        let i = primitive as usize;
        let spheres = self.triangles.len();
        let cylinders = spheres + self.spheres.len();
        if i < spheres {
            Kind::Triangle(i)
        } else if i < cylinders {
            Kind::Sphere(i - spheres)
        } else {
            Kind::Cylinder(i - cylinders)
        }
    }
    /// The corners of a triangle.
    #[inline(always)]
    pub fn corners(&self, triangle: usize) -> [V3; 3] {
        self.triangles[triangle].map(|i| self.positions[i as usize])
    }
    /// The point of a triangle at barycentric weights `b` of its second and third vertex.
    #[cfg(test)]
    pub(crate) fn triangle_surface(&self, triangle: usize, b: [f32; 2]) -> SurfacePoint {
        triangle::surface(self, triangle, b)
    }
    /// The surface at a hit of `ray`.
    #[inline(always)]
    pub fn surface(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        match self.kind(hit.primitive) {
            Kind::Triangle(i) => triangle::surface(self, i, hit.b),
            Kind::Sphere(i) => self.spheres[i].surface(ray.at(hit.t)),
            Kind::Cylinder(i) => self.cylinders[i].surface(ray.at(hit.t)),
        }
    }
}
