//! Contact sheets: every model with every roughness, each picture traced to the same error.
//!
//! Pictures are judged by their noise as well, so none has less than the others: one whose error is less than was
//! wished for is traced again to fewer passes.

mod search;
mod trace;
mod words;

pub use trace::{SheetProgress, TracedCell, TracedSheet};

use super::{Params, ParamsError, StopRule};
use crate::brdf::{Model, Roughness};
use crate::limits::{PICTURE_SIDE, TooLarge, fits};
use crate::picture::sheet::layout;
use crate::scene::MaterialId;
use std::sync::Arc;
use thiserror::Error;

/// What a contact sheet shows: rows of models, columns of roughnesses.
///
/// All cells have the same random numbers: they differ by their models and roughnesses, and by as much of
/// the noise as depends on these.
///
/// ```
/// use burnish::brdf::Model;
/// use burnish::progressive::{Params, Sheet};
/// use burnish::scene::builtin;
/// use std::sync::Arc;
///
/// let scene = Arc::new(builtin::default_scene()?.0.build());
/// let mut sheet = Sheet::new(Params { size: [32, 24], ..Params::new(scene) });
/// sheet.models = vec![Model::Beckmann, Model::Ggx];
/// sheet.roughnesses.truncate(1);
/// sheet.most_passes = 8; // enough for an example
/// let traced = sheet.trace(0, |_| true)?;
/// assert_eq!(traced.done(), 2);
/// assert_eq!(sheet.name(1), "ggx_alpha_0p05");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Sheet {
    /// All that the cells have in common, the size of a cell among it.
    pub params: Params,
    /// The rows, from the top.
    pub models: Vec<Model>,
    /// The columns, from the left.
    pub roughnesses: Vec<Roughness>,
    /// Whether the columns are called by their Phong exponents rather than by their alphas.
    pub by_exponent: bool,
    /// The materials that have a column's roughness; all of them where none is named.
    pub materials: Vec<MaterialId>,
    /// Relative error that a cell's upper 95 % limit is to reach, as a part of one; see [`StopRule`].
    pub error: f64,
    /// A cell ends after this many passes, whatever its error.
    pub most_passes: u64,
}

/// A sheet that cannot be made.
#[derive(Debug, Error, PartialEq)]
pub enum SheetError {
    /// It has no rows or no columns.
    #[error("a contact sheet needs at least one model and one roughness")]
    Empty,
    /// It is wider or higher than pictures are.
    #[error(
        "the contact sheet would have {0}x{1} pixels, and pictures have at most {PICTURE_SIDE} a \
             side: make its cells smaller, or fewer"
    )]
    Size(u32, u32),
    /// There is no memory for it.
    #[error(transparent)]
    Memory(#[from] TooLarge),
    /// Its cells cannot be rendered.
    #[error(transparent)]
    Params(#[from] ParamsError),
}

impl Sheet {
    /// Roughness alphas of the columns, where no others are wished for: each twice the one before.
    pub const ALPHAS: [f64; 5] = [0.05, 0.1, 0.2, 0.4, 0.8];
    /// Error of every cell, where no other is wished for.
    pub const ERROR: f64 = 0.03;
    /// Most passes of a cell, where no other number is wished for.
    pub const MOST_PASSES: u64 = 4096;
    /// Width and height in pixels that a cell keeps within, where no size is wished for.
    pub const CELL: [u32; 2] = [320, 240];

    /// All models with alphas from 0.05 to 0.8, in cells of the size of these.
    pub fn new(params: Params) -> Sheet {
        let roughness = |alpha| Roughness::from_alpha(alpha).ok();
        Sheet {
            params,
            models: Model::ALL.to_vec(),
            roughnesses: Self::ALPHAS.into_iter().filter_map(roughness).collect(),
            by_exponent: false,
            materials: Vec::new(),
            error: Self::ERROR,
            most_passes: Self::MOST_PASSES,
        }
    }

    /// A picture's size made smaller, in proportion, until it is within [`Sheet::CELL`].
    pub fn fitted(size: [u32; 2]) -> [u32; 2] {
        let times = |i: usize| f64::from(Self::CELL[i]) / f64::from(size[i].max(1));
        let times = times(0).min(times(1)).min(1.0);
        size.map(|side| ((f64::from(side) * times).round() as u32).max(1))
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.models.len() * self.roughnesses.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The model and the roughness of a cell, counted row by row from 0; `None` beyond the last.
    pub fn of(&self, cell: usize) -> Option<(Model, Roughness)> {
        let columns = self.roughnesses.len().max(1);
        Some((*self.models.get(cell / columns)?, *self.roughnesses.get(cell % columns)?))
    }

    /// All that a cell's pixels depend on, besides its passes: a render of these is the cell, bit for
    /// bit. `None` beyond the last.
    pub fn cell(&self, cell: usize) -> Option<Params> {
        let (model, roughness) = self.of(cell)?;
        let mut params = Params { model, ..self.params.clone() };
        if self.materials.is_empty() {
            return Some(params.with_roughness(roughness));
        }
        let materials = Arc::make_mut(&mut params.materials);
        for &id in &self.materials {
            if let Some(material) = materials.get_mut(id as usize) {
                material.roughness = roughness;
            }
        }
        Some(params)
    }

    /// When a cell is good enough.
    pub fn rule(&self) -> StopRule {
        StopRule { wanted: self.error }
    }

    /// Whether it can be made: its size, its memory, its parameters.
    pub fn check(&self) -> Result<(), SheetError> {
        if self.is_empty() {
            return Err(SheetError::Empty);
        }
        self.params.check()?;
        // A cell's mean and error, all of which are kept, and of one all sums.
        let [width, height] = self.params.size.map(u64::from);
        let kept = (width * height).saturating_mul(self.len() as u64 * 32);
        let [across, down] = layout(&self.laid_out(&[])).size;
        if across.max(down) > PICTURE_SIDE {
            return Err(SheetError::Size(across, down));
        }
        let sheet = u64::from(across) * u64::from(down) * 4;
        let need =
            self.params.bytes_after(self.most_passes).saturating_add(kept).saturating_add(sheet);
        fits(need, || {
            format!("a contact sheet of {} pictures of {width}x{height} pixels", self.len())
        })?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Material, SceneBuilder};

    fn sheet() -> Sheet {
        let mut builder = SceneBuilder::new("two");
        for (name, x) in [("left", -1.0), ("right", 1.0)] {
            let m = Material::reflecting(name, [0.5; 3], [0.2; 3], 30.0).unwrap();
            let id = builder.material(m);
            builder.sphere(glam::DVec3::new(x, 0.0, 0.0), 0.9, id).unwrap();
        }
        builder.environment = [1.0; 3];
        Sheet::new(Params { size: [8, 6], ..Params::new(Arc::new(builder.build())) })
    }

    #[test]
    fn cells_go_row_by_row_and_change_the_materials_that_are_named() {
        let mut sheet = sheet();
        assert_eq!(sheet.len(), 15);
        let cell = sheet.cell(7).unwrap();
        assert_eq!(cell.model, Model::ALL[1]);
        assert!(cell.materials.iter().all(|m| m.roughness.alpha() == 0.2));
        assert_eq!(cell, {
            let all = Roughness::from_alpha(0.2).unwrap();
            Params { model: Model::ALL[1], ..sheet.params.clone() }.with_roughness(all)
        });
        sheet.materials = vec![1];
        let alphas = |sheet: &Sheet, cell| {
            sheet.cell(cell).unwrap().materials.iter().map(|m| m.roughness.alpha()).collect()
        };
        let found: Vec<f64> = alphas(&sheet, 0);
        assert_eq!(found, [Roughness::from_exponent(30.0).unwrap().alpha(), 0.05]);
        assert!(sheet.cell(15).is_none() && sheet.of(15).is_none());
    }

    #[test]
    fn cells_are_called_by_the_number_that_was_given() {
        let mut sheet = sheet();
        // Of both numbers here one is as round as the other.
        sheet.roughnesses = vec![Roughness::from_alpha(0.5).unwrap()];
        assert_eq!(
            (sheet.name(2), sheet.title(0)),
            ("ggx_alpha_0p5".into(), "Phong, alpha 0.5".into())
        );
        sheet.by_exponent = true;
        assert_eq!((sheet.name(1), sheet.title(2)), ("beckmann_ap_6".into(), "GGX, a_p 6".into()));
        assert_eq!((sheet.name(3), sheet.title(3)), (String::new(), String::new()));
    }

    #[test]
    fn a_cell_keeps_the_shape_of_its_picture() {
        for (size, expected) in [
            ([640, 480], [320, 240]),
            ([1920, 1080], [320, 180]),
            ([100, 1000], [24, 240]),
            ([64, 48], [64, 48]),
            ([30_000, 1], [320, 1]),
        ] {
            assert_eq!(Sheet::fitted(size), expected, "{size:?}");
        }
    }

    #[test]
    fn what_cannot_be_made_is_known_before() {
        assert_eq!(sheet().check(), Ok(()));
        let none = Sheet { models: Vec::new(), ..sheet() };
        assert_eq!(none.check(), Err(SheetError::Empty));
        let mut wide = sheet();
        wide.params.size = [30_000, 2];
        assert!(matches!(wide.check(), Err(SheetError::Size(..))));
        let mut bad = sheet();
        bad.params.max_depth = Some(0);
        assert_eq!(bad.check(), Err(SheetError::Params(ParamsError::Depth)));
    }
}
