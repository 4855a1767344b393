//! What texbake itself encodes with, from its sources.

#[path = "../../../src/io/png/deflate/mod.rs"]
pub mod deflate;
#[path = "../../../src/io/png/filter.rs"]
pub mod filter;
#[path = "../../../src/io/png/stripe.rs"]
pub mod stripe;
#[path = "experiment.rs"]
pub mod experiment;
