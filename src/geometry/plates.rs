//! The few large flat faces of a scene: tried one after the other by as many rays at a time as a
//! register holds. Walls, floors and boxes are met by nearly every ray, and a tree only delays that.
//!
//! A quick test decides where it is sure: by more than all roundings of its own and of the
//! [exact one](super::triangle). Rays that pass too near an edge, or through two faces at nearly the
//! same distance, are marked as open, and the exact test decides about them. So no hit depends on
//! the quick one.

use super::offset::ROUNDING;
use super::{Geometry, Kind};
use crate::math::V3;
use crate::math::lanes::{Bits, Mask, Packet};
use glam::DVec3;

/// A plate that is none.
pub(crate) const NO_PLATE: u32 = u32::MAX;
/// Most plates of a scene.
const MOST: usize = 64;
/// Scenes of so few triangles are plates altogether.
const FEW: usize = 96;
/// Otherwise triangles of at least this part of half the surface of the scene's box are.
const LARGE: f64 = 1.0 / 256.0;
/// A triangle's longest side squared over twice its area is at most this: of slender ones distances
/// are not known well enough.
const SLENDER: f64 = 64.0;
/// Roundings of 1 + the origin's largest coordinate that decisions keep clear of, across a plane.
const CLEARANCE: f32 = 64.0;
/// What is this far to one side of a plate does not meet it: several times the clearance above for
/// points of the scene, whose coordinates are within 1, and their distance from the surface.
const ASIDE: f32 = 16.0 * CLEARANCE * ROUNDING;
/// Corners of a four-sided plate lie in its plane to within this.
const FLAT: f64 = 4.0 * ROUNDING as f64;

/// A triangle, or two that make a convex quadrilateral.
#[derive(Clone, Debug)]
struct Plate {
    /// Unit normal and its product with the points of the plane.
    n: V3,
    d: f32,
    /// Inwards across each edge: unit, and its product with the edge's points. A triangle's last
    /// edge is there twice.
    edges: [(V3, f32); 4],
    /// Across the diagonal, towards the second triangle.
    diagonal: (V3, f32),
    triangles: [u32; 2],
    slenderness: f32,
}

/// All plates of a scene.
#[derive(Clone, Debug, Default)]
pub(crate) struct Plates {
    plates: Vec<Plate>,
    /// The places of all of them.
    all: Vec<u32>,
    /// Those that bodies may lie behind, as seen from between surfaces: not on the convex hull.
    inner: Vec<u32>,
    /// The inner ones by component, for [`Plates::between`].
    shades: Box<Shades>,
    /// Triangles and their plates, by triangle.
    plate_of: Vec<(u32, u32)>,
}

/// Planes and bounds of plates: normal, its product with the points of the plane, lowest and
/// highest corner.
#[derive(Clone, Debug)]
struct Shades {
    n: [[f32; MOST]; 3],
    d: [f32; MOST],
    bounds: [[[f32; MOST]; 3]; 2],
}

impl Default for Shades {
    fn default() -> Shades {
        let zero = [0.0; MOST];
        Shades { n: [zero; 3], d: zero, bounds: [[zero; 3]; 2] }
    }
}

/// What as many rays met.
pub(crate) struct PlateHits<P: Packet> {
    /// Distance, roughly; what it was at the start where nothing was met.
    pub(crate) t: P,
    /// How roughly.
    pub(crate) within: P,
    /// [`NO_PLATE`] for none.
    pub(crate) plate: P::Bits,
    /// The triangle; without meaning where there is no plate.
    pub(crate) triangle: P::Bits,
    /// Where the exact test has to decide.
    pub(crate) open: P::Mask,
}

impl Plates {
    /// Picks the plates out of a scene.
    pub(crate) fn new(geometry: &Geometry) -> Plates {
        let mut candidates = candidates(geometry);
        candidates.sort_by(|a, b| b.area.total_cmp(&a.area).then(a.triangle.cmp(&b.triangle)));
        candidates.truncate(2 * MOST);
        let mut plates = Vec::new();
        let mut used = vec![false; candidates.len()];
        for i in 0..candidates.len() {
            if used[i] || plates.len() == MOST {
                continue;
            }
            used[i] = true;
            let partner = (i + 1..candidates.len()).find_map(|j| {
                let plate = (!used[j]).then(|| quad(&candidates[i], &candidates[j]))??;
                Some((j, plate))
            });
            plates.push(match partner {
                Some((j, plate)) => {
                    used[j] = true;
                    plate
                }
                None => alone(&candidates[i]),
            });
        }
        let mut plate_of: Vec<(u32, u32)> = (0..)
            .zip(&plates)
            .flat_map(|(at, plate)| plate.triangles.map(|triangle| (triangle, at)))
            .collect();
        plate_of.sort_unstable();
        plate_of.dedup();
        let all: Vec<u32> = (0..plates.len() as u32).collect();
        let hides = |&&i: &&u32| !is_on_the_hull(geometry, &plates[i as usize]);
        let inner: Vec<u32> = all.iter().filter(hides).copied().collect();
        let mut shades = Box::<Shades>::default();
        for (i, &at) in inner.iter().enumerate() {
            let Plate { n, d, triangles, .. } = &plates[at as usize];
            shades.d[i] = *d;
            let corners = triangles.map(|triangle| geometry.corners(triangle as usize));
            for axis in 0..3 {
                let of = |v: V3| [v.x, v.y, v.z][axis];
                shades.n[axis][i] = of(*n);
                let along = || corners.iter().flatten().map(|corner| of(*corner));
                shades.bounds[0][axis][i] = along().fold(f32::INFINITY, f32::min) - ASIDE;
                shades.bounds[1][axis][i] = along().fold(f32::NEG_INFINITY, f32::max) + ASIDE;
            }
        }
        Plates { plates, all, inner, shades, plate_of }
    }

    /// Which of the inner plates may be met on the way from a point to any point of a box, given by
    /// its corners: bit `i` for the `i`th of them. Coordinates are those of surfaces of the scene.
    #[inline(always)]
    pub(crate) fn between<P: Packet>(&self, p: V3, [low, high]: [V3; 2]) -> u64 {
        let (p_lanes, half) = (p.splat_lanes::<P>(), 0.5);
        let middle = ((low + high) * half).splat_lanes::<P>();
        let reach = ((high - low) * half).splat_lanes::<P>();
        let (lowest, highest) = (low.min(p).splat_lanes::<P>(), high.max(p).splat_lanes::<P>());
        let aside = P::splat(ASIDE);
        let Shades { n, d, bounds } = &*self.shades;
        let mut found = 0;
        for at in (0..self.inner.len()).step_by(P::WIDTH) {
            let load = |rows: &[[f32; MOST]; 3]| {
                V3::new(P::load(&rows[0][at..]), P::load(&rows[1][at..]), P::load(&rows[2][at..]))
            };
            let (n, d) = (load(n), P::load(&d[at..]));
            let (height, centre) = (n.dot(p_lanes) - d, n.dot(middle) - d);
            let spread = n.abs().dot(reach);
            let above = height.min(centre - spread).gt(aside);
            let below = height.max(centre + spread).lt(-aside);
            let (from, to) = (load(&bounds[0]), load(&bounds[1]));
            let apart = from.x.gt(highest.x)
                | from.y.gt(highest.y)
                | from.z.gt(highest.z)
                | to.x.lt(lowest.x)
                | to.y.lt(lowest.y)
                | to.z.lt(lowest.z);
            let may = !(above | below | apart);
            let some = self.inner.len() - at;
            let there = if some >= P::WIDTH { u64::MAX } else { (1 << some) - 1 };
            let lanes = if P::WIDTH == 32 { u64::MAX } else { (1 << P::WIDTH) - 1 };
            found |= (u64::from(may.bits()) & there & lanes) << at;
        }
        found
    }

    /// The triangles that belong to plates, in order.
    pub(super) fn triangles(&self) -> impl Iterator<Item = u32> {
        self.plate_of.iter().map(|(triangle, _)| *triangle)
    }

    /// The plate that a primitive belongs to, or [`NO_PLATE`].
    pub(crate) fn plate_of(&self, primitive: u32) -> u32 {
        let found = self.plate_of.binary_search_by_key(&primitive, |(triangle, _)| *triangle);
        found.map_or(NO_PLATE, |i| self.plate_of[i].1)
    }

    /// The nearest plates that rays meet, but for the one each leaves from.
    #[inline(always)]
    pub(crate) fn closest<P: Packet>(&self, o: V3<P>, d: V3<P>, from: P::Bits) -> PlateHits<P> {
        let (clearance, zero) = ([clearance(o), d.length()], P::splat(0.0));
        let mut hits = PlateHits {
            t: P::splat(f32::INFINITY),
            within: P::splat(0.0),
            plate: P::Bits::splat(NO_PLATE),
            triangle: P::Bits::splat(0),
            open: P::mask(0),
        };
        for (at, plate) in (0..).zip(&self.plates) {
            let met = plate.meet(o, d, clearance);
            let own = P::equal_bits(from, P::Bits::splat(at));
            let [most, least] = met.depth(hits.t);
            let outside = own | most.lt(zero);
            if outside.all() {
                continue;
            }
            let nearer = least.gt(zero) & !own;
            let (m, c) = plate.diagonal;
            let second = dot(m, met.x) - P::splat(c);
            let known = outside | (nearer & second.abs().gt(met.band));
            hits.open = hits.open | !known;
            let [a, b] = plate.triangles.map(P::Bits::splat);
            let triangle = P::select_bits(second.gt(zero), b, a);
            hits.t = P::select(nearer, met.t, hits.t);
            hits.within = P::select(nearer, met.within, hits.within);
            hits.plate = P::select_bits(nearer, P::Bits::splat(at), hits.plate);
            hits.triangle = P::select_bits(nearer, triangle, hits.triangle);
        }
        hits
    }

    /// Which of the rays certainly meet a plate before `t_max`, other than the ones they leave from
    /// and go to, and which may. `between` says that all of them run from surface to surface.
    #[inline(always)]
    pub(crate) fn occluded<P: Packet>(
        &self,
        o: V3<P>,
        d: V3<P>,
        t_max: P,
        [from, to]: [P::Bits; 2],
        mut live: P::Mask,
        between: bool,
    ) -> [P::Mask; 2] {
        let clearance = [clearance(o), d.length()];
        let candidates = if between { &self.inner } else { &self.all };
        let mut shadow = Shadow { blocked: P::mask(0), open: P::mask(0) };
        for &at in candidates {
            live = live & !self.shade(at, &mut shadow, (o, d, t_max), [from, to], clearance);
            if !live.any() {
                break;
            }
        }
        [shadow.blocked, shadow.open & !shadow.blocked]
    }

    /// [`Plates::occluded`] from surface to surface by those of the inner plates alone that
    /// [`Plates::between`] has found.
    #[inline(always)]
    pub(crate) fn occluded_by<P: Packet>(
        &self,
        mut which: u64,
        o: V3<P>,
        d: V3<P>,
        t_max: P,
        ends: [P::Bits; 2],
        mut live: P::Mask,
    ) -> [P::Mask; 2] {
        let clearance = [clearance(o), d.length()];
        let mut shadow = Shadow { blocked: P::mask(0), open: P::mask(0) };
        while which != 0 && live.any() {
            let at = self.inner[which.trailing_zeros() as usize];
            which &= which - 1;
            live = live & !self.shade(at, &mut shadow, (o, d, t_max), ends, clearance);
        }
        [shadow.blocked, shadow.open & !shadow.blocked]
    }

    /// Adds the shadow of one plate; returns the rays that certainly meet it.
    #[inline(always)]
    fn shade<P: Packet>(
        &self,
        at: u32,
        shadow: &mut Shadow<P>,
        (o, d, t_max): (V3<P>, V3<P>, P),
        [from, to]: [P::Bits; 2],
        clearance: [P; 2],
    ) -> P::Mask {
        let met = self.plates[at as usize].meet(o, d, clearance);
        let this = P::Bits::splat(at);
        let own = P::equal_bits(from, this) | P::equal_bits(to, this);
        let [most, least] = met.depth(t_max);
        let outside = own | most.lt(P::splat(0.0));
        let inside = least.gt(P::splat(0.0)) & !own;
        shadow.blocked = shadow.blocked | inside;
        shadow.open = shadow.open | !(outside | inside);
        inside
    }
}

/// Rays that certainly meet a plate, and those that may.
struct Shadow<P: Packet> {
    blocked: P::Mask,
    open: P::Mask,
}

/// A ray and a plate.
struct Meeting<P> {
    x: V3<P>,
    t: P,
    /// How far off the distance may be.
    within: P,
    /// How far inside the point is.
    inside: P,
    /// How far off that may be.
    band: P,
}

impl<P: Packet> Meeting<P> {
    /// How far within the edges, ahead of the ray's start and before `t_max` it is, by the least of
    /// the three: at most, and at least. Of a ray along the plane neither is above or below 0.
    #[inline(always)]
    fn depth(&self, t_max: P) -> [P; 2] {
        let before = t_max - self.t;
        let most = (self.inside + self.band).min(self.t + self.within).min(before + self.within);
        let least = (self.inside - self.band).min(self.t - self.within).min(before - self.within);
        [most, least]
    }
}

impl Plate {
    #[inline(always)]
    fn meet<P: Packet>(&self, o: V3<P>, d: V3<P>, [clearance, length]: [P; 2]) -> Meeting<P> {
        let inverse = dot(self.n, d).recip();
        let t = (P::splat(self.d) - dot(self.n, o)) * inverse;
        let x = V3::new(d.x.mul_add(t, o.x), d.y.mul_add(t, o.y), d.z.mul_add(t, o.z));
        let [a, b, c, e] = &self.edges;
        let ab = across(a, x).min(across(b, x));
        let ce = across(c, x).min(across(e, x));
        // By so much in distances, which are in units of the ray's length; across the plane a unit
        // of distance is that length at most.
        let roughly = clearance * inverse.abs();
        let within = roughly * P::splat(self.slenderness);
        Meeting { x, t, within, inside: ab.min(ce), band: roughly * length }
    }
}

#[inline(always)]
fn dot<P: Packet>(n: V3, v: V3<P>) -> P {
    let y = v.y.mul_add(P::splat(n.y), v.x * P::splat(n.x));
    v.z.mul_add(P::splat(n.z), y)
}

#[inline(always)]
fn across<P: Packet>((m, c): &(V3, f32), x: V3<P>) -> P {
    dot(*m, x) - P::splat(*c)
}

/// Roundings are in proportion to the largest number that took part.
#[inline(always)]
fn clearance<P: Packet>(o: V3<P>) -> P {
    (o.abs().max_component() + P::splat(1.0)) * P::splat(CLEARANCE * ROUNDING)
}

struct Candidate {
    triangle: u32,
    corners: [DVec3; 3],
    /// Not normalised.
    normal: DVec3,
    area: f64,
    slenderness: f64,
}

fn candidates(geometry: &Geometry) -> Vec<Candidate> {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for p in &geometry.positions {
        (low, high) = (low.min(wide(*p)), high.max(wide(*p)));
    }
    let size = (high - low).max(DVec3::ZERO);
    let box_area = size.x * size.y + size.y * size.z + size.z * size.x;
    let least = if geometry.triangles.len() <= FEW { 0.0 } else { LARGE * box_area };
    let candidate = |triangle: usize| {
        let corners = geometry.corners(triangle).map(wide);
        let sides = [0, 1, 2].map(|i| (corners[(i + 1) % 3] - corners[i]).length_squared());
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let area = 0.5 * normal.length();
        let slenderness = sides.into_iter().fold(0.0, f64::max) / (2.0 * area);
        let triangle = triangle as u32;
        let fits = area > 0.0 && area >= least && slenderness <= SLENDER;
        fits.then_some(Candidate { triangle, corners, normal, area, slenderness })
    };
    (0..geometry.triangles.len()).filter_map(candidate).collect()
}

fn wide(v: V3) -> DVec3 {
    DVec3::new(v.x.into(), v.y.into(), v.z.into())
}

fn narrow(v: DVec3) -> V3 {
    V3::from(v.as_vec3().to_array())
}

/// The line through two points of a plane, `n` its unit normal: inwards where the corners run
/// counter-clockwise about it.
fn edge(n: DVec3, a: DVec3, b: DVec3) -> (V3, f32) {
    let m = n.cross(b - a).normalize();
    (narrow(m), m.dot(a) as f32)
}

fn plane(corners: &[DVec3], normal: DVec3) -> (DVec3, f64) {
    let n = normal.normalize();
    (n, corners.iter().map(|c| n.dot(*c)).sum::<f64>() / corners.len() as f64)
}

fn alone(candidate: &Candidate) -> Plate {
    let [a, b, c] = candidate.corners;
    let (n, d) = plane(&candidate.corners, candidate.normal);
    let last = edge(n, c, a);
    Plate {
        n: narrow(n),
        d: d as f32,
        edges: [edge(n, a, b), edge(n, b, c), last, last],
        // Every point is on the near side of it.
        diagonal: (V3::default(), 1e30),
        triangles: [candidate.triangle; 2],
        slenderness: candidate.slenderness as f32,
    }
}

/// The convex quadrilateral of two triangles with a common side in one plane, if it is one.
fn quad(first: &Candidate, second: &Candidate) -> Option<Plate> {
    let [p, q] = [&first.corners, &second.corners];
    let lone = |these: &[DVec3; 3], those: &[DVec3; 3]| {
        let mut alone = (0..3).filter(|&i| !those.contains(&these[i]));
        alone.next().filter(|_| alone.next().is_none())
    };
    let (i, j) = (lone(p, q)?, lone(q, p)?);
    // Counter-clockwise about the first triangle's normal, the common side from b to e.
    let (a, b, e, c) = (p[i], p[(i + 1) % 3], p[(i + 2) % 3], q[j]);
    let corners = [a, b, c, e];
    let (n, d) = plane(&corners, first.normal);
    let flat = corners.iter().all(|corner| (n.dot(*corner) - d).abs() <= FLAT);
    let turns = |i: usize| {
        let [before, at, after] = [corners[i], corners[(i + 1) % 4], corners[(i + 2) % 4]];
        (at - before).cross(after - at).dot(n)
    };
    let convex = (0..4).all(|i| turns(i) > 1e-3 * first.area.min(second.area));
    if !flat || !convex {
        return None;
    }
    let (m, c0) = edge(n, b, e);
    Some(Plate {
        n: narrow(n),
        d: d as f32,
        edges: [edge(n, a, b), edge(n, b, c), edge(n, c, e), edge(n, e, a)],
        diagonal: (-m, -c0),
        triangles: [first.triangle, second.triangle],
        slenderness: first.slenderness.max(second.slenderness) as f32,
    })
}

/// Whether the whole scene is on one side of the plate's plane.
fn is_on_the_hull(geometry: &Geometry, plate: &Plate) -> bool {
    let (n, d) = (wide(plate.n), f64::from(plate.d));
    let (mut low, mut high) = (0.0f64, 0.0f64);
    let mut extend = |p: V3, by: f32| {
        let height = n.dot(wide(p)) - d;
        low = low.min(height - f64::from(by));
        high = high.max(height + f64::from(by));
    };
    for triangle in 0..geometry.triangles.len() {
        geometry.corners(triangle).into_iter().for_each(|p| extend(p, 0.0));
    }
    for primitive in geometry.triangles.len()..geometry.len() {
        match geometry.kind(primitive as u32) {
            Kind::Sphere(i) => extend(geometry.spheres[i].centre, geometry.spheres[i].radius),
            Kind::Cylinder(i) => {
                let cylinder = &geometry.cylinders[i];
                let reach = cylinder.radius + cylinder.height;
                extend(cylinder.base, reach);
            }
            Kind::Triangle(_) => {}
        }
    }
    low.max(-high) >= -FLAT
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Hit, Ray, offset_origin, resolve};
    use crate::math::lanes::{Isa, Kernel, Wide, dispatch};
    use crate::scene::{Material, Mesh, Scene, SceneBuilder};
    use glam::DAffine3;

    /// Numbers in [0, 1) in an order without pattern.
    struct Numbers(u64);
    impl Numbers {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (self.0 >> 11) as f64 / (1u64 << 53) as f64
        }
        fn point(&mut self) -> DVec3 {
            DVec3::new(self.next(), self.next(), self.next()) * 2.0 - 1.0
        }
    }

    /// A closed room with boxes in it, turned, and loose triangles that cut through them.
    fn room(numbers: &mut Numbers) -> Scene {
        let mut b = SceneBuilder::new("room");
        let clay = b.material(Material::reflecting("clay", [0.5; 3], [0.0; 3], 1.0).unwrap());
        let mut soup = Mesh::default();
        for _ in 0..12 {
            let p = numbers.point() * 0.7;
            soup.positions.extend([(); 3].map(|()| p + numbers.point() * 0.4));
            let n = soup.positions.len() as u32;
            soup.triangles.push([n - 3, n - 2, n - 1]);
        }
        b.mesh(&soup, DAffine3::IDENTITY, clay).unwrap();
        b.cuboid(DVec3::splat(-1.0), DVec3::splat(2.0), clay).unwrap();
        for _ in 0..4 {
            b.cuboid(numbers.point() * 0.6, numbers.point() * 0.3 + DVec3::splat(0.35), clay)
                .unwrap();
        }
        b.build()
    }

    /// What as many rays met by the quick test and then the exact distance: t, triangle, weights,
    /// and whether it is open; and for the same rays cut at `t_max` whether they are blocked.
    struct Quick<'a> {
        scene: &'a Scene,
        rays: &'a [Segment],
    }
    /// A ray, how far it goes, and the plates at its ends.
    type Segment = (Ray, f32, [u32; 2]);
    type Answer = (Option<Hit>, bool, [bool; 2]);

    impl Kernel for Quick<'_> {
        type Output = Vec<Answer>;
        #[inline(always)]
        fn run<W: Wide, P: Packet>(self) -> Vec<Answer> {
            let (plates, geometry) = (self.scene.bvh().plates(), self.scene.geometry());
            let mut answers = Vec::new();
            for rays in self.rays.chunks_exact(16) {
                for rays in rays.chunks_exact(P::WIDTH) {
                    let column = |f: &dyn Fn(&Segment) -> f32| {
                        let mut x = [0.0; 16];
                        x.iter_mut().zip(rays).for_each(|(x, ray)| *x = f(ray));
                        P::load(&x)
                    };
                    let ends = [0, 1].map(|end: usize| {
                        let mut x = [0; 16];
                        x.iter_mut().zip(rays).for_each(|(x, ray)| *x = ray.2[end]);
                        P::load_bits(&x)
                    });
                    let o =
                        V3::new(column(&|r| r.0.o.x), column(&|r| r.0.o.y), column(&|r| r.0.o.z));
                    let d =
                        V3::new(column(&|r| r.0.d.x), column(&|r| r.0.d.y), column(&|r| r.0.d.z));
                    let t_max = column(&|r| r.1);
                    let hits = plates.closest::<P>(o, d, ends[0]);
                    let between = (t_max.lt(P::splat(f32::INFINITY))).all();
                    let all = P::mask(u32::MAX);
                    let [blocked, unsure] = plates.occluded::<P>(o, d, t_max, ends, all, between);
                    let (mut plate, mut triangle) = ([0; 16], [0; 16]);
                    P::store_bits(hits.plate, &mut plate);
                    P::store_bits(hits.triangle, &mut triangle);
                    let corner = |vertex: usize| {
                        let of = |axis: usize| {
                            let mut x = [0.0; 16];
                            for lane in 0..P::WIDTH {
                                let p = geometry.corners(triangle[lane] as usize)[vertex];
                                x[lane] = [p.x, p.y, p.z][axis];
                            }
                            P::load(&x)
                        };
                        V3::new(of(0), of(1), of(2))
                    };
                    let corners = [corner(0), corner(1), corner(2)];
                    let (t, b) = resolve::<P>(o, d, corners, P::mask(u32::MAX));
                    let mut found = [[0.0; 16]; 3];
                    for (found, x) in found.iter_mut().zip([t, b[0], b[1]]) {
                        x.store(found);
                    }
                    for lane in 0..P::WIDTH {
                        let bit = |mask: P::Mask| mask.bits() >> lane & 1 != 0;
                        let [t, b1, b2] = found.map(|x| x[lane]);
                        let hit = Hit { t, primitive: triangle[lane], b: [b1, b2] };
                        let hit = (plate[lane] != NO_PLATE).then_some(hit);
                        answers.push((hit, bit(hits.open), [bit(blocked), bit(unsure)]));
                    }
                }
            }
            answers
        }
    }

    /// Rays from anywhere, from surfaces, and at the very edges and corners; some of them from
    /// surface to surface.
    fn rays(scene: &Scene, numbers: &mut Numbers) -> Vec<Segment> {
        let (geometry, plates) = (scene.geometry(), scene.bvh().plates());
        let count = geometry.triangles.len();
        let mut rays = Vec::new();
        while rays.len() < 1 << 15 {
            let mut pick = || ((numbers.next() * count as f64) as usize).min(count - 1);
            let (here, there) = (pick(), pick());
            let weights = match rays.len() % 4 {
                0 => [0.0, 0.0],
                1 => [numbers.next() as f32, 0.0],
                _ => [0.5 * numbers.next() as f32, 0.5 * numbers.next() as f32],
            };
            let target = geometry.triangle_surface(there, weights);
            let inside = [0.5 * numbers.next() as f32, 0.5 * numbers.next() as f32];
            let start = geometry.triangle_surface(here, inside);
            let wi = target.p - start.p;
            if wi.length2() < 1e-6 {
                continue;
            }
            let wi = wi.normalize();
            // Along its own face a ray has no business, and the exact test none to do.
            if start.ng.dot(wi).abs().min(target.ng.dot(wi).abs()) < 1e-3 {
                continue;
            }
            let ng = if start.ng.dot(wi) < 0.0 { -start.ng } else { start.ng };
            let o = offset_origin(start.p, start.error, ng, wi);
            let from = plates.plate_of(here as u32);
            if rays.len() % 2 == 0 {
                let anywhere = narrow(numbers.point() * 0.9);
                let d = target.p - anywhere;
                let ray = Ray { o: anywhere, d: d.normalize() };
                rays.push((ray, f32::INFINITY, [NO_PLATE; 2]));
            } else if rays.len() % 32 < 16 {
                rays.push((Ray { o, d: wi }, f32::INFINITY, [from, NO_PLATE]));
            } else {
                let d = offset_origin(target.p, target.error, target.ng, -wi) - o;
                let to = plates.plate_of(there as u32);
                rays.push((Ray { o, d }, 1.0 - 16.0 * f32::EPSILON, [from, to]));
            }
        }
        // Such that whole registers run from surface to surface.
        rays.sort_by_key(|ray| ray.1 < 1.0);
        rays
    }

    #[test]
    fn what_is_not_left_open_is_exactly_right() {
        let mut numbers = Numbers(7);
        for _ in 0..4 {
            let scene = room(&mut numbers);
            let (bvh, geometry) = (scene.bvh(), scene.geometry());
            assert!(bvh.plates().plates.len() > 20);
            let rays = rays(&scene, &mut numbers);
            let mut stack = bvh.stack();
            for isa in Isa::available() {
                let answers = dispatch(isa, Quick { scene: &scene, rays: &rays });
                assert_eq!(answers.len(), rays.len());
                let (mut open, mut unsure) = (0, 0);
                for ((ray, t_max, _), (hit, is_open, [blocked, is_unsure])) in
                    rays.iter().zip(answers)
                {
                    let truth = bvh.closest(geometry, ray, f32::INFINITY, &mut stack);
                    assert!(is_open || hit == truth, "{isa:?} {hit:?} {truth:?} {ray:?}");
                    let truth = bvh.occluded(geometry, ray, *t_max, &mut stack);
                    assert!(is_unsure || blocked == truth, "{isa:?} {truth} {t_max} {ray:?}");
                    open += usize::from(is_open);
                    unsure += usize::from(is_unsure);
                }
                // Half of the rays are aimed at edges and corners; of the others hardly one.
                assert!(open < rays.len() * 11 / 20, "{open} of {}", rays.len());
                assert!(unsure < rays.len() * 9 / 20, "{unsure} of {}", rays.len());
            }
        }
    }

    /// A box is six plates, each on the hull; what is in it has inner ones.
    #[test]
    fn faces_of_a_box_are_joined_and_its_hull_is_known() {
        let mut b = SceneBuilder::new("boxes");
        let clay = b.material(Material::reflecting("clay", [0.5; 3], [0.0; 3], 1.0).unwrap());
        b.cuboid(DVec3::ZERO, DVec3::ONE, clay).unwrap();
        b.cuboid(DVec3::splat(0.4), DVec3::splat(0.3), clay).unwrap();
        let scene = b.build();
        let plates = scene.bvh().plates();
        assert_eq!(plates.plates.len(), 12);
        assert_eq!(plates.inner.len(), 6);
        assert_eq!(plates.triangles().collect::<Vec<_>>(), (0..24).collect::<Vec<_>>());
        for triangle in 0..24 {
            let plate = plates.plate_of(triangle);
            assert!(plates.plates[plate as usize].triangles.contains(&triangle));
        }
        assert_eq!(plates.plate_of(24), NO_PLATE);
    }
}
