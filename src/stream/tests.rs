//! Bands of every height are the rows of the map and what its edge says lies beyond; what fails on the way lets go.

use super::{
    Band, BandReader, CodeSink, CodeWriter, HeightBand, HeightBands, MapBands, RowOrder, RowSink, RowSource, Stop,
    read_map,
};
use crate::error::Result;
use crate::map::{CodesRef, Edge, Grid, HeightMap, HeightType, Heights, HeightsMut, NormalFormat, Size};
use std::sync::Arc;

/// Rows of a map in memory.
struct MemorySource {
    map: HeightMap,
    next_row: usize,
    /// Lives as long as the source.
    open: Arc<()>,
}

impl MemorySource {
    fn new(map: HeightMap) -> Self {
        Self { map, next_row: 0, open: Arc::new(()) }
    }

    fn copy(&self, first_row: usize, rows: HeightsMut<'_>) -> usize {
        fn copy<T: Copy>(all: &[T], from: usize, rows: &mut [T]) -> usize {
            rows.copy_from_slice(&all[from..][..rows.len()]);
            rows.len()
        }
        let from = first_row * self.map.size().width();
        match (self.map.heights(), rows) {
            (Heights::U8(all), HeightsMut::U8(rows)) => copy(all, from, rows),
            (Heights::U16(all), HeightsMut::U16(rows)) => copy(all, from, rows),
            (Heights::F32(all), HeightsMut::F32(rows)) => copy(all, from, rows),
            _ => panic!("rows of another height type were asked for"),
        }
    }
}

impl RowSource for MemorySource {
    fn size(&self) -> Size {
        self.map.size()
    }

    fn height_type(&self) -> HeightType {
        self.map.height_type()
    }

    fn read(&mut self, rows: HeightsMut<'_>) -> Result<()> {
        self.next_row += self.copy(self.next_row, rows) / self.size().width();
        Ok(())
    }

    fn rewind(&mut self) -> Result<()> {
        self.next_row = 0;
        Ok(())
    }

    fn held_bytes(&self) -> u64 {
        0
    }
}

/// A map of three columns whose heights all differ; rows of 10 y + x.
fn tens(height: usize) -> HeightMap {
    Grid::from_fn(3, height, |x, y| (10 * y + x) as u16).unwrap().into()
}

/// The row beside row `row` of `height`, by cases.
fn row_beside(edge: Edge, row: usize, step: isize, height: usize) -> usize {
    let last = height - 1;
    let [outside, opposite, border, inner] = match (row, step) {
        (0, -1) => [1, last, 0, 1.min(last)],
        (row, 1) if row == last => [1, 0, last, last.saturating_sub(1)],
        _ => [0; 4],
    };
    match edge {
        _ if outside == 0 => row.strict_add_signed(step),
        Edge::Wrap => opposite,
        Edge::Clamp => border,
        Edge::Mirror => inner,
    }
}

/// Rows of bits, whatever the height type.
type Rows = Vec<Vec<u32>>;

fn rows_of_band(band: &HeightBand<'_>) -> [Rows; 3] {
    fn rows<T: Copy>(band: &Band<'_, T>, bits: impl Fn(T) -> u32 + Copy) -> [Rows; 3] {
        [band.above, band.body, band.below]
            .map(|part| part.chunks(band.width).map(|row| row.iter().map(|&h| bits(h)).collect()).collect())
    }
    match band {
        HeightBand::U8(band) => rows(band, u32::from),
        HeightBand::U16(band) => rows(band, u32::from),
        HeightBand::F32(band) => rows(band, f32::to_bits),
    }
}

fn rows_of_map(map: &HeightMap) -> Rows {
    let bits: Vec<u32> = match map.heights() {
        Heights::U8(heights) => heights.iter().map(|&h| h.into()).collect(),
        Heights::U16(heights) => heights.iter().map(|&h| h.into()).collect(),
        Heights::F32(heights) => heights.iter().map(|h| h.to_bits()).collect(),
    };
    bits.chunks(map.size().width()).map(<[u32]>::to_vec).collect()
}

#[test]
fn bands_hold_the_map_and_its_halo() {
    for height in [1, 2, 3, 4, 5, 7, 8, 9, 16, 17, 31] {
        let maps: [HeightMap; 3] = [
            Grid::from_fn(5, height, |x, y| (5 * y + x) as u8).unwrap().into(),
            Grid::from_fn(7, height, |x, y| (1000 * x + y) as u16).unwrap().into(),
            Grid::from_fn(3, height, |x, y| (x * 100 + y) as f32).unwrap().try_into().unwrap(),
        ];
        for map in &maps {
            let rows = rows_of_map(map);
            for edge in [Edge::Wrap, Edge::Clamp, Edge::Mirror] {
                for band_rows in [1, 2, 3, 4, 7, 8, 30, 31, 1000] {
                    let what = format!("{} rows of {}, {edge}, bands of {band_rows}", height, map.height_type());
                    let source = || Box::new(MemorySource::new(map.clone())) as Box<dyn RowSource>;
                    let mut in_memory = MapBands::new(map, edge, band_rows);
                    let mut read = BandReader::new(source(), edge, RowOrder::FromTop, band_rows, Stop::default())
                        .expect("a thread");
                    for bands in [&mut in_memory as &mut dyn HeightBands, &mut read] {
                        let mut first = 0;
                        while let Some(band) = bands.next().expect("rows") {
                            let [above, body, below] = rows_of_band(&band);
                            let row = |row: usize, step: isize| &rows[row_beside(edge, row, step, height)];
                            assert_eq!(body, rows[first..first + band.rows()], "{what}: from row {first}");
                            assert_eq!(&above[0], row(first, -1), "{what}: above row {first}");
                            first += band.rows();
                            assert_eq!(&below[0], row(first - 1, 1), "{what}: below row {}", first - 1);
                            assert!(band.rows() == band_rows || first == height, "{what}: a short band");
                        }
                        assert_eq!(first, height, "{what}: rows in all");
                        assert!(bands.next().expect("the end").is_none(), "{what}: something after the end");
                    }
                }
            }
        }
    }
}

#[test]
fn the_first_row_can_come_last() {
    for height in [2, 3, 4, 5, 8, 9, 31] {
        let map = tens(height);
        let rows = rows_of_map(&map);
        for band_rows in [1, 2, 3, 4, 8, 30, 31, 1000] {
            let source = Box::new(MemorySource::new(map.clone()));
            let mut bands = BandReader::new(source, Edge::Wrap, RowOrder::FirstRowLast, band_rows, Stop::default())
                .expect("a thread");
            let (mut bodies, mut starts) = (Rows::new(), Vec::new());
            while let Some(band) = bands.next().expect("rows") {
                let first = (1 + bodies.len()) % height;
                let [above, body, below] = rows_of_band(&band);
                assert_eq!(above[0], rows[(first + height - 1) % height], "above row {first} of {height}");
                assert_eq!(below[0], rows[(first + body.len()) % height], "below from row {first} of {height}");
                starts.push(first);
                bodies.extend(body);
            }
            let rotated: Rows = rows[1..].iter().chain(&rows[..1]).cloned().collect();
            assert_eq!(bodies, rotated, "{height} rows, bands of {band_rows}");
            assert_eq!(starts.last(), Some(&0), "{height} rows, bands of {band_rows}");
        }
    }
}

#[test]
fn a_part_of_a_band_is_a_band() {
    let map = tens(9);
    let mut bands = MapBands::new(&map, Edge::Mirror, 100);
    let band = bands.next().expect("rows").expect("a band");
    let row = |y: u32| vec![10 * y, 10 * y + 1, 10 * y + 2];
    for (first, count, above, below) in [(0, 9, 1, 7), (0, 1, 1, 1), (8, 1, 7, 7), (2, 3, 1, 5)] {
        let body: Rows = (first..first + count).map(|y| row(y as u32)).collect();
        assert_eq!(rows_of_band(&band.part(first, count)), [vec![row(above)], body, vec![row(below)]]);
    }
}

#[test]
fn a_map_that_is_read_is_the_map() {
    // More than one piece.
    let map = HeightMap::try_from(Grid::from_fn(1100, 700, |x, y| x as f32 - 0.5 * y as f32).unwrap()).unwrap();
    assert_eq!(read_map(&mut MemorySource::new(map.clone())).expect("rows"), map);
}

#[test]
fn a_reader_that_is_dropped_has_closed_its_source() {
    for bands_used in [0, 1, 2] {
        let source = MemorySource::new(tens(1000));
        let open = Arc::downgrade(&source.open);
        let mut bands =
            BandReader::new(Box::new(source), Edge::Wrap, RowOrder::FromTop, 10, Stop::default()).expect("a thread");
        for _ in 0..bands_used {
            bands.next().expect("rows").expect("a band");
        }
        drop(bands);
        assert_eq!(open.strong_count(), 0, "after {bands_used} bands");
    }
}

/// Takes all rows and forgets them.
struct Nowhere;

impl RowSink for Nowhere {
    fn held_bytes(&self, _: usize) -> u64 {
        0
    }

    fn write(&mut self, _: usize, _: CodesRef<'_>) -> Result<()> {
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<()> {
        Ok(())
    }
}

#[test]
fn a_band_that_cannot_be_filled_can_be_tried_again() {
    let size = Size::new(4, 4).unwrap();
    let mut sink =
        CodeWriter::new(Box::new(Nowhere), size, NormalFormat::default().texel(), RowOrder::FromTop).unwrap();
    // More often than there are buffers.
    for _ in 0..10 {
        assert_eq!(sink.room(1).expect("room").len(), 12);
    }
    assert_eq!(sink.room(4).expect("room").len(), 48);
    sink.filled().expect("a band");
    sink.complete().and_then(|sink| sink.finish()).expect("a map");
}
