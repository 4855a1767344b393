//! The CPU: the plain reference, and the vectorised, threaded implementation that gives the same bytes.

mod reference;

pub(crate) use reference::Reference;
