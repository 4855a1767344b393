//! Deflate for the stripes of an image: with Huffman codes made for each block and matches for runs of zeros only, or
//! with all matches.
//!
//! A filtered map has hardly anything else that repeats: searching for matches takes most of the time of other
//! encoders and wins nothing, but where it is nearly flat. No crate does just this (`benches/png` has the figures): the
//! codes of `fdeflate` are fixed, which costs size, and the Huffman-only strategy of zlib takes several times as long.
//! And the stripes of an image, which several threads deflate, must join: every call here ends on a byte's border with
//! a block that is not the last, where `fdeflate` and libdeflate end the whole stream.

mod bits;
mod codes;
mod header;
mod matches;
mod runs;

pub(super) use bits::BitWriter;

use bits::LONGEST_CODE;
use codes::{Code, codes};
use header::Header;
use runs::{Length, runs_of_zeros};

/// The most bytes of a stored block, and the bytes before them.
pub(super) const STORED_MOST: usize = 0xffff;
pub(super) const STORED_HEADER: usize = 5;

/// Bytes that share codes, about: fewer follow the map more closely, more spend less on codes and their making.
pub(super) const LONG_BLOCK: usize = STORED_MOST;
pub(super) const SHORT_BLOCK: usize = 16 << 10;

/// Literals, the end of a block, and the lengths of matches (RFC 1951, section 3.2.5).
const SYMBOLS: usize = 286;
const END: usize = 256;

/// What repeats, and what codes are made for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Coding {
    /// Runs of zeros; blocks of about so many bytes.
    Literals(usize),
    /// All that a level of zlib finds.
    Matches(u32),
}

/// Appends `data`, deflated into blocks of which none is the last, up to a byte's border.
pub(super) fn deflate(data: &[u8], coding: Coding, out: &mut BitWriter) {
    match coding {
        Coding::Matches(level) => matches::deflate(data, level, out),
        Coding::Literals(_) if data.is_empty() => write_stored(&[], out),
        Coding::Literals(block_bytes) => {
            // Of equal length, lest the last one be short and its codes dear.
            let blocks = data.len().div_ceil(block_bytes);
            data.chunks(data.len().div_ceil(blocks)).for_each(|block| write_block(block, out));
            // An empty stored block ends on a byte's border.
            write_stored(&[], out);
        }
    }
}

fn write_block(block: &[u8], out: &mut BitWriter) {
    let mut counts = count_bytes(block);
    // Long runs are worth a search only where zeros are common.
    let runs = if counts[0] as usize > block.len() / 4 { runs_of_zeros(block) } else { Vec::new() };
    for run in &runs {
        counts[0] -= run.matched() as u32;
        run.lengths().for_each(|length| counts[length.symbol] += 1);
    }
    counts[END] = 1;
    let codes = codes(&counts, LONGEST_CODE);
    let header = Header::new(&codes);
    let extra: usize = runs.iter().flat_map(|run| run.lengths()).map(|length| length.extra_bits as usize + 1).sum();
    let coded: usize = counts.iter().zip(&codes).map(|(count, code)| *count as usize * code.length() as usize).sum();
    let bytes = (header.bits() + coded + extra).div_ceil(8);
    if bytes > block.len() + STORED_HEADER * block.len().div_ceil(STORED_MOST) {
        return block.chunks(STORED_MOST).for_each(|piece| write_stored(piece, out));
    }
    out.reserve(bytes + STORED_HEADER);
    header.write(out);
    let literals: &[Code; 256] = codes.first_chunk().expect("286 codes");
    let mut at = 0;
    for run in &runs {
        out.literals(&block[at..run.start], literals);
        run.lengths().for_each(|length| write_match(length, &codes, out));
        at = run.start + run.matched();
    }
    out.literals(&block[at..], literals);
    out.code(codes[END]);
}

/// How often each byte occurs.
fn count_bytes(block: &[u8]) -> [u32; SYMBOLS] {
    // A count that follows on the same one waits for it, so equal neighbours count in several places.
    let mut places = [[0u32; 256]; 4];
    let mut fours = block.chunks_exact(4);
    for four in &mut fours {
        places.iter_mut().zip(four).for_each(|(counts, byte)| counts[usize::from(*byte)] += 1);
    }
    fours.remainder().iter().for_each(|byte| places[0][usize::from(*byte)] += 1);
    std::array::from_fn(|symbol| if symbol < END { places.iter().map(|counts| counts[symbol]).sum() } else { 0 })
}

/// A match of the byte before.
fn write_match(length: Length, codes: &[Code; SYMBOLS], out: &mut BitWriter) {
    out.code(codes[length.symbol]);
    // The only distance is 1, its code a single 0.
    out.bits(length.extra.into(), length.extra_bits + 1);
}

/// A stored block (RFC 1951, section 3.2.4).
fn write_stored(bytes: &[u8], out: &mut BitWriter) {
    out.bits(0, 3);
    out.align();
    out.whole(&stored_header(bytes.len())[1..]);
    out.whole(bytes);
}

/// What stands before the bytes of a stored block that begins on a byte's border and is not the last.
pub(super) fn stored_header(length: usize) -> [u8; STORED_HEADER] {
    let [low, high] = (length as u16).to_le_bytes();
    [0, low, high, !low, !high]
}

#[cfg(test)]
mod tests;
