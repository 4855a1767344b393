//! What texbake itself encodes with, from its sources.

#[path = "../../../src/io/png/deflate/mod.rs"]
mod deflate;
#[path = "../../../src/io/png/filter.rs"]
mod filter;
#[allow(dead_code, reason = "texbake itself uses the rest")]
#[path = "../../../src/io/png/stripe.rs"]
mod stripe;

use crate::Image;
use crate::io::Compression;
use filter::Filter;
use rayon::prelude::*;
use stripe::Stripe;

/// Rows below `above`, filtered by Paeth: what every encoder gets.
pub fn filtered(rows: &[u8], above: Option<&[u8]>, row: usize, bpp: usize) -> Vec<u8> {
    let zeros = vec![0; row];
    let mut out = Vec::with_capacity(rows.len() / row * (row + 1));
    let aboves = std::iter::once(above.unwrap_or(&zeros)).chain(rows.chunks_exact(row));
    rows.chunks_exact(row).zip(aboves).for_each(|(line, above)| Filter::Paeth.apply(line, above, bpp, &mut out));
    out
}

/// Bytes of the stripes of an image, which the threads of `pool` filter and deflate.
pub fn encode(image: &Image, compression: Compression, pool: &rayon::ThreadPool) -> usize {
    let row = image.row();
    let rows = compression.stripe_rows(row);
    let stripes: Vec<&[u8]> = image.samples.chunks(rows * row).collect();
    let size = |number: usize| {
        let above = number.checked_sub(1).map(|before| &stripes[before][stripes[before].len() - row..]);
        let mut stripe = Stripe::default();
        stripe.begin(rows, row, image.bpp, above);
        stripes[number].chunks_exact(row).for_each(|samples| stripe.next_row().copy_from_slice(samples));
        let stripe = stripe.encoded(compression);
        // The checksum of the chunk that would hold the stripe.
        std::hint::black_box(crc32fast::hash(stripe.deflated()));
        stripe.deflated().len()
    };
    pool.install(|| (0..stripes.len()).into_par_iter().map(size).sum())
}
