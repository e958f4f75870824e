//! Pictures: the tone curve, files in and out.

mod atomic;
mod codes;
mod dither;
mod exr_file;
mod exr_parts;
mod exr_tables;
mod files;
mod format;
mod letters;
mod neutral;
mod primaries;
pub mod sheet;
mod tone;

pub use atomic::{Sink, check_writable, replace_file};
pub use codes::{Codes, Place};
pub use exr_file::ReadPicture;
pub use exr_parts::{Part, write_parts};
pub use exr_tables::{Fill, ReadTable, ReadTables, Table, read_tables, write_with_tables};
pub use files::{FoundRecipe, write, write_codes, write_with_recipe, write_with_samples};
pub use files::{ReadError, contents, read_exr, read_exr_part, read_recipe, read_recipe_of};
pub use format::{Format, SaveError};
pub use letters::Face;
pub use tone::{Curve, NAN_COLOUR, Tone};

/// Radiance of every pixel, linear Rec. 709, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// `width * height` pixels, row by row.
    pub pixels: Vec<[f32; 3]>,
}

impl Picture {
    /// All zeros.
    pub fn black(width: u32, height: u32) -> Picture {
        Picture { width, height, pixels: vec![[0.0; 3]; width as usize * height as usize] }
    }
}
