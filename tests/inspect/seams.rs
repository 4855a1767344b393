//! Edges that do not fit are found, with where; what tiles, flat or rough, has no seam.

use super::support::{findings, sound, texel, waves};
use crate::support::{FORMATS, Random, UNORM8, UNORM16};
use texbake::inspect::{CheckOptions, Problem, Severity, Texel, check};
use texbake::stream::Monitor;
use texbake::{Baker, Codes, CodesRef, Edge, Edges, Grid, HeightMap, NormalMap, NormalOptions, Scale, Size};

/// The columns `from..to` of an 8-bit map.
fn columns(map: &NormalMap, from: usize, to: usize) -> NormalMap {
    let CodesRef::U8(codes) = map.codes() else { panic!("8 bits") };
    let rows = codes.chunks_exact(3 * map.size().width());
    let cut = rows.flat_map(|row| row[3 * from..3 * to].to_vec()).collect();
    NormalMap::new(Size::new(to - from, map.size().height()).unwrap(), map.format(), Codes::U8(cut)).unwrap()
}

fn seams(map: &NormalMap) -> Vec<(Option<Texel>, String)> {
    let found = findings(map);
    let seams = found.list.iter().filter(|finding| finding.problem == Problem::Seam);
    seams.map(|finding| (finding.at, finding.what.clone())).collect()
}

#[test]
fn a_cut_map_does_not_fit_where_it_was_cut() {
    let whole = sound(64, 64, UNORM8);
    let cut = columns(&whole, 0, 41);
    let found = findings(&cut);
    let seam = found.seams.columns.unwrap();
    assert_eq!((seam.between, seam.shows(), found.seams.rows.unwrap().shows()), ([40, 0], true, false));
    // The mean of |dx| + |dy| + |dz| from column 40 to column 0, from the codes themselves, in 255ths: 2c - 255, and
    // 0 for 128.
    let CodesRef::U8(codes) = whole.codes() else { panic!("8 bits") };
    let component = |x: usize, y: usize, channel: usize| match i64::from(codes[3 * (64 * y + x) + channel]) {
        128 => 0,
        code => 2 * code - 255,
    };
    let step =
        |y: usize| (0..3).map(|channel| (component(0, y, channel) - component(40, y, channel)).abs()).sum::<i64>();
    let mean = (0..64).map(step).sum::<i64>() as f64 / 255.0 / 64.0;
    assert!((seam.step - mean).abs() < 1e-5, "{} {mean}", seam.step);
    let worst = (0..64).rev().max_by_key(|&y| step(y)).unwrap();
    assert_eq!(seam.worst, texel(40, worst));
    assert!((seam.worst_step - step(worst) as f64 / 255.0).abs() < 1e-5);
    let [(at, what)] = &seams(&cut)[..] else { panic!("one seam: {found:?}") };
    assert_eq!(*at, Some(texel(40, worst)));
    assert!(what.starts_with("columns 40 and 0 do not fit where the map is repeated: a mean step of "), "{what}");
}

#[test]
fn a_seam_is_a_note_unless_the_map_shall_tile() {
    let cut = columns(&sound(64, 64, UNORM8), 0, 41);
    let found = check(cut.into_rows(), &CheckOptions { tiles: false }, &Monitor::default()).unwrap();
    assert_eq!((found.list[0].problem, found.list[0].severity), (Problem::Seam, Severity::Note));
    assert!(!found.has_faults());
}

#[test]
fn heights_baked_with_the_wrong_edge_are_found_beside_the_seam() {
    let rising = HeightMap::from(Grid::from_fn(48, 48, |x, y| (1000 * y + 100 * (x % 4)) as u16).unwrap());
    let bake = |map: &HeightMap, edge| {
        let options = NormalOptions { scale: Scale::texels(40), edges: Edges::both(edge), ..Default::default() };
        Baker::reference().normal(map, &options).unwrap()
    };
    // A slope that wraps has a cliff in its first and last rows, next to each other.
    let found = seams(&bake(&rising, Edge::Wrap));
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].1.starts_with("rows 0 and 1, at the edge, do not fit: "), "{found:?}");
    // Heights that were clamped have half their slope at the edge.
    let plane = HeightMap::from(Grid::from_fn(64, 64, |x, _| 1000 * x as u16).unwrap());
    let found = seams(&bake(&plane, Edge::Clamp));
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].1.starts_with("columns 0 and 1, at the edge, do not fit: "), "{found:?}");
}

#[test]
fn what_tiles_has_no_seam() {
    let mut random = Random::new(9);
    let rough = HeightMap::from(Grid::from_fn(80, 64, |_, _| random.below(256) as u8).unwrap());
    let blocks =
        HeightMap::from(Grid::from_fn(64, 64, |x, y| if (x / 16 + y / 16) % 2 == 0 { 0u8 } else { 200 }).unwrap());
    // A bump whose top is the corner of the map.
    let corner = HeightMap::from(
        Grid::from_fn(64, 64, |x, y| {
            let away = |i: usize| i.min(64 - i) as f64;
            (60_000.0 * (-(away(x).powi(2) + away(y).powi(2)) / 100.0).exp()) as u16
        })
        .unwrap(),
    );
    for (name, map) in [("rough", rough), ("blocks", blocks), ("corner", corner), ("waves", waves(50, 90))] {
        for format in FORMATS {
            for scale in [2, 60] {
                let options = NormalOptions { scale: Scale::texels(scale), format, ..Default::default() };
                let map = Baker::reference().normal(&map, &options).unwrap();
                assert_eq!(seams(&map), [], "{name}, {format:?}, {scale}");
            }
        }
    }
}

#[test]
fn small_maps_and_small_steps_are_not_judged() {
    let found = findings(&sound(15, 64, UNORM16));
    assert_eq!((found.seams.columns, found.seams.rows), (None, None));
    // One code of 8 bits from the last column to the first of a flat map.
    let codes = (0..32 * 32).flat_map(|i| if i % 32 < 16 { [128, 128, 255] } else { [129, 128, 255] }).collect();
    let map = NormalMap::new(Size::new(32, 32).unwrap(), UNORM8, Codes::U8(codes)).unwrap();
    assert_eq!(seams(&map), []);
}
