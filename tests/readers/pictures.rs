//! Pictures on their way to the screen and to files, and back.

use crate::support::Random;
use burnish::picture::{Curve, Format, NAN_COLOUR, Picture, SaveError, Tone};
use burnish::picture::{check_writable, contents, read_exr, read_exr_part, read_recipe};
use burnish::picture::{read_recipe_of, replace_file};
use burnish::picture::{write, write_with_recipe};
use std::fs;
use std::io;
use std::path::Path;

fn tone(exposure: f32, curve: Curve) -> Tone {
    Tone { exposure, curve }
}

fn code(tone: Tone, radiance: f32) -> u8 {
    let mut out = [[0; 3]];
    tone.rgb8(&[[radiance; 3]], &mut out);
    out[0][0]
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn every_radiance_has_a_code() {
    for curve in Curve::ALL {
        for exposure in [-30.0, -1.0, 0.0, 2.5, 30.0, f32::INFINITY, f32::NEG_INFINITY, f32::NAN] {
            let tone = tone(exposure, curve);
            for dark in [0.0, -0.0, -1e-45, -1.0, -1e30, f32::NEG_INFINITY, 1e-45] {
                assert_eq!(code(tone, dark), 0, "{tone:?} {dark}");
            }
            for bright in [1e30, f32::MAX, f32::INFINITY] {
                assert_eq!(code(tone, bright), 255, "{tone:?} {bright}");
            }
            for nan in [[f32::NAN, 0.0, 0.0], [0.0, -f32::NAN, 0.0], [1.0, 0.0, f32::NAN]] {
                let mut out = [[0; 4]];
                tone.rgba8(&[nan], &mut out);
                assert_eq!(out, [[255, 0, 255, 255]]);
                assert_eq!(tone.exact(nan), NAN_COLOUR);
            }
        }
    }
}

#[test]
fn tables_are_within_one_code_of_the_formula_at_every_exposure() {
    for curve in Curve::ALL {
        for exposure in [-7.3, -1.0, 0.0, 0.1, 5.0] {
            let tone = tone(exposure, curve);
            for bits in (0..f32::INFINITY.to_bits()).step_by(40_009) {
                let x = f32::from_bits(bits);
                let exact = tone.exact([x; 3])[0];
                assert!(code(tone, x).abs_diff(exact) <= 1, "{tone:?} {x}");
            }
        }
    }
}

#[test]
fn codes_are_those_of_the_published_curves() {
    // Mid grey in sRGB, the end of its straight part, and what the curves make of 1.
    assert_eq!(code(tone(0.0, Curve::Srgb), 0.214_041_14), 128);
    assert_eq!(code(tone(0.0, Curve::Srgb), 0.0031308), 10);
    assert_eq!(code(tone(0.0, Curve::Reinhard), 1.0), 188);
    assert_eq!(code(tone(0.0, Curve::Filmic), 1.0), 232);
}

#[test]
fn a_stop_is_a_factor_of_two() {
    for curve in Curve::ALL {
        for x in [0.001, 0.02, 0.18, 0.4, 3.0] {
            assert_eq!(code(tone(1.0, curve), x), code(tone(0.0, curve), 2.0 * x));
            assert_eq!(code(tone(-2.0, curve), x), code(tone(0.0, curve), 0.25 * x));
        }
    }
}

#[test]
fn channels_keep_their_places() {
    let pixels = [[0.0, 0.5, 1.0], [1.0, 0.0, 0.5]];
    let mut out = [[9; 4]; 3];
    Tone::default().rgba8(&pixels, &mut out);
    assert_eq!(out, [[0, 188, 255, 255], [255, 0, 188, 255], [9; 4]]);
}

#[test]
fn exr_comes_back_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picture.EXR");
    let odd = [0.0, -0.0, 1e-45, -1e30, 3.0e38, f32::MAX, f32::INFINITY, f32::NAN, 1.0 / 3.0];
    let mut picture = Picture::black(37, 5);
    for (i, pixel) in picture.pixels.iter_mut().enumerate() {
        *pixel = std::array::from_fn(|c| odd[(i + 2 * c) % odd.len()]);
    }
    write(&path, &picture, tone(3.0, Curve::Filmic)).unwrap();
    let back = read_exr(&path).unwrap();
    assert_eq!((back.width, back.height), (37, 5));
    let bits =
        |p: &Picture| p.pixels.as_flattened().iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&back), bits(&picture));
    assert_eq!(names(folder.path()), ["picture.EXR"]);
}

#[test]
fn png_holds_the_codes_of_a_ramp() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ramp.png");
    // The inverse of the sRGB transfer curve at every code.
    let light = |code: u32| {
        let v = f64::from(code) / 255.0;
        (if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }) as f32
    };
    let pixels = (0..256).map(|c| [light(c), light(255 - c), 0.25 * light(c)]).collect();
    let picture = Picture { width: 64, height: 4, pixels };
    write(&path, &picture, Tone::default()).unwrap();
    let back = image::open(&path).unwrap();
    assert_eq!(back.color(), image::ColorType::Rgb8);
    for (code, pixel) in back.to_rgb8().pixels().enumerate() {
        assert_eq!(pixel.0[..2], [code as u8, 255 - code as u8]);
    }
    // Two stops up, the third channel is the ramp.
    write(&path, &picture, tone(2.0, Curve::Srgb)).unwrap();
    for (code, pixel) in image::open(&path).unwrap().to_rgb8().pixels().enumerate() {
        assert_eq!(pixel.0[2], code as u8);
    }
}

/// A flat picture between two codes holds both, mixed so that the mean of every block of 32x32
/// pixels is right to 1/128 of a code. White noise would be off by more in every other block: its
/// standard deviation is 1/107 to 1/64.
#[test]
fn dither_keeps_the_mean_of_every_block() {
    for (curve, fraction) in
        Curve::ALL.into_iter().flat_map(|c| [0.1, 0.25, 0.5, 0.9].map(|f| (c, f)))
    {
        // The radiance whose exact value is 100 + fraction codes, by bisection of the two greys
        // that are shown as the codes to both sides.
        let code_of = |x: f32| Tone { exposure: 0.0, curve }.exact([x; 3])[0];
        let edge = |code: u8| {
            let (mut low, mut high) = (0.0f32, 1.0f32);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if code_of(middle) < code { low = middle } else { high = middle }
            }
            f64::from(high)
        };
        // `exact` rounds: 100 begins at 99.5. Between its ends a code is nearly linear.
        let [from, to] = [edge(100), edge(101)];
        let level = 99.5 + fraction;
        let grey = (from + (to - from) * fraction) as f32;
        let picture = Picture { width: 128, height: 96, pixels: vec![[grey; 3]; 128 * 96] };
        let codes = Tone { exposure: 0.0, curve }.dithered(&picture);
        let around = [level.floor() as u8, level.floor() as u8 + 1];
        assert!(codes.iter().all(|c| around.contains(&c[0]) && c[0] == c[1] && c[1] == c[2]));
        for (x, y) in (0..4).flat_map(|x| (0..3).map(move |y| (32 * x, 32 * y))) {
            let block = (0..1024).map(|i| codes[(y + i / 32) * 128 + x + i % 32][0]);
            let mean = block.map(f64::from).sum::<f64>() / 1024.0;
            assert!((mean - level).abs() < 1.0 / 128.0, "{curve:?} {level} at {x} {y}: {mean}");
        }
    }
}

/// A slow ramp, 16 columns a code: dithered, the mean of every column is that of the exact values,
/// where rounding is off by up to half a code.
#[test]
fn dither_takes_the_bands_out_of_a_ramp() {
    let (width, height) = (128, 256);
    let light = |code: f64| ((code / 255.0 + 0.055) / 1.055).powf(2.4) as f32;
    let level = |x: usize| 80.0 + x as f64 / 16.0;
    let row: Vec<_> = (0..width).map(|x| [light(level(x)); 3]).collect();
    let picture = Picture { width: 128, height: 256, pixels: row.repeat(height) };
    let codes = Tone::default().dithered(&picture);
    assert_eq!(codes, Tone::default().dithered(&picture));
    let mut rounded = vec![[0; 3]; codes.len()];
    Tone::default().rgb8(&picture.pixels, &mut rounded);
    let worst = |codes: &[[u8; 3]]| {
        let off = |x: usize| {
            let column = (0..height).map(|y| f64::from(codes[y * width + x][1]));
            (column.sum::<f64>() / height as f64 - level(x)).abs()
        };
        (0..width).map(off).fold(0.0, f64::max)
    };
    let [dithered, banded] = [worst(&codes), worst(&rounded)];
    assert!(dithered < 0.02 && banded > 0.4, "{dithered} and {banded}");
}

#[test]
fn black_white_and_what_is_no_number_are_not_dithered() {
    let odd = [0.0, -1.0, f32::NEG_INFINITY, 1e9, f32::INFINITY, f32::NAN];
    let white = (Curve::Srgb, 1.0);
    for (curve, x) in Curve::ALL.into_iter().flat_map(|c| odd.map(|x| (c, x))).chain([white]) {
        let tone = tone(0.0, curve);
        let picture = Picture { width: 50, height: 40, pixels: vec![[x; 3]; 2000] };
        assert!(tone.dithered(&picture).iter().all(|c| *c == tone.exact([x; 3])), "{tone:?} {x}");
    }
}

const RECIPE: &str = "{\"recipe\": \"tea, 3 minutes\", \"name\": \"Würfel 立方体\"}\n";

#[test]
fn a_recipe_comes_back_from_both_kinds_of_file_and_changes_no_pixel() {
    let folder = tempfile::tempdir().unwrap();
    let pixels = (0..600).map(|i| [i as f32 / 600.0, 0.3, 1.5]).collect();
    let picture = Picture { width: 30, height: 20, pixels };
    for kind in ["png", "exr"] {
        let [with, without] =
            ["with", "without"].map(|n| folder.path().join(n.to_owned() + "." + kind));
        for text in [RECIPE, "", &"long ".repeat(100_000)] {
            write_with_recipe(&with, &picture, Tone::default(), text).unwrap();
            // OpenEXR knows no empty strings.
            if kind == "png" || !text.is_empty() {
                assert_eq!(read_recipe(&with).unwrap().as_deref(), Some(text), "{kind}");
            }
        }
        write_with_recipe(&with, &picture, Tone::default(), RECIPE).unwrap();
        write(&without, &picture, Tone::default()).unwrap();
        assert_eq!(read_recipe(&without).unwrap(), None);
        let [a, b] = [&with, &without].map(|path| image::open(path).unwrap().to_rgb32f());
        assert_eq!(a.dimensions(), (30, 20));
        assert_eq!(a, b);
    }
    let exr = read_exr(&folder.path().join("with.exr")).unwrap();
    assert_eq!(exr, picture);
}

#[test]
fn what_has_no_recipe_is_an_error_or_none() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    for kind in ["png", "exr"] {
        let path = at(&format!("a.{kind}"));
        let text = read_recipe(&path).unwrap_err().to_string();
        assert!(text.contains("cannot be opened"), "{text}");
        for bytes in [&b""[..], b"no picture", b"\x89PNG\r\n\x1a\n", b"v/1\x01\x02\0\0\0"] {
            fs::write(&path, bytes).unwrap();
            let text = read_recipe(&path).unwrap_err().to_string();
            assert!(text.contains(&format!("a.{kind}")) && text.contains(".exr files"), "{text}");
        }
    }
    fs::write(at("a.txt"), "x").unwrap();
    assert!(read_recipe(&at("a.txt")).unwrap_err().to_string().contains("unknown kind"));
}

/// One to four bytes changed, all before the pixels: a recipe, none, or an error, never a panic.
#[test]
fn recipes_of_damaged_files_are_text_or_errors() {
    let folder = tempfile::tempdir().unwrap();
    let mut random = Random::new(11);
    for kind in ["png", "exr"] {
        let path = folder.path().join(format!("a.{kind}"));
        write_with_recipe(&path, &Picture::black(20, 9), Tone::default(), RECIPE).unwrap();
        let whole = fs::read(&path).unwrap();
        let (mut read, mut errors) = (0, 0);
        for _ in 0..500 {
            let mut bytes = whole.clone();
            for _ in 0..=random.bits() % 4 {
                let place = random.bits() as usize % bytes.len().min(500);
                bytes[place] = [0, 255, random.bits() as u8][random.bits() as usize % 3];
            }
            fs::write(&path, &bytes).unwrap();
            match read_recipe(&path) {
                Ok(_) => read += 1,
                Err(error) => {
                    assert!(error.to_string().contains("a.") && !error.to_string().is_empty());
                    errors += 1;
                }
            }
        }
        assert!(read > 20 && errors > 20, "{kind}: {read} read, {errors} errors");
    }
}

#[test]
fn a_name_decides_the_format_or_is_an_error_that_lists_them() {
    assert_eq!(Format::of(Path::new("a.png")).unwrap(), Format::Png);
    assert_eq!(Format::of(Path::new("b.c/a.ExR")).unwrap(), Format::Exr);
    for bad in ["a.jpg", "a", "a.", "png", ".exr"] {
        let text = Format::of(Path::new(bad)).unwrap_err().to_string();
        assert!(text.starts_with(bad) && text.contains(".png") && text.contains(".exr"), "{text}");
    }
}

#[test]
fn a_save_that_fails_leaves_the_old_file_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("precious.png");
    fs::write(&path, "old").unwrap();
    let error = replace_file(&path, |sink| {
        sink.write_all(b"half of the new")?;
        Err(io::Error::other("the disk is full"))
    })
    .unwrap_err();
    let text = error.to_string();
    assert!(text.contains("precious.png") && text.contains("the disk is full"), "{text}");
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_eq!(names(folder.path()), ["precious.png"]);

    // Pixels that do not fill the picture must not cost the old file either.
    let broken = Picture { width: 3, height: 3, pixels: vec![[0.0; 3]; 8] };
    let empty = Picture::black(0, 0);
    for (picture, name) in [(&broken, "precious.png"), (&broken, "b.exr"), (&empty, "c.exr")] {
        let error = write(&folder.path().join(name), picture, Tone::default()).unwrap_err();
        assert!(matches!(error, SaveError::Write { .. }), "{error}");
    }
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_eq!(names(folder.path()), ["precious.png"]);
}

#[test]
fn whether_a_file_can_be_written_is_known_beforehand() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    check_writable(&at("new.png")).unwrap();
    assert!(names(folder.path()).is_empty(), "a check leaves nothing behind");

    let missing = check_writable(&at("no/such/a.png")).unwrap_err().to_string();
    assert!(missing.contains("no/such/a.png") && missing.contains("folder"), "{missing}");
    assert!(!missing.contains(".part"), "{missing}");

    fs::create_dir(at("folder.png")).unwrap();
    assert!(matches!(check_writable(&at("folder.png")), Err(SaveError::NotAFile(_))));

    fs::write(at("kept.png"), "old").unwrap();
    let mut permissions = fs::metadata(at("kept.png")).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(at("kept.png"), permissions).unwrap();
    assert!(matches!(check_writable(&at("kept.png")), Err(SaveError::Protected(_))));
}

#[cfg(unix)]
#[test]
fn links_and_permissions_survive() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = tempfile::tempdir().unwrap();
    let (file, link) = (folder.path().join("file.png"), folder.path().join("link.png"));
    fs::write(&file, "old").unwrap();
    fs::set_permissions(&file, fs::Permissions::from_mode(0o640)).unwrap();
    symlink(&file, &link).unwrap();
    replace_file(&link, |sink| sink.write_all(b"new")).unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(fs::read(&file).unwrap(), b"new");
    assert_eq!(fs::metadata(&file).unwrap().permissions().mode() & 0o777, 0o640);
    // A new file is as readable as any other program's: the temporary one's 0600 must not show.
    let (fresh, plain) = (folder.path().join("fresh"), folder.path().join("plain"));
    replace_file(&fresh, |sink| sink.write_all(b"x")).unwrap();
    fs::write(&plain, "x").unwrap();
    let mode = |path| fs::metadata(path).unwrap().permissions().mode();
    assert_eq!(mode(&fresh), mode(&plain));
}

#[test]
fn broken_and_oversized_exr_files_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    write(&path, &Picture::black(16, 16), Tone::default()).unwrap();
    let whole = fs::read(&path).unwrap();
    for length in [0, 4, 100, whole.len() / 2, whole.len() - 1] {
        fs::write(&path, &whole[..length]).unwrap();
        let text = read_exr(&path).unwrap_err().to_string();
        assert!(text.contains("a.exr") && text.contains("32768"), "{length}: {text}");
    }
    let missing = read_exr(&folder.path().join("none.exr")).unwrap_err().to_string();
    assert!(missing.contains("none.exr"), "{missing}");

    // Every size that is rendered is read, and no larger one, whatever the memory.
    write(&path, &Picture::black(32_769, 1), Tone::default()).unwrap();
    assert!(read_exr(&path).is_err());
    for (width, height) in [(32_768, 1), (1, 32_768), (20_000, 2)] {
        let mut picture = Picture::black(width, height);
        picture.pixels.iter_mut().enumerate().for_each(|(i, p)| p[i % 3] = i as f32);
        write(&path, &picture, Tone::default()).unwrap();
        assert!(read_exr(&path).unwrap() == picture, "{width}x{height}");
    }
}

/// A file in which these 32-bit numbers follow an attribute's name and type.
fn with_window(whole: &[u8], name: &str, window: [i32; 4]) -> Vec<u8> {
    let head = format!("{name}\0box2i\0\x10\0\0\0");
    let at = whole.windows(head.len()).position(|w| w == head.as_bytes()).unwrap() + head.len();
    let mut bytes = whole.to_vec();
    for (i, x) in window.into_iter().enumerate() {
        bytes[at + 4 * i..at + 4 * i + 4].copy_from_slice(&x.to_le_bytes());
    }
    bytes
}

/// Kind: a header that claims more than the file can hold is refused; how many bytes it takes is
/// measured in tests/fuzz.
#[test]
fn claims_that_the_file_cannot_hold_are_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    write(&path, &Picture::black(16, 16), Tone::default()).unwrap();
    let whole = fs::read(&path).unwrap();
    let [most, least] = [i32::MAX / 2 - 1, -(i32::MAX / 2)];
    for name in ["dataWindow", "displayWindow"] {
        for window in [
            [0, 0, 0x0fff_ffff, 15],
            [0, 0, 15, 0x0fff_ffff],
            [0, 0, 32_767, 32_767],
            [least, least, most, most],
            [-16_000, -16_000, 16_000, 16_000],
        ] {
            fs::write(&path, with_window(&whole, name, window)).unwrap();
            let text = read_exr(&path).unwrap_err().to_string();
            assert!(
                text.contains("a.exr") && text.lines().count() == 1,
                "{name} {window:?}: {text}"
            );
        }
    }
    // What lies outside the display window is left out and told; what it has beyond is black.
    let pixels = (0..256).map(|i| [i as f32; 3]).collect();
    write(&path, &Picture { width: 16, height: 16, pixels }, Tone::default()).unwrap();
    let whole = fs::read(&path).unwrap();
    fs::write(&path, with_window(&whole, "displayWindow", [-2, 4, 9, 20])).unwrap();
    let read = read_exr_part(&path, None).unwrap();
    assert_eq!((read.picture.width, read.picture.height), (12, 17));
    assert_eq!(read.picture.pixels[0], [0.0; 3]);
    assert_eq!(read.picture.pixels[2], [64.0; 3]);
    assert_eq!(read.picture.pixels[12 * 16 + 5], [0.0; 3]);
    assert_eq!(
        read.remarks,
        ["136 of its 256 pixels lie outside its display window and are left out"]
    );
}

/// An OpenEXR file of several parts, each with a name and channels of one value each.
fn parts(
    path: &Path,
    parts: &[(&str, &[(&str, f32)])],
    change: impl Fn(&mut exr::prelude::ImageAttributes),
) {
    use exr::prelude::*;
    let layers: SmallVec<[Layer<AnyChannels<FlatSamples>>; 2]> = parts
        .iter()
        .map(|(name, channels)| {
            let size = Vec2(6, 4);
            let channels = channels
                .iter()
                .map(|(name, value)| {
                    // Small numbers are written in half precision, as most programs do.
                    let samples = if *value == value.trunc() {
                        FlatSamples::F16(vec![f16::from_f32(*value); 24])
                    } else {
                        FlatSamples::F32(vec![*value; 24])
                    };
                    AnyChannel::new(*name, samples)
                })
                .collect();
            let attributes = LayerAttributes::named(*name);
            let encoding = Encoding::SMALL_LOSSLESS;
            Layer::new(size, attributes, encoding, AnyChannels::sort(channels))
        })
        .collect();
    let mut attributes = ImageAttributes::new(IntegerBounds::from_dimensions((6, 4)));
    change(&mut attributes);
    Image::from_layers(attributes, layers).write().to_file(path).unwrap();
}

/// Kind: a file of several parts.
#[test]
fn one_of_several_parts_is_read_by_its_name_and_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let rgb = |x: f32| [("R", x), ("G", x + 1.0), ("B", x + 2.0)];
    parts(&path, &[("depth", &[("Z", 9.0)]), ("albedo", &rgb(1.0)), ("beauty", &rgb(4.5))], |_| {});
    let has = "part `depth` (Z), part `albedo` (B, G, R), part `beauty` (B, G, R)";
    for (part, name, first) in [
        (None, "albedo", 1.0),
        (Some("albedo"), "albedo", 1.0),
        (Some("beauty"), "beauty", 4.5),
        (Some("BEAUTY"), "beauty", 4.5),
    ] {
        let read = read_exr_part(&path, part).unwrap();
        assert_eq!(read.picture.pixels, [[first, first + 1.0, first + 2.0]; 24], "{part:?}");
        assert_eq!(read.remarks, [format!("of the pictures in it `{name}` is read: it has {has}")]);
        assert_eq!(read.choices, 2);
    }
    for missing in ["depth", "shadow", "\u{1b}[2J", ""] {
        let text = read_exr_part(&path, Some(missing)).unwrap_err().to_string();
        assert!(text.contains(has) && !text.contains('\u{1b}'), "{text}");
    }
    assert_eq!(contents(&path).unwrap(), format!("6x4 pixels, {has}"));
    assert!(read_recipe_of(&path, Some("shadow")).unwrap_err().to_string().contains(has));
    assert_eq!(read_recipe_of(&path, Some("beauty")).unwrap(), None);
    // A name with characters that steer a terminal.
    parts(&path, &[("a\u{1b}[2J", &rgb(1.0)), ("b", &rgb(2.0))], |_| {});
    let read = read_exr_part(&path, None).unwrap();
    assert!(read.remarks[0].contains("`a\\u{1b}[2J`"), "{:?}", read.remarks);
    // A file with one picture has that one.
    parts(&path, &[("only", &rgb(3.0))], |_| {});
    assert_eq!(read_exr_part(&path, Some("other")).unwrap().picture.pixels[0], [3.0, 4.0, 5.0]);
    assert_eq!(read_exr_part(&path, None).unwrap().remarks, [""; 0]);
}

/// Kinds: layers within a part, channels in lower case or by their words, and Y alone.
#[test]
fn channels_by_other_names_are_read_or_listed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    type Channels<'a> = &'a [(&'a str, f32)];
    let cases: [(Channels, Option<&str>, [f32; 3], &str); 9] = [
        (
            &[("beauty.R", 1.0), ("beauty.G", 2.0), ("beauty.B", 3.0)],
            None,
            [1.0, 2.0, 3.0],
            "its channels beauty.R, beauty.G, beauty.B are read as R, G, B",
        ),
        (&[("r", 1.0), ("g", 2.0), ("b", 3.0)], None, [1.0, 2.0, 3.0], "its channels r, g, b are"),
        (
            &[("red", 1.0), ("green", 2.0), ("blue", 3.0), ("A", 1.0)],
            None,
            [1.0, 2.0, 3.0],
            "its channels red, green, blue are read",
        ),
        (&[("R", 1.0), ("G", 2.0), ("B", 3.0), ("b", 4.0)], None, [1.0, 2.0, 3.0], ""),
        (&[("Y", 5.0)], None, [5.0; 3], "its channel Y is read as grey"),
        (&[("y", 5.0), ("A", 1.0)], None, [5.0; 3], "its channel y is read as grey"),
        (
            &[
                ("a.R", 1.0),
                ("a.G", 2.0),
                ("a.B", 3.0),
                ("b.c.R", 4.0),
                ("b.c.G", 5.0),
                ("b.c.B", 6.0),
            ],
            Some("b.c"),
            [4.0, 5.0, 6.0],
            "of the pictures in it `b.c` is read",
        ),
        (
            &[("R", 1.0), ("G", 2.0), ("B", 3.0), ("z.R", 4.0), ("z.G", 5.0), ("z.B", 6.0)],
            None,
            [1.0, 2.0, 3.0],
            "of the pictures in it the one without a layer is read",
        ),
        (
            &[("R", 1.0), ("G", 2.0), ("B", 3.0), ("z.R", 4.0), ("z.G", 5.0), ("z.B", 6.0)],
            Some("z"),
            [4.0, 5.0, 6.0],
            "of the pictures in it `z` is read",
        ),
    ];
    for (channels, part, pixel, told) in cases {
        // A part without a name, as files of one part are.
        parts(&path, &[("", channels)], |_| {});
        let read = read_exr_part(&path, part).unwrap();
        assert_eq!(read.picture.pixels, [pixel; 24], "{channels:?}");
        let all = read.remarks.join("; ");
        assert!(all.contains(told) && all.is_empty() == told.is_empty(), "{channels:?}: {all}");
    }
    for channels in [&[("Z", 1.0)][..], &[("R", 1.0), ("G", 2.0)], &[("U", 1.0), ("V", 1.0)]] {
        parts(&path, &[("", channels)], |_| {});
        let text = read_exr(&path).unwrap_err().to_string();
        let names: Vec<&str> = channels.iter().map(|(name, _)| *name).collect();
        let mut names = names;
        names.sort_unstable();
        assert!(
            text.contains(&names.join(", ")) && text.contains("no red, green and blue"),
            "{text}"
        );
    }
}

/// Kind: a file that cannot be read at all still says what it has.
#[test]
fn chroma_of_fewer_samples_is_an_error_that_lists_the_channels() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    parts(&path, &[("", &[("BY", 0.5), ("RY", 0.5), ("Y", 1.0)])], |_| {});
    assert_eq!(read_exr(&path).unwrap().pixels[0], [1.0; 3]);
    let mut bytes = fs::read(&path).unwrap();
    for name in [&b"BY\0"[..], b"RY\0"] {
        let at = bytes.windows(3).position(|w| w == name).unwrap() + 3;
        // Behind type, linearity and three bytes that are kept free.
        bytes[at + 8..at + 16].copy_from_slice(&[2, 0, 0, 0, 2, 0, 0, 0]);
    }
    fs::write(&path, bytes).unwrap();
    let text = read_exr(&path).unwrap_err().to_string();
    assert!(text.contains("the file has channels BY, RY, Y"), "{text}");
}

/// Kind: colours of other primaries than Rec. 709.
#[test]
fn colours_of_other_primaries_are_converted_and_told() {
    use exr::meta::attribute::Chromaticities;
    use exr::prelude::Vec2;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let of = |c: [f32; 8]| {
        let point = |i: usize| Vec2(c[i], c[i + 1]);
        Some(Chromaticities { red: point(0), green: point(2), blue: point(4), white: point(6) })
    };
    let d65 = [0.3127, 0.329];
    let rec_709 = [0.64, 0.33, 0.3, 0.6, 0.15, 0.06, d65[0], d65[1]];
    let rec_2020 = [0.708, 0.292, 0.17, 0.797, 0.131, 0.046, d65[0], d65[1]];
    let p3 = [0.68, 0.32, 0.265, 0.69, 0.15, 0.06, d65[0], d65[1]];
    let none = [0.3, 0.3, 0.3, 0.3, 0.3, 0.3, d65[0], d65[1]];
    let write = |chromaticities: [f32; 8], [r, g, b]: [f32; 3]| {
        parts(&path, &[("", &[("R", r), ("G", g), ("B", b)])], |a| {
            a.chromaticities = of(chromaticities);
        });
        let read = read_exr_part(&path, None).unwrap();
        (read.picture.pixels[7], read.remarks)
    };
    assert_eq!(write(rec_709, [0.25, 0.5, 3.5]), ([0.25, 0.5, 3.5], vec![]));
    let mut written_short = rec_709;
    written_short[6..].copy_from_slice(&[0.31271, 0.32902]);
    assert_eq!(write(written_short, [0.25, 0.5, 3.5]).1, [""; 0]);
    // The published matrices, to the digits that the primaries have.
    for (primaries, expected) in
        [(rec_2020, [1.6605, -0.1246, -0.0182]), (p3, [1.2249, -0.0420, -0.0197])]
    {
        let (pixel, told) = write(primaries, [1.0, 0.0, 0.0]);
        for (got, wanted) in pixel.iter().zip(expected) {
            assert!((got - wanted).abs() < 2e-4, "{pixel:?}");
        }
        assert!(told[0].contains("converted to Rec. 709"), "{told:?}");
        let (white, _) = write(primaries, [0.5; 3]);
        assert!(white.iter().all(|x| (x - 0.5).abs() < 1e-6), "{white:?}");
    }
    let (pixel, told) = write(none, [0.25, 0.5, 3.5]);
    assert_eq!(pixel, [0.25, 0.5, 3.5]);
    assert!(told[0].contains("make no colours: read as Rec. 709"), "{told:?}");
}

/// One to four bytes changed, mostly in the header: what is read is a picture or an error with the
/// file's name, and neither a panic nor a wait.
#[test]
fn damaged_exr_files_are_pictures_or_errors() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let pixels = (0..180).map(|i| [i as f32, 1.0 / (i as f32 + 1.0), 0.5]).collect();
    write(&path, &Picture { width: 20, height: 9, pixels }, Tone::default()).unwrap();
    let whole = fs::read(&path).unwrap();
    let mut random = Random::new(3);
    let (mut pictures, mut errors) = (0, 0);
    for _ in 0..500 {
        let mut bytes = whole.clone();
        for _ in 0..=random.bits() % 4 {
            let part = if random.bits().is_multiple_of(4) { bytes.len() } else { 400 };
            let place = random.bits() as usize % part;
            bytes[place] = [0, 255, random.bits() as u8][random.bits() as usize % 3];
        }
        fs::write(&path, &bytes).unwrap();
        match read_exr(&path) {
            Ok(picture) => {
                assert_eq!(
                    picture.pixels.len() as u64,
                    picture.width as u64 * picture.height as u64
                );
                pictures += 1;
            }
            Err(error) => {
                assert!(error.to_string().contains("a.exr"), "{error}");
                errors += 1;
            }
        }
    }
    assert!(pictures > 50 && errors > 50, "{pictures} pictures, {errors} errors");
}

/// A picture of another kind is called what it is, whatever its name.
#[test]
fn other_kinds_of_pictures_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let jpeg = [0xff, 0xd8, 0xff, 0xe0, 0, 16, b'J', b'F', b'I', b'F', 0, 1, 1, 0, 0, 1];
    let png = [0x89, b'P', b'N', b'G', 13, 10, 26, 10, 0, 0, 0, 13, b'I', b'H', b'D', b'R'];
    for (name, start) in [("JPG", jpeg), ("PNG", png)] {
        let path = folder.path().join("other.exr");
        std::fs::write(&path, start).unwrap();
        let told = read_exr(&path).unwrap_err().to_string();
        assert!(told.contains(&format!("this is a {name} file")), "{told}");
    }
}
