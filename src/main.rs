//! texbake
fn main() {}
