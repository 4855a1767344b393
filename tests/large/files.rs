//! Height maps as files of every kind that is read row by row, written by hand or by the format's own crate.

use crate::io::hand_made_tiff::Tiff;
use ::exr::prelude::*;
use std::path::Path;
use texbake::io::{RawLayout, ReadOptions};
use texbake::{HeightMap, HeightType, Heights};

/// A kind of file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Png,
    TiffStrips,
    /// All rows in one strip.
    TiffStrip,
    TiffTiles,
    ExrLines,
    ExrTiles,
    Raw,
}

pub const KINDS: [Kind; 7] =
    [Kind::Png, Kind::TiffStrips, Kind::TiffStrip, Kind::TiffTiles, Kind::ExrLines, Kind::ExrTiles, Kind::Raw];

const TILE: usize = 16;

impl Kind {
    pub fn holds(self, height_type: HeightType) -> bool {
        match self {
            Self::Png => height_type != HeightType::F32,
            Self::ExrLines | Self::ExrTiles => height_type == HeightType::F32,
            _ => true,
        }
    }

    pub fn extension(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::TiffStrips | Self::TiffStrip | Self::TiffTiles => "tif",
            Self::ExrLines | Self::ExrTiles => "exr",
            Self::Raw => "raw",
        }
    }

    /// How such a file is read.
    pub fn read(self, map: &HeightMap) -> ReadOptions {
        let size = map.size();
        let kind = match map.height_type() {
            HeightType::U8 => "u8",
            HeightType::U16 => "u16le",
            HeightType::F32 => "f32le",
        };
        let layout = format!("{}x{}:{kind}", size.width(), size.height()).parse::<RawLayout>();
        ReadOptions { raw: (self == Self::Raw).then(|| layout.unwrap()), ..Default::default() }
    }

    pub fn write(self, path: &Path, map: &HeightMap) {
        let (width, height) = (map.size().width(), map.size().height());
        match self {
            Self::Png => write_png(path, map),
            Self::TiffStrips => std::fs::write(
                path,
                tiff(
                    map,
                    bytes(map, 0..width, 0..height)
                        .chunks(7 * width * map.height_type().bytes())
                        .map(<[u8]>::to_vec)
                        .collect(),
                    7,
                )
                .bytes(),
            )
            .unwrap(),
            Self::TiffStrip => {
                std::fs::write(path, tiff(map, vec![bytes(map, 0..width, 0..height)], height).bytes()).unwrap()
            }
            Self::TiffTiles => {
                let lefts = || (0..width).step_by(TILE);
                let corners = (0..height).step_by(TILE).flat_map(|top| lefts().map(move |left| (left, top)));
                let tiles = corners.map(|(left, top)| bytes(map, left..left + TILE, top..top + TILE)).collect();
                let tile = Some((TILE as u32, TILE as u32));
                std::fs::write(path, Tiff { tile, ..tiff(map, tiles, TILE) }.bytes()).unwrap();
            }
            Self::ExrLines => write_exr(path, map, Blocks::ScanLines),
            Self::ExrTiles => write_exr(path, map, Blocks::Tiles(Vec2(TILE, TILE))),
            Self::Raw => std::fs::write(path, bytes(map, 0..width, 0..height)).unwrap(),
        }
    }
}

/// Heights of a part of the map, least significant byte first; what is beyond the map is filled.
fn bytes(map: &HeightMap, columns: std::ops::Range<usize>, rows: std::ops::Range<usize>) -> Vec<u8> {
    let (width, height) = (map.size().width(), map.size().height());
    let texels = rows.flat_map(|y| columns.clone().map(move |x| (x < width && y < height).then_some(y * width + x)));
    match map.heights() {
        Heights::U8(heights) => texels.map(|texel| texel.map_or(99, |texel| heights[texel])).collect(),
        Heights::U16(heights) => {
            texels.flat_map(|texel| texel.map_or(99, |texel| heights[texel]).to_le_bytes()).collect()
        }
        Heights::F32(heights) => {
            texels.flat_map(|texel| texel.map_or(99.0, |texel| heights[texel]).to_le_bytes()).collect()
        }
    }
}

fn tiff(map: &HeightMap, chunks: Vec<Vec<u8>>, rows_per_strip: usize) -> Tiff {
    let kind = if map.height_type() == HeightType::F32 { 3 } else { 1 };
    let (width, height, bits) = (map.size().width() as u32, map.size().height() as u32, 8 * map.height_type().bytes());
    Tiff { rows_per_strip: rows_per_strip as u32, ..Tiff::grey(width, height, bits as u16, kind, chunks) }
}

fn write_png(path: &Path, map: &HeightMap) {
    let (depth, samples) = match map.heights() {
        Heights::U8(heights) => (png::BitDepth::Eight, heights.to_vec()),
        Heights::U16(heights) => (png::BitDepth::Sixteen, heights.iter().flat_map(|code| code.to_be_bytes()).collect()),
        Heights::F32(_) => panic!("a PNG holds no floats"),
    };
    let file = std::fs::File::create(path).unwrap();
    let mut encoder = png::Encoder::new(file, map.size().width() as u32, map.size().height() as u32);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(depth);
    encoder.write_header().unwrap().write_image_data(&samples).unwrap();
}

fn write_exr(path: &Path, map: &HeightMap, blocks: Blocks) {
    let Heights::F32(heights) = map.heights() else { panic!("an EXR holds floats") };
    let encoding = Encoding { compression: Compression::ZIP16, blocks, line_order: LineOrder::Increasing };
    let channels = AnyChannels::sort([AnyChannel::new("Y", FlatSamples::F32(heights.to_vec()))].into_iter().collect());
    let layer =
        Layer::new((map.size().width(), map.size().height()), LayerAttributes::named("heights"), encoding, channels);
    Image::from_layer(layer).write().to_file(path).unwrap();
}
