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
    /// Those that bodies may lie behind, as seen from between surfaces: not on the convex hull.
    inner: Vec<u32>,
    /// Triangles and their plates, by triangle.
    plate_of: Vec<(u32, u32)>,
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
        let inner = (0..plates.len() as u32)
            .filter(|&i| !is_on_the_hull(geometry, &plates[i as usize]))
            .collect();
        Plates { plates, inner, plate_of }
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
        let clearance = clearance(o);
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
            let outside = own
                | met.inside.lt(-met.band)
                | met.t.lt(-met.within)
                | met.t.gt(hits.t + met.within);
            if outside.all() {
                continue;
            }
            let nearer = met.inside.gt(met.band)
                & met.t.gt(met.within)
                & met.t.lt(hits.t - met.within)
                & !own;
            hits.open = hits.open | !(outside | nearer);
            let x = o + d * met.t;
            let (m, c) = plate.diagonal;
            let second = m.splat_lanes::<P>().dot(x) - P::splat(c);
            hits.open = hits.open | (nearer & !second.abs().gt(met.band));
            let [a, b] = plate.triangles.map(P::Bits::splat);
            let triangle = P::select_bits(second.gt(P::splat(0.0)), b, a);
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
        let clearance = clearance(o);
        let (mut blocked, mut open) = (P::mask(0), P::mask(0));
        let all = self.plates.len() as u32;
        let inner = if between { &self.inner[..] } else { &[] };
        let count = if between { inner.len() } else { all as usize };
        for i in 0..count {
            let at = if between { inner[i] } else { i as u32 };
            let met = self.plates[at as usize].meet(o, d, clearance);
            let this = P::Bits::splat(at);
            let own = P::equal_bits(from, this) | P::equal_bits(to, this);
            let outside = own
                | met.inside.lt(-met.band)
                | met.t.lt(-met.within)
                | met.t.gt(t_max + met.within);
            let inside = met.inside.gt(met.band)
                & met.t.gt(met.within)
                & met.t.lt(t_max - met.within)
                & !own;
            blocked = blocked | inside;
            open = open | !(outside | inside);
            live = live & !inside;
            if !live.any() {
                break;
            }
        }
        [blocked, open & !blocked]
    }
}

/// A ray and a plate.
struct Meeting<P> {
    t: P,
    /// How far off the distance may be.
    within: P,
    /// How far inside the point is.
    inside: P,
    /// How far off that may be.
    band: P,
}

impl Plate {
    #[inline(always)]
    fn meet<P: Packet>(&self, o: V3<P>, d: V3<P>, clearance: P) -> Meeting<P> {
        let inverse = P::splat(1.0) / dot(self.n, d);
        let t = (P::splat(self.d) - dot(self.n, o)) * inverse;
        let x = V3::new(d.x.mul_add(t, o.x), d.y.mul_add(t, o.y), d.z.mul_add(t, o.z));
        let [a, b, c, e] = &self.edges;
        let ab = across(a, x).min(across(b, x));
        let ce = across(c, x).min(across(e, x));
        let band = clearance * inverse.abs();
        Meeting { t, within: band * P::splat(self.slenderness), inside: ab.min(ce), band }
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
