//! One picture on the card, and its successor of another size until that can be shown.

use super::texture::{Look, PictureTexture};
use burnish::progressive::Snapshot;
use egui::{Context, TextureOptions};

#[derive(Default)]
pub(crate) struct Side {
    pub(crate) texture: Option<PictureTexture>,
    /// A picture of another size, until there is something of it to be seen.
    next: Option<PictureTexture>,
}

impl Side {
    /// Whether all that has come is shown.
    #[cfg(test)]
    pub(crate) fn is_settled(&self) -> bool {
        self.next.is_none() && self.texture.as_ref().is_none_or(|t| !t.is_busy())
    }

    /// Width and height of the picture, where there is one.
    pub(crate) fn size(&self) -> Option<[u32; 2]> {
        self.texture.as_ref().map(PictureTexture::size)
    }

    /// Takes over the tiles of a snapshot. Whether any is new.
    pub(crate) fn show(&mut self, snapshot: &Snapshot, look: Look) -> bool {
        if snapshot.tiles.iter().all(Option::is_none) {
            return false;
        }
        let fits = |t: &&mut PictureTexture| t.size() == snapshot.grid.size;
        let texture = match self.texture.as_mut().filter(fits) {
            Some(texture) => {
                self.next = None;
                texture
            }
            None => {
                let next = self.next.take().filter(|t| t.size() == snapshot.grid.size);
                let fresh = || PictureTexture::new(snapshot.grid, look);
                self.next.insert(next.unwrap_or_else(fresh))
            }
        };
        texture.show(snapshot)
    }

    /// Brings what is on the card up to date.
    pub(crate) fn refresh(&mut self, ctx: &Context, look: Look, options: TextureOptions) {
        for texture in [&mut self.texture, &mut self.next].into_iter().flatten() {
            texture.restyle(look, options);
            texture.refresh(ctx);
        }
        if self.next.as_ref().is_some_and(PictureTexture::is_ready) {
            self.texture = self.next.take();
        }
    }
}
