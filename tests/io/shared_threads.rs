//! Callers that bake on the very threads that encoders share (rayon's): all of them wait for their files at once.

use super::support::Folder;
use rayon::prelude::*;
use std::path::Path;
use texbake::io::{BlockCompression, WriteOptions, create_normals_with, open_heights};
use texbake::stream::Monitor;
use texbake::{Baker, Channels, Depth, Encoding, NormalFormat, NormalOptions};

/// The file of a bake of `input` whose name is `path`.
fn bake(input: &Path, path: &Path, format: NormalFormat, write: &WriteOptions) -> Vec<u8> {
    let open = || Ok(open_heights(input, &Default::default())?.rows);
    let create = |size| create_normals_with(path, size, format, write);
    let options = NormalOptions { format, ..NormalOptions::default() };
    Baker::cpu().normal_rows(&open, &create, &options, &Monitor::default()).unwrap();
    std::fs::read(path).unwrap()
}

/// A file whose encoder waited for a free thread would never end.
#[test]
fn all_shared_threads_bake_at_once() {
    let folder = Folder::new();
    let (input, size) = (folder.path("heights.bmp"), [300, 200]);
    let heights: Vec<u8> = (0..size[0] * size[1]).map(|texel| ((texel * texel) >> 7) as u8).collect();
    image::save_buffer(&input, &heights, 300, 200, image::ExtendedColorType::L8).unwrap();
    let bytes = NormalFormat::default();
    let halves = NormalFormat { encoding: Encoding::Float, depth: Depth::Float16, ..bytes };
    let xy = NormalFormat { channels: Channels::Xy, ..bytes };
    let rows = WriteOptions::default();
    let blocks = |blocks| WriteOptions { blocks: Some(blocks), mips: true, ..rows };
    for (extension, format, write) in [
        ("png", bytes, rows),
        ("tif", bytes, rows),
        ("exr", halves, rows),
        ("dds", xy, blocks(BlockCompression::Bc5)),
        ("ktx2", bytes, blocks(BlockCompression::Bc7)),
    ] {
        let expected = bake(&input, &folder.path(&format!("alone.{extension}")), format, &write);
        let found = rayon::broadcast(|thread| {
            let path = folder.path(&format!("thread_{}.{extension}", thread.index()));
            bake(&input, &path, format, &write) == expected
        });
        assert!(found.iter().all(|is_equal| *is_equal), "{extension}: {found:?}");
        // A thread that waits for a part of its bake begins the next one meanwhile.
        let found = (0..4 * rayon::current_num_threads()).into_par_iter().map(|file| {
            let path = folder.path(&format!("file_{file}.{extension}"));
            bake(&input, &path, format, &write) == expected
        });
        assert!(found.all(|is_equal| is_equal), "{extension}");
    }
}
