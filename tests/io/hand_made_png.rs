//! PNGs written by hand, for what no encoder at hand writes.

/// A PNG whose rows are in one stored deflate block.
pub fn hand_made(width: u32, height: u32, bits: u8, colour: u8, interlace: u8, rows: &[u8]) -> Vec<u8> {
    of_chunks([width, height], [bits, colour, interlace], &[(b"IDAT", stored(rows))])
}

/// A PNG of these chunks, between IHDR and IEND; `kind` is bits, colour type and interlace method.
pub fn of_chunks(size: [u32; 2], [bits, colour, interlace]: [u8; 3], chunks: &[(&[u8; 4], Vec<u8>)]) -> Vec<u8> {
    let mut header = size.map(u32::to_be_bytes).concat();
    header.extend([bits, colour, 0, 0, interlace]);
    let ends = [(b"IHDR", header), (b"IEND", Vec::new())];
    let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
    for (name, content) in ends[..1].iter().chain(chunks).chain(&ends[1..]) {
        file.extend((content.len() as u32).to_be_bytes());
        let named = [&name[..], content].concat();
        file.extend(&named);
        file.extend(crc32fast::hash(&named).to_be_bytes());
    }
    file
}

/// A zlib stream of one stored block.
pub fn stored(bytes: &[u8]) -> Vec<u8> {
    let length = bytes.len() as u16;
    let mut data = vec![0x78, 0x01, 1];
    data.extend(length.to_le_bytes());
    data.extend((!length).to_le_bytes());
    data.extend(bytes);
    data.extend(adler32(bytes).to_be_bytes());
    data
}

fn adler32(bytes: &[u8]) -> u32 {
    let (a, b) = bytes.iter().fold((1, 0), |(a, b), byte| {
        let a = (a + u32::from(*byte)) % 65521;
        (a, (b + a) % 65521)
    });
    b << 16 | a
}
