//! TIFFs written by hand, for what no encoder at hand writes.

/// A TIFF, least significant byte first.
#[derive(Clone)]
pub struct Tiff {
    pub width: u32,
    pub height: u32,
    pub bits: u16,
    /// 1 unsigned, 2 signed, 3 float.
    pub kind: u16,
    pub samples: u16,
    /// 1 black is zero, 2 RGB.
    pub photometric: u16,
    pub planar: bool,
    /// 1 none, 5 LZW, 8 deflate: of the bytes that the chunks already are.
    pub compression: u16,
    /// Tile sides, or rows per strip.
    pub tile: Option<(u32, u32)>,
    pub rows_per_strip: u32,
    pub chunks: Vec<Vec<u8>>,
    /// Other entries: tag, type, number, bytes.
    pub extra: Vec<(u16, u16, u32, Vec<u8>)>,
}

impl Tiff {
    pub fn grey(width: u32, height: u32, bits: u16, kind: u16, chunks: Vec<Vec<u8>>) -> Self {
        let rows_per_strip = height.div_ceil(chunks.len().max(1) as u32);
        let (samples, photometric, planar, tile, extra) = (1, 1, false, None, Vec::new());
        let compression = 1;
        Self {
            width,
            height,
            bits,
            kind,
            samples,
            photometric,
            planar,
            compression,
            tile,
            rows_per_strip,
            chunks,
            extra,
        }
    }

    pub fn bytes(&self) -> Vec<u8> {
        let longs = |values: Vec<u32>| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
        let shorts = |values: Vec<u16>| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
        let mut data = Vec::new();
        let mut offsets = Vec::new();
        for chunk in &self.chunks {
            offsets.push(8 + data.len() as u32);
            data.extend(chunk);
        }
        data.resize(data.len().next_multiple_of(2), 0);
        let counts: Vec<u32> = self.chunks.iter().map(|chunk| chunk.len() as u32).collect();
        let chunks = self.chunks.len() as u32;
        let samples = usize::from(self.samples);
        let mut entries = vec![
            (256, 4, 1, longs(vec![self.width])),
            (257, 4, 1, longs(vec![self.height])),
            (258, 3, samples as u32, shorts(vec![self.bits; samples])),
            (259, 3, 1, shorts(vec![self.compression])),
            (262, 3, 1, shorts(vec![self.photometric])),
            (277, 3, 1, shorts(vec![self.samples])),
            (284, 3, 1, shorts(vec![if self.planar { 2 } else { 1 }])),
            (339, 3, samples as u32, shorts(vec![self.kind; samples])),
        ];
        match self.tile {
            None => entries.extend([
                (273, 4, chunks, longs(offsets)),
                (278, 4, 1, longs(vec![self.rows_per_strip])),
                (279, 4, chunks, longs(counts)),
            ]),
            Some((width, height)) => entries.extend([
                (322, 4, 1, longs(vec![width])),
                (323, 4, 1, longs(vec![height])),
                (324, 4, chunks, longs(offsets)),
                (325, 4, chunks, longs(counts)),
            ]),
        }
        entries.extend(self.extra.clone());
        entries.sort_by_key(|entry| entry.0);
        let directory = 8 + data.len() as u32;
        let mut behind = Vec::new();
        let behind_start = directory + 2 + 12 * entries.len() as u32 + 4;
        let mut file = [b"II*\0".to_vec(), longs(vec![directory]), data].concat();
        file.extend((entries.len() as u16).to_le_bytes());
        for (tag, kind, count, mut value) in entries {
            file.extend(shorts(vec![tag, kind]));
            file.extend(longs(vec![count]));
            if value.len() > 4 {
                let offset = behind_start + behind.len() as u32;
                behind.append(&mut value);
                behind.resize(behind.len().next_multiple_of(2), 0);
                value = longs(vec![offset]);
            }
            value.resize(4, 0);
            file.extend(value);
        }
        file.extend([0; 4]);
        file.extend(behind);
        file
    }
}
