//! One large quad against as many rays as a register holds: how far its plane is, and how far inside its
//! edges they hit it.

use crate::math::V3;
use crate::math::record::{RecordField, gather_record};
use crate::math::simd::SimdWide;

/// A triangle, or two that make a convex quadrilateral.
#[derive(Clone, Debug)]
pub(super) struct Quad {
    /// Unit normal and its product with the points of the plane.
    pub(super) n: V3,
    pub(super) d: f32,
    pub(super) sides: Sides,
    /// Across the diagonal, towards the second triangle, if there is one.
    pub(super) diagonal: Option<Line>,
    pub(super) triangles: [u32; 2],
    pub(super) slenderness: f32,
}

gather_record! {
    /// A line in a large quad's plane: a unit vector across it and its product with the line's points.
    pub(super) struct Line {
        pub(super) m: V3,
        pub(super) c: f32,
    }
}

/// Two parallel edges: the line in the middle between them, and how far off they are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strip {
    pub(super) middle: Line,
    pub(super) half: f32,
}

/// A large quad's edges, their lines inwards. Parallel ones are looked at together.
#[derive(Clone, Debug)]
pub(super) enum Sides {
    Triangle([Line; 3]),
    Parallelogram([Strip; 2]),
    Trapezoid(Strip, [Line; 2]),
    Quadrilateral([Line; 4]),
}

/// How far it is to a plane along a ray.
#[derive(Clone, Copy)]
pub(super) struct Way<P> {
    pub(super) t: P,
    /// How far off that may be.
    pub(super) within: P,
    /// How far off the point's distances in the plane may be.
    pub(super) band: P,
}

impl<P: SimdWide> Way<P> {
    #[inline(always)]
    pub(super) fn point(&self, o: V3<P>, d: V3<P>) -> V3<P> {
        let t = self.t;
        V3::new(d.x.mul_add(t, o.x), d.y.mul_add(t, o.y), d.z.mul_add(t, o.z))
    }

    /// Whether it is certainly not ahead, or beyond `t_max`.
    #[inline(always)]
    pub(super) fn is_off(&self, t_max: P) -> P::Mask {
        let depth = self.t.min(t_max - self.t);
        (depth + self.within).lt(P::splat(0.0))
    }

    /// How far within the edges, ahead of the ray's start and before `t_max` it is, by the least of
    /// the three: at most, and at least. Of a ray along the plane neither is above or below 0.
    #[inline(always)]
    pub(super) fn depth(&self, inside: P, t_max: P) -> [P; 2] {
        let (along, Way { within, band, .. }) = (self.t.min(t_max - self.t), *self);
        [(inside + band).min(along + within), (inside - band).min(along - within)]
    }
}

impl Quad {
    #[inline(always)]
    pub(super) fn way<P: SimdWide>(&self, o: V3<P>, d: V3<P>, clearance: P) -> Way<P> {
        let inverse = dot(self.n, d).recip();
        let t = (P::splat(self.d) - dot(self.n, o)) * inverse;
        let band = clearance * inverse.abs();
        Way { t, within: band * P::splat(self.slenderness), band }
    }
}

impl Sides {
    /// Four edges; a triangle's last one twice.
    pub(super) fn lines(&self) -> [Line; 4] {
        match *self {
            Sides::Triangle([a, b, c]) => [a, b, c, c],
            Sides::Parallelogram([one, other]) => {
                let ([a, b], [c, e]) = (one.edges(), other.edges());
                [a, b, c, e]
            }
            Sides::Trapezoid(strip, [c, e]) => {
                let [a, b] = strip.edges();
                [a, b, c, e]
            }
            Sides::Quadrilateral(lines) => lines,
        }
    }

    /// How far inside a point of the plane is.
    #[inline(always)]
    pub(super) fn inside<P: SimdWide>(&self, x: V3<P>) -> P {
        match self {
            Sides::Triangle([a, b, c]) => a.across(x).min(b.across(x)).min(c.across(x)),
            Sides::Parallelogram([a, b]) => a.inside(x).min(b.inside(x)),
            Sides::Trapezoid(strip, [a, b]) => strip.inside(x).min(a.across(x).min(b.across(x))),
            Sides::Quadrilateral([a, b, c, e]) => {
                a.across(x).min(b.across(x)).min(c.across(x).min(e.across(x)))
            }
        }
    }
}

impl Line {
    /// How far points are across the line.
    #[inline(always)]
    pub(super) fn across<P: SimdWide>(&self, x: V3<P>) -> P {
        Line::splat::<P>(self).each_across(x)
    }
}

impl<P: SimdWide> Line<P> {
    /// How far points are across, each across its own line.
    #[inline(always)]
    pub(super) fn each_across(&self, x: V3<P>) -> P {
        let y = x.y.mul_add(self.m.y, x.x * self.m.x);
        x.z.mul_add(self.m.z, y) - self.c
    }
}

impl Strip {
    pub(super) fn edges(&self) -> [Line; 2] {
        let Line { m, c } = self.middle;
        [Line { m, c: c - self.half }, Line { m: -m, c: -c - self.half }]
    }

    #[inline(always)]
    pub(super) fn inside<P: SimdWide>(&self, x: V3<P>) -> P {
        P::splat(self.half) - self.middle.across(x).abs()
    }
}

#[inline(always)]
pub(super) fn dot<P: SimdWide>(n: V3, v: V3<P>) -> P {
    let y = v.y.mul_add(P::splat(n.y), v.x * P::splat(n.x));
    v.z.mul_add(P::splat(n.z), y)
}
