//! Peak memory does not grow with the height of a map.

#![cfg(target_os = "linux")]

use super::support::{Folder, peak_of, png};

const WIDTH: usize = 1024;
const HEIGHTS: [usize; 2] = [2048, 8 * 2048];

/// Less than the heights of the taller map (16 MiB of bytes), more than what threads and buffers differ by.
const MOST_GROWTH: u64 = 8 << 20;

fn assert_does_not_grow(folder: &Folder, input: impl Fn(usize) -> (String, Vec<String>), output: &str) {
    assert_peaks_are_alike(folder, |height| {
        let (input, arguments) = input(height);
        let command = ["normal", &input, "-o", output].map(str::to_owned).to_vec();
        [command, arguments].concat()
    });
}

fn assert_peaks_are_alike(folder: &Folder, arguments: impl Fn(usize) -> Vec<String>) {
    let peaks = HEIGHTS.map(|height| {
        let mut command = folder.command(&[]);
        command.args(arguments(height));
        peak_of(command)
    });
    assert!(peaks[1] < peaks[0] + MOST_GROWTH, "{:?}: {peaks:?} bytes for {HEIGHTS:?} rows", arguments(HEIGHTS[1]));
}

#[test]
fn a_taller_map_needs_no_more_memory() {
    let folder = Folder::new();
    let raw = |height: usize| {
        let name = format!("{height}.raw");
        std::fs::File::create(folder.path(&name)).unwrap().set_len((2 * WIDTH * height) as u64).unwrap();
        (name, vec!["--raw".to_owned(), format!("{WIDTH}x{height}:u16le")])
    };
    let grey = |height: usize| {
        let name = format!("{height}.png");
        let codes = vec![0; WIDTH * height];
        folder.file(&name, png(WIDTH, height, png::ColorType::Grayscale, png::BitDepth::Eight, &codes));
        (name, Vec::new())
    };
    assert_does_not_grow(&folder, raw, "n.tif");
    assert_does_not_grow(&folder, raw, "n.exr");
    assert_does_not_grow(&folder, grey, "n.png");
}

#[test]
fn taller_blends_and_fused_bakes_need_no_more_memory() {
    let folder = Folder::new();
    for height in HEIGHTS {
        let grey = vec![0; WIDTH * height];
        folder.file(
            &format!("{height}_h.png"),
            png(WIDTH, height, png::ColorType::Grayscale, png::BitDepth::Eight, &grey),
        );
        let flat = [128, 128, 255].repeat(WIDTH * height);
        folder.file(&format!("{height}_n.png"), png(WIDTH, height, png::ColorType::Rgb, png::BitDepth::Eight, &flat));
    }
    let words = |text: String| text.split(' ').map(str::to_owned).collect::<Vec<_>>();
    assert_peaks_are_alike(&folder, |h| words(format!("bake {h}_h.png --out baked --maps normal,parallax")));
    assert_peaks_are_alike(&folder, |h| words(format!("parallax {h}_h.png --normal {h}_n.png -o p.png")));
    assert_peaks_are_alike(&folder, |h| words(format!("blend {h}_n.png {h}_n.png --mask {h}_h.png -o b.png")));
}
