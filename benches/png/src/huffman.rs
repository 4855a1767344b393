//! A prototype of the plainest deflate that adapts: Huffman codes per block, runs of zeros, no other matches.
//!
//! Every block has codes of its own, made from its own bytes; a block that would grow is stored (RFC 1951, 3.2.4).
//! Every call ends on a byte boundary with a block that is not the last, so stripes concatenate.

/// Bits of the longest code: four codes and seven bits left over fit 64.
const LONGEST: u32 = 12;
/// Bytes that share codes.
const BLOCK: usize = 128 << 10;

struct Bits {
    out: Vec<u8>,
    word: u64,
    held: u32,
}

impl Bits {
    fn put(&mut self, value: u64, count: u32) {
        self.word |= value << self.held;
        self.held += count;
        self.spill();
    }

    #[inline(always)]
    fn spill(&mut self) {
        let bytes = self.held / 8;
        self.out.extend_from_slice(&self.word.to_le_bytes());
        self.out.truncate(self.out.len() - 8 + bytes as usize);
        self.word = self.word.checked_shr(bytes * 8).unwrap_or(0);
        self.held &= 7;
    }

    fn align(&mut self) {
        if self.held > 0 {
            self.out.push(self.word as u8);
            (self.word, self.held) = (0, 0);
        }
    }
}

/// Deflates `data` into blocks of which none is the last, byte-aligned.
pub fn deflate(data: &[u8], zero_runs: bool) -> Vec<u8> {
    let mut bits = Bits { out: Vec::with_capacity(data.len() + data.len() / 16 + 64), word: 0, held: 0 };
    for block in data.chunks(BLOCK) {
        write_block(&mut bits, block, zero_runs);
    }
    stored(&mut bits, &[]);
    bits.out
}

fn stored(bits: &mut Bits, data: &[u8]) {
    let pieces: Vec<&[u8]> = if data.is_empty() { vec![data] } else { data.chunks(65535).collect() };
    for piece in pieces {
        bits.put(0, 3);
        bits.align();
        let length = piece.len() as u16;
        bits.out.extend_from_slice(&length.to_le_bytes());
        bits.out.extend_from_slice(&(!length).to_le_bytes());
        bits.out.extend_from_slice(piece);
    }
}

/// Zeros that the longest match covers (symbol 285).
const RUN: usize = 258;

fn write_block(bits: &mut Bits, block: &[u8], zero_runs: bool) {
    let mut counts = [0u32; 286];
    let zeros = histogram(block, &mut counts);
    // Long runs are worth a search only if there are many zeros at all.
    let runs = zero_runs && zeros > block.len() / 4;
    if runs {
        let mut long = 0;
        for_each_run(block, |_, matches| long += matches);
        counts[0] -= (long * RUN) as u32;
        counts[285] = long as u32;
    }
    counts[256] = 1;
    let lengths = code_lengths(&counts, LONGEST);
    let size: u64 = counts.iter().zip(&lengths).map(|(&c, &l)| u64::from(c) * u64::from(l)).sum();
    if size / 8 + 200 > block.len() as u64 {
        return stored(bits, block);
    }
    let codes = canonical(&lengths);
    header(bits, &lengths);
    if runs {
        let mut from = 0;
        for_each_run(block, |at, matches| {
            literals(bits, &block[from..at], &codes);
            let (code, length) = codes[285];
            for _ in 0..matches {
                // The one distance code, of one bit: distance 1.
                bits.put(u64::from(code), length + 1);
            }
            from = at + matches * RUN;
        });
        literals(bits, &block[from..], &codes);
    } else {
        literals(bits, block, &codes);
    }
    let (code, length) = codes[256];
    bits.put(u64::from(code), length);
}

/// Calls `found(position, matches)` for runs of zeros that hold whole matches, after their first zero.
fn for_each_run(block: &[u8], mut found: impl FnMut(usize, usize)) {
    let mut at = 0;
    while at + RUN < block.len() {
        // A run this long holds an aligned group of 64 zeros.
        if block[at..at + 64].iter().any(|&b| b != 0) {
            at += 64;
            continue;
        }
        let start = at - block[..at].iter().rev().take_while(|&&b| b == 0).count().min(63);
        let length = block[start..].iter().take_while(|&&b| b == 0).count();
        let matches = (length - 1) / RUN;
        if matches > 0 {
            found(start + 1, matches);
        }
        at = (start + length).next_multiple_of(64).max(at + 64);
    }
}

fn histogram(block: &[u8], counts: &mut [u32; 286]) -> usize {
    let mut four = [[0u32; 256]; 4];
    for quad in block.chunks_exact(4) {
        for k in 0..4 {
            four[k][quad[k] as usize] += 1;
        }
    }
    for &b in block.chunks_exact(4).remainder() {
        four[0][b as usize] += 1;
    }
    for b in 0..256 {
        counts[b] = four.iter().map(|t| t[b]).sum();
    }
    counts[0] as usize
}

fn literals(bits: &mut Bits, block: &[u8], codes: &[(u16, u32)]) {
    let table: Vec<u32> = codes[..256].iter().map(|&(code, length)| u32::from(code) | length << 16).collect();
    let table: &[u32; 256] = table[..].try_into().expect("256 codes");
    let start = bits.out.len();
    bits.out.resize(start + block.len() * LONGEST as usize / 8 + 16, 0);
    let out = &mut bits.out[start..];
    let (mut word, mut held, mut at) = (bits.word, bits.held, 0);
    let mut quads = block.chunks_exact(4);
    for quad in &mut quads {
        let (a, b, c, d) =
            (table[quad[0] as usize], table[quad[1] as usize], table[quad[2] as usize], table[quad[3] as usize]);
        let (la, lc) = (a >> 16, c >> 16);
        let (ab, cd) = ((a & 0xFFFF) | (b & 0xFFFF) << la, (c & 0xFFFF) | (d & 0xFFFF) << lc);
        let (lab, lcd) = (la + (b >> 16), lc + (d >> 16));
        // At most 7 held and 48 new bits.
        word |= (u64::from(ab) | u64::from(cd) << lab) << held;
        held += lab + lcd;
        out[at..at + 8].copy_from_slice(&word.to_le_bytes());
        at += (held / 8) as usize;
        word >>= held & !7;
        held &= 7;
    }
    for &byte in quads.remainder() {
        let entry = table[byte as usize];
        word |= u64::from(entry & 0xFFFF) << held;
        held += entry >> 16;
        out[at..at + 8].copy_from_slice(&word.to_le_bytes());
        at += (held / 8) as usize;
        word >>= held & !7;
        held &= 7;
    }
    bits.out.truncate(start + at);
    (bits.word, bits.held) = (word, held);
}

/// Huffman's lengths, cut to `longest` and repaired to a full code.
fn code_lengths(counts: &[u32], longest: u32) -> Vec<u32> {
    use std::{cmp::Reverse, collections::BinaryHeap};
    let mut heap: BinaryHeap<_> =
        (0..counts.len()).filter(|&s| counts[s] > 0).map(|s| Reverse((u64::from(counts[s]), s))).collect();
    let mut parents = vec![usize::MAX; counts.len()];
    while let (Some(Reverse((a, x))), Some(Reverse((b, y)))) = (heap.pop(), heap.pop()) {
        let node = parents.len();
        parents.push(usize::MAX);
        (parents[x], parents[y]) = (node, node);
        heap.push(Reverse((a + b, node)));
        if heap.len() == 1 {
            break;
        }
    }
    let mut depths = vec![0; parents.len()];
    for node in (0..parents.len()).rev().filter(|&n| parents[n] != usize::MAX) {
        depths[node] = depths[parents[node]] + 1;
    }
    let mut lengths: Vec<u32> =
        (0..counts.len()).map(|s| if counts[s] > 0 { depths[s].clamp(1, longest) } else { 0 }).collect();
    let mut order: Vec<usize> = (0..counts.len()).filter(|&s| counts[s] > 0).collect();
    order.sort_by_key(|&s| counts[s]);
    // Kraft's sum in units of 2^-longest.
    let mut sum: u64 = order.iter().map(|&s| 1u64 << (longest - lengths[s])).sum();
    let full = 1u64 << longest;
    while sum > full {
        let s = *order.iter().filter(|&&s| lengths[s] < longest).max_by_key(|&&s| lengths[s]).expect("room");
        sum -= 1 << (longest - lengths[s] - 1);
        lengths[s] += 1;
    }
    for &s in order.iter().rev() {
        while lengths[s] > 1 && sum + (1 << (longest - lengths[s])) <= full {
            sum += 1 << (longest - lengths[s]);
            lengths[s] -= 1;
        }
    }
    lengths
}

/// Canonical codes, bit-reversed as deflate wants them, with their lengths.
fn canonical(lengths: &[u32]) -> Vec<(u16, u32)> {
    let mut next = [0u16; 16];
    for length in 1..16 {
        let shorter = lengths.iter().filter(|&&l| l == length as u32 - 1 && l > 0).count() as u16;
        next[length] = (next[length - 1] + shorter) << 1;
    }
    lengths
        .iter()
        .map(|&length| {
            if length == 0 {
                return (0, 0);
            }
            let code = next[length as usize];
            next[length as usize] += 1;
            (code.reverse_bits() >> (16 - length), length)
        })
        .collect()
}

/// A dynamic block's header; code lengths in four bits each, without run lengths.
fn header(bits: &mut Bits, lengths: &[u32]) {
    bits.put(0b100, 3);
    bits.put(286 - 257, 5);
    bits.put(0, 5);
    bits.put(19 - 4, 4);
    // Lengths 0 to 15 take four bits each, 16 to 18 are not used.
    for symbol in [16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15] {
        bits.put(if symbol < 16 { 4 } else { 0 }, 3);
    }
    for &length in lengths.iter().chain(&[1]) {
        bits.put(u64::from((length as u8).reverse_bits() >> 4), 4);
    }
}

#[cfg(test)]
mod tests {
    use super::deflate;

    fn inflated(stripes: &[Vec<u8>], length: usize) -> Vec<u8> {
        let mut stream = stripes.concat();
        stream.extend([1, 0, 0, 0xFF, 0xFF]);
        let mut out = vec![0; length];
        assert_eq!(libdeflater::Decompressor::new().deflate_decompress(&stream, &mut out), Ok(length));
        out
    }

    /// Runs of zeros of every length up to 700 at every phase, between bytes of few and of many values.
    #[test]
    fn what_goes_in_comes_out() {
        let mut data = Vec::new();
        for run in 0..700 {
            data.extend(std::iter::repeat_n(0, run));
            data.extend((0..run % 7 + 1).map(|k| (k * run % 5 + 1) as u8));
        }
        let mut state = 1u32;
        let noise: Vec<u8> = (0..300_000)
            .map(|_| {
                state = state.wrapping_mul(1664525).wrapping_add(1013904223);
                (state >> 24) as u8
            })
            .collect();
        // Byte counts that double from one value to the next want codes longer than deflate has.
        let skewed: Vec<u8> = (0..17u8).flat_map(|v| std::iter::repeat_n(v, 1 << v)).collect();
        let flat = vec![0; 1_000_000];
        for data in [&data, &noise, &skewed, &flat, &vec![7; 5], &vec![]] {
            assert!(
                inflated(&[deflate(data, true), deflate(data, false)], 2 * data.len()) == [&data[..], data].concat()
            );
        }
        assert!(deflate(&flat, true).len() < flat.len() / 400);
    }
}
