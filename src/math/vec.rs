//! Vectors and colours over lanes.

use super::simd::Simd;
use std::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub};

/// A vector or point of three components.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct V3<L = f32> {
    /// First component.
    pub x: L,
    /// Second component.
    pub y: L,
    /// Third component; along the normal in a local frame.
    pub z: L,
}

impl<L: Simd> V3<L> {
    /// From components.
    #[inline(always)]
    pub fn new(x: L, y: L, z: L) -> Self {
        V3 { x, y, z }
    }
    /// The same number in every component.
    #[inline(always)]
    pub fn splat(x: L) -> Self {
        V3 { x, y: x, z: x }
    }
    /// Inner product.
    #[inline(always)]
    pub fn dot(self, o: Self) -> L {
        self.x * o.x + self.y * o.y + self.z * o.z
    }
    /// Vector product.
    #[inline(always)]
    pub fn cross(self, o: Self) -> Self {
        V3 {
            x: self.y * o.z - self.z * o.y,
            y: self.z * o.x - self.x * o.z,
            z: self.x * o.y - self.y * o.x,
        }
    }
    /// Squared length.
    #[inline(always)]
    pub fn length2(self) -> L {
        self.dot(self)
    }
    /// Length.
    #[inline(always)]
    pub fn length(self) -> L {
        self.length2().sqrt()
    }
    /// This vector divided by its length, which must not be zero.
    #[inline(always)]
    pub fn normalize(self) -> Self {
        self * (L::splat(1.0) / self.length())
    }
    /// The smaller of each pair of components.
    #[inline(always)]
    pub fn min(self, o: Self) -> Self {
        V3 { x: self.x.min(o.x), y: self.y.min(o.y), z: self.z.min(o.z) }
    }
    /// The larger of each pair of components.
    #[inline(always)]
    pub fn max(self, o: Self) -> Self {
        V3 { x: self.x.max(o.x), y: self.y.max(o.y), z: self.z.max(o.z) }
    }
    /// The magnitude of each component.
    #[inline(always)]
    pub fn abs(self) -> Self {
        V3 { x: self.x.abs(), y: self.y.abs(), z: self.z.abs() }
    }
    /// The largest component.
    #[inline(always)]
    pub fn max_component(self) -> L {
        self.x.max(self.y).max(self.z)
    }
    /// `a` where the mask is set, else `b`.
    #[inline(always)]
    pub fn select(mask: L::Mask, a: Self, b: Self) -> Self {
        V3 {
            x: L::select(mask, a.x, b.x),
            y: L::select(mask, a.y, b.y),
            z: L::select(mask, a.z, b.z),
        }
    }
}

impl V3 {
    /// This vector in every lane.
    #[inline(always)]
    pub fn splat_lanes<L: Simd>(self) -> V3<L> {
        V3 { x: L::splat(self.x), y: L::splat(self.y), z: L::splat(self.z) }
    }
}

impl<L: Simd> Add for V3<L> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        V3 { x: self.x + o.x, y: self.y + o.y, z: self.z + o.z }
    }
}
impl<L: Simd> Sub for V3<L> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        V3 { x: self.x - o.x, y: self.y - o.y, z: self.z - o.z }
    }
}
impl<L: Simd> Mul<L> for V3<L> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: L) -> Self {
        V3 { x: self.x * s, y: self.y * s, z: self.z * s }
    }
}
impl<L: Simd> Neg for V3<L> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        V3 { x: -self.x, y: -self.y, z: -self.z }
    }
}

impl From<[f32; 3]> for V3 {
    fn from([x, y, z]: [f32; 3]) -> V3 {
        V3 { x, y, z }
    }
}
impl From<V3> for [f32; 3] {
    fn from(v: V3) -> [f32; 3] {
        [v.x, v.y, v.z]
    }
}

/// A colour or radiance: linear, Rec. 709 primaries.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rgb<L = f32> {
    /// Red.
    pub r: L,
    /// Green.
    pub g: L,
    /// Blue.
    pub b: L,
}

impl<L: Simd> Rgb<L> {
    /// From components.
    #[inline(always)]
    pub fn new(r: L, g: L, b: L) -> Self {
        Rgb { r, g, b }
    }
    /// The same number in every channel.
    #[inline(always)]
    pub fn splat(x: L) -> Self {
        Rgb { r: x, g: x, b: x }
    }
    /// The same function on every channel.
    #[inline(always)]
    pub fn map(self, f: impl Fn(L) -> L) -> Self {
        Rgb { r: f(self.r), g: f(self.g), b: f(self.b) }
    }
    /// Rec. 709 luminance.
    #[inline(always)]
    pub fn luminance(self) -> L {
        self.r * L::splat(0.2126) + self.g * L::splat(0.7152) + self.b * L::splat(0.0722)
    }
    /// The largest channel.
    #[inline(always)]
    pub fn max_channel(self) -> L {
        self.r.max(self.g).max(self.b)
    }
}

impl Rgb {
    /// No light.
    pub const BLACK: Rgb = Rgb { r: 0.0, g: 0.0, b: 0.0 };
    /// This colour in every lane.
    #[inline(always)]
    pub fn splat_lanes<L: Simd>(self) -> Rgb<L> {
        Rgb { r: L::splat(self.r), g: L::splat(self.g), b: L::splat(self.b) }
    }
    /// True when every channel is exactly zero.
    #[inline(always)]
    pub fn is_black(self) -> bool {
        self == Rgb::BLACK
    }
    /// True when no channel is NaN or infinite.
    #[inline(always)]
    pub fn is_finite(self) -> bool {
        self.r.is_finite() && self.g.is_finite() && self.b.is_finite()
    }
}

impl<L: Simd> Add for Rgb<L> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Rgb { r: self.r + o.r, g: self.g + o.g, b: self.b + o.b }
    }
}
impl<L: Simd> AddAssign for Rgb<L> {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}
impl<L: Simd> Mul for Rgb<L> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        Rgb { r: self.r * o.r, g: self.g * o.g, b: self.b * o.b }
    }
}
impl<L: Simd> Mul<L> for Rgb<L> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: L) -> Self {
        Rgb { r: self.r * s, g: self.g * s, b: self.b * s }
    }
}
impl<L: Simd> MulAssign for Rgb<L> {
    #[inline(always)]
    fn mul_assign(&mut self, o: Self) {
        *self = *self * o;
    }
}

impl From<[f32; 3]> for Rgb {
    fn from([r, g, b]: [f32; 3]) -> Rgb {
        Rgb { r, g, b }
    }
}
impl From<Rgb> for [f32; 3] {
    fn from(c: Rgb) -> [f32; 3] {
        [c.r, c.g, c.b]
    }
}
