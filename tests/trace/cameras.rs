//! Where a picture is taken from, at its extremes.

use crate::support::Random;
use burnish::progressive::{Params, render};
use burnish::scene::{Camera, CameraRays, Material, Mesh, SceneBuilder};
use glam::{DAffine3, DQuat, DVec3};
use std::sync::Arc;

/// Tangent of half of so many degrees.
fn half_tangent(degrees: f64) -> f64 {
    (degrees / 2.0).to_radians().tan()
}

/// The narrowest and the widest angle of view that a person would type.
const ANGLES: [f64; 5] = [1e-3, 0.1, 45.0, 150.0, 179.0];

fn glowing_ball() -> SceneBuilder {
    let mut b = SceneBuilder::new("glowing ball");
    let wall = Material::reflecting("wall", [0.5; 3], [0.0; 3], 10.0).unwrap();
    let wall = b.material(wall.emitting([1.0; 3]).unwrap());
    b.sphere(DVec3::ZERO, 1.0, wall).unwrap();
    b.screen = [16, 12];
    b
}

#[test]
fn rays_have_the_direction_of_their_pixel_at_every_angle() {
    let placement = glowing_ball().build().placement();
    let mut r = Random::new(1);
    for degrees in ANGLES {
        for size in [[640, 480], [1, 1], [1, 2000], [32_768, 3]] {
            let turn = DQuat::from_rotation_z(r.within(0.0, 6.0))
                * DQuat::from_rotation_x(r.within(0.0, 3.0));
            let camera = Camera::new(DVec3::ZERO, half_tangent(degrees), turn).unwrap();
            let rays = CameraRays::new(&camera, placement, size);
            let [x, y, z] = camera.axes();
            for _ in 0..1000 {
                let place = size.map(|s| r.within(0.0, s as f64) as f32);
                let [sx, sy] = [0, 1].map(|k| 2.0 * place[k] as f64 / size[k] as f64 - 1.0);
                let ry = camera.ry;
                let rx = ry * size[0] as f64 / size[1] as f64;
                let expected = (x * (sx * rx) - y * (sy * ry) - z).normalize();
                let d = rays.ray(place[0], place[1]).d;
                let off = DVec3::new(d.x as f64, d.y as f64, d.z as f64) - expected;
                // Of a wide picture the last digit of a place is worth that many times more.
                let allowed = 4e-7 * rx.max(ry).max(1.0);
                assert!(off.length() < allowed, "{degrees} {size:?} {place:?}: {}", off.length());
            }
        }
    }
    assert!(Camera::new(DVec3::ZERO, half_tangent(180.0), DQuat::IDENTITY).is_err());
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-7] {
        assert!(Camera::new(DVec3::ZERO, bad, DQuat::IDENTITY).is_err(), "{bad}");
    }
    assert!(Camera::new(DVec3::new(0.0, f64::NAN, 0.0), 1.0, DQuat::IDENTITY).is_err());
}

/// In a glowing ball every direction carries 1 / (1 - 0.5) = 2, wherever in it one is and however
/// wide one looks; on the wall itself a ray starts on the one side or the other.
#[test]
fn every_angle_and_place_in_a_furnace_sees_the_same() {
    for degrees in ANGLES {
        for eye in [DVec3::ZERO, DVec3::new(0.6, -0.3, 0.2), DVec3::new(0.0, 0.0, 0.999_999)] {
            let mut b = glowing_ball();
            b.camera = Some(
                Camera::look_at(eye, DVec3::new(0.1, 0.9, 0.0), half_tangent(degrees)).unwrap(),
            );
            let s = render(Params::new(Arc::new(b.build())), 64, 0).unwrap();
            let pixels = s.mean().pixels;
            let mean = pixels.iter().map(|p| p[0] as f64).sum::<f64>() / pixels.len() as f64;
            // 12,288 paths of a deviation below 1.
            assert!((mean - 2.0).abs() < 0.04, "{degrees} degrees at {eye}: {mean}");
            assert_eq!(s.counts.nonfinite, 0);
        }
        let mut b = glowing_ball();
        b.camera = Some(Camera::look_at(DVec3::X, DVec3::ZERO, half_tangent(degrees)).unwrap());
        let params = Params { max_depth: Some(1), ..Params::new(Arc::new(b.build())) };
        let s = render(params, 4, 0).unwrap();
        assert_eq!(s.counts.nonfinite, 0);
        assert!(s.mean().pixels.iter().all(|p| (0.0..3.0).contains(&p[0])), "{degrees}");
    }
}

/// An eye inside something solid, in the light that shines on it from outside, is in the dark.
#[test]
fn inside_a_solid_it_is_dark() {
    for shape in 0..3 {
        let mut b = SceneBuilder::new("solid");
        let clay = b.material(Material::reflecting("clay", [0.9; 3], [0.1; 3], 20.0).unwrap());
        match shape {
            0 => b.sphere(DVec3::ZERO, 1.0, clay).unwrap(),
            1 => b.cuboid(DVec3::splat(-1.0), DVec3::splat(2.0), clay).unwrap(),
            _ => b.cylinder(-DVec3::Z, DVec3::Z * 2.0, 1.0, clay).unwrap(),
        }
        b.environment = [1e6; 3];
        b.screen = [32, 32];
        for eye in [DVec3::ZERO, DVec3::new(0.0, 0.0, 0.999), DVec3::new(0.5, 0.5, -0.5)] {
            b.camera = Some(Camera::look_at(eye, DVec3::new(0.3, 1.0, 0.2), 2.0).unwrap());
            let params = Params { max_depth: Some(10), ..Params::new(Arc::new(b.clone().build())) };
            let picture = render(params, 8, 0).unwrap().mean();
            assert!(picture.pixels.iter().all(|p| *p == [0.0; 3]), "shape {shape} from {eye}");
        }
    }
}

/// Nothing at all, one triangle, and triangles that are all the same point.
#[test]
fn hardly_a_scene_is_still_a_picture() {
    let nothing = SceneBuilder::new("nothing");
    let mut triangle = SceneBuilder::new("triangle");
    let clay = Material::reflecting("clay", [0.5; 3], [0.0; 3], 10.0).unwrap();
    let clay_id = triangle.material(clay.clone());
    let mesh = Mesh {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    };
    triangle.mesh(&mesh, DAffine3::IDENTITY, clay_id).unwrap();
    let mut point = SceneBuilder::new("point");
    let clay_id = point.material(clay);
    let flat = DAffine3::from_scale(DVec3::splat(1e-200));
    assert_eq!(point.mesh(&mesh, flat, clay_id).unwrap().kept, 0);
    for (mut b, seen) in [(nothing, false), (triangle, true), (point, false)] {
        b.environment = [0.25, 0.5, 1.0];
        b.screen = [9, 9];
        let target = DVec3::new(0.33, 0.33, 0.0);
        b.camera = Some(Camera::look_at(target + DVec3::Z * 2.0, target, 1.0).unwrap());
        let name = b.name.clone();
        let s = render(Params::new(Arc::new(b.build())), 4, 0).unwrap();
        assert_eq!(s.counts.nonfinite, 0);
        let picture = s.mean();
        assert_eq!(picture.pixels[0], [0.25, 0.5, 1.0], "{name}: the background");
        // Half of what the sky sends, from both sides alike.
        let expected = if seen { 0.5 } else { 1.0 };
        let middle = picture.pixels[4 * 9 + 4][2];
        assert!((middle - expected).abs() < 1e-5, "{name}: {middle}");
    }
}

#[test]
fn the_largest_sides_are_rendered() {
    for size in [[Params::MAX_SIDE, 1], [1, Params::MAX_SIDE]] {
        let params = Params { size, ..Params::new(Arc::new(glowing_ball().build())) };
        let s = render(params, 1, 0).unwrap();
        assert_eq!(s.counts.paths, u64::from(Params::MAX_SIDE));
        assert!(s.mean().pixels.iter().all(|p| p[0].is_finite()));
    }
}
