//! What to do about a file of a kind that is not read.

use std::path::Path;

const NOT_READ: &str = "files of this kind are not read, only .scn, .obj and .ply";

/// Endings of models that Assimp reads, in lower case.
const MODELS: &str = " 3d 3ds 3mf ac ac3d amf ase assbin assxml b3d blend c4d cob dae dxf fbx glb \
    gltf hmp ifc iqm irr irrmesh lwo lws lxo m3d md2 md3 md5mesh mdc mdl ms3d ndo nff off ogex \
    pmx q3d q3o q3s smd step stl stp ter usd usda usdc usdz vrm wrl x x3d xgl zgl ";
const PICTURES: &str = " bmp dds exr gif hdr jpeg jpg ktx ktx2 pbm pfm pgm pic png ppm psd svg tga \
    tif tiff webp ";
const PACKED: &str = " 7z bz2 gz rar tar tgz xz zip zst ";

/// One sentence about a file with this ending, which is in lower case.
pub(super) fn on(path: &Path, ending: &str) -> String {
    let is = |endings: &str| !ending.contains(' ') && endings.contains(&format!(" {ending} "));
    if is(MODELS) {
        let [from, to] = [path, &path.with_extension("obj")].map(as_word);
        return match (from, to) {
            (Some(from), Some(to)) => {
                format!("{NOT_READ}; a model can be converted: `assimp export {from} {to}`")
            }
            _ => format!("{NOT_READ}; a model can be converted by `assimp export`"),
        };
    }
    if ending == "mtl" {
        return format!("{NOT_READ}; this is a material library: open the .obj that names it");
    }
    if is(PICTURES) {
        let tells = match (ending, as_word(path)) {
            ("png" | "exr", Some(name)) => format!("; `burnish info {name}` tells what it is"),
            _ => String::new(),
        };
        return format!("{NOT_READ}; this is a picture{tells}");
    }
    if is(PACKED) {
        return format!("{NOT_READ}; it is packed: unpack it first");
    }
    if ending.ends_with(['"', '\'', '\u{201d}', '\u{2019}']) {
        return "the name must end in .scn, .obj or .ply: a quote belongs to it here".to_owned();
    }
    NOT_READ.to_owned()
}

/// A path as one word of a shell's command; `None` if that would not be the path any more, or
/// would be longer than a message ought to be.
fn as_word(path: &Path) -> Option<String> {
    const LONGEST: usize = 60;
    let text = path.to_str()?;
    if text.chars().count() > LONGEST || text.chars().any(char::is_control) {
        return None;
    }
    let plain = |c: char| c.is_alphanumeric() || "/._-+,=:@%".contains(c);
    if text.chars().all(plain) {
        return Some(text.to_owned());
    }
    Some(format!("'{}'", text.replace('\'', "'\\''")))
}
