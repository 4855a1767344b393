//! What each shortcut costs, measured on the user's own maps.

mod errors;
mod normals;
mod offsets;
mod time;

pub use errors::Errors;
pub use normals::TrueNormals;
pub use offsets::{View, Views};
pub use time::median_time;
