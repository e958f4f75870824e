//! Collects what a reader found, in world units and f64, and checks it.

mod build;

use super::doubles::Origin;
use super::mesh::{MAX_COORDINATE, Mesh};
use super::normals::{self, NormalCounts, face_normal};
use super::weld::weld;
use super::{Camera, Material, MaterialId, Source};
use crate::limits::{TRIANGLES as MAX_TRIANGLES, TooLarge};
use crate::plain::number;
use glam::{DAffine3, DVec3};
use std::ops::Range;
use thiserror::Error;

/// What became of a mesh's triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MeshCounts {
    /// Triangles that are now part of the scene.
    pub kept: usize,
    /// Dropped: no area once placed (points, lines, repeated vertices).
    pub degenerate: usize,
    /// Dropped: a vertex is not finite, or beyond 1e18.
    pub out_of_range: usize,
    /// Dropped: an index points at no vertex.
    pub bad_index: usize,
    /// Vertices whose given normal was zero or not finite; the face's is used.
    pub bad_normals: usize,
    /// How the kept triangles came by their normals.
    pub normals: NormalCounts,
}

/// A shape that encloses nothing, or lies out of reach.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ShapeError {
    /// Zero, negative or undefined radius.
    #[error("the radius must be above 0 and at most 1e18, not {0}")]
    Radius(f64),
    /// An axis of no length.
    #[error("the axis must have a length above 0 and at most 1e18, not {0}")]
    Axis(f64),
    /// A coordinate that is not finite or too large.
    #[error(
        "coordinates must be finite and at most 1e18 in size, not {} {} {}",
        number(*.0), number(*.1), number(*.2)
    )]
    Coordinate(f64, f64, f64),
    /// A box with two or three sides of length zero.
    #[error("a box needs at least two sides of a length other than 0")]
    Flat,
    /// The number of a material that has not been added.
    #[error("there is no material {material}: {known} have been added, counted from 0")]
    Material {
        /// What was given.
        material: MaterialId,
        /// How many there are.
        known: usize,
    },
    /// More triangles than 32-bit indices can name.
    #[error("more than {0} triangles are not supported")]
    TooMany(usize),
    /// More than there is memory for.
    #[error(transparent)]
    Memory(#[from] TooLarge),
}

/// Triangles that are added before the system is asked again whether there is room.
const ROOM: usize = 1 << 17;

/// Collects shapes in world space; [`SceneBuilder::build`] makes the scene of them.
///
/// ```
/// use burnish::scene::{Material, SceneBuilder};
/// use glam::DVec3;
///
/// let mut builder = SceneBuilder::new("one ball");
/// let red = builder.material(Material::reflecting("red", [0.8, 0.1, 0.1], [0.04; 3], 200.0)?);
/// builder.sphere(DVec3::ZERO, 1.0, red)?;
/// builder.environment = [1.0; 3];
/// let scene = builder.build();
/// assert_eq!(scene.counts().spheres, 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct SceneBuilder {
    /// Shown in the window's title and status line.
    pub name: String,
    /// What to look for in it, one line.
    pub caption: Option<String>,
    /// The files that it comes from; filled by the readers.
    pub source: Source,
    /// Width and height in pixels that the file asks for.
    pub screen: [u32; 2],
    /// The file's camera; `None` frames the whole scene.
    pub camera: Option<Camera>,
    /// Uniform radiance of every direction that hits nothing.
    pub environment: [f32; 3],
    /// The bounding box of the model that a stage was put up for.
    pub(super) focus: Option<[DVec3; 2]>,
    /// The line that shapes added from now on come from, for warnings about them; the readers keep it.
    pub line: Option<usize>,
    materials: Vec<Material>,
    positions: Vec<DVec3>,
    normals: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    /// Runs of triangles that came in by one call: one light each, where the material emits.
    groups: Vec<(Range<usize>, Origin)>,
    spheres: Vec<(DVec3, f64, Origin)>,
    cylinders: Vec<(DVec3, DVec3, f64, Origin)>,
    /// How meshes came by their normals.
    normal_counts: NormalCounts,
    /// Shapes that were left out because another is in the same place.
    duplicates: usize,
    /// Nothing was added since doubles were looked for.
    settled: bool,
    /// There is memory for this number of triangles.
    roomy: usize,
}

impl SceneBuilder {
    /// An empty scene of 640 by 480 pixels.
    pub fn new(name: impl Into<String>) -> SceneBuilder {
        SceneBuilder {
            name: name.into(),
            caption: None,
            source: Source::default(),
            screen: [640, 480],
            camera: None,
            environment: [0.0; 3],
            focus: None,
            line: None,
            materials: Vec::new(),
            positions: Vec::new(),
            normals: Vec::new(),
            triangles: Vec::new(),
            groups: Vec::new(),
            spheres: Vec::new(),
            cylinders: Vec::new(),
            normal_counts: NormalCounts::default(),
            duplicates: 0,
            settled: false,
            roomy: 0,
        }
    }

    /// Adds a material; shapes refer to it by the number returned.
    pub fn material(&mut self, material: Material) -> MaterialId {
        self.materials.push(material);
        self.materials.len() as MaterialId - 1
    }

    /// The materials so far.
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// Triangles, spheres and cylinders so far.
    pub fn shapes(&self) -> usize {
        self.triangles.len() + self.spheres.len() + self.cylinders.len()
    }

    /// True when something emits: a shape's material or the environment.
    pub fn is_lit(&self) -> bool {
        let emits = |o: &Origin| self.materials[o.material as usize].emits();
        self.environment.iter().any(|&c| c > 0.0)
            || self.groups.iter().any(|(range, o)| !range.is_empty() && emits(o))
            || self.spheres.iter().any(|(_, _, o)| emits(o))
            || self.cylinders.iter().any(|(_, _, _, o)| emits(o))
    }

    /// What is added now, of this material.
    fn origin(&mut self, material: MaterialId) -> Result<Origin, ShapeError> {
        self.settled = false;
        Ok(Origin { material: self.known(material)?, line: self.line })
    }

    fn known(&self, material: MaterialId) -> Result<MaterialId, ShapeError> {
        let known = self.materials.len();
        if (material as usize) < known {
            Ok(material)
        } else {
            Err(ShapeError::Material { material, known })
        }
    }

    /// A sphere, exact.
    pub fn sphere(
        &mut self,
        centre: DVec3,
        radius: f64,
        material: MaterialId,
    ) -> Result<(), ShapeError> {
        let sphere = (in_reach(centre)?, positive(radius)?, self.origin(material)?);
        self.spheres.push(sphere);
        Ok(())
    }

    /// A cylinder with flat caps, exact: from `base` along `axis`, whose length is the height.
    pub fn cylinder(
        &mut self,
        base: DVec3,
        axis: DVec3,
        radius: f64,
        material: MaterialId,
    ) -> Result<(), ShapeError> {
        let axis = in_reach(axis)?;
        if axis.length() < 1e-18 {
            return Err(ShapeError::Axis(axis.length()));
        }
        let cylinder = (in_reach(base)?, axis, positive(radius)?, self.origin(material)?);
        self.cylinders.push(cylinder);
        Ok(())
    }

    /// An axis-aligned box: corner and diagonal, whose components may be negative.
    pub fn cuboid(
        &mut self,
        corner: DVec3,
        diagonal: DVec3,
        material: MaterialId,
    ) -> Result<(), ShapeError> {
        let (a, d) = (in_reach(corner)?, in_reach(diagonal)?);
        if d.to_array().iter().filter(|x| **x != 0.0).count() < 2 {
            return Err(ShapeError::Flat);
        }
        let mut mesh = Mesh::default();
        // Two faces across each axis; own vertices a face, so that the faces stay flat.
        for axis in 0..3 {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            for side in 0..2 {
                let first = mesh.positions.len() as u32;
                for (s, t) in [(0, 0), (1, 0), (1, 1), (0, 1)] {
                    let mut p = a;
                    p[axis] += side as f64 * d[axis];
                    p[u] += s as f64 * d[u];
                    p[v] += t as f64 * d[v];
                    mesh.positions.push(p);
                }
                mesh.triangles.push([first, first + 1, first + 2]);
                mesh.triangles.push([first, first + 2, first + 3]);
            }
        }
        let (meshes, part) = (self.normal_counts, (0..12, self.origin(material)?));
        self.place(&mesh, DAffine3::IDENTITY, &[part])?;
        // A box is not a mesh whose normals there is anything to tell about.
        self.normal_counts = meshes;
        Ok(())
    }

    /// Places a mesh and gives it one material. Where that emits, the mesh is one light.
    pub fn mesh(
        &mut self,
        mesh: &Mesh,
        placement: DAffine3,
        material: MaterialId,
    ) -> Result<MeshCounts, ShapeError> {
        self.mesh_parts(mesh, placement, &[(0..mesh.triangles.len(), material)])
    }

    /// Places a mesh whose parts, runs of triangles, have materials of their own. Each part is one
    /// light where its material emits; smooth normals are made across the parts. Triangles of no
    /// part are left out.
    pub fn mesh_parts(
        &mut self,
        mesh: &Mesh,
        placement: DAffine3,
        parts: &[(Range<usize>, MaterialId)],
    ) -> Result<MeshCounts, ShapeError> {
        let parts: Result<Vec<_>, ShapeError> =
            parts.iter().map(|(r, m)| Ok((r.clone(), self.origin(*m)?))).collect();
        self.place(mesh, placement, &parts?)
    }

    /// [`SceneBuilder::mesh_parts`] whose lines are known.
    pub(super) fn place(
        &mut self,
        mesh: &Mesh,
        placement: DAffine3,
        parts: &[(Range<usize>, Origin)],
    ) -> Result<MeshCounts, ShapeError> {
        self.settled = false;
        if self.triangles.len() + mesh.triangles.len() > MAX_TRIANGLES
            || self.positions.len() + mesh.positions.len() > MAX_TRIANGLES
        {
            return Err(ShapeError::TooMany(MAX_TRIANGLES));
        }
        for (_, origin) in parts {
            self.known(origin.material)?;
        }
        // Not for each of many small ones: it takes the system a while to tell.
        let triangles = self.triangles.len() + mesh.triangles.len();
        if triangles > self.roomy {
            self.has_room(1, mesh)?;
            self.roomy = triangles + ROOM;
        }
        let mut placed: Vec<DVec3> =
            mesh.positions.iter().map(|&p| placement.transform_point3(p)).collect();
        let mut counts = MeshCounts::default();
        let mut kept = Vec::with_capacity(mesh.triangles.len());
        let mut rules = Vec::with_capacity(mesh.triangles.len());
        let mut groups = Vec::with_capacity(parts.len());
        for (range, origin) in parts {
            let start = kept.len();
            let triangles = mesh.triangles.get(range.clone()).unwrap_or_default();
            for (i, &t) in (range.start..).zip(triangles) {
                let Some(corners) = corners(&placed, t) else {
                    counts.bad_index += 1;
                    continue;
                };
                if corners.iter().any(|&p| in_reach(p).is_err()) {
                    counts.out_of_range += 1;
                } else if face_normal(corners).is_none() {
                    counts.degenerate += 1;
                } else {
                    kept.push(t);
                    rules.push(mesh.smoothing.get(i).copied().unwrap_or_default());
                }
            }
            groups.push((start..kept.len(), *origin));
        }
        counts.kept = kept.len();
        let normals = if mesh.normals.len() == mesh.positions.len() {
            let (normals, bad) = normals::given(mesh, placement);
            counts.bad_normals = bad;
            counts.normals.given = kept.len();
            normals
        } else {
            counts.normals = NormalCounts::made(&rules);
            normals::make(&mut placed, &mut kept, &rules)
        };
        self.normal_counts.add(counts.normals);
        let (placed, normals) = weld((placed, normals), &mut kept);
        let first = self.positions.len() as u32;
        let start = self.triangles.len();
        self.positions.extend(placed);
        self.normals.extend(normals);
        self.triangles.extend(kept.iter().map(|t| t.map(|i| i + first)));
        let within = |r: Range<usize>| start + r.start..start + r.end;
        self.groups.extend(groups.into_iter().map(|(range, origin)| (within(range), origin)));
        Ok(counts)
    }
}

fn in_reach(p: DVec3) -> Result<DVec3, ShapeError> {
    // Written so that NaN fails.
    if p.abs().to_array().iter().all(|&x| x <= MAX_COORDINATE) {
        Ok(p)
    } else {
        Err(ShapeError::Coordinate(p.x, p.y, p.z))
    }
}

fn positive(radius: f64) -> Result<f64, ShapeError> {
    if radius > 0.0 && radius <= MAX_COORDINATE {
        Ok(radius)
    } else {
        Err(ShapeError::Radius(radius))
    }
}

fn corners(positions: &[DVec3], t: [u32; 3]) -> Option<[DVec3; 3]> {
    let get = |i: u32| positions.get(i as usize).copied();
    Some([get(t[0])?, get(t[1])?, get(t[2])?])
}
