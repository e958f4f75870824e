//! A scene being put together: shapes by their places in a room of about unit size, put where the
//! room is.

use super::super::draw::Draw;
use super::super::site::{Site, Somewhere};
use super::RandomError;
use super::room::Wall;
use crate::brdf::Roughness;
use crate::scene::{Material, MaterialId, Mesh};
use glam::{DQuat, DVec3};
use std::collections::HashMap;
use std::fmt::Write;

pub(super) struct RandomStage {
    pub(super) site: Site,
    pub(super) place: Somewhere,
    pub(super) draw: Draw,
    /// Spheres around what stands here already.
    taken: Vec<(DVec3, f64)>,
    /// Places where rounding decides: middles of rectangles, where their own plane is widest; edges;
    /// where things touch.
    pub(super) spots: Vec<DVec3>,
    /// One line a thing.
    pub(super) told: String,
    /// What all emission is multiplied by.
    pub(super) brightness: f64,
}

impl RandomStage {
    pub(super) fn new(mut draw: Draw, name: String) -> RandomStage {
        let place = Somewhere::draw(&mut draw);
        let brightness = draw.decades(1e-3, 1e3);
        let site = Site::new(name, place);
        let (taken, spots, told) = (Vec::new(), Vec::new(), String::new());
        RandomStage { site, place, draw, taken, spots, told, brightness }
    }

    /// Adds a line to the description.
    pub(super) fn tell(&mut self, what: std::fmt::Arguments) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.told, "  {what}");
    }

    /// A surface of any kind that keeps at least a fifth of the light: diffuse, a lobe of a
    /// roughness of at least `smoothest`, or both.
    pub(super) fn surface(&mut self, smoothest: f64) -> Result<Material, RandomError> {
        let draw = &mut self.draw;
        let (diffuse, lobe) = draw.one(&[(true, false), (false, true), (true, true), (true, true)]);
        let share = draw.within(0.2, 0.8);
        let alpha = draw.decades(smoothest, 1.0);
        let mut colour = |most: f64| {
            let level = draw.within(0.3, 1.0) * most;
            [0; 3].map(|_| level * draw.within(0.6, 1.0))
        };
        // Schlick's rim adds a twentieth.
        let (kd, ks) = match (diffuse, lobe) {
            (true, false) => (colour(0.78), [0.0; 3]),
            (false, _) => ([0.0; 3], colour(0.74)),
            _ => (colour(0.72 * share), colour(0.72 * (1.0 - share))),
        };
        let surface = Material::reflecting("surface", kd, ks, 0.0)?;
        Ok(Material { roughness: Roughness::from_alpha(alpha.clamp(1e-4, 1.0))?, ..surface })
    }

    /// The emission of an emitter.
    pub(super) fn radiance(&mut self, low: f64, high: f64) -> [f64; 3] {
        let level = self.draw.decades(low, high) * self.brightness;
        [0; 3].map(|_| level * self.draw.within(0.5, 1.0))
    }

    pub(super) fn add(&mut self, material: Material) -> MaterialId {
        let Material { kd, ks, roughness, emission, .. } = &material;
        let words = format!(
            "material {}: Kd {kd:.3?} Ks {ks:.3?} alpha {:.4e} emission {emission:.4?}",
            self.site.builder.materials().len(),
            roughness.alpha(),
        );
        self.tell(format_args!("{words}"));
        self.site.material(material)
    }

    /// Whether a sphere here keeps clear of all that is taken.
    pub(super) fn is_free(&self, centre: DVec3, radius: f64) -> bool {
        self.taken.iter().all(|(c, r)| c.distance(centre) > r + radius)
    }

    /// Takes a sphere for something.
    pub(super) fn take(&mut self, centre: DVec3, radius: f64) {
        self.taken.push((centre, radius));
    }

    pub(super) fn triangle(
        &mut self,
        corners: [DVec3; 3],
        material: MaterialId,
    ) -> Result<(), RandomError> {
        self.tell(format_args!("triangle {} of material {material}", spelled(&corners)));
        let (positions, triangles) = (corners.to_vec(), vec![[0, 1, 2]]);
        let mesh = Mesh { positions, triangles, ..Mesh::default() };
        Ok(self.site.mesh(mesh, material)?)
    }

    /// The rectangle around `centre` with these half-edges, which begins at any corner.
    pub(super) fn rectangle(
        &mut self,
        centre: DVec3,
        [u, v]: [DVec3; 2],
        material: MaterialId,
    ) -> Result<(), RandomError> {
        let what = spelled(&[centre, u, v]);
        self.tell(format_args!("rectangle {what} of material {material}"));
        self.quad([centre - u - v, centre + u - v, centre + u + v, centre - u + v], material)
    }

    fn quad(&mut self, mut corners: [DVec3; 4], material: MaterialId) -> Result<(), RandomError> {
        let [a, b, c, _] = corners;
        self.spots.extend([a.midpoint(c), a.midpoint(b), a, a.midpoint(c)]);
        corners.rotate_left(self.draw.below(4));
        if self.draw.chance(0.5) {
            corners.reverse();
        }
        Ok(self.site.quad(corners, material)?)
    }

    /// A wall, whole or around a hole in its plane.
    pub(super) fn wall(&mut self, wall: &Wall, material: MaterialId) -> Result<(), RandomError> {
        self.tell(format_args!(
            "wall {} of material {material}",
            spelled(&[wall.centre, wall.edges[0], wall.edges[1]])
        ));
        let Some([[a0, a1], [b0, b1]]) = wall.hole else {
            return self.quad(wall.corners([-1.0, 1.0], [-1.0, 1.0]), material);
        };
        let all = [-1.0, 1.0];
        for (a, b) in
            [([-1.0, a0], all), ([a1, 1.0], all), ([a0, a1], [-1.0, b0]), ([a0, a1], [b1, 1.0])]
        {
            self.quad(wall.corners(a, b), material)?;
        }
        Ok(())
    }

    /// What fills the hole of a wall.
    pub(super) fn filling(&mut self, wall: &Wall, material: MaterialId) -> Result<(), RandomError> {
        let Some([a, b]) = wall.hole else { return Ok(()) };
        let corners = wall.corners(a, b);
        self.tell(format_args!("rectangle {} of material {material}", spelled(&corners)));
        self.quad(corners, material)
    }

    /// A box of these half-edges, turned: flat faces, one light if it emits.
    pub(super) fn block(
        &mut self,
        centre: DVec3,
        half: DVec3,
        turn: DQuat,
        material: MaterialId,
    ) -> Result<(), RandomError> {
        let what = spelled(&[centre, half]);
        self.tell(format_args!("box {what} turned by {turn:.6} of material {material}"));
        Ok(self.site.block(centre, half, turn, material)?)
    }

    pub(super) fn ball(
        &mut self,
        centre: DVec3,
        radius: f64,
        material: MaterialId,
    ) -> Result<(), RandomError> {
        let what = spelled(&[centre]);
        self.tell(format_args!("sphere {what} {radius:.17} of material {material}"));
        Ok(self.site.sphere(centre, radius, material)?)
    }

    pub(super) fn rod(
        &mut self,
        base: DVec3,
        axis: DVec3,
        radius: f64,
        material: MaterialId,
    ) -> Result<(), RandomError> {
        let what = spelled(&[base, axis]);
        self.tell(format_args!("cylinder {what} {radius:.17} of material {material}"));
        Ok(self.site.cylinder(base, axis, radius, material)?)
    }

    /// A ball of a few dozen triangles, flat or smooth, of uneven axes.
    pub(super) fn blob(
        &mut self,
        centre: DVec3,
        radius: f64,
        material: MaterialId,
    ) -> Result<(), RandomError> {
        let levels = self.draw.one(&[0, 1, 2]);
        let smooth = levels > 0 && self.draw.chance(0.5);
        let (turn, axes) = (self.draw.rotation(), [0; 3].map(|_| self.draw.within(0.5, 1.0)));
        self.tell(format_args!(
            "mesh {} {radius:.17}, {levels} levels, smooth: {smooth}, of material {material}",
            spelled(&[centre])
        ));
        let mut mesh = octahedron(levels);
        for p in &mut mesh.positions {
            *p = centre + turn * (*p * DVec3::from_array(axes)) * radius;
        }
        if smooth {
            // Of the ellipsoid that it stands for.
            let axes = DVec3::from_array(axes);
            let normal = |p: &DVec3| turn * (*p / axes);
            mesh.normals = octahedron(levels).positions.iter().map(normal).collect();
        } else {
            let corners = mesh.triangles.iter().flatten();
            mesh.positions = corners.map(|&i| mesh.positions[i as usize]).collect();
            mesh.triangles = (0..mesh.positions.len() as u32 / 3)
                .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
                .collect();
        }
        Ok(self.site.mesh(mesh, material)?)
    }
}

fn spelled(points: &[DVec3]) -> String {
    let words: Vec<String> =
        points.iter().map(|p| format!("({}, {}, {})", p.x, p.y, p.z)).collect();
    words.join(" ")
}

/// An octahedron of unit radius, each face split into four `levels` times.
fn octahedron(levels: u32) -> Mesh {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let mut positions: Vec<DVec3> = axes.iter().flat_map(|&a| [a, -a]).collect();
    let mut triangles = Vec::new();
    for (x, y, z) in (0..8).map(|i| (i & 1, i >> 1 & 1, i >> 2)) {
        // Counter-clockwise from outside, whichever axes are turned over.
        let (y, z) = if (x + y + z) % 2 == 0 { (2 + y, 4 + z) } else { (4 + z, 2 + y) };
        triangles.push([x, y, z]);
    }
    for _ in 0..levels {
        let mut middles = HashMap::new();
        let mut finer = Vec::new();
        for [a, b, c] in triangles {
            let mut middle = |i: u32, j: u32| {
                *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                    positions.push((positions[i as usize] + positions[j as usize]).normalize());
                    positions.len() as u32 - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        triangles = finer;
    }
    Mesh { positions, triangles, ..Mesh::default() }
}
