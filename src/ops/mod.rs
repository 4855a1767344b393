//! The operations: their options, their kernels' parameters and their CPU reference, one stem for each.

pub mod normal;
