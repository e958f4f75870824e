//! Pictures through the engine: the same bits on every processor.

use super::super::Isa;
use crate::progressive::{Params, render};
use crate::scene::builtin::Example;
use std::sync::Arc;
use std::{env, fs};

/// A mesh with every kind of surface, walls that light each other, and a light tree, which alone asks
/// the system's library for an angle. Few, for an emulated processor takes its time.
const SCENES: [&str; 3] = ["default", "cornell", "lights"];

fn bytes(example: &Example, isa: Isa) -> Vec<u8> {
    let mut scene = example.read().unwrap().0.build();
    scene.set_isa(isa);
    let params = Params { size: [40, 30], ..Params::new(Arc::new(scene)) };
    let picture = render(params, 2, 1).unwrap().mean();
    picture.pixels.iter().flatten().flat_map(|x| x.to_le_bytes()).collect()
}

/// With fused sums all sets give one picture and the portable set another, within the machine. Where
/// `BURNISH_PICTURES` names a folder, both go there as numbers, to be held against another machine's:
/// `.ci/aarch64.sh` does that.
#[test]
fn every_fused_set_makes_one_picture() {
    let folder = env::var_os("BURNISH_PICTURES");
    for example in SCENES.map(|name| Example::named(name).unwrap()) {
        let mut fused: Option<Vec<u8>> = None;
        for isa in Isa::available() {
            let found = bytes(example, isa);
            let kind = if isa == Isa::Portable { "portable" } else { "fused" };
            if let Some(folder) = &folder {
                let name = format!("{}-{kind}.f32", example.name);
                fs::write(std::path::Path::new(folder).join(name), &found).unwrap();
            }
            if isa != Isa::Portable {
                let first = fused.get_or_insert_with(|| found.clone());
                assert!(*first == found, "{} by {}", example.name, isa.name());
            }
        }
    }
}
