//! The program itself, run in folders of its own.

mod check;
mod diff;
mod errors;
mod folder;
mod help;
mod interrupt;
mod memory;
mod normal;
mod report;
mod settings;
mod support;
