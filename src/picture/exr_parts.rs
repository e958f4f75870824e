//! Several pictures of one size in one OpenEXR file, each a part with a name of its own.

use super::files::{describe, exr_error, part};
use super::{Format, Picture, SaveError, Sink, replace_file};
use exr::prelude::{
    AnyChannel, FlatSamples, Image, ImageAttributes, IntegerBounds, Layers, Vec2, WritableImage,
};
use std::io;
use std::path::Path;

/// A picture of several.
#[derive(Clone, Debug)]
pub struct Part<'a> {
    /// What its part is called: each another name. Programs that know no other characters in it than
    /// letters, digits and underscores are many.
    pub name: String,
    /// All parts have one size.
    pub picture: &'a Picture,
    /// How it was made; [`read_recipe_of`](super::read_recipe_of) gives it back.
    pub recipe: String,
}

/// Writes all of them to an `.exr` file, the first first: that is what programs show which know of one
/// picture a file. Channels R, G, B of 32-bit floats, as in a file with one picture. The file is there as a
/// whole or, after an error, as it was before.
pub fn write_parts(path: &Path, parts: &[Part]) -> Result<(), SaveError> {
    if Format::of(path)? != Format::Exr {
        return Err(SaveError::Format(path.to_path_buf()));
    }
    let invalid = |text: &str| io::Error::new(io::ErrorKind::InvalidInput, text);
    replace_file(path, |sink| {
        let Some(first) = parts.first() else { return Err(invalid("no picture")) };
        let Picture { width, height, .. } = first.picture;
        let area = *width as usize * *height as usize;
        let alike = |p: &Picture| {
            [p.width, p.height] == [*width, *height] && p.pixels.len() == area && area > 0
        };
        if !parts.iter().all(|part| alike(part.picture)) {
            return Err(invalid("pictures of several sizes do not make parts of one file"));
        }
        as_parts(Vec2(*width as usize, *height as usize), parts, sink)
    })
}

fn as_parts(size: Vec2<usize>, parts: &[Part], sink: &mut dyn Sink) -> io::Result<()> {
    let layer = |p: &Part| {
        let colour = |c: usize| FlatSamples::F32(p.picture.pixels.iter().map(|p| p[c]).collect());
        let rgb = [("R", colour(0)), ("G", colour(1)), ("B", colour(2))];
        let channels = rgb.into_iter().map(|(name, all)| AnyChannel::new(name, all)).collect();
        let mut layer = part(size, &p.name, channels);
        describe(&mut layer.attributes, Some(&p.recipe));
        layer
    };
    let layers: Layers<_> = parts.iter().map(layer).collect();
    let bounds = IntegerBounds::from_dimensions(size);
    let image = Image::from_layers(ImageAttributes::new(bounds), layers);
    image.write().to_buffered(sink).map_err(exr_error)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::{read_exr, read_exr_part, read_recipe_of};

    #[test]
    fn every_part_comes_back_by_its_name_with_its_recipe() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("all.exr");
        let picture = |k: usize| Picture {
            width: 9,
            height: 5,
            pixels: (0..45).map(|i| [i as f32, k as f32, -0.5]).collect(),
        };
        let pictures: Vec<Picture> = (0..3).map(picture).collect();
        let parts: Vec<Part> = (0..3)
            .map(|k| Part {
                name: format!("ggx_alpha_0p{k}"),
                picture: &pictures[k],
                recipe: format!("recipe {k}"),
            })
            .collect();
        write_parts(&path, &parts).unwrap();
        for part in &parts {
            let read = read_exr_part(&path, Some(&part.name)).unwrap();
            assert!(read.picture == *part.picture && read.choices == 3);
            let recipe = read_recipe_of(&path, Some(&part.name)).unwrap().unwrap();
            assert_eq!(
                (recipe.text, recipe.part.as_ref()),
                (part.recipe.clone(), Some(&part.name))
            );
        }
        assert!(read_exr(&path).unwrap() == pictures[0], "the first where one is asked for");
        // The same content makes the same file.
        let before = std::fs::read(&path).unwrap();
        write_parts(&path, &parts).unwrap();
        assert!(std::fs::read(&path).unwrap() == before);
    }

    #[test]
    fn what_makes_no_file_is_refused_and_nothing_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("all.exr");
        let [a, b] = [Picture::black(4, 3), Picture::black(3, 4)];
        let part = |name: &str, picture| Part { name: name.into(), picture, recipe: String::new() };
        assert!(write_parts(&path, &[]).is_err());
        assert!(write_parts(&path, &[part("a", &a), part("b", &b)]).is_err());
        assert!(write_parts(&folder.path().join("all.png"), &[part("a", &a)]).is_err());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
