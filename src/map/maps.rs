//! The maps of one material.

use crate::error::{Error, Result};

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

    /// What becomes of each map.
    pub(crate) fn map<U>(self, mut turn: impl FnMut(T) -> U) -> Maps<U> {
        let Self { normal, parallax, roughness } = self;
        Maps { normal: normal.map(&mut turn), parallax: parallax.map(&mut turn), roughness: roughness.map(turn) }
    }

    /// What becomes of each map, unless one fails.
    pub(crate) fn try_map<U>(self, mut turn: impl FnMut(T) -> Result<U>) -> Result<Maps<U>> {
        let Self { normal, parallax, roughness } = self;
        Ok(Maps {
            normal: normal.map(&mut turn).transpose()?,
            parallax: parallax.map(&mut turn).transpose()?,
            roughness: roughness.map(turn).transpose()?,
        })
    }

    /// Each map by reference.
    pub(crate) fn as_mut(&mut self) -> Maps<&mut T> {
        let Self { normal, parallax, roughness } = self;
        Maps { normal: normal.as_mut(), parallax: parallax.as_mut(), roughness: roughness.as_mut() }
    }

    /// Each map with what belongs to it in `others`.
    ///
    /// # Errors
    /// [`Error::Parameter`] unless these are the maps that `others` has too.
    pub(crate) fn pair<U>(self, others: Maps<U>) -> Result<Maps<(T, U)>> {
        let differ = self.normal.is_some() != others.normal.is_some()
            || self.parallax.is_some() != others.parallax.is_some()
            || self.roughness.is_some() != others.roughness.is_some();
        if differ {
            return Err(Error::parameter("maps", "others", "those that the options ask for"));
        }
        Ok(Maps {
            normal: self.normal.zip(others.normal),
            parallax: self.parallax.zip(others.parallax),
            roughness: self.roughness.zip(others.roughness),
        })
    }
}

impl<T> IntoIterator for Maps<T> {
    type Item = T;
    type IntoIter = std::iter::Flatten<std::array::IntoIter<Option<T>, 3>>;

    /// The maps that there are: normal, parallax, roughness.
    fn into_iter(self) -> Self::IntoIter {
        [self.normal, self.parallax, self.roughness].into_iter().flatten()
    }
}
