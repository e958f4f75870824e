//! The ways in which emitters lie to other surfaces.

/// How a scene's emitters lie to other surfaces. Kinds take turns, so that a fault can be told by
/// those that it is found in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EmitterKind {
    /// Emitters hang free.
    Free,
    /// Emitters touch surfaces: lie on them, stand on them.
    Touching,
    /// An emitter fills a hole of a wall, in its plane.
    Flush,
    /// Emitters reflect: walls that glow, emitters that are not black.
    Glowing,
    /// Emitters lie in the plane of a wall and on top of it: an emitter is in front of what coincides
    /// with it.
    Coincident,
}

impl EmitterKind {
    /// All of them, in turn.
    pub const ALL: [EmitterKind; 5] = [
        EmitterKind::Free,
        EmitterKind::Touching,
        EmitterKind::Flush,
        EmitterKind::Glowing,
        EmitterKind::Coincident,
    ];

    /// In a word.
    pub fn name(self) -> &'static str {
        match self {
            EmitterKind::Free => "free lamps",
            EmitterKind::Touching => "touching lamps",
            EmitterKind::Flush => "flush lamps",
            EmitterKind::Glowing => "glowing surfaces",
            EmitterKind::Coincident => "coincident lamps",
        }
    }
}
