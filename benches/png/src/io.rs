//! What texbake's stripes ask of texbake.

/// The levels of `--compression`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compression {
    Fast,
    Balanced,
    Small,
}
