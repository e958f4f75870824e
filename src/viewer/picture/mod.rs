//! The picture on the screen: its textures, the pointer over it, the camera that the pointer moves.

pub(crate) mod canvas;
pub(crate) mod crop;
pub(crate) mod difference;
pub(crate) mod false_colour;
pub(crate) mod frozen;
pub(crate) mod legend;
pub(crate) mod maps;
pub(crate) mod orbit;
pub(crate) mod side;
pub(crate) mod texture;
pub(crate) mod versus;
