//! Files that are legal and small, and unpack to a thousand times as much: what does not fit is refused before it
//! is unpacked, what fits is read in memory that is bounded.

use super::bounded::{EACH, FREE, bounded};
use super::{TURN, exr, folder, on_one_thread};
use burnish::limits::{EXR_FREE_BYTES, TEXT_BYTES};
use burnish::picture::{read_exr_part, read_recipe};
use std::sync::PoisonError;

/// A megabyte of zeros as OpenEXR packs them is a gigabyte, which nobody needs.
#[test]
fn zeros_that_unpack_to_a_gigabyte_are_refused_and_less_is_read() {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let folder = folder();
    let path = folder.path().join("zeros.exr");
    let raw = |strips: usize| strips * exr::STRIP;
    let most_free = EXR_FREE_BYTES as usize / exr::STRIP;
    for strips in [10, most_free / 2, most_free + 1, 340] {
        let bytes = exr::zeros(strips);
        assert!(bytes.len() < raw(strips) / 500, "{} bytes are not packed well", bytes.len());
        std::fs::write(&path, &bytes).unwrap();
        let fits = raw(strips) as u64 <= EXR_FREE_BYTES;
        // The samples, as they are unpacked, and the picture made of them.
        let most = FREE + EACH * bytes.len() + if fits { 3 * raw(strips) } else { 0 };
        on_one_thread(|| {
            // Of the file a message has to show no more than its beginning.
            let read = bounded(most, &bytes[..400], 0, || read_exr_part(&path, None));
            match read {
                Ok(read) => {
                    assert!(fits, "{strips} strips were read");
                    assert_eq!([read.picture.width, read.picture.height], exr::zeros_size(strips));
                    assert!(read.picture.pixels.iter().all(|pixel| *pixel == [0.0; 3]));
                }
                Err(e) => {
                    let told = e.to_string();
                    assert!(
                        !fits && told.contains("zeros.exr: ") && told.contains("MiB"),
                        "{told}"
                    );
                }
            }
        });
    }
}

/// Texts of every kind beside the pixels of a PNG picture, of 160 MB each in a megabyte.
#[test]
fn texts_of_pictures_are_unpacked_to_their_limit() {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let folder = folder();
    let path = folder.path().join("text.png");
    let mut refused = 0;
    for (kind, bytes) in exr::png_bombs() {
        assert!(bytes.len() < 1 << 20, "{kind}: {} bytes", bytes.len());
        std::fs::write(&path, &bytes).unwrap();
        let most = FREE + 8 * TEXT_BYTES;
        on_one_thread(|| {
            let read = bounded(most, kind.as_bytes(), 0, || read_recipe(&path));
            if let Err(e) = read {
                refused += 1;
                assert!(super::is_fit(&e.to_string()), "{e}");
            }
        });
    }
    // That of a recipe; what is none is passed over.
    assert!(refused >= 1, "nothing was refused");
}
