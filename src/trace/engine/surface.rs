//! What rays met: fetched one by one, made into surfaces lane by lane.

use super::Paths;
use crate::brdf::{Lobes, Width};
use crate::geometry::{
    Geometry, Hit, NO_PLATE, PlateHits, SurfacePoint, flat_surface, resolve, shading_normal,
};
use crate::math::columns::{Column, Columns3};
use crate::math::lanes::{Bits, Lane, Mask, Packet, Wide};
use crate::math::table::Table;
use crate::math::{Rgb, V3};
use crate::scene::Material;

/// Kd; Ks; alpha; a_p; emission; how it reflects.
const FIELDS: usize = 12;

#[derive(Debug)]
pub(super) struct MaterialTable(Table<FIELDS>);

/// How a material reflects: not at all, as its lobes have it, with a weak specular lobe, or as a
/// mirror.
const REFLECTS: f32 = 1.0;
const WEAKLY: f32 = 2.0;
const MIRRORS: f32 = 3.0;

/// A specular lobe alone that is sharper than this is a mirror: what one path sees in it is of no use
/// to its neighbours.
const MIRROR_ALPHA: f32 = 0.05;

/// A specular lobe is weak if its reflectance at normal incidence is at most this part of all, and it
/// is at least this rough: then what it adds varies so little that one path's share of it is as good
/// as what all of a group could send.
const WEAK_SHARE: f32 = 0.1;
const WEAK_ALPHA: f32 = 0.2;

fn is_weak(lobes: &Lobes) -> bool {
    let [diffuse, specular] = [lobes.kd.luminance(), lobes.ks.luminance()];
    let is_there = !lobes.ks.is_black();
    is_there && specular <= WEAK_SHARE * (diffuse + specular) && lobes.width.alpha >= WEAK_ALPHA
}

/// Materials of lanes.
pub(super) struct Materials<P: Lane> {
    pub(super) lobes: Lobes<P>,
    pub(super) emission: Rgb<P>,
    pub(super) emits: P::Mask,
    pub(super) reflects: P::Mask,
    pub(super) weak: P::Mask,
    pub(super) mirror: P::Mask,
}

impl<P: Packet> Materials<P> {
    /// The part of the BRDF that paths share: all but a weak lobe.
    #[inline(always)]
    pub(super) fn shared_lobes(&self) -> Lobes<P> {
        let Lobes { kd, ks, width } = self.lobes;
        let strong = !self.weak;
        let ks = Rgb::new(ks.r.or_zero(strong), ks.g.or_zero(strong), ks.b.or_zero(strong));
        Lobes { kd, ks, width }
    }
}

impl MaterialTable {
    pub(super) fn new(materials: &[Material]) -> MaterialTable {
        let record = |m: &Material| {
            let (kd, ks, light) = (Rgb::from(m.kd), Rgb::from(m.ks), Rgb::from(m.emission));
            let width = Width::from(m.roughness);
            let reflects = match kd.is_black() && ks.is_black() {
                true => 0.0,
                false if is_weak(&Lobes { kd, ks, width }) => WEAKLY,
                false if kd.is_black() && width.alpha < MIRROR_ALPHA => MIRRORS,
                false => REFLECTS,
            };
            [
                kd.r,
                kd.g,
                kd.b,
                ks.r,
                ks.g,
                ks.b,
                width.alpha,
                width.exponent,
                light.r,
                light.g,
                light.b,
                reflects,
            ]
        };
        MaterialTable(Table::new(materials.iter().map(record).collect()))
    }

    /// One material's BRDF.
    #[inline(always)]
    pub(super) fn lobes(&self, index: u32) -> Lobes {
        let f = self.0.record(index as usize);
        Lobes {
            kd: Rgb::new(f[0], f[1], f[2]),
            ks: Rgb::new(f[3], f[4], f[5]),
            width: Width { alpha: f[6], exponent: f[7] },
        }
    }

    /// Whether a material has a specular lobe that is weak.
    #[inline(always)]
    pub(super) fn is_weak(&self, index: u32) -> bool {
        self.0.record(index as usize)[11] == WEAKLY
    }

    /// The part of a material's BRDF that paths share: all but a weak lobe.
    #[inline(always)]
    pub(super) fn shared_lobes(&self, index: u32) -> Lobes {
        let lobes = self.lobes(index);
        if self.is_weak(index) { Lobes { ks: Rgb::BLACK, ..lobes } } else { lobes }
    }

    #[inline(always)]
    pub(super) fn get<P: Packet>(&self, index: P::Bits) -> Materials<P> {
        let f = self.0.get::<P>(index);
        let emission = Rgb::new(f[8], f[9], f[10]);
        Materials {
            lobes: Lobes {
                kd: Rgb::new(f[0], f[1], f[2]),
                ks: Rgb::new(f[3], f[4], f[5]),
                width: Width { alpha: f[6], exponent: f[7] },
            },
            emission,
            emits: emission.max_channel().gt(P::splat(0.0)),
            reflects: f[11].gt(P::splat(0.0)),
            weak: f[11].equal(P::splat(WEAKLY)),
            mirror: f[11].equal(P::splat(MIRRORS)),
        }
    }
}

/// Where rays met surfaces.
#[derive(Clone, Debug, Default)]
pub(super) struct Met {
    pub(super) t: Column<f32>,
    b: [Column<f32>; 2],
    /// `u32::MAX` for nothing.
    pub(super) primitive: Column<u32>,
    pub(super) material: Column<u32>,
    pub(super) plate: Column<u32>,
    /// All ones where distance and weights are still to be found.
    rough: Column<u32>,
    /// A triangle's corners; another shape's point, normal and bound on the error.
    corners: [Columns3; 3],
    /// Normals of a smooth triangle's corners.
    normals: [Columns3; 3],
    kind: Column<u32>,
    /// [`Geometry::least_error`]
    least_error: f32,
}

/// So many triangles and their corners are in the processor's caches anyway.
const MANY: usize = 10_000;
/// How many hits before a shape is wanted its corners are asked for; its indices twice as many.
const AHEAD: usize = 8;

const NOTHING: u32 = 0;
const FLAT: u32 = 1;
const SMOOTH: u32 = 2;
const OTHER: u32 = 3;

/// Surfaces of lanes.
pub(super) struct Surfaces<P: Lane> {
    pub(super) hit: P::Mask,
    /// Its normals on either side.
    pub(super) point: SurfacePoint<P>,
}

impl Met {
    /// Takes down the plates that rays met, if any.
    #[inline(always)]
    pub(super) fn on_plates<P: Packet>(&mut self, at: usize, hits: &PlateHits<P>) {
        let none = P::Bits::splat(u32::MAX);
        let missed = P::equal_bits(hits.plate, P::Bits::splat(NO_PLATE));
        self.t.store(at, hits.t);
        self.primitive.store::<P>(at, P::select_bits(missed, none, hits.triangle));
        self.plate.store::<P>(at, hits.plate);
        self.rough.store::<P>(at, P::select_bits(missed, P::Bits::splat(0), none));
    }

    /// Takes down what one ray met.
    #[inline(always)]
    pub(super) fn set(&mut self, at: usize, hit: Option<Hit>, plate: u32) {
        let Hit { t, primitive, b } =
            hit.unwrap_or(Hit { t: f32::INFINITY, primitive: u32::MAX, b: [0.0; 2] });
        self.put(at, t, b, primitive, plate);
    }

    /// Takes down a hit by its numbers.
    #[inline(always)]
    pub(super) fn put(&mut self, at: usize, t: f32, b: [f32; 2], primitive: u32, plate: u32) {
        self.t.0[at] = t;
        self.primitive.0[at] = primitive;
        self.b[0].0[at] = b[0];
        self.b[1].0[at] = b[1];
        self.plate.0[at] = plate;
        self.rough.0[at] = 0;
    }

    /// The numbers of a hit, once all are found.
    pub(super) fn of(&self, at: usize) -> (f32, [f32; 2], u32, u32) {
        let b = [self.b[0].0[at], self.b[1].0[at]];
        (self.t.0[at], b, self.primitive.0[at], self.plate.0[at])
    }

    /// Finds distances and weights where they are not known yet; the shapes have to be there.
    #[inline(always)]
    pub(super) fn resolve<P: Packet>(&mut self, paths: &Paths, count: usize) {
        for at in (0..count).step_by(P::WIDTH) {
            let rough = !P::equal_bits(self.rough.load::<P>(at), P::Bits::splat(0));
            if !rough.any() {
                continue;
            }
            let [a, b, c] = &self.corners;
            let corners = [a.load::<P>(at), b.load::<P>(at), c.load::<P>(at)];
            let (o, d) = (paths.o.load::<P>(at), paths.d.load::<P>(at));
            let (t, b) = resolve(o, d, corners, rough);
            self.t.store(at, P::select(rough, t, self.t.load::<P>(at)));
            for (column, b) in self.b.iter_mut().zip(b) {
                column.store(at, P::select(rough, b, column.load::<P>(at)));
            }
        }
    }

    /// Gathers the shapes. Each is anywhere in memory, so memory is asked for those to come.
    #[inline(always)]
    pub(super) fn fetch<W: Wide>(&mut self, geometry: &Geometry, paths: &Paths, count: usize) {
        let (faces, vertices) = (geometry.faces(), geometry.vertices());
        self.least_error = geometry.least_error();
        for at in 0..count {
            if faces.len() > MANY {
                let primitives = &self.primitive.0[..count];
                let ahead = |n: usize| primitives.get(at + n).and_then(|&i| faces.get(i as usize));
                if let Some(face) = ahead(2 * AHEAD) {
                    W::prefetch(face);
                }
                if let Some(face) = ahead(AHEAD) {
                    for i in face.vertices {
                        W::prefetch(&vertices[i as usize]);
                    }
                }
            }
            let primitive = self.primitive.0[at];
            if primitive == u32::MAX {
                self.kind.0[at] = NOTHING;
                self.material.0[at] = 0;
                continue;
            }
            let Some(face) = faces.get(primitive as usize) else {
                self.material.0[at] = geometry.material(primitive);
                let b = [self.b[0].0[at], self.b[1].0[at]];
                let hit = Hit { t: self.t.0[at], primitive, b };
                let point = geometry.surface(&paths.ray(at), &hit);
                self.kind.0[at] = OTHER;
                for (column, v) in self.corners.iter_mut().zip([point.p, point.ng, point.error]) {
                    column.set(at, v);
                }
                continue;
            };
            self.material.0[at] = face.material;
            let corners = face.vertices.map(|i| vertices[i as usize]);
            for (column, vertex) in self.corners.iter_mut().zip(corners) {
                column.set(at, vertex.position);
            }
            let normals = corners.map(|vertex| V3::from(vertex.normal));
            if normals.contains(&V3::default()) {
                self.kind.0[at] = FLAT;
                continue;
            }
            self.kind.0[at] = SMOOTH;
            for (column, n) in self.normals.iter_mut().zip(normals) {
                column.set(at, n);
            }
        }
    }

    /// The surfaces of the members from `at` on.
    #[inline(always)]
    pub(super) fn surfaces<P: Packet>(&self, at: usize) -> Surfaces<P> {
        let kind = self.kind.load::<P>(at);
        let [a, b, c] = &self.corners;
        let corners = [a.load::<P>(at), b.load::<P>(at), c.load::<P>(at)];
        let weights = [self.b[0].load::<P>(at), self.b[1].load::<P>(at)];
        let mut point = flat_surface(corners, weights);
        point.error = point.error.max(V3::splat(P::splat(self.least_error)));
        let smooth = is::<P>(kind, SMOOTH);
        if smooth.any() {
            let [a, b, c] = &self.normals;
            let normals = [a.load::<P>(at), b.load::<P>(at), c.load::<P>(at)];
            point.ns = V3::select(smooth, shading_normal(point.ng, normals, weights), point.ng);
        }
        let other = is::<P>(kind, OTHER);
        if other.any() {
            let [p, n, error] = corners;
            point.p = V3::select(other, p, point.p);
            point.ng = V3::select(other, n, point.ng);
            point.ns = V3::select(other, n, point.ns);
            point.error = V3::select(other, error, point.error);
        }
        Surfaces { hit: !is::<P>(kind, NOTHING), point }
    }
}

#[inline(always)]
fn is<P: Packet>(kind: P::Bits, wanted: u32) -> P::Mask {
    P::equal_bits(kind, P::Bits::splat(wanted))
}
