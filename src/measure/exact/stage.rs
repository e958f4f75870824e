//! A scene set up to be measured.

use super::ExactError;
use crate::brdf::Model;
use crate::math::simd::Isa;
use crate::measure::site::{Site, Somewhere};
use crate::progressive::Params;
use crate::scene::{Camera, Material, MaterialId, Mesh, ShapeError};
use crate::trace::{DEPTH_CAP, ReuseGroup};
use glam::DVec3;
use std::sync::Arc;

/// Pixels of a picture that shows one number everywhere: few, so that each has many passes to be
/// stratified over, and in four tiles, so that more than one core has work.
const SIZE: [u32; 2] = [128, 8];

/// Tangent of half the field of view of a camera that looks at a point. What varies linearly over
/// the window averages out; what varies with its square is below 1e-7.
pub(super) const POINT: f64 = 1e-5;

/// What single precision costs a scene of unit size: positions on lights, the step off a surface,
/// and a dozen rounding errors of densities. Relative.
const ROUNDING_ERROR: f64 = 1e-5;

/// A viewer of no special place: unit, above the plane.
pub(super) const ASIDE: DVec3 = DVec3::new(-0.48, 0.36, 0.8);

/// Where a scene stands, and what its pictures are made on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Where {
    pub place: Somewhere,
    pub isa: Isa,
}

impl Where {
    pub(super) fn site(self, name: &str) -> Site {
        Site::new(name, self.place)
    }

    pub(super) fn stage(self, site: Site, camera: Camera) -> Result<ExactStage, ExactError> {
        ExactStage::new(site, camera, self.isa)
    }
}

/// What to render, and what it says about the number wanted.
pub(super) struct ExactStage {
    pub params: Params,
    /// The picture's mean is `share * wanted + rest`.
    pub share: f64,
    pub rest: f64,
    /// Bound of the relative error that the construction adds.
    pub bound: f64,
}

impl ExactStage {
    /// The mean of the whole picture is the number wanted.
    fn new(site: Site, camera: Camera, isa: Isa) -> Result<ExactStage, ExactError> {
        let camera = site.camera(camera)?;
        let mut builder = site.builder;
        builder.camera = Some(camera);
        builder.screen = SIZE;
        let mut scene = builder.build();
        scene.set_isa(isa);
        // Paths share, where they can: that is what a picture is made by.
        let group = Some(ReuseGroup::ThirtyTwo);
        let params = Params { group, ..Params::new(Arc::new(scene)) };
        Ok(ExactStage { params, share: 1.0, rest: 0.0, bound: ROUNDING_ERROR })
    }

    pub(super) fn model(mut self, model: Model) -> ExactStage {
        self.params.model = model;
        self
    }

    /// At most this many scattering events; 1 leaves direct light.
    pub(super) fn depth(mut self, depth: u32) -> ExactStage {
        self.params.max_depth = Some(depth);
        self
    }

    /// Widens the bound.
    pub(super) fn bounded(mut self, relative: f64) -> ExactStage {
        self.bound += relative;
        self
    }
}

/// Relative error of a closed room's `1 / (1 - albedo)`: the albedo is rounded to single precision,
/// and what comes from beyond the cap on a path's length is missing.
pub(super) fn of_albedo(albedo: f64) -> f64 {
    f32::EPSILON as f64 * 0.5 / (1.0 - albedo) + albedo.powi(DEPTH_CAP as i32)
}

/// A grey diffuse surface.
pub(super) fn diffuse(
    site: &mut Site,
    albedo: f64,
    emission: f64,
) -> Result<MaterialId, ExactError> {
    let material = Material::reflecting("diffuse", [albedo; 3], [0.0; 3], 0.0)?;
    Ok(site.material(material.emitting([emission; 3])?))
}

/// A black surface that emits.
pub(super) fn emitter(site: &mut Site, radiance: f64) -> Result<MaterialId, ExactError> {
    Ok(site.material(Material::light("lamp", [radiance; 3])?))
}

/// The plane z = 0 around the origin, as far as rays need it: a triangle with its middle there.
pub(super) fn plane(site: &mut Site, size: f64, material: MaterialId) -> Result<(), ShapeError> {
    let corner = |x: f64, y: f64| DVec3::new(x, y, 0.0) * size;
    let positions = vec![corner(-1.0, -1.0), corner(2.0, -1.0), corner(-1.0, 2.0)];
    mesh(site, positions, vec![[0, 1, 2]], material)
}

/// The quadrilateral with these corners, in turn.
pub(super) fn quad(
    site: &mut Site,
    corners: [DVec3; 4],
    material: MaterialId,
) -> Result<(), ShapeError> {
    site.quad(corners, material)
}

/// The rectangle around `centre` with these half-edges.
pub(super) fn rectangle(
    site: &mut Site,
    centre: DVec3,
    [u, v]: [DVec3; 2],
    material: MaterialId,
) -> Result<(), ShapeError> {
    let corners = [centre - u - v, centre + u - v, centre + u + v, centre - u + v];
    quad(site, corners, material)
}

/// Triangles with smooth normals.
pub(super) fn mesh(
    site: &mut Site,
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    material: MaterialId,
) -> Result<(), ShapeError> {
    site.mesh(Mesh { positions, triangles, ..Mesh::default() }, material)
}

/// Looks at the origin along `-wo`, from closer than anything that could be in the way.
pub(super) fn viewer(wo: DVec3, distance: f64) -> Result<Camera, ExactError> {
    Ok(Camera::look_at(wo * distance, DVec3::ZERO, POINT)?)
}
