//! A scene from a seed.

use super::super::draw::Draw;
use super::RandomError;
use super::emitter_kind::EmitterKind;
use super::room::{Form, Room};
use super::stage::RandomStage;
use crate::brdf::Model;
use crate::math::simd::Isa;
use crate::progressive::Params;
use crate::scene::{Camera, Material, MaterialId};
use crate::trace::ReuseGroup;
use glam::{DMat3, DQuat, DVec3};
use std::sync::Arc;

/// A scene drawn at random.
#[derive(Clone, Debug)]
pub struct RandomScene {
    /// What it was drawn from.
    pub seed: u64,
    /// How its emitters lie.
    pub kind: EmitterKind,
    /// Everything that is in it, a line a thing; lengths in units of the room.
    pub description: String,
    /// The engine's picture of it.
    pub params: Params,
    /// The reference tracer's.
    pub reference: Params,
    /// What the engine runs on.
    pub isa: Isa,
}

/// Of the numbers that scenes are drawn by.
const FAMILY: u64 = 0x7363_656e_6573;

impl RandomScene {
    /// The scene of this seed: the same on every machine but for the instruction set, which goes
    /// round those that this one has.
    pub fn draw(seed: u64) -> Result<RandomScene, RandomError> {
        let kind = EmitterKind::ALL[(seed % 5) as usize];
        let mut stage = RandomStage::new(Draw::new(FAMILY, seed), format!("random scene {seed}"));
        let room = Room::draw(&mut stage.draw, kind);
        let room = furnish(&mut stage, room, kind)?;
        let camera = stage.camera(&room, kind)?;
        let draw = &mut stage.draw;
        let size = [draw.within(24.0, 44.0) as u32, draw.within(24.0, 40.0) as u32];
        let model = draw.one(&Model::ALL);
        let max_depth = match draw.below(8) {
            0 => Some(1),
            1 => Some(2),
            2 => Some(3),
            3 => Some(4 + draw.below(12) as u32),
            _ => None,
        };
        // As users get them, and each size of group by itself.
        let sizes = ReuseGroup::ALL.map(Some);
        let group = if draw.chance(0.4) { None } else { draw.one(&sizes) };
        let isas = Isa::available();
        let isa = isas[draw.below(isas.len())];
        let picture = draw.seed();
        let place = stage.place;
        stage.tell(format_args!(
            "at scale {:e}, offset {}, turned by {}",
            place.scale, place.offset, place.rotation
        ));
        stage.tell(format_args!(
            "{} {}x{}, model {}, depth {max_depth:?}, group {group:?}, isa {}",
            camera.scn_line(),
            size[0],
            size[1],
            model.name(),
            isa.name()
        ));
        stage.site.builder.camera = Some(camera);
        let mut scene = stage.site.builder.build();
        scene.set_isa(isa);
        let params =
            Params { size, model, max_depth, group, seed: picture, ..Params::new(Arc::new(scene)) };
        let reference = Params { reference: true, ..params.clone() };
        Ok(RandomScene { seed, kind, description: stage.told, params, reference, isa })
    }
}

/// Puts up the room with all that is in it.
fn furnish(
    stage: &mut RandomStage,
    mut room: Room,
    kind: EmitterKind,
) -> Result<Room, RandomError> {
    let glows = kind == EmitterKind::Glowing;
    stage.tell(format_args!("{:?} around {}", room.form, room.centre));
    let hole = match kind {
        EmitterKind::Flush => Some(cut(stage, &mut room)),
        _ => None,
    };
    let open = !room.is_closed();
    // What surfaces send each other is best seen where little else sends light.
    let sky = if glows { 0.4 } else { 0.7 };
    if open && stage.draw.chance(sky) {
        let sky = stage.radiance(0.1, 1.0);
        stage.site.builder.environment = sky.map(|c| c as f32);
        stage.tell(format_args!("environment {sky:?}"));
    }
    let lamps_first = stage.draw.chance(0.5);
    if !lamps_first {
        walls(stage, &room, glows)?;
    }
    let count = match stage.draw.below(8) {
        0 => 6,
        i if glows && i < 4 => 0,
        i => 1 + i % 3,
    };
    let mut material = 0;
    for i in 0..count {
        if i == 0 || stage.draw.chance(0.5) {
            let reflects = glows || stage.draw.chance(0.2);
            material = stage.emitter(reflects)?;
        }
        match kind {
            EmitterKind::Flush if i == 0 => {
                let wall = room.walls[hole.unwrap_or_default()].clone();
                stage.filling(&wall, material)?;
            }
            EmitterKind::Coincident if i == 0 => stage.coincide(&room, material)?,
            EmitterKind::Touching => stage.touch(&room, material)?,
            EmitterKind::Glowing if stage.draw.chance(0.5) => stage.touch(&room, material)?,
            _ => stage.hang(&room, material)?,
        }
    }
    if lamps_first {
        walls(stage, &room, glows)?;
    }
    let things = stage.draw.below(5);
    for _ in 0..things {
        let surface = stage.surface(1e-4)?;
        let glimmer = glows && stage.draw.chance(0.3);
        let radiance = if glimmer { stage.radiance(0.1, 1.0) } else { [0.0; 3] };
        let material = stage.add(surface.emitting(radiance)?);
        match stage.draw.chance(0.5) {
            true => stage.touch(&room, material)?,
            false => stage.hang(&room, material)?,
        }
    }
    Ok(room)
}

/// Cuts a hole in a wall, and keeps what is before it free.
fn cut(stage: &mut RandomStage, room: &mut Room) -> usize {
    let which = stage.draw.below(room.walls.len());
    let wall = &mut room.walls[which];
    let draw = &mut stage.draw;
    let mut span = || {
        let half = draw.within(0.1, 0.4);
        let middle = draw.within(half - 0.95, 0.95 - half);
        [middle - half, middle + half]
    };
    let [a, b] = [span(), span()];
    wall.hole = Some([a, b]);
    let middle = wall.at(0.5 * (a[0] + a[1]), 0.5 * (b[0] + b[1]));
    stage.take(middle, 0.1);
    which
}

/// Puts up the walls, which glow now and then if they may.
fn walls(stage: &mut RandomStage, room: &Room, glows: bool) -> Result<(), RandomError> {
    // Light goes along round walls at grazing angles, where a smooth lobe keeps all of it.
    let smoothest = match room.form {
        Form::Sphere(_) | Form::Cylinder(..) => 0.2,
        _ => 1e-4,
    };
    let mut first = true;
    let mut paint = |stage: &mut RandomStage| -> Result<MaterialId, RandomError> {
        let mut surface = match stage.draw.chance(0.5) {
            true => stage.surface(smoothest)?,
            false => {
                let level = stage.draw.within(0.2, 0.8);
                let kd = [0; 3].map(|_| level * stage.draw.within(0.7, 1.0));
                Material::reflecting("wall", kd, [0.0; 3], 0.0)?
            }
        };
        if glows && (first || stage.draw.chance(0.5)) {
            first = false;
            let radiance = stage.radiance(0.2, 2.0);
            surface = surface.emitting(radiance)?;
        }
        Ok(stage.add(surface))
    };
    match room.form {
        Form::Sphere(radius) => {
            let material = paint(stage)?;
            stage.ball(room.centre, radius, material)
        }
        Form::Cylinder(radius, half) => {
            let material = paint(stage)?;
            let base = room.centre - DVec3::Z * half;
            stage.rod(base, DVec3::Z * (2.0 * half), radius, material)
        }
        _ => {
            let mut material = None;
            for wall in &room.walls {
                if material.is_none() || stage.draw.chance(0.4) {
                    material = Some(paint(stage)?);
                }
                stage.wall(wall, material.unwrap_or_default())?;
            }
            Ok(())
        }
    }
}

impl RandomStage {
    /// An eye outside all that stands here, that looks at something in the room.
    fn camera(&mut self, room: &Room, kind: EmitterKind) -> Result<Camera, RandomError> {
        let mut eye = room.centre;
        for _ in 0..100 {
            let Some(place) = room.somewhere(&mut self.draw, 0.05) else { continue };
            if self.is_free(place, 0.05) {
                eye = place;
                break;
            }
        }
        let mut target = room.somewhere(&mut self.draw, 0.01).unwrap_or(room.centre);
        if !room.is_closed() {
            // What is open is mostly sky.
            target = target.lerp(room.centre, 0.7);
        }
        let mut ry = self.draw.decades(0.3, 1.2);
        let near = if kind == EmitterKind::Glowing { 0.75 } else { 0.5 };
        if !self.spots.is_empty() && self.draw.chance(near) {
            // A close look: what goes wrong in a thousandth of a surface is lost in its mean.
            target = self.spots[self.draw.below(self.spots.len())];
            ry = self.draw.decades(1e-4, 0.1);
        }
        let back = (eye - target).try_normalize().unwrap_or(DVec3::X);
        let right = self.draw.direction().cross(back).try_normalize().unwrap_or(DVec3::Y);
        let axes = DQuat::from_mat3(&DMat3::from_cols(right, back.cross(right), back));
        Ok(self.site.camera(Camera::new(eye, ry, axes)?)?)
    }
}
