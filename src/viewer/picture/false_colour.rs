//! The false colours of the present layer: one scale for the two pictures that are compared.

use crate::viewer::document::comparison::Layout;
use crate::viewer::picture::maps::{Layer, Scale};
use crate::viewer::picture::side::Side;
use crate::viewer::picture::texture::{Look, PictureTexture};
use burnish::picture::Tone;

/// The scale that a map's colours have at present.
#[derive(Default)]
pub(crate) struct FalseColour {
    scale: Option<Scale>,
    /// Whether tiles have come since the scale was made.
    pub(super) news: bool,
}

impl FalseColour {
    /// The look of tiles: on one scale for both pictures.
    pub(super) fn look(
        &mut self,
        layer: Layer,
        tone: Tone,
        layout: Option<Layout>,
        sides: &[Side; 2],
    ) -> Look {
        // A difference has colours of its own.
        if layer == Layer::Picture || layout == Some(Layout::Difference) {
            self.scale = None;
            return Look::Tone(tone);
        }
        let known = self.scale.filter(|scale| scale.layer == layer && !self.news);
        let scale = known.unwrap_or_else(|| {
            let textures = sides.iter().filter_map(|side| side.texture.as_ref());
            Scale::of(layer, textures.flat_map(PictureTexture::tiles), self.scale)
        });
        (self.scale, self.news) = (Some(scale), false);
        Look::Map(scale)
    }

    /// The scale, while colours are false ones.
    pub(crate) fn scale(&self) -> Option<Scale> {
        self.scale
    }
}
