//! Maps larger than memory, and the tiles of one: streamed results are those of maps in memory, whatever the file, and
//! no size needs more memory.

pub mod files;
mod interrupts;
#[cfg(feature = "cli")]
mod neighbours;
#[cfg(all(feature = "cli", target_os = "linux"))]
mod peaks;
#[cfg(all(feature = "cli", target_os = "linux"))]
mod sparse;
mod streamed;
mod strips;
