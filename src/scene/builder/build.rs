//! The scene made of what a builder has collected: the room for it, doubles left out, all moved and scaled to
//! about unit size, and the tree built.

use super::SceneBuilder;
use crate::geometry::{Bvh, Cylinder, Face, Geometry, PrimitiveRange, Sphere, Vertex};
use crate::limits::{TooLarge, fits};
use crate::math::V3;
use crate::math::simd::Isa;
use crate::scene::doubles::{Doubles, FirstPlaces, Lost, Origin};
use crate::scene::mesh::Mesh;
use crate::scene::read::text::shown;
use crate::scene::{Camera, Light, MaterialId, Placement, Scene, SceneCounts};
use glam::DVec3;

// Bytes that shapes take at most, measured on meshes of a million triangles: until the scene is
// built, and while it is.
const PLACED_TRIANGLE: u64 = 40;
const PLACED_VERTEX: u64 = 72;
const BUILT_TRIANGLE: u64 = 260;
const BUILT_VERTEX: u64 = 36;
const BUILT_ANALYTIC: u64 = 640;

/// Remarks about the shapes of a scene as a whole.
#[derive(Clone, Debug, Default)]
pub(in crate::scene) struct Remarks {
    /// Each with its line.
    pub(in crate::scene) warnings: Vec<(Option<usize>, String)>,
    pub(in crate::scene) notes: Vec<String>,
}

impl SceneBuilder {
    /// Whether there is memory for a scene of what is there and `times` as many copies of a mesh.
    pub(in crate::scene) fn has_room(&self, times: u64, mesh: &Mesh) -> Result<(), TooLarge> {
        let new = |n: usize, each: u64| times.saturating_mul(n as u64).saturating_mul(each);
        let held = PLACED_TRIANGLE + BUILT_TRIANGLE;
        let need = new(mesh.triangles.len(), held)
            .saturating_add(new(mesh.positions.len(), PLACED_VERTEX + BUILT_VERTEX))
            .saturating_add(self.build_bytes());
        fits(need, || "the scene".to_owned())
    }

    /// Bytes that [`SceneBuilder::build`] takes beside what is held already.
    fn build_bytes(&self) -> u64 {
        let analytic = self.spheres.len() + self.cylinders.len();
        self.triangles.len() as u64 * BUILT_TRIANGLE
            + self.positions.len() as u64 * BUILT_VERTEX
            + analytic as u64 * BUILT_ANALYTIC
    }

    /// [`SceneBuilder::build`] if there is the memory for it: refused before it is begun, with what
    /// it would need.
    pub fn try_build(self) -> Result<Scene, TooLarge> {
        let shapes = self.shapes();
        fits(self.build_bytes(), || format!("{}: a scene of {shapes} shapes", self.name))?;
        Ok(self.build())
    }

    /// Leaves out what coincides with a surface in front of it. Returns what there is to tell about
    /// that, and about how meshes came by their normals; the readers put it into their report.
    pub(in crate::scene) fn settle(&mut self) -> Remarks {
        let mut remarks = Remarks::default();
        if !self.settled {
            let doubles = self.drop_doubles();
            self.duplicates += doubles.count;
            let named = |material: MaterialId| {
                let material = &self.materials[material as usize];
                (shown(&material.name), material.emits())
            };
            let warning = |lost: &Lost| (lost.first.line, lost.sentence(named));
            remarks.warnings = doubles.lost().iter().map(warning).collect();
            self.settled = true;
        }
        remarks.notes.extend(self.normal_counts.note());
        remarks
    }

    /// Recentres and rescales all shapes to about unit size, turns them into f32 and builds the
    /// tree over them.
    pub fn build(mut self) -> Scene {
        self.settle();
        let (low, high) = self.bounds();
        let placement = Placement::fitting(low, high);
        let local = |p: DVec3| V3::from(placement.to_local(p).as_vec3().to_array());
        let scaled = |x: f64| (x * placement.scale()) as f32;

        let mut material_of = vec![0; self.triangles.len()];
        for (range, origin) in &self.groups {
            material_of[range.clone()].fill(origin.material);
        }
        let vertex = |(p, normal)| Vertex { position: local(p).into(), normal };
        let face = |(vertices, material)| Face { vertices, material };
        let sphere = |&(c, r, _): &_| Sphere { centre: local(c), radius: scaled(r) };
        let cylinder = |&(base, axis, r, _): &(DVec3, DVec3, _, _)| {
            let height = axis.length();
            let axis = V3::from((axis / height).as_vec3().to_array());
            Cylinder::new(local(base), axis, scaled(height), scaled(r))
        };
        let materials = self.spheres.iter().map(|s| s.2.material);
        let mut geometry = Geometry::new(
            self.positions.into_iter().zip(self.normals).map(vertex),
            self.triangles.into_iter().zip(material_of).map(face),
            (
                self.spheres.iter().map(sphere).collect(),
                self.cylinders.iter().map(cylinder).collect(),
            ),
            materials.chain(self.cylinders.iter().map(|c| c.3.material)).collect(),
        );
        let mut lights = Vec::new();
        for (range, Origin { material, .. }) in self.groups {
            if !range.is_empty() {
                lights.push(Light { shape: PrimitiveRange::triangles(range), material });
            }
        }
        let first_sphere = geometry.faces().len();
        for i in first_sphere..geometry.len() {
            lights.push(Light {
                shape: PrimitiveRange { first: i as u32, count: 1 },
                material: geometry.material(i as u32),
            });
        }
        let counts = SceneCounts {
            triangles: geometry.faces().len(),
            spheres: geometry.spheres.len(),
            cylinders: geometry.cylinders.len(),
            duplicates: self.duplicates,
        };
        let mut bvh = Bvh::build(&geometry);
        bvh.settle_coincident(&mut geometry, &|m| self.materials[m as usize].emits());
        let aspect = self.screen[0] as f64 / self.screen[1].max(1) as f64;
        Scene {
            name: self.name,
            caption: self.caption,
            source: self.source,
            screen: self.screen,
            camera: self.camera.unwrap_or_else(|| Camera::framing(low, high, aspect)),
            environment: self.environment,
            materials: self.materials,
            bvh,
            isa: Isa::detect(),
            geometry,
            surfaces: lights,
            placement,
            bounds: [low, high],
            focus: self.focus,
            counts,
        }
    }

    /// Lowest and highest corner so far, in world units.
    pub(in crate::scene) fn bounds(&self) -> (DVec3, DVec3) {
        let mut low = DVec3::INFINITY;
        let mut high = DVec3::NEG_INFINITY;
        let mut grow = |a: DVec3, b: DVec3| {
            low = low.min(a);
            high = high.max(b);
        };
        for &i in self.triangles.iter().flatten() {
            let p = self.positions[i as usize];
            grow(p, p);
        }
        for &(c, r, _) in &self.spheres {
            grow(c - r, c + r);
        }
        for &(base, axis, r, _) in &self.cylinders {
            // Half-extent of a disc of this radius, perpendicular to the axis.
            let unit = axis.normalize();
            let e = (DVec3::ONE - unit * unit).max(DVec3::ZERO).map(f64::sqrt) * r;
            grow(base.min(base + axis) - e, base.max(base + axis) + e);
        }
        if low.x <= high.x { (low, high) } else { (DVec3::NEG_ONE, DVec3::ONE) }
    }

    /// Removes shapes in the place of others.
    fn drop_doubles(&mut self) -> Doubles {
        let mut doubles = Doubles::default();
        let (low, high) = self.bounds();
        let places = FirstPlaces(Placement::fitting(low, high));
        let emits = |material: MaterialId| self.materials[material as usize].emits();
        let (positions, triangles, groups) = (&self.positions, &self.triangles, &self.groups);
        let (spheres, cylinders) = (&self.spheres, &self.cylinders);
        // The groups follow one another.
        let group_of = |i: usize| groups[groups.partition_point(|(range, _)| range.end <= i)].1;
        let corners = |i: usize| triangles[i].map(|i| positions[i as usize]);
        let key = |i: usize| places.triangle(corners(i));
        let drop = doubles.find(0, triangles.len(), key, group_of, emits);
        let key = |i: usize| places.sphere(spheres[i].0, spheres[i].1);
        let drop_spheres = doubles.find(1, spheres.len(), key, |i| spheres[i].2, emits);
        let key = |i: usize| places.cylinder(cylinders[i].0, cylinders[i].1, cylinders[i].2);
        let drop_cylinders = doubles.find(2, cylinders.len(), key, |i| cylinders[i].3, emits);
        if doubles.count > 0 {
            let mut kept_before = 0;
            for (range, _) in &mut self.groups {
                let kept = range.clone().filter(|&i| !drop[i]).count();
                *range = kept_before..kept_before + kept;
                kept_before += kept;
            }
            retain(&mut self.triangles, &drop);
            retain(&mut self.spheres, &drop_spheres);
            retain(&mut self.cylinders, &drop_cylinders);
        }
        doubles
    }
}

/// Keeps those that are not to be dropped.
fn retain<T>(list: &mut Vec<T>, drop: &[bool]) {
    let mut flags = drop.iter();
    list.retain(|_| !flags.next().copied().unwrap_or(false));
}
