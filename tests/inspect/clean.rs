//! What texbake bakes is sound: flat, gentle, steep, of any format.

use super::support::{findings, noise, sound, waves, xy};
use crate::support::FORMATS;
use texbake::inspect::Problem;
use texbake::{Baker, Codes, Grid, HeightMap, NormalFormat, NormalMap, NormalOptions, Scale, Size};

fn baked(map: &HeightMap, scale: i32, format: NormalFormat) -> NormalMap {
    Baker::reference()
        .normal(map, &NormalOptions { scale: Scale::texels(scale), format, ..Default::default() })
        .unwrap()
}

/// Faults and notes, without the note on z of zero, which steep maps have by right.
fn wrong(map: &NormalMap) -> Vec<String> {
    let found = findings(map).list;
    found.iter().filter(|finding| finding.problem != Problem::AtZero).map(ToString::to_string).collect()
}

#[test]
fn bakes_of_any_scale_and_format_are_sound() {
    let bricks = HeightMap::from(
        Grid::from_fn(96, 64, |x, y| {
            let (x, y) = ((x + y / 16 % 2 * 16) % 32, y % 16);
            let to_joint = x.min(31 - x).min(y.min(15 - y)).min(4) as u8;
            40 + 50 * to_joint + ((x * 7 + y * 13) % 5) as u8
        })
        .unwrap(),
    );
    let floats =
        Grid::from_fn(64, 48, |x, y| ((x as f32 / 64.0 * std::f32::consts::TAU).sin() * (y % 12) as f32).abs());
    let maps = [waves(64, 48), noise(1, 48, 64), bricks, floats.unwrap().try_into().unwrap()];
    let formats = FORMATS.into_iter().chain(FORMATS.map(xy));
    for format in formats {
        for (index, map) in maps.iter().enumerate() {
            for scale in [1, -3, 10, 40, 400, 20_000] {
                let wrong = wrong(&baked(map, scale, format));
                assert!(wrong.is_empty(), "map {index}, scale {scale}, {format:?}: {wrong:?}");
            }
        }
    }
}

#[test]
fn flat_maps_of_any_size_are_sound() {
    for format in FORMATS.into_iter().chain(FORMATS.map(xy)) {
        for [width, height] in [[1, 1], [1, 40], [40, 1], [2, 2], [64, 64]] {
            let heights = HeightMap::from(Grid::new(width, height, vec![9u8; width * height]).unwrap());
            assert_eq!(wrong(&baked(&heights, 10, format)), [""; 0], "{width} x {height}, {format:?}");
        }
    }
}

#[test]
fn sound_maps_have_neither_faults_nor_notes() {
    for format in FORMATS {
        let found = findings(&sound(64, 64, format));
        assert_eq!((found.list.len(), found.has_faults(), found.size.width()), (0, false, 64), "{format:?}");
    }
}

#[test]
fn a_plane_of_one_code_is_sound() {
    let codes = Codes::U16([40_000, 30_000, 64_607].repeat(32 * 32));
    let map = NormalMap::new(Size::new(32, 32).unwrap(), crate::support::UNORM16, codes).unwrap();
    assert_eq!(wrong(&map), [""; 0]);
}
