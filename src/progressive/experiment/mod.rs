//! A picture as an experiment: every sum that it is made of, so that it can go on, be added to others
//! and be checked.
//!
//! An experiment in a file is an OpenEXR picture that any program shows: its mean is the first part, with
//! the recipe as an attribute. Beside it are a part `sums` with the sums of each pixel by
//! replicate and channel, 96 bytes a pixel before packing, and a part `cells` with
//! the numbers of samples by cell of 8 x 8 pixels and what they were chosen by. Sums are whole
//! numbers, of 64 bits and more, each in several channels of 32 bits, the lowest first.
//!
//! Equal samples make equal files, whoever traced them in what order: a picture that was killed and
//! went on, or was put together of parts, has the file of one that was not.

mod file;
mod identity;
mod possible;
mod record;

pub use record::Goal;

use super::recipe::Outcome;
use super::{
    Counts, ErrorEstimate, ErrorRecipe, Params, ParamsError, Recipe, RecipeError, TileGrid,
};
use crate::film::{ErrorSums, Film, FilmError};
use crate::picture::{Picture, ReadError};
use crate::plain;
use crate::trace::ReuseGroup;
use std::path::PathBuf;
use thiserror::Error;

/// The samples of some passes of one picture, with all that is needed to trace more of them.
///
/// ```
/// use burnish::progressive::{Experiment, Options, Params, Session};
/// use burnish::scene::builtin;
/// use std::sync::{Arc, mpsc};
///
/// let scene = Arc::new(builtin::default_scene()?.0.build());
/// let params = Params { size: [16, 12], ..Params::new(scene.clone()) };
/// let path = std::env::temp_dir().join(format!("experiment-{}.exr", std::process::id()));
///
/// // Somewhere in a render of 40 passes.
/// let session = Session::with_options(params, 40, Options::headless(1), || {})?;
/// let (saved, told) = mpsc::channel();
/// let to = path.clone();
/// session.visit_experiment(move |experiment| { let _ = saved.send(experiment.save(&to)); });
/// told.recv()??;
/// drop(session);
///
/// // Another day.
/// let experiment = Experiment::read(&path)?;
/// let session = Session::with_experiment(experiment, scene, 40, Options::headless(2), || {})?;
/// let whole = session.snapshots().iter().find(|s| s.passes == 40 && s.whole).unwrap();
/// assert_eq!(whole.counts.paths, whole.samples().iter().sum::<u64>());
/// # std::fs::remove_file(&path)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Experiment {
    /// Without an error, which is estimated when it is asked for.
    recipe: Recipe,
    /// Roughness alpha of each of the recipe's materials.
    alphas: Vec<f64>,
    /// Whether the size of groups was chosen for the scene.
    chosen: bool,
    /// Exponent of the quantum of the sums.
    quantum: i32,
    /// The passes that are in it, in order and not touching each other.
    spans: Vec<[u64; 2]>,
    /// Tile by tile.
    films: Vec<Film>,
    /// What it is to become, and whereof.
    pub goal: Goal,
}

/// An experiment that cannot be read, resumed or added to another.
#[derive(Debug, Error)]
pub enum ExperimentError {
    /// There is no such file, or it is no OpenEXR file, or a broken one.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A picture without sums.
    #[error("{}: is a picture without its sums, such as `render -o` writes; those that `render --checkpoint` \
             writes have them", plain::path(.0))]
    NoSums(PathBuf),
    /// Sums that no render has.
    #[error("{}: no experiment that this burnish wrote: {reason}", plain::path(.path))]
    Broken {
        /// The file.
        path: PathBuf,
        /// What cannot be.
        reason: String,
    },
    /// The recipe cannot be followed.
    #[error("{}: {source}", plain::path(.path))]
    Recipe {
        /// The file.
        path: PathBuf,
        /// Why not.
        source: RecipeError,
    },
    /// It is of something else: in words that follow "it has".
    #[error("it has {0}")]
    Foreign(String),
    /// Both have these passes, first and last.
    #[error("both have passes {0} to {1}")]
    Overlap(u64, u64),
    /// Passes are missing between others, first and last.
    #[error("it lacks passes {0} to {1}: merge it with those that have them")]
    Gap(u64, u64),
    /// It ended within a pass.
    #[error("it ended within a pass; `burnish resume` it to the end of one")]
    WithinPass,
    /// Samples were chosen by samples, so that no passes of others fit to it.
    #[error("the numbers of its samples were chosen by what samples say; parts need --uniform")]
    Uneven,
    /// Films that do not fit.
    #[error(transparent)]
    Film(#[from] FilmError),
    /// It cannot be rendered.
    #[error(transparent)]
    Params(#[from] ParamsError),
}

/// Where two experiments of the same passes differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Pixels of which any sum differs.
    pub pixels: u64,
    /// The first of them, column and row.
    pub first: [u32; 2],
    /// Largest difference of the means of a pixel's channel, in radiance.
    pub largest: f64,
}

impl Experiment {
    /// Of the films of a session's epoch.
    pub(super) fn of(
        params: &Params,
        group: Option<ReuseGroup>,
        counts: Counts,
        films: Vec<Film>,
    ) -> Experiment {
        let passes = films.iter().map(Film::passes).min().unwrap_or(0);
        let whole = films.iter().all(|film| film.passes() == passes && film.is_whole());
        let outcome =
            Outcome { passes, whole, counts, error: None, group: group.unwrap_or_default() };
        let recipe = Recipe::of(params, outcome);
        let first = params.first_pass;
        Experiment {
            alphas: recipe
                .materials
                .iter()
                .map(|material| params.materials[material.index].roughness.alpha())
                .collect(),
            chosen: params.group.is_none(),
            quantum: params.quantum(),
            spans: if passes > 0 { vec![[first, first + passes]] } else { Vec::new() },
            films,
            goal: Goal::default(),
            recipe,
        }
    }

    pub(super) fn into_films(self) -> Vec<Film> {
        self.films
    }

    /// The tiles.
    pub fn grid(&self) -> TileGrid {
        TileGrid { size: self.recipe.size }
    }

    /// The passes that are in it, each from the first to before the second, in order.
    pub fn spans(&self) -> &[[u64; 2]] {
        &self.spans
    }

    /// The number of passes in it.
    pub fn passes(&self) -> u64 {
        self.recipe.passes
    }

    /// The passes of the part of the picture that has most: more than [`Experiment::passes`], by 16 at
    /// most, where it was ended within some that were traced at once.
    pub fn most_passes(&self) -> u64 {
        self.films.iter().map(Film::passes).max().unwrap_or(0)
    }

    /// The recipe, without the error of the picture.
    pub fn recipe(&self) -> &Recipe {
        &self.recipe
    }

    /// Whether the passes are all that is in it.
    pub fn is_whole(&self) -> bool {
        self.recipe.whole == Some(true)
    }

    /// How many neighbours share, once that is known.
    pub(super) fn group(&self) -> Option<ReuseGroup> {
        let known = self.films.iter().any(|film| film.passes() > 0);
        let is_it = |group: &ReuseGroup| group.paths() == self.recipe.group.max(1);
        ReuseGroup::ALL.into_iter().find(is_it).filter(|_| known)
    }

    pub(super) fn counts(&self) -> Counts {
        let Recipe { paths, rays, nonfinite, capped, .. } = self.recipe;
        Counts { paths, rays, nonfinite, capped }
    }

    /// The mean radiance, its error and the whole recipe.
    pub fn picture(&self) -> (Picture, Option<ErrorEstimate>, Recipe) {
        let grid = self.grid();
        let [width, height] = grid.size;
        let mut picture = Picture::black(width, height);
        let mut sums = ErrorSums::default();
        for (index, film) in self.films.iter().enumerate() {
            let rect = grid.rect(index);
            let estimate = film.estimate(rect.width());
            sums.add(&estimate.sums);
            for (row, line) in estimate.mean.chunks_exact(rect.width()).enumerate() {
                let start = (rect.y0 as usize + row) * width as usize + rect.x0 as usize;
                picture.pixels[start..start + rect.width()].copy_from_slice(line);
            }
        }
        let error = sums.estimate(u64::from(width) * u64::from(height), self.passes());
        let parts = if self.gap().is_some() { self.spans.clone() } else { Vec::new() };
        let known = error.as_ref().and_then(ErrorRecipe::new);
        let recipe = Recipe { error: known, parts, ..self.recipe.clone() };
        (picture, error, recipe)
    }

    /// Takes in the passes of another: to the bit what one render of both would be, in any order.
    /// They must be of one recipe, uniform, whole and have no pass in common.
    pub fn merge(&mut self, other: &Experiment) -> Result<(), ExperimentError> {
        if let Some(what) = self.foreign(other) {
            return Err(ExperimentError::Foreign(what));
        }
        if !self.recipe.uniform {
            return Err(ExperimentError::Uneven);
        }
        if !(self.is_whole() && other.is_whole()) {
            return Err(ExperimentError::WithinPass);
        }
        for [a, b] in &self.spans {
            for [c, d] in &other.spans {
                let (from, to) = (*a.max(c), *b.min(d));
                if from < to {
                    return Err(ExperimentError::Overlap(from, to - 1));
                }
            }
        }
        for (film, more) in self.films.iter_mut().zip(&other.films) {
            film.merge(more)?;
        }
        self.spans.extend(&other.spans);
        self.spans.sort_unstable();
        self.spans.dedup_by(|next, last| {
            let touch = next[0] == last[1];
            last[1] = if touch { next[1] } else { last[1] };
            touch
        });
        let counts = self.counts() + other.counts();
        let Counts { paths, rays, nonfinite, capped } = counts;
        self.recipe = Recipe {
            passes: self.recipe.passes + other.recipe.passes,
            first_pass: self.spans.first().map_or(0, |span| span[0]),
            paths,
            rays,
            nonfinite,
            capped,
            ..self.recipe.clone()
        };
        self.goal = self.goal.of_both(&other.goal);
        Ok(())
    }

    /// The first passes that are missing between others, from the first to before the second.
    pub fn gap(&self) -> Option<[u64; 2]> {
        self.spans.windows(2).next().map(|pair| [pair[0][1], pair[1][0]])
    }

    /// Where another experiment of the same passes differs, if it does.
    pub fn difference(&self, other: &Experiment) -> Option<Difference> {
        let mut found: Option<Difference> = None;
        let width = u64::from(self.recipe.size[0]);
        let place = |[x, y]: [u32; 2]| u64::from(y) * width + u64::from(x);
        for (index, (film, another)) in self.films.iter().zip(&other.films).enumerate() {
            let rect = self.grid().rect(index);
            let means = [film, another].map(|film| film.estimate(rect.width()).mean);
            for (pixel, (a, b)) in means[0].iter().zip(&means[1]).enumerate() {
                if film.sums(pixel) == another.sums(pixel) {
                    continue;
                }
                let [x, y] = [pixel % rect.width(), pixel / rect.width()].map(|x| x as u32);
                let at = [rect.x0 + x, rect.y0 + y];
                let off = (0..3).map(|c| (f64::from(a[c]) - f64::from(b[c])).abs());
                let off = off.fold(0.0, f64::max);
                let so_far = found.unwrap_or(Difference { pixels: 0, first: at, largest: 0.0 });
                let first = if place(at) < place(so_far.first) { at } else { so_far.first };
                let largest = so_far.largest.max(off);
                found = Some(Difference { pixels: so_far.pixels + 1, first, largest });
            }
        }
        found
    }
}
