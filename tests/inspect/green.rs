//! The curl test finds green that points the wrong way, and says nothing where there is no telling.

use super::support::{dx, encoded, findings, noise, sound, waves};
use crate::support::{FORMATS, Random, UNORM8, UNORM16};
use texbake::inspect::{Green, Problem};
use texbake::{Baker, Codes, CodesRef, Convention, Grid, HeightMap, NormalFormat, NormalMap, NormalOptions, Scale};

/// The same codes, read as the other convention.
fn misread(map: &NormalMap) -> NormalMap {
    let codes = match map.codes() {
        CodesRef::U8(codes) => Codes::U8(codes.to_vec()),
        CodesRef::U16(codes) => Codes::U16(codes.to_vec()),
        CodesRef::F16(codes) => Codes::F16(codes.to_vec()),
        CodesRef::F32(codes) => Codes::F32(codes.to_vec()),
    };
    let convention = match map.format().convention {
        Convention::Gl => Convention::Dx,
        Convention::Dx => Convention::Gl,
    };
    NormalMap::new(map.size(), NormalFormat { convention, ..map.format() }, codes).unwrap()
}

fn green(map: &NormalMap) -> Green {
    findings(map).green
}

#[test]
fn a_convention_that_is_misread_is_found_in_any_format() {
    for format in FORMATS.into_iter().chain(FORMATS.map(dx)) {
        let map = sound(64, 48, format);
        assert_eq!(green(&map).likely(), Some(format.convention), "{format:?}");
        let found = findings(&misread(&map));
        assert_eq!(found.green.likely(), Some(format.convention), "{format:?}");
        let finding = found.of(Problem::Green).unwrap();
        assert!(finding.worst.unwrap() > 1000.0, "{format:?}: {finding}");
    }
    let found = findings(&misread(&sound(64, 48, dx(UNORM8))));
    let finding = found.of(Problem::Green).unwrap();
    assert!(
        finding.what.starts_with(
            "green (or red) seems to point the other way, green down (dx) and not as gl says: read so, slopes have "
        ),
        "{finding}"
    );
    assert!(finding.remedy.starts_with("read it with --convention dx; "), "{finding}");
}

/// z = x y / 100 has the slopes (y, x) / 100: dp/dy = dq/dx = 1/100, so the curl is 0 or 2/100, here of two texels.
#[test]
fn the_curls_are_the_known_ones_of_a_saddle() {
    let saddle = encoded(40, 40, crate::support::FLOAT32, |x, y| {
        let [p, q] = [(y as f64 - 20.0) / 100.0, (x as f64 - 20.0) / 100.0];
        let length = (p * p + q * q + 1.0).sqrt();
        // Green up: y is negated.
        [-p / length, q / length, 1.0 / length]
    });
    let found = green(&saddle);
    assert!(found.gl < 1e-10, "{found:?}");
    // (4/100)^2 where z is 1, and less by z^4 towards the corners.
    assert!(found.dx > 0.7 * 0.0016 && found.dx < 0.0016, "{found:?}");
    assert_eq!(found.likely(), Some(Convention::Gl));
}

#[test]
fn steep_gentle_and_random_heights_are_decided() {
    for (map, scale) in [(waves(96, 96), 1), (waves(96, 96), 3000), (noise(2, 64, 64), 3), (noise(3, 64, 64), 300)] {
        for format in [UNORM8, UNORM16] {
            let options = NormalOptions { scale: Scale::texels(scale), format, ..Default::default() };
            let map = Baker::reference().normal(&map, &options).unwrap();
            assert_eq!(green(&map).likely(), Some(Convention::Gl), "scale {scale}, {:?}", green(&map));
            assert_eq!(findings(&misread(&map)).list[0].problem, Problem::Green, "scale {scale}");
        }
    }
}

#[test]
fn what_is_not_made_of_heights_is_not_decided() {
    let mut random = Random::new(4);
    let mut slope = || random.below(1000) as f64 / 1000.0 - 0.5;
    let vectors = encoded(128, 128, UNORM8, |_, _| {
        let [p, q] = [slope(), slope()];
        let length = (p * p + q * q + 1.0).sqrt();
        [p / length, q / length, 1.0 / length]
    });
    let found = green(&vectors);
    assert!(found.ratio() < 1.1 && found.likely().is_none(), "{found:?}");
}

#[test]
fn flat_maps_and_slopes_along_one_axis_are_undecidable() {
    let wave = |along: fn(usize, usize) -> usize| {
        let height = |x, y| (128.0 + 100.0 * (along(x, y) as f64 * std::f64::consts::TAU / 16.0).sin()) as u8;
        HeightMap::from(Grid::from_fn(64, 64, height).unwrap())
    };
    let flat = HeightMap::from(Grid::new(64, 64, vec![7u8; 64 * 64]).unwrap());
    for (name, map) in [("x", wave(|x, _| x)), ("y", wave(|_, y| y)), ("flat", flat)] {
        let options = NormalOptions { scale: Scale::texels(10), ..Default::default() };
        let map = Baker::reference().normal(&map, &options).unwrap();
        let found = green(&map);
        assert_eq!((found.likely(), found.ratio(), found.gl), (None, 1.0, 0.0), "{name}");
        assert_eq!(findings(&misread(&map)).list, [], "{name}");
    }
    // One texel has no neighbours.
    assert_eq!(green(&sound(2, 2, UNORM8)).likely(), None);
}
