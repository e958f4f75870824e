//! Things and emitters: their shapes, and how they lie to what is around them.

use super::RandomError;
use super::room::{Form, Room, Wall};
use super::stage::RandomStage;
use crate::scene::{Material, MaterialId};
use glam::{DQuat, DVec3};

impl RandomStage {
    /// The material of an emitter: black, or one that reflects as well.
    pub(super) fn emitter(&mut self, reflects: bool) -> Result<MaterialId, RandomError> {
        let radiance = self.radiance(1.0, 10.0);
        let material = match reflects {
            true => self.surface(1e-4)?.emitting(radiance)?,
            false => Material::light("lamp", radiance)?,
        };
        Ok(self.add(material))
    }

    /// Something that hangs free in the room; nothing where there is no room for it.
    pub(super) fn hang(&mut self, room: &Room, material: MaterialId) -> Result<(), RandomError> {
        for _ in 0..20 {
            let size = self.draw.decades(0.08, 0.4);
            let Some(centre) = room.somewhere(&mut self.draw, size) else { continue };
            if self.is_free(centre, size) {
                self.take(centre, size);
                return self.solid(centre, size, material);
            }
        }
        Ok(())
    }

    /// Something within this sphere, or a flat shape.
    fn solid(&mut self, centre: DVec3, size: f64, material: MaterialId) -> Result<(), RandomError> {
        let turn = self.draw.rotation();
        let [u, v, n] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| turn * axis);
        let part = self.draw.within(0.25, 0.9);
        let (thick, thin) = (size * part, size * (1.0 - part * part).sqrt());
        match self.draw.below(8) {
            0 | 1 => self.ball(centre, size, material),
            2 => self.rod(centre - n * thick, n * (2.0 * thick), thin, material),
            3 => {
                let base = centre - n * (0.01 * size);
                self.rod(base, n * (0.02 * size), 0.99 * size, material)
            }
            4 => {
                let rest = self.draw.within(0.3, 0.9);
                let half = DVec3::new(thick, thin * rest, thin * (1.0 - rest * rest).sqrt());
                self.block(centre, half, turn, material)
            }
            5 => self.rectangle(centre, [u * thick, v * thin], material),
            6 => {
                let corners = [u * size, (v - u) * (0.7 * thick), (v + u) * (-0.7 * thin)];
                self.triangle(corners.map(|c| centre + c), material)
            }
            _ => self.blob(centre, size, material),
        }
    }

    /// Something that touches a wall: lies on it, stands on it, hangs from it.
    pub(super) fn touch(&mut self, room: &Room, material: MaterialId) -> Result<(), RandomError> {
        for _ in 0..20 {
            let size = self.draw.decades(0.08, 0.35);
            if let Form::Sphere(radius) = room.form {
                let centre = room.centre + self.draw.direction() * (radius - size);
                if self.is_free(centre, size) {
                    self.take(centre, size);
                    self.spots
                        .push(room.centre + (centre - room.centre) * (radius / (radius - size)));
                    return self.ball(centre, size, material);
                }
                continue;
            }
            if room.walls.is_empty() {
                return self.hang(room, material);
            }
            let wall = &room.walls[self.draw.below(room.walls.len())];
            let place = wall.place(&mut self.draw, size);
            // Twice as high as wide, the whole lies in this sphere.
            let (middle, reach) = (place + wall.normal * size, 1.5 * size);
            if self.is_free(middle, reach) {
                self.take(middle, reach);
                return self.touching(wall, place, size, material);
            }
        }
        Ok(())
    }

    fn touching(
        &mut self,
        wall: &Wall,
        place: DVec3,
        size: f64,
        material: MaterialId,
    ) -> Result<(), RandomError> {
        let n = wall.normal;
        let along = wall.along(&mut self.draw);
        let height = self.draw.within(0.3, 1.0) * size;
        self.spots.extend([place, place + along * size]);
        match self.draw.below(8) {
            0 | 1 => self.ball(place + n * size, size, material),
            // Standing, from either end; lying; a disc just above.
            2 => self.rod(place, n * height, 0.7 * size, material),
            3 => self.rod(place + n * height, n * -height, 0.7 * size, material),
            4 => {
                let radius = 0.5 * height;
                let base = place + n * radius - along * size;
                self.rod(base, along * (2.0 * size), radius, material)
            }
            5 => {
                let turn = DQuat::from_mat3(&glam::DMat3::from_cols(along, n.cross(along), n));
                let half = DVec3::new(0.7 * size, 0.6 * size, 0.5 * height);
                self.block(place + n * half.z, half, turn, material)
            }
            6 => {
                let up = n * (0.5 * height);
                self.rectangle(place + up, [along * size, up], material)
            }
            _ => {
                let lean = n.cross(along) * self.draw.within(-0.5, 0.5);
                let top = place + (n + lean) * height;
                let corners = match self.draw.chance(0.5) {
                    true => [place - along * size, place + along * (0.6 * size), top],
                    false => [place, top - along * size, top + along * (0.6 * size)],
                };
                self.triangle(corners, material)
            }
        }
    }

    /// An emitter in the very plane of a wall, on top of it.
    pub(super) fn coincide(
        &mut self,
        room: &Room,
        material: MaterialId,
    ) -> Result<(), RandomError> {
        let wall = &room.walls[self.draw.below(room.walls.len())];
        let size = self.draw.decades(0.1, 0.4);
        let place = wall.place(&mut self.draw, size);
        let along = wall.along(&mut self.draw);
        let across = wall.normal.cross(along);
        let part = self.draw.within(0.3, 0.9);
        self.take(place, size);
        self.spots.extend([place, place + along * size]);
        match self.draw.below(4) {
            0 => {
                let corners = [along * size, across * (part * size), along * -size];
                self.triangle(corners.map(|c| place + c), material)
            }
            // Sunk in the wall, so that the end alone is seen.
            1 => self.rod(place, wall.normal * -(part * size), size, material),
            2 => {
                let turn = DQuat::from_mat3(&glam::DMat3::from_cols(along, across, wall.normal));
                let half = DVec3::new(0.7 * size, 0.7 * part * size, 0.2 * size);
                self.block(place - wall.normal * half.z, half, turn, material)
            }
            _ => self.rectangle(place, [along * (0.7 * size), across * (part * size)], material),
        }
    }
}
