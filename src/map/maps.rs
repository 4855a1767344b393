//! The maps of one material.

/// What a bake makes of a height map: a normal map, a parallax map, or both, and perhaps the roughness of their mip levels.
#[derive(Debug, Clone, PartialEq)]
pub struct Maps<N, P = N, R = N> {
    /// The normal map, if it was asked for.
    pub normal: Option<N>,
    /// The parallax map, if it was asked for.
    pub parallax: Option<P>,
    /// The roughness map, if it was asked for.
    pub roughness: Option<R>,
}

impl<N, P, R> Default for Maps<N, P, R> {
    /// No map.
    fn default() -> Self {
        Self { normal: None, parallax: None, roughness: None }
    }
}

impl<T> Maps<T> {
    /// The maps that there are: normal, parallax, roughness.
    pub fn iter(&self) -> impl Iterator<Item = &T> {
        self.normal.iter().chain(&self.parallax).chain(&self.roughness)
    }

    /// The maps that there are: normal, parallax, roughness.
    pub fn into_vec(self) -> Vec<T> {
        self.normal.into_iter().chain(self.parallax).chain(self.roughness).collect()
    }
}
