//! OpenEXR files as other programs write them: every compression there is an encoder for, in lines and in
//! tiles, of every kind of number, with windows that are off, in several parts, and deep ones.

use exr::prelude::*;
use std::io::Cursor;

const SIZE: Vec2<usize> = Vec2(7, 5);
const COMPRESSIONS: [Compression; 8] = [
    Compression::Uncompressed,
    Compression::RLE,
    Compression::ZIP1,
    Compression::ZIP16,
    Compression::PIZ,
    Compression::PXR24,
    Compression::B44,
    Compression::B44A,
];

/// Red of a pixel; half of it is green, a quarter of it blue.
fn red(place: Vec2<usize>) -> f32 {
    (place.x() + 8 * place.y()) as f32
}

/// How numbers are kept.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Half,
    Single,
    Whole,
}

fn channel(name: &str, kind: Kind, times: f32) -> AnyChannel<FlatSamples> {
    let places = (0..SIZE.area()).map(|i| Vec2(i % SIZE.x(), i / SIZE.x()));
    let numbers = places.map(|place| times * red(place));
    let samples = match kind {
        Kind::Half => FlatSamples::F16(numbers.map(f16::from_f32).collect()),
        Kind::Single => FlatSamples::F32(numbers.collect()),
        Kind::Whole => FlatSamples::U32(numbers.map(|x| x as u32).collect()),
    };
    AnyChannel::new(name, samples)
}

type Colours = Layer<AnyChannels<FlatSamples>>;

/// A part of that name, the upper left pixel of which is at this place.
fn layer(name: &str, encoding: Encoding, kind: Kind, at: Vec2<i32>) -> Colours {
    let attributes = LayerAttributes { layer_position: at, ..LayerAttributes::named(name) };
    let all = [("B", 0.25), ("G", 0.5), ("R", 1.0)];
    let channels = all.map(|(colour, times)| channel(colour, kind, times));
    Layer::new(SIZE, attributes, encoding, AnyChannels::sort(channels.into_iter().collect()))
}

fn written(layers: Vec<Colours>, display: IntegerBounds) -> Vec<u8> {
    let image = Image::from_layers(ImageAttributes::new(display), layers);
    let mut bytes = Cursor::new(Vec::new());
    image.write().non_parallel().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

/// Zeros, a single strip of 16 lines.
pub(crate) fn black([width, height]: [usize; 2]) -> Vec<u8> {
    let attributes = LayerAttributes::named("black");
    let zeros = || FlatSamples::F32(vec![0.0; width * height]);
    let channels = ["B", "G", "R"].map(|name| AnyChannel::new(name, zeros()));
    let encoding = Encoding { compression: Compression::ZIP16, ..Encoding::UNCOMPRESSED };
    let size = Vec2(width, height);
    let channels = AnyChannels::sort(channels.into_iter().collect());
    let display = IntegerBounds::new(Vec2(0, 0), size);
    written(vec![Layer::new(size, attributes, encoding, channels)], display)
}

/// A file, and whether its first part is one of three colours that is read to the bit: some compressions keep
/// less than that.
pub(crate) struct Written {
    pub(crate) bytes: Vec<u8>,
    pub(crate) exact: bool,
    pub(crate) what: String,
}

/// What a reader has to understand.
pub(crate) fn whole() -> Vec<Written> {
    let mut all = Vec::new();
    let display = |at: Vec2<i32>, size: Vec2<usize>| IntegerBounds::new(at, size);
    let mut add = |what: String, exact, bytes| all.push(Written { bytes, exact, what });
    for compression in COMPRESSIONS {
        for blocks in [Blocks::ScanLines, Blocks::Tiles(Vec2(4, 4)), Blocks::Tiles(Vec2(64, 64))] {
            for kind in [Kind::Half, Kind::Single, Kind::Whole] {
                let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
                let layer = layer("x", encoding, kind, Vec2(0, 0));
                let exact = kind == Kind::Single && !compression.may_loose_data();
                let what = format!("{compression} {blocks:?}");
                add(what, exact, written(vec![layer], display(Vec2(0, 0), SIZE)));
            }
        }
    }
    let zip = Encoding::SMALL_FAST_LOSSLESS;
    let one = |name: &str, at| layer(name, zip, Kind::Single, at);
    let down = Encoding { line_order: LineOrder::Decreasing, ..Encoding::UNCOMPRESSED };
    add("lines upwards".into(), true, {
        written(vec![layer("x", down, Kind::Single, Vec2(0, 0))], display(Vec2(0, 0), SIZE))
    });
    // Both windows elsewhere; data within a larger picture, beyond a smaller one, and apart from it.
    for (at, from, size) in [
        (Vec2(-3, 100), Vec2(-3, 100), SIZE),
        (Vec2(2, 1), Vec2(0, 0), Vec2(12, 9)),
        (Vec2(-2, -1), Vec2(0, 0), Vec2(3, 3)),
    ] {
        let what = format!("data at {at:?} of {size:?} at {from:?}");
        add(what, at == from, written(vec![one("x", at)], display(from, size)));
    }
    let parts = ["left", "right", "depth"].map(|name| one(name, Vec2(0, 0)));
    add("three parts".into(), true, written(parts.to_vec(), display(Vec2(0, 0), SIZE)));
    all
}
