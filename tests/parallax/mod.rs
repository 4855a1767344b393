//! Parallax maps.
