//! Bakes from rows to rows.

use crate::support::{
    BIASED8, EDGES, FLOAT16, FLOAT32, Random, SNORM16, Subject, UNORM8, every_baker, map_f32, map_u8, map_u16, options,
};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, Mutex};
use texbake::stream::{MapOut, Monitor, RowSink, RowSource};
use texbake::{
    Baker, Channels, CodesRef, Edge, Edges, Error, HeightMap, HeightType, Heights, HeightsMut, NormalFormat,
    NormalOptions, Result, Size,
};

/// Rows of a map in memory.
pub struct MemorySource {
    map: HeightMap,
    next_row: usize,
    /// The row that cannot be read, if there is one.
    broken_row: Option<usize>,
}

impl MemorySource {
    pub fn new(map: HeightMap) -> Self {
        Self { map, next_row: 0, broken_row: None }
    }

    fn copy(&self, first_row: usize, rows: HeightsMut<'_>) {
        let from = first_row * self.map.size().width();
        match (self.map.heights(), rows) {
            (Heights::U8(all), HeightsMut::U8(rows)) => rows.copy_from_slice(&all[from..][..rows.len()]),
            (Heights::U16(all), HeightsMut::U16(rows)) => rows.copy_from_slice(&all[from..][..rows.len()]),
            (Heights::F32(all), HeightsMut::F32(rows)) => rows.copy_from_slice(&all[from..][..rows.len()]),
            _ => panic!("rows of another height type were asked for"),
        }
    }
}

fn broken(path: &str) -> Error {
    Error::Io { path: path.into(), source: std::io::Error::other("it tore") }
}

impl RowSource for MemorySource {
    fn size(&self) -> Size {
        self.map.size()
    }

    fn height_type(&self) -> HeightType {
        self.map.height_type()
    }

    fn read(&mut self, rows: HeightsMut<'_>) -> Result<()> {
        let texels = match &rows {
            HeightsMut::U8(rows) => rows.len(),
            HeightsMut::U16(rows) => rows.len(),
            HeightsMut::F32(rows) => rows.len(),
        };
        let first = self.next_row;
        self.next_row += texels / self.size().width();
        assert!(texels % self.size().width() == 0 && texels > 0, "whole rows");
        assert!(self.next_row <= self.size().height(), "never more rows than are left");
        if self.broken_row.is_some_and(|broken| (first..self.next_row).contains(&broken)) {
            return Err(broken("heights"));
        }
        self.copy(first, rows);
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

/// What a sink has taken.
#[derive(Default)]
struct Taken {
    bytes: Vec<u8>,
    written: usize,
    /// The first row of every call.
    firsts: Vec<usize>,
    finished: bool,
}

struct MemorySink {
    taken: Arc<Mutex<Taken>>,
    /// Bytes from which on the sink is full.
    capacity: usize,
    row_bytes: usize,
    first_row_last: bool,
}

impl RowSink for MemorySink {
    fn held_bytes(&self, _: usize) -> u64 {
        0
    }

    fn takes_first_row_last(&self) -> bool {
        self.first_row_last
    }

    fn write(&mut self, first: usize, rows: CodesRef<'_>) -> Result<()> {
        let mut taken = self.taken.lock().expect("no panic");
        assert!(!rows.bytes().is_empty() && !taken.finished, "rows before the end");
        if taken.written + rows.bytes().len() > self.capacity {
            return Err(broken("normals"));
        }
        let place = first * self.row_bytes..first * self.row_bytes + rows.bytes().len();
        if taken.bytes.len() < place.end {
            taken.bytes.resize(place.end, 0xa5);
        }
        taken.bytes[place].copy_from_slice(rows.bytes());
        taken.written += rows.bytes().len();
        taken.firsts.push(first);
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<()> {
        self.taken.lock().expect("no panic").finished = true;
        Ok(())
    }
}

/// A bake from rows to rows, and how it can go wrong.
struct Stream<'a> {
    map: &'a HeightMap,
    options: NormalOptions,
    broken_row: Option<usize>,
    capacity: usize,
    first_row_last: bool,
    monitor: Monitor,
}

impl<'a> Stream<'a> {
    fn new(map: &'a HeightMap, options: NormalOptions) -> Self {
        Self {
            map,
            options,
            broken_row: None,
            capacity: usize::MAX,
            first_row_last: false,
            monitor: Monitor::default(),
        }
    }

    fn bake(&self, baker: &Baker) -> (Result<texbake::Baked>, Taken) {
        let taken = Arc::new(Mutex::new(Taken::default()));
        let open = || {
            let source = MemorySource { broken_row: self.broken_row, ..MemorySource::new(self.map.clone()) };
            Ok(Box::new(source) as Box<dyn RowSource>)
        };
        let create = |size: Size| {
            assert_eq!(size, self.map.size());
            *taken.lock().expect("no panic") = Taken::default();
            let format = self.options.format;
            let row_bytes = size.width() * format.channels.count() * format.depth.bytes();
            let Self { capacity, first_row_last, .. } = *self;
            let sink = MemorySink { taken: taken.clone(), capacity, row_bytes, first_row_last };
            Ok((Box::new(sink) as Box<dyn RowSink>).into())
        };
        let ran = baker.normal_rows(&open, &create, &self.options, &self.monitor);
        let taken = std::mem::take(&mut *taken.lock().expect("no panic"));
        (ran, taken)
    }
}

#[test]
fn rows_give_the_bytes_of_maps() {
    let mut random = Random::new(41);
    for height in [1, 2, 3, 5, 8, 33, 257] {
        let maps = [
            map_u8(19, height, |_, _| random.bits() as u8),
            map_u16(21, height, |_, _| random.bits() as u16),
            map_f32(17, height, |_, _| random.below(999) as f32),
        ];
        let two_channels = NormalFormat { channels: Channels::Xy, ..SNORM16 };
        for (map, format) in maps.iter().zip([UNORM8, two_channels, FLOAT16].into_iter().cycle()) {
            for edge in EDGES {
                let options = NormalOptions { edges: Edges { x: Edge::Wrap, y: edge }, ..options("24", format) };
                let ways = every_baker().iter().flat_map(|subject| [false, true].map(|way| (subject, way)));
                for (Subject { name, baker }, first_row_last) in ways {
                    let stream = Stream { first_row_last, ..Stream::new(map, options) };
                    let (ran, taken) = stream.bake(baker);
                    let texbake::Baked { ran, size, height_type, scale } =
                        ran.unwrap_or_else(|error| panic!("{name}: {error}"));
                    let whole = baker.normal(map, &options).expect("a bake");
                    assert!(
                        taken.bytes == whole.codes().bytes(),
                        "{name}, {height} rows, {}, {edge}",
                        map.height_type()
                    );
                    assert!(taken.finished, "{name}");
                    let late = first_row_last && edge == Edge::Wrap && height > 1;
                    assert_eq!(taken.firsts[0], usize::from(late), "{name}: {:?}", taken.firsts);
                    assert_eq!(stream.monitor.texels(), map.size().texels() as u64, "{name}");
                    assert_eq!((size, height_type, ran.fallback), (map.size(), map.height_type(), None), "{name}");
                    assert_eq!((scale.x, scale.y, scale.q, scale.exact), (24, 24, 1, true), "{name}");
                }
            }
        }
    }
}

/// Above 64 MiB a map that wraps is not held: its last row is read first, then the rows from the top.
#[test]
fn a_map_too_large_to_hold_gives_the_same_bytes() {
    let height = (64 << 20) / (4 * 4099) + 2;
    let map = map_f32(4099, height, |x, y| ((x * 31 + y * 17) % 101) as f32);
    let format = NormalFormat { channels: Channels::Xy, ..BIASED8 };
    let options = options("0.35", format);
    let mut expected: Option<Vec<u8>> = None;
    for Subject { name, baker } in every_baker() {
        // Every other adapter takes the same way through the same backend, and this one would take minutes.
        if name.contains("swiftshader") {
            continue;
        }
        let (ran, taken) = Stream::new(&map, options).bake(baker);
        ran.unwrap_or_else(|error| panic!("{name}: {error}"));
        let expected =
            expected.get_or_insert_with(|| baker.normal(&map, &options).expect("a bake").codes().bytes().to_vec());
        assert!(taken.finished && taken.bytes == *expected, "{name}");
    }
}

#[test]
fn a_torn_source_is_the_error_and_nothing_is_finished() {
    let map = map_u8(16, 500, |x, y| (x * y) as u8);
    for Subject { name, baker } in every_baker() {
        for (edge, broken_row) in EDGES.into_iter().flat_map(|edge| [0, 1, 250, 499].map(|row| (edge, row))) {
            let options = NormalOptions { edges: Edges::both(edge), ..options("1", UNORM8) };
            let first_row_last = broken_row % 2 == 1;
            let stream = Stream { broken_row: Some(broken_row), first_row_last, ..Stream::new(&map, options) };
            let (ran, taken) = stream.bake(baker);
            let error = ran.expect_err("a row cannot be read").to_string();
            assert_eq!(error, "heights: it tore", "{name}, {edge}, row {broken_row}");
            assert!(!taken.finished, "{name}, {edge}, row {broken_row}");
        }
    }
}

#[test]
fn a_full_sink_is_the_error_and_nothing_is_finished() {
    let map = map_u16(16, 500, |x, y| (x * y) as u16);
    for Subject { name, baker } in every_baker() {
        for capacity in [0, 48 * 499] {
            let stream = Stream { capacity, ..Stream::new(&map, options("1", UNORM8)) };
            let (ran, taken) = stream.bake(baker);
            assert_eq!(ran.expect_err("the sink is full").to_string(), "normals: it tore", "{name}, {capacity} bytes");
            assert!(!taken.finished, "{name}, {capacity} bytes");
        }
    }
}

#[test]
fn a_cancelled_bake_ends_and_nothing_is_finished() {
    let map = map_f32(16, 500, |x, y| (x * y) as f32);
    for Subject { name, baker } in every_baker() {
        let stream = Stream::new(&map, options("1", FLOAT32));
        stream.monitor.cancel();
        let (ran, taken) = stream.bake(baker);
        assert!(matches!(ran, Err(Error::Cancelled)), "{name}: {ran:?}");
        assert!(!taken.finished, "{name}");
    }
}

/// A source of floats of which one is NaN, and which does not say so.
pub struct Careless {
    pub source: MemorySource,
    pub hole: [usize; 2],
}

impl Careless {
    fn punch(&self, first_row: usize, rows: HeightsMut<'_>) {
        let (HeightsMut::F32(heights), [x, y]) = (rows, self.hole) else { panic!("floats") };
        let width = self.size().width();
        if (first_row..first_row + heights.len() / width).contains(&y) {
            heights[(y - first_row) * width + x] = f32::NAN;
        }
    }
}

impl RowSource for Careless {
    fn size(&self) -> Size {
        self.source.size()
    }

    fn height_type(&self) -> HeightType {
        self.source.height_type()
    }

    fn read(&mut self, rows: HeightsMut<'_>) -> Result<()> {
        let first_row = self.source.next_row;
        let HeightsMut::F32(heights) = rows else { panic!("floats") };
        self.source.read(HeightsMut::F32(heights))?;
        self.punch(first_row, HeightsMut::F32(heights));
        Ok(())
    }

    fn rewind(&mut self) -> Result<()> {
        self.source.rewind()
    }

    fn held_bytes(&self) -> u64 {
        0
    }
}

#[test]
fn a_height_that_is_not_finite_reaches_no_backend() {
    // Held in memory, read twice, read once: the three ways of a map that wraps, and the only one of others.
    let tall = (64 << 20) / (4 * 4099) + 2;
    let ways = [
        (Edge::Wrap, false, [16, 500]),
        (Edge::Wrap, false, [4099, tall]),
        (Edge::Wrap, true, [16, 500]),
        (Edge::Clamp, false, [16, 500]),
    ];
    for (edge, first_row_last, [width, height]) in ways {
        let map = map_f32(width, height, |x, y| (x + y) as f32);
        for row in [0, 1, height / 2, height - 1] {
            let open = || {
                let source = MemorySource::new(map.clone());
                Ok(Box::new(Careless { source, hole: [3, row] }) as Box<dyn RowSource>)
            };
            let taken = Arc::new(Mutex::new(Taken::default()));
            let create = |_: Size| {
                let sink =
                    MemorySink { taken: taken.clone(), capacity: usize::MAX, row_bytes: 3 * width, first_row_last };
                Ok((Box::new(sink) as Box<dyn RowSink>).into())
            };
            let options = NormalOptions { edges: Edges::both(edge), ..options("1", UNORM8) };
            let ran = Baker::cpu().normal_rows(&open, &create, &options, &Monitor::default());
            let found = matches!(ran, Err(Error::NotFinite { x: 3, y, .. }) if y == row);
            assert!(found, "{edge}, {width} x {height}, row {row}: {ran:?}");
            assert!(!taken.lock().expect("no panic").finished, "{edge}, row {row}");
        }
    }
}

/// A source whose monitor is told to stop when row `row` is read.
struct Stopping {
    source: MemorySource,
    monitor: Arc<Monitor>,
    row: usize,
    rows_read: Arc<AtomicUsize>,
}

impl RowSource for Stopping {
    fn size(&self) -> Size {
        self.source.size()
    }

    fn height_type(&self) -> HeightType {
        self.source.height_type()
    }

    fn read(&mut self, rows: HeightsMut<'_>) -> Result<()> {
        self.source.read(rows)?;
        self.rows_read.store(self.source.next_row, Relaxed);
        if self.source.next_row > self.row {
            self.monitor.cancel();
        }
        Ok(())
    }

    fn rewind(&mut self) -> Result<()> {
        self.source.rewind()
    }

    fn held_bytes(&self) -> u64 {
        0
    }
}

/// A map that wraps into a sink that takes rows from the top is read whole before it is baked.
#[test]
fn a_map_that_is_held_is_read_no_further_after_a_stop() {
    let map = map_u16(2048, 2048, |x, y| (x ^ y) as u16);
    let monitor = Arc::new(Monitor::default());
    let rows_read = Arc::new(AtomicUsize::new(0));
    let open = || {
        let source = MemorySource::new(map.clone());
        let (monitor, rows_read) = (monitor.clone(), rows_read.clone());
        Ok(Box::new(Stopping { source, monitor, row: 700, rows_read }) as Box<dyn RowSource>)
    };
    let taken = Arc::new(Mutex::new(Taken::default()));
    let create = |_: Size| {
        let sink =
            MemorySink { taken: taken.clone(), capacity: usize::MAX, row_bytes: 3 * 2048, first_row_last: false };
        Ok((Box::new(sink) as Box<dyn RowSink>).into())
    };
    let ran = Baker::cpu().normal_rows(&open, &create, &options("1", UNORM8), &monitor);
    assert!(matches!(ran, Err(Error::Cancelled)), "{ran:?}");
    // Pieces of 1 MiB are 256 rows.
    assert_eq!(rows_read.load(Relaxed), 768);
    assert_eq!(taken.lock().expect("no panic").written, 0);
}

#[test]
fn refused_options_open_no_sink() {
    let map = map_u8(4, 4, |_, _| 0);
    for Subject { name, baker } in every_baker() {
        let create = |_: Size| -> Result<MapOut> { panic!("{name}: a sink for a bake that cannot be") };
        let open = || Ok(Box::new(MemorySource::new(map.clone())) as Box<dyn RowSource>);
        let ran = baker.normal_rows(&open, &create, &options("1e9", UNORM8), &Monitor::default());
        assert!(matches!(ran, Err(Error::Parameter { parameter: "scale", .. })), "{name}: {ran:?}");
    }
}
