//! PNG and OpenEXR files.

use super::exr_file::{self, COLOUR_PART, LARGEST_SIDE, ReadPicture, SAMPLES_PART};
use super::{Codes, Format, Picture, SaveError, Sink, Tone, replace_file};
use crate::limits::TEXT_BYTES;
use crate::plain;
use exr::meta::attribute::{AttributeValue, Text};
use exr::meta::header::Header;
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, ImageAttributes, IntegerBounds, Layer,
    LayerAttributes, Layers, MetaData, SmallVec, SpecificChannels, Vec2, WritableImage,
};
use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// A picture file that could not be read.
#[derive(Debug, Error)]
pub enum ReadError {
    /// It is not there, or may not be read.
    #[error("{}: cannot be opened: {source}", plain::path(.path))]
    Open {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// It is broken, too large, or something else altogether.
    #[error(
        "{}: {reason}; only OpenEXR pictures of up to {side} pixels a side are read",
        plain::path(.path), side = LARGEST_SIDE
    )]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// It is neither a PNG nor an OpenEXR file, or a broken one.
    #[error("{}: {reason}; only .png and .exr files have recipes", plain::path(.path))]
    Recipe {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
}

/// What files name as the program that wrote them.
const SOFTWARE: &str = concat!("burnish ", env!("CARGO_PKG_VERSION"));
/// What the recipe is called: the keyword of an iTXt chunk, or the name of an EXR attribute.
const RECIPE: &str = "burnish";
/// The program, as it stands in files.
pub(super) fn software() -> Text {
    text(SOFTWARE)
}

/// Writes a picture, the format chosen by the file's name. The file is there as a whole or, after
/// an error, as it was before.
pub fn write(path: &Path, picture: &Picture, tone: Tone) -> Result<(), SaveError> {
    write_to(path, picture, tone, None, &[])
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
    write_to(path, picture, tone, Some(recipe), &[])
}

/// The same with the number of samples of each pixel, row by row: in an OpenEXR file a second part,
/// `samples`, with one channel; a PNG has no place for it.
pub fn write_with_samples(
    path: &Path,
    picture: &Picture,
    tone: Tone,
    recipe: &str,
    samples: &[u64],
) -> Result<(), SaveError> {
    write_to(path, picture, tone, Some(recipe), samples)
}

fn write_to(
    path: &Path,
    picture: &Picture,
    tone: Tone,
    recipe: Option<&str>,
    samples: &[u64],
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
            Format::Png => as_png(picture, tone, recipe, sink).map_err(png_error),
            Format::Exr => as_exr(picture, recipe, samples, sink),
        }
    })
}

fn as_png(
    picture: &Picture,
    tone: Tone,
    recipe: Option<&str>,
    sink: &mut dyn Sink,
) -> Result<(), png::EncodingError> {
    let text = recipe.map(|recipe| (RECIPE, recipe));
    codes_as_png([picture.width, picture.height], &tone.dithered(picture), text, sink)
}

fn codes_as_png(
    [width, height]: [u32; 2],
    codes: &[[u8; 3]],
    text: Option<(&str, &str)>,
    sink: &mut dyn Sink,
) -> Result<(), png::EncodingError> {
    let mut encoder = png::Encoder::new(sink, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.add_text_chunk("Software".to_owned(), SOFTWARE.to_owned())?;
    if let Some((keyword, text)) = text {
        encoder.add_itxt_chunk(keyword.to_owned(), text.to_owned())?;
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(codes.as_flattened())?;
    writer.finish()
}

/// Writes colours as they are to a `.png` file, with words about them as its `Description`, a text chunk
/// that other programs show. The file is there as a whole or, after an error, as it was before.
pub fn write_codes(path: &Path, codes: &Codes, description: &str) -> Result<(), SaveError> {
    if Format::of(path)? != Format::Png {
        return Err(SaveError::Format(path.to_path_buf()));
    }
    let Codes { width, height, pixels } = codes;
    let text = Some(("Description", description));
    replace_file(path, |sink| {
        codes_as_png([*width, *height], pixels, text, sink).map_err(png_error)
    })
}

fn png_error(error: png::EncodingError) -> io::Error {
    match error {
        png::EncodingError::IoError(e) => e,
        other => io::Error::other(other),
    }
}

fn as_exr(
    picture: &Picture,
    recipe: Option<&str>,
    samples: &[u64],
    sink: &mut dyn Sink,
) -> io::Result<()> {
    let size = Vec2(picture.width as usize, picture.height as usize);
    if samples.len() == picture.pixels.len() {
        let colour = |c: usize| FlatSamples::F32(picture.pixels.iter().map(|p| p[c]).collect());
        let counts = FlatSamples::F32(samples.iter().map(|&n| n as f32).collect());
        let rgb = [("R", colour(0)), ("G", colour(1)), ("B", colour(2))];
        // A part of its own: programs that know one part alone read the first, which is the picture.
        let mut parts = [
            part(
                size,
                COLOUR_PART,
                rgb.into_iter().map(|(n, all)| AnyChannel::new(n, all)).collect(),
            ),
            part(size, SAMPLES_PART, [AnyChannel::new("Y", counts)].into_iter().collect()),
        ];
        describe(&mut parts[0].attributes, recipe);
        let bounds = IntegerBounds::from_dimensions(size);
        let image = Image::from_layers(ImageAttributes::new(bounds), Layers::from_iter(parts));
        return image.write().to_buffered(sink).map_err(exr_error);
    }
    let channels = SpecificChannels::rgb(|at: Vec2<usize>| {
        let [r, g, b] = picture.pixels[at.flat_index_for_size(size)];
        (r, g, b)
    });
    let mut image = Image::from_channels(size, channels);
    describe(&mut image.layer_data.attributes, recipe);
    image.write().to_buffered(sink).map_err(exr_error)
}

pub(super) fn part(
    size: Vec2<usize>,
    name: &str,
    channels: SmallVec<[AnyChannel<FlatSamples>; 4]>,
) -> Layer<AnyChannels<FlatSamples>> {
    let attributes = LayerAttributes::named(name);
    Layer::new(size, attributes, Encoding::default(), AnyChannels::sort(channels))
}

pub(super) fn describe(attributes: &mut LayerAttributes, recipe: Option<&str>) {
    attributes.software_name = Some(software());
    if let Some(recipe) = recipe {
        attributes.other.insert(text(RECIPE), AttributeValue::Text(text(recipe)));
    }
}

pub(super) fn exr_error(error: exr::error::Error) -> io::Error {
    match error {
        exr::error::Error::Io(e) => e,
        other => io::Error::other(other.to_string()),
    }
}

/// UTF-8, as OpenEXR has it; the crate's own conversion takes Latin-1 alone.
pub(super) fn text(utf8: &str) -> Text {
    Text::from_slice_unchecked(utf8.as_bytes())
}

/// The recipe that is written beside the pixels of a PNG or OpenEXR file; `None` if there is none,
/// as in pictures of other programs.
pub fn read_recipe(path: &Path) -> Result<Option<String>, ReadError> {
    Ok(read_recipe_of(path, None)?.map(|recipe| recipe.text))
}

/// A recipe, and of which part it is where the file has several.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FoundRecipe {
    /// The recipe itself.
    pub text: String,
    /// The part's name; `None` in a file with one picture.
    pub part: Option<String>,
}

/// The same of one part of an OpenEXR file; without a part, of the first that has a recipe.
pub fn read_recipe_of(path: &Path, part: Option<&str>) -> Result<Option<FoundRecipe>, ReadError> {
    let content = |reason: String| ReadError::Recipe { path: path.to_path_buf(), reason };
    let format = Format::of(path).map_err(|_| content("unknown kind of picture".to_owned()))?;
    let file = BufReader::new(open(path)?);
    match format {
        Format::Png => {
            let text = png_recipe(file).map_err(|e| content(e.to_string()))?;
            Ok(text.map(|text| FoundRecipe { text, part: None }))
        }
        Format::Exr => exr_recipe(file, part).map_err(content),
    }
}

/// What is in a picture file, for a message: its size, and the parts and channels of an OpenEXR
/// file.
pub fn contents(path: &Path) -> Result<String, ReadError> {
    let content = |reason: String| ReadError::Recipe { path: path.to_path_buf(), reason };
    let format = Format::of(path).map_err(|_| content("unknown kind of picture".to_owned()))?;
    let file = BufReader::new(open(path)?);
    match format {
        Format::Png => {
            let reader = png_decoder(file).read_info().map_err(|e| content(e.to_string()))?;
            let png::Info { width, height, .. } = reader.info();
            Ok(format!("{width}x{height} pixels"))
        }
        Format::Exr => {
            let headers = headers(file).map_err(content)?;
            let size = headers.first().map(|h| h.shared_attributes.display_window.size);
            let size = size.unwrap_or_else(Vec2::default);
            let has = exr_file::contents(&headers);
            Ok(format!("{}x{} pixels, {has}", size.width(), size.height()))
        }
    }
}

fn open(path: &Path) -> Result<File, ReadError> {
    File::open(path).map_err(|source| ReadError::Open { path: path.to_path_buf(), source })
}

fn png_recipe(file: BufReader<File>) -> Result<Option<String>, png::DecodingError> {
    let reader = png_decoder(file).read_info()?;
    let mut chunks = reader.info().utf8_text.iter();
    let Some(chunk) = chunks.find(|chunk| chunk.keyword == RECIPE) else { return Ok(None) };
    // A thousand times as long as it is packed, if it is made to be.
    let mut chunk = chunk.clone();
    chunk.decompress_text_with_limit(TEXT_BYTES)?;
    chunk.get_text().map(Some)
}

/// A reader that takes no more memory for what stands beside the pixels than our own files need.
fn png_decoder(file: BufReader<File>) -> png::Decoder<BufReader<File>> {
    png::Decoder::new_with_limits(file, png::Limits { bytes: 4 * TEXT_BYTES })
}

fn headers(file: BufReader<File>) -> Result<Vec<Header>, String> {
    let meta_data = MetaData::read_from_buffered(file, false).map_err(|e| e.to_string())?;
    Ok(meta_data.headers.into_iter().collect())
}

fn exr_recipe(file: BufReader<File>, wanted: Option<&str>) -> Result<Option<FoundRecipe>, String> {
    let name = text(RECIPE);
    let headers = headers(file)?;
    let several = headers.len() > 1;
    let is_meant = |header: &&Header| {
        let own = exr_file::part_name(header);
        !several || wanted.is_none_or(|wanted| own.is_some_and(|own| own == wanted))
    };
    if !headers.iter().any(|header| is_meant(&header)) {
        let has = exr_file::contents(&headers);
        return Err(format!("no part in it has this name: the file has {has}"));
    }
    let recipe = headers.iter().filter(is_meant).find_map(|header| {
        let attributes = [&header.own_attributes.other, &header.shared_attributes.other];
        attributes.into_iter().find_map(|all| match all.get(&name) {
            Some(AttributeValue::Text(text)) => Some(FoundRecipe {
                text: String::from_utf8_lossy(text.as_slice()).into_owned(),
                part: exr_file::part_name(header).filter(|_| several),
            }),
            _ => None,
        })
    });
    Ok(recipe)
}

/// Reads the picture in an OpenEXR file, NaN and infinity included: of several the first. See
/// [`read_exr_part`].
pub fn read_exr(path: &Path) -> Result<Picture, ReadError> {
    read_exr_part(path, None).map(|read| read.picture)
}

/// Reads one of the pictures in an OpenEXR file, by the name of its part or layer; the first
/// without a name. A file with a single picture has that one, whatever the name.
///
/// Its channels are R, G and B in upper or lower case, or Y alone. Colours of other primaries than
/// Rec. 709 are converted, with Bradford's adaptation of the white. At most 32768 pixels a side are
/// read, and no more than the file's length explains: a small file can claim to hold a huge picture.
pub fn read_exr_part(path: &Path, part: Option<&str>) -> Result<ReadPicture, ReadError> {
    let (file, length) = open_exr(path)?;
    let content = |reason| ReadError::Content { path: path.to_path_buf(), reason };
    exr_file::read(file, length, part).map_err(content)
}

/// A file that begins as OpenEXR files do, or as nothing that is known, and its length.
pub(super) fn open_exr(path: &Path) -> Result<(BufReader<File>, u64), ReadError> {
    let file = open(path)?;
    let length = file.metadata().map_or(0, |about| about.len());
    let content = |reason| ReadError::Content { path: path.to_path_buf(), reason };
    let mut file = BufReader::new(file);
    // What cannot be looked into now cannot be read below, and is told there.
    let other = file.fill_buf().ok().and_then(|start| image::guess_format(start).ok());
    if let Some(kind) = other.filter(|kind| *kind != image::ImageFormat::OpenExr) {
        let ending = kind.extensions_str().first().unwrap_or(&"other").to_ascii_uppercase();
        return Err(content(format!("this is a {ending} file, whatever its name")));
    }
    Ok((file, length))
}
