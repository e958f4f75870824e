//! Whether two experiments, or an experiment and a scene, are of one and the same picture.

use super::{Experiment, ExperimentError};
use crate::brdf::{Erratum, Model, Normals, Roughness};
use crate::math::simd::Isa;
use crate::plain;
use crate::progressive::{FileRecipe, Params, Recipe};
use crate::scene::read::parse_camera;
use crate::scene::{Crop, Material, Scene};
use crate::trace::{ReuseGroup, Strategy};
use std::fmt::Display;
use std::sync::Arc;

/// Sets that give the same bits.
fn is_fused(isa: &str) -> bool {
    isa != Isa::Portable.name()
}

/// "model ggx and not phong", if they are not the same.
fn differ<T: PartialEq + Display>(what: &str, own: T, other: T) -> Option<String> {
    let shown = |x: &T| plain::start(&x.to_string());
    (own != other).then(|| format!("{what} {} and not {}", shown(&other), shown(&own)))
}

/// The axis of a model that was turned up.
fn up(axis: &Option<String>) -> &str {
    axis.as_deref().unwrap_or("none")
}

/// The first file that is another.
fn other_file(own: &[FileRecipe], other: &[FileRecipe]) -> Option<String> {
    let short = |file: &FileRecipe| plain::line(&file.sha256.chars().take(12).collect::<String>());
    let changed = own.iter().zip(other).find(|(a, b)| a != b).map(|(a, b)| {
        let [own, other] = [a, b].map(|file| plain::start(&file.name));
        if a.name != b.name {
            return format!("{other} and not {own}");
        }
        format!("another {own}: SHA-256 {}… and not {}…", short(b), short(a))
    });
    let number = || differ("files of a scene:", own.len(), other.len());
    changed.or_else(number)
}

impl Experiment {
    /// What another one has that keeps it from being of the same picture, in words that follow "it has".
    pub(super) fn foreign(&self, other: &Experiment) -> Option<String> {
        let (a, b) = (&self.recipe, &other.recipe);
        let depth = |r: &Recipe| r.max_depth.map_or("none".to_owned(), |n| n.to_string());
        let erratum = |r: &Recipe| r.erratum.clone().unwrap_or_else(|| "none".to_owned());
        let size = |r: &Recipe| format!("{}x{}", r.size[0], r.size[1]);
        let crop = |r: &Recipe| format!("{:?}", r.crop.unwrap_or(Crop::WHOLE).parts());
        let passes = |r: &Recipe| if r.uniform { "uniform" } else { "planned" };
        let tracer = |r: &Recipe| if r.reference { "reference" } else { "engine" };
        let sums = |r: &Recipe| if is_fused(&r.isa) { "fused" } else { "portable" };
        let materials = || {
            let same = a.materials == b.materials && self.alphas == other.alphas;
            (!same).then(|| "other materials".to_owned())
        };
        differ("burnish version", &a.burnish, &b.burnish)
            .or_else(|| other_file(&a.scene.files, &b.scene.files))
            .or_else(|| differ("scene", &a.scene.name, &b.scene.name))
            .or_else(|| differ("axis up", up(&a.scene.up), up(&b.scene.up)))
            .or_else(materials)
            .or_else(|| differ("camera", &a.camera, &b.camera))
            .or_else(|| differ("crop", crop(a), crop(b)))
            .or_else(|| differ("size", size(a), size(b)))
            .or_else(|| differ("model", &a.model, &b.model))
            .or_else(|| differ("strategy", &a.strategy, &b.strategy))
            .or_else(|| differ("normals", &a.normals, &b.normals))
            .or_else(|| differ("erratum", erratum(a), erratum(b)))
            .or_else(|| differ("tracer", tracer(a), tracer(b)))
            .or_else(|| differ("seed", a.seed, b.seed))
            .or_else(|| differ("passes that are", passes(a), passes(b)))
            .or_else(|| differ("depth limit", depth(a), depth(b)))
            .or_else(|| differ("instruction set of sums that are", sums(a), sums(b)))
            .or_else(|| differ("groups of", a.group, b.group))
            .or_else(|| differ("quantum 2^", self.quantum, other.quantum))
    }

    /// The parameters that it was rendered with, of its scene read again. A scene whose files have
    /// changed is refused with the name of the first that has.
    pub fn params(&self, scene: Arc<Scene>) -> Result<Params, ExperimentError> {
        let params = self.recipe.params_of(scene, |material| self.alphas.get(material).copied())?;
        match differ("quantum 2^", params.quantum(), self.quantum) {
            Some(what) => Err(ExperimentError::Foreign(what)),
            None if self.chosen => Ok(Params { group: None, ..params }),
            None => Ok(params),
        }
    }

    /// Whether it can go on.
    pub(in crate::progressive) fn is_resumable(&self) -> Result<(), ExperimentError> {
        match self.gap() {
            Some([from, to]) => Err(ExperimentError::Gap(from, to - 1)),
            None => Ok(()),
        }
    }
}

impl Recipe {
    /// The parameters of the picture, of its scene read again. A scene whose files have changed is refused
    /// with the name of the first that has; so is one that would be traced with an instruction set
    /// that gives other bits.
    pub fn params(&self, scene: Arc<Scene>) -> Result<Params, ExperimentError> {
        self.params_of(scene, |_| self.alpha)
    }

    /// The same with the alpha of each edited material, where it is known better than by its exponent.
    fn params_of(
        &self,
        scene: Arc<Scene>,
        alpha: impl Fn(usize) -> Option<f64>,
    ) -> Result<Params, ExperimentError> {
        // What is asked for is the recipe's, what there is the scene's.
        let files: Vec<FileRecipe> = scene.source().files.iter().map(FileRecipe::from).collect();
        let fused = |isa: &str| if is_fused(isa) { "fused" } else { "portable" };
        let isa = scene.isa().name();
        let nameless = files.is_empty();
        let foreign = other_file(&files, &self.scene.files)
            .or_else(|| differ("scene", scene.name(), &self.scene.name).filter(|_| nameless))
            .or_else(|| {
                let own = scene.source().up.map(|axis| axis.name().to_owned());
                differ("axis up", up(&own), up(&self.scene.up))
            })
            .or_else(|| differ("burnish version", env!("CARGO_PKG_VERSION"), &self.burnish))
            .or_else(|| differ("instruction set of sums that are", fused(isa), fused(&self.isa)));
        if let Some(what) = foreign {
            return Err(ExperimentError::Foreign(what));
        }
        let params = self.parsed(scene, alpha).map_err(ExperimentError::Foreign)?;
        params.check()?;
        Ok(params)
    }

    fn parsed(
        &self,
        scene: Arc<Scene>,
        alpha: impl Fn(usize) -> Option<f64>,
    ) -> Result<Params, String> {
        let mut params = Params::new(scene);
        if self.moved {
            params.camera = parse_camera(&self.camera)?;
        }
        params.camera.crop = self.crop.unwrap_or(Crop::WHOLE);
        let mut materials = params.materials.to_vec();
        for (at, edited) in self.materials.iter().enumerate() {
            let mut material: Material = edited.material().map_err(|e| e.to_string())?;
            // It is one of both, and the other follows from it.
            let exponent = material.roughness.exponent();
            let by_alpha = alpha(at).and_then(|alpha| Roughness::from_alpha(alpha).ok());
            if let Some(by_alpha) = by_alpha.filter(|r| r.exponent() == exponent) {
                material.roughness = by_alpha;
            }
            let place = materials.get_mut(edited.index);
            *place.ok_or_else(|| format!("a material number {}", edited.index))? = material;
        }
        params.materials = Arc::new(materials);
        let erratum = |name: &String| named("erratum", name, &Erratum::ALL, Erratum::name);
        Ok(Params {
            size: self.size,
            model: named("model", &self.model, &Model::ALL, Model::name)?,
            seed: self.seed,
            max_depth: self.max_depth,
            strategy: named("strategy", &self.strategy, &Strategy::ALL, Strategy::name)?,
            normals: named("choice of normals", &self.normals, &Normals::ALL, Normals::name)?,
            erratum: self.erratum.as_ref().map(erratum).transpose()?,
            reference: self.reference,
            group: ReuseGroup::ALL.into_iter().find(|group| group.paths() == self.group.max(1)),
            uniform: self.uniform,
            first_pass: self.first_pass,
            ..params
        })
    }
}

/// The one of this name.
fn named<T: Copy>(
    what: &str,
    name: &str,
    all: &[T],
    own: fn(T) -> &'static str,
) -> Result<T, String> {
    let found = all.iter().copied().find(|&one| own(one) == name);
    found.ok_or_else(|| format!("an unknown {what}, `{}`", plain::start(name)))
}
