//! How inputs are read.

use crate::cli::values::{ByteSize, choice, shrink, value};
use clap::Args;
use std::num::NonZeroU32;
use texbake::io::{Channel, ColorSpace, NormalReadOptions, RawLayout, ReadOptions};

/// What was set of a height map.
#[derive(Args, Debug, Clone, Default, PartialEq)]
pub struct HeightInput {
    /// Channel that holds the heights: r, g, b, a, luma, or the name of an EXR channel; needed if they differ
    #[arg(long, value_name = "CHANNEL", help_heading = HEADING)]
    pub channel: Option<Channel>,

    /// srgb undoes a wrong conversion of the heights; data is not converted otherwise [default: linear]
    #[arg(long, value_name = "SPACE", value_parser = choice::<ColorSpace>(ColorSpace::NAMES), help_heading = HEADING)]
    pub color_space: Option<ColorSpace>,

    /// Layout of a file without header: 1025x1025:u16le; types u8, u16le, u16be, f32le, f32be
    #[arg(long, value_name = "WxH:TYPE", value_parser = value::<RawLayout>, help_heading = HEADING)]
    pub raw: Option<RawLayout>,

    /// Reduce the map by a whole factor first, a divisor of both its sides: the mean of N x N heights, as a 16-bit code
    /// or a float. --scale stays in texels of the file [default: 1]
    #[arg(long, value_name = "N", value_parser = shrink, help_heading = HEADING)]
    pub shrink: Option<NonZeroU32>,

    /// Most memory that decoding one file may take: 512M, 4G [default: 4G]
    #[arg(long, value_name = "BYTES", value_parser = value::<ByteSize>, help_heading = HEADING)]
    pub max_bytes: Option<ByteSize>,
}

const HEADING: &str = "Height map";

impl HeightInput {
    /// These settings, and those of `weaker` where these say nothing.
    pub fn or(self, weaker: Self) -> Self {
        Self {
            channel: self.channel.or(weaker.channel),
            color_space: self.color_space.or(weaker.color_space),
            raw: self.raw.or(weaker.raw),
            shrink: self.shrink.or(weaker.shrink),
            max_bytes: self.max_bytes.or(weaker.max_bytes),
        }
    }

    /// How the height map is read.
    pub fn read(&self) -> ReadOptions {
        ReadOptions {
            channel: self.channel.clone(),
            color_space: self.color_space.unwrap_or_default(),
            raw: self.raw,
            shrink: self.shrink.unwrap_or(NonZeroU32::MIN),
            max_bytes: max_bytes(self.max_bytes),
        }
    }
}

/// The limit on the memory that decoding one file may take.
pub fn max_bytes(given: Option<ByteSize>) -> u64 {
    given.map_or(NormalReadOptions::default().max_bytes, |ByteSize(bytes)| bytes)
}
