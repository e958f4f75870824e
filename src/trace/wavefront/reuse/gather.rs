//! What reuse vertices send to the primary vertices that see them.

use super::super::PathBatch;
use super::super::hits::MaterialTable;
use super::super::vertex::is_black;
use super::{LARGEST, PrimaryVertices, ReuseVertices, Runs};
use crate::brdf::{Brdf, BrdfParams, Microfacet};
use crate::geometry::bent;
use crate::math::simd::{Bits, Kernel, MAX_WIDTH, Mask, Simd8, SimdWide};
use crate::math::special::INV_PI;
use crate::math::{Frame, Rgb, V3};
use crate::trace::Tracer;
use crate::trace::highlights::{self, Image};
use std::marker::PhantomData;
use std::ops::Range;

/// Adds to each path what the reuse vertices of its group send its way.
pub(in super::super) struct GatherLight<'a, M> {
    pub(in super::super) tracer: &'a Tracer,
    pub(in super::super) batch: &'a mut PathBatch,
    pub(in super::super) model: PhantomData<M>,
}

impl<M: Microfacet> Kernel for GatherLight<'_, M> {
    /// How often a specular lobe was evaluated.
    type Output = u64;
    #[inline(always)]
    fn run<W: Simd8, P: SimdWide>(self) -> u64 {
        let PathBatch { primary, reuse, ends, radiance, .. } = self.batch;
        let materials = &self.tracer.tables.materials;
        let mut viewers: Vec<Viewers<P>> = Vec::with_capacity(LARGEST / P::WIDTH);
        let mut pairs = PairTerms::default();
        let mut images = Vec::new();
        let mut run = Runs::new(ends);
        let (mut at, mut glossy) = (0, 0);
        while let Some(&first) = reuse.order.get(at) {
            run.reach(reuse.slot.0[first as usize] as usize);
            viewers.clear();
            images.clear();
            // As many as can be summed up in the same order by any width.
            let places = run.base..run.base + run.len().next_multiple_of(MAX_WIDTH);
            for at in places.step_by(P::WIDTH) {
                viewers.push(Viewers::load::<M>(self.tracer, primary, at, &mut images));
            }
            let diffuse = (run.base..run.end).all(|at| {
                let params = materials.params(primary.point.material.0[at]);
                primary.there.0[at] == 0 || params.ks.is_black()
            });
            while let Some(&entry) = reuse.order.get(at) {
                let entry = entry as usize;
                let slot = reuse.slot.0[entry] as usize;
                if slot >= run.end {
                    break;
                }
                at += 1;
                if reuse.is_lit(slot) {
                    let second = ReuseVertex::at(reuse, materials, entry);
                    // At the primary vertices one direction, at the second one two.
                    let there = match second.params.ks.is_black() {
                        true => 0,
                        false if second.weak => 1,
                        false => 2,
                    };
                    glossy += (u64::from(!diffuse) + there) * run.len() as u64;
                    second.send::<P, M>(
                        primary,
                        run.base,
                        diffuse,
                        (&mut viewers, &images),
                        &mut pairs,
                    );
                }
            }
            for (at, viewers) in (run.base..run.end).step_by(P::WIDTH).zip(&viewers) {
                let mut sum = viewers.sum * primary.throughput.load_rgb::<P>(at);
                if diffuse {
                    sum *= viewers.brdf.params().kd;
                }
                let mut sums = [[0.0; MAX_WIDTH]; 3];
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
        glossy
    }
}

/// Primary vertices of a group, a register of them, with what they have received.
struct Viewers<P: SimdWide> {
    p: V3<P>,
    frame: Frame<P>,
    brdf: Brdf<P>,
    /// What their own paths aim at besides.
    images: Range<usize>,
    chance: P,
    sum: Rgb<P>,
}

impl<P: SimdWide> Viewers<P> {
    #[inline(always)]
    fn load<M: Microfacet>(
        tracer: &Tracer,
        primary: &PrimaryVertices,
        at: usize,
        images: &mut Vec<Image<P>>,
    ) -> Viewers<P> {
        let frame = Frame::around(primary.point.ns.load::<P>(at));
        let material = tracer.tables.materials.get::<P>(primary.point.material.load::<P>(at));
        let wo = frame.to_local(primary.wo.load::<P>(at));
        let p = primary.point.p.load::<P>(at);
        let there = !P::equal_bits(primary.there.load::<P>(at), P::Bits::splat(0));
        let start = images.len();
        let chance = tracer.highlights.seen_from(p, frame.n, there, images);
        Viewers {
            p,
            frame,
            images: start..images.len(),
            chance,
            brdf: material.params.at_wo::<M>(wo),
            sum: Rgb::splat(P::splat(0.0)),
        }
    }
}

/// One number for each pair of a reuse vertex with the first ones.
type PairRow = [f32; LARGEST];

/// All pairs of one reuse vertex with the primary vertices of its group.
#[repr(align(64))]
struct PairTerms {
    /// Cosine at the reuse vertex over the distance squared.
    geometry: PairRow,
    /// Density of finding it, by area; then its share.
    density: PairRow,
    /// BRDF and cosine at the primary vertex times the geometry; where all are diffuse the first alone, over
    /// the reflectance.
    throughput: [PairRow; 3],
    /// At the reuse vertex: BRDF in 1/sr and density in 1/sr of the direction to the sampled light and of that sampled from the BRDF.
    f: [[PairRow; 3]; 2],
    pdf: [PairRow; 2],
}

impl Default for PairTerms {
    fn default() -> PairTerms {
        let zero = [0.0; LARGEST];
        PairTerms {
            geometry: zero,
            density: zero,
            throughput: [zero; 3],
            f: [[zero; 3]; 2],
            pdf: [zero; 2],
        }
    }
}

/// Light times the cosine over the density of its direction; none where there is none, for where a
/// path did not go on the density may be so near to 0 that it has no finite inverse.
#[inline(always)]
fn over(light: Rgb, cos: f32, density: f32) -> Rgb {
    if light.is_black() { Rgb::BLACK } else { light * (cos / density) }
}

/// One reuse vertex.
struct ReuseVertex {
    slot: usize,
    seen: u128,
    p: V3,
    ng: V3,
    frame: Frame,
    params: BrdfParams,
    /// Whether its specular lobe is weak.
    weak: bool,
    light_dir: (V3, f32),
    bsdf_dir: (V3, f32),
    /// What its own path has: BRDF of the sampled direction, the same times the cosine in the frame that
    /// it sees, and the density with which it would have sampled the direction to the light.
    f: Rgb,
    own_f_cos: Rgb,
    own_light_pdf: f32,
    light: Rgb,
    emitted: Rgb,
    emitted_pdf: f32,
    reflected: Rgb,
}

impl ReuseVertex {
    #[inline(always)]
    fn at(reuse: &ReuseVertices, materials: &MaterialTable, entry: usize) -> ReuseVertex {
        let slot = reuse.slot.0[entry] as usize;
        let material = reuse.point.material.0[entry];
        ReuseVertex {
            slot,
            seen: reuse.seen[entry],
            p: reuse.point.p.get(entry).into(),
            ng: reuse.point.ng.get(entry).into(),
            frame: Frame::around(V3::from(reuse.point.ns.get(entry))),
            params: materials.params(material),
            weak: materials.is_weak(material),
            light_dir: (reuse.light_dir.wi.get(entry).into(), reuse.light_dir.pdf.0[entry]),
            bsdf_dir: (reuse.bsdf_dir.wi.get(entry).into(), reuse.bsdf_dir.pdf.0[entry]),
            f: reuse.f.get(entry).into(),
            own_f_cos: reuse.own_f_cos.get(entry).into(),
            own_light_pdf: reuse.own_light_pdf.0[entry],
            light: reuse.light[slot].into(),
            emitted: reuse.emitted[slot].into(),
            emitted_pdf: reuse.emitted_pdf[slot],
            reflected: reuse.reflected[slot].into(),
        }
    }

    /// Adds to the viewers what this point sends them; where all of them are `diffuse`, what is still to
    /// be multiplied by their reflectance.
    #[inline(always)]
    fn send<P: SimdWide, M: Microfacet>(
        &self,
        primary: &PrimaryVertices,
        base: usize,
        diffuse: bool,
        (viewers, images): (&mut [Viewers<P>], &[Image<P>]),
        pairs: &mut PairTerms,
    ) {
        let group = viewers.len() * P::WIDTH;
        let own = self.slot - base;
        if diffuse {
            self.pair_terms_diffuse::<P>(viewers, images, pairs);
        } else {
            self.pair_terms::<P, M>(viewers, images, pairs);
            // The density with which its own path found the point, by area, and what it carries: its own
            // path knows its own numbers from having sampled them, to more digits.
            let away = self.p - V3::from(primary.point.p.get(self.slot));
            let inverse2 = 1.0 / away.length2();
            let geometry = self.ng.dot(away).abs() * inverse2 * inverse2.sqrt();
            let density = primary.pdf.0[self.slot] * geometry;
            pairs.density[own] = density;
            let beta = primary.beta.get(self.slot);
            for (throughput, beta) in pairs.throughput.iter_mut().zip(beta) {
                throughput[own] = beta * density;
            }
        }
        let all = sum(&pairs.density, group);
        let per_all = 1.0 / all;
        if !(all > 0.0 && per_all > 0.0 && per_all < f32::INFINITY) {
            return;
        }
        let cosines = [self.light_dir.0.z, self.bsdf_dir.0.z];
        if self.bends_for(viewers) {
            self.evaluate_bent::<P, M>(viewers, pairs);
            // Its own path knows the BRDF to more digits.
            self.spread(viewers, pairs, (own, self.own_f_cos), diffuse, [all, per_all], [1.0; 2]);
        } else if self.params.ks.is_black() || self.weak {
            self.spread_by_own_densities::<P, M>(viewers, pairs, diffuse, per_all);
        } else {
            self.evaluate::<P, M>(viewers, pairs);
            self.spread(viewers, pairs, (own, self.f), diffuse, [all, per_all], cosines);
        }
    }

    /// [`ReuseVertex::evaluate`] and [`ReuseVertex::spread`] with the densities of its own path alone for
    /// both directions.
    #[inline(always)]
    fn spread_by_own_densities<P: SimdWide, M: Microfacet>(
        &self,
        viewers: &mut [Viewers<P>],
        pairs: &PairTerms,
        diffuse: bool,
        per_all: f32,
    ) {
        let ways = [self.light_dir.0, self.bsdf_dir.0];
        let lights = [
            self.by_light_sampling(self.own_light_pdf, ways[0].z) * per_all,
            self.by_bsdf_sampling(self.bsdf_dir.1, ways[1].z) * per_all,
        ];
        let lo = (self.params.kd * (lights[0] + lights[1]) * INV_PI).splat_lanes::<P>();
        if self.params.ks.is_black() {
            for (at, viewers) in (0..).step_by(P::WIDTH).zip(viewers) {
                viewers.sum += pairs.throughput_at::<P>(at, diffuse) * lo;
            }
            return;
        }
        let p2 = self.p.splat_lanes::<P>();
        let frame = self.frame.splat_lanes::<P>();
        let params = self.params.splat_lanes::<P>();
        for (at, viewers) in (0..).step_by(P::WIDTH).zip(viewers) {
            let back = viewers.p - p2;
            let wo = frame.to_local(back * (P::splat(1.0) / back.length2()).sqrt());
            let lobe = params.at_wo::<M>(wo);
            let mut lo = lo;
            for (wi, light) in ways.into_iter().zip(lights) {
                if !light.is_black() {
                    lo += lobe.specular::<M>(wi.splat_lanes()) * light.splat_lanes();
                }
            }
            viewers.sum += pairs.throughput_at::<P>(at, diffuse) * lo;
        }
    }

    /// Adds up what was evaluated for all pairs, `f` for its own path's. The BRDFs are still to be
    /// multiplied by these cosines.
    #[inline(always)]
    fn spread<P: SimdWide>(
        &self,
        viewers: &mut [Viewers<P>],
        pairs: &mut PairTerms,
        (own, f): (usize, Rgb),
        diffuse: bool,
        [all, per_all]: [f32; 2],
        cosines: [f32; 2],
    ) {
        let group = viewers.len() * P::WIDTH;
        pairs.pdf[1][own] = self.bsdf_dir.1;
        for (row, f) in pairs.f[1].iter_mut().zip(<[f32; 3]>::from(f)) {
            row[own] = f;
        }
        let wanted = self.wanted();
        let mut densities = [0.0; 2];
        for (which, density) in densities.iter_mut().enumerate() {
            if !wanted[which] {
                continue;
            }
            let pdf = &pairs.pdf[which];
            let mut products = [0.0; LARGEST];
            let shares = &pairs.density[..group];
            for ((product, pdf), share) in products.iter_mut().zip(pdf).zip(shares) {
                *product = pdf * share;
            }
            *density = sum(&products, group) / all;
        }
        let lights = [
            self.by_light_sampling(densities[0], cosines[0]) * per_all,
            self.by_bsdf_sampling(densities[1], cosines[1]) * per_all,
        ];
        for (which, light) in lights.into_iter().enumerate() {
            if !wanted[which] {
                continue;
            }
            let light = light.splat_lanes::<P>();
            for (at, viewers) in (0..).step_by(P::WIDTH).zip(&mut *viewers) {
                let lo = pairs.f_at::<P>(which, at) * light;
                viewers.sum += pairs.throughput_at::<P>(at, diffuse) * lo;
            }
        }
    }

    /// From which of the two directions there comes any light.
    #[inline(always)]
    fn wanted(&self) -> [bool; 2] {
        [!self.light.is_black(), !(self.emitted.is_black() && self.reflected.is_black())]
    }

    /// What arrives from the sampled light, times the cosine, over the density of its direction:
    /// by light sampling, and by sampling as the group does on the mean.
    #[inline(always)]
    fn by_light_sampling(&self, pdf: f32, cos: f32) -> Rgb {
        // Another viewer's normal might have had it above.
        if cos > 0.0 { over(self.light, cos, self.light_dir.1 + pdf) } else { Rgb::BLACK }
    }

    /// The same for the sampled direction; light that was reflected there cannot be found by light sampling.
    #[inline(always)]
    fn by_bsdf_sampling(&self, pdf: f32, cos: f32) -> Rgb {
        if pdf <= 0.0 {
            return Rgb::BLACK;
        }
        over(self.emitted, cos, self.emitted_pdf + pdf) + over(self.reflected, cos, pdf)
    }

    /// Geometry, densities and BRDFs at the primary vertices.
    #[inline(always)]
    fn pair_terms<P: SimdWide, M: Microfacet>(
        &self,
        viewers: &[Viewers<P>],
        images: &[Image<P>],
        pairs: &mut PairTerms,
    ) {
        let (p2, ng2) = (self.p.splat_lanes::<P>(), self.ng.splat_lanes::<P>());
        for (at, viewers) in (0..).step_by(P::WIDTH).zip(viewers) {
            let seen = P::mask((self.seen >> at) as u32);
            let away = p2 - viewers.p;
            let inverse2 = P::splat(1.0) / away.length2();
            let wi = away * inverse2.sqrt();
            let geometry = (ng2.dot(wi).abs() * inverse2).or_zero(seen);
            let local = viewers.frame.to_local(wi);
            let e = viewers.brdf.eval::<M>(local);
            let f = e.f * (local.z * geometry);
            let mut pdf = e.pdf;
            if !viewers.images.is_empty() {
                let aimed = highlights::pdf(&images[viewers.images.clone()], wi);
                pdf = (P::splat(1.0) - viewers.chance) * pdf + aimed;
            }
            geometry.store(&mut pairs.geometry[at..]);
            // Where nothing is carried the path would have ended.
            let seen = seen & !is_black(e.f);
            (pdf * geometry).or_zero(seen).store(&mut pairs.density[at..]);
            for (f, row) in [f.r, f.g, f.b].into_iter().zip(&mut pairs.throughput) {
                f.or_zero(seen).store(&mut row[at..]);
            }
        }
    }

    /// [`ReuseVertex::pair_terms`] where all primary vertices are diffuse: BRDF and cosine over the reflectance
    /// are the density.
    #[inline(always)]
    fn pair_terms_diffuse<P: SimdWide>(
        &self,
        viewers: &[Viewers<P>],
        images: &[Image<P>],
        pairs: &mut PairTerms,
    ) {
        let (p2, ng2) = (self.p.splat_lanes::<P>(), self.ng.splat_lanes::<P>());
        for (at, viewers) in (0..).step_by(P::WIDTH).zip(viewers) {
            let seen = P::mask((self.seen >> at) as u32);
            let away = p2 - viewers.p;
            let inverse2 = P::splat(1.0) / away.length2();
            let cosines = viewers.frame.n.dot(away) * ng2.dot(away).abs() * inverse2;
            let density = (cosines * P::splat(INV_PI) * inverse2).or_zero(seen);
            density.store(&mut pairs.throughput[0][at..]);
            let mut density = density;
            if !viewers.images.is_empty() {
                let inverse = inverse2.sqrt();
                let geometry = ng2.dot(away).abs() * inverse2 * inverse;
                let aimed = highlights::pdf(&images[viewers.images.clone()], away * inverse);
                // Below the surface nothing is carried.
                let carries = seen & density.gt(P::splat(0.0));
                let aimed = (aimed * geometry).or_zero(carries);
                density = (P::splat(1.0) - viewers.chance) * density + aimed;
            }
            density.store(&mut pairs.density[at..]);
        }
    }

    /// Whether the normal here is bent for any of those who see it.
    #[inline(always)]
    fn bends_for<P: SimdWide>(&self, viewers: &[Viewers<P>]) -> bool {
        if self.frame.n == self.ng {
            return false;
        }
        let p2 = self.p.splat_lanes::<P>();
        let (ng, ns) = (self.ng.splat_lanes::<P>(), self.frame.n.splat_lanes::<P>());
        for (at, viewers) in (0..).step_by(P::WIDTH).zip(viewers) {
            let back = viewers.p - p2;
            let wo = back * (P::splat(1.0) / back.length2()).sqrt();
            if (P::mask((self.seen >> at) as u32) & bent(ng, ns, wo).1).any() {
                return true;
            }
        }
        false
    }

    /// BRDFs, times the cosine, and densities at this point, in the frame that each viewer has here.
    #[inline(always)]
    fn evaluate_bent<P: SimdWide, M: Microfacet>(
        &self,
        viewers: &[Viewers<P>],
        pairs: &mut PairTerms,
    ) {
        let p2 = self.p.splat_lanes::<P>();
        let (ng, ns) = (self.ng.splat_lanes::<P>(), self.frame.n.splat_lanes::<P>());
        let params = self.params.splat_lanes::<P>();
        let ways = [self.light_dir, self.bsdf_dir].map(|(wi, _)| self.frame.to_world(wi));
        let wanted = self.wanted();
        for (at, viewers) in (0..).step_by(P::WIDTH).zip(viewers) {
            let seen = P::mask((self.seen >> at) as u32);
            let back = viewers.p - p2;
            let wo = back * (P::splat(1.0) / back.length2()).sqrt();
            let frame = Frame::around(bent(ng, ns, wo).0);
            let brdf = params.at_wo::<M>(frame.to_local(wo));
            for (which, wi) in ways.into_iter().enumerate() {
                if !wanted[which] {
                    continue;
                }
                let wi = frame.to_local(wi.splat_lanes());
                let e = brdf.eval::<M>(wi);
                let reflects = seen & wi.z.gt(P::splat(0.0)) & !is_black(e.f);
                let f = e.f * wi.z;
                e.pdf.or_zero(reflects).store(&mut pairs.pdf[which][at..]);
                for (f, row) in [f.r, f.g, f.b].into_iter().zip(&mut pairs.f[which]) {
                    f.or_zero(reflects).store(&mut row[at..]);
                }
            }
        }
    }

    /// BRDFs and densities at this point.
    #[inline(always)]
    fn evaluate<P: SimdWide, M: Microfacet>(&self, viewers: &[Viewers<P>], pairs: &mut PairTerms) {
        let p2 = self.p.splat_lanes::<P>();
        let frame = self.frame.splat_lanes::<P>();
        let params = self.params.splat_lanes::<P>();
        let wanted = self.wanted();
        for (at, viewers) in (0..).step_by(P::WIDTH).zip(viewers) {
            let seen = P::mask((self.seen >> at) as u32);
            let back = viewers.p - p2;
            let wo = frame.to_local(back * (P::splat(1.0) / back.length2()).sqrt());
            let brdf = params.at_wo::<M>(wo);
            for (which, (wi, _)) in [self.light_dir, self.bsdf_dir].into_iter().enumerate() {
                if !wanted[which] {
                    continue;
                }
                let e = brdf.eval::<M>(wi.splat_lanes());
                let pdf = e.pdf.or_zero(seen & !is_black(e.f));
                pdf.store(&mut pairs.pdf[which][at..]);
                for (f, row) in [e.f.r, e.f.g, e.f.b].into_iter().zip(&mut pairs.f[which]) {
                    f.or_zero(seen).store(&mut row[at..]);
                }
            }
        }
    }
}

impl PairTerms {
    #[inline(always)]
    fn throughput_at<P: SimdWide>(&self, at: usize, diffuse: bool) -> Rgb<P> {
        let [r, g, b] = &self.throughput;
        if diffuse {
            return Rgb::splat(P::load(&r[at..]));
        }
        Rgb::new(P::load(&r[at..]), P::load(&g[at..]), P::load(&b[at..]))
    }

    #[inline(always)]
    fn f_at<P: SimdWide>(&self, which: usize, at: usize) -> Rgb<P> {
        let [r, g, b] = &self.f[which];
        Rgb::new(P::load(&r[at..]), P::load(&g[at..]), P::load(&b[at..]))
    }
}

/// The sum of the first `count` numbers, a multiple of [`MAX_WIDTH`], in an order that does not depend on the
/// registers' width.
#[inline(always)]
fn sum(row: &PairRow, count: usize) -> f32 {
    let mut sums = [0.0; MAX_WIDTH];
    for part in row[..count].chunks_exact(MAX_WIDTH) {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_light_over_next_to_no_density_is_no_light() {
        let sum = over(Rgb::BLACK, 0.5, 1e-40) + over(Rgb::splat(1.0), 0.5, 2.0);
        assert_eq!([sum.r, sum.g, sum.b], [0.25; 3]);
    }
}
