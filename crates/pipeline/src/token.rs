//! Who the tokens of a channel are.

/// Who a token is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Token {
    /// Frame, from 0.
    pub frame: u32,
    /// Plane of ray slots; of a beam counted over all sections of its frame.
    pub plane: u32,
    /// A beam's depth, or a ray's slot.
    pub place: u32,
}

/// What the tokens of a channel are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TokenKind {
    /// A beam of voxels of a plane at a depth.
    Beam,
    /// A ray slot of a plane.
    Ray,
}

impl TokenKind {
    /// The kind's name.
    pub fn name(self) -> &'static str {
        match self {
            TokenKind::Beam => "beam",
            TokenKind::Ray => "ray",
        }
    }

    /// What the place of its tokens is.
    pub fn place(self) -> &'static str {
        match self {
            TokenKind::Beam => "depth",
            TokenKind::Ray => "slot",
        }
    }
}
