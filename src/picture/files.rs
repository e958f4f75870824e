//! PNG and OpenEXR files.

use super::{Picture, SaveError, Tone, replace_file};
use image::{ImageError, ImageFormat, ImageReader, Limits, Rgb32FImage, RgbImage};
use std::fs::File;
use std::io::{self, BufReader};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// The kinds of file that pictures are written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// 8-bit sRGB, tone-mapped: for looking at.
    Png,
    /// OpenEXR with the radiance itself in channels R, G, B, 32-bit float, linear Rec. 709: for
    /// measuring. Neither exposure nor curve goes into it.
    Exr,
}

impl Format {
    /// What a file's name may end in.
    pub const NAMES: &str = ".png (8-bit sRGB) or .exr (linear 32-bit float)";

    /// By the extension of the file's name, in upper or lower case.
    pub fn of(path: &Path) -> Result<Format, SaveError> {
        match path.extension().map(|e| e.to_ascii_lowercase()) {
            Some(e) if e == "png" => Ok(Format::Png),
            Some(e) if e == "exr" => Ok(Format::Exr),
            _ => Err(SaveError::Format(path.to_path_buf())),
        }
    }
}

/// A picture file that could not be read.
#[derive(Debug, Error)]
pub enum ReadError {
    /// It is not there, or may not be read.
    #[error("{}: cannot be opened: {source}", .path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// It is broken, too large, or something else altogether.
    #[error(
        "{}: {reason}; only OpenEXR pictures with channels R, G, B of up to {side} pixels a side \
         and 1 GiB of samples are read", .path.display(), side = LARGEST_SIDE
    )]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
}

/// Largest width and height that is read.
const LARGEST_SIDE: u32 = 16_384;
/// Most bytes that the samples of a picture being read may take.
const MOST_BYTES: u64 = 1 << 30;

/// Writes a picture, the format chosen by the file's name. The file is there as a whole or, after
/// an error, as it was before.
pub fn write(path: &Path, picture: &Picture, tone: Tone) -> Result<(), SaveError> {
    let format = Format::of(path)?;
    replace_file(path, |mut sink| {
        match format {
            Format::Png => as_png(picture, tone)?.write_to(&mut sink, ImageFormat::Png),
            Format::Exr => as_exr(picture)?.write_to(&mut sink, ImageFormat::OpenExr),
        }
        .map_err(|e| match e {
            ImageError::IoError(e) => e,
            other => io::Error::other(other),
        })
    })
}

fn as_png(picture: &Picture, tone: Tone) -> io::Result<RgbImage> {
    let mut codes = vec![[0; 3]; picture.pixels.len()];
    tone.rgb8(&picture.pixels, &mut codes);
    RgbImage::from_raw(picture.width, picture.height, codes.into_flattened())
        .filter(|image| !image.is_empty())
        .ok_or_else(|| wrong_size(picture))
}

fn as_exr(picture: &Picture) -> io::Result<Rgb32FImage> {
    let samples = picture.pixels.as_flattened().to_vec();
    Rgb32FImage::from_raw(picture.width, picture.height, samples)
        .filter(|image| !image.is_empty())
        .ok_or_else(|| wrong_size(picture))
}

fn wrong_size(picture: &Picture) -> io::Error {
    let Picture { width, height, pixels } = picture;
    let text = format!("{} pixels do not make a picture of {width}x{height}", pixels.len());
    io::Error::new(io::ErrorKind::InvalidInput, text)
}

/// Reads the R, G, B channels of an OpenEXR file as they are, NaN and infinity included. Other
/// channels are left out.
///
/// At most 16384 pixels a side and 1 GiB of samples are read: a small file can claim to hold a
/// huge picture.
pub fn read_exr(path: &Path) -> Result<Picture, ReadError> {
    let file =
        File::open(path).map_err(|source| ReadError::Open { path: path.to_path_buf(), source })?;
    let mut reader = ImageReader::with_format(BufReader::new(file), ImageFormat::OpenExr);
    let mut limits = Limits::default();
    limits.max_image_width = Some(LARGEST_SIDE);
    limits.max_image_height = Some(LARGEST_SIDE);
    limits.max_alloc = Some(MOST_BYTES);
    reader.limits(limits);
    let image = reader
        .decode()
        .map_err(|e| ReadError::Content { path: path.to_path_buf(), reason: e.to_string() })?
        .into_rgb32f();
    let (width, height) = image.dimensions();
    let (pixels, _) = image.as_raw().as_chunks();
    Ok(Picture { width, height, pixels: pixels.to_vec() })
}
