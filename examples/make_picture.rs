//! Draws the README's picture: height maps on the left, the normal maps that `bake` makes of them on the right.
//!
//!     cargo run --release -- bake examples/textures --out target/picture
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
    let pairs = [
        ("walls/bricks_height.png", "walls/bricks_normal.png"),
        ("ground/pebbles_disp.png", "ground/pebbles_normal.png"),
    ];
    let width = 4 * SIDE + 3 * GAP;
    let mut picture = vec![255; 3 * width * SIDE];
    for (index, (height, normal)) in pairs.iter().enumerate() {
        let left = 2 * index * (SIDE + GAP);
        place(&mut picture, width, left, &grey(&Path::new("examples/textures").join(height))?);
        place(&mut picture, width, left + SIDE + GAP, &colours(&Path::new("target/picture").join(normal))?);
    }
    std::fs::create_dir_all("docs")?;
    let mut encoder = png::Encoder::new(BufWriter::new(File::create("docs/bake.png")?), width as u32, SIDE as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::High);
    encoder.write_header()?.write_image_data(&picture)?;
    Ok(())
}

/// The corner of a height map as grey RGB rows.
fn grey(path: &Path) -> texbake::Result<Vec<u8>> {
    let map = HeightMap::read(path)?;
    let width = map.size().width();
    let code = |i: usize| match map.heights() {
        Heights::U8(heights) => heights[i],
        Heights::U16(heights) => (heights[i] >> 8) as u8,
        Heights::F32(heights) => (heights[i] * 255.0) as u8,
    };
    Ok((0..SIDE * SIDE).flat_map(|i| [code(i / SIDE * width + i % SIDE); 3]).collect())
}

/// The corner of an 8-bit RGB PNG.
fn colours(path: &Path) -> Result<Vec<u8>, Box<dyn Error>> {
    let mut reader = png::Decoder::new(std::io::BufReader::new(File::open(path)?)).read_info()?;
    let mut bytes = vec![0; reader.output_buffer_size().ok_or("too large")?];
    let info = reader.next_frame(&mut bytes)?;
    let rows = bytes.chunks(3 * info.width as usize).take(SIDE);
    Ok(rows.flat_map(|row| row[..3 * SIDE].to_vec()).collect())
}

fn place(picture: &mut [u8], width: usize, left: usize, rgb: &[u8]) {
    for (row, pixels) in rgb.chunks(3 * SIDE).enumerate() {
        picture[3 * (row * width + left)..][..3 * SIDE].copy_from_slice(pixels);
    }
}
