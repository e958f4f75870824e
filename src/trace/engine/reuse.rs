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
//! Light that `x1` emits, that it finds by asking, and that `x2` emits stays with its own path.

use super::surface::MaterialTable;
use super::shade::is_black;
use super::{Bundle, lowest};
use crate::brdf::{Lobes, Microfacet, View};
use crate::geometry::{Ray, Stack, SurfacePoint, offset_origin};
use crate::math::columns::{BUNDLE, Column, Columns3};
use crate::math::lanes::{Bits, Mask, Packet, Wide};
use crate::math::special::INV_PI;
use crate::math::{Frame, Rgb, V3};
use crate::trace::{Effort, Tracer};

/// Shadow rays end this close to 1: a distance along a ray is known to a few roundings of the whole.
const SHADOW_END: f32 = 1.0 - 16.0 * f32::EPSILON;
/// Largest group: the pairs of one `x2` fit into a word's bits.
pub(super) const LARGEST: usize = 64;

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
    /// BRDF in 1/sr of the sampled direction as its own path sees it.
    f: Columns3,
    /// Which of the group see it, by bit.
    seen: Vec<u64>,
    /// What arrives from the asked light, by place in the bundle.
    pub(super) light: Vec<[f32; 3]>,
    /// What arrives from the sampled direction, by place in the bundle: by emission, with the
    /// density that asking would have had for it, and by reflection.
    pub(super) emitted: Vec<[f32; 3]>,
    pub(super) emitted_pdf: Vec<f32>,
    pub(super) reflected: Vec<[f32; 3]>,
}

/// Surface points turned to their viewers.
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

impl Firsts {
    /// Corners of the box around the points of a run.
    #[inline(always)]
    fn bounds<P: Packet>(&self, run: &Runs) -> [V3; 2] {
        let mut low = V3::splat(P::splat(f32::INFINITY));
        let mut high = -low;
        for first in (0..run.len()).step_by(P::WIDTH) {
            let at = run.base + first;
            let there = !P::equal_bits(self.there.load::<P>(at), P::Bits::splat(0));
            let there = there & P::mask(lowest(run.len() - first));
            let p = self.point.p.load::<P>(at);
            low = V3::select(there, low.min(p), low);
            high = V3::select(there, high.max(p), high);
        }
        let fold = |x: P, of: fn(f32, f32) -> f32| {
            let mut lanes = [0.0; 16];
            x.store(&mut lanes);
            lanes[1..P::WIDTH].iter().fold(lanes[0], |a, b| of(a, *b))
        };
        let all = |v: V3<P>, of| V3::new(fold(v.x, of), fold(v.y, of), fold(v.z, of));
        [all(low, f32::min), all(high, f32::max)]
    }
}

impl Tracer {
    /// Finds which first points see which second points of their groups. Returns what was done for it.
    #[inline(always)]
    pub(super) fn join<W: Wide, P: Packet>(
        &self,
        bundle: &mut Bundle,
        stack: &mut Stack,
    ) -> Effort {
        let Bundle { firsts, seconds, ends, .. } = bundle;
        let bvh = self.scene.bvh();
        let zero = P::splat(0.0);
        let mut effort = Effort::default();
        let mut run = Runs::new(ends);
        let mut bounds = [V3::default(); 2];
        seconds.seen.clear();
        for entry in 0..seconds.count {
            let slot = seconds.slot.0[entry] as usize;
            if run.reach(slot) {
                bounds = firsts.bounds::<P>(&run);
            }
            let mut seen = 1u64 << (slot - run.base);
            if !seconds.is_lit(slot) {
                seconds.seen.push(seen);
                continue;
            }
            let others = !seen;
            effort.pairs += run.len() as u64;
            let splat = |v: &Columns3| V3::from(v.get(entry)).splat_lanes::<P>();
            let p2 = splat(&seconds.point.p);
            let error2 = splat(&seconds.point.error);
            let ng2 = splat(&seconds.point.ng);
            let ns2 = splat(&seconds.point.ns);
            let plate2 = P::Bits::splat(seconds.point.plate.0[entry]);
            let between = bvh.plates().between::<P>(seconds.point.p.get(entry).into(), bounds);
            for first in (0..run.len()).step_by(P::WIDTH) {
                let at = run.base + first;
                let from = &firsts.point;
                let there = !P::equal_bits(firsts.there.load::<P>(at), P::Bits::splat(0));
                let (p1, ng1) = (from.p.load::<P>(at), from.ng.load::<P>(at));
                let w = p2 - p1;
                // Both sides of both surfaces, as each path asks of its own.
                let faces = ng1.dot(w).gt(zero)
                    & from.ns.load::<P>(at).dot(w).gt(zero)
                    & ng2.dot(w).lt(zero)
                    & ns2.dot(w).lt(zero);
                let others = (others >> first) as u32 & lowest(run.len() - first);
                let live = there & faces & P::mask(others);
                if !live.any() {
                    continue;
                }
                effort.joined += u64::from(live.bits().count_ones());
                let o = offset_origin(p1, from.error.load::<P>(at), ng1, w);
                let d = offset_origin(p2, error2, ng2, -w) - o;
                let ends = [from.plate.load::<P>(at), plate2];
                let t_max = P::splat(SHADOW_END);
                let [blocked, open] =
                    bvh.plates().occluded_by::<P>(between, o, d, t_max, ends, live);
                let clear = (live & !blocked).bits();
                let open = open.bits();
                let unsure = clear & (open | bvh.meets_tree(o, d, t_max).bits());
                let mut free = clear & !unsure;
                if unsure != 0 {
                    effort.alone += u64::from(unsure.count_ones());
                    free |= self.clear_one_by_one::<W, P>([o, d], unsure, open, stack);
                }
                seen |= u64::from(free) << first;
            }
            seconds.seen.push(seen);
        }
        effort
    }

    /// Those of the rays that meet nothing, of the lanes for which plates alone could not tell.
    #[inline(always)]
    fn clear_one_by_one<W: Wide, P: Packet>(
        &self,
        [o, d]: [V3<P>; 2],
        mut lanes: u32,
        open: u32,
        stack: &mut Stack,
    ) -> u32 {
        let (bvh, geometry) = (self.scene.bvh(), self.scene.geometry());
        let mut parts = [[0.0; 16]; 6];
        for (x, column) in [o.x, o.y, o.z, d.x, d.y, d.z].into_iter().zip(&mut parts) {
            x.store(column);
        }
        let mut clear = 0;
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            let part = |i: usize| V3::new(parts[i][lane], parts[i + 1][lane], parts[i + 2][lane]);
            let ray = Ray { o: part(0), d: part(3) };
            let occluded = if open >> lane & 1 != 0 {
                bvh.occluded_with::<W>(geometry, &ray, SHADOW_END, stack)
            } else {
                bvh.occluded_but_plates::<W>(geometry, &ray, SHADOW_END, stack)
            };
            clear |= u32::from(!occluded) << lane;
        }
        clear
    }

    /// Adds to each path what the second points of its group send its way.
    #[inline(always)]
    pub(super) fn share<P: Packet, M: Microfacet>(&self, bundle: &mut Bundle) {
        let Bundle { firsts, seconds, ends, radiance, .. } = bundle;
        let materials = &self.tables.materials;
        let mut viewers: Vec<Viewers<P>> = Vec::with_capacity(LARGEST / P::WIDTH);
        let mut pairs = Pairs::default();
        let mut run = Runs::new(ends);
        let mut entry = 0;
        while entry < seconds.count {
            run.reach(seconds.slot.0[entry] as usize);
            viewers.clear();
            // As many as can be summed up in the same order by any width.
            let places = run.base..run.base + run.len().next_multiple_of(16);
            for at in places.step_by(P::WIDTH) {
                viewers.push(Viewers::load::<M>(firsts, materials, at));
            }
            let matt = (run.base..run.end).all(|at| {
                firsts.there.0[at] == 0 || materials.is_matt(firsts.point.material.0[at])
            });
            while entry < seconds.count && (seconds.slot.0[entry] as usize) < run.end {
                if seconds.is_lit(seconds.slot.0[entry] as usize) {
                    let second = Second::at(seconds, materials, entry);
                    second.send::<P, M>(firsts, run.base, matt, &mut viewers, &mut pairs);
                }
                entry += 1;
            }
            for (at, viewers) in (run.base..run.end).step_by(P::WIDTH).zip(&viewers) {
                let mut sum = viewers.sum;
                if matt {
                    sum = sum * viewers.view.lobes().kd;
                }
                let mut sums = [[0.0; 16]; 3];
                for (x, column) in [sum.r, sum.g, sum.b].into_iter().zip(&mut sums) {
                    x.store(column);
                }
                let places = radiance[at..run.end].iter_mut().take(P::WIDTH);
                for (lane, sum) in places.enumerate() {
                    for (sum, column) in sum.iter_mut().zip(&sums) {
                        *sum += column[lane];
                    }
                }
            }
        }
    }
}

/// First points of a group, a register of them, with what they have received.
struct Viewers<P: Packet> {
    p: V3<P>,
    frame: Frame<P>,
    view: View<P>,
    sum: Rgb<P>,
}

impl<P: Packet> Viewers<P> {
    #[inline(always)]
    fn load<M: Microfacet>(firsts: &Firsts, materials: &MaterialTable, at: usize) -> Viewers<P> {
        let frame = Frame::around(firsts.point.ns.load::<P>(at));
        let material = materials.get::<P>(firsts.point.material.load::<P>(at));
        let wo = frame.to_local(firsts.wo.load::<P>(at));
        Viewers {
            p: firsts.point.p.load::<P>(at),
            frame,
            view: material.lobes.seen_from::<M>(wo),
            sum: Rgb::splat(P::splat(0.0)),
        }
    }
}

/// One number for each pair of a second point with the first ones.
type Row = [f32; LARGEST];

/// All pairs of one second point with the first points of its group.
#[repr(align(64))]
struct Pairs {
    /// Cosine at the second point over the distance squared.
    geometry: Row,
    /// Density of finding it, by area; then its share.
    density: Row,
    /// BRDF and cosine at the first point times the geometry; then over all densities.
    carried: [Row; 3],
    /// At the second point: BRDF in 1/sr and density in 1/sr of the asked and the sampled direction.
    f: [[Row; 3]; 2],
    pdf: [Row; 2],
}

impl Default for Pairs {
    fn default() -> Pairs {
        let zero = [0.0; LARGEST];
        Pairs {
            geometry: zero,
            density: zero,
            carried: [zero; 3],
            f: [[zero; 3]; 2],
            pdf: [zero; 2],
        }
    }
}

/// One second point.
struct Second {
    slot: usize,
    seen: u64,
    p: V3,
    ng: V3,
    frame: Frame,
    lobes: Lobes,
    asked: (V3, f32),
    sampled: (V3, f32),
    f: Rgb,
    light: Rgb,
    emitted: Rgb,
    emitted_pdf: f32,
    reflected: Rgb,
}

impl Second {
    #[inline(always)]
    fn at(seconds: &Seconds, materials: &MaterialTable, entry: usize) -> Second {
        let slot = seconds.slot.0[entry] as usize;
        Second {
            slot,
            seen: seconds.seen[entry],
            p: seconds.point.p.get(entry).into(),
            ng: seconds.point.ng.get(entry).into(),
            frame: Frame::around(V3::from(seconds.point.ns.get(entry))),
            lobes: materials.lobes(seconds.point.material.0[entry]),
            asked: (seconds.asked.wi.get(entry).into(), seconds.asked.pdf.0[entry]),
            sampled: (seconds.sampled.wi.get(entry).into(), seconds.sampled.pdf.0[entry]),
            f: seconds.f.get(entry).into(),
            light: seconds.light[slot].into(),
            emitted: seconds.emitted[slot].into(),
            emitted_pdf: seconds.emitted_pdf[slot],
            reflected: seconds.reflected[slot].into(),
        }
    }

    /// Adds to the viewers what this point sends them; where all of them are `matt`, what is still to
    /// be multiplied by their reflectance.
    #[inline(always)]
    fn send<P: Packet, M: Microfacet>(
        &self,
        firsts: &Firsts,
        base: usize,
        matt: bool,
        viewers: &mut [Viewers<P>],
        pairs: &mut Pairs,
    ) {
        let group = viewers.len() * P::WIDTH;
        let own = self.slot - base;
        if matt {
            self.join_matt::<P>(viewers, pairs);
        } else {
            self.join::<P, M>(viewers, pairs);
            // Its own path knows these from having sampled them, to more digits.
            let density = firsts.pdf.0[self.slot] * pairs.geometry[own];
            pairs.density[own] = density;
            let beta = firsts.beta.get(self.slot);
            for (carried, beta) in pairs.carried.iter_mut().zip(beta) {
                carried[own] = beta * density;
            }
        }
        let all = sum(&pairs.density, group);
        let per_all = 1.0 / all;
        if !(all > 0.0 && per_all > 0.0) {
            return;
        }
        if self.lobes.ks.is_black() {
            let up = V3::new(0.0, 0.0, 1.0);
            let [asked, sampled] =
                [self.asked.0, self.sampled.0].map(|wi| self.lobes.eval::<M>(up, wi));
            let asked = self.from_asked(asked.pdf) * asked.f;
            let lo = (asked + self.from_sampled(sampled.pdf) * sampled.f) * per_all;
            let lo = lo.splat_lanes::<P>();
            for (at, viewers) in (0..).step_by(P::WIDTH).zip(viewers) {
                viewers.sum += pairs.carried_at::<P>(at, matt) * lo;
            }
            return;
        }
        self.evaluate::<P, M>(viewers, pairs);
        pairs.pdf[1][own] = self.sampled.1;
        for (row, f) in pairs.f[1].iter_mut().zip(<[f32; 3]>::from(self.f)) {
            row[own] = f;
        }
        let mut densities = [0.0; 2];
        for (density, pdf) in densities.iter_mut().zip(&pairs.pdf) {
            let mut products = [0.0; LARGEST];
            for ((product, pdf), share) in products.iter_mut().zip(pdf).zip(&pairs.density) {
                *product = pdf * share;
            }
            *density = sum(&products, group) * per_all;
        }
        let asked = (self.from_asked(densities[0]) * per_all).splat_lanes::<P>();
        let sampled = (self.from_sampled(densities[1]) * per_all).splat_lanes::<P>();
        for (at, viewers) in (0..).step_by(P::WIDTH).zip(viewers) {
            let lo = pairs.f_at::<P>(0, at) * asked + pairs.f_at::<P>(1, at) * sampled;
            viewers.sum += pairs.carried_at::<P>(at, matt) * lo;
        }
    }

    /// What arrives from the asked light, times the cosine, over the density of its direction:
    /// by asking, and by sampling as the group does on the mean.
    #[inline(always)]
    fn from_asked(&self, pdf: f32) -> Rgb {
        let all = self.asked.1 + pdf;
        if self.light.is_black() { Rgb::BLACK } else { self.light * (self.asked.0.z / all) }
    }

    /// The same for the sampled direction; light that was reflected there could not be asked for.
    #[inline(always)]
    fn from_sampled(&self, pdf: f32) -> Rgb {
        if !(pdf > 0.0) {
            return Rgb::BLACK;
        }
        let cos = self.sampled.0.z;
        self.emitted * (cos / (self.emitted_pdf + pdf)) + self.reflected * (cos / pdf)
    }

    /// Geometry, densities and BRDFs at the first points.
    #[inline(always)]
    fn join<P: Packet, M: Microfacet>(&self, viewers: &[Viewers<P>], pairs: &mut Pairs) {
        let (p2, ng2) = (self.p.splat_lanes::<P>(), self.ng.splat_lanes::<P>());
        for (at, viewers) in (0..).step_by(P::WIDTH).zip(viewers) {
            let seen = P::mask((self.seen >> at) as u32);
            let away = p2 - viewers.p;
            let inverse2 = P::splat(1.0) / away.length2();
            let wi = away * inverse2.sqrt();
            let geometry = (ng2.dot(wi).abs() * inverse2).or_zero(seen);
            let local = viewers.frame.to_local(wi);
            let e = viewers.view.eval::<M>(local);
            let f = e.f * (local.z * geometry);
            geometry.store(&mut pairs.geometry[at..]);
            // Where nothing is carried the path would have ended.
            let seen = seen & !is_black(e.f);
            (e.pdf * geometry).or_zero(seen).store(&mut pairs.density[at..]);
            for (f, row) in [f.r, f.g, f.b].into_iter().zip(&mut pairs.carried) {
                f.or_zero(seen).store(&mut row[at..]);
            }
        }
    }

    /// [`Second::join`] where all first points are diffuse: BRDF and cosine over the reflectance
    /// are the density.
    #[inline(always)]
    fn join_matt<P: Packet>(&self, viewers: &[Viewers<P>], pairs: &mut Pairs) {
        let (p2, ng2) = (self.p.splat_lanes::<P>(), self.ng.splat_lanes::<P>());
        for (at, viewers) in (0..).step_by(P::WIDTH).zip(viewers) {
            let seen = P::mask((self.seen >> at) as u32);
            let away = p2 - viewers.p;
            let inverse2 = P::splat(1.0) / away.length2();
            let cosines = viewers.frame.n.dot(away) * ng2.dot(away).abs() * inverse2;
            let density = cosines * P::splat(INV_PI) * inverse2;
            density.or_zero(seen).store(&mut pairs.density[at..]);
        }
    }

    /// BRDFs and densities at this point.
    #[inline(always)]
    fn evaluate<P: Packet, M: Microfacet>(&self, viewers: &[Viewers<P>], pairs: &mut Pairs) {
        let p2 = self.p.splat_lanes::<P>();
        let frame = self.frame.splat_lanes::<P>();
        let lobes = self.lobes.splat_lanes::<P>();
        for (at, viewers) in (0..).step_by(P::WIDTH).zip(viewers) {
            let seen = P::mask((self.seen >> at) as u32);
            let back = viewers.p - p2;
            let wo = frame.to_local(back * (P::splat(1.0) / back.length2()).sqrt());
            let view = lobes.seen_from::<M>(wo);
            for (which, (wi, _)) in [self.asked, self.sampled].into_iter().enumerate() {
                let e = view.eval::<M>(wi.splat_lanes());
                let pdf = e.pdf.or_zero(seen & !is_black(e.f));
                pdf.store(&mut pairs.pdf[which][at..]);
                for (f, row) in [e.f.r, e.f.g, e.f.b].into_iter().zip(&mut pairs.f[which]) {
                    f.or_zero(seen).store(&mut row[at..]);
                }
            }
        }
    }
}

impl Pairs {
    #[inline(always)]
    fn carried_at<P: Packet>(&self, at: usize, matt: bool) -> Rgb<P> {
        if matt {
            return Rgb::splat(P::load(&self.density[at..]));
        }
        let [r, g, b] = &self.carried;
        Rgb::new(P::load(&r[at..]), P::load(&g[at..]), P::load(&b[at..]))
    }

    #[inline(always)]
    fn f_at<P: Packet>(&self, which: usize, at: usize) -> Rgb<P> {
        let [r, g, b] = &self.f[which];
        Rgb::new(P::load(&r[at..]), P::load(&g[at..]), P::load(&b[at..]))
    }
}

/// The sum of the first `count` numbers, a multiple of 16, in an order that does not depend on the
/// registers' width.
#[inline(always)]
fn sum(row: &Row, count: usize) -> f32 {
    let mut sums = [0.0; 16];
    for part in row[..count].chunks_exact(16) {
        for (sum, x) in sums.iter_mut().zip(part) {
            *sum += x;
        }
    }
    for half in [8, 4, 2, 1] {
        for i in 0..half {
            sums[i] += sums[i + half];
        }
    }
    sums[0]
}

const _: () = assert!(BUNDLE % LARGEST == 0);
