//! Every file by the text of the specifications, and by the parsers of `ktx2` and `ddsfile`.

use super::made::{Kind, Made};
use crate::io::support::Folder;
use texbake::Depth::{Bits8, Bits16};
use texbake::Encoding::{Snorm, Unorm};

/// Bytes of each level, the largest first, or why the file is none.
pub type Parsed = Result<Vec<Vec<u8>>, String>;

fn u32_at(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap())
}

fn u64_at(bytes: &[u8], at: usize) -> usize {
    u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap()) as usize
}

fn equal<T: PartialEq + std::fmt::Debug>(what: &str, found: T, expected: T) -> Result<(), String> {
    if found == expected { Ok(()) } else { Err(format!("{what} is {found:?}, not {expected:?}")) }
}

/// The basic data format descriptor of a kind (Khronos Data Format Specification 1.4, section 5), with the total size.
fn descriptor(kind: &Kind) -> Vec<u32> {
    // Model, samples as (bits, channel), lower and upper, qualifiers, bytes of the first plane.
    let qualifiers = match kind.encoding {
        Unorm => 0u32,
        Snorm => 0x40,
        _ => 0xc0,
    };
    let (model, samples): (u32, Vec<(u32, u32)>) = match (kind.blocks.is_some(), kind.bytes, kind.vulkan) {
        (true, 8, _) => (131, vec![(64, 0)]),
        (true, _, 145) => (134, vec![(128, 0)]),
        (true, ..) => (132, vec![(64, 0), (64, 1)]),
        _ => {
            let bits = 8 * kind.depth.bytes() as u32;
            let channels: &[u32] = [&[0][..], &[0, 1], &[0, 1, 2, 15]][kind.channels - 1];
            (1, channels.iter().map(|channel| (bits, *channel)).collect())
        }
    };
    let (lower, upper) = match (kind.blocks.is_some(), kind.encoding, kind.depth) {
        (true, Unorm, _) => (0, u32::MAX),
        (true, ..) => (0x8000_0000, 0x7fff_ffff),
        (_, Unorm, Bits8) => (0, 255),
        (_, Snorm, Bits8) => (-127i32 as u32, 127),
        (_, Unorm, Bits16) => (0, 65535),
        (_, Snorm, Bits16) => (-32767i32 as u32, 32767),
        _ => ((-1.0f32).to_bits(), 1.0f32.to_bits()),
    };
    let block_bytes = 24 + 16 * samples.len() as u32;
    let (unspecified, linear, straight) = (0, 1, 0);
    let dimensions = if kind.blocks.is_some() { 0x0000_0303 } else { 0 };
    let mut words = vec![
        4 + block_bytes,
        0,
        2 | block_bytes << 16,
        model | unspecified << 8 | linear << 16 | straight << 24,
        dimensions,
        kind.bytes as u32,
        0,
    ];
    let mut offset = 0;
    for (bits, channel) in samples {
        words.extend([offset | (bits - 1) << 16 | (channel | qualifiers) << 24, 0, lower, upper]);
        offset += bits;
    }
    words
}

/// A KTX2 file by its specification (version 2.0, sections 3 to 5).
pub fn ktx2(bytes: &[u8], made: &Made) -> Parsed {
    let (kind, levels) = (&made.kind, &made.levels);
    equal("identifier", &bytes[..12], b"\xabKTX 20\xbb\r\n\x1a\n")?;
    let type_size = if kind.blocks.is_some() { 1 } else { kind.depth.bytes() as u32 };
    let [width, height] = [levels[0].width, levels[0].height].map(|side| side as u32);
    let header = [kind.vulkan, type_size, width, height, 0, 0, 1, levels.len() as u32, 0];
    equal("header", std::array::from_fn(|word| u32_at(bytes, 12 + 4 * word)), header)?;

    let dfd_at = 80 + 24 * levels.len();
    let dfd: Vec<u32> = (0..descriptor(kind).len()).map(|word| u32_at(bytes, dfd_at + 4 * word)).collect();
    equal("descriptor", dfd, descriptor(kind))?;
    let kvd_at = dfd_at + 4 * descriptor(kind).len();
    let writer = "KTXwriter\0texbake\0";
    let mut metadata = b"\x12\0\0\0KTXorientation\0rd\0\0\0".to_vec();
    metadata.extend((writer.len() as u32).to_le_bytes());
    metadata.extend(writer.as_bytes());
    metadata.resize(metadata.len().next_multiple_of(4), 0);
    equal("keys and values", &bytes[kvd_at..kvd_at + metadata.len()], &metadata[..])?;
    let index = [dfd_at, kvd_at - dfd_at, kvd_at, metadata.len()].map(|word| word as u32);
    equal("index", std::array::from_fn(|word| u32_at(bytes, 48 + 4 * word)), index)?;
    equal("supercompression", [u64_at(bytes, 64), u64_at(bytes, 72)], [0, 0])?;

    // The smallest level first, each at the next multiple of lcm(bytes of a texel or block, 4): zeros between them.
    let alignment = (1..).map(|count| 4 * count).find(|multiple| multiple % kind.bytes == 0).unwrap();
    let mut end = kvd_at + metadata.len();
    let mut found = Vec::new();
    for (at, level) in levels.iter().enumerate().rev() {
        let entry: [usize; 3] = std::array::from_fn(|word| u64_at(bytes, 80 + 24 * at + 8 * word));
        let (offset, length) = (end.next_multiple_of(alignment), kind.sizes(level).0);
        equal("level", entry, [offset, length, length])?;
        equal("padding", bytes[end..offset].iter().all(|byte| *byte == 0), true)?;
        end = offset + length;
        found.insert(0, bytes.get(offset..end).ok_or("too short")?.to_vec());
    }
    equal("bytes", bytes.len(), end)?;
    Ok(found)
}

/// A DDS file by Microsoft's reference of DDS_HEADER, DDS_PIXELFORMAT and DDS_HEADER_DXT10.
pub fn dds(bytes: &[u8], made: &Made) -> Parsed {
    let (kind, levels) = (&made.kind, &made.levels);
    equal("magic number", &bytes[..4], b"DDS ")?;
    let [width, height] = [levels[0].width, levels[0].height].map(|side| side as u32);
    // CAPS, HEIGHT, WIDTH and PIXELFORMAT, with PITCH or LINEARSIZE; MIPMAPCOUNT; TEXTURE, with COMPLEX and MIPMAP.
    let (level_bytes, row_bytes) = kind.sizes(&levels[0]);
    let (size_flag, size) = if kind.blocks.is_some() { (0x80000, level_bytes) } else { (0x8, row_bytes) };
    let (mip_flag, caps) = if levels.len() > 1 { (0x20000, 0x401008) } else { (0, 0x1000) };
    let mut words = vec![124, 0x1007 | size_flag | mip_flag, height, width, size as u32, 0, levels.len() as u32];
    words.extend([0; 11]);
    // The pixel format says FOURCC, "DX10" alone.
    words.extend([32, 0x4, u32::from_le_bytes(*b"DX10"), 0, 0, 0, 0, 0]);
    words.extend([caps, 0, 0, 0, 0]);
    // The format, TEXTURE2D, no cube, one of them, ALPHA_MODE_OPAQUE.
    words.extend([kind.dxgi, 3, 0, 1, 3]);
    let header: Vec<u32> = (0..words.len()).map(|word| u32_at(bytes, 4 + 4 * word)).collect();
    equal("header", header, words)?;
    let mut at = 148;
    let mut found = Vec::new();
    for level in levels {
        let end = at + kind.sizes(level).0;
        found.push(bytes.get(at..end).ok_or("too short")?.to_vec());
        at = end;
    }
    equal("bytes", bytes.len(), at)?;
    Ok(found)
}

/// By the specification of the file's container.
pub fn by_specification(bytes: &[u8], made: &Made) -> Parsed {
    if made.is_ktx2() { ktx2(bytes, made) } else { dds(bytes, made) }
}

/// By the crate of the container, which gives its levels and says that they are linear.
fn by_crate(bytes: &[u8], made: &Made) -> Parsed {
    if made.is_ktx2() {
        let reader = ::ktx2::Reader::new(bytes).map_err(|error| error.to_string())?;
        equal("format", reader.header().format.map(|format| format.value()), Some(made.kind.vulkan))?;
        equal("transfer function", reader.transfer_function(), Some(::ktx2::TransferFunction::Linear))?;
        equal("alpha", reader.is_alpha_premultiplied(), Some(false))?;
        return Ok(reader.levels().map(|level| level.data.to_vec()).collect());
    }
    let dds = ddsfile::Dds::read(bytes).map_err(|error| error.to_string())?;
    equal("format", dds.get_dxgi_format().map(|format| format as u32), Some(made.kind.dxgi))?;
    equal("width", dds.get_width() as usize, made.levels[0].width)?;
    equal("levels", dds.get_num_mipmap_levels() as usize, made.levels.len())?;
    let mut data = dds.get_data(0).map_err(|error| error.to_string())?;
    let sizes = made.levels.iter().map(|level| made.kind.sizes(level).0);
    Ok(sizes.map(|size| data.split_off(..size).unwrap().to_vec()).collect())
}

#[test]
fn all_files_are_what_the_specifications_and_the_crates_say() {
    let folder = Folder::new();
    let all = Made::all(&folder);
    assert_eq!(all.len(), 27 * 7 * 2 * 2);
    for made in &all {
        let (name, bytes) = (made.path.display(), made.bytes());
        let found = by_specification(&bytes, made).unwrap_or_else(|error| panic!("{name}: {error}"));
        let parsed = by_crate(&bytes, made).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(found == parsed, "{name}: the crate finds other levels");
        if made.kind.blocks.is_none() {
            let expected: Vec<_> = made.levels.iter().map(|level| made.kind.texel_bytes(level)).collect();
            assert!(found == expected, "{name}: other texels than were written");
        }
    }
    // Both containers of a kind have the same blocks.
    for pair in all.chunks_exact(2) {
        let [a, b] = [&pair[0], &pair[1]].map(|made| by_specification(&made.bytes(), made).unwrap());
        assert!(a == b, "{}", pair[0].path.display());
    }
}

#[test]
fn a_changed_bit_of_any_header_is_seen() {
    let folder = Folder::new();
    for kind in [super::made::KINDS[2], super::made::KINDS[25]] {
        for container in super::made::CONTAINERS {
            let made = Made::new(&folder, kind, (17, 9), true, container);
            let bytes = made.bytes();
            let texels: usize = made.levels.iter().map(|level| kind.sizes(level).0).sum();
            let mut seen = 0;
            for at in 0..bytes.len() - texels {
                let mut changed = bytes.clone();
                changed[at] ^= 1;
                let result = std::panic::catch_unwind(|| by_specification(&changed, &made).is_err());
                assert!(result.unwrap_or(true), "{container}: byte {at} may be anything");
                seen += 1;
            }
            assert!(seen > 140);
            // And by the other parser: sRGB, and a level that stands elsewhere.
            let by_crate_fails = |at: usize, value: u8| {
                let mut changed = bytes.clone();
                changed[at] = value;
                by_crate(&changed, &made).map_or(true, |levels| levels != by_crate(&bytes, &made).unwrap())
            };
            let srgb = if made.is_ktx2() { (12, kind.vulkan as u8 + 6) } else { (128, kind.dxgi as u8 + 1) };
            assert!(by_crate_fails(srgb.0, srgb.1), "{container}: sRGB");
            if made.is_ktx2() {
                assert!(by_crate_fails(80, bytes[80] ^ 16), "the offset of a level");
            }
        }
    }
}
