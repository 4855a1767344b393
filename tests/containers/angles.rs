//! What blocks cost: the angles between the normals that they hold and those of the texels that they are made of.

use super::blocks::Component;
use super::made::{KINDS, Kind, Level, bc7, write_at_once};
use crate::io::support::Folder;
use crate::support::{Random, map_u8, map_u16, options, scale};
use texbake::{Baker, Channels, CodesRef, HeightMap, NormalFormat, NormalMap, NormalOptions};

/// Three codes, in BC5 and in BC7 blocks.
const BC5: Kind = KINDS[22];
const BC7: Kind = KINDS[25];

type Vector = [f64; 3];

/// What a reader makes of two codes: z is what makes the length one, or zero.
fn with_z([x, y]: [f64; 2]) -> Vector {
    let [x, y] = [x, y].map(component);
    [x, y, (1.0 - x * x - y * y).max(0.0).sqrt()]
}

fn component(code: f64) -> f64 {
    code / 127.5 - 1.0
}

/// In degrees.
fn angle(a: Vector, b: Vector) -> f64 {
    let length = |[x, y, z]: Vector| (x * x + y * y + z * z).sqrt();
    let cross = [0, 1, 2].map(|at| a[(at + 1) % 3] * b[(at + 2) % 3] - a[(at + 2) % 3] * b[(at + 1) % 3]);
    let dot: f64 = (0..3).map(|at| a[at] * b[at]).sum();
    length(cross).atan2(dot).to_degrees()
}

/// A smooth wave of slopes up to a nineteenth of the scale; noise; bricks of the examples: 8-bit normal maps.
fn maps() -> Vec<(&'static str, NormalMap)> {
    let wave = |scale_text: &str| {
        let sine = |at: usize, frequency: f64| (at as f64 * frequency).sin();
        let map = map_u16(128, 128, |x, y| (16_384.0 * (2.0 + sine(x, 0.17) + sine(y, 0.13)) - 1.0) as u16);
        (map, scale_text.to_owned())
    };
    let mut random = Random::new(78);
    let bricks = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/textures/walls/bricks_height.png");
    let heights = [
        ("gentle", wave("3")),
        ("steep", wave("48")),
        ("noise", (map_u8(128, 128, |_, _| random.bits() as u8), "8".into())),
        ("bricks", (HeightMap::read(bricks).unwrap(), "24".into())),
    ];
    let bake = |(name, (map, text)): (_, (HeightMap, String))| {
        let options = NormalOptions { scale: scale(&text), ..options("1", NormalFormat::default()) };
        (name, Baker::cpu().normal(&map, &options).unwrap())
    };
    heights.into_iter().map(bake).collect()
}

/// The blocks of a map.
fn blocks(folder: &Folder, kind: Kind, map: &NormalMap) -> Vec<u8> {
    let path = folder.path("n.dds");
    let size = (map.size().width(), map.size().height());
    write_at_once(kind.create(&path, size, false).unwrap(), &[map.codes()]);
    std::fs::read(&path).unwrap().split_off(148)
}

fn texels(map: &NormalMap) -> Vec<[f64; 3]> {
    assert_eq!(map.format().channels, Channels::Xyz);
    let CodesRef::U8(codes) = map.codes() else { panic!("8 bits") };
    codes.chunks_exact(3).map(|texel| [0, 1, 2].map(|at| f64::from(texel[at]))).collect()
}

/// The angle of each texel of BC5 blocks, none of which is more than its block's range allows.
fn bc5_angles(folder: &Folder, map: &NormalMap) -> Vec<f64> {
    let (width, blocks, texels) = (map.size().width(), blocks(folder, BC5, map), texels(map));
    let one = |(at, texel): (usize, &[f64; 3])| {
        let (x, y) = (at % width, at / width);
        let pair = &blocks[(y / 4 * width.div_ceil(4) + x / 4) * 16..][..16];
        let decoded =
            [0, 1].map(|axis| Component { block: &pair[8 * axis..][..8], signed: false }.value(y % 4 * 4 + x % 4));
        let reference = with_z([texel[0], texel[1]]);
        let angle = angle(reference, with_z(decoded));
        // x and y are off by a fourteenth of their range at most, and z, the square root of 1 - r^2, by what r^2 is off by
        // over z. A vector that ends so far from the end of a unit vector leaves it by the arc sine of that.
        let off = [0, 1].map(|axis| {
            let axis = pair[8 * axis].abs_diff(pair[8 * axis + 1]);
            f64::from(axis) / 14.0 / 127.5
        });
        let off = off[0].hypot(off[1]);
        let r = reference[0].hypot(reference[1]);
        let off_z = off * (2.0 * r + off) / reference[2];
        // 1e-6: roundings of f64 here, whose square root z has near zero.
        let allowed = off.hypot(off_z).min(1.0).asin().to_degrees() + 1e-6;
        assert!(angle <= allowed, "texel {x}, {y}: {angle} is more than {allowed}");
        angle
    };
    texels.iter().enumerate().map(one).collect()
}

/// BC7 has no bound of its own: a block holds at most three lines through the codes, and its texels lie beside them.
fn bc7_angles(folder: &Folder, map: &NormalMap) -> Vec<f64> {
    let (width, height) = (map.size().width(), map.size().height());
    let level = Level { width, height, codes: texbake::Codes::U8(Vec::new()) };
    let decoded = bc7(&blocks(folder, BC7, map), &level);
    let vector = |codes: [f64; 3]| codes.map(component);
    let decoded = decoded.chunks_exact(4).map(|texel| vector([0, 1, 2].map(|at| f64::from(texel[at]))));
    texels(map).into_iter().zip(decoded).map(|(texel, decoded)| angle(vector(texel), decoded)).collect()
}

fn mean_and_greatest(angles: &[f64]) -> [f64; 2] {
    [angles.iter().sum::<f64>() / angles.len() as f64, angles.iter().copied().fold(0.0, f64::max)]
}

/// Measured, since nothing bounds the mean, nor BC7: the encoder is the same on every machine. The README has the figures.
#[test]
fn blocks_cost_these_angles() {
    let folder = Folder::new();
    // Mean and greatest angle of BC5, of BC7, in degrees.
    let measured = [
        ("gentle", [0.0806, 1.1838], [0.2199, 1.0460]),
        ("steep", [1.4379, 24.9920], [1.1174, 6.9133]),
        ("noise", [8.1871, 31.5867], [9.4193, 32.4401]),
        ("bricks", [1.1171, 23.2392], [1.3624, 15.3592]),
    ];
    for ((name, map), (expected_name, bc5, bc7)) in maps().into_iter().zip(measured) {
        assert_eq!(name, expected_name);
        for (blocks, found, expected) in [
            ("bc5", mean_and_greatest(&bc5_angles(&folder, &map)), bc5),
            ("bc7", mean_and_greatest(&bc7_angles(&folder, &map)), bc7),
        ] {
            println!("{name}, {blocks}: mean and greatest angle {found:.4?}");
            let same = |(found, expected): (f64, f64)| (found - expected).abs() <= 0.001;
            assert!(found.into_iter().zip(expected).all(same), "{name}, {blocks}: {found:?}, not {expected:?}");
        }
    }
}
