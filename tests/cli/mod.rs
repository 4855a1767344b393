//! The program itself, run in folders of its own.

mod blend;
mod check;
mod diff;
mod errors;
mod folder;
mod help;
mod maps;
mod memory;
mod mips;
mod normal;
mod parallax;
mod plan_settings;
mod report;
mod resources;
mod settings;
mod shaders;
pub mod support;
pub mod tangents;
mod textures;
mod tiles;
