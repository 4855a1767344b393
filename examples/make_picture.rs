//! Draws the README's pictures: height maps beside the normal maps that `bake` makes of them, and a blend between its
//! two normal maps.
//!
//!     cargo run --release -- bake examples/textures --out target/picture --maps normal,parallax
//!     cargo run --release -- blend target/picture/walls/bricks_normal.png target/picture/cloth/weave_normal.png \
//!         --tile -o target/picture/blend.png
//!     cargo run --release --example make_picture

use std::error::Error;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use texbake::{HeightMap, Heights};

/// Each map is shown by its upper left corner.
const SIDE: usize = 256;
const GAP: usize = 8;

fn main() -> Result<(), Box<dyn Error>> {
    let heights = |name: &str| grey(&Path::new("examples/textures").join(name));
    let baked = |name: &str| colours(&Path::new("target/picture").join(name));
    std::fs::create_dir_all("docs")?;
    draw(
        "docs/bake.png",
        &[
            heights("walls/bricks_height.png")?,
            baked("walls/bricks_normal.png")?,
            heights("ground/pebbles_disp.png")?,
            baked("ground/pebbles_normal.png")?,
        ],
    )?;
    draw(
        "docs/material.png",
        &[
            baked("walls/bricks_parallax.png")?,
            baked("walls/bricks_normal.png")?,
            baked("cloth/weave_normal.png")?,
            baked("blend.png")?,
        ],
    )
}

/// Writes squares of RGB rows side by side.
fn draw(path: &str, squares: &[Vec<u8>]) -> Result<(), Box<dyn Error>> {
    let width = squares.len() * (SIDE + GAP) - GAP;
    let mut picture = vec![255; 3 * width * SIDE];
    for (index, square) in squares.iter().enumerate() {
        place(&mut picture, width, index * (SIDE + GAP), square);
    }
    let mut encoder = png::Encoder::new(BufWriter::new(File::create(path)?), width as u32, SIDE as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::High);
    encoder.write_header()?.write_image_data(&picture)?;
    Ok(())
}

/// The corner of a height map as grey RGB rows.
fn grey(path: &Path) -> Result<Vec<u8>, Box<dyn Error>> {
    let map = HeightMap::read(path)?;
    let width = map.size().width();
    let code = |i: usize| match map.heights() {
        Heights::U8(heights) => heights[i],
        Heights::U16(heights) => (heights[i] >> 8) as u8,
        Heights::F32(heights) => (heights[i] * 255.0) as u8,
    };
    Ok((0..SIDE * SIDE).flat_map(|i| [code(i / SIDE * width + i % SIDE); 3]).collect())
}

/// The corner of an 8-bit grey or RGB PNG, repeated where it is smaller, as RGB rows.
fn colours(path: &Path) -> Result<Vec<u8>, Box<dyn Error>> {
    let mut reader = png::Decoder::new(std::io::BufReader::new(File::open(path)?)).read_info()?;
    let mut bytes = vec![0; reader.output_buffer_size().ok_or("too large")?];
    let info = reader.next_frame(&mut bytes)?;
    let (width, height) = (info.width as usize, info.height as usize);
    let channels = info.color_type.samples();
    let colour = |i: usize| {
        let texel = (i / SIDE % height) * width + i % SIDE % width;
        [0, 1, 2].map(|channel| bytes[texel * channels + channel % channels])
    };
    Ok((0..SIDE * SIDE).flat_map(colour).collect())
}

fn place(picture: &mut [u8], width: usize, left: usize, rgb: &[u8]) {
    for (row, pixels) in rgb.chunks(3 * SIDE).enumerate() {
        picture[3 * (row * width + left)..][..3 * SIDE].copy_from_slice(pixels);
    }
}
