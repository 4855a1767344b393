//! What goes wrong around a bake, really caused: no half file, no hang, no panic.

#[cfg(all(feature = "cli", target_os = "linux"))]
mod disk;
#[cfg(all(feature = "cli", unix))]
mod files;
#[cfg(all(feature = "cli", feature = "gpu"))]
mod gpu;
#[cfg(all(feature = "cli", unix))]
mod interrupt;
#[cfg(all(feature = "cli", unix))]
mod kill;
#[cfg(all(feature = "cli", unix))]
mod paused;
#[cfg(all(feature = "cli", target_os = "linux"))]
mod unheard;
#[cfg(all(feature = "cli", unix))]
pub mod watched;
