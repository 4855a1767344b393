//! How outputs are written.

use crate::cli::values::choice;
use clap::Args;
use texbake::io::{Compression, WriteOptions};

/// What was set of the files of all maps.
#[derive(Args, Debug, Clone, Default, PartialEq)]
pub struct FileOutput {
    /// How hard a PNG is compressed; its texels are the same [default: fast]
    #[arg(long, value_parser = choice::<Compression>(Compression::NAMES), help_heading = HEADING)]
    pub compression: Option<Compression>,
}

const HEADING: &str = "Output files";

impl FileOutput {
    /// These settings, and those of `weaker` where these say nothing.
    pub fn or(self, weaker: &Self) -> Self {
        Self { compression: self.compression.or(weaker.compression) }
    }

    /// How a map becomes a file.
    pub fn write(&self) -> WriteOptions {
        WriteOptions { compression: self.compression.unwrap_or_default() }
    }
}
