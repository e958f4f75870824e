//! Contact sheets: pictures in rows and columns with their labels, laid out on a grid.
//!
//! [`layout`] says where everything goes, from sizes and words alone; [`draw`] puts it there.

use super::letters::{Face, LINE, cover, shortened, width};
use super::{Codes, Picture, Place, Tone};

/// A sheet to be laid out: what is in it, in words and pictures.
#[derive(Clone, Debug, Default)]
pub struct ContactSheet<'a> {
    /// In large letters above all else.
    pub title: String,
    /// Sentences below it; each begins a new line and goes on in further ones where it is too long.
    pub remarks: Vec<String>,
    /// The rows' names, at their left.
    pub rows: Vec<String>,
    /// The columns' headings, each of some lines.
    pub columns: Vec<Vec<String>>,
    /// Width and height of every picture in pixels.
    pub size: [u32; 2],
    /// As many as rows times columns, row by row.
    pub cells: Vec<Cell<'a>>,
}

/// One of its pictures.
#[derive(Clone, Debug, Default)]
pub struct Cell<'a> {
    /// Nothing where there is none: its place is left empty, with a line around it.
    pub picture: Option<&'a Picture>,
    /// Figures below it, side by side where they fit and else below each other.
    pub label: Vec<String>,
    /// Whether the label is to be noticed.
    pub warns: bool,
}

/// A line of letters.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// What it says.
    pub text: String,
    /// In which font.
    pub face: Face,
    /// The letters' size in pixels.
    pub size: f32,
    /// Where the baseline begins.
    pub at: [u32; 2],
    /// Its colour, in codes.
    pub colour: [u8; 3],
}

/// Where everything goes.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// Width and height of the sheet in pixels.
    pub size: [u32; 2],
    /// Where the pictures are, row by row.
    pub cells: Vec<Place>,
    /// All that is written.
    pub lines: Vec<Line>,
}

/// The sheet's own colour: a neutral grey, so that the pictures' colours are judged on no colour.
pub const GROUND: [u8; 3] = [0x46; 3];
const STRONG: [u8; 3] = [0xf4; 3];
const WEAK: [u8; 3] = [0xcf; 3];
const WARNING: [u8; 3] = [0xff, 0xc2, 0x66];
const FRAME: [u8; 3] = [0x6c; 3];

/// Cells of this width are labelled in letters of [`BODY`] pixels; larger cells in larger letters, so
/// that a sheet that is seen as a whole can still be read.
const USUAL_WIDTH: f32 = 320.0;
const BODY: f32 = 13.0;
/// Most times as large.
const LARGEST: f32 = 6.0;
/// Between the figures of a label, as letters.
const BETWEEN: &str = "   ";

/// Sizes of letters and of what is between, in pixels.
struct Measures {
    body: f32,
    remark: f32,
    heading: f32,
    title: f32,
    gap: u32,
    margin: u32,
}

impl Measures {
    fn of(size: [u32; 2]) -> Measures {
        let times = (size[0] as f32 / USUAL_WIDTH).clamp(1.0, LARGEST);
        let body = (BODY * times).round();
        Measures {
            body,
            remark: (1.15 * body).round(),
            heading: (1.4 * body).round(),
            title: (2.1 * body).round(),
            gap: (1.25 * body).round() as u32,
            margin: (2.2 * body).round() as u32,
        }
    }
}

fn line_height(size: f32) -> u32 {
    (LINE * size).ceil() as u32
}

/// Width in whole pixels.
fn pixels(face: Face, size: f32, text: &str) -> u32 {
    width(face, size, text).ceil() as u32
}

/// Lines no wider than `most`, if no single piece is.
fn wrapped(face: Face, size: f32, pieces: &[&str], between: &str, most: u32) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for piece in pieces {
        if let Some(last) = lines.last_mut() {
            let longer = format!("{last}{between}{piece}");
            if pixels(face, size, &longer) <= most {
                *last = longer;
                continue;
            }
        }
        lines.push((*piece).to_owned());
    }
    lines
}

/// Lines that are set below each other.
struct Column<'a> {
    lines: &'a mut Vec<Line>,
    x: u32,
    /// Where the next line's upper edge is.
    y: u32,
}

impl Column<'_> {
    fn write(&mut self, text: String, face: Face, size: f32, colour: [u8; 3]) {
        // Above the baseline there is room for capitals, below it for descenders.
        let at = [self.x, self.y + size.ceil() as u32];
        self.y += line_height(size);
        self.lines.push(Line { text, face, size, at, colour });
    }
}

/// Where everything goes: the same words and sizes always give the same places, and no two things
/// overlap.
pub fn layout(sheet: &ContactSheet) -> Layout {
    let m = Measures::of(sheet.size);
    let columns = sheet.columns.len() as u32;
    let [cell_width, cell_height] = sheet.size;
    // A column is as wide as its pictures, or as its widest figure.
    let headings = sheet.columns.iter().flatten();
    let headings = headings.map(|text| pixels(Face::Words, m.heading, text));
    let figures = sheet.cells.iter().flat_map(|cell| &cell.label);
    let figures = figures.map(|text| pixels(Face::Figures, m.body, text));
    let column_width = headings.chain(figures).fold(cell_width, u32::max);
    let names = sheet.rows.iter().map(|name| pixels(Face::Words, m.heading, name));
    let names = names.max().unwrap_or(0);

    let left = m.margin + names + m.gap;
    let grid_width = columns * column_width + columns.saturating_sub(1) * m.gap;
    // A sheet of few small pictures is wide enough for some words a line.
    let width = (left + grid_width).max(m.margin + (30.0 * m.body) as u32) + m.margin;
    let room = width - 2 * m.margin;

    let mut lines = Vec::new();
    let mut head = Column { lines: &mut lines, x: m.margin, y: m.margin };
    let title = shortened(Face::Words, m.title, &sheet.title, room as f32);
    head.write(title, Face::Words, m.title, STRONG);
    head.y += m.gap / 4;
    for remark in &sheet.remarks {
        let words: Vec<&str> = remark.split_whitespace().collect();
        for line in wrapped(Face::Words, m.remark, &words, " ", room) {
            let line = shortened(Face::Words, m.remark, &line, room as f32);
            head.write(line, Face::Words, m.remark, WEAK);
        }
    }
    let mut y = head.y + m.gap;

    let place = |column: u32| left + column * (column_width + m.gap);
    let mut heads_end = y;
    for (column, heading) in (0..).zip(&sheet.columns) {
        let mut below = Column { lines: &mut lines, x: place(column), y };
        for (i, text) in heading.iter().enumerate() {
            let (size, colour) = if i == 0 { (m.heading, STRONG) } else { (m.remark, WEAK) };
            below.write(text.clone(), Face::Words, size, colour);
        }
        heads_end = heads_end.max(below.y);
    }
    y = heads_end + m.gap / 2;

    let label = |cell: &Cell| {
        let pieces: Vec<&str> = cell.label.iter().map(String::as_str).collect();
        wrapped(Face::Figures, m.body, &pieces, BETWEEN, column_width)
    };
    let labels: Vec<Vec<String>> = sheet.cells.iter().map(label).collect();
    // Rows are equally far apart, however long the labels of one are.
    let label_lines = labels.iter().map(Vec::len).max().unwrap_or(0) as u32;
    let label_height = m.gap / 4 + label_lines * line_height(m.body);
    let pitch = (cell_height + label_height).max(line_height(m.heading)) + m.gap;

    let mut cells = Vec::new();
    for (i, (cell, label)) in sheet.cells.iter().zip(labels).enumerate() {
        let (row, column) = (i as u32 / columns.max(1), i as u32 % columns.max(1));
        let (x, y) = (place(column), y + row * pitch);
        if let Some(name) = sheet.rows.get(row as usize).filter(|_| column == 0) {
            let mut beside = Column { lines: &mut lines, x: m.margin, y };
            beside.write(name.clone(), Face::Words, m.heading, STRONG);
        }
        cells.push(Place { x, y, width: cell_width, height: cell_height });
        let mut below = Column { lines: &mut lines, x, y: y + cell_height + m.gap / 4 };
        let colour = if cell.warns { WARNING } else { WEAK };
        for line in label {
            below.write(line, Face::Figures, m.body, colour);
        }
    }
    y += sheet.rows.len() as u32 * pitch;
    let height = (y + m.margin).saturating_sub(m.gap);
    Layout { size: [width, height], cells, lines }
}

/// The sheet as it is seen. Pictures are toned and dithered as in their own files; one of another size
/// than the sheet's is cut or leaves its place partly empty.
pub fn draw(sheet: &ContactSheet, tone: Tone) -> Codes {
    let Layout { size: [width, height], cells, lines } = layout(sheet);
    let mut codes = Codes::filled([width, height], GROUND);
    for (place, cell) in cells.iter().zip(&sheet.cells) {
        match cell.picture {
            Some(picture) => codes.put(*place, picture, tone),
            None => codes.frame(*place, FRAME),
        }
    }
    for Line { text, face, size, at, colour } in &lines {
        let [x, y] = at.map(|i| i as i32);
        cover(*face, *size, text, |column, row, coverage| {
            codes.blend([x + column, y + row], *colour, coverage);
        });
    }
    codes
}

/// Where a line of letters is, as its size and width say.
#[cfg(test)]
fn extent(line: &Line) -> Place {
    let height = line_height(line.size);
    let y = line.at[1] - line.size.ceil() as u32;
    Place { x: line.at[0], y, width: pixels(line.face, line.size, &line.text), height }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sheet<'a>(size: [u32; 2], rows: usize, columns: usize) -> ContactSheet<'a> {
        let label = ["4096 passes", "error 3.1 %, above 3 %", "12.5 s"].map(str::to_owned).to_vec();
        let cell = Cell { picture: None, label, warns: false };
        ContactSheet {
            title: "a scene with quite a long name, longer than some sheets are wide.scn".into(),
            remarks: vec!["some words ".repeat(20)],
            rows: ["Phong", "Beckmann", "GGX", "X"][..rows].iter().map(|&n| n.into()).collect(),
            columns: vec![vec!["alpha 0.1".into(), "a_p 198".into()]; columns],
            size,
            cells: vec![cell; rows * columns],
        }
    }

    fn overlap(a: &Place, b: &Place) -> bool {
        a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height
    }

    #[test]
    fn cells_lie_on_a_grid_and_nothing_overlaps_or_leaves_the_sheet() {
        for size in [[1, 1], [40, 30], [320, 240], [200, 600], [1600, 1200]] {
            for (rows, columns) in [(1, 1), (3, 5), (4, 2), (1, 9)] {
                let layout = layout(&sheet(size, rows, columns));
                assert_eq!(layout.cells.len(), rows * columns);
                for (i, cell) in layout.cells.iter().enumerate() {
                    assert_eq!([cell.width, cell.height], size);
                    let (row, column) = (i / columns, i % columns);
                    assert_eq!(cell.x, layout.cells[column].x, "a column is a column");
                    assert_eq!(cell.y, layout.cells[row * columns].y, "a row is a row");
                }
                let places: Vec<Place> =
                    layout.lines.iter().map(extent).chain(layout.cells.clone()).collect();
                for (i, a) in places.iter().enumerate() {
                    let [width, height] = layout.size;
                    assert!(a.x > 0 && a.y > 0, "{size:?}: no margin at {a:?}");
                    assert!(a.x + a.width < width && a.y + a.height < height, "{size:?} {a:?}");
                    for b in &places[..i] {
                        assert!(!overlap(a, b), "{size:?} {rows}x{columns}: {a:?} {b:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn columns_and_rows_are_equally_far_apart() {
        let mut sheet = sheet([320, 240], 3, 5);
        sheet.cells[7].label = vec!["much longer than all others".to_owned(); 4];
        let Layout { cells, .. } = layout(&sheet);
        let across = cells[1].x - cells[0].x;
        assert!((0..5).all(|i| cells[i].x == cells[0].x + i as u32 * across) && across > 320);
        let down = cells[5].y - cells[0].y;
        assert!((0..3).all(|i| cells[5 * i].y == cells[0].y + i as u32 * down) && down > 240);
    }

    #[test]
    fn figures_share_a_line_where_they_fit() {
        let on_lines = |size| {
            let mut sheet = sheet(size, 1, 1);
            sheet.cells[0].label = ["64 passes", "2 %", "1 s"].map(str::to_owned).to_vec();
            let lines = layout(&sheet).lines;
            lines.iter().filter(|line| line.face == Face::Figures).count()
        };
        assert_eq!((on_lines([320, 240]), on_lines([1600, 1200]), on_lines([40, 30])), (1, 1, 2));
    }

    /// A picture's codes are those of its own file, on a ground of one grey, and letters are seen.
    #[test]
    fn pictures_are_drawn_as_in_their_own_files() {
        let pixels = (0..40 * 30).map(|i| [i as f32 / 1200.0, 0.3, 2.0]).collect();
        let picture = Picture { width: 40, height: 30, pixels };
        let tone = Tone { exposure: 0.5, ..Tone::default() };
        let mut sheet = sheet([40, 30], 2, 2);
        sheet.cells[1].picture = Some(&picture);
        sheet.cells[1].warns = true;
        let (codes, layout) = (draw(&sheet, tone), layout(&sheet));
        assert_eq!([codes.width, codes.height], layout.size);
        let of = |place: Place| -> Vec<[u8; 3]> {
            let rows = (place.y..place.y + place.height).map(|y| (y * codes.width) as usize);
            let columns = place.x as usize..(place.x + place.width) as usize;
            rows.flat_map(|row| codes.pixels[row + columns.start..row + columns.end].to_vec())
                .collect()
        };
        assert!(of(layout.cells[1]) == tone.dithered(&picture));
        let empty = of(layout.cells[0]);
        assert_eq!(empty.iter().filter(|&&code| code == FRAME).count(), 2 * (40 + 28));
        for line in &layout.lines {
            let seen = of(extent(line)).iter().filter(|&&code| code != GROUND).count();
            assert!(seen > 10, "{line:?}");
        }
        let warned = layout.lines.iter().filter(|line| line.colour == WARNING);
        assert_eq!(warned.count(), 3);
        assert_eq!(codes.pixels[0], GROUND);
    }
}
