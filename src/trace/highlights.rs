//! Highlights: directions in which polished balls mirror lights.
//!
//! The light that a polished ball throws on a surface beside it, its caustic, comes from a small part of
//! the ball, which a direction drawn from the surface's BRDF seldom finds. But the point of a sphere that
//! mirrors the middle of a light is known, and the size of the light's image there follows from how a
//! thin beam spreads at a curved mirror (Coddington's equations; Born and Wolf, "Principles of optics", 4.6). So a
//! part of the directions that leave a primary vertex is drawn around such images. The chance of that grows
//! with the light that an image may send, as if nothing were in the way.
//!
//! All of it is a function of the point and its normal alone: whoever finds a direction knows with which
//! density it would have been drawn elsewhere.

#[cfg(test)]
mod tests;

use super::lights::{LightDisc, Lights};
use crate::brdf::{Alpha, schlick, schlick_weight};
use crate::math::simd::{Mask, Simd, SimdWide};
use crate::math::special::{INV_PI, sin_cos_2pi};
use crate::math::{Frame, Rgb, V3};
use crate::scene::{Material, Scene};

/// Most pairs of a ball and a light; the strongest are taken.
const MOST: usize = 4;
/// Balls that are as rough as this throw light so widely that it is found without help.
const SHARP: f32 = 0.15;
/// How many times its share of the light an image is aimed at while that is small, and the largest chance of
/// all together. With 2 and 1, and none below 0.01, the built-in scene had 1.17 times the error.
const EAGER: f32 = 10.0;
const LARGEST: f32 = 0.2;
/// Images that would be aimed at by less than this are left to chance.
const LEAST: f32 = 3e-3;
/// A lobe of roughness alpha mirrors directions to within this times alpha; half at a microfacet.
const BLUR: f32 = 4.0;
/// Newton's steps towards the point that mirrors a light.
const STEPS: usize = 2;

/// Pairs of balls and lights.
#[derive(Debug)]
pub(super) struct Highlights {
    lights: Vec<LightDisc>,
    /// The irradiance that the surroundings give, in the units of the lights.
    sky: f32,
    pairs: Vec<MirroredLight>,
}

/// A ball and a light that it mirrors.
#[derive(Clone, Copy, Debug)]
struct MirroredLight {
    centre: V3,
    radius: f32,
    ks: f32,
    /// What the lobe adds to the size of the light, in radians seen from the ball.
    blur: f32,
    light: LightDisc,
}

/// A light's image in a ball: directions around an axis, by their tangents over the image's half sizes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Image<P: Simd> {
    axis: V3<P>,
    /// In the plane of incidence and across it, over the image's half sizes in radians.
    across: [V3<P>; 2],
    half: [P; 2],
    chance: P,
    /// Density in 1/sr on the axis, times the chance.
    peak: P,
}

impl Highlights {
    pub(super) fn new(scene: &Scene, materials: &[Material], lights: &Lights) -> Highlights {
        let (discs, sky) = lights.discs(MOST);
        let mut pairs: Vec<(f32, MirroredLight)> = Vec::with_capacity(MOST + 1);
        let geometry = scene.geometry();
        let first = geometry.faces().len();
        for (i, sphere) in geometry.spheres.iter().enumerate() {
            let material = &materials[geometry.material((first + i) as u32) as usize];
            let ks = Rgb::from(material.ks);
            let alpha = Alpha::from(material.roughness).alpha;
            if ks.is_black() || alpha >= SHARP || material.emits() {
                continue;
            }
            let (ks, blur) = (ks.luminance(), BLUR * alpha);
            for &light in &discs {
                let away2 = (light.centre - sphere.centre).length2();
                let radius = sphere.radius;
                let strength = ks * light.intensity * radius.powi(2) / away2;
                let weakest = pairs.last().filter(|_| pairs.len() == MOST).map_or(0.0, |p| p.0);
                // One around the light mirrors it all around.
                if strength > weakest && strength.is_finite() && away2 > (1.1 * radius).powi(2) {
                    let pair = MirroredLight { centre: sphere.centre, radius, ks, blur, light };
                    let at = pairs.partition_point(|p| p.0 >= strength);
                    pairs.insert(at, (strength, pair));
                    pairs.truncate(MOST);
                }
            }
        }
        Highlights { lights: discs, sky, pairs: pairs.into_iter().map(|(_, pair)| pair).collect() }
    }

    /// Adds those that are seen from points with these unit normals; returns the chance to aim at
    /// one, below 1.
    #[inline(always)]
    pub(super) fn seen_from<P: SimdWide>(
        &self,
        p: V3<P>,
        n: V3<P>,
        which: P::Mask,
        images: &mut Vec<Image<P>>,
    ) -> P {
        let (zero, most) = (P::splat(0.0), P::splat(LARGEST));
        if self.pairs.is_empty() || !which.any() {
            return zero;
        }
        let mut direct = P::splat(self.sky);
        for light in &self.lights {
            let away2 = (light.centre.splat_lanes::<P>() - p).length2();
            direct = direct + P::splat(light.intensity) / away2;
        }
        let start = images.len();
        let mut sum = zero;
        for pair in &self.pairs {
            let near = which & pair.may_matter(p, n, direct);
            if near.any() {
                let image = pair.image(p, n, direct, near);
                if image.chance.gt(zero).any() {
                    sum = sum + image.chance;
                    images.push(image);
                }
            }
        }
        if images.len() == start {
            return zero;
        }
        let (scale, mut chance) = (most / (most + sum), zero);
        for image in &mut images[start..] {
            image.chance = image.chance * scale;
            image.peak = image.peak * scale;
            chance = chance + image.chance;
        }
        chance
    }
}

impl MirroredLight {
    /// Where the chance of [`MirroredLight::image`] may not be 0.
    #[inline(always)]
    fn may_matter<P: SimdWide>(&self, p: V3<P>, n: V3<P>, direct: P) -> P::Mask {
        let radius = P::splat(self.radius);
        let away = self.centre.splat_lanes::<P>() - p;
        let d1 = away.length() - radius;
        let above = (n.dot(away) + radius).gt(P::splat(0.0));
        let d2 = P::splat((self.light.centre - self.centre).length() - self.radius);
        let beam = d1 + d2 + P::splat(2.0) * d1 * d2 / radius;
        let bound = P::splat(EAGER * self.light.intensity) / (beam * beam * direct);
        above & d1.gt(radius * P::splat(1e-3)) & bound.ge(P::splat(LEAST))
    }

    /// The light's image for these points; the chance is 0 where it is not seen.
    #[inline(always)]
    fn image<P: SimdWide>(&self, p: V3<P>, n: V3<P>, direct: P, which: P::Mask) -> Image<P> {
        let (zero, one) = (P::splat(0.0), P::splat(1.0));
        let (centre, radius) = (self.centre.splat_lanes::<P>(), P::splat(self.radius));
        let to_p = p - centre;
        let to_light = (self.light.centre - self.centre).splat_lanes::<P>();
        let normal = mirroring_normal(to_p, to_light, radius);
        let (w1, w2) = (to_p - normal * radius, to_light - normal * radius);
        let (d1, d2) = (w1.length(), w2.length());
        let axis = w1 * (-one / d1);
        let cos = -normal.dot(axis);
        let lit = cos.gt(P::splat(1e-3)) & normal.dot(w2).gt(zero);
        let cos = cos.max(P::splat(1e-3)).min(one);
        // How far a unit of the light's size is spread where the beam arrives.
        let curved = P::splat(2.0) * d1 * d2 / radius;
        let beam = [d1 + d2 + curved / cos, d1 + d2 + curved * cos];
        let (size, blur) = (P::splat(self.light.radius), P::splat(self.blur) * d2);
        let half = [(size + blur) / beam[0], (size + blur * cos) / beam[1]];
        let across = normal + axis * cos;
        let slanted = across.length2().gt(P::splat(1e-6));
        let across = V3::select(slanted, across, Frame::around(axis).s);
        let s = (across - axis * axis.dot(across)).normalize();
        let t = axis.cross(s);
        let fresnel = schlick(Rgb::splat(P::splat(self.ks)), schlick_weight(one - cos)).r;
        let facing = n.dot(axis);
        let irradiance = P::splat(EAGER * self.light.intensity) * fresnel * facing;
        let chance = irradiance / (beam[0] * beam[1] * direct);
        let counts = which & lit & facing.gt(zero) & chance.ge(P::splat(LEAST));
        // Whatever is left of points where nothing is.
        let counts = counts & chance.lt(P::splat(1e6)) & s.length2().gt(P::splat(0.5));
        let chance = chance.or_zero(counts);
        let inverse = half.map(|half| one / half);
        let peak = chance * P::splat(2.0 * INV_PI) * (inverse[0] * inverse[1]);
        let peak = peak.or_zero(counts);
        Image { axis, across: [s * inverse[0], t * inverse[1]], half, chance, peak }
    }
}

/// About the unit normal of a sphere around the origin where it mirrors two points outside into each other:
/// from where a flat arc between them would, by Newton's steps towards the half vector.
#[inline(always)]
fn mirroring_normal<P: SimdWide>(a: V3<P>, b: V3<P>, radius: P) -> V3<P> {
    let one = P::splat(1.0);
    let (far_a, far_b) = (a.length(), b.length());
    let start = a * ((far_b - radius) / far_a) + b * ((far_a - radius) / far_b);
    let mut normal = start.normalize();
    for _ in 0..STEPS {
        let (w1, w2) = (a - normal * radius, b - normal * radius);
        let (i1, i2) = (one / w1.length(), one / w2.length());
        let h = w1 * i1 + w2 * i2;
        // Twice the cosine to the half vector, which a step of the normal turns the other way.
        let up = normal.dot(h);
        let gain = one / (one + radius * up * (i1 + i2) * P::splat(0.25));
        let towards = h * (one / up) - normal;
        normal = (normal + towards * gain).normalize();
    }
    normal
}

/// Density in 1/sr of unit directions to be drawn around these images, times the chance of that.
#[inline(always)]
pub(super) fn pdf<P: SimdWide>(images: &[Image<P>], d: V3<P>) -> P {
    let zero = P::splat(0.0);
    let mut sum = zero;
    for image in images {
        let along = image.axis.dot(d);
        let (x, y) = (image.across[0].dot(d), image.across[1].dot(d));
        // 2 / pi (1 + r²)^-3 over the half sizes, r² = (x² + y²) / along²; by solid angle over along³.
        let ratio = along / (along * along + x * x + y * y);
        let density = image.peak * (ratio * ratio * ratio);
        sum = sum + density.or_zero(along.gt(zero) & image.chance.gt(zero));
    }
    sum
}

/// Unit directions around these images, of which there is one at least: by a number below the chance of
/// that, and two uniform ones.
#[inline(always)]
pub(super) fn sample<P: SimdWide>(images: &[Image<P>], choice: P, u: [P; 2]) -> V3<P> {
    let (zero, one) = (P::splat(0.0), P::splat(1.0));
    let mut end = zero;
    let Image { mut axis, mut across, mut half, .. } = images[0];
    for image in images {
        let here = end.le(choice) & image.chance.gt(zero);
        axis = V3::select(here, image.axis, axis);
        for i in 0..2 {
            across[i] = V3::select(here, image.across[i], across[i]);
            half[i] = P::select(here, image.half[i], half[i]);
        }
        end = end + image.chance;
    }
    let r = (one / (one - u[0]).sqrt() - one).max(zero).sqrt();
    let (sin, cos) = sin_cos_2pi(u[1]);
    let (x, y) = (r * cos * half[0].sqr(), r * sin * half[1].sqr());
    (axis + across[0] * x + across[1] * y).normalize()
}
