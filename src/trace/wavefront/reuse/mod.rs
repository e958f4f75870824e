//! Path reuse: neighbouring paths share the points where their second rays ended.
//!
//! A group is a run of neighbouring places in a batch. Each path of it has a primary vertex
//! `x1`, mirrors not counted, and, where its ray from there hit something that reflects, a second one, `x2`. All first
//! points of the group are connected with all reuse vertices (Bekaert, Sbert and Halton, "Accelerating
//! path tracing by re-using paths", 2002), and each path gets the light that every `x2` sends its
//! way. Any of the paths could have found `x2`; the sum over all of their densities, visibility
//! included, is what the light is divided by (the balance heuristic, Veach 1997), so nothing is
//! counted twice and nothing is left out.
//!
//! What `x2` sends towards another `x1` is not what it sends along its own path unless it is
//! diffuse. So two directions are kept with it, the one sampled for a light and the one sampled for
//! the path to go on, and what arrives from there; each viewer evaluates the BRDF for itself, and
//! the densities are those of point and direction together.
//!
//! A shading normal is [bent](crate::geometry) for whoever looks, so each pair of points has a frame
//! of its own at `x2`. What does not depend on the viewer there are both directions, the light that
//! arrives, and the density of light sampling, whose receiver has the surface's own normal.
//!
//! Where a weak and rough specular lobe stands beside a diffuse one that is much stronger, `x2` draws
//! its directions with about the same density for every viewer. There the density of its own path
//! alone stands for that of all: what is left to evaluate for the others is the lobe's value.
//!
//! What a path sees in a mirror is of no use to its neighbours, so it goes through up to two of them,
//! and the point that it comes to then is its `x1`, of whose light the camera gets what the mirrors
//! leave. Where the number of scattering events is limited, only paths that have gone through as many
//! mirrors share: the light of the others has come by longer paths or by shorter ones.
//!
//! Some of the directions that leave `x1` aim at [highlights](crate::trace::highlights). The density of a
//! direction is that of both ways to draw it, wherever another path might have.
//!
//! Light that `x1` emits, that it finds by light sampling, and that `x2` emits stays with its own path.

mod gather;
#[cfg(test)]
mod tests;
mod visibility;

pub(super) use gather::GatherLight;
pub(super) use visibility::FindVisibility;

use crate::geometry::SurfacePoint;
use crate::math::simd::{Bits, MAX_WIDTH, Mask, SimdWide};
use crate::math::soa::{Soa, Soa3};
use crate::math::{Rgb, V3};

/// Largest group: the pairs of one `x2` fit into a word's bits.
const LARGEST: usize = 128;

/// Primary vertices, by place in the batch.
#[derive(Clone, Debug, Default)]
pub(super) struct PrimaryVertices {
    point: Points,
    /// Towards the camera.
    wo: Soa3,
    /// 1 where there is one that reflects.
    pub(super) there: Soa<u32>,
    /// Of the direction that its own path took: density in 1/sr, and BRDF times cosine over that.
    pdf: Soa<f32>,
    beta: Soa3,
    /// What the camera gets of the light that leaves towards it: 1, or less by way of mirrors.
    throughput: Soa3,
    /// How many those are.
    lead: Soa<u32>,
}

/// Reuse vertices with what is known of the light there.
#[derive(Clone, Debug, Default)]
pub(super) struct ReuseVertices {
    pub(super) count: usize,
    /// Place of the path in the batch.
    slot: Soa<u32>,
    point: Points,
    light_dir: Directions,
    bsdf_dir: Directions,
    /// BRDF in 1/sr of the sampled direction as its own path sees it, in the frame of that path.
    f: Soa3,
    /// The same times the cosine, and the density in 1/sr with which that path would have sampled the
    /// direction to the light.
    own_f_cos: Soa3,
    own_light_pdf: Soa<f32>,
    /// Entries in the order of their paths.
    order: Vec<u32>,
    /// Which of the group see it, by bit.
    seen: Vec<u128>,
    /// What arrives from the sampled light, by place in the batch.
    pub(super) light: Vec<[f32; 3]>,
    /// What arrives from the sampled direction, by place in the batch: by emission, with the
    /// density that light sampling would have had for it, and by reflection.
    pub(super) emitted: Vec<[f32; 3]>,
    pub(super) emitted_pdf: Vec<f32>,
    pub(super) reflected: Vec<[f32; 3]>,
}

/// Surface points turned to their viewers. The shading normals of primary vertices are bent for the
/// camera, those of second ones are the surface's own: each primary vertex bends them for itself.
#[derive(Clone, Debug, Default)]
struct Points {
    p: Soa3,
    error: Soa3,
    ng: Soa3,
    ns: Soa3,
    material: Soa<u32>,
    surface_id: Soa<u32>,
}

/// Directions in the frame of the shading normal with their densities in 1/sr; 0 for none.
#[derive(Clone, Debug, Default)]
struct Directions {
    wi: Soa3,
    pdf: Soa<f32>,
}

impl Points {
    #[inline(always)]
    fn push<P: SimdWide>(
        &mut self,
        at: usize,
        which: P::Mask,
        point: &SurfacePoint<P>,
        [material, surface_id]: [P::Bits; 2],
    ) {
        self.p.push::<P>(at, which, point.p);
        self.error.push::<P>(at, which, point.error);
        self.ng.push::<P>(at, which, point.ng);
        self.ns.push::<P>(at, which, point.ns);
        self.material.push::<P>(at, which, material);
        self.surface_id.push::<P>(at, which, surface_id);
    }
}

impl PrimaryVertices {
    /// Takes down those of the points of the paths from place `at` on that are first ones. The paths
    /// have these slots, or lie at their places.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    pub(super) fn store<P: SimdWide>(
        &mut self,
        at: usize,
        slots: Option<P::Bits>,
        there: P::Mask,
        point: &SurfacePoint<P>,
        wo: V3<P>,
        throughput: Rgb<P>,
        [material, surface_id, lead]: [P::Bits; 3],
    ) {
        let throughput = V3::new(throughput.r, throughput.g, throughput.b);
        match slots {
            None => {
                let all = P::mask(u32::MAX);
                self.point.push::<P>(at, all, point, [material, surface_id]);
                self.wo.store(at, wo);
                self.throughput.store(at, throughput);
                self.lead.store::<P>(at, lead);
                let [no, yes] = [0, 1].map(P::Bits::splat);
                self.there.store::<P>(at, P::select_bits(there, yes, no));
            }
            Some(slots) => {
                let places = ScatterPlaces::new::<P>(slots, there);
                places.put(&mut self.point.p, point.p);
                places.put(&mut self.point.error, point.error);
                places.put(&mut self.point.ng, point.ng);
                places.put(&mut self.point.ns, point.ns);
                places.put(&mut self.wo, wo);
                places.put(&mut self.throughput, throughput);
                let mut words = [[0; MAX_WIDTH]; 3];
                P::store_bits(material, &mut words[0]);
                P::store_bits(surface_id, &mut words[1]);
                P::store_bits(lead, &mut words[2]);
                for (lane, slot) in places.each() {
                    self.point.material.0[slot] = words[0][lane];
                    self.point.surface_id.0[slot] = words[1][lane];
                    self.lead.0[slot] = words[2][lane];
                    self.there.0[slot] = 1;
                }
            }
        }
    }

    /// Takes down how these paths go on from their primary vertices.
    #[inline(always)]
    pub(super) fn store_direction<P: SimdWide>(
        &mut self,
        at: usize,
        slots: Option<P::Bits>,
        there: P::Mask,
        pdf: P,
        beta: Rgb<P>,
    ) {
        let beta = V3::new(beta.r, beta.g, beta.b);
        let Some(slots) = slots else {
            self.pdf.store(at, pdf);
            return self.beta.store(at, beta);
        };
        let places = ScatterPlaces::new::<P>(slots, there);
        places.put(&mut self.beta, beta);
        let mut pdfs = [0.0; MAX_WIDTH];
        pdf.store(&mut pdfs);
        for (lane, slot) in places.each() {
            self.pdf.0[slot] = pdfs[lane];
        }
    }
}

/// Where some lanes belong.
struct ScatterPlaces {
    slots: [u32; MAX_WIDTH],
    lanes: u32,
}

impl ScatterPlaces {
    #[inline(always)]
    fn new<P: SimdWide>(slots: P::Bits, which: P::Mask) -> ScatterPlaces {
        let mut places = ScatterPlaces { slots: [0; MAX_WIDTH], lanes: which.bits() };
        P::store_bits(slots, &mut places.slots);
        places
    }

    #[inline(always)]
    fn each(&self) -> impl Iterator<Item = (usize, usize)> + use<'_> {
        let lanes = (0..MAX_WIDTH).filter(|lane| self.lanes >> lane & 1 != 0);
        lanes.map(|lane| (lane, self.slots[lane] as usize))
    }

    #[inline(always)]
    fn put<P: SimdWide>(&self, column: &mut Soa3, v: V3<P>) {
        let mut numbers = [[0.0; MAX_WIDTH]; 3];
        v.x.store(&mut numbers[0]);
        v.y.store(&mut numbers[1]);
        v.z.store(&mut numbers[2]);
        for (lane, slot) in self.each() {
            let [x, y, z] = [numbers[0][lane], numbers[1][lane], numbers[2][lane]];
            column.set(slot, V3::new(x, y, z));
        }
    }
}

impl ReuseVertices {
    /// Forgets everything.
    pub(super) fn clear(&mut self, paths: usize) {
        self.count = 0;
        for sums in [&mut self.light, &mut self.emitted, &mut self.reflected] {
            sums.clear();
            sums.resize(paths, [0.0; 3]);
        }
        self.emitted_pdf.clear();
        self.emitted_pdf.resize(paths, 0.0);
    }

    /// Takes down points with their sampled directions and the densities of those.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    pub(super) fn push<P: SimdWide>(
        &mut self,
        which: P::Mask,
        slot: P::Bits,
        point: &SurfacePoint<P>,
        what: [P::Bits; 2],
        [light_dir, bsdf_dir]: [(V3<P>, P); 2],
        [f, f_cos]: [Rgb<P>; 2],
        light_pdf: P,
    ) {
        let at = self.count;
        self.slot.push::<P>(at, which, slot);
        self.point.push::<P>(at, which, point, what);
        self.light_dir.wi.push::<P>(at, which, light_dir.0);
        self.light_dir.pdf.push::<P>(at, which, light_dir.1);
        self.bsdf_dir.wi.push::<P>(at, which, bsdf_dir.0);
        self.bsdf_dir.pdf.push::<P>(at, which, bsdf_dir.1);
        self.f.push_rgb::<P>(at, which, f);
        self.own_f_cos.push_rgb::<P>(at, which, f_cos);
        self.own_light_pdf.push::<P>(at, which, light_pdf);
        self.count += which.bits().count_ones() as usize;
    }

    /// Finds the order of the paths: mirrors let some come to their reuse vertices later.
    pub(super) fn sort(&mut self) {
        self.order.clear();
        self.order.extend(0..self.count as u32);
        let slots = &self.slot.0[..self.count];
        if !slots.is_sorted() {
            self.order.sort_unstable_by_key(|&entry| slots[entry as usize]);
        }
    }

    /// Whether any light arrives at the reuse vertex of this path.
    #[inline(always)]
    fn is_lit(&self, slot: usize) -> bool {
        let black = [0.0; 3];
        self.light[slot] != black || self.emitted[slot] != black || self.reflected[slot] != black
    }
}

/// The runs of places that share, one after the other.
struct Runs<'a> {
    ends: &'a [u32],
    base: usize,
    end: usize,
}

impl Runs<'_> {
    fn new(ends: &[u32]) -> Runs<'_> {
        Runs { ends, base: 0, end: 0 }
    }

    /// Goes on to the run that has this place; true where that is another one than before.
    #[inline(always)]
    fn reach(&mut self, slot: usize) -> bool {
        let stays = slot < self.end;
        while slot >= self.end {
            let [end, rest @ ..] = self.ends else { return false };
            (self.base, self.end, self.ends) = (self.end, *end as usize, rest);
        }
        !stays
    }

    fn len(&self) -> usize {
        self.end - self.base
    }
}
