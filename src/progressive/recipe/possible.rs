//! Whether a recipe's values are such as a render can have: who wrote it is not known.

use super::Recipe;
use crate::brdf::{Erratum, Model, Normals, Roughness};
use crate::math::simd::Isa;
use crate::picture::{Curve, Tone};
use crate::plain;
use crate::progressive::{Params, Session, plan};
use crate::scene::Axis;
use crate::scene::read::parse_camera;
use crate::trace::{ReuseGroup, Strategy};

impl Recipe {
    /// The first value that no render has, in words that follow "the recipe has ".
    pub(super) fn impossible(&self) -> Option<String> {
        let known = |what: &str, name: &str, names: &[&'static str]| {
            let text = || format!("an unknown {what}, `{}`", plain::start(name));
            (!names.contains(&name)).then(text)
        };
        let erratum = self.erratum.as_deref();
        let up = self.scene.up.as_deref();
        let tone = self.tone.as_ref();
        let sides = 1..=Params::MAX_SIDE;
        let [width, height] = self.size;
        let size = || {
            let wrong = !(sides.contains(&width) && sides.contains(&height));
            wrong.then(|| format!("a size of {width}x{height} pixels"))
        };
        let parts = || {
            let (parts, passes) = (&self.parts, self.passes);
            let apart = |pair: &[[u64; 2]]| pair[0][1] < pair[1][0];
            let in_order = parts.iter().all(|[from, to]| from < to && from.is_multiple_of(4))
                && parts.windows(2).all(apart)
                && parts.last().is_some_and(|part| part[1] <= 2 * Session::MAX_PASSES);
            let all = || parts.iter().map(|[from, to]| to - from).sum::<u64>() == passes;
            let begins = || parts[0][0] == self.first_pass && parts.len() > 1 && self.uniform;
            let possible = parts.is_empty() || in_order && all() && begins();
            (!possible).then(|| format!("passes {:?} of {passes}", &parts[..parts.len().min(4)]))
        };
        let passes = || {
            // Time may run out within a pass: then there are more paths than whole passes have.
            // Where samples are planned, passes are those of a pixel on the mean only, but for the first.
            let each = if self.uniform { Session::MAX_PASSES } else { plan::UNIFORM };
            let least = u64::from(width) * u64::from(height) * self.passes.min(each);
            let first = self.first_pass;
            let begins = first == 0 || self.uniform && first.is_multiple_of(4);
            if self.passes > Session::MAX_PASSES {
                Some(format!("{} passes", self.passes))
            } else if first > Session::MAX_PASSES || !begins {
                Some(format!("a first pass of {first}"))
            } else if self.paths < least || self.nonfinite > self.paths {
                Some(format!(
                    "{} paths, {} of them not finite, in {} passes of {width}x{height} pixels",
                    self.paths, self.nonfinite, self.passes
                ))
            } else {
                None
            }
        };
        let roughness = || {
            let alpha = self.alpha.is_some_and(|a| Roughness::from_alpha(a).is_err());
            let exponent = self.exponent.is_some_and(|a_p| Roughness::from_exponent(a_p).is_err());
            let alone = self.alpha.is_none() || self.exponent.is_none();
            (alpha || exponent || !alone)
                .then(|| format!("alpha {:?} and exponent {:?}", self.alpha, self.exponent))
        };
        let camera = || {
            let text = |why: String| format!("a camera that cannot be: {}", plain::start(&why));
            parse_camera(&self.camera).err().map(text)
        };
        let error = || {
            let e = self.error.as_ref()?;
            let high = e.high.unwrap_or(f64::INFINITY);
            let in_order = 0.0 <= e.low && e.low <= e.relative && e.relative <= high;
            (!in_order).then(|| format!("an error of {} from {} to {high}", e.relative, e.low))
        };
        let exposure = || {
            let exposure = tone?.exposure;
            let [low, high] = Tone::EXPOSURE;
            let possible = (low..=high).contains(&exposure);
            (!possible).then(|| format!("an exposure of {exposure}"))
        };
        let material = || {
            let wrong = |m: &super::MaterialRecipe| {
                m.material().err().map(|e| format!("a material that cannot be: {e}"))
            };
            self.materials.iter().find_map(wrong)
        };
        known("model", &self.model, &Model::ALL.map(Model::name))
            .or_else(|| known("strategy", &self.strategy, &Strategy::ALL.map(Strategy::name)))
            .or_else(|| known("choice of normals", &self.normals, &Normals::ALL.map(Normals::name)))
            .or_else(|| known("erratum", erratum?, &Erratum::ALL.map(Erratum::name)))
            .or_else(|| known("axis", up?, &Axis::ALL.map(Axis::name)))
            .or_else(|| known("tone curve", &tone?.curve, &Curve::ALL.map(Curve::name)))
            .or_else(|| known("instruction set", &self.isa, &Isa::ALL.map(Isa::name)))
            .or_else(|| {
                let sizes = || ReuseGroup::ALL.into_iter().map(ReuseGroup::paths);
                let wrong = self.group != 0 && !sizes().any(|paths| paths == self.group);
                wrong.then(|| format!("groups of {} paths", self.group))
            })
            .or_else(|| (self.max_depth == Some(0)).then(|| "a depth limit of 0".to_owned()))
            .or_else(size)
            .or_else(passes)
            .or_else(parts)
            .or_else(roughness)
            .or_else(camera)
            .or_else(error)
            .or_else(exposure)
            .or_else(material)
    }
}
