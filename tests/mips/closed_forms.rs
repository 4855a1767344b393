//! Surfaces whose levels are known, and what the mean of normals would make of them.

use super::assert_levels;
use crate::oracle::{integer_levels, mean_normals};
use crate::support::{SNORM16, UNORM8, UNORM16, map_u8, map_u16, options};
use texbake::{Baker, CodesRef, NormalFormat, NormalMap, Size};

/// The codes of a texel.
fn texel(map: &NormalMap, x: usize, y: usize) -> Vec<u32> {
    let channels = map.format().channels.count();
    let first = (y * map.size().width() + x) * channels;
    match map.codes() {
        CodesRef::U8(codes) => codes[first..first + channels].iter().map(|code| (*code).into()).collect(),
        CodesRef::U16(codes) => codes[first..first + channels].iter().map(|code| (*code).into()).collect(),
        _ => panic!("integer codes"),
    }
}

/// A plane rises by the same everywhere but at its borders, where any edge bends it: what covers no border has its
/// normal, at every level.
#[test]
fn a_plane_has_one_normal_at_every_level() {
    let plane = map_u16(100, 90, |x, y| (300 * x + 200 * y) as u16);
    for format in [UNORM8, UNORM16, SNORM16] {
        let levels = Baker::cpu().normal_levels(&plane, &options("24", format)).expect("levels");
        let expected = texel(&levels[0], 50, 50);
        let mut inside = 0;
        for level in &levels[..5] {
            for y in 1..level.size().height() - 1 {
                for x in 1..level.size().width() - 1 {
                    assert_eq!(texel(level, x, y), expected, "{} of {}", level.size(), plane.size());
                    inside += 1;
                }
            }
        }
        assert!(inside > 10_000, "{inside}");
    }
}

/// Slopes 3 and 0 beside each other: their mean is 3/2, the mean of their normals leans less. In codes of 8 bits, with
/// v = -x: 3/2 over sqrt(1 + 9/4) is 0.832, and 3/sqrt(10) over the length of (3/sqrt(10), 1 + 1/sqrt(10)) is 0.585.
#[test]
fn slopes_are_averaged_and_not_normals() {
    // Central differences of two texels each: +255, +255, 0, 0, -255, -255, 0, 0, times 3 / 255 and over 2.
    let map = map_u8(8, 1, |x, _| [0, 0, 255, 255, 255, 255, 0, 0][x]);
    let options = options("6", UNORM8);
    let levels = Baker::cpu().normal_levels(&map, &options).expect("levels");
    assert_levels("a step", &levels, &integer_levels(&map, &options));
    assert_eq!([0, 1, 2, 3].map(|x| texel(&levels[0], x, 0)[0]), [128, 7, 7, 128]);
    assert_eq!([0, 1].map(|x| texel(&levels[1], x, 0)), [[21, 128, 198]; 2].map(Vec::from));

    let means = mean_normals(&map, &options, levels[1].size());
    let wrong: Vec<u32> = means[0].iter().map(|v| ((v + 1.0) * 127.5 + 0.5).floor() as u32).collect();
    assert_eq!(wrong, [53, 128, 231]);
}

/// How far the mean of normals is off, in degrees, on a rough map: the comparison would notice.
#[test]
fn averaged_normals_fail_the_comparison() {
    let map = map_u8(64, 64, |x, y| (x * x * 7 + y * y * 13 + x * y) as u8);
    let options = options("24", UNORM8);
    let expected = integer_levels(&map, &options);
    for (level, least_share) in [(1, 0.9), (2, 0.9), (3, 0.9)] {
        let image = &expected[level];
        let means = mean_normals(&map, &options, image.size);
        let codes = means.iter().flatten().map(|v| ((v + 1.0) * 127.5 + 0.5).floor() as u32);
        let differ = codes.zip(&image.bits).filter(|(wrong, right)| wrong != *right).count();
        let share = differ as f64 / image.bits.len() as f64;
        assert!(share > least_share, "level {level}: {share} of the codes differ");
    }
}

/// A map that tiles rises as much as it falls, and its last level is flat; a map that is clamped keeps half of the slope
/// at its borders.
#[test]
fn the_last_level_is_the_mean_of_all() {
    let map = map_u8(48, 20, |x, y| (x * 31 + y * y * 17) as u8);
    let levels = Baker::cpu().normal_levels(&map, &options("24", UNORM8)).expect("levels");
    assert_eq!(texel(levels.last().expect("levels"), 0, 0), [128, 128, 255]);

    // Clamped, the slopes of a row add up to (H(n-1) - H(0)) s / 255, here 4 times 51/255 over 4 texels.
    let ramp = map_u8(4, 1, |x, _| 17 * x as u8);
    let clamped = texbake::NormalOptions { edges: texbake::Edges::both(texbake::Edge::Clamp), ..options("20", UNORM8) };
    let levels = Baker::cpu().normal_levels(&ramp, &clamped).expect("levels");
    let slope_1: NormalFormat = UNORM8;
    assert_eq!((levels[2].size(), levels[2].format()), (Size::new(1, 1).expect("a size"), slope_1));
    assert_eq!(texel(&levels[2], 0, 0), [37, 128, 218]);
}
