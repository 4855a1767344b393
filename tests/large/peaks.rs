//! A flat map with a few peaks, as large as wanted: the file is sparse, and what each texel's normal must be is known.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufReader;
use std::os::unix::fs::FileExt;
use std::path::Path;
use texbake::HeightsMut;
use texbake::io::{ReadOptions, open_heights};

/// Texels of white; the slopes beside a peak of code 255 or 65535 are half of it.
pub const SCALE: &str = "24";

/// A flat map of height 0 with peaks of height 1, of which none is near another.
pub struct Peaks {
    pub size: [usize; 2],
    pub peaks: Vec<[usize; 2]>,
}

impl Peaks {
    /// Peaks in the corner that all edges meet, at the ends of rows, in the first and last rows, and inside.
    pub fn new(width: usize, height: usize) -> Self {
        let peaks = vec![
            [0, 0],
            [width - 1, height / 4],
            [0, height / 3],
            [777, height - 1],
            [width / 2, height / 2],
            [width - 5, 0],
            [300, height - 4],
        ];
        Self { size: [width, height], peaks }
    }

    /// Writes the peaks into a file of zeros, from `offset` on where texels of `bytes` bytes stand in rows.
    pub fn dig(&self, file: &File, offset: u64, bytes: usize) {
        let [width, height] = self.size;
        let end = offset + (width * height * bytes) as u64;
        file.set_len(end.max(file.metadata().unwrap().len())).unwrap();
        for [x, y] in &self.peaks {
            file.write_all_at(&[255, 255][..bytes], offset + ((y * width + x) * bytes) as u64).unwrap();
        }
    }

    /// The row `y` of heights as codes of `bytes` bytes.
    pub fn row(&self, y: usize, bytes: usize) -> Vec<u8> {
        let mut row = vec![0; self.size[0] * bytes];
        self.peaks.iter().filter(|peak| peak[1] == y).for_each(|[x, _]| row[x * bytes..][..bytes].fill(255));
        row
    }

    /// The slopes (dz/dx, dz/dy) of the texels that are not flat, by central differences over a map that wraps: half the
    /// scale beside a peak, rising towards it.
    pub fn slopes(&self) -> BTreeMap<[usize; 2], [f64; 2]> {
        let [width, height] = self.size;
        let beside = |[x, y]: [usize; 2]| {
            [
                ([(x + width - 1) % width, y], [12.0, 0.0]),
                ([(x + 1) % width, y], [-12.0, 0.0]),
                ([x, (y + height - 1) % height], [0.0, 12.0]),
                ([x, (y + 1) % height], [0.0, -12.0]),
            ]
        };
        self.peaks.iter().flat_map(|peak| beside(*peak)).collect()
    }

    /// Fails unless the PNG holds the 8-bit normals of this map, green up.
    pub fn assert_normals(&self, path: &Path) {
        let file = BufReader::with_capacity(1 << 20, File::open(path).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
        assert_eq!([reader.info().width as usize, reader.info().height as usize], self.size);
        let slopes = self.slopes();
        let flat = [128, 128, 255].repeat(self.size[0]);
        let mut row = vec![0; flat.len()];
        for y in 0..self.size[1] {
            reader.read_row(&mut row).unwrap().expect("a row");
            let steep = slopes.iter().filter(|(texel, _)| texel[1] == y);
            for ([x, _], [dx, dy]) in steep {
                // 12 and 1 over the root of 145: no code is near a tie.
                let length = (1.0 + dx * dx + dy * dy).sqrt();
                let code = |component: f64| ((component / length + 1.0) * 127.5 + 0.5).floor() as u8;
                let expected = [code(-dx), code(*dy), code(1.0)];
                assert_eq!(row[3 * x..][..3], expected, "column {x}, row {y}");
                row[3 * x..][..3].copy_from_slice(&flat[..3]);
            }
            assert!(row == flat, "row {y}: a texel is not flat");
        }
        reader.finish().unwrap();
    }

    /// Fails unless the EXR or TIFF of one channel holds the parallax map n_z (2h - 1): -1 where it is flat.
    pub fn assert_parallax(&self, path: &Path) {
        let mut rows = open_heights(path, &ReadOptions::default()).unwrap().rows;
        assert_eq!([rows.size().width(), rows.size().height()], self.size);
        let slopes = self.slopes();
        let mut row = vec![0.0; self.size[0]];
        for y in 0..self.size[1] {
            rows.read(HeightsMut::F32(&mut row)).unwrap();
            for [x, _] in slopes.keys().filter(|texel| texel[1] == y) {
                // Correctly rounded: within half of the spacing of floats below 1/8, 2^-28.
                assert!((f64::from(row[*x]) + 1.0 / 145f64.sqrt()).abs() <= 2f64.powi(-28), "column {x}, row {y}");
                row[*x] = -1.0;
            }
            for [x, _] in self.peaks.iter().filter(|peak| peak[1] == y) {
                assert_eq!(row[*x], 1.0, "the peak at column {x}, row {y}");
                row[*x] = -1.0;
            }
            assert!(row.iter().all(|value| *value == -1.0), "row {y}");
        }
    }
}
