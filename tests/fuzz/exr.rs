//! OpenEXR and PNG files, put together byte by byte as other programs write them, and as none does.

/// One attribute of a header.
fn attribute(name: &str, kind: &str, value: &[u8]) -> Vec<u8> {
    let mut bytes = [name.as_bytes(), b"\0", kind.as_bytes(), b"\0"].concat();
    bytes.extend((value.len() as i32).to_le_bytes());
    bytes.extend(value);
    bytes
}

fn window(corners: [i32; 4]) -> Vec<u8> {
    corners.iter().flat_map(|x| x.to_le_bytes()).collect()
}

fn channels(names: &[&str], kind: i32, sampling: i32) -> Vec<u8> {
    let mut bytes = Vec::new();
    for name in names {
        bytes.extend([name.as_bytes(), b"\0"].concat());
        bytes.extend(kind.to_le_bytes());
        bytes.extend([0; 4]);
        bytes.extend(sampling.to_le_bytes());
        bytes.extend(sampling.to_le_bytes());
    }
    bytes.push(0);
    bytes
}

/// What a file is made of.
#[derive(Clone)]
struct File {
    version: u32,
    channels: Vec<u8>,
    compression: u8,
    data: [i32; 4],
    display: [i32; 4],
    order: u8,
    more: Vec<u8>,
    /// What stands behind the header.
    body: Vec<u8>,
}

impl File {
    /// Four pixels by two, uncompressed: a table of two offsets and two lines.
    fn new() -> File {
        let mut body = vec![0; 16];
        for y in 0..2i32 {
            body.extend(y.to_le_bytes());
            body.extend(48i32.to_le_bytes());
            body.extend([0, 0, 128, 63].repeat(12));
        }
        File {
            version: 2,
            channels: channels(&["B", "G", "R"], 2, 1),
            compression: 0,
            data: [0, 0, 3, 1],
            display: [0, 0, 3, 1],
            order: 0,
            more: Vec::new(),
            body,
        }
    }

    fn header(&self) -> Vec<u8> {
        let one = 1f32.to_le_bytes();
        let mut bytes = attribute("channels", "chlist", &self.channels);
        bytes.extend(attribute("compression", "compression", &[self.compression]));
        bytes.extend(attribute("dataWindow", "box2i", &window(self.data)));
        bytes.extend(attribute("displayWindow", "box2i", &window(self.display)));
        bytes.extend(attribute("lineOrder", "lineOrder", &[self.order]));
        bytes.extend(attribute("pixelAspectRatio", "float", &one));
        bytes.extend(attribute("screenWindowCenter", "v2f", &[0; 8]));
        bytes.extend(attribute("screenWindowWidth", "float", &one));
        bytes.extend(&self.more);
        bytes.push(0);
        bytes
    }

    fn bytes(&self) -> Vec<u8> {
        let mut bytes = 20_000_630u32.to_le_bytes().to_vec();
        bytes.extend(self.version.to_le_bytes());
        bytes.extend(self.header());
        bytes.extend(&self.body);
        bytes
    }

    /// As parts of one file, with names and numbers of chunks.
    fn parts(parts: &[File]) -> Vec<u8> {
        let mut bytes = 20_000_630u32.to_le_bytes().to_vec();
        bytes.extend((2u32 | 0x1000).to_le_bytes());
        for (i, part) in parts.iter().enumerate() {
            let mut part = part.clone();
            part.more.extend(attribute("name", "string", format!("part {i}").as_bytes()));
            part.more.extend(attribute("type", "string", b"scanlineimage"));
            part.more.extend(attribute("chunkCount", "int", &2i32.to_le_bytes()));
            bytes.extend(part.header());
        }
        bytes.push(0);
        bytes.extend(vec![0; 16 * parts.len()]);
        for (i, part) in parts.iter().enumerate() {
            for line in part.body.get(16..).unwrap_or_default().chunks(56) {
                bytes.extend((i as i32).to_le_bytes());
                bytes.extend(line);
            }
        }
        bytes
    }
}

/// Deep ones, in lines and in tiles: alone, and as a part of several.
pub(crate) fn deep_files() -> Vec<Vec<u8>> {
    let deep = |kind: &str, chunks: i32| {
        let mut more = attribute("type", "string", kind.as_bytes());
        more.extend(attribute("version", "int", &1i32.to_le_bytes()));
        more.extend(attribute("chunkCount", "int", &chunks.to_le_bytes()));
        more.extend(attribute("maxSamplesPerPixel", "int", &1i32.to_le_bytes()));
        File { version: 2 | 0x800, more, ..File::new() }
    };
    let mut tiles = deep("deeptile", 1);
    tiles.more.extend(attribute("tiles", "tiledesc", &[4, 0, 0, 0, 4, 0, 0, 0, 0]));
    vec![deep("deepscanline", 2).bytes(), tiles.bytes()]
}

/// Sides of a strip of [`zeros`], and its bytes unpacked.
const STRIP_SIDES: [usize; 2] = [16_384, 16];
pub(crate) const STRIP: usize = 12 * STRIP_SIDES[0] * STRIP_SIDES[1];

/// Width and height of [`zeros`].
pub(crate) fn zeros_size(strips: usize) -> [u32; 2] {
    [STRIP_SIDES[0] as u32, (strips * STRIP_SIDES[1]) as u32]
}

/// A legal file of this number of strips, black, all of which are packed as the first is.
pub(crate) fn zeros(strips: usize) -> Vec<u8> {
    let packed = super::written::black(STRIP_SIDES);
    // The table has one offset: that of what stands right behind it.
    let word = |at: usize| u64::from_le_bytes(packed[at..at + 8].try_into().unwrap());
    let strip = (8..packed.len() - 8).find(|&at| word(at - 8) == at as u64).unwrap();
    let strip = &packed[strip + 4..];
    let [width, height] = zeros_size(strips).map(|side| side as i32);
    let data = [0, 0, width - 1, height - 1];
    let mut file = File { compression: 3, data, display: data, body: Vec::new(), ..File::new() };
    let body = 8 + file.header().len() + 8 * strips;
    for i in 0..strips {
        file.body.extend(((body + i * (4 + strip.len())) as u64).to_le_bytes());
    }
    for i in 0..strips {
        file.body.extend(((i * STRIP_SIDES[1]) as i32).to_le_bytes());
        file.body.extend(strip);
    }
    file.bytes()
}

/// Whole and broken ones.
pub(crate) fn files() -> Vec<Vec<u8>> {
    let whole = File::new();
    let mut all = vec![whole.bytes()];
    let mut add = |change: &dyn Fn(&mut File)| {
        let mut file = File::new();
        change(&mut file);
        all.push(file.bytes());
    };
    // Every compression with lines that are not compressed that way, and unknown ones.
    for compression in [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 255] {
        add(&|f| f.compression = compression);
    }
    // Windows: off, apart, upside down, huge in one direction and in both, at the ends of i32.
    let (low, high) = (i32::MIN, i32::MAX);
    for data in [
        [1, 1, 4, 2],
        [-2, -1, 1, 0],
        [100, 100, 103, 101],
        [3, 1, 0, 0],
        [0, 0, 0x0fff_ffff, 15],
        [0, 0, 15, 0x0fff_ffff],
        [0, 0, 32_767, 32_767],
        [0, 0, high, high],
        [low, low, high, high],
        [low, low, low + 3, low + 1],
        [high - 3, high - 1, high, high],
    ] {
        add(&|f| f.data = data);
        add(&|f| (f.data, f.display) = (data, data));
        add(&|f| f.display = data);
    }
    // Channels: none, of unknown kinds, with gaps, by thousands, without an end, called anything.
    for (names, kind, sampling) in [
        (&[][..], 2, 1),
        (&["R"], 2, 1),
        (&["Y"], 2, 1),
        (&["A", "Z"], 2, 1),
        (&["B", "G", "R"], 0, 1),
        (&["B", "G", "R"], 1, 1),
        (&["B", "G", "R"], 3, 1),
        (&["B", "G", "R"], -1, 1),
        (&["B", "G", "R"], 2, 0),
        (&["B", "G", "R"], 2, 2),
        (&["B", "G", "R"], 2, -1),
        (&["BY", "RY", "Y"], 1, 2),
        (&["R", "R", "R"], 2, 1),
        (&["\u{1b}[2J", "\u{202e}"], 2, 1),
        (&["a.b.c.R", "a.b.c.G", "a.b.c.B"], 2, 1),
    ] {
        add(&|f| f.channels = channels(names, kind, sampling));
    }
    let many: Vec<String> = (0..5000).map(|i| format!("c{i:05}")).collect();
    let many: Vec<&str> = many.iter().map(String::as_str).collect();
    add(&|f| f.channels = channels(&many, 2, 1));
    add(&|f| f.channels.truncate(f.channels.len() - 1));
    add(&|f| f.channels = b"R\0".to_vec());
    // Kinds of file: deep, in tiles with and without a description, long names, later versions.
    for flags in [0x200, 0x400, 0x800, 0x1000, 0x1e00, 0xffff_fd00] {
        add(&|f| f.version |= flags);
    }
    for tile in [[0u32, 0], [1, 1], [u32::MAX, u32::MAX], [64, 64]] {
        for mode in [0u8, 1, 2, 0x11, 0x12, 0xff] {
            add(&|f| {
                f.version |= 0x200;
                let mut value = tile.map(u32::to_le_bytes).concat();
                value.push(mode);
                f.more = attribute("tiles", "tiledesc", &value);
            });
        }
    }
    // Bodies: cut anywhere, lines that are not there or twice, of wrong lengths.
    for length in [0, 8, 16, 20, 24, 70, 100] {
        add(&|f| f.body.truncate(length));
    }
    for (at, number) in [(16, -1), (16, 2), (16, 1), (20, 0), (20, -1), (20, i32::MAX), (72, 0)] {
        add(&|f| f.body[at..at + 4].copy_from_slice(&i32::to_le_bytes(number)));
    }
    add(&|f| f.body.extend(File::new().body));
    // Attributes that lie.
    for more in [
        attribute("burnish", "string", b"{"),
        attribute("burnish", "int", &[1, 0, 0, 0]),
        attribute("channels", "chlist", &[0]),
        attribute("chromaticities", "chromaticities", &[0xff; 32]),
        attribute("chromaticities", "chromaticities", &[0; 32]),
        attribute("preview", "preview", &[0xff; 8]),
        attribute("x", "string", &[0xff; 100]),
        attribute(&"n".repeat(300), "string", b"long"),
        attribute("type", "string", b"deepscanline"),
        attribute("chunkCount", "int", &i32::MAX.to_le_bytes()),
        [&b"x\0string\0"[..], &i32::MAX.to_le_bytes()].concat(),
        [&b"x\0string\0"[..], &(-1i32).to_le_bytes()].concat(),
    ] {
        add(&|f| f.more = more.clone());
    }
    add(&|f| f.order = 1);
    add(&|f| f.order = 2);
    add(&|f| f.order = 9);
    let deep = File { more: attribute("type", "string", b"deepscanline"), ..File::new() };
    let far = File { data: [0, 0, 0x0fff_ffff, 15], ..File::new() };
    all.extend(deep_files());
    all.extend([
        File::parts(std::slice::from_ref(&whole)),
        File::parts(&[whole.clone(), whole.clone()]),
        File::parts(&[far, whole.clone()]),
        File::parts(&[deep, whole]),
        File::parts(&[]),
        Vec::new(),
        b"v/1\x01".to_vec(),
        b"\x89PNG\r\n\x1a\n".to_vec(),
        b"not a picture".to_vec(),
        vec![0; 1000],
    ]);
    all
}

/// Zlib of a million bytes that are 160 million blanks unpacked: one blank, then copies of 258 by the fixed codes
/// of RFC 1951. Its checksum is not there, for nobody should get that far.
fn blanks() -> Vec<u8> {
    let (mut bytes, mut bits, mut held) = (vec![0x78, 0x01], 0u32, 0);
    let mut put = |code: u32, length: u32| {
        bits |= code << held;
        held += length;
        while held >= 8 {
            bytes.push(bits as u8);
            (bits, held) = (bits >> 8, held - 8);
        }
    };
    // Codes have their first bit first, numbers their last.
    let code = |code: u32, length: u32| code.reverse_bits() >> (32 - length);
    put(0b011, 3);
    put(code(0x30 + u32::from(b' '), 8), 8);
    for _ in 0..620_000 {
        put(code(0b1100_0101, 8), 8);
        put(0, 5);
    }
    put(0, 7 + 8);
    bytes
}

/// PNG files of a pixel with a text or profile that unpacks to 160 MB, by the kind of chunk.
pub(crate) fn png_bombs() -> Vec<(&'static str, Vec<u8>)> {
    let blanks = blanks();
    let head = chunk(b"IHDR", &[0, 0, 0, 1, 0, 0, 0, 1, 8, 2, 0, 0, 0]);
    let file = |kind: &[u8; 4], start: &[u8]| {
        let text = chunk(kind, &[start, &blanks].concat());
        let all =
            [&b"\x89PNG\r\n\x1a\n"[..], &head, &text, &chunk(b"IDAT", b""), &chunk(b"IEND", b"")];
        all.concat()
    };
    vec![
        ("recipe", file(b"iTXt", b"burnish\0\x01\0\0\0")),
        ("iTXt", file(b"iTXt", b"comment\0\x01\0\0\0")),
        ("zTXt", file(b"zTXt", b"burnish\0\0")),
        ("iCCP", file(b"iCCP", b"profile\0\0")),
    ]
}

/// A chunk of a PNG file; its checksum is right.
fn chunk(kind: &[u8; 4], data: &[u8]) -> Vec<u8> {
    let mut bytes = (data.len() as u32).to_be_bytes().to_vec();
    let body = [&kind[..], data].concat();
    let mut crc = u32::MAX;
    for &byte in &body {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 { 0xedb8_8320 ^ (crc >> 1) } else { crc >> 1 };
        }
    }
    bytes.extend(body);
    bytes.extend((!crc).to_be_bytes());
    bytes
}

/// PNG files around a recipe's text, one kind of fault each.
pub(crate) fn png_files(recipe: &str) -> Vec<Vec<u8>> {
    let size =
        |w: u32, h: u32, tail: [u8; 5]| [&w.to_be_bytes()[..], &h.to_be_bytes(), &tail].concat();
    let plain = [8, 2, 0, 0, 0];
    // An iTXt chunk, packed or not; Deflate without compression, for want of a compressor.
    let text = |keyword: &str, flag: u8, method: u8, text: &[u8]| {
        chunk(b"iTXt", &[keyword.as_bytes(), &[0, flag, method, 0, 0], text].concat())
    };
    let stored = |text: &[u8]| {
        let mut bytes = vec![0x78, 0x01];
        for (i, part) in text.chunks(65_535).enumerate() {
            let n = part.len() as u16;
            bytes.push(u8::from((i + 1) * 65_535 >= text.len()));
            bytes.extend(n.to_le_bytes());
            bytes.extend((!n).to_le_bytes());
            bytes.extend(part);
        }
        let (mut a, mut b) = (1u32, 0u32);
        for &byte in text {
            a = (a + u32::from(byte)) % 65_521;
            b = (b + a) % 65_521;
        }
        bytes.extend((b << 16 | a).to_be_bytes());
        bytes
    };
    let pixels = chunk(b"IDAT", &stored(&[0, 0, 0, 0]));
    let end = chunk(b"IEND", &[]);
    let file = |middle: Vec<Vec<u8>>| {
        let mut bytes = b"\x89PNG\r\n\x1a\n".to_vec();
        middle.iter().for_each(|chunk| bytes.extend(chunk));
        bytes
    };
    let head = chunk(b"IHDR", &size(1, 1, plain));
    let with = |more: Vec<u8>| file(vec![head.clone(), more, pixels.clone(), end.clone()]);
    let mut all = vec![with(text("burnish", 0, 0, recipe.as_bytes()))];
    all.push(with(text("burnish", 1, 0, &stored(recipe.as_bytes()))));
    // More than is unpacked.
    all.push(with(text("burnish", 1, 0, &stored(&vec![b' '; 9 << 20]))));
    for (keyword, flag, method, body) in [
        ("", 0, 0, &b"{}"[..]),
        ("burnish", 0, 0, b""),
        ("burnish", 0, 0, b"\xff\xfe"),
        ("burnish", 0, 0, b"{"),
        ("burnish", 0, 9, b"{}"),
        ("burnish", 9, 0, b"{}"),
        ("burnish", 1, 0, b"not packed"),
        ("burnish", 1, 0, b""),
        ("burnish", 1, 9, b"x"),
        ("Burnish", 0, 0, b"{}"),
        (&"k".repeat(80), 0, 0, b"{}"),
        ("burnish\u{1b}", 0, 0, b"{}"),
    ] {
        all.push(with(text(keyword, flag, method, body)));
    }
    for (w, h, tail) in [
        (0, 1, plain),
        (1, 0, plain),
        (u32::MAX, u32::MAX, plain),
        (0x7fff_ffff, 0x7fff_ffff, plain),
        (100_000, 100_000, plain),
        (1, 1, [0, 2, 0, 0, 0]),
        (1, 1, [3, 2, 0, 0, 0]),
        (1, 1, [16, 6, 0, 0, 0]),
        (1, 1, [8, 3, 0, 0, 0]),
        (1, 1, [8, 5, 0, 0, 0]),
        (1, 1, [8, 2, 1, 0, 0]),
        (1, 1, [8, 2, 0, 1, 0]),
        (1, 1, [8, 2, 0, 0, 1]),
        (1, 1, [8, 2, 0, 0, 2]),
    ] {
        all.push(file(vec![chunk(b"IHDR", &size(w, h, tail)), pixels.clone(), end.clone()]));
    }
    for (kind, body) in [
        (b"tEXt", &b"burnish\0{}"[..]),
        (b"tEXt", b"burnish"),
        (b"zTXt", b"burnish\0\0x"),
        (b"zTXt", b"burnish"),
        (b"iTXt", b"burnish"),
        (b"iTXt", b"burnish\0"),
        (b"iTXt", b"burnish\0\0"),
        (b"iTXt", b""),
        (b"iCCP", b"x\0\0x"),
        (b"gAMA", b"\0\0\0\0"),
        (b"gAMA", b""),
        (b"cHRM", b"x"),
        (b"pHYs", b"x"),
        (b"PLTE", b"xy"),
        (b"tRNS", b""),
        (b"acTL", b"\0\0\0\0\0\0\0\0"),
        (b"acTL", b"\xff\xff\xff\xff\xff\xff\xff\xff"),
        (b"fcTL", b"x"),
        (b"IHDR", b"x"),
        (b"XXXX", b"critical"),
        (b"xxxx", b"not"),
        (b"\0\0\0\0", b""),
        (b"eXIf", b"x"),
        (b"sBIT", b"x"),
        (b"IEND", b""),
    ] {
        all.push(with(chunk(kind, body)));
    }
    let good = all[0].clone();
    for end in [0, 1, 8, 12, 20, 33, 40, 60] {
        all.push(good[..end].to_vec());
    }
    let mut wrong = good.clone();
    wrong[30] ^= 1;
    all.push(wrong);
    let mut long = good.clone();
    long[33..37].copy_from_slice(&[0xff; 4]);
    all.extend([long, file(vec![end.clone()]), file(vec![pixels, head, end]), b"GIF89a".to_vec()]);
    all
}
