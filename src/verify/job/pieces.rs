//! Pieces of maps: cuts and simpler values.

use crate::map::{Codes, CodesRef, Grid, HeightMap, Heights, NormalMap, Size};
use crate::verify::shrink::{simpler_floats, simpler_integers};
use half::f16;
use std::fmt::Write;
use std::ops::Range;

/// A cut of a map.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Cut {
    pub columns: Range<usize>,
    pub rows: Range<usize>,
}

/// Cuts of a map around a texel, the smallest first: of one texel, with its neighbours, then halves.
pub(super) fn cuts(size: Size, texel: usize) -> Vec<Cut> {
    let (x, y) = (texel % size.width(), texel / size.width());
    let around = |i: usize, n: usize, reach: usize| i.saturating_sub(reach)..(i + reach + 1).min(n);
    let near = |reach| Cut { columns: around(x, size.width(), reach), rows: around(y, size.height(), reach) };
    let half = |i: usize, n: usize| if i < n / 2 { 0..n.div_ceil(2) } else { n / 2..n };
    let whole = Cut { columns: 0..size.width(), rows: 0..size.height() };
    let mut cuts = vec![near(0), near(1), near(2), near(4)];
    cuts.push(Cut { columns: half(x, size.width()), ..whole.clone() });
    cuts.push(Cut { rows: half(y, size.height()), ..whole.clone() });
    for columns in [0..size.width() - 1, 1..size.width()] {
        cuts.push(Cut { columns, ..whole.clone() });
    }
    for rows in [0..size.height() - 1, 1..size.height()] {
        cuts.push(Cut { rows, ..whole.clone() });
    }
    cuts.retain(|cut| *cut != whole && !cut.columns.is_empty() && !cut.rows.is_empty());
    cuts
}

pub(super) fn cut_heights(map: &HeightMap, cut: &Cut) -> HeightMap {
    let (columns, rows) = (cut.columns.len(), cut.rows.len());
    let width = map.size().width();
    let of = "a cut has a size and finite heights";
    match map.heights() {
        Heights::U8(heights) => Grid::new(columns, rows, cut_texels(heights, width, 1, cut)).expect(of).into(),
        Heights::U16(heights) => Grid::new(columns, rows, cut_texels(heights, width, 1, cut)).expect(of).into(),
        Heights::F32(heights) => {
            let grid = Grid::new(columns, rows, cut_texels(heights, width, 1, cut)).expect(of);
            HeightMap::try_from(grid).expect(of)
        }
    }
}

pub(super) fn cut_normals(map: &NormalMap, cut: &Cut) -> NormalMap {
    let (width, channels) = (map.size().width(), map.format().channels.count());
    let codes = match map.codes() {
        CodesRef::U8(codes) => Codes::U8(cut_texels(codes, width, channels, cut)),
        CodesRef::U16(codes) => Codes::U16(cut_texels(codes, width, channels, cut)),
        CodesRef::F16(codes) => Codes::F16(cut_texels(codes, width, channels, cut)),
        CodesRef::F32(codes) => Codes::F32(cut_texels(codes, width, channels, cut)),
    };
    let size = Size::new(cut.columns.len(), cut.rows.len()).expect("a cut has a size");
    NormalMap::new(size, map.format(), codes).expect("a cut has the map's format")
}

fn cut_texels<T: Copy>(texels: &[T], width: usize, channels: usize, cut: &Cut) -> Vec<T> {
    let row = |y: usize| &texels[channels * (y * width + cut.columns.start)..channels * (y * width + cut.columns.end)];
    cut.rows.clone().flat_map(row).copied().collect()
}

/// The map with one simpler height, for each height of a small map.
pub(super) fn simpler_heights(map: &HeightMap) -> Vec<HeightMap> {
    let (width, height) = (map.size().width(), map.size().height());
    if map.size().texels() > FEW {
        return Vec::new();
    }
    let of = "as many as before, and finite";
    match map.heights() {
        Heights::U8(heights) => replaced(heights, simpler_bytes)
            .map(|heights| Grid::new(width, height, heights).expect(of).into())
            .collect(),
        Heights::U16(heights) => replaced(heights, simpler_words)
            .map(|heights| Grid::new(width, height, heights).expect(of).into())
            .collect(),
        Heights::F32(heights) => replaced(heights, |value| simpler_floats(value).collect())
            .map(|heights| HeightMap::try_from(Grid::new(width, height, heights).expect(of)).expect(of))
            .collect(),
    }
}

/// The map with one simpler code, for each code of a small map.
pub(super) fn simpler_normals(map: &NormalMap) -> Vec<NormalMap> {
    if map.size().texels() > FEW {
        return Vec::new();
    }
    let codes: Vec<Codes> = match map.codes() {
        CodesRef::U8(codes) => replaced(codes, simpler_bytes).map(Codes::U8).collect(),
        CodesRef::U16(codes) => replaced(codes, simpler_words).map(Codes::U16).collect(),
        CodesRef::F16(codes) => replaced(codes, |value| {
            simpler_floats(value.to_f32()).map(f16::from_f32).filter(|simpler| *simpler != value).collect()
        })
        .map(Codes::F16)
        .collect(),
        CodesRef::F32(codes) => replaced(codes, |value| simpler_floats(value).collect()).map(Codes::F32).collect(),
    };
    codes.into_iter().map(|codes| NormalMap::new(map.size(), map.format(), codes).expect("as many as before")).collect()
}

/// Values of larger maps are not simplified: cuts come first.
const FEW: usize = 25;

fn simpler_bytes(value: u8) -> Vec<u8> {
    simpler_integers(value.into()).map(|simpler| simpler as u8).collect()
}

fn simpler_words(value: u16) -> Vec<u16> {
    simpler_integers(value.into()).map(|simpler| simpler as u16).collect()
}

/// Lists with one value replaced by a simpler one.
pub(super) fn replaced<T: Copy>(values: &[T], simpler: impl Fn(T) -> Vec<T>) -> impl Iterator<Item = Vec<T>> {
    values.iter().enumerate().flat_map(move |(index, &value)| {
        simpler(value).into_iter().map(move |simpler| {
            let mut list = values.to_vec();
            list[index] = simpler;
            list
        })
    })
}

/// Heights in rows, floats with their bits.
pub(super) fn print_heights(name: &str, map: &HeightMap) -> String {
    let values: Vec<String> = match map.heights() {
        Heights::U8(heights) => heights.iter().map(u8::to_string).collect(),
        Heights::U16(heights) => heights.iter().map(u16::to_string).collect(),
        Heights::F32(heights) => heights.iter().map(|&height| print_float(height)).collect(),
    };
    print_rows(&format!("{name}, {}, {}", map.size(), map.height_type()), &values, map.size().width())
}

/// Codes in rows, texel by texel.
pub(super) fn print_normals(name: &str, map: &NormalMap) -> String {
    let values: Vec<String> = match map.codes() {
        CodesRef::U8(codes) => codes.iter().map(u8::to_string).collect(),
        CodesRef::U16(codes) => codes.iter().map(u16::to_string).collect(),
        CodesRef::F16(codes) => codes.iter().map(|code| format!("{code} ({:#06x})", code.to_bits())).collect(),
        CodesRef::F32(codes) => codes.iter().map(|&code| print_float(code)).collect(),
    };
    let channels = map.format().channels.count();
    let texels: Vec<String> = values.chunks(channels).map(|texel| format!("({})", texel.join(", "))).collect();
    let name = format!("{name}, {} {} {}", map.size(), map.format().encoding, map.format().depth);
    print_rows(&name, &texels, map.size().width())
}

/// A float with its bits.
pub(super) fn print_float(value: f32) -> String {
    format!("{value:e} ({:#010x})", value.to_bits())
}

/// Longer lists are not of use to anybody.
const MOST_SHOWN: usize = 64;

fn print_rows(name: &str, values: &[String], width: usize) -> String {
    let mut text = format!("{name}:");
    if values.len() > MOST_SHOWN {
        return text + " too many texels to show";
    }
    for row in values.chunks(width) {
        let _ = write!(text, "\n  {}", row.join("  "));
    }
    text
}
