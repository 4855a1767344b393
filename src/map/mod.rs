//! Maps with what their numbers mean attached.

mod codes;
mod format;
mod grid;
mod height;
mod normal;

pub use codes::{Codes, CodesMut, CodesRef};
pub use format::{Channels, Convention, Depth, Edge, Edges, Encoding, NormalFormat};
pub use grid::{Grid, Size};
pub use height::{HeightMap, HeightType, Heights, HeightsMut};
pub use normal::NormalMap;
