//! The document: the scene that is shown and all that controls change, shared by all panels.

pub(crate) mod command;
pub(crate) mod comparison;
pub(crate) mod dropped;
pub(crate) mod errors;
pub(crate) mod exposures;
pub(crate) mod goal;
pub(crate) mod history;
pub(crate) mod live;
pub(crate) mod recent;
pub(crate) mod trend;

use crate::viewer::document::comparison::Comparison;
use crate::viewer::document::errors::Curves;
use crate::viewer::document::goal::{Goal, Stop};
use crate::viewer::document::history::{History, State};
use crate::viewer::document::live::Live;
use crate::viewer::jobs::load::{Loaded, Source};
use crate::viewer::jobs::watch::Stamp;
use crate::viewer::picture::maps::Layer;
use crate::viewer::picture::orbit::Subject;
use burnish::brdf::Roughness;
use burnish::picture::Tone;
use burnish::progressive::Params;
use burnish::scene::{FirstHit, Material, MaterialId, Report};
use glam::DVec3;
use std::sync::Arc;

/// A scene with everything that can be set about it. Panels change it; the app then tells the
/// renderer.
pub(crate) struct Document {
    /// Parameters that the pixels depend on.
    pub(crate) params: Params,
    /// The place the scene was read from.
    pub(crate) source: Source,
    /// Its files as they were when it was read.
    pub(crate) files: Vec<Stamp>,
    /// The reader's warnings and notes.
    pub(crate) report: Report,
    /// Counts the scenes opened, so that panels know a new one.
    pub(crate) number: u64,
    /// When tracing stops.
    pub(crate) goal: Goal,
    pub(crate) paused: bool,
    pub(crate) tone: Tone,
    /// Whether the picture is as large as the window has room for.
    pub(crate) follow: bool,
    /// The material last picked.
    pub(crate) picked: Option<MaterialId>,
    /// Whether the roughness is that of the picked material or that of all.
    pub(crate) only_picked: bool,
    /// The pixel last clicked: column and row from the top left.
    pub(crate) clicked: Option<[u32; 2]>,
    /// The picture itself, or a map of it.
    pub(crate) layer: Layer,
    /// The pictures it is compared with.
    pub(crate) comparison: Comparison,
    /// The errors of its pictures over time.
    pub(crate) errors: Curves,
    /// The rest that panels read.
    pub(crate) live: Live,
    history: History<Settings>,
}

/// The part of a document that undo brings back.
#[derive(Clone)]
struct Settings {
    params: Params,
    tone: Tone,
    goal: Goal,
    follow: bool,
}

impl State for Settings {
    /// The first six of the parts below.
    const FLOWING: u32 = 0b11_1111;

    fn differs(&self, from: &Settings) -> u32 {
        let (now, was) = (&self.params, &from.params);
        let same = Arc::ptr_eq(&now.materials, &was.materials) || now.materials == was.materials;
        let parts = [
            !same,
            now.camera != was.camera,
            // What the window's size does is no step of its own.
            self.follow != from.follow || (now.size != was.size && !self.follow),
            now.seed != was.seed,
            self.tone.exposure != from.tone.exposure,
            Goal { stop: from.goal.stop, ..self.goal } != from.goal,
            now.max_depth != was.max_depth,
            now.model != was.model,
            now.strategy != was.strategy,
            now.normals != was.normals,
            now.erratum != was.erratum,
            self.tone.curve != from.tone.curve,
            self.goal.stop != from.goal.stop,
        ];
        parts.iter().enumerate().map(|(i, differs)| u32::from(*differs) << i).sum()
    }
}

/// The roughness that the slider stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Shown {
    /// All the materials in question have this one.
    Same(Roughness),
    /// They differ; this is the geometric mean of their alphas.
    Mixed(Roughness),
    /// None of them has a specular lobe.
    None,
}

impl Document {
    /// A scene as it was read, with its own exposure. Model, method, goal, curve, layer and comparison stay
    /// those of the scene before, of which the first has none; and so does a camera that was moved when the same
    /// scene is read again.
    pub(crate) fn open(
        loaded: Loaded,
        before: Option<&Document>,
        (tone, goal, follow): (Tone, Goal, bool),
    ) -> Document {
        let mut params = Params::new(loaded.scene);
        if let Some(before) = before {
            params.model = before.params.model;
            params.strategy = before.params.strategy;
            params.normals = before.params.normals;
            params.erratum = before.params.erratum;
            let moved = before.params.camera != before.params.scene.camera();
            if loaded.again && loaded.source == before.source && moved {
                params.camera = before.params.camera;
            }
        }
        let (curve, goal) = before.map_or((tone.curve, goal), |b| (b.tone.curve, b.goal));
        let tone = Tone { curve, ..tone };
        let same = before.filter(|b| loaded.again && loaded.source == b.source);
        let clicked = same.and_then(|b| b.clicked);
        let follow = before.map_or(follow, |b| b.follow);
        let settings = Settings { params: params.clone(), tone, goal, follow };
        Document {
            params,
            source: loaded.source,
            files: loaded.files,
            report: loaded.report,
            number: before.map_or(0, |b| b.number + 1),
            goal,
            paused: false,
            tone,
            follow,
            picked: None,
            only_picked: false,
            clicked,
            layer: before.map_or(Layer::default(), |b| b.layer),
            comparison: before.map_or(Comparison::default(), |b| b.comparison.clone()),
            errors: Curves::default(),
            live: Live::default(),
            history: History::new(settings),
        }
    }

    /// Is of these parameters from now on, to as many passes at least.
    pub(crate) fn go_on(&mut self, params: Params, passes: u64) {
        self.params = params;
        self.goal.stop = Stop::Passes;
        self.goal.passes = self.goal.passes.max(passes);
        self.follow = false;
        self.history = History::new(self.settings());
    }

    /// The box that the camera moves about.
    pub(crate) fn subject(&self) -> Subject {
        Subject::new(self.params.scene.focus())
    }

    /// Bounds to be framed: the surfaces of the picked material, or else all there is to look at.
    pub(crate) fn framed(&self) -> [DVec3; 2] {
        let picked = self.picked.filter(|_| self.only_picked);
        let scene = &self.params.scene;
        picked.and_then(|material| scene.bounds_of(material)).unwrap_or_else(|| scene.focus())
    }

    /// The point that the keys turn the camera about: the middle of the picked material's surfaces, or straight
    /// ahead.
    pub(crate) fn pivot(&self) -> DVec3 {
        let camera = &self.params.camera;
        let picked = self.picked.filter(|_| self.only_picked);
        let ahead = |centre: &DVec3| (camera.eye - *centre).dot(camera.axes()[2]) > 0.0;
        picked
            .and_then(|material| self.params.scene.bounds_of(material))
            .map(|[low, high]| (low + high) * 0.5)
            .filter(ahead)
            .unwrap_or_else(|| self.subject().pivot(camera))
    }

    /// Width over height of the picture.
    pub(crate) fn aspect(&self) -> f64 {
        f64::from(self.params.size[0]) / f64::from(self.params.size[1].max(1))
    }

    #[cfg(test)]
    pub(crate) fn set_limit(&mut self, passes: u64) {
        self.goal.passes = passes.clamp(1, burnish::progressive::Session::MAX_PASSES);
    }

    /// Picks a material, or none: then the roughness is that of all.
    pub(crate) fn pick(&mut self, material: Option<MaterialId>) {
        self.only_picked = material.is_some();
        self.picked = material.or(self.picked);
    }

    /// The surface behind the middle of the pixel last clicked.
    pub(crate) fn clicked_hit(&self) -> Option<FirstHit> {
        let params = &self.params;
        let [x, y] = self.clicked.filter(|p| p[0] < params.size[0] && p[1] < params.size[1])?;
        let middle = [x as f32 + 0.5, y as f32 + 0.5];
        params.scene.first_hit(&params.camera, params.size, middle)
    }

    /// The picked material, where there is one.
    pub(crate) fn picked_material(&self) -> Option<&Material> {
        self.params.materials.get(self.picked? as usize)
    }

    /// The picked material as the scene file has it.
    pub(crate) fn picked_as_read(&self) -> Option<&Material> {
        self.params.scene.materials().get(self.picked? as usize)
    }

    /// Puts this in the place of the picked material.
    pub(crate) fn set_picked(&mut self, material: Material) {
        let Some(picked) = self.picked else { return };
        if let Some(place) = Arc::make_mut(&mut self.params.materials).get_mut(picked as usize) {
            *place = material;
        }
    }

    /// The roughness that the slider shows.
    pub(crate) fn roughness(&self) -> Shown {
        let alphas: Vec<f64> = self.concerned().map(|m| m.roughness.alpha()).collect();
        let Some(first) = self.concerned().next() else { return Shown::None };
        if self.concerned().all(|m| m.roughness == first.roughness) {
            return Shown::Same(first.roughness);
        }
        let mean = alphas.iter().map(|a| a.ln()).sum::<f64>() / alphas.len() as f64;
        let [low, high] = Roughness::ALPHA;
        Roughness::from_alpha(mean.exp().clamp(low, high)).map_or(Shown::None, Shown::Mixed)
    }

    /// The least and the largest alpha that the slider speaks of.
    pub(crate) fn alphas(&self) -> [f64; 2] {
        self.concerned()
            .map(|m| m.roughness.alpha())
            .fold([f64::INFINITY, 0.0], |[low, high], a| [low.min(a), high.max(a)])
    }

    /// The parameters with this roughness of all the materials in question.
    pub(crate) fn with_roughness(&self, roughness: Roughness) -> Params {
        let mut params = self.params.clone();
        for (i, material) in Arc::make_mut(&mut params.materials).iter_mut().enumerate() {
            if self.concerns(i) {
                material.roughness = roughness;
            }
        }
        params
    }

    /// Gives all the materials in question this roughness.
    pub(crate) fn set_roughness(&mut self, roughness: Roughness) {
        self.edit(|_, material| material.roughness = roughness);
    }

    /// Multiplies their alphas, each within its range: mixed ones keep their differences.
    pub(crate) fn scale_roughness(&mut self, factor: f64) {
        let [low, high] = Roughness::ALPHA;
        self.edit(|_, material| {
            let alpha = (material.roughness.alpha() * factor).clamp(low, high);
            if let Ok(roughness) = Roughness::from_alpha(alpha) {
                material.roughness = roughness;
            }
        });
    }

    /// Whether any of them differs from the scene file.
    pub(crate) fn roughness_is_edited(&self) -> bool {
        let as_read = self.params.scene.materials();
        let pairs = as_read.iter().zip(self.params.materials.iter()).enumerate();
        pairs.filter(|(i, _)| self.concerns(*i)).any(|(_, (was, is))| was.roughness != is.roughness)
    }

    /// Puts theirs back to the scene file's.
    pub(crate) fn reset_roughness(&mut self) {
        let scene = self.params.scene.clone();
        self.edit(|i, material| {
            if let Some(as_read) = scene.materials().get(i) {
                material.roughness = as_read.roughness;
            }
        });
    }

    /// Takes note of changes for undo: at `now` seconds, the pointer being `down` or not.
    pub(crate) fn note(&mut self, now: f64, down: bool) {
        let settings = self.settings();
        self.history.note(&settings, now, down);
    }

    fn settings(&self) -> Settings {
        let Document { tone, goal, follow, .. } = *self;
        Settings { params: self.params.clone(), tone, goal, follow }
    }

    /// Goes one change back. False when there is none.
    pub(crate) fn undo(&mut self) -> bool {
        let before = self.history.undo().cloned();
        self.restore(before)
    }

    /// Takes back the last undo. False when there is none.
    pub(crate) fn redo(&mut self) -> bool {
        let after = self.history.redo().cloned();
        self.restore(after)
    }

    pub(crate) fn can_undo(&self) -> bool {
        self.history.can_undo()
    }

    pub(crate) fn can_redo(&self) -> bool {
        self.history.can_redo()
    }

    fn restore(&mut self, settings: Option<Settings>) -> bool {
        let Some(Settings { params, tone, goal, follow }) = settings else { return false };
        let size = if follow && self.follow { self.params.size } else { params.size };
        self.params = Params { size, ..params };
        (self.tone, self.goal, self.follow) = (tone, goal, follow);
        true
    }

    /// Whether the slider speaks of material `i`: it has a lobe, and is picked or all are meant.
    fn concerns(&self, i: usize) -> bool {
        let Some(material) = self.params.materials.get(i) else { return false };
        let meant = !self.only_picked || self.picked == Some(i as MaterialId);
        meant && has_lobe(material)
    }

    fn concerned(&self) -> impl Iterator<Item = &Material> {
        let materials = self.params.materials.iter().enumerate();
        materials.filter(|(i, _)| self.concerns(*i)).map(|(_, m)| m)
    }

    fn edit(&mut self, change: impl Fn(usize, &mut Material)) {
        let concerned: Vec<usize> =
            (0..self.params.materials.len()).filter(|&i| self.concerns(i)).collect();
        let materials = Arc::make_mut(&mut self.params.materials);
        for i in concerned {
            if let Some(material) = materials.get_mut(i) {
                change(i, material);
            }
        }
    }
}

/// Whether a roughness has any effect on this material.
pub(crate) fn has_lobe(material: &Material) -> bool {
    material.ks.iter().any(|&c| c > 0.0)
}
