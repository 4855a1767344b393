//! Sources and sinks that behave in any way.

use arbitrary::Arbitrary;
use std::sync::{Arc, Mutex};
use texbake::stream::{Monitor, RowSink, RowSource};
use texbake::{
    Baker, CodesRef, Edge, Edges, Error, Filter, Grid, HeightMap, HeightType, Heights, HeightsMut, NormalOptions,
    Rational, Result, Scale, Size,
};

/// A map, how it is baked, and what its source and its sink do.
#[derive(Debug, Arbitrary)]
pub struct Behaviour {
    width: u8,
    height: u8,
    heights: Vec<u8>,
    kind: u8,
    edges: (u8, u8),
    filter: u8,
    scale: (i32, u16),
    /// Whether the last row is said to be near.
    is_near: bool,
    /// Whether the sink takes row 0 last.
    takes_first_row_last: bool,
    /// The row at which the source fails, if it has so many.
    source_fails: Option<u8>,
    /// The row at which the sink fails.
    sink_fails: Option<u8>,
    /// Whether the sink fails at its end.
    end_fails: bool,
    /// The row at which the source holds NaN, whatever it promised.
    nan: Option<u8>,
    threads: u8,
}

struct Source {
    map: HeightMap,
    next_row: usize,
    is_near: bool,
    fails: Option<usize>,
    nan: Option<usize>,
}

#[derive(Default)]
struct Taken {
    bytes: Vec<u8>,
    is_finished: bool,
}

struct Sink {
    taken: Arc<Mutex<Taken>>,
    row_bytes: usize,
    takes_first_row_last: bool,
    fails: Option<usize>,
    end_fails: bool,
}

fn torn(what: &str) -> Error {
    Error::Io { path: what.into(), source: std::io::Error::other("it tore") }
}

impl Source {
    fn fill(&self, first: usize, rows: HeightsMut<'_>) -> Result<()> {
        let width = self.map.size().width();
        let from = first * width;
        let count = match (self.map.heights(), rows) {
            (Heights::U8(all), HeightsMut::U8(rows)) => {
                rows.copy_from_slice(&all[from..][..rows.len()]);
                rows.len()
            }
            (Heights::U16(all), HeightsMut::U16(rows)) => {
                rows.copy_from_slice(&all[from..][..rows.len()]);
                rows.len()
            }
            (Heights::F32(all), HeightsMut::F32(rows)) => {
                rows.copy_from_slice(&all[from..][..rows.len()]);
                if let Some(at) = self.nan.and_then(|row| row.checked_sub(first)).filter(|at| at * width < rows.len()) {
                    rows[at * width] = f32::NAN;
                }
                rows.len()
            }
            _ => panic!("rows of another type are asked for"),
        };
        assert!(count > 0 && count % width == 0, "whole rows");
        match self.fails {
            Some(row) if (first..first + count / width).contains(&row) => Err(torn("source")),
            _ => Ok(()),
        }
    }
}

impl RowSource for Source {
    fn size(&self) -> Size {
        self.map.size()
    }

    fn height_type(&self) -> HeightType {
        self.map.height_type()
    }

    fn read(&mut self, rows: HeightsMut<'_>) -> Result<()> {
        let count = match &rows {
            HeightsMut::U8(rows) => rows.len(),
            HeightsMut::U16(rows) => rows.len(),
            HeightsMut::F32(rows) => rows.len(),
        };
        let first = self.next_row;
        self.next_row += count / self.map.size().width();
        assert!(self.next_row <= self.map.size().height(), "no more rows than are left");
        self.fill(first, rows)
    }

    fn rewind(&mut self) -> Result<()> {
        self.next_row = 0;
        Ok(())
    }

    fn held_bytes(&self) -> u64 {
        0
    }

    fn last_row_is_near(&self) -> bool {
        self.is_near
    }
}

impl RowSink for Sink {
    fn held_bytes(&self, _: usize) -> u64 {
        0
    }

    fn takes_first_row_last(&self) -> bool {
        self.takes_first_row_last
    }

    fn write(&mut self, first: usize, rows: CodesRef<'_>) -> Result<()> {
        let count = rows.bytes().len() / self.row_bytes;
        if self.fails.is_some_and(|row| (first..first + count).contains(&row)) {
            return Err(torn("sink"));
        }
        let mut taken = self.taken.lock().expect("no panic");
        assert!(!taken.is_finished, "rows come before the end");
        let place = first * self.row_bytes;
        let end = place + rows.bytes().len();
        if taken.bytes.len() < end {
            taken.bytes.resize(end, 0xa5);
        }
        taken.bytes[place..end].copy_from_slice(rows.bytes());
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<()> {
        if self.end_fails {
            return Err(torn("end"));
        }
        self.taken.lock().expect("no panic").is_finished = true;
        Ok(())
    }
}

/// Rows to rows is the map's bytes; where something fails, that is the answer, and nothing is finished.
pub fn assert_streams(behaviour: Behaviour) {
    let size = Size::new(usize::from(behaviour.width % 40) + 1, usize::from(behaviour.height) + 1).expect("a size");
    let map = map(&behaviour, size);
    let edge = |choice: u8| [Edge::Wrap, Edge::Clamp, Edge::Mirror][usize::from(choice) % 3];
    let scale = Rational::new((behaviour.scale.0 % 100_000).into(), i64::from(behaviour.scale.1) + 1).expect("small");
    let options = NormalOptions {
        scale: Scale::Texels(scale),
        edges: Edges { x: edge(behaviour.edges.0), y: edge(behaviour.edges.1) },
        filter: [Filter::Central, Filter::Sobel, Filter::Scharr, Filter::Prewitt][usize::from(behaviour.filter) % 4],
        ..NormalOptions::default()
    };
    let row = |asked: Option<u8>| asked.map(usize::from).filter(|row| *row < size.height());
    let (source_fails, sink_fails) = (row(behaviour.source_fails), row(behaviour.sink_fails));
    let nan = row(behaviour.nan).filter(|_| map.height_type() == HeightType::F32);
    let taken = Arc::new(Mutex::new(Taken::default()));
    let open = || {
        let map = map.clone();
        let source = Source { map, next_row: 0, is_near: behaviour.is_near, fails: source_fails, nan };
        Ok(Box::new(source) as Box<dyn RowSource>)
    };
    let create = |created: Size| {
        assert_eq!(created, size);
        *taken.lock().expect("no panic") = Taken::default();
        let sink = Sink {
            taken: taken.clone(),
            row_bytes: 3 * size.width(),
            takes_first_row_last: behaviour.takes_first_row_last,
            fails: sink_fails,
            end_fails: behaviour.end_fails,
        };
        Ok(Box::new(sink) as Box<dyn RowSink>)
    };
    let baker = match behaviour.threads % 3 {
        0 => Baker::reference(),
        1 => Baker::cpu(),
        _ => Baker::cpu_threads(1).expect("a thread"),
    };
    let baked = baker.normal_rows(&open, &create, &options, &Monitor::default());
    let taken = taken.lock().expect("the threads have ended");
    let should_fail = source_fails.is_some() || sink_fails.is_some() || nan.is_some() || behaviour.end_fails;
    match baked {
        Ok(_) => {
            assert!(!should_fail && taken.is_finished, "a failure was not heard of");
            let whole = Baker::reference().normal(&map, &options).expect("a map");
            assert!(taken.bytes == whole.codes().bytes(), "rows to rows is map to map");
        }
        Err(error) => {
            assert!(should_fail && !taken.is_finished, "{error}");
            let is_known = match &error {
                Error::Io { path, .. } => ["source", "sink", "end"].iter().any(|what| path.as_os_str() == *what),
                Error::NotFinite { x, y, .. } => (Some(*y), *x) == (nan, 0),
                _ => false,
            };
            assert!(is_known, "{error}");
        }
    }
}

fn map(behaviour: &Behaviour, size: Size) -> HeightMap {
    let heights = &behaviour.heights;
    let byte = |i: usize| if heights.is_empty() { 0 } else { heights[i % heights.len()] };
    let (width, height) = (size.width(), size.height());
    let texel = |x: usize, y: usize| y * width + x;
    match behaviour.kind % 3 {
        0 => Grid::from_fn(width, height, |x, y| byte(texel(x, y))).expect("a size").into(),
        1 => {
            Grid::from_fn(width, height, |x, y| u16::from_le_bytes([byte(2 * texel(x, y)), byte(2 * texel(x, y) + 1)]))
                .expect("a size")
                .into()
        }
        _ => {
            let float = |x, y| {
                let bits = u32::from_le_bytes([0, 1, 2, 3].map(|i| byte(4 * texel(x, y) + i)));
                Some(f32::from_bits(bits)).filter(|height| height.is_finite()).unwrap_or(0.5)
            };
            Grid::from_fn(width, height, float).expect("a size").try_into().expect("finite heights")
        }
    }
}
