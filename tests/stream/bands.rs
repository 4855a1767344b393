//! Bands of every height are the rows of the map and what its edge says lies beyond.

use super::rows::MemorySource;
use crate::oracle::neighbour;
use crate::support::{EDGES, Random, map_f32, map_u8, map_u16};
use texbake::stream::{Band, BandReader, HeightBand, HeightBands, MapBands, RowOrder, RowSource, read_map};
use texbake::{HeightMap, Heights};

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
    let mut random = Random::new(3);
    for height in [1, 2, 3, 4, 5, 7, 8, 9, 16, 17, 31] {
        let maps = [
            map_u8(5, height, |_, _| random.bits() as u8),
            map_u16(7, height, |_, _| random.bits() as u16),
            map_f32(3, height, |x, y| (x * 100 + y) as f32),
        ];
        for map in &maps {
            let rows = rows_of_map(map);
            for edge in EDGES {
                for band_rows in [1, 2, 3, 4, 7, 8, 30, 31, 1000] {
                    let what = format!("{} rows of {}, {edge}, bands of {band_rows}", height, map.depth());
                    let source = || Box::new(MemorySource::new(map.clone())) as Box<dyn RowSource>;
                    let mut in_memory = MapBands::new(map, edge, band_rows);
                    let mut read = BandReader::new(source(), edge, RowOrder::FromTop, band_rows);
                    for bands in [&mut in_memory as &mut dyn HeightBands, &mut read] {
                        let mut first = 0;
                        while let Some(band) = bands.next().expect("rows") {
                            let [above, body, below] = rows_of_band(&band);
                            let row =
                                |i: usize, step: i64| &rows[neighbour(edge, i as i64 + step, height as i64) as usize];
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
        let map = map_u16(3, height, |x, y| (10 * y + x) as u16);
        let rows = rows_of_map(&map);
        for band_rows in [1, 2, 3, 4, 8, 30, 31, 1000] {
            let source = Box::new(MemorySource::new(map.clone()));
            let order = RowOrder::FirstRowLast { height };
            let mut bands = BandReader::new(source, texbake::Edge::Wrap, order, band_rows);
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
    let map = map_u16(3, 9, |x, y| (10 * y + x) as u16);
    let mut bands = MapBands::new(&map, texbake::Edge::Mirror, 100);
    let band = bands.next().expect("rows").expect("a band");
    let row = |y: u32| vec![10 * y, 10 * y + 1, 10 * y + 2];
    for (first, count, above, below) in [(0, 9, 1, 7), (0, 1, 1, 1), (8, 1, 7, 7), (2, 3, 1, 5)] {
        let body: Rows = (first..first + count).map(|y| row(y as u32)).collect();
        assert_eq!(rows_of_band(&band.part(first, count)), [vec![row(above)], body, vec![row(below)]]);
    }
}

#[test]
fn a_map_that_is_read_is_the_map() {
    let map = map_f32(11, 13, |x, y| x as f32 - 0.5 * y as f32);
    assert_eq!(read_map(&mut MemorySource::new(map.clone())).expect("rows"), map);
}
