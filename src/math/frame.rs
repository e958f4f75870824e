//! Orthonormal frames.

use super::simd::Simd;
use super::vec::V3;

/// Right-handed orthonormal axes; `n` is the local z.
#[derive(Clone, Copy, Debug)]
pub struct Frame<L = f32> {
    /// Local x.
    pub s: V3<L>,
    /// Local y.
    pub t: V3<L>,
    /// Local z.
    pub n: V3<L>,
}

impl<L: Simd> Frame<L> {
    /// Some frame around the unit vector `n`, without a branch and without a pole (Duff et al.,
    /// "Building an orthonormal basis, revisited", JCGT 6:1, 2017).
    #[inline(always)]
    pub fn around(n: V3<L>) -> Frame<L> {
        let one = L::splat(1.0);
        let sign = one.copysign(n.z);
        let a = -one / (sign + n.z);
        let b = n.x * n.y * a;
        Frame {
            s: V3::new(one + sign * n.x * n.x * a, sign * b, -sign * n.x),
            t: V3::new(b, sign + n.y * n.y * a, -n.y),
            n,
        }
    }

    /// World to local.
    #[inline(always)]
    pub fn to_local(&self, v: V3<L>) -> V3<L> {
        V3::new(v.dot(self.s), v.dot(self.t), v.dot(self.n))
    }

    /// Local to world.
    #[inline(always)]
    pub fn to_world(&self, v: V3<L>) -> V3<L> {
        self.s * v.x + self.t * v.y + self.n * v.z
    }
}

impl Frame {
    /// The same frame in every lane.
    #[inline(always)]
    pub fn splat_lanes<L: Simd>(&self) -> Frame<L> {
        Frame { s: self.s.splat_lanes(), t: self.t.splat_lanes(), n: self.n.splat_lanes() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orthonormal_everywhere_the_poles_included() {
        let mut worst = 0.0f32;
        for i in 0..2000 {
            let z = 1.0 - 2.0 * (i as f32 + 0.5) / 2000.0;
            let phi = i as f32 * 2.399_963;
            let r = (1.0 - z * z).sqrt();
            check(V3::new(r * phi.cos(), r * phi.sin(), z).normalize(), &mut worst);
        }
        for z in [1.0, -1.0] {
            for tilt in [0.0, 1e-8, 1e-6, 1e-4, 2e-3, 4e-2] {
                check(V3::new(tilt, -tilt, z).normalize(), &mut worst);
            }
        }
        assert!(worst < 5e-7, "{worst}");
    }

    fn check(n: V3, worst: &mut f32) {
        let f = Frame::around(n);
        for (a, b, expected) in [
            (f.s, f.s, 1.0),
            (f.t, f.t, 1.0),
            (f.s, f.t, 0.0),
            (f.s, f.n, 0.0),
            (f.t, f.n, 0.0),
            (f.s.cross(f.t), f.n, 1.0),
        ] {
            *worst = worst.max((a.dot(b) - expected).abs());
        }
    }
}
