//! Triangles: eight at once against one ray, and the surface at a hit.

use super::ray_origin::UNIT_ROUNDOFF;
use super::{Geometry, SurfacePoint};
use crate::math::simd::{MAX_WIDTH, Simd8, SimdWide};
use crate::math::{Mask, Simd, V3};
use bytemuck::{Pod, Zeroable};

/// Hits nearer than this, in units of the scene along the ray's fastest axis, have their distance
/// decided in f64.
const NEAR: f32 = 1.0 / 256.0;

/// Eight triangles by component: `v[vertex][axis][lane]`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub(super) struct TrianglePack8 {
    pub v: [[[f32; 8]; 3]; 3],
    pub id: [u32; 8],
}

impl TrianglePack8 {
    /// One to eight triangles. Lanes to spare hold no numbers and are never hit.
    pub(super) fn of(geometry: &Geometry, ids: &[u32]) -> TrianglePack8 {
        let mut pack = TrianglePack8 { v: [[[f32::NAN; 8]; 3]; 3], id: [u32::MAX; 8] };
        for (lane, &id) in ids.iter().enumerate().take(8) {
            pack.id[lane] = id;
            for (rows, p) in pack.v.iter_mut().zip(geometry.corners(id as usize)) {
                for (row, x) in rows.iter_mut().zip([p.x, p.y, p.z]) {
                    row[lane] = x;
                }
            }
        }
        pack
    }
}

/// A ray in the form that the triangle test wants: the axis along which it runs fastest becomes z,
/// and space is sheared so that the ray is that axis (Woop, Benthin and Wald, "Watertight
/// ray/triangle intersection", JCGT 2:1, 2013).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ShearedRay {
    k: [usize; 3],
    o: [f32; 3],
    s: [f32; 3],
}

impl ShearedRay {
    #[inline(always)]
    pub(super) fn new(o: V3, d: V3) -> ShearedRay {
        let d = [d.x, d.y, d.z];
        let a = d.map(f32::abs);
        // By arithmetic: no one can foretell these branches.
        let x_over_y = a[0] > a[1];
        let x_first = x_over_y & (a[0] > a[2]);
        let y_first = !x_over_y & (a[1] > a[2]);
        let kz = 2 - 2 * x_first as usize - y_first as usize;
        let (kx, ky) = ([1, 2, 0][kz], [2, 0, 1][kz]);
        let sz = 1.0 / d[kz];
        let o = [o.x, o.y, o.z];
        ShearedRay { k: [kx, ky, kz], o: [o[kx], o[ky], o[kz]], s: [d[kx] * sz, d[ky] * sz, sz] }
    }
}

/// Hits among eight triangles.
pub(super) struct PackHits<W> {
    /// Lane `i` as bit `i`.
    pub mask: u32,
    pub t: W,
    /// Weights of the second and third vertex.
    pub b: [W; 2],
}

/// All of the pack's triangles that the ray hits at `0 < t <= t_max`.
///
/// The signs of the three edge functions are exact for the sheared vertices: a difference of two
/// rounded products has the right sign or is zero, and zeros are decided again in f64, where the
/// products are exact. Shared vertices shear to the same numbers, so triangles agree about edges.
#[inline(always)]
pub(super) fn intersect<W: Simd8>(
    pack: &TrianglePack8,
    ray: &ShearedRay,
    t_max: f32,
) -> Option<PackHits<W>> {
    let zero = W::splat(0.0);
    let (ax, ay, az) = shear::<W>(&pack.v[0], ray);
    let (bx, by, bz) = shear::<W>(&pack.v[1], ray);
    let (cx, cy, cz) = shear::<W>(&pack.v[2], ray);
    let mut u = cx * by - cy * bx;
    let mut v = ax * cy - ay * cx;
    let mut w = bx * ay - by * ax;
    let on_edge = u.equal(zero) | v.equal(zero) | w.equal(zero);
    if on_edge.any() {
        let lanes = on_edge.bits();
        let x = [ax.store(), bx.store(), cx.store()];
        let y = [ay.store(), by.store(), cy.store()];
        (u, v, w) = decide_edges::<W>(lanes, x, y, [u.store(), v.store(), w.store()]);
    }
    let least = u.min(v).min(w);
    let most = u.max(v).max(w);
    let det = u + v + w;
    let inside = (least.ge(zero) | most.le(zero)) & !det.equal(zero);
    if !inside.any() {
        return None;
    }
    let inverse = W::splat(1.0) / det;
    let t = (u * az + v * bz + w * cz) * W::splat(ray.s[2]) * inverse;
    let ahead = inside & t.gt(zero);
    let near = ahead & t.le(W::splat(NEAR * ray.s[2].abs()));
    let (mask, t) = if near.any() {
        let (mask, t) = decide_distances(near.bits(), ahead.bits(), pack, ray, t_max, t.store());
        (mask, W::load(&t))
    } else {
        ((ahead & t.le(W::splat(t_max))).bits(), t)
    };
    (mask != 0).then(|| PackHits { mask, t, b: [v * inverse, w * inverse] })
}

/// Eight vertices in the ray's frame. (A function, not a closure: closures cannot be made to inline,
/// and SIMD code that is not inlined is not compiled for its instruction set.)
#[inline(always)]
fn shear<W: Simd8>(v: &[[f32; 8]; 3], ray: &ShearedRay) -> (W, W, W) {
    let [kx, ky, kz] = ray.k;
    let z = W::load(&v[kz]) - W::splat(ray.o[2]);
    let x = (W::load(&v[kx]) - W::splat(ray.o[0])) - W::splat(ray.s[0]) * z;
    let y = (W::load(&v[ky]) - W::splat(ray.o[1])) - W::splat(ray.s[1]) * z;
    (x, y, z)
}

/// The edge functions again in f64 for these lanes, kept apart from zero where they are not zero.
#[cold]
#[inline(never)]
fn decide_edges<W: Simd8>(
    lanes: u32,
    x: [[f32; 8]; 3],
    y: [[f32; 8]; 3],
    mut uvw: [[f32; 8]; 3],
) -> (W, W, W) {
    let cross = |a: usize, b: usize, i: usize| {
        let exact = x[a][i] as f64 * y[b][i] as f64 - y[a][i] as f64 * x[b][i] as f64;
        let rounded = exact as f32;
        if rounded == 0.0 && exact != 0.0 {
            f32::MIN_POSITIVE.copysign(exact as f32)
        } else {
            rounded
        }
    };
    for i in (0..8).filter(|i| lanes >> i & 1 != 0) {
        uvw[0][i] = cross(2, 1, i);
        uvw[1][i] = cross(0, 2, i);
        uvw[2][i] = cross(1, 0, i);
    }
    (W::load(&uvw[0]), W::load(&uvw[1]), W::load(&uvw[2]))
}

/// The distances again in f64 for these lanes, and which are hits then. Of a slender triangle the
/// weights are differences of nearly equal products, and a ray that leaves it could hit it again.
#[cold]
#[inline(never)]
fn decide_distances(
    near: u32,
    ahead: u32,
    pack: &TrianglePack8,
    ray: &ShearedRay,
    t_max: f32,
    mut t: [f32; 8],
) -> (u32, [f32; 8]) {
    for i in (0..8).filter(|i| near >> i & 1 != 0) {
        let corners = [0, 1, 2].map(|vertex| {
            let [x, y, z] = &pack.v[vertex];
            [x[i], y[i], z[i]]
        });
        t[i] = precise_distance(corners, ray).unwrap_or(t[i]);
    }
    let is_hit = |i: &usize| ahead >> i & 1 != 0 && t[*i] > 0.0 && t[*i] <= t_max;
    ((0..8).filter(is_hit).fold(0, |mask, i| mask | 1 << i), t)
}

/// The distance along a ray that hits the plane of these corners, from f64; `None` where it
/// overflows.
fn precise_distance(corners: [[f32; 3]; 3], ray: &ShearedRay) -> Option<f32> {
    let [kx, ky, kz] = ray.k;
    let [ox, oy, oz] = ray.o.map(f64::from);
    let [sx, sy, sz] = ray.s.map(f64::from);
    let [a, b, c] = corners.map(|corner| {
        let corner = corner.map(f64::from);
        let z = corner[kz] - oz;
        [corner[kx] - ox - sx * z, corner[ky] - oy - sy * z, z]
    });
    let cross = |p: [f64; 3], q: [f64; 3]| p[0] * q[1] - p[1] * q[0];
    let (u, v, w) = (cross(c, b), cross(a, c), cross(b, a));
    let distance = (u * a[2] + v * b[2] + w * c[2]) / (u + v + w) * sz;
    distance.is_finite().then_some(distance as f32)
}

/// Distances and weights of rays that are known to hit these triangles clear of their edges: the
/// very numbers that [`intersect`] gives. Where `wanted` is not set they mean nothing.
#[inline(always)]
pub(crate) fn resolve<P: SimdWide>(
    o: V3<P>,
    d: V3<P>,
    corners: [V3<P>; 3],
    wanted: P::Mask,
) -> (P, [P; 2]) {
    let a = d.abs();
    let x_first = a.x.gt(a.y) & a.x.gt(a.z);
    let y_first = !a.x.gt(a.y) & a.y.gt(a.z);
    let axes = [x_first, y_first];
    let [dx, dy, dz] = turned(d, axes);
    let [ox, oy, oz] = turned(o, axes);
    let sz = P::splat(1.0) / dz;
    let (sx, sy) = (dx * sz, dy * sz);
    let mut sheared = [V3::splat(sz); 3];
    for (sheared, corner) in sheared.iter_mut().zip(corners) {
        let [x, y, z] = turned(corner, axes);
        let z = z - oz;
        *sheared = V3::new((x - ox) - sx * z, (y - oy) - sy * z, z);
    }
    let [a, b, c] = sheared;
    let u = c.x * b.y - c.y * b.x;
    let v = a.x * c.y - a.y * c.x;
    let w = b.x * a.y - b.y * a.x;
    let inverse = P::splat(1.0) / (u + v + w);
    let t = (u * a.z + v * b.z + w * c.z) * sz * inverse;
    let near = wanted & t.le(P::splat(NEAR) * sz.abs());
    let t = if near.any() { resolve_near(o, d, corners, near.bits(), t) } else { t };
    (t, [v * inverse, w * inverse])
}

/// The components in the order of a ray's frame: z along its fastest axis.
#[inline(always)]
fn turned<P: SimdWide>(v: V3<P>, [x_first, y_first]: [P::Mask; 2]) -> [P; 3] {
    [
        P::select(x_first, v.y, P::select(y_first, v.z, v.x)),
        P::select(x_first, v.z, P::select(y_first, v.x, v.y)),
        P::select(x_first, v.x, P::select(y_first, v.y, v.z)),
    ]
}

#[cold]
#[inline(never)]
fn resolve_near<P: SimdWide>(o: V3<P>, d: V3<P>, corners: [V3<P>; 3], lanes: u32, t: P) -> P {
    let (mut rays, mut points, mut distances) =
        ([[0.0; MAX_WIDTH]; 6], [[[0.0; MAX_WIDTH]; 3]; 3], [0.0; MAX_WIDTH]);
    for (column, x) in rays.iter_mut().zip([o.x, o.y, o.z, d.x, d.y, d.z]) {
        x.store(column);
    }
    for (columns, corner) in points.iter_mut().zip(corners) {
        for (column, x) in columns.iter_mut().zip([corner.x, corner.y, corner.z]) {
            x.store(column);
        }
    }
    t.store(&mut distances);
    for lane in (0..P::WIDTH).filter(|lane| lanes >> lane & 1 != 0) {
        let [ox, oy, oz, dx, dy, dz] = rays.map(|column| column[lane]);
        let ray = ShearedRay::new(V3::new(ox, oy, oz), V3::new(dx, dy, dz));
        let corners = points.map(|columns| columns.map(|column| column[lane]));
        distances[lane] = precise_distance(corners, &ray).unwrap_or(distances[lane]);
    }
    P::load(&distances)
}

/// The surface at barycentric weights `b` of the second and third vertex.
#[inline(always)]
pub(super) fn surface(geometry: &Geometry, triangle: usize, b: [f32; 2]) -> SurfacePoint {
    let vertices = geometry.vertices();
    let corners = geometry.faces()[triangle].vertices.map(|i| vertices[i as usize]);
    let flat = flat_surface(corners.map(|v| V3::from(v.position)), b);
    let n = corners.map(|v| V3::from(v.normal));
    if n.contains(&V3::default()) {
        return flat;
    }
    SurfacePoint { ns: shading_normal(flat.ng, n, b), ..flat }
}

/// The surface of triangles with these corners, without regard to normals of the corners.
#[inline(always)]
pub(crate) fn flat_surface<L: Simd>([v0, v1, v2]: [V3<L>; 3], [b1, b2]: [L; 2]) -> SurfacePoint<L> {
    let b0 = L::splat(1.0) - b1 - b2;
    let p = v0 * b0 + v1 * b1 + v2 * b2;
    let size = v0.abs().max_component().max(v1.abs().max_component()).max(v2.abs().max_component());
    // Rebuilding the point costs 4 unit roundoffs of the largest corner, hitting the plane again from
    // anywhere off it about 10 more. The test shears space, so that a rounding along one axis shows
    // along the others too: even a floor at height 0 exactly is hit again at a height that is not.
    let error = V3::splat(size * L::splat(16.0 * UNIT_ROUNDOFF));
    // A point that rounding has put past an edge may lie behind the neighbouring face. A step of
    // the error's size towards the middle brings it back.
    let inwards = (v0 + v1 + v2) * L::splat(1.0 / 3.0) - p;
    let reach = inwards.abs().max_component();
    let step = L::splat(2.0) * error.x;
    let p = V3::select(reach.gt(step), p + inwards * (step / reach), p);
    let ng = (v1 - v0).cross(v2 - v0).normalize();
    SurfacePoint { p, ng, ns: ng, error }
}

/// The normals of the corners blended; `ng` where they cancel.
#[inline(always)]
pub(crate) fn shading_normal<L: Simd>(ng: V3<L>, n: [V3<L>; 3], [b1, b2]: [L; 2]) -> V3<L> {
    let b0 = L::splat(1.0) - b1 - b2;
    let sum = n[0] * b0 + n[1] * b1 + n[2] * b2;
    let length2 = sum.length2();
    V3::select(length2.lt(L::splat(1e-12)), ng, sum * (L::splat(1.0) / length2.sqrt()))
}
