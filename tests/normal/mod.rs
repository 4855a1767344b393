//! Height map to normal map.

mod closed_forms;
mod edges;
mod eight_bits;
mod float_heights;
mod options;
mod scales;
mod sixteen_bits;
