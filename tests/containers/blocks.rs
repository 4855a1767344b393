//! Blocks, decoded here by the text of the formats (Microsoft, "Texture Block Compression in Direct3D 11"; Khronos Data
//! Format Specification, sections 18.4 and 18.5), in exact numbers.

use super::made::{KINDS, Level, Made, SIZES, bc7};
use super::parsed::by_specification;
use crate::io::support::Folder;
use block_compression::encode::compress_rgba8;
use block_compression::{BC7Settings, CompressionVariant};
use texbake::Codes;
use texbake::Encoding::Snorm;
use texbake::io::{BlockCompression, WriteOptions, create_normals_with};
use texbake::{CodesRef, NormalFormat, Size};

/// A block of BC4, or one of the two components of one of BC5.
pub struct Component<'a> {
    pub block: &'a [u8],
    pub signed: bool,
}

impl Component<'_> {
    /// The two ends of its range, in codes.
    pub fn ends(&self) -> [f64; 2] {
        [0, 1].map(|end| if self.signed { f64::from(self.block[end] as i8) } else { f64::from(self.block[end]) })
    }

    /// Which of its values texel `at` has: 0 and 1 are the ends.
    pub fn index(&self, at: usize) -> u8 {
        let bits = u64::from_le_bytes(self.block.try_into().unwrap()) >> 16;
        (bits >> (3 * at) & 7) as u8
    }

    /// The value of texel `at`, in codes.
    pub fn value(&self, at: usize) -> f64 {
        let ([first, second], index) = (self.ends(), f64::from(self.index(at)));
        match (self.index(at), first > second) {
            (0, _) => first,
            (1, _) => second,
            (_, true) => ((8.0 - index) * first + (index - 1.0) * second) / 7.0,
            _ => panic!("a block of six values, which the encoder does not make but of one code"),
        }
    }
}

#[test]
fn a_component_is_off_by_a_fourteenth_of_its_blocks_range_at_most() {
    let folder = Folder::new();
    let mut components = 0;
    for kind in KINDS.into_iter().filter(|kind| kind.blocks.is_some() && kind.vulkan != 145) {
        for size in SIZES {
            let made = Made::new(&folder, kind, size, true, "ktx2");
            let all = by_specification(&made.bytes(), &made).unwrap();
            for (level, bytes) in made.levels.iter().zip(all) {
                let Codes::U8(codes) = &level.codes else { panic!("blocks are of 8 bits") };
                let across = level.width.div_ceil(4);
                for (at, block) in bytes.chunks_exact(8).enumerate() {
                    let channels_kept = kind.bytes / 8;
                    let (channel, block_at) = (at % channels_kept, at / channels_kept);
                    let (left, top) = (block_at % across * 4, block_at / across * 4);
                    let inside = (0..16).map(|at| (at, left + at % 4, top + at / 4));
                    let texels = inside.filter(|(_, x, y)| *x < level.width && *y < level.height);
                    let code = |x, y| {
                        let code = codes[(y * level.width + x) * kind.channels + channel];
                        if kind.encoding == Snorm { f64::from(code as i8) } else { f64::from(code) }
                    };
                    let component = Component { block, signed: kind.encoding == Snorm };
                    let values: Vec<(f64, f64)> = texels.map(|(at, x, y)| (code(x, y), component.value(at))).collect();
                    let least = values.iter().map(|value| value.0).fold(f64::MAX, f64::min);
                    let greatest = values.iter().map(|value| value.0).fold(f64::MIN, f64::max);
                    // 1e-9: the roundings of f64 here.
                    let allowed = (greatest - least) / 14.0 + 1e-9;
                    for (code, decoded) in values {
                        assert!((code - decoded).abs() <= allowed, "{}: {code} is {decoded}", made.path.display());
                        components += 1;
                    }
                }
            }
        }
    }
    assert!(components > 50_000, "{components}");
}

/// A smooth normal map of `SIDE` x `SIDE` texels, RGBA.
fn smooth() -> Vec<u8> {
    let texel = |x: f64, y: f64| {
        let (dx, dy) = (0.8 * (0.13 * x).sin(), 0.8 * (0.09 * y + 0.05 * x).cos());
        let length = (dx * dx + dy * dy + 1.0).sqrt();
        let [x, y, z] = [-dx, dy, 1.0].map(|v: f64| ((v / length + 1.0) * 127.5 + 0.5) as u8);
        [x, y, z, 255]
    };
    (0..SIDE * SIDE).flat_map(|at| texel((at % SIDE) as f64, (at / SIDE) as f64)).collect()
}

const SIDE: usize = 64;

/// The greatest and the root mean square error of x, y and z, in codes.
fn errors(rgba: &[u8], decoded: &[u8]) -> (u8, f64) {
    let texels = rgba.chunks_exact(4).zip(decoded.chunks_exact(4));
    let errors: Vec<u8> = texels.flat_map(|(a, b)| (0..3).map(|at| a[at].abs_diff(b[at]))).collect();
    let squares: f64 = errors.iter().map(|error| f64::from(*error).powi(2)).sum();
    (*errors.iter().max().unwrap(), (squares / errors.len() as f64).sqrt())
}

/// BC7 has no bound of its own: a block holds at most three lines through the codes, and its texels lie beside them.
/// Of this map, whose slopes change by up to 0.1 from texel to texel, the errors are the same on every machine: they are
/// measured here.
#[test]
fn bc7_of_a_smooth_normal_map_is_a_few_codes_off() {
    let folder = Folder::new();
    let rgba = smooth();
    let path = folder.path("n.dds");
    let options = WriteOptions { blocks: Some(BlockCompression::Bc7), ..WriteOptions::default() };
    let size = Size::new(SIDE, SIDE).unwrap();
    let mut sink = create_normals_with(&path, size, NormalFormat::default(), &options).unwrap().rows;
    let codes: Vec<u8> = rgba.chunks_exact(4).flat_map(|texel| texel[..3].to_vec()).collect();
    sink.write(0, CodesRef::U8(&codes)).unwrap();
    sink.finish().unwrap();

    let level = Level { width: SIDE, height: SIDE, codes: Codes::U8(codes) };
    let file = std::fs::read(&path).unwrap();
    let (greatest, rms) = errors(&rgba, &bc7(&file[148..], &level));
    println!("greatest error {greatest}, root mean square {rms}");
    assert!(greatest <= 7 && rms < 1.4, "{greatest}, {rms}");

    // The settings: slow ones gain nothing, fast ones lose.
    let of = |settings| {
        let mut blocks = vec![0; SIDE * SIDE];
        let side = SIDE as u32;
        compress_rgba8(CompressionVariant::BC7(settings), &rgba, &mut blocks, side, side, 4 * side);
        (errors(&rgba, &bc7(&blocks, &level)).1, blocks)
    };
    let (basic, blocks) = of(BC7Settings::opaque_basic());
    assert!(blocks == file[148..], "the file holds the blocks of whole rows");
    let (slow, fast) = (of(BC7Settings::opaque_slow()).0, of(BC7Settings::opaque_fast()).0);
    println!("slow {slow}, basic {basic}, fast {fast}");
    assert!(basic < 1.01 * slow && basic < 0.95 * fast, "slow {slow}, basic {basic}, fast {fast}");
}
