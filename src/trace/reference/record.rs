//! One path of the reference tracer, vertex by vertex.

use super::errata::WithErratum;
use super::rules::Rules;
use crate::math::simd::U32;
use crate::math::sobol::{Slot, Stream, pair};
use crate::math::{Rgb, V3};
use crate::scene::MaterialId;
use crate::trace::{Scratch, Tracer};
use glam::DVec3;

/// Is told of the steps of a path. Points and directions are in the scene's local units.
pub(super) trait Recorder {
    /// A surface was hit, with this throughput of the path up to it.
    #[inline(always)]
    fn hit(&mut self, _point: V3, _material: MaterialId, _beta: Rgb) {}
    /// What its emission adds to the sample.
    #[inline(always)]
    fn emitted(&mut self, _found: Rgb) {}
    /// What light sampling adds there, and the point on the light unless that is the environment.
    #[inline(always)]
    fn lit(&mut self, _found: Rgb, _light: Option<V3>) {}
    /// The direction sampled from the BRDF, with that to the viewer, both in the vertex's frame.
    #[inline(always)]
    fn scattered(&mut self, _wo: V3, _wi: V3) {}
    /// The path left the scene in this direction, where the environment adds this.
    #[inline(always)]
    fn escaped(&mut self, _d: V3, _found: Rgb) {}
}

/// Records nothing, and costs nothing.
impl Recorder for () {}

/// One sample of the reference tracer. World space.
#[derive(Clone, Debug, PartialEq)]
pub struct PathRecord {
    /// Radiance of the sample. All contributions below add up to it, to rounding, but for
    /// [`Erratum::ClampSamples`](crate::brdf::Erratum::ClampSamples), which clamps their sum.
    pub value: Rgb,
    /// Surfaces hit, from the camera on.
    pub vertices: Vec<PathVertex>,
    /// How the path left the scene, if it did.
    pub escape: Option<Escape>,
}

/// A surface hit by a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathVertex {
    /// Where.
    pub point: DVec3,
    /// Whose surface.
    pub material: MaterialId,
    /// Throughput of the path up to here.
    pub beta: Rgb,
    /// What the surface's own emission adds to the sample, weighted.
    pub emitted: Rgb,
    /// What light sampling adds here, weighted.
    pub direct: Rgb,
    /// The point on the light that did so; none of the environment.
    pub light: Option<DVec3>,
    /// Directions to the viewer and of the sampled scattering in the vertex's local frame, z being
    /// the shading normal. None where the path was not scattered. z of the second may be below 0:
    /// such a path ends.
    pub scattered: Option<[V3; 2]>,
}

/// Where a path left the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Escape {
    /// Its direction, unit.
    pub direction: DVec3,
    /// What the environment adds to the sample, weighted.
    pub found: Rgb,
}

struct Writer<'a> {
    tracer: &'a Tracer,
    record: PathRecord,
}

impl Writer<'_> {
    fn world(&self, p: V3) -> DVec3 {
        self.tracer.scene.placement().to_world(wide(p))
    }
}

fn wide(v: V3) -> DVec3 {
    DVec3::new(v.x.into(), v.y.into(), v.z.into())
}

impl Recorder for Writer<'_> {
    fn hit(&mut self, point: V3, material: MaterialId, beta: Rgb) {
        let point = self.world(point);
        let (emitted, direct) = (Rgb::BLACK, Rgb::BLACK);
        let vertex =
            PathVertex { point, material, beta, emitted, direct, light: None, scattered: None };
        self.record.vertices.push(vertex);
    }

    fn emitted(&mut self, found: Rgb) {
        if let Some(last) = self.record.vertices.last_mut() {
            last.emitted = found;
        }
    }

    fn lit(&mut self, found: Rgb, light: Option<V3>) {
        let light = light.map(|p| self.world(p));
        if let Some(last) = self.record.vertices.last_mut() {
            (last.direct, last.light) = (found, light);
        }
    }

    fn scattered(&mut self, wo: V3, wi: V3) {
        if let Some(last) = self.record.vertices.last_mut() {
            last.scattered = Some([wo, wi]);
        }
    }

    fn escaped(&mut self, d: V3, found: Rgb) {
        self.record.escape = Some(Escape { direction: wide(d), found });
    }
}

impl Tracer {
    /// [`Tracer::sample`] with all that its path hit: pass `pass` (from 0) of the pixel in column
    /// `x`, row `y` from the top, by the reference tracer. Its value has the same bits.
    pub fn record(&self, [x, y]: [u32; 2], pass: u64, scratch: &mut Scratch) -> PathRecord {
        let rules = WithErratum::new(self, self.model);
        let stream = Stream::new(self.seed, U32(x), U32(y), pass);
        let [dx, dy] = pair::<f32>(&stream, Slot::CAMERA);
        let ray = self.camera.ray(x as f32 + dx, y as f32 + dy);
        let record = PathRecord { value: Rgb::BLACK, vertices: Vec::new(), escape: None };
        let mut writer = Writer { tracer: self, record };
        let found = self.radiance(&rules, ray, &stream, scratch, &mut writer);
        PathRecord { value: rules.kept(found), ..writer.record }
    }
}
