//! What second points send to the first points that see them.

use super::super::Bundle;
use super::super::shade::is_black;
use super::super::surface::MaterialTable;
use super::{Firsts, LARGEST, Runs, Seconds};
use crate::brdf::{Lobes, Microfacet, View};
use crate::geometry::bent;
use crate::math::lanes::{Mask, Packet};
use crate::math::special::INV_PI;
use crate::math::{Frame, Rgb, V3};
use crate::trace::Tracer;

impl Tracer {
    /// Adds to each path what the second points of its group send its way. Returns how often a
    /// specular lobe was evaluated for it.
    #[inline(always)]
    pub(in super::super) fn share<P: Packet, M: Microfacet>(&self, bundle: &mut Bundle) -> u64 {
        let Bundle { firsts, seconds, ends, radiance, .. } = bundle;
        let materials = &self.tables.materials;
        let mut viewers: Vec<Viewers<P>> = Vec::with_capacity(LARGEST / P::WIDTH);
        let mut pairs = Pairs::default();
        let mut run = Runs::new(ends);
        let (mut at, mut glossy) = (0, 0);
        while let Some(&first) = seconds.order.get(at) {
            run.reach(seconds.slot.0[first as usize] as usize);
            viewers.clear();
            // As many as can be summed up in the same order by any width.
            let places = run.base..run.base + run.len().next_multiple_of(16);
            for at in places.step_by(P::WIDTH) {
                viewers.push(Viewers::load::<M>(firsts, materials, at));
            }
            let matt = (run.base..run.end).all(|at| {
                let lobes = materials.shared_lobes(firsts.point.material.0[at]);
                firsts.there.0[at] == 0 || lobes.ks.is_black()
            });
            while let Some(&entry) = seconds.order.get(at) {
                let entry = entry as usize;
                let slot = seconds.slot.0[entry] as usize;
                if slot >= run.end {
                    break;
                }
                at += 1;
                if seconds.is_lit(slot) {
                    let second = Second::at(seconds, firsts, materials, entry);
                    // At the first points one direction, at the second one two.
                    let lobes = u64::from(!matt) + 2 * u64::from(!second.shared.ks.is_black());
                    glossy += lobes * run.len() as u64;
                    let rest =
                        second.send::<P, M>(firsts, run.base, matt, &mut viewers, &mut pairs);
                    let rest = rest * Rgb::from(firsts.throughput.get(slot));
                    let own = &mut radiance[slot];
                    for (sum, rest) in own.iter_mut().zip(<[f32; 3]>::from(rest)) {
                        *sum += rest;
                    }
                }
            }
            for (at, viewers) in (run.base..run.end).step_by(P::WIDTH).zip(&viewers) {
                let mut sum = viewers.sum * firsts.throughput.load_rgb::<P>(at);
                if matt {
                    sum *= viewers.view.lobes().kd;
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
        glossy
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
            view: material.shared_lobes().seen_from::<M>(wo),
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

/// Light times the cosine over the density of its direction; none where there is none, for where a
/// path did not go on the density may be so near to 0 that it has no finite inverse.
#[inline(always)]
fn over(light: Rgb, cos: f32, density: f32) -> Rgb {
    if light.is_black() { Rgb::BLACK } else { light * (cos / density) }
}

/// One second point.
struct Second {
    slot: usize,
    seen: u128,
    p: V3,
    ng: V3,
    frame: Frame,
    /// All of the BRDF, and the part that is shared.
    lobes: Lobes,
    shared: Lobes,
    /// Kd of the path's first point if the lobe there is weak.
    weak_first: Option<Rgb>,
    asked: (V3, f32),
    sampled: (V3, f32),
    f: Rgb,
    own: OwnSecond,
    light: Rgb,
    emitted: Rgb,
    emitted_pdf: f32,
    reflected: Rgb,
}

/// What its own path makes of the two directions: BRDF times cosine, and the density of sampling
/// the asked one.
struct OwnSecond {
    asked: Rgb,
    asked_pdf: f32,
    sampled: Rgb,
}

impl Second {
    #[inline(always)]
    fn at(seconds: &Seconds, firsts: &Firsts, materials: &MaterialTable, entry: usize) -> Second {
        let slot = seconds.slot.0[entry] as usize;
        let (first, second) = (firsts.point.material.0[slot], seconds.point.material.0[entry]);
        Second {
            slot,
            seen: seconds.seen[entry],
            p: seconds.point.p.get(entry).into(),
            ng: seconds.point.ng.get(entry).into(),
            frame: Frame::around(V3::from(seconds.point.ns.get(entry))),
            lobes: materials.lobes(second),
            shared: materials.shared_lobes(second),
            weak_first: materials.is_weak(first).then(|| materials.lobes(first).kd),
            asked: (seconds.asked.wi.get(entry).into(), seconds.asked.pdf.0[entry]),
            sampled: (seconds.sampled.wi.get(entry).into(), seconds.sampled.pdf.0[entry]),
            f: seconds.f.get(entry).into(),
            own: OwnSecond {
                asked: seconds.own_asked.get(entry).into(),
                asked_pdf: seconds.own_asked_pdf.0[entry],
                sampled: seconds.own_sampled.get(entry).into(),
            },
            light: seconds.light[slot].into(),
            emitted: seconds.emitted[slot].into(),
            emitted_pdf: seconds.emitted_pdf[slot],
            reflected: seconds.reflected[slot].into(),
        }
    }

    /// Adds to the viewers what this point sends them; where all of them are `matt`, what is still to
    /// be multiplied by their reflectance. Returns what its own path has besides, of lobes that are
    /// not shared.
    #[inline(always)]
    fn send<P: Packet, M: Microfacet>(
        &self,
        firsts: &Firsts,
        base: usize,
        matt: bool,
        viewers: &mut [Viewers<P>],
        pairs: &mut Pairs,
    ) -> Rgb {
        let group = viewers.len() * P::WIDTH;
        let own = self.slot - base;
        if matt {
            self.join_matt::<P>(viewers, pairs);
        } else {
            self.join::<P, M>(viewers, pairs);
        }
        // The density with which its own path found the point, by area.
        let away = self.p - V3::from(firsts.point.p.get(self.slot));
        let inverse2 = 1.0 / away.length2();
        let geometry = self.ng.dot(away).abs() * inverse2 * inverse2.sqrt();
        let density = firsts.pdf.0[self.slot] * geometry;
        // Of what it sends the part that is shared has this share. Its own path knows its own numbers
        // from having sampled them, to more digits.
        let mut share = 1.0;
        let mut beta = Rgb::from(firsts.beta.get(self.slot));
        if let Some(kd) = self.weak_first {
            share = firsts.diffuse_share.0[self.slot];
            beta = kd * share;
        }
        if self.weak_first.is_some() || !matt {
            pairs.density[own] = share * density;
        }
        if !matt {
            for (carried, beta) in pairs.carried.iter_mut().zip(<[f32; 3]>::from(beta)) {
                carried[own] = beta * density;
            }
        }
        // A normal that is bent for some is a reason to share all that is there: the frames differ.
        let bends = self.bends_for(viewers);
        let mut rest = Rgb::BLACK;
        if self.weak_first.is_some() || (self.shared.ks != self.lobes.ks && !bends) {
            rest = self.rest(firsts, share, bends);
        }
        let all = sum(&pairs.density, group);
        let per_all = share / all;
        if !(all > 0.0 && per_all > 0.0 && per_all < f32::INFINITY) {
            return rest;
        }
        let cosines = [self.asked.0.z, self.sampled.0.z];
        if bends {
            self.evaluate_bent::<P, M>(viewers, pairs);
            // Its own path knows the BRDF to more digits.
            self.spread(viewers, pairs, (own, self.own.sampled), matt, [all, per_all], [1.0; 2]);
            return rest;
        }
        if self.shared.ks.is_black() {
            let lo = self.diffusely(self.lobes.kd) * per_all;
            let lo = lo.splat_lanes::<P>();
            for (at, viewers) in (0..).step_by(P::WIDTH).zip(viewers) {
                viewers.sum += pairs.carried_at::<P>(at, matt) * lo;
            }
            return rest;
        }
        self.evaluate::<P, M>(viewers, pairs);
        self.spread(viewers, pairs, (own, self.f), matt, [all, per_all], cosines);
        rest
    }

    /// What it sends back by its diffuse lobe, as its own path finds it.
    #[inline(always)]
    fn diffusely(&self, kd: Rgb) -> Rgb {
        let [asked, sampled] = [self.asked.0.z, self.sampled.0.z];
        let pdf =
            if self.lobes.ks.is_black() { asked.max(0.0) * INV_PI } else { self.own.asked_pdf };
        let light = self.by_asking(pdf, asked) + self.by_sampling(self.sampled.1, sampled);
        kd * light * INV_PI
    }

    /// What its own path has by lobes that are not shared; `share` is the part of it that is.
    #[inline(always)]
    fn rest(&self, firsts: &Firsts, share: f32, bends: bool) -> Rgb {
        let OwnSecond { asked, asked_pdf, sampled } = self.own;
        // The BRDFs have their cosines already.
        let whole = asked * self.by_asking(asked_pdf, 1.0)
            + sampled * self.by_sampling(self.sampled.1, 1.0);
        let weak_second = self.shared.ks != self.lobes.ks && !bends;
        let shared = if weak_second { self.diffusely(self.lobes.kd) } else { whole };
        let beta = Rgb::from(firsts.beta.get(self.slot));
        let shared_beta = self.weak_first.map_or(beta, |kd| kd * share);
        let less = |a: f32, b: f32| (a - b).max(0.0);
        let (a, b) = (beta * whole, shared_beta * shared);
        Rgb::new(less(a.r, b.r), less(a.g, b.g), less(a.b, b.b))
    }

    /// Adds up what was evaluated for all pairs, `f` for its own path's. The BRDFs are still to be
    /// multiplied by these cosines.
    #[inline(always)]
    fn spread<P: Packet>(
        &self,
        viewers: &mut [Viewers<P>],
        pairs: &mut Pairs,
        (own, f): (usize, Rgb),
        matt: bool,
        [all, per_all]: [f32; 2],
        cosines: [f32; 2],
    ) {
        let group = viewers.len() * P::WIDTH;
        pairs.pdf[1][own] = self.sampled.1;
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
            self.by_asking(densities[0], cosines[0]) * per_all,
            self.by_sampling(densities[1], cosines[1]) * per_all,
        ];
        for (which, light) in lights.into_iter().enumerate() {
            if !wanted[which] {
                continue;
            }
            let light = light.splat_lanes::<P>();
            for (at, viewers) in (0..).step_by(P::WIDTH).zip(&mut *viewers) {
                let lo = pairs.f_at::<P>(which, at) * light;
                viewers.sum += pairs.carried_at::<P>(at, matt) * lo;
            }
        }
    }

    /// From which of the two directions there comes any light.
    #[inline(always)]
    fn wanted(&self) -> [bool; 2] {
        [!self.light.is_black(), !(self.emitted.is_black() && self.reflected.is_black())]
    }

    /// What arrives from the asked light, times the cosine, over the density of its direction:
    /// by asking, and by sampling as the group does on the mean.
    #[inline(always)]
    fn by_asking(&self, pdf: f32, cos: f32) -> Rgb {
        // Another viewer's normal might have had it above.
        if cos > 0.0 { over(self.light, cos, self.asked.1 + pdf) } else { Rgb::BLACK }
    }

    /// The same for the sampled direction; light that was reflected there could not be asked for.
    #[inline(always)]
    fn by_sampling(&self, pdf: f32, cos: f32) -> Rgb {
        if pdf <= 0.0 {
            return Rgb::BLACK;
        }
        over(self.emitted, cos, self.emitted_pdf + pdf) + over(self.reflected, cos, pdf)
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

    /// Whether the normal here is bent for any of those who see it.
    #[inline(always)]
    fn bends_for<P: Packet>(&self, viewers: &[Viewers<P>]) -> bool {
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
    fn evaluate_bent<P: Packet, M: Microfacet>(&self, viewers: &[Viewers<P>], pairs: &mut Pairs) {
        let p2 = self.p.splat_lanes::<P>();
        let (ng, ns) = (self.ng.splat_lanes::<P>(), self.frame.n.splat_lanes::<P>());
        let lobes = self.lobes.splat_lanes::<P>();
        let ways = [self.asked, self.sampled].map(|(wi, _)| self.frame.to_world(wi));
        let wanted = self.wanted();
        for (at, viewers) in (0..).step_by(P::WIDTH).zip(viewers) {
            let seen = P::mask((self.seen >> at) as u32);
            let back = viewers.p - p2;
            let wo = back * (P::splat(1.0) / back.length2()).sqrt();
            let frame = Frame::around(bent(ng, ns, wo).0);
            let view = lobes.seen_from::<M>(frame.to_local(wo));
            for (which, wi) in ways.into_iter().enumerate() {
                if !wanted[which] {
                    continue;
                }
                let wi = frame.to_local(wi.splat_lanes());
                let e = view.eval::<M>(wi);
                let carries = seen & wi.z.gt(P::splat(0.0)) & !is_black(e.f);
                let f = e.f * wi.z;
                e.pdf.or_zero(carries).store(&mut pairs.pdf[which][at..]);
                for (f, row) in [f.r, f.g, f.b].into_iter().zip(&mut pairs.f[which]) {
                    f.or_zero(carries).store(&mut row[at..]);
                }
            }
        }
    }

    /// BRDFs and densities at this point.
    #[inline(always)]
    fn evaluate<P: Packet, M: Microfacet>(&self, viewers: &[Viewers<P>], pairs: &mut Pairs) {
        let p2 = self.p.splat_lanes::<P>();
        let frame = self.frame.splat_lanes::<P>();
        let lobes = self.lobes.splat_lanes::<P>();
        let wanted = self.wanted();
        for (at, viewers) in (0..).step_by(P::WIDTH).zip(viewers) {
            let seen = P::mask((self.seen >> at) as u32);
            let back = viewers.p - p2;
            let wo = frame.to_local(back * (P::splat(1.0) / back.length2()).sqrt());
            let view = lobes.seen_from::<M>(wo);
            for (which, (wi, _)) in [self.asked, self.sampled].into_iter().enumerate() {
                if !wanted[which] {
                    continue;
                }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_light_over_next_to_no_density_is_no_light() {
        let sum = over(Rgb::BLACK, 0.5, 1e-40) + over(Rgb::splat(1.0), 0.5, 2.0);
        assert_eq!([sum.r, sum.g, sum.b], [0.25; 3]);
    }
}
