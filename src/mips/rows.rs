//! Rows of heights to rows of samples, and rows of sums to rows of codes, on all threads.

use super::pyramid::Rows;
use super::sample::Sample;
use crate::map::{Codes, CodesMut, TexelFormat};
use crate::stream::Band;
use rayon::prelude::*;

/// The samples of a strip, `planes` for each texel: `fill` has room for those of one row.
pub(super) fn samples_of<T: Copy, V: Sample>(
    strip: &Band<'_, T>,
    planes: usize,
    fill: impl Fn(usize, &mut [V]) + Sync,
) -> Vec<V> {
    let row_samples = planes * strip.width;
    let mut samples = vec![V::default(); strip.rows() * row_samples];
    samples.par_chunks_mut(row_samples).enumerate().for_each(|(row, samples)| fill(row, samples));
    samples
}

/// The codes of complete rows, for maps of these formats: `fill` has the planes of one row, and room for its codes.
pub(super) fn codes_of<S: Sample>(
    rows: &Rows<S>,
    planes: usize,
    formats: &[TexelFormat],
    fill: impl Fn(&[&[S]], Vec<CodesMut<'_>>) + Sync,
) -> Vec<Codes> {
    let row_codes = |format: &TexelFormat| format.row_codes(rows.width);
    let zeroed = |format: &TexelFormat| Codes::zeroed(format.depth, rows.rows.len() * row_codes(format));
    let mut maps: Vec<Codes> = formats.iter().map(zeroed).collect();
    let mut by_row: Vec<Vec<CodesMut<'_>>> = rows.rows.clone().map(|_| Vec::new()).collect();
    for (codes, format) in maps.iter_mut().zip(formats) {
        let codes = codes.as_mut().into_chunks(row_codes(format));
        by_row.iter_mut().zip(codes).for_each(|(maps, codes)| maps.push(codes));
    }
    by_row.into_par_iter().zip(rows.sums.par_chunks(planes * rows.width)).for_each(|(maps, sums)| {
        let planes: Vec<&[S]> = sums.chunks(rows.width).collect();
        fill(&planes, maps);
    });
    maps
}
