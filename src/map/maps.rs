//! The maps of one material.

/// What a bake makes of a height map: a normal map, a parallax map, or both.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Maps<N, P = N> {
    /// The normal map, if it was asked for.
    pub normal: Option<N>,
    /// The parallax map, if it was asked for.
    pub parallax: Option<P>,
}

impl<T> Maps<T> {
    /// The maps that there are: normal, then parallax.
    pub fn iter(&self) -> impl Iterator<Item = &T> {
        self.normal.iter().chain(&self.parallax)
    }

    /// The maps that there are: normal, then parallax.
    pub fn into_vec(self) -> Vec<T> {
        self.normal.into_iter().chain(self.parallax).collect()
    }
}
