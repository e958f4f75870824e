//! Path reuse: neighbouring paths share the points where their second rays ended.
//!
//! A group is a run of neighbouring places in a bundle. Each path of it has a first surface point
//! `x1` and, where its ray from there met something that reflects, a second one, `x2`. All first
//! points of the group are joined with all second points (Bekaert, Sbert and Halton, "Accelerating
//! path tracing by re-using paths", 2002), and each path gets the light that every `x2` sends its
//! way. Any of the paths could have found `x2`; the sum over all of their densities, visibility
//! included, is what the light is divided by (the balance heuristic, Veach 1997), so nothing is
//! counted twice and nothing is left out.
//!
//! What `x2` sends towards another `x1` is not what it sends along its own path unless it is
//! diffuse. So two directions are kept with it, the one asked for a light and the one sampled for
//! the path to go on, and what arrives from there; each viewer evaluates the BRDF for itself, and
//! the densities are those of point and direction together.
//!
//! A shading normal is [bent](crate::geometry) for whoever looks, so each pair of points has a frame
//! of its own at `x2`. What does not depend on the viewer there are both directions, the light that
//! arrives, and the density of asking for it, whose receiver has the surface's own normal.
//!
//! Light that `x1` emits, that it finds by asking, and that `x2` emits stays with its own path.

mod join;
mod share;
#[cfg(test)]
mod tests;

use crate::geometry::SurfacePoint;
use crate::math::columns::{Column, Columns3};
use crate::math::lanes::{Bits, Mask, Packet};
use crate::math::{Rgb, V3};

/// Largest group: the pairs of one `x2` fit into a word's bits.
const LARGEST: usize = 128;

/// First surface points, by place in the bundle.
#[derive(Clone, Debug, Default)]
pub(super) struct Firsts {
    point: Points,
    /// Towards the camera.
    wo: Columns3,
    /// 1 where there is one that reflects.
    pub(super) there: Column<u32>,
    /// Of the direction that its own path took: density in 1/sr, and BRDF times cosine over that.
    pdf: Column<f32>,
    beta: Columns3,
}

/// Second surface points, in the order of their paths, with what is known of the light there.
#[derive(Clone, Debug, Default)]
pub(super) struct Seconds {
    pub(super) count: usize,
    /// Place of the path in the bundle.
    slot: Column<u32>,
    point: Points,
    asked: Directions,
    sampled: Directions,
    /// BRDF in 1/sr of the sampled direction as its own path sees it, in the frame of that path.
    f: Columns3,
    /// Which of the group see it, by bit.
    seen: Vec<u128>,
    later: join::Later,
    /// What arrives from the asked light, by place in the bundle.
    pub(super) light: Vec<[f32; 3]>,
    /// What arrives from the sampled direction, by place in the bundle: by emission, with the
    /// density that asking would have had for it, and by reflection.
    pub(super) emitted: Vec<[f32; 3]>,
    pub(super) emitted_pdf: Vec<f32>,
    pub(super) reflected: Vec<[f32; 3]>,
}

/// Surface points turned to their viewers. The shading normals of first points are bent for the
/// camera, those of second ones are the surface's own: each first point bends them for itself.
#[derive(Clone, Debug, Default)]
struct Points {
    p: Columns3,
    error: Columns3,
    ng: Columns3,
    ns: Columns3,
    material: Column<u32>,
    plate: Column<u32>,
}

/// Directions in the frame of the shading normal with their densities in 1/sr; 0 for none.
#[derive(Clone, Debug, Default)]
struct Directions {
    wi: Columns3,
    pdf: Column<f32>,
}

impl Points {
    #[inline(always)]
    fn push<P: Packet>(
        &mut self,
        at: usize,
        which: P::Mask,
        point: &SurfacePoint<P>,
        [material, plate]: [P::Bits; 2],
    ) {
        self.p.push::<P>(at, which, point.p);
        self.error.push::<P>(at, which, point.error);
        self.ng.push::<P>(at, which, point.ng);
        self.ns.push::<P>(at, which, point.ns);
        self.material.push::<P>(at, which, material);
        self.plate.push::<P>(at, which, plate);
    }
}

impl Firsts {
    /// Takes down the points of the paths from place `at` on.
    #[inline(always)]
    pub(super) fn store<P: Packet>(
        &mut self,
        at: usize,
        there: P::Mask,
        point: &SurfacePoint<P>,
        wo: V3<P>,
        what: [P::Bits; 2],
    ) {
        let all = P::mask(u32::MAX);
        self.point.push::<P>(at, all, point, what);
        self.wo.store(at, wo);
        let [no, yes] = [0, 1].map(P::Bits::splat);
        self.there.store::<P>(at, P::select_bits(there, yes, no));
    }

    /// Takes down how the paths from place `at` on go on.
    #[inline(always)]
    pub(super) fn store_direction<P: Packet>(&mut self, at: usize, pdf: P, beta: Rgb<P>) {
        self.pdf.store(at, pdf);
        self.beta.store(at, V3::new(beta.r, beta.g, beta.b));
    }
}

impl Seconds {
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

    /// Takes down points with their asked directions and the densities of those.
    #[inline(always)]
    pub(super) fn push<P: Packet>(
        &mut self,
        which: P::Mask,
        slot: P::Bits,
        point: &SurfacePoint<P>,
        what: [P::Bits; 2],
        [asked, sampled]: [(V3<P>, P); 2],
        f: Rgb<P>,
    ) {
        let at = self.count;
        self.slot.push::<P>(at, which, slot);
        self.point.push::<P>(at, which, point, what);
        self.asked.wi.push::<P>(at, which, asked.0);
        self.asked.pdf.push::<P>(at, which, asked.1);
        self.sampled.wi.push::<P>(at, which, sampled.0);
        self.sampled.pdf.push::<P>(at, which, sampled.1);
        self.f.push_rgb::<P>(at, which, f);
        self.count += which.bits().count_ones() as usize;
    }

    /// Whether any light arrives at the second point of this path.
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
