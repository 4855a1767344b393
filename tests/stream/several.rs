//! Bakes from rows to the rows of several maps.

use super::rows::{Careless, MemorySource};
use crate::support::{UNORM8, map_f32, map_u8};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, Mutex};
use texbake::stream::{HeightRows, Monitor, NormalRows, NormalSource, RowSink, RowsOut};
use texbake::{
    BakeOptions, Baker, BlendInputs, BlendMethod, BlendOptions, CodesMut, CodesRef, Edge, Edges, Error, HeightMap,
    Maps, NormalFormat, ParallaxFormat, Precision, Result, Size,
};

/// A file of many: it tells whether it got its name.
struct Sink {
    bytes: Arc<Mutex<Vec<u8>>>,
    named: Arc<AtomicUsize>,
    row_codes: usize,
    /// What it cannot do, if anything: write this row and those after it, or what follows the last.
    cannot_write: Option<usize>,
    cannot_complete: bool,
}

fn full() -> Error {
    Error::Io { path: "codes".into(), source: std::io::Error::other("it is full") }
}

impl RowSink for Sink {
    fn held_bytes(&self, _: usize) -> u64 {
        0
    }

    fn write(&mut self, first: usize, rows: CodesRef<'_>) -> Result<()> {
        let rows_end = first + rows.len() / (self.row_codes);
        if self.cannot_write.is_some_and(|row| row < rows_end) {
            return Err(full());
        }
        self.bytes.lock().expect("no panic").extend_from_slice(rows.bytes());
        Ok(())
    }

    fn complete(&mut self) -> Result<()> {
        assert_eq!(self.named.load(Relaxed), 0, "all are complete before one has its name");
        if self.cannot_complete { Err(full()) } else { Ok(()) }
    }

    fn finish(self: Box<Self>) -> Result<()> {
        self.named.fetch_add(1, Relaxed);
        Ok(())
    }
}

/// Bakes both maps of a height map of 64 rows; `spoil` is told which sink it may spoil.
fn bake(spoil: impl Fn(&mut Sink, &str)) -> (Result<()>, usize, [Vec<u8>; 2]) {
    let map = heights();
    let named = Arc::new(AtomicUsize::new(0));
    let bytes = [(); 2].map(|()| Arc::new(Mutex::new(Vec::new())));
    let open = || Ok(Box::new(MemorySource::new(map.clone())) as HeightRows);
    let create = |size: Size| {
        let sink = |name, row_codes, bytes: &Arc<Mutex<Vec<u8>>>| {
            let (bytes, named) = (bytes.clone(), named.clone());
            let mut sink = Sink { bytes, named, row_codes, cannot_write: None, cannot_complete: false };
            spoil(&mut sink, name);
            Some((Box::new(sink) as RowsOut).into())
        };
        Ok(Maps {
            normal: sink("normal", 3 * size.width(), &bytes[0]),
            parallax: sink("parallax", size.width(), &bytes[1]),
            roughness: None,
        })
    };
    let result = Baker::cpu().bake_rows(&open, &create, &both(), &Monitor::default()).map(drop);
    (result, named.load(Relaxed), bytes.map(|bytes| std::mem::take(&mut *bytes.lock().expect("no panic"))))
}

fn heights() -> HeightMap {
    map_u8(40_000, 64, |x, y| (3 * x + 7 * y) as u8)
}

fn both() -> BakeOptions {
    let clamp = Edges::both(Edge::Clamp);
    let (normal, parallax) = (Some(UNORM8), Some(ParallaxFormat::default()));
    BakeOptions { edges: clamp, normal, parallax, ..Default::default() }
}

#[test]
fn rows_of_two_maps_are_the_bytes_of_both() {
    let (result, named, [normal, parallax]) = bake(|_, _| ());
    result.expect("a bake");
    assert_eq!(named, 2);
    let maps = Baker::reference().bake(&heights(), &both()).expect("a bake");
    assert!(maps.normal.expect("asked for").codes().bytes() == normal);
    assert!(maps.parallax.expect("asked for").codes().bytes() == parallax);
}

#[test]
fn neither_map_gets_its_name_unless_both_are_complete() {
    for spoilt in ["normal", "parallax"] {
        let (result, named, _) = bake(|sink, name| sink.cannot_complete = name == spoilt);
        assert_eq!((result.expect_err("it is full").to_string(), named), ("codes: it is full".into(), 0), "{spoilt}");
        // The first row, a row in the middle, the last one.
        for row in [0, 30, 63] {
            let (result, named, _) = bake(|sink, name| sink.cannot_write = (name == spoilt).then_some(row));
            assert_eq!(
                (result.expect_err("it is full").to_string(), named),
                ("codes: it is full".into(), 0),
                "{spoilt}"
            );
        }
    }
}

#[test]
fn sinks_must_be_those_of_the_maps() {
    let map = heights();
    let open = || Ok(Box::new(MemorySource::new(map.clone())) as HeightRows);
    let create = |_: Size| Ok(Maps::default());
    let error = Baker::cpu().bake_rows(&open, &create, &both(), &Monitor::default()).expect_err("no sinks");
    assert_eq!(error.to_string(), "maps is others: it must be those that the options ask for");
}

/// A normal map in memory, read row by row.
struct Flat(Size);

impl NormalSource for Flat {
    fn size(&self) -> Size {
        self.0
    }

    fn format(&self) -> NormalFormat {
        UNORM8
    }

    fn read(&mut self, rows: CodesMut<'_>) -> Result<()> {
        let CodesMut::U8(rows) = rows else { panic!("8 bits") };
        rows.chunks_exact_mut(3).for_each(|texel| texel.copy_from_slice(&[128, 128, 255]));
        Ok(())
    }

    fn held_bytes(&self) -> u64 {
        0
    }
}

#[test]
fn a_mask_or_height_that_is_not_finite_reaches_no_backend() {
    let size = Size::new(70, 500).expect("a size");
    for row in [0, 250, 499] {
        let floats = || {
            let source = MemorySource::new(map_f32(70, 500, |_, _| 0.5));
            Box::new(Careless { source, hole: [3, row] }) as HeightRows
        };
        let flat = || Box::new(Flat(size)) as NormalRows;
        let create = |_: Size| {
            let (bytes, named) = (Arc::default(), Arc::default());
            Ok(Box::new(Sink { bytes, named, row_codes: 1, cannot_write: None, cannot_complete: true }) as RowsOut)
        };
        let inputs = || Ok(BlendInputs { base: flat(), detail: flat(), mask: Some(floats()) });
        let options = BlendOptions { method: BlendMethod::Masked, ..Default::default() };
        let blended = Baker::cpu().blend_rows(&inputs, &create, &options, &Monitor::default()).map(drop);
        let maps = || Ok((floats(), flat()));
        let (format, exact, monitor) = (ParallaxFormat::default(), Precision::Exact, Monitor::default());
        let baked = Baker::cpu().parallax_with_normals_rows(&maps, &create, format, exact, &monitor).map(drop);
        for ran in [blended, baked] {
            assert!(matches!(ran, Err(Error::NotFinite { x: 3, y, .. }) if y == row), "row {row}: {ran:?}");
        }
    }
}
