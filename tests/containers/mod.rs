//! KTX2 and DDS files: what they hold by the specifications, by other readers, and on GPUs.

mod angles;
mod blocks;
mod bytes;
#[cfg(feature = "gpu")]
mod device;
#[cfg(feature = "gpu")]
mod gpu;
mod made;
mod parsed;
mod readers;
mod refused;
mod rows;
mod streamed;
