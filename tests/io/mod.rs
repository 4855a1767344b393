//! Reading height maps and writing normal maps.

mod png;
mod raw;
mod support;
