//! Tables of whole numbers beside a picture, as further parts of its OpenEXR file.
//!
//! The format knows 32-bit whole numbers and no wider ones, so that wider ones are several
//! channels. The picture is the first part: programs that know nothing of the others show it.

use super::exr_file::{self, COLOUR_PART, part_name};
use super::files::{exr_error, open_exr, software, text};
use super::{Picture, ReadError, SaveError, Sink, replace_file};
use crate::limits::{Bytes, EXR_EXPANSION, EXR_FREE_BYTES, fits};
use exr::block::reader::{ChunksReader, Reader};
use exr::block::writer::ChunksWriter;
use exr::block::{UncompressedBlock, enumerate_ordered_header_block_indices};
use exr::meta::attribute::{AttributeValue, ChannelDescription, IntegerBounds, SampleType};
use exr::meta::header::Header;
use exr::prelude::{SmallVec, Vec2};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// Fills in numbers of a channel, by its place among a table's, from a column and row on.
pub type Fill<'a> = dyn Fn(usize, [u32; 2], &mut [u32]) + 'a;

/// A table to be written.
pub struct Table<'a> {
    /// The part's name.
    pub name: &'a str,
    /// Columns and rows.
    pub size: [u32; 2],
    /// What its channels are called, in any order.
    pub channels: Vec<String>,
    /// What is in them.
    pub fill: &'a Fill<'a>,
}

/// A table that was read.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ReadTable {
    /// The part's name.
    pub name: String,
    /// Columns and rows.
    pub size: [u32; 2],
    /// The channels' names and numbers, row by row.
    pub channels: Vec<(String, Vec<u32>)>,
}

/// What a file has beside its picture.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ReadTables {
    /// The texts that were asked for, as far as they are there.
    pub texts: Vec<Option<String>>,
    /// All parts of nothing but whole numbers.
    pub tables: Vec<ReadTable>,
}

impl ReadTables {
    /// The table of this name.
    pub fn table(&self, name: &str) -> Option<&ReadTable> {
        self.tables.iter().find(|table| table.name == name)
    }
}

impl ReadTable {
    /// The numbers of a channel.
    pub fn channel(&self, name: &str) -> Option<&[u32]> {
        self.channels.iter().find(|(own, _)| own == name).map(|(_, numbers)| numbers.as_slice())
    }
}

/// Writes a picture to an OpenEXR file, with tables as further parts, and texts as attributes: the first of
/// the picture's part, the others of a table's each, no more than there are parts. Equal content makes
/// equal files. The file is there as a whole or, after an error, as it was before.
pub fn write_with_tables(
    path: &Path,
    picture: &Picture,
    texts: &[(&str, &str)],
    tables: &[Table],
) -> Result<(), SaveError> {
    replace_file(path, |sink| as_parts(picture, texts, tables, sink).map_err(exr_error))
}

fn as_parts(
    picture: &Picture,
    texts: &[(&str, &str)],
    tables: &[Table],
    sink: &mut dyn Sink,
) -> Result<(), exr::error::Error> {
    const COLOURS: [&str; 3] = ["R", "G", "B"];
    let size = [picture.width, picture.height];
    let (mut colour, _) = header(COLOUR_PART, size, &COLOURS, SampleType::F32);
    colour.own_attributes.software_name = Some(software());
    let (mut headers, mut orders) = (vec![colour], vec![vec![2, 1, 0]]);
    for table in tables {
        let (header, order) = header(table.name, table.size, &table.channels, SampleType::U32);
        headers.push(header);
        orders.push(order);
    }
    // One a part: several would be written in an order of their own each time.
    for (header, (name, value)) in headers.iter_mut().zip(texts) {
        header.own_attributes.other.insert(text(name), AttributeValue::Text(text(value)));
    }
    let bounds = IntegerBounds::from_dimensions(vec2(size));
    headers.iter_mut().for_each(|header| header.shared_attributes.display_window = bounds);
    let mut numbers = Vec::new();
    exr::block::write(sink, headers.into_iter().collect(), true, |meta, writer| {
        let mut writer = writer.sequential_blocks_compressor(&meta);
        for (number, at) in enumerate_ordered_header_block_indices(&meta.headers) {
            let channels = &meta.headers[at.layer].channels;
            let mut failed = Ok(());
            let block = UncompressedBlock::from_lines(channels, at, |line| {
                let place = line.location;
                let [x, y] = [place.position.0, place.position.1];
                let channel = orders[at.layer][place.channel];
                let result = if at.layer == 0 {
                    let row = &picture.pixels[y * size[0] as usize + x..];
                    line.write_samples(|i| row[i][channel])
                } else {
                    numbers.clear();
                    numbers.resize(place.sample_count, 0u32);
                    (tables[at.layer - 1].fill)(channel, [x as u32, y as u32], &mut numbers);
                    line.write_samples_from_slice(&numbers)
                };
                if result.is_err() {
                    failed = result;
                }
            });
            failed?;
            writer.compress_block(number, block)?;
        }
        Ok(())
    })
}

/// The header of a part, and the places of its channels, which are sorted by name, in the list given.
fn header(
    name: &str,
    size: [u32; 2],
    channels: &[impl AsRef<str>],
    kind: SampleType,
) -> (Header, Vec<usize>) {
    let mut order: Vec<usize> = (0..channels.len()).collect();
    order.sort_by_key(|&i| channels[i].as_ref());
    let described: SmallVec<[ChannelDescription; 5]> = order
        .iter()
        .map(|&i| ChannelDescription::named(text(channels[i].as_ref()), kind))
        .collect();
    (Header::new(text(name), vec2(size), described), order)
}

fn vec2([x, y]: [u32; 2]) -> Vec2<usize> {
    Vec2(x as usize, y as usize)
}

/// Reads the tables of an OpenEXR file, and the texts of these names that are attributes of its parts. What the header claims is held against the file's length and the memory there is before
/// anything is allocated.
pub fn read_tables(path: &Path, texts: &[&str]) -> Result<ReadTables, ReadError> {
    let (file, length) = open_exr(path)?;
    read(file, length, texts)
        .map_err(|reason| ReadError::Content { path: path.to_path_buf(), reason })
}

fn read(file: BufReader<File>, length: u64, texts: &[&str]) -> Result<ReadTables, String> {
    let reader = Reader::read_from_buffered(file, false).map_err(|e| e.to_string())?;
    let headers = reader.headers();
    let found = |name: &&str| {
        headers.iter().find_map(|header| match header.own_attributes.other.get(&text(name)) {
            Some(AttributeValue::Text(text)) => {
                Some(String::from_utf8_lossy(text.as_slice()).into_owned())
            }
            _ => None,
        })
    };
    let mut read = ReadTables { texts: texts.iter().map(found).collect(), tables: Vec::new() };
    let is_table = |header: &&Header| {
        let is_number = |c: &ChannelDescription| {
            c.sample_type == SampleType::U32 && (c.sampling.0, c.sampling.1) == (1, 1)
        };
        !header.deep && header.channels.list.iter().all(is_number)
    };
    check(headers.iter().filter(is_table), length)?;
    // By header: its place among the tables, and its numbers that are still to come.
    let mut places = vec![None; headers.len()];
    let mut left = 0;
    for (at, header) in headers.iter().enumerate().filter(|(_, header)| is_table(header)) {
        places[at] = Some(read.tables.len());
        left += header.layer_size.area();
        read.tables.push(empty(header)?);
    }
    let mut chunks = reader.all_chunks(false).map_err(|e| e.to_string())?;
    let meta = chunks.meta_data().clone();
    while left > 0 {
        let Some(chunk) = chunks.read_next_chunk() else { break };
        let chunk = chunk.map_err(|e| e.to_string())?;
        let layer = chunk.layer_index;
        let Some(Some(place)) = places.get(layer).copied() else { continue };
        let block =
            UncompressedBlock::decompress_chunk(chunk, &meta, false).map_err(|e| e.to_string())?;
        if (block.index.level.0, block.index.level.1) != (0, 0) {
            continue;
        }
        let (channels, area) = (&meta.headers[layer].channels, block.index.pixel_size.area());
        if block.data.len() != area * channels.bytes_per_pixel {
            return Err("a block of its numbers has the wrong length".to_owned());
        }
        left = left.saturating_sub(area);
        put(&block, channels, &mut read.tables[place])?;
    }
    match left {
        0 => Ok(read),
        _ => Err(format!("{left} entries of its tables are missing")),
    }
}

/// Refuses tables that the file's length cannot explain, or for which there is no memory.
fn check<'a>(tables: impl Iterator<Item = &'a Header>, length: u64) -> Result<(), String> {
    let mut bytes = 0u64;
    for header in tables {
        let (width, height) = (header.layer_size.width(), header.layer_size.height());
        if width.max(height) > exr_file::LARGEST_SIDE {
            return Err(format!("the header claims a table of {width}x{height} entries"));
        }
        let each = header.channels.bytes_per_pixel as u64;
        bytes = bytes.saturating_add((width as u64 * height as u64).saturating_mul(each));
    }
    let most = EXR_FREE_BYTES.max(length.saturating_mul(EXR_EXPANSION));
    if bytes > most {
        let (bytes, most) = (Bytes(bytes), Bytes(most));
        return Err(format!(
            "the header claims tables of {bytes}, and of a file of {length} bytes no more than {most} \
             are taken"
        ));
    }
    // As they are packed, and what is made of them.
    fits(bytes.saturating_mul(2), || format!("a file with tables of {}", Bytes(bytes)))
        .map_err(|e| e.to_string())
}

fn empty(header: &Header) -> Result<ReadTable, String> {
    let area = header.layer_size.area();
    let channel = |c: &ChannelDescription| {
        let mut numbers = Vec::new();
        numbers.try_reserve_exact(area).map_err(|e| e.to_string())?;
        numbers.resize(area, 0);
        Ok((String::from_utf8_lossy(c.name.as_slice()).into_owned(), numbers))
    };
    Ok(ReadTable {
        name: part_name(header).unwrap_or_default(),
        size: [header.layer_size.width() as u32, header.layer_size.height() as u32],
        channels: header.channels.list.iter().map(channel).collect::<Result<_, String>>()?,
    })
}

fn put(
    block: &UncompressedBlock,
    channels: &exr::meta::attribute::ChannelList,
    table: &mut ReadTable,
) -> Result<(), String> {
    let width = table.size[0] as usize;
    for line in block.lines(channels) {
        let at = line.location;
        let start = at.position.1 * width + at.position.0;
        let places = table
            .channels
            .get_mut(at.channel)
            .and_then(|(_, numbers)| numbers.get_mut(start..start + at.sample_count))
            .ok_or("a block of its numbers lies outside its table")?;
        line.read_samples_into_slice(places).map_err(|e| e.to_string())?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::{read_exr_part, read_recipe};

    /// Numbers of 32 bits, NaN patterns among them, come back as they went, beside a picture that reads
    /// as if there were none.
    #[test]
    fn tables_come_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.exr");
        let pixels = (0..70 * 50).map(|i| [i as f32, -1.0, f32::NAN]).collect();
        let picture = Picture { width: 70, height: 50, pixels };
        let number = |channel: usize, x: u32, y: u32| {
            (x + 1000 * y + channel as u32).wrapping_mul(2_654_435_761) | (y % 2 * 0x7f80_0001)
        };
        let fill = |channel: usize, [x, y]: [u32; 2], numbers: &mut [u32]| {
            (x..).zip(numbers).for_each(|(x, place)| *place = number(channel, x, y));
        };
        let names = |n: &[&str]| n.iter().map(|n| n.to_string()).collect::<Vec<_>>();
        let all =
            [("sums", [70, 50], names(&["b.1", "a.0", "c"])), ("cells", [5, 4], names(&["x"]))];
        let table = |(name, size, channels): &(&'static str, [u32; 2], Vec<String>)| Table {
            name,
            size: *size,
            channels: channels.clone(),
            fill: &fill,
        };
        let tables: Vec<Table> = all.iter().map(table).collect();
        write_with_tables(&path, &picture, &[("burnish", "a recipe"), ("more", "ü")], &tables)
            .unwrap();
        let read = read_tables(&path, &["more", "none"]).unwrap();
        assert_eq!(read.texts, [Some("ü".to_owned()), None]);
        for (name, size, channels) in &all {
            let table = read.table(name).unwrap();
            assert_eq!((table.size, table.channels.len()), (*size, channels.len()));
            for (c, channel) in channels.iter().enumerate() {
                let numbers = table.channel(channel).unwrap();
                for (i, &found) in numbers.iter().enumerate() {
                    let [x, y] = [i as u32 % size[0], i as u32 / size[0]];
                    assert_eq!(found, number(c, x, y));
                }
            }
        }
        assert_eq!(read_recipe(&path).unwrap().as_deref(), Some("a recipe"));
        let back = read_exr_part(&path, None).unwrap();
        let bits = |p: &Picture| p.pixels.as_flattened().iter().map(|x| x.to_bits()).collect();
        let [back, before]: [Vec<u32>; 2] = [&back.picture, &picture].map(bits);
        assert_eq!(back, before);
    }
}
