//! Whether two primitives share an area: everything in double precision, of coordinates that are
//! single precision's.

use crate::geometry::ray_origin::UNIT_ROUNDOFF;
use crate::geometry::{Cylinder, Geometry, Kind, Sphere};
use crate::math::V3;
use glam::{DVec2, DVec3};

/// Surfaces coincide where they are no farther apart than this multiple of their largest
/// coordinate. Coordinates that were exact before a scene was turned and rounded are moved by two or
/// three; the rest is for files of few digits, and because rays leave surfaces by up to 28: what is
/// nearer than that is seen by some rays and not by others.
pub(super) const APART: f64 = 32.0 * UNIT_ROUNDOFF as f64;
/// What overlaps by less than this multiple of that has an edge in common.
const EDGE: f64 = 4.0;

fn wide(v: V3) -> DVec3 {
    DVec3::new(v.x.into(), v.y.into(), v.z.into())
}

/// Whether two primitives coincide over an area.
pub(super) fn coincide(geometry: &Geometry, a: u32, b: u32) -> bool {
    match (geometry.kind(a), geometry.kind(b)) {
        (Kind::Triangle(i), Kind::Triangle(j)) => {
            triangles([i, j].map(|i| geometry.corners(i).map(wide)))
        }
        (Kind::Triangle(i), Kind::Cylinder(j)) | (Kind::Cylinder(j), Kind::Triangle(i)) => {
            let corners = geometry.corners(i).map(wide);
            caps(&geometry.cylinders[j]).iter().any(|cap| triangle_and_cap(&corners, cap))
        }
        (Kind::Sphere(i), Kind::Sphere(j)) => spheres(&geometry.spheres[i], &geometry.spheres[j]),
        (Kind::Cylinder(i), Kind::Cylinder(j)) => {
            cylinders(&geometry.cylinders[i], &geometry.cylinders[j])
        }
        // A sphere shares no area with anything else.
        _ => false,
    }
}

fn largest(points: &[DVec3]) -> f64 {
    points.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max)
}

fn normal([a, b, c]: &[DVec3; 3]) -> DVec3 {
    (*b - *a).cross(*c - *a)
}

fn triangles([a, b]: [[DVec3; 3]; 2]) -> bool {
    let (na, nb) = (normal(&a), normal(&b));
    // By the plane of the larger one, which is known better.
    let (n, on, others) =
        if na.length_squared() >= nb.length_squared() { (na, a, b) } else { (nb, b, a) };
    let (unit, alike) = (n.normalize(), na.dot(nb).abs() >= 0.9 * (na.length() * nb.length()));
    let apart = APART * largest(&a).max(largest(&b));
    if !alike || others.iter().any(|p| unit.dot(*p - on[0]).abs() > apart) {
        return false;
    }
    let flat = flattened(unit);
    polygons_overlap(&on.map(flat), &others.map(flat), EDGE * apart)
}

/// Points by their places in a plane.
fn flattened(unit: DVec3) -> impl Fn(DVec3) -> DVec2 + Copy {
    let (u, v) = unit.any_orthonormal_pair();
    move |p| DVec2::new(u.dot(p), v.dot(p))
}

/// Whether two triangles of a plane overlap by more than `margin`: no edge of either has the other
/// on its far side.
fn polygons_overlap(a: &[DVec2; 3], b: &[DVec2; 3], margin: f64) -> bool {
    let apart = |one: &[DVec2; 3], other: &[DVec2; 3]| {
        let turn = (one[1] - one[0]).perp_dot(one[2] - one[0]).signum();
        (0..3).any(|i| {
            let edge = one[(i + 1) % 3] - one[i];
            let inwards = |p: &DVec2| edge.perp_dot(*p - one[i]) * turn;
            other.iter().map(inwards).fold(f64::NEG_INFINITY, f64::max) <= margin * edge.length()
        })
    };
    !apart(a, b) && !apart(b, a)
}

/// A flat end of a cylinder.
struct Cap {
    centre: DVec3,
    axis: DVec3,
    radius: f64,
}

fn caps(cylinder: &Cylinder) -> [Cap; 2] {
    let (base, axis) = (wide(cylinder.base), wide(cylinder.axis()));
    let radius = f64::from(cylinder.radius);
    [0.0, f64::from(cylinder.height)].map(|z| Cap { centre: base + axis * z, axis, radius })
}

impl Cap {
    fn apart(&self) -> f64 {
        APART * (self.centre.abs().max_element() + self.radius)
    }
}

fn triangle_and_cap(corners: &[DVec3; 3], cap: &Cap) -> bool {
    let apart = (APART * largest(corners)).max(cap.apart());
    let unit = normal(corners).normalize();
    // Either one's extent in the other's plane: the smaller one is enough.
    let tilt = unit.cross(cap.axis).length() * cap.radius;
    let in_its_plane = unit.dot(cap.centre - corners[0]).abs() + tilt <= apart;
    let in_caps_plane = corners.iter().all(|p| cap.axis.dot(*p - cap.centre).abs() <= apart);
    if !(in_its_plane || in_caps_plane) || unit.dot(cap.axis).abs() < 0.9 {
        return false;
    }
    let flat = flattened(cap.axis);
    let middle = flat(cap.centre);
    let [a, b, c] = corners.map(|p| flat(p) - middle);
    let turn = (b - a).perp_dot(c - a).signum();
    let inside = [(a, b), (b, c), (c, a)].iter().all(|(p, q)| (*q - *p).perp_dot(-*p) * turn > 0.0);
    let nearest = |p: DVec2, q: DVec2| {
        let along = ((-p).dot(q - p) / (q - p).length_squared()).clamp(0.0, 1.0);
        (p + (q - p) * along).length()
    };
    let distance = nearest(a, b).min(nearest(b, c)).min(nearest(c, a));
    inside || distance < cap.radius - EDGE * apart
}

fn spheres(a: &Sphere, b: &Sphere) -> bool {
    let reach = |s: &Sphere| wide(s.centre).abs().max_element() + f64::from(s.radius);
    let off = (wide(a.centre) - wide(b.centre)).length()
        + (f64::from(a.radius) - f64::from(b.radius)).abs();
    off <= APART * reach(a).max(reach(b))
}

fn cylinders(a: &Cylinder, b: &Cylinder) -> bool {
    let share_a_cap = caps(a).iter().any(|p| {
        caps(b).iter().any(|q| {
            let apart = p.apart().max(q.apart());
            let away = q.centre - p.centre;
            let height = p.axis.dot(away);
            let tilt = p.axis.cross(q.axis).length() * p.radius.min(q.radius);
            let aside = (away - p.axis * height).length();
            height.abs() + tilt <= apart && aside < p.radius + q.radius - EDGE * apart
        })
    });
    share_a_cap || share_a_side(a, b)
}

fn share_a_side(a: &Cylinder, b: &Cylinder) -> bool {
    let [p, q] = [a, b].map(caps);
    let apart = p.iter().chain(&q).map(Cap::apart).fold(0.0, f64::max);
    let height = f64::from(a.height);
    let ends = [0, 1].map(|i| {
        let away = q[i].centre - p[0].centre;
        let along = p[0].axis.dot(away);
        (along, (away - p[0].axis * along).length())
    });
    let same_axis = ends.iter().all(|(_, aside)| *aside <= apart);
    let same_radius = (p[0].radius - q[0].radius).abs() <= apart;
    let (low, high) = (ends[0].0.min(ends[1].0).max(0.0), ends[0].0.max(ends[1].0).min(height));
    same_axis && same_radius && high - low > EDGE * apart
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::numbers::Numbers;
    use glam::{DAffine3, DQuat};

    fn turned(numbers: &mut Numbers) -> DAffine3 {
        let axis = numbers.point().normalize();
        DAffine3::from_rotation_translation(
            DQuat::from_axis_angle(axis, numbers.next() * 6.0),
            numbers.point() * 0.3,
        )
    }

    fn rounded(p: DVec3) -> DVec3 {
        p.as_vec3().as_dvec3()
    }

    /// Triangles of one plane that overlap coincide, however they are turned and rounded; those that
    /// share an edge, lie beside each other or a hair's breadth above do not.
    #[test]
    fn triangles_coincide_where_they_overlap_in_one_plane() {
        let mut numbers = Numbers(5);
        for _ in 0..2000 {
            let place = turned(&mut numbers);
            let flat =
                |x: f64, y: f64, z: f64| rounded(place.transform_point3(DVec3::new(x, y, z) * 0.5));
            let x = numbers.next() * 0.5;
            let lower = [flat(0.0, 0.0, 0.0), flat(1.0, 0.0, 0.0), flat(0.0, 1.0, 0.0)];
            let over = [flat(x, 0.1, 0.0), flat(x + 0.9, 0.3, 0.0), flat(x, 0.6, 0.0)];
            assert!(triangles([lower, over]) && triangles([over, lower]));
            let beside = [lower[1], lower[2], flat(1.0, 1.0, 0.0)];
            assert!(!triangles([lower, beside]) && !triangles([beside, lower]));
            let away = [flat(1.1, 0.0, 0.0), flat(2.0, 0.0, 0.0), flat(1.1, 1.0, 0.0)];
            assert!(!triangles([lower, away]));
            let above = [flat(x, 0.1, 1e-5), flat(x + 0.9, 0.3, 1e-5), flat(x, 0.6, 1e-5)];
            assert!(!triangles([lower, above]));
            let across = [flat(x, 0.1, 0.0), flat(x, 0.3, 0.0), flat(x, 0.2, 0.5)];
            assert!(!triangles([lower, across]));
        }
    }

    #[test]
    fn a_disk_coincides_with_what_it_stands_on() {
        let mut numbers = Numbers(6);
        for _ in 0..2000 {
            let place = turned(&mut numbers);
            let corner = |x: f64, y: f64| rounded(place.transform_point3(DVec3::new(x, y, 0.0)));
            let floor = [corner(-0.6, -0.6), corner(0.6, -0.6), corner(0.0, 0.7)];
            let single = |v: DVec3| V3::from(v.as_vec3().to_array());
            let stand = |x: f64, z: f64| {
                let base = place.transform_point3(DVec3::new(x, 0.0, z));
                let axis = place.transform_vector3(DVec3::Z);
                Cylinder::new(single(base), single(axis), 0.2, 0.1)
            };
            let meets = |c: &Cylinder| caps(c).iter().any(|cap| triangle_and_cap(&floor, cap));
            assert!(meets(&stand(0.0, 0.0)) && meets(&stand(0.3, -0.2)));
            assert!(!meets(&stand(0.0, 1e-5)) && !meets(&stand(0.9, 0.0)));
            assert!(cylinders(&stand(0.0, 0.0), &stand(0.15, 0.0)));
            assert!(cylinders(&stand(0.0, 0.0), &stand(0.0, 0.1)));
            assert!(cylinders(&stand(0.0, 0.0), &stand(0.05, 0.2)));
            assert!(!cylinders(&stand(0.0, 0.0), &stand(0.25, 0.0)));
            assert!(!cylinders(&stand(0.0, 0.0), &stand(0.05, 0.1)));
        }
    }

    #[test]
    fn spheres_coincide_as_a_whole_or_not() {
        let at = |x: f32, radius: f32| Sphere { centre: V3::new(x, 0.2, 0.3), radius };
        assert!(spheres(&at(0.1, 0.4), &at(0.1, 0.400_000_03)));
        assert!(!spheres(&at(0.1, 0.4), &at(0.1, 0.400_01)));
        assert!(!spheres(&at(0.1, 0.4), &at(0.100_01, 0.4)));
    }
}
