//! Experiments in OpenEXR files.

use super::record::Record;
use super::{Experiment, ExperimentError};
use crate::film::{CELL, Film, FilmState};
use crate::limits::fits;
use crate::math::sobol::REPLICATES;
use crate::picture::{ReadTable, ReadTables, SaveError, Table, read_tables, write_with_tables};
use crate::plain;
use crate::progressive::{Recipe, TILE, TileGrid, plan};
use std::path::Path;

/// The texts beside the picture: the recipe as in any other, and what an experiment has besides.
const RECIPE: &str = "burnish";
const RECORD: &str = "burnish experiment";
/// The parts with its tables.
const SUMS: &str = "sums";
const CELLS: &str = "cells";
/// What stands for a variance that is not noted yet.
const NOT_YET: u32 = u32::MAX;
/// Longest reason for not reading one, and longest name of a scene, in characters.
const LONGEST: usize = 200;
const LONGEST_NAME: usize = 4096;
/// Most variances noted of a cell and half of its replicates.
const MOST_NOTED: usize = 20;

/// A channel of the sums: replicate, colour, and which of its words.
fn sum_channels(words: usize) -> Vec<([usize; 3], String)> {
    let mut all = Vec::new();
    for r in 0..REPLICATES {
        for (c, colour) in ["R", "G", "B"].into_iter().enumerate() {
            for word in 0..words {
                all.push(([r, c, word], format!("replicate{r}.{colour}.{word}")));
            }
        }
    }
    all
}

/// A channel of the cells.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Of {
    /// Passes of the cell's tile, by word.
    Passes(usize),
    /// Of the cell's tile: 1 if numbers of samples were chosen, and 2 more if there are samples of a pass
    /// that is not whole.
    Flags,
    /// Samples of a replicate, by word.
    Count(usize, usize),
    /// Those of half of the replicates when they were last chosen, by word.
    Planned(usize, usize),
    /// What was noted of half of the replicates, in order: single precision.
    Spread(usize, usize),
}

impl Of {
    fn name(self) -> String {
        match self {
            Of::Passes(word) => format!("passes.{word}"),
            Of::Flags => "flags".to_owned(),
            Of::Count(r, word) => format!("replicate{r}.samples.{word}"),
            Of::Planned(half, word) => format!("half{half}.planned.{word}"),
            Of::Spread(half, level) => format!("half{half}.spread.{level:02}"),
        }
    }

    fn all(levels: usize) -> Vec<Of> {
        let words = |of: &dyn Fn(usize) -> Of| [of(0), of(1)];
        let mut all = vec![Of::Flags];
        all.extend(words(&Of::Passes));
        (0..REPLICATES).for_each(|r| all.extend(words(&|word| Of::Count(r, word))));
        for half in 0..2 {
            all.extend(words(&|word| Of::Planned(half, word)));
            all.extend((0..levels).map(|level| Of::Spread(half, level)));
        }
        all
    }

    fn number(self, film: &Film, cell: usize) -> u32 {
        let word = |n: u64, word: usize| (n >> (32 * word)) as u32;
        match self {
            Of::Passes(w) => word(film.passes(), w),
            Of::Flags => u32::from(film.is_uneven()) + 2 * u32::from(!film.is_whole()),
            Of::Count(r, w) => word(film.counts(cell)[r], w),
            Of::Planned(half, w) => word(film.planned(cell)[half], w),
            Of::Spread(half, level) => {
                film.spreads(cell)[half].get(level).map_or(NOT_YET, |x| x.to_bits())
            }
        }
    }
}

/// The tile and the pixel in it that a pixel of the picture is.
fn pixel_of(grid: TileGrid, [x, y]: [u32; 2]) -> (usize, usize) {
    let tile = (y / TILE * grid.columns_rows()[0] + x / TILE) as usize;
    (tile, (y % TILE) as usize * grid.rect(tile).width() + (x % TILE) as usize)
}

/// The tile and the cell in it that a cell of the picture is.
fn cell_of(grid: TileGrid, [x, y]: [u32; 2]) -> (usize, usize) {
    const EACH: u32 = TILE / CELL as u32;
    let tile = (y / EACH * grid.columns_rows()[0] + x / EACH) as usize;
    let across = grid.rect(tile).width().div_ceil(CELL);
    (tile, (y % EACH) as usize * across + (x % EACH) as usize)
}

fn cells_of(size: [u32; 2]) -> [u32; 2] {
    size.map(|side| side.div_ceil(CELL as u32))
}

impl Experiment {
    /// Writes it to an OpenEXR file, of which the picture is the first part. The file is there as a
    /// whole or, after an error or the death of the process, as it was before.
    pub fn save(&self, path: &Path) -> Result<(), SaveError> {
        let (picture, _, recipe) = self.picture();
        let json = |e: serde_json::Error| SaveError::Write { path: path.into(), source: e.into() };
        let recipe = serde_json::to_string_pretty(&recipe).map_err(json)?;
        let record = serde_json::to_string_pretty(&Record {
            experiment: Record::VERSION,
            spans: self.spans.clone(),
            goal: self.goal.clone(),
            planned_at: self.films.first().and_then(Film::planned_at),
            quantum: self.quantum,
            alphas: self.alphas.clone(),
            chosen: self.chosen,
        })
        .map_err(json)?;
        let words = if self.films.iter().all(Film::fits_64_bits) { 2 } else { 4 };
        let (channels, names): (Vec<_>, Vec<_>) = sum_channels(words).into_iter().unzip();
        let grid = self.grid();
        let sums = |channel: usize, [x, y]: [u32; 2], numbers: &mut [u32]| {
            let [r, c, word] = channels[channel];
            for (x, place) in (x..).zip(numbers) {
                let (tile, pixel) = pixel_of(grid, [x, y]);
                *place = (self.films[tile].sums(pixel)[r][c] >> (32 * word)) as u32;
            }
        };
        let noted = |film: &Film| {
            (0..film.cells()).flat_map(|cell| film.spreads(cell)).map(Vec::len).max().unwrap_or(0)
        };
        let all = Of::all(self.films.iter().map(noted).max().unwrap_or(0));
        let cells = |channel: usize, [x, y]: [u32; 2], numbers: &mut [u32]| {
            for (x, place) in (x..).zip(numbers) {
                let (tile, cell) = cell_of(grid, [x, y]);
                *place = all[channel].number(&self.films[tile], cell);
            }
        };
        let tables = [
            Table { name: SUMS, size: grid.size, channels: names, fill: &sums },
            Table {
                name: CELLS,
                size: cells_of(grid.size),
                channels: all.iter().map(|of| of.name()).collect(),
                fill: &cells,
            },
        ];
        write_with_tables(path, &picture, &[(RECIPE, &recipe), (RECORD, &record)], &tables)
    }

    /// Reads one from its file. Whatever is in it that no render of this program could have written is
    /// refused.
    pub fn read(path: &Path) -> Result<Experiment, ExperimentError> {
        let broken = |reason: String| {
            let reason = plain::line(&reason.chars().take(LONGEST).collect::<String>());
            ExperimentError::Broken { path: path.to_path_buf(), reason }
        };
        let read = read_tables(path, &[RECIPE, RECORD])?;
        let [Some(recipe), Some(record)] = [&read.texts[0], &read.texts[1]] else {
            return Err(ExperimentError::NoSums(path.to_path_buf()));
        };
        let recipe = Recipe::parse(recipe)
            .map_err(|source| ExperimentError::Recipe { path: path.to_path_buf(), source })?;
        let record: Record = serde_json::from_str(record).map_err(|e| broken(e.to_string()))?;
        if record.experiment != Record::VERSION {
            let (version, known) = (record.experiment, Record::VERSION);
            return Err(broken(format!("it has version {version}, this burnish knows {known}")));
        }
        if record.goal.scene.as_ref().is_some_and(|name| name.len() > LONGEST_NAME) {
            return Err(broken("its scene has an endless name".to_owned()));
        }
        if record.alphas.len() != recipe.materials.len() {
            return Err(broken("not every material has its roughness".to_owned()));
        }
        let films = films(&recipe, &record, &read).map_err(broken)?;
        let Record { spans, goal, quantum, alphas, chosen, .. } = record;
        // What is estimated is estimated again.
        let recipe = Recipe { error: None, parts: Vec::new(), ..recipe };
        let read = Experiment { recipe, alphas, chosen, quantum, spans, films, goal };
        match read.impossible() {
            Some(what) => Err(broken(what)),
            None => Ok(read),
        }
    }
}

/// The films of all tiles.
fn films(recipe: &Recipe, record: &Record, read: &ReadTables) -> Result<Vec<Film>, String> {
    let grid = TileGrid { size: recipe.size };
    let table = |name: &str, size: [u32; 2]| {
        let table = read.table(name).ok_or_else(|| format!("there is no part `{name}`"))?;
        let [width, height] = table.size;
        let fits = table.size == size;
        fits.then_some(table).ok_or_else(|| {
            format!("part `{name}` has {width}x{height} entries for {}x{} pixels", size[0], size[1])
        })
    };
    let (sums, cells) = (table(SUMS, recipe.size)?, table(CELLS, cells_of(recipe.size))?);
    let words = if sums.channels.len() == sum_channels(4).len() { 4 } else { 2 };
    let levels = sums_of_levels(cells);
    if levels > MOST_NOTED {
        return Err(format!("{levels} variances of a cell"));
    }
    if !(-400..=400).contains(&record.quantum) {
        return Err(format!("a quantum of 2^{}", record.quantum));
    }
    let pixels = u64::from(grid.size[0]) * u64::from(grid.size[1]);
    fits(pixels * 96, || "an experiment".to_owned()).map_err(|e| e.to_string())?;
    let named = |table: &'_ ReadTable, name: &str| {
        table
            .channel(name)
            .map(<[u32]>::to_vec)
            .ok_or_else(|| format!("there is no channel `{name}`"))
    };
    let sum_words: Vec<([usize; 3], &[u32])> = sum_channels(words)
        .into_iter()
        .map(|(of, name)| {
            let numbers = sums.channel(&name);
            Ok((of, numbers.ok_or_else(|| format!("there is no channel `{name}`"))?))
        })
        .collect::<Result<_, String>>()?;
    let cell_words: Vec<(Of, Vec<u32>)> = Of::all(levels)
        .into_iter()
        .map(|of| Ok((of, named(cells, &of.name())?)))
        .collect::<Result<_, String>>()?;
    let mut states = empty(grid, record);
    for y in 0..grid.size[1] {
        for x in 0..grid.size[0] {
            let (tile, pixel) = pixel_of(grid, [x, y]);
            let at = y as usize * grid.size[0] as usize + x as usize;
            let own = &mut states[tile].sums[pixel];
            for ([r, c, word], numbers) in &sum_words {
                let sum = &mut own[*r][*c];
                *sum |= i128::from(numbers[at]) << (32 * word);
                if *word == 1 && words == 2 {
                    // The sign goes all the way.
                    *sum = i128::from(*sum as i64);
                }
            }
        }
    }
    let [across, down] = cells.size;
    for y in 0..down {
        for x in 0..across {
            let (tile, cell) = cell_of(grid, [x, y]);
            let at = y as usize * across as usize + x as usize;
            take_cell(&mut states[tile], cell, cell_words.iter().map(|(of, n)| (*of, n[at])))?;
        }
    }
    states.into_iter().map(|state| Film::restore(state).map_err(|e| e.to_string())).collect()
}

/// How many variances are noted at most.
fn sums_of_levels(cells: &ReadTable) -> usize {
    let is_spread = |(name, _): &&(String, Vec<u32>)| name.starts_with("half0.spread.");
    cells.channels.iter().filter(is_spread).count()
}

/// Films of the right sizes without any samples.
fn empty(grid: TileGrid, record: &Record) -> Vec<FilmState> {
    let film = |tile: usize| {
        let rect = grid.rect(tile);
        let cells = rect.width().div_ceil(CELL) * rect.height().div_ceil(CELL);
        FilmState {
            width: rect.width(),
            quantum: record.quantum,
            passes: 0,
            open: false,
            uneven: false,
            sums: vec![Default::default(); rect.area()],
            counts: vec![Default::default(); cells],
            spreads: vec![Default::default(); cells],
            plan: record.planned_at.map(|from| (from, vec![[0; 2]; cells])),
        }
    };
    (0..grid.len()).map(film).collect()
}

/// Puts the numbers of a cell into its film.
fn take_cell(
    film: &mut FilmState,
    cell: usize,
    numbers: impl Iterator<Item = (Of, u32)>,
) -> Result<(), String> {
    let (mut passes, mut flags, mut planned) = (0u64, 0, [0u64; 2]);
    for (of, number) in numbers {
        let wide = |word: usize| u64::from(number) << (32 * word);
        match of {
            Of::Passes(word) => passes |= wide(word),
            Of::Flags => flags = number,
            Of::Count(r, word) => film.counts[cell][r] |= wide(word),
            Of::Planned(half, word) => planned[half] |= wide(word),
            Of::Spread(..) if number == NOT_YET => {}
            Of::Spread(half, level) => {
                let (spread, noted) = (f32::from_bits(number), &mut film.spreads[cell][half]);
                if noted.len() != level || spread.is_nan() || spread < 0.0 {
                    return Err(format!("a variance of {spread}"));
                }
                noted.push(spread);
            }
        }
    }
    let of_tile = (passes, flags & 1 == 1, flags & 2 == 2);
    if flags > 3 {
        return Err(format!("flags of {flags}"));
    } else if cell == 0 {
        (film.passes, film.uneven, film.open) = of_tile;
    } else if (film.passes, film.uneven, film.open) != of_tile {
        return Err("the cells of a tile have different passes".to_owned());
    }
    match &mut film.plan {
        Some((_, before)) => before[cell] = planned,
        None if planned != [0; 2] => return Err("numbers of a plan and no plan".to_owned()),
        None => {}
    }
    let most = 2 * crate::progressive::Session::MAX_PASSES + plan::UNIFORM;
    if film.passes > most { Err(format!("{} passes", film.passes)) } else { Ok(()) }
}
