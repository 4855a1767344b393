//! Maps with what their numbers mean attached.

mod code_map;
mod codes;
mod format;
mod grid;
mod height;
mod maps;

pub use code_map::{CodeMap, NormalMap, ParallaxMap, RoughnessMap};
pub use codes::{Codes, CodesMut, CodesRef};
pub(crate) use format::TexelFormat;
pub use format::{
    Channels, Convention, Depth, Edge, Edges, Encoding, MapFormat, NormalFormat, ParallaxFormat, RoughnessFormat,
};
pub use grid::{Grid, Size};
pub use height::{HeightMap, HeightType, Heights, HeightsMut};
pub use maps::Maps;
