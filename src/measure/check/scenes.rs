//! Proofs through the tracer itself: pictures whose every pixel has the same known value.
//!
//! The cameras look through a window so small that all pixels see one point, and every path is for
//! itself, so that each pixel is an independent estimate of the same number.

use super::quadrature::{QuadratureGrid, albedo};
use super::reference::ReferenceBrdf;
use super::statistics::Mean;
use super::{CheckError, Proof, ProofWork};
use crate::progressive::{Params, Strategy, render};
use crate::scene::{Camera, Material, MaterialId, Mesh, Scene, SceneBuilder, ShapeError};
use crate::trace::ReuseGroup;
use glam::{DAffine3, DVec3};
use std::sync::Arc;

/// Below this alpha, light sampling lights no longer finds a lobe: the spread of so few hits tells nothing.
const SHARP: f64 = 0.05;

/// Size of the plate's scenes: as large as a house, for a tolerance without regard to size is lost on
/// small ones.
const SIZE: f64 = 16.0;

/// All of them.
pub(super) fn prove(work: &mut ProofWork) -> Result<(), CheckError> {
    furnace(work)?;
    slab(work)?;
    strategies(work)
}

/// Walls that emit 1 and reflect one half: 2 in every direction. A tenth of a millimetre wide, for
/// size must not matter.
fn furnace(work: &mut ProofWork) -> Result<(), CheckError> {
    let radius = 1e-4;
    let mut b = SceneBuilder::new("white furnace");
    let wall = Material::reflecting("wall", [0.5; 3], [0.0; 3], 10.0)?.emitting([1.0; 3])?;
    let wall = b.material(wall);
    b.sphere(DVec3::ZERO, radius, wall)?;
    let eye = DVec3::new(0.1, 0.2, -0.3) * radius;
    b.camera = Some(Camera::look_at(eye, eye + DVec3::X, 1.0)?);
    let pixels = work.pixels(b.build().into(), Strategy::Mis)?;
    let says = "in a closed room that emits 1 and reflects 1/2 there is 2";
    work.add(Proof::at_most("white furnace", says, (pixels.mean / 2.0 - 1.0).abs(), 5e-3));
    work.add(Proof::by_chance("white furnace, Student", says, pixels.chance(2.0, 2e-5)));
    Ok(())
}

/// A plate before white light shows its directional albedo.
fn slab(work: &mut ProofWork) -> Result<(), CheckError> {
    let lobe = ReferenceBrdf::of_width(work.subject.model, work.roughness);
    let (mut off, mut chance) = (0.0f64, 1.0f64);
    for cos in [0.9, 0.5, 0.2] {
        let mut b = SceneBuilder::new("plate in white light");
        let surface = b.material(Material::reflecting("plate", [0.2; 3], [0.5; 3], 0.0)?);
        look_at_plate(&mut b, surface, cos)?;
        b.environment = [1.0; 3];
        let pixels = work.pixels(b.build().into(), Strategy::Mis)?;
        let expected = albedo(&lobe, cos, QuadratureGrid::FINE).of(0.2f32.into(), 0.5);
        off = off.max((pixels.mean / expected - 1.0).abs());
        // Rotating directions into the surface's frame costs a sharp lobe some digits.
        chance = chance.min(pixels.chance(expected, 2e-4 * expected));
    }
    let says = "a plate in white light shows its albedo, by quadrature";
    work.add(Proof::at_most("plate in white light", says, off, 5e-3));
    work.add(Proof::by_chance("plate, Student", says, chance));
    Ok(())
}

/// Three emitters above a plate, one of them in its mirror: light found by light sampling, by chance, and by
/// both ways weighed.
fn strategies(work: &mut ProofWork) -> Result<(), CheckError> {
    let mut b = SceneBuilder::new("three lamps");
    let surface = b.material(Material::reflecting("plate", [0.4; 3], [0.5; 3], 0.0)?);
    let emitter = b.material(Material::light("lamp", [2.0; 3])?);
    let cos: f64 = 0.6;
    let across = (1.0 - cos * cos).sqrt();
    let [x, y, z] = look_at_plate(&mut b, surface, cos)?;
    for (to, distance, radius) in [
        (x * 0.9 + y * 0.5 + z, 2.5, 0.7),
        (x * -across + z * cos, 2.0, 0.6),
        (x * -0.3 - y * 1.2 + z, 3.0, 0.9),
    ] {
        b.sphere(to.normalize() * distance * SIZE, radius * SIZE, emitter)?;
    }
    let scene: Arc<Scene> = b.build().into();
    let both = work.pixels(scene.clone(), Strategy::Mis)?;
    let mut others = vec![Strategy::BsdfOnly];
    if work.subject.roughness.alpha() >= SHARP {
        others.push(Strategy::LightOnly);
    }
    let (mut off, mut chance) = (0.0f64, 1.0f64);
    for strategy in others {
        let pixels = work.pixels(scene.clone(), strategy)?;
        off = off.max((pixels.mean / both.mean - 1.0).abs());
        chance = chance.min(both.chance_with(&pixels, 1e-4 * both.mean));
    }
    let says = "lamps met by chance, asked, and both ways weighed: one mean";
    work.add(Proof::at_most("light met and asked", says, off, 0.02));
    work.add(Proof::by_chance("light met and asked, Welch", says, chance));
    Ok(())
}

/// A plate through the origin, tilted so that no axis is the world's, and a camera that sees the
/// origin at this cosine. Returns the plate's axes; the camera is on the side of the first.
fn look_at_plate(
    b: &mut SceneBuilder,
    material: MaterialId,
    cos: f64,
) -> Result<[DVec3; 3], CheckError> {
    let z = DVec3::new(0.3, -0.2, 0.9).normalize();
    let x = DVec3::new(1.0, 0.4, 0.0).reject_from(z).normalize();
    let y = z.cross(x);
    let corner = |s: f64, t: f64| (x * s + y * t) * 0.5 * SIZE;
    let mesh = Mesh {
        positions: vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    let counts = b.mesh(&mesh, DAffine3::IDENTITY, material)?;
    if counts.kept != 2 {
        return Err(ShapeError::Flat.into());
    }
    let eye = (x * (1.0 - cos * cos).sqrt() + z * cos) * 2.0 * SIZE;
    b.camera = Some(Camera::look_at(eye, DVec3::ZERO, 1e-5)?);
    Ok([x, y, z])
}

impl ProofWork {
    /// The green of all pixels of a picture of this scene, every lobe as rough as the subject's.
    fn pixels(&mut self, scene: Arc<Scene>, strategy: Strategy) -> Result<Mean, CheckError> {
        let subject = self.subject;
        let params = Params {
            model: subject.model,
            size: [16, 16],
            strategy,
            normals: subject.normals,
            erratum: subject.erratum,
            group: Some(ReuseGroup::None),
            ..Params::new(scene)
        };
        let params = params.with_roughness(subject.roughness);
        let passes = if self.full { 1024 } else { 256 };
        let snapshot = render(params, passes, self.threads)?;
        let pixels = snapshot.mean().pixels;
        let strange = pixels.iter().flatten().filter(|c| c.is_nan() || **c < 0.0).count() as u64;
        self.strange += snapshot.counts.nonfinite + strange;
        Ok(Mean::of(pixels.iter().map(|p| f64::from(p[1]))))
    }
}
