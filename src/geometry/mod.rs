//! Shapes and the tree over them, in the scene's local units (half-extent about 1).
//!
//! **The rule at edges and vertices.** A triangle is tested in the ray's own sheared frame, where
//! each shared vertex gets the same two numbers in every triangle that has it; the side of an edge
//! is then decided exactly. A ray through an edge or vertex hits all triangles that share it, so no
//! ray slips between them; of hits at the same distance the lowest primitive index wins. Surfaces
//! that share an area have a rule of their own: the emitter is in front, else the first.

mod aabb;
mod accel;
mod coincident;
mod cylinder;
mod huge_pages;
mod ray_origin;
mod shading;
mod sphere;
mod triangle;

pub(crate) use aabb::{Aabb, PacketSlabs};
pub use accel::{Bvh, Query, Ray, Stack};
pub(crate) use accel::{HitSoa, NO_SURFACE, PointSoa, RaySoa, SegmentSoa, surface_left};
pub use cylinder::Cylinder;
pub use ray_origin::offset_origin;
pub(crate) use shading::bent;
pub use sphere::Sphere;
pub(crate) use sphere::intersect as intersect_spheres;
pub(crate) use triangle::{flat_surface, shading_normal};

use crate::math::V3;
use bytemuck::{Pod, Zeroable};
use huge_pages::HugePages;
use std::ops::Range;

/// All shapes of a scene. Primitives are numbered triangles first, then spheres, then cylinders.
#[derive(Debug, Default)]
pub struct Geometry {
    vertices: HugePages<Vertex>,
    faces: HugePages<Face>,
    /// Exact spheres.
    pub spheres: Vec<Sphere>,
    /// Exact capped cylinders.
    pub cylinders: Vec<Cylinder>,
    /// Of spheres and then cylinders.
    materials: Vec<u32>,
    /// No surface point is taken to be known better than this, in each component. Above 0 where
    /// surfaces coincide: what leaves the one in front has to be off the other as well.
    least_error: f32,
}

/// A corner of triangles.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Vertex {
    /// Where it is.
    pub position: [f32; 3],
    /// Unit shading normal; zero where the face's is to be used.
    pub normal: [f32; 3],
}

/// A triangle. What a hit wants to know of it is side by side in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Face {
    /// Indices of its corners.
    pub vertices: [u32; 3],
    /// Index of its material.
    pub material: u32,
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
    /// Index into [`Geometry::faces`].
    Triangle(usize),
    /// Index into [`Geometry::spheres`].
    Sphere(usize),
    /// Index into [`Geometry::cylinders`].
    Cylinder(usize),
}

/// Where a ray hit a surface.
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
    /// Of these shapes. Indices of corners must be below the number of vertices; `materials` has
    /// one for each sphere and then for each cylinder.
    pub fn new(
        vertices: impl ExactSizeIterator<Item = Vertex>,
        faces: impl ExactSizeIterator<Item = Face>,
        (spheres, cylinders): (Vec<Sphere>, Vec<Cylinder>),
        materials: Vec<u32>,
    ) -> Geometry {
        let mut geometry = Geometry {
            vertices: HugePages::zeroed(vertices.len()),
            faces: HugePages::zeroed(faces.len()),
            spheres,
            cylinders,
            materials,
            least_error: 0.0,
        };
        geometry.vertices.iter_mut().zip(vertices).for_each(|(place, vertex)| *place = vertex);
        geometry.faces.iter_mut().zip(faces).for_each(|(place, face)| *place = face);
        geometry
    }
    /// Corners of triangles.
    pub fn vertices(&self) -> &[Vertex] {
        &self.vertices
    }
    /// Triangles.
    pub fn faces(&self) -> &[Face] {
        &self.faces
    }
    /// Number of primitives.
    pub fn len(&self) -> usize {
        self.faces.len() + self.spheres.len() + self.cylinders.len()
    }
    /// True without any primitive.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// Bytes held by positions, normals, indices, materials and exact shapes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.vertices[..])
            + size_of_val(&self.faces[..])
            + size_of_val(&self.spheres[..])
            + size_of_val(&self.cylinders[..])
            + size_of_val(&self.materials[..])
    }
    /// Which shape a primitive index names; it must be below [`Geometry::len`].
    #[inline(always)]
    pub fn kind(&self, primitive: u32) -> Kind {
        let i = primitive as usize;
        let spheres = self.faces.len();
        let cylinders = spheres + self.spheres.len();
        if i < spheres {
            Kind::Triangle(i)
        } else if i < cylinders {
            Kind::Sphere(i - spheres)
        } else {
            Kind::Cylinder(i - cylinders)
        }
    }
    /// Index of a primitive's material; it must be below [`Geometry::len`].
    #[inline(always)]
    pub fn material(&self, primitive: u32) -> u32 {
        let (faces, i) = (&self.faces[..], primitive as usize);
        faces.get(i).map_or_else(|| self.materials[i - faces.len()], |face| face.material)
    }
    /// Lowest and highest corner of a primitive, in local units.
    pub fn bounds(&self, primitive: u32) -> [V3; 2] {
        accel::primitive_bounds(self, primitive)
    }
    /// The corners of a triangle.
    #[inline(always)]
    pub fn corners(&self, triangle: usize) -> [V3; 3] {
        let vertices = &self.vertices[..];
        self.faces[triangle].vertices.map(|i| V3::from(vertices[i as usize].position))
    }
    /// The least bound on a surface point's error, 0 unless surfaces coincide.
    #[inline(always)]
    pub(crate) fn least_error(&self) -> f32 {
        self.least_error
    }
    /// The point of a triangle at barycentric weights `b` of its second and third vertex.
    #[cfg(test)]
    pub(crate) fn triangle_surface(&self, triangle: usize, b: [f32; 2]) -> SurfacePoint {
        triangle::surface(self, triangle, b)
    }
    /// The surface at a hit of `ray`.
    #[inline(always)]
    pub fn surface(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let point = match self.kind(hit.primitive) {
            Kind::Triangle(i) => triangle::surface(self, i, hit.b),
            Kind::Sphere(i) => self.spheres[i].surface(ray.at(hit.t)),
            Kind::Cylinder(i) => self.cylinders[i].surface(ray.at(hit.t)),
        };
        SurfacePoint { error: point.error.max(V3::splat(self.least_error)), ..point }
    }
}
