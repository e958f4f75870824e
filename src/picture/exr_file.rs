//! OpenEXR files read: which of the pictures in a file is meant, and its pixels.
//!
//! A file may hold several pictures: parts, each with a name, and in a part layers, whose channels
//! are called `beauty.R` and so on. A picture is three channels that are called R, G and B in upper
//! or lower case or by their words, or one that is called Y: grey. What a header claims is held
//! against the length of the file before anything is allocated.

use super::Picture;
use super::primaries::{Primaries, REC_709};
use crate::limits::{Bytes, EXR_EXPANSION, EXR_FREE_BYTES, PICTURE_SIDE, fits};
use exr::block::UncompressedBlock;
use exr::block::reader::{ChunksReader, Reader};
use exr::meta::attribute::{ChannelList, SampleType};
use exr::meta::header::Header;
use exr::prelude::f16;
use std::fs::File;
use std::io::{BufReader, Read, Seek};

/// Largest width and height that is read: the largest that is rendered.
pub(super) const LARGEST_SIDE: usize = PICTURE_SIDE as usize;

/// Names of the parts of an OpenEXR file that has more than the picture: this, and how many samples
/// each pixel is made of.
pub(super) const COLOUR_PART: &str = "rgb";
pub(super) const SAMPLES_PART: &str = "samples";

/// What was read and what is to be told about it.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadPicture {
    /// Linear Rec. 709.
    pub picture: Picture,
    /// Which of several pictures it is, and what was made of its channels and colours.
    pub remarks: Vec<String>,
    /// How many pictures the file has to choose from.
    pub choices: usize,
}

/// One of the pictures in a file.
struct Choice {
    header: usize,
    part: Option<String>,
    /// What stands before the channels' last dot.
    layer: Option<String>,
    /// The places of red, green and blue among the header's channels.
    channels: [usize; 3],
}

impl Choice {
    /// What it is called.
    fn name(&self) -> String {
        match (&self.part, &self.layer) {
            (Some(part), Some(layer)) => format!("{part}.{layer}"),
            (Some(name), None) | (None, Some(name)) => name.clone(),
            (None, None) => String::new(),
        }
    }

    /// Whether this is what `wanted` names: the part, the layer, or both with a dot between.
    fn is(&self, wanted: &str, equal: fn(&str, &str) -> bool) -> bool {
        let name = self.name();
        [self.part.as_deref(), self.layer.as_deref(), Some(&name)]
            .into_iter()
            .flatten()
            .any(|name| equal(name, wanted))
    }
}

/// A name from the file for a message: short, and without characters that steer a terminal.
fn shown(name: &str) -> String {
    const LONGEST: usize = 60;
    let mut text: String = name.chars().take(LONGEST).flat_map(char::escape_debug).collect();
    if name.chars().nth(LONGEST).is_some() {
        text.push('…');
    }
    text
}

/// The first few of them, comma by comma.
fn listed(names: impl Iterator<Item = String>) -> String {
    const MOST: usize = 12;
    let mut names: Vec<String> = names.take(MOST + 1).collect();
    if names.len() > MOST {
        names.truncate(MOST);
        names.push("…".to_owned());
    }
    names.join(", ")
}

pub(super) fn part_name(header: &Header) -> Option<String> {
    let name = header.own_attributes.layer_name.as_ref()?;
    let name = String::from_utf8_lossy(name.as_slice()).into_owned();
    (!name.is_empty()).then_some(name)
}

fn channel_names(header: &Header) -> Vec<String> {
    let name = |c: &exr::meta::attribute::ChannelDescription| {
        String::from_utf8_lossy(c.name.as_slice()).into_owned()
    };
    header.channels.list.iter().map(name).collect()
}

/// What the file has: each part with its channels.
pub(super) fn contents(headers: &[Header]) -> String {
    let part = |header: &Header| {
        let channels = listed(channel_names(header).iter().map(|name| shown(name)));
        let deep = if header.deep { "deep: " } else { "" };
        match part_name(header) {
            Some(name) => format!("part `{}` ({deep}{channels})", shown(&name)),
            None => format!("channels {deep}{channels}"),
        }
    };
    listed(headers.iter().map(part))
}

/// The place of a colour among the channels of a layer.
fn colour(layer: &[(usize, &str)], names: [&str; 3]) -> Option<usize> {
    let found = |name: &str| layer.iter().find(|(_, own)| *own == name).map(|(at, _)| *at);
    let any_case = |name: &&str| {
        layer.iter().find(|(_, own)| own.eq_ignore_ascii_case(name)).map(|(at, _)| *at)
    };
    names.iter().find_map(|name| found(name)).or_else(|| names.iter().find_map(any_case))
}

/// The pictures that a file has, in its order.
fn choices(headers: &[Header]) -> Vec<Choice> {
    let mut choices = Vec::new();
    for (index, header) in headers.iter().enumerate().filter(|(_, header)| !header.deep) {
        let names = channel_names(header);
        // Layers with their channels; those without a layer are the part's own picture.
        let mut layers: Vec<(&str, Vec<(usize, &str)>)> = vec![("", Vec::new())];
        for (at, name) in names.iter().enumerate() {
            let (layer, own) = name.rsplit_once('.').unwrap_or(("", name));
            match layers.iter_mut().find(|(known, _)| *known == layer) {
                Some((_, channels)) => channels.push((at, own)),
                None => layers.push((layer, vec![(at, own)])),
            }
        }
        for (layer, channels) in layers {
            let [red, green, blue] = [["R", "red", "r"], ["G", "green", "g"], ["B", "blue", "b"]]
                .map(|names| colour(&channels, names));
            let grey = || colour(&channels, ["Y", "luminance", "y"]).map(|y| [y; 3]);
            let channels = match (red, green, blue) {
                (Some(r), Some(g), Some(b)) => Some([r, g, b]),
                _ => grey(),
            };
            if let Some(channels) = channels {
                let layer = (!layer.is_empty()).then(|| layer.to_owned());
                choices.push(Choice { header: index, part: part_name(header), layer, channels });
            }
        }
    }
    choices
}

/// The choice that is wanted, or else the first.
fn choose(headers: &[Header], wanted: Option<&str>) -> Result<(Choice, usize), String> {
    let mut all = choices(headers);
    // How many samples a picture is made of is none, unless it is what is wanted.
    let is_count = |c: &Choice| c.part.as_deref() == Some(SAMPLES_PART) && c.layer.is_none();
    if wanted != Some(SAMPLES_PART) && all.len() > 1 {
        all.retain(|c| !is_count(c));
    }
    let count = all.len();
    let has = || format!("the file has {}", contents(headers));
    if count == 0 {
        return Err(format!("no red, green and blue, and no Y: {}", has()));
    }
    let at = match wanted {
        // A file of one picture need not call it by a name.
        None => Some(0),
        Some(_) if count == 1 && headers.len() == 1 => Some(0),
        Some(name) => all
            .iter()
            .position(|c| c.is(name, |a, b| a == b))
            .or_else(|| all.iter().position(|c| c.is(name, |a, b| a.eq_ignore_ascii_case(b)))),
    };
    match (at, wanted) {
        (Some(at), _) => Ok((all.swap_remove(at), count)),
        (None, name) => {
            let name = shown(name.unwrap_or_default());
            Err(format!("no picture in it is called `{name}`: {}", has()))
        }
    }
}

/// Reads the picture that is wanted from an open file of `length` bytes.
pub(super) fn read(
    file: BufReader<File>,
    length: u64,
    wanted: Option<&str>,
) -> Result<ReadPicture, String> {
    let again = file.get_ref().try_clone();
    let reader = Reader::read_from_buffered(file, false).map_err(|e| {
        // Such as chroma with fewer samples than luminance.
        match again.ok().map(channels_of_a_header) {
            Some(names) if !names.is_empty() => format!("{e}: the file has channels {names}"),
            _ => e.to_string(),
        }
    })?;
    let headers = reader.headers();
    let (choice, count) = choose(headers, wanted)?;
    let header = headers.get(choice.header).ok_or("it has no such part")?;
    check_size(header, length)?;
    let mut remarks = remarks(headers, &choice, count);
    let primaries = primaries(header);
    let mut picture = pixels(reader, &choice, &mut remarks)?;
    match primaries {
        Some(primaries) if primaries.is(&REC_709) => {}
        Some(primaries) => match primaries.to_rec_709() {
            Some(matrix) => {
                picture.pixels.iter_mut().for_each(|rgb| *rgb = matrix.of(*rgb));
                remarks.push(format!("its colours have {primaries}: converted to Rec. 709"));
            }
            None => remarks.push(format!(
                "its chromaticities ({primaries}) make no colours: read as Rec. 709"
            )),
        },
        None => {}
    }
    Ok(ReadPicture { picture, remarks, choices: count })
}

/// The channels of a file whose header is not understood as a whole, as far as they can be found.
fn channels_of_a_header(mut file: File) -> String {
    const BEFORE: &[u8] = b"channels\0chlist\0";
    let mut start = Vec::new();
    let read = file.rewind().and_then(|()| file.take(1 << 16).read_to_end(&mut start));
    let at = start.windows(BEFORE.len()).position(|window| window == BEFORE);
    let (Ok(_), Some(at)) = (read, at) else { return String::new() };
    // Behind the list's length: each name with a zero, then its type and samplings.
    let mut rest = start.get(at + BEFORE.len() + 4..).unwrap_or(&[]);
    let names = std::iter::from_fn(|| {
        let end = rest.iter().position(|&b| b == 0).filter(|&end| end > 0)?;
        let name = shown(&String::from_utf8_lossy(rest.get(..end)?));
        rest = rest.get(end + 1 + 16..)?;
        Some(name)
    });
    listed(names)
}

/// What is to be told of the picture that was chosen.
fn remarks(headers: &[Header], choice: &Choice, count: usize) -> Vec<String> {
    let mut remarks = Vec::new();
    // Nor are tables of whole numbers.
    let is_table = |h: &Header| h.channels.list.iter().all(|c| c.sample_type == SampleType::U32);
    let of_samples = |h: &Header| part_name(h).as_deref() == Some(SAMPLES_PART);
    if count > 1 || headers.iter().filter(|h| !of_samples(h) && !is_table(h)).count() > 1 {
        let name = shown(&choice.name());
        let name = if name.is_empty() {
            "the one without a layer".to_owned()
        } else {
            format!("`{name}`")
        };
        remarks.push(format!("of the pictures in it {name} is read: it has {}", contents(headers)));
    }
    let names = headers.get(choice.header).map(channel_names).unwrap_or_default();
    let names = choice.channels.map(|at| names.get(at).cloned().unwrap_or_default());
    let own = |name: &str| name.rsplit_once('.').map_or(name.to_owned(), |(_, own)| own.to_owned());
    if names[0] == names[1] {
        remarks.push(format!("its channel {} is read as grey", shown(&names[0])));
    } else if names.each_ref().map(|name| own(name)) != ["R", "G", "B"]
        || count == 1 && names[0] != "R"
    {
        let [r, g, b] = names.map(|name| shown(&name));
        remarks.push(format!("its channels {r}, {g}, {b} are read as R, G, B"));
    }
    remarks
}

/// Refuses sizes that are beyond those rendered or that the file's length cannot explain.
fn check_size(header: &Header, length: u64) -> Result<(), String> {
    let display = header.shared_attributes.display_window.size;
    let mut bytes = 0;
    let per_pixel = header.channels.bytes_per_pixel.max(size_of::<[f32; 3]>()) as u64;
    for (what, size) in [("picture", display), ("data window", header.layer_size)] {
        let (width, height) = (size.width(), size.height());
        if width.max(height) > LARGEST_SIDE {
            return Err(format!("the header claims a {what} of {width}x{height} pixels"));
        }
        bytes = bytes.max((width as u64 * height as u64).saturating_mul(per_pixel));
    }
    let (width, height) = (display.width(), display.height());
    let most = EXR_FREE_BYTES.max(length.saturating_mul(EXR_EXPANSION));
    if bytes > most {
        return Err(format!(
            "the header claims {width}x{height} pixels with {} of samples, and of a file of {length} \
             bytes no more than {} are taken",
            Bytes(bytes),
            Bytes(most)
        ));
    }
    // The samples as they are packed and unpacked, and the picture made of them.
    let what = || format!("a picture of {width}x{height} pixels");
    fits(bytes.saturating_mul(2), what).map_err(|e| e.to_string())
}

fn primaries(header: &Header) -> Option<Primaries> {
    let c = header.shared_attributes.chromaticities.as_ref()?;
    let point = |p: exr::math::Vec2<f32>| [f64::from(p.0), f64::from(p.1)];
    Some(Primaries { colours: [c.red, c.green, c.blue].map(point), white: point(c.white) })
}

/// The display window's pixels; those outside the data window are black.
fn pixels(
    reader: Reader<BufReader<File>>,
    choice: &Choice,
    remarks: &mut Vec<String>,
) -> Result<Picture, String> {
    let header = reader.headers().get(choice.header).ok_or("it has no such part")?.clone();
    let display = header.shared_attributes.display_window;
    let mut canvas = Canvas {
        size: [display.size.width(), display.size.height()],
        offset: [
            i64::from(header.own_attributes.layer_position.x()) - i64::from(display.position.x()),
            i64::from(header.own_attributes.layer_position.y()) - i64::from(display.position.y()),
        ],
        pixels: Vec::new(),
        outside: 0,
    };
    let area = canvas.size[0] * canvas.size[1];
    canvas.pixels.try_reserve_exact(area).map_err(|e| e.to_string())?;
    canvas.pixels.resize(area, [0.0; 3]);
    let wanted = header.layer_size.width() * header.layer_size.height();
    let mut found: usize = 0;
    // In the order of the file: its table of offsets may be missing where a writer was stopped.
    let mut chunks = reader.all_chunks(false).map_err(|e| e.to_string())?;
    let meta_data = chunks.meta_data().clone();
    while found < wanted {
        let Some(chunk) = chunks.read_next_chunk() else { break };
        let chunk = chunk.map_err(|e| e.to_string())?;
        if chunk.layer_index != choice.header {
            continue;
        }
        let block = UncompressedBlock::decompress_chunk(chunk, &meta_data, false)
            .map_err(|e| e.to_string())?;
        if block.index.level.0 != 0 || block.index.level.1 != 0 {
            continue;
        }
        let area = block.index.pixel_size.width() * block.index.pixel_size.height();
        if block.data.len() != area * header.channels.bytes_per_pixel {
            return Err("a block of its pixels has the wrong length".to_owned());
        }
        found = found.saturating_add(area);
        canvas.put(&block, &header.channels, choice.channels)?;
    }
    if found < wanted {
        return Err(format!("{} of its {wanted} pixels are missing", wanted - found));
    }
    if canvas.outside > 0 {
        remarks.push(format!(
            "{} of its {wanted} pixels lie outside its display window and are left out",
            canvas.outside
        ));
    }
    let [width, height] = canvas.size.map(|side| side as u32);
    Ok(Picture { width, height, pixels: canvas.pixels })
}

/// The picture in the making.
struct Canvas {
    size: [usize; 2],
    /// From the data window's corner to the display window's.
    offset: [i64; 2],
    pixels: Vec<[f32; 3]>,
    /// Pixels beyond the display window.
    outside: usize,
}

impl Canvas {
    fn put(
        &mut self,
        block: &UncompressedBlock,
        channels: &ChannelList,
        wanted: [usize; 3],
    ) -> Result<(), String> {
        let mut samples: Vec<f32> = Vec::new();
        for line in block.lines(channels) {
            let places: Vec<usize> =
                (0..3).filter(|&c| wanted[c] == line.location.channel).collect();
            let Some(channel) = channels.list.get(line.location.channel) else { continue };
            if places.is_empty() {
                continue;
            }
            samples.clear();
            let read = match channel.sample_type {
                SampleType::F16 => {
                    line.read_samples::<f16>().try_for_each(|x| x.map(|x| samples.push(x.to_f32())))
                }
                SampleType::F32 => {
                    line.read_samples::<f32>().try_for_each(|x| x.map(|x| samples.push(x)))
                }
                SampleType::U32 => {
                    line.read_samples::<u32>().try_for_each(|x| x.map(|x| samples.push(x as f32)))
                }
            };
            read.map_err(|e| e.to_string())?;
            let at = line.location.position;
            let (x, y) = (at.0 as i64 + self.offset[0], at.1 as i64 + self.offset[1]);
            self.line([x, y], &samples, &places);
        }
        Ok(())
    }

    /// Puts the samples of a line into these channels, as far as there is a picture.
    fn line(&mut self, [x, y]: [i64; 2], samples: &[f32], places: &[usize]) {
        let [width, height] = self.size.map(|side| side as i64);
        let first = (-x).clamp(0, samples.len() as i64);
        let end = (width - x).clamp(first, samples.len() as i64);
        let inside = if (0..height).contains(&y) { first..end } else { 0..0 };
        if places.contains(&0) {
            self.outside += samples.len() - (inside.end - inside.start) as usize;
        }
        for at in inside {
            let pixel = self.pixels.get_mut((y * width + x + at) as usize);
            if let (Some(pixel), Some(&sample)) = (pixel, samples.get(at as usize)) {
                places.iter().for_each(|&place| pixel[place] = sample);
            }
        }
    }
}
