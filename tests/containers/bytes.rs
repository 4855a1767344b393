//! Whole files of a few texels, byte by byte.

use crate::io::support::Folder;
use texbake::io::{BlockCompression, WriteOptions, create_normals_with, create_parallax_with};
use texbake::stream::MapOut;
use texbake::{Channels, CodesRef, Depth, Encoding, NormalFormat, ParallaxFormat, Size};

/// Bytes from hexadecimal digits, in which blanks do not count.
fn hex(text: &str) -> Vec<u8> {
    let digits: Vec<u8> = text.bytes().filter(u8::is_ascii_hexdigit).collect();
    digits.chunks_exact(2).map(|byte| u8::from_str_radix(std::str::from_utf8(byte).unwrap(), 16).unwrap()).collect()
}

#[test]
fn two_levels_of_rg8_in_ktx2() {
    let folder = Folder::new();
    let path = folder.path("n.ktx2");
    let format = NormalFormat { channels: Channels::Xy, ..NormalFormat::default() };
    let options = WriteOptions { mips: true, ..WriteOptions::default() };
    let MapOut { mut rows, levels } = create_normals_with(&path, Size::new(2, 1).unwrap(), format, &options).unwrap();
    rows.write(0, CodesRef::U8(&[1, 2, 3, 4])).unwrap();
    levels.unwrap().write(1, 0, CodesRef::U8(&[5, 6])).unwrap();
    rows.finish().unwrap();
    let expected = hex(
        // Identifier; VK_FORMAT_R8G8_UNORM, type size 1, 2 x 1 x 0, 0 layers, 1 face, 2 levels, no supercompression.
        "ab4b5458 203230bb 0d0a1a0a 10000000 01000000 02000000 01000000 00000000 00000000 01000000 02000000 00000000
        80000000 3c000000 bc000000 30000000 00000000 00000000 00000000 00000000
        f000000000000000 0400000000000000 0400000000000000
        ec00000000000000 0200000000000000 0200000000000000
        3c000000 00000000 02003800 01000100 00000000 02000000 00000000
        00000700 00000000 00000000 ff000000 08000701 00000000 00000000 ff000000",
    );
    let writer = "KTXwriter\0texbake\0\0\0";
    let metadata = [&b"\x12\0\0\0KTXorientation\0rd\0\0\0\x12\0\0\0"[..], writer.as_bytes()].concat();
    let texels = hex("0506 0000 01020304");
    assert_eq!(std::fs::read(&path).unwrap(), [&expected[..], &metadata, &texels].concat());
}

#[test]
fn a_texel_of_rgba8_in_dds() {
    let folder = Folder::new();
    let path = folder.path("n.dds");
    let size = Size::new(1, 1).unwrap();
    let mut sink = create_normals_with(&path, size, NormalFormat::default(), &WriteOptions::default()).unwrap().rows;
    sink.write(0, CodesRef::U8(&[128, 128, 255])).unwrap();
    sink.finish().unwrap();
    let zeros = "00000000".repeat(11);
    let expected = hex(&format!(
        "44445320 7c000000 0f100000 01000000 01000000 04000000 00000000 01000000 {zeros}
        20000000 04000000 44583130 00000000 00000000 00000000 00000000 00000000
        00100000 00000000 00000000 00000000 00000000
        1c000000 03000000 00000000 01000000 03000000
        8080ffff"
    ));
    assert_eq!(std::fs::read(&path).unwrap(), expected);
}

#[test]
fn blocks_of_one_code_and_of_a_ramp() {
    let folder = Folder::new();
    let options = WriteOptions { blocks: Some(BlockCompression::Bc4), ..WriteOptions::default() };
    let block = |encoding, width, height, codes: &[u8]| {
        let path = folder.path("p.dds");
        let format = ParallaxFormat { encoding, depth: Depth::Bits8 };
        let mut sink = create_parallax_with(&path, Size::new(width, height).unwrap(), format, &options).unwrap().rows;
        sink.write(0, CodesRef::U8(codes)).unwrap();
        sink.finish().unwrap();
        std::fs::read(&path).unwrap()[148..].to_vec()
    };
    // Both ends are the code, and every texel takes the second.
    assert_eq!(block(Encoding::Unorm, 1, 1, &[77]), hex("4d4d 49922449 9224"));
    assert_eq!(block(Encoding::Snorm, 1, 1, &[0]), hex("0000 49922449 9224"));
    assert_eq!(block(Encoding::Snorm, 1, 1, &[-127i8 as u8]), hex("8181 49922449 9224"));
    // Eight codes in steps of one between 7 and 0, which is -7 and 0 in signed blocks: indices 1 7 6 5 4 3 2 0, twice.
    let ramp: Vec<u8> = (0..16).map(|at| at % 8).collect();
    let indices = [1u64, 7, 6, 5, 4, 3, 2, 0].repeat(2);
    let bits = indices.iter().enumerate().fold(0, |bits, (at, index)| bits | index << (3 * at));
    let expected = |ends: [u8; 2]| [&ends[..], &bits.to_le_bytes()[..6]].concat();
    assert_eq!(block(Encoding::Unorm, 4, 4, &ramp), expected([7, 0]));
    let signed: Vec<u8> = ramp.iter().map(|code| (*code as i8 - 7) as u8).collect();
    assert_eq!(block(Encoding::Snorm, 4, 4, &signed), expected([0, -7i8 as u8]));
    // A border repeats: a block of 1 x 3 texels is the one of its row drawn out.
    let drawn_out: Vec<u8> = [3, 9, 200, 200].iter().flat_map(|code| [*code; 4]).collect();
    assert_eq!(block(Encoding::Unorm, 1, 3, &[3, 9, 200]), block(Encoding::Unorm, 4, 4, &drawn_out));
}
