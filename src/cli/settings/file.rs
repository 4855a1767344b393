//! How outputs are written.

use crate::cli::values::choice;
use clap::Args;
use std::path::Path;
use texbake::io::{BlockCompression, Compression, WriteOptions, check_parallax_with, is_compressed};
use texbake::{Depth, Encoding, Error, ParallaxFormat, Result};

/// What was set of the files of all maps.
#[derive(Args, Debug, Clone, Default, PartialEq)]
pub struct FileOutput {
    /// How hard a PNG is compressed; its texels are the same. balanced and small take about 10 and 100 times as long as
    /// fast and save up to 1 %; 9 and 14 % where a map is nearly flat, at more than that [default: fast]
    #[arg(long, value_parser = choice::<Compression>(Compression::NAMES), help_heading = HEADING)]
    pub compression: Option<Compression>,

    /// Compress .ktx2 and .dds files into blocks that a GPU reads as they are: bc5 keeps x and y of a normal map, bc7
    /// all three, and takes about 5 s of processor time for a million texels; a parallax map becomes bc4 with any of
    /// them [default: uncompressed]
    #[arg(long, value_name = "BLOCKS", value_parser = choice::<BlockCompression>(BlockCompression::NAMES))]
    #[arg(help_heading = HEADING)]
    pub block_compression: Option<BlockCompression>,
}

const HEADING: &str = "Output files";

impl FileOutput {
    /// These settings, and those of `weaker` where these say nothing.
    pub fn or(self, weaker: &Self) -> Self {
        Self {
            compression: self.compression.or(weaker.compression),
            block_compression: self.block_compression.or(weaker.block_compression),
        }
    }

    /// These settings without blocks that the file `output` cannot hold.
    pub fn held_by(&self, output: &Path) -> Self {
        // One component of 8 bits: every kind of blocks holds it.
        let plain = ParallaxFormat { encoding: Encoding::Unorm, depth: Depth::Bits8 };
        let holds = |blocks: &BlockCompression| {
            let options = WriteOptions { blocks: Some(*blocks), ..WriteOptions::default() };
            check_parallax_with(output, plain, &options).is_ok()
        };
        Self { block_compression: self.block_compression.filter(holds), ..self.clone() }
    }

    /// Fails if something is set that is for none of these outputs.
    ///
    /// # Errors
    /// [`Error::Parameter`]
    pub fn check_effect<'a>(&self, outputs: impl IntoIterator<Item = &'a Path>) -> Result<()> {
        match self.compression {
            Some(compression) if !outputs.into_iter().any(is_compressed) => Err(Error::Parameter {
                parameter: "compression",
                value: compression.to_string(),
                range: "left out where no output is a PNG: others are compressed in one way".into(),
            }),
            _ => Ok(()),
        }
    }

    /// How a map becomes a file.
    pub fn write(&self) -> WriteOptions {
        WriteOptions { compression: self.compression.unwrap_or_default(), mips: false, blocks: self.block_compression }
    }
}
