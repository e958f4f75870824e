//! A scene put together in one place and standing in another.

use super::draw::Draw;
use crate::scene::{Camera, CameraError, Material, MaterialId, Mesh, SceneBuilder, ShapeError};
use glam::{DAffine3, DQuat, DVec3};

/// Where a scene stands: turned, then made larger or smaller, then moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Somewhere {
    /// How it is turned.
    pub(super) rotation: DQuat,
    /// How much larger it is.
    pub(super) scale: f64,
    /// How far it is moved.
    pub(super) offset: DVec3,
}

impl Somewhere {
    /// Where it was put together.
    pub(super) const HERE: Somewhere =
        Somewhere { rotation: DQuat::IDENTITY, scale: 1.0, offset: DVec3::ZERO };

    /// Any rotation, but every fourth time none; a scale of 1e-4 to 1e4; up to 1e5 of its size away.
    pub(super) fn draw(draw: &mut Draw) -> Somewhere {
        let turned = draw.rotation();
        let rotation = if draw.chance(0.25) { DQuat::IDENTITY } else { turned };
        let scale = draw.decades(1e-4, 1e4);
        let offset = draw.direction() * draw.decades(0.1, 1e5) * scale;
        Somewhere { rotation, scale, offset }
    }

    fn point(&self, p: DVec3) -> DVec3 {
        self.vector(p) + self.offset
    }

    fn vector(&self, v: DVec3) -> DVec3 {
        self.rotation * v * self.scale
    }
}

/// A builder of a scene that stands somewhere: shapes are given where they are put together.
#[derive(Clone, Debug)]
pub(super) struct Site {
    pub(super) builder: SceneBuilder,
    at: Somewhere,
}

impl Site {
    pub(super) fn new(name: impl Into<String>, at: Somewhere) -> Site {
        Site { builder: SceneBuilder::new(name), at }
    }

    pub(super) fn material(&mut self, material: Material) -> MaterialId {
        self.builder.material(material)
    }

    pub(super) fn sphere(
        &mut self,
        centre: DVec3,
        radius: f64,
        material: MaterialId,
    ) -> Result<(), ShapeError> {
        self.builder.sphere(self.at.point(centre), radius * self.at.scale, material)
    }

    pub(super) fn cylinder(
        &mut self,
        base: DVec3,
        axis: DVec3,
        radius: f64,
        material: MaterialId,
    ) -> Result<(), ShapeError> {
        let (base, axis) = (self.at.point(base), self.at.vector(axis));
        self.builder.cylinder(base, axis, radius * self.at.scale, material)
    }

    /// A box around `centre`, of these half-edges, turned: flat faces, one light if it emits.
    pub(super) fn block(
        &mut self,
        centre: DVec3,
        half: DVec3,
        turn: DQuat,
        material: MaterialId,
    ) -> Result<(), ShapeError> {
        let mut mesh = Mesh::default();
        for axis in 0..3 {
            let (n, u, v) = (axis, (axis + 1) % 3, (axis + 2) % 3);
            for side in [-1.0, 1.0] {
                let first = mesh.positions.len() as u32;
                for (s, t) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                    let mut p = DVec3::ZERO;
                    (p[n], p[u], p[v]) = (side * half[n], s * half[u], t * half[v]);
                    mesh.positions.push(centre + turn * p);
                }
                mesh.triangles.push([first, first + 1, first + 2]);
                mesh.triangles.push([first, first + 2, first + 3]);
            }
        }
        self.mesh(mesh, material)
    }

    /// The quadrilateral with these corners, in turn.
    pub(super) fn quad(
        &mut self,
        corners: [DVec3; 4],
        material: MaterialId,
    ) -> Result<(), ShapeError> {
        let (positions, triangles) = (corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]]);
        self.mesh(Mesh { positions, triangles, ..Mesh::default() }, material)
    }

    pub(super) fn mesh(&mut self, mesh: Mesh, material: MaterialId) -> Result<(), ShapeError> {
        let positions = mesh.positions.iter().map(|&p| self.at.point(p)).collect();
        let normals = mesh.normals.iter().map(|&n| self.at.rotation * n).collect();
        let mesh = Mesh { positions, normals, ..mesh };
        self.builder.mesh(&mesh, DAffine3::IDENTITY, material).map(|_| ())
    }

    /// A camera that stands where the scene was put together, standing where the scene is.
    pub(super) fn camera(&self, camera: Camera) -> Result<Camera, CameraError> {
        let orientation = self.at.rotation * camera.orientation;
        Camera::new(self.at.point(camera.eye), camera.ry, orientation)
    }
}
