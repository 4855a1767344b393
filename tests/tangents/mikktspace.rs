//! MikkTSpace against its own implementations.
