//! What light sampling knows of a light: its shape when the table is built, its record in the lanes.

use super::area_of;
use super::importance::LightBounds;
use super::merge_triangles::{FlatLight, merge_triangles};
use crate::geometry::{Geometry, Kind, PrimitiveRange, Sphere};
use crate::math::gather_table::GatherTable;
use crate::math::record::{KindLanes, RecordField, RecordKind, gather_record};
use crate::math::simd::{Simd, U32};
use crate::math::{Rgb, V3};

/// Rounding a flat light's point, and hitting it again, costs less than this part of its largest
/// coordinate, as for any triangle.
const ERROR: f32 = 8.0 * f32::EPSILON;
/// A rectangle's corner is a right angle to within this cosine.
const RIGHT: f32 = 1e-5;
/// A rectangle is near where the square of its diagonal is more than this part of the distance's...
const NEAR: f32 = 2.0;
/// ...and it does not look so narrow, in sr by its middle, that rounding would show.
const LEAST_ANGLE: f32 = 0.02;
/// Smallest size that estimates see.
const SPARK: f32 = 1e-7;

/// How a light is sampled.
#[derive(Clone, Copy, Debug)]
#[repr(u32)]
pub(super) enum LightKind {
    Triangle,
    Parallelogram,
    Rectangle,
    Sphere,
    Cylinder,
    Environment,
}

impl RecordKind for LightKind {
    #[inline(always)]
    fn number(self) -> u32 {
        self as u32
    }
}

gather_record! {
    /// A light. What its kind does not have is 0.
    pub(super) struct LightRecord {
        pub(super) kind: LightKind,
        /// A flat light's, from which its sides go; a sphere's centre.
        pub(super) corner: V3,
        pub(super) sides: [V3; 2],
        /// A flat light's unit normal.
        pub(super) ng: V3,
        /// A sphere's.
        pub(super) radius: f32,
        pub(super) one_over_area: f32,
        /// How far off a point on it may be, by rounding.
        pub(super) error: f32,
        pub(super) radiance: Rgb,
        pub(super) surface_id: u32,
        /// The first of its primitives.
        pub(super) primitive: u32,
    }
}

/// All lights.
pub(super) type LightTable = GatherTable<LightRecord, { LightRecord::NUMBERS }>;

/// Bytes of a light in the table.
pub(super) const LIGHT_BYTES: usize = size_of::<[f32; LightRecord::NUMBERS]>();

impl<L: Simd> LightRecord<L> {
    /// Whether a rectangle is to be sampled by its solid angle.
    #[inline(always)]
    pub(super) fn is_near(&self, p: V3<L>) -> L::Mask {
        let diagonal = self.sides[0] + self.sides[1];
        let away = self.corner + diagonal * L::splat(0.5) - p;
        let distance2 = away.length2();
        let narrow = L::splat(LEAST_ANGLE) * self.one_over_area * distance2 * distance2.sqrt();
        let large = diagonal.length2().gt(L::splat(NEAR) * distance2);
        large & self.ng.dot(away).abs().gt(narrow)
    }
}

/// A light's shape.
pub(super) enum LightShape {
    FlatLight(FlatLight),
    Sphere(Sphere),
    /// Lowest and highest corner, axis times half the height, radius, area.
    Cylinder([V3; 2], V3, f32, f32),
    Environment,
}

/// The lights in a range of primitives, each with its first and last one.
pub(super) fn of(geometry: &Geometry, range: PrimitiveRange) -> Vec<(LightShape, [u32; 2])> {
    let PrimitiveRange { first, count } = range;
    if count > 0 && matches!(geometry.kind(first), Kind::Triangle(_)) {
        let flats = merge_triangles(geometry, first, count).into_iter();
        return flats.map(|flat| (LightShape::FlatLight(flat), flat.triangles)).collect();
    }
    (first..first + count)
        .filter_map(|primitive| {
            let shape = match geometry.kind(primitive) {
                Kind::Triangle(_) => return None,
                Kind::Sphere(i) => LightShape::Sphere(geometry.spheres[i]),
                Kind::Cylinder(i) => {
                    let c = &geometry.cylinders[i];
                    let half = c.axis() * (0.5 * c.height);
                    LightShape::Cylinder(c.bounds(), half, c.radius, area_of(geometry, primitive))
                }
            };
            Some((shape, [primitive; 2]))
        })
        .collect()
}

impl LightShape {
    pub(super) fn area(&self) -> f32 {
        match self {
            LightShape::FlatLight(flat) => flat.area(),
            LightShape::Sphere(sphere) => 4.0 * std::f32::consts::PI * sphere.radius.powi(2),
            LightShape::Cylinder(.., area) => *area,
            LightShape::Environment => f32::INFINITY,
        }
    }

    /// No point is taken to be known better than to `least_error`.
    pub(super) fn record(
        &self,
        primitive: u32,
        radiance: Rgb,
        surface_id: u32,
        least_error: f32,
    ) -> LightRecord {
        let nothing = V3::default();
        let record = LightRecord {
            kind: KindLanes::new(self.kind()),
            corner: nothing,
            sides: [nothing; 2],
            ng: nothing,
            radius: 0.0,
            one_over_area: 1.0 / self.area(),
            error: least_error,
            radiance,
            surface_id: U32(surface_id),
            primitive: U32(primitive),
        };
        match self {
            LightShape::FlatLight(FlatLight { corner, sides: [a, b], .. }) => {
                let corners = [*corner, *corner + *a, *corner + *b, *corner + *a + *b];
                let largest = corners.iter().map(|c| c.abs().max_component()).fold(0.0, f32::max);
                LightRecord {
                    corner: *corner,
                    sides: [*a, *b],
                    ng: a.cross(*b).normalize(),
                    error: (ERROR * largest).max(least_error),
                    ..record
                }
            }
            LightShape::Sphere(Sphere { centre, radius }) => {
                LightRecord { corner: *centre, radius: *radius, ..record }
            }
            LightShape::Cylinder(..) | LightShape::Environment => record,
        }
    }

    fn kind(&self) -> LightKind {
        match self {
            LightShape::FlatLight(flat) if !flat.is_pair() => LightKind::Triangle,
            LightShape::FlatLight(FlatLight { sides: [a, b], .. }) => {
                match a.dot(*b).abs() <= RIGHT * a.length() * b.length() {
                    true => LightKind::Rectangle,
                    false => LightKind::Parallelogram,
                }
            }
            LightShape::Sphere(_) => LightKind::Sphere,
            LightShape::Cylinder(..) => LightKind::Cylinder,
            LightShape::Environment => LightKind::Environment,
        }
    }

    /// `luminance` is the radiance's, in units of the brightest light's.
    pub(super) fn bound(&self, luminance: f32) -> LightBounds {
        let any = V3::new(0.0, 0.0, 1.0);
        let body = |centre: V3, half: V3, radius: f32, area: f32| LightBounds {
            centre,
            half,
            radius: radius.max(SPARK),
            axis: any,
            cos: 0.0,
            sin: 0.0,
            slack: 0.0,
            // A convex body shows a quarter of its surface, on the mean over all directions.
            area: 0.25 * area,
            luminance,
        };
        match self {
            LightShape::FlatLight(flat) => {
                let [a, b] = flat.sides;
                let third = V3::splat(1.0 / 3.0);
                let (centre, half, radius) = if flat.is_pair() {
                    let half = (a.abs() + b.abs()) * 0.5;
                    let diagonal = (a + b).length().max((a - b).length());
                    (flat.corner + (a + b) * 0.5, half, 0.5 * diagonal)
                } else {
                    let centre = flat.corner + (a + b) * third.x;
                    let corners = [flat.corner, flat.corner + a, flat.corner + b];
                    let off = corners.map(|c| (c - centre).abs());
                    let each = |f: fn(&V3) -> f32| off.iter().map(f).fold(0.0, f32::max);
                    let half = V3::new(each(|v| v.x), each(|v| v.y), each(|v| v.z));
                    let radius = corners.iter().map(|c| (*c - centre).length()).fold(0.0, f32::max);
                    (centre, half, radius)
                };
                let axis = a.cross(b).normalize();
                let area = 4.0 * flat.area();
                LightBounds { axis, cos: 1.0, ..body(centre, half, radius, area) }
            }
            LightShape::Sphere(s) => body(s.centre, V3::splat(s.radius), s.radius, self.area()),
            LightShape::Cylinder([low, high], half, radius, area) => {
                let reach = (half.length2() + radius * radius).sqrt();
                body((*low + *high) * 0.5, (*high - *low) * 0.5, reach, *area)
            }
            LightShape::Environment => body(V3::default(), V3::splat(1.0), 2.0, self.area()),
        }
    }
}
