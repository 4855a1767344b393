//! Mip levels: the normals of mean slopes.
//!
//! Level k of a map of w x h texels has w_k x h_k = max(1, floor(w / 2^k)) x max(1, floor(h / 2^k)). Its texel (i, j) is
//! the rectangle from i w/w_k to (i + 1) w/w_k and from j h/h_k to (j + 1) h/h_k of level 0; the texels at its sides
//! count by the part of them that it covers. Its slope is the mean of the slopes there, which know the filter and what
//! lies beyond the borders, and its normal and codes come from that slope as those of level 0 do. (The mean of normals
//! has another direction: steep texels count less, since the z of all of them is not the same.) Its parallax is
//! n_z (2h - 1) with its own n_z and the mean height.
//!
//! For integer heights the mean is a ratio of whole numbers, and each code is the nearest to what it gives. Float
//! heights are summed up in f64 in the order that [`pyramid::Pyramid`] tells, and their mean is rounded to f32 once.

mod axis;
mod bake;
mod flat;
mod level;
mod maps;
mod pyramid;
mod roughness;
mod roughness_levels;
mod rows;
mod sample;
mod tee;

pub(crate) use bake::{Bake, LevelsOut, MapSinks, held_bytes};
pub use roughness::{RoughnessMethod, RoughnessOptions};
