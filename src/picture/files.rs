//! PNG and OpenEXR files.

use super::{Picture, SaveError, Sink, Tone, replace_file};
use exr::meta::attribute::{AttributeValue, Text};
use exr::prelude::{MetaData, SpecificChannels, Vec2, WritableImage};
use image::{ImageFormat, ImageReader, Limits};
use std::fs::File;
use std::io::{self, BufReader};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// The kinds of file that pictures are written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// 8-bit sRGB, tone-mapped and dithered: for looking at.
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
    /// It is neither a PNG nor an OpenEXR file, or a broken one.
    #[error("{}: {reason}; only .png and .exr files have recipes", .path.display())]
    Recipe {
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

/// What files name as the program that wrote them.
const SOFTWARE: &str = concat!("burnish ", env!("CARGO_PKG_VERSION"));
/// What the recipe is called: the keyword of an iTXt chunk, or the name of an EXR attribute.
const RECIPE: &str = "burnish";

/// Writes a picture, the format chosen by the file's name. The file is there as a whole or, after
/// an error, as it was before.
pub fn write(path: &Path, picture: &Picture, tone: Tone) -> Result<(), SaveError> {
    write_to(path, picture, tone, None)
}

/// The same with a text beside the pixels that says how they were made; [`read_recipe`] gives it
/// back. In a PNG it is an iTXt chunk, in an OpenEXR file an attribute of type string, both named
/// `burnish` and both UTF-8, so that any program which shows such things can show it.
pub fn write_with_recipe(
    path: &Path,
    picture: &Picture,
    tone: Tone,
    recipe: &str,
) -> Result<(), SaveError> {
    write_to(path, picture, tone, Some(recipe))
}

fn write_to(
    path: &Path,
    picture: &Picture,
    tone: Tone,
    recipe: Option<&str>,
) -> Result<(), SaveError> {
    let format = Format::of(path)?;
    replace_file(path, |sink| {
        let Picture { width, height, pixels } = picture;
        if pixels.is_empty() || pixels.len() as u64 != u64::from(*width) * u64::from(*height) {
            let count = pixels.len();
            let text = format!("{count} pixels do not make a picture of {width}x{height}");
            return Err(io::Error::new(io::ErrorKind::InvalidInput, text));
        }
        match format {
            Format::Png => as_png(picture, tone, recipe, sink).map_err(|e| match e {
                png::EncodingError::IoError(e) => e,
                other => io::Error::other(other),
            }),
            Format::Exr => as_exr(picture, recipe, sink),
        }
    })
}

fn as_png(
    picture: &Picture,
    tone: Tone,
    recipe: Option<&str>,
    sink: &mut dyn Sink,
) -> Result<(), png::EncodingError> {
    let mut encoder = png::Encoder::new(sink, picture.width, picture.height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.add_text_chunk("Software".to_owned(), SOFTWARE.to_owned())?;
    if let Some(recipe) = recipe {
        encoder.add_itxt_chunk(RECIPE.to_owned(), recipe.to_owned())?;
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(tone.dithered(picture).as_flattened())?;
    writer.finish()
}

fn as_exr(picture: &Picture, recipe: Option<&str>, sink: &mut dyn Sink) -> io::Result<()> {
    let size = Vec2(picture.width as usize, picture.height as usize);
    let channels = SpecificChannels::rgb(|at: Vec2<usize>| {
        let [r, g, b] = picture.pixels[at.flat_index_for_size(size)];
        (r, g, b)
    });
    let mut image = exr::prelude::Image::from_channels(size, channels);
    let attributes = &mut image.layer_data.attributes;
    attributes.software_name = Some(text(SOFTWARE));
    if let Some(recipe) = recipe {
        attributes.other.insert(text(RECIPE), AttributeValue::Text(text(recipe)));
    }
    image.write().to_buffered(sink).map_err(|e| match e {
        exr::error::Error::Io(e) => e,
        other => io::Error::other(other.to_string()),
    })
}

/// UTF-8, as OpenEXR has it; the crate's own conversion takes Latin-1 alone.
fn text(utf8: &str) -> Text {
    Text::from_slice_unchecked(utf8.as_bytes())
}

/// The recipe that is written beside the pixels of a PNG or OpenEXR file; `None` if there is none,
/// as in pictures of other programs.
pub fn read_recipe(path: &Path) -> Result<Option<String>, ReadError> {
    let content = |reason: String| ReadError::Recipe { path: path.to_path_buf(), reason };
    let format = Format::of(path).map_err(|_| content("unknown kind of picture".to_owned()))?;
    let file =
        File::open(path).map_err(|source| ReadError::Open { path: path.to_path_buf(), source })?;
    let file = BufReader::new(file);
    match format {
        Format::Png => png_recipe(file).map_err(|e| content(e.to_string())),
        Format::Exr => exr_recipe(file).map_err(|e| content(e.to_string())),
    }
}

fn png_recipe(file: BufReader<File>) -> Result<Option<String>, png::DecodingError> {
    let reader = png::Decoder::new(file).read_info()?;
    let mut chunks = reader.info().utf8_text.iter();
    chunks.find(|chunk| chunk.keyword == RECIPE).map(|chunk| chunk.get_text()).transpose()
}

fn exr_recipe(file: BufReader<File>) -> exr::error::Result<Option<String>> {
    let name = text(RECIPE);
    let headers = MetaData::read_from_buffered(file, false)?.headers;
    let attributes = headers.iter().flat_map(|header| {
        [&header.own_attributes.other, &header.shared_attributes.other].map(|all| all.get(&name))
    });
    let recipe = attributes.flatten().find_map(|value| match value {
        AttributeValue::Text(text) => Some(String::from_utf8_lossy(text.as_slice()).into_owned()),
        _ => None,
    });
    Ok(recipe)
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
