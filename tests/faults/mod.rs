//! What goes wrong around a bake, really caused: no half file, no hang, no panic.

#[cfg(all(feature = "cli", feature = "gpu"))]
mod gpu;
#[cfg(all(feature = "cli", unix))]
mod interrupt;
#[cfg(all(feature = "cli", unix))]
mod kill;
#[cfg(all(feature = "cli", unix))]
mod paused;
