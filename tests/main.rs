//! One test binary: every topic is a folder, and README.md says what proves what.

mod blend;
#[cfg(feature = "cli")]
mod cli;
mod containers;
mod extremes;
mod faults;
#[cfg(feature = "cli")]
mod fresh;
#[cfg(feature = "gpu")]
mod gpu;
mod inspect;
mod io;
mod large;
mod material;
mod materials;
mod measure;
mod mips;
mod normal;
mod oracle;
mod parallax;
#[cfg(feature = "cli")]
mod plan;
#[cfg(feature = "cli")]
mod preview;
mod properties;
mod sabotage;
mod shading;
mod stream;
mod support;
mod tangents;
mod verify;
