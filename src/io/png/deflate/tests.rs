//! What goes in comes out of an inflater that is not ours.

use super::*;
use std::io::Read;

/// The bytes of stripes that were deflated one by one and joined.
fn inflated(stripes: &[&[u8]], coding: Coding) -> Vec<u8> {
    let mut out = BitWriter::default();
    let mut stream = Vec::new();
    for stripe in stripes {
        out.clear();
        deflate(stripe, coding, &mut out);
        stream.extend_from_slice(out.bytes());
    }
    stream.extend([1, 0, 0, 0xff, 0xff]);
    let mut bytes = Vec::new();
    let mut inflater = flate2::bufread::DeflateDecoder::new(&stream[..]);
    inflater.read_to_end(&mut bytes).unwrap();
    assert_eq!(inflater.total_in(), stream.len() as u64, "all of the stream");
    bytes
}

fn deflated(bytes: &[u8]) -> Vec<u8> {
    let mut out = BitWriter::default();
    deflate(bytes, Coding::Literals(LONG_BLOCK), &mut out);
    out.bytes().to_vec()
}

fn noise(count: usize) -> Vec<u8> {
    let mut state = 1u32;
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    };
    (0..count).map(|_| next()).collect()
}

/// Runs of zeros of every length up to 700, between bytes of few and of many values.
fn runs() -> Vec<u8> {
    let run = |length: usize| {
        let others = (0..length % 7 + 1).map(move |k| (k * length % 5 + 1) as u8);
        std::iter::repeat_n(0, length).chain(others)
    };
    (0..700).flat_map(run).collect()
}

#[test]
fn what_goes_in_comes_out() {
    // Counts that double from value to value want codes that are longer than ours may be.
    let doubling: Vec<u8> = (0..17u8).flat_map(|value| std::iter::repeat_n(value, 1 << value)).collect();
    let flat = vec![0; 1_000_000];
    let all = [&runs()[..], &noise(300_000), &doubling, &flat, &[7; 5], &[0], &[]];
    for coding in [Coding::Literals(LONG_BLOCK), Coding::Literals(SHORT_BLOCK), Coding::Matches(6), Coding::Matches(9)]
    {
        for bytes in all {
            assert!(inflated(&[bytes], coding) == bytes, "{} bytes, {coding:?}", bytes.len());
        }
        assert!(inflated(&all, coding) == all.concat(), "joined, {coding:?}");
    }
}

#[test]
fn every_length_of_a_block_comes_out() {
    let bytes = [runs(), noise(1000)].concat();
    for length in (0..40).chain([LONG_BLOCK - 1, LONG_BLOCK, LONG_BLOCK + 1]) {
        assert!(inflated(&[&bytes[..length]], Coding::Literals(LONG_BLOCK)) == bytes[..length], "{length}");
    }
}

#[test]
fn zeros_vanish_and_noise_hardly_grows() {
    let flat = deflated(&vec![0; 1 << 20]).len();
    assert!(flat < (1 << 20) / 400, "{flat}");
    let noise = noise(1 << 20);
    let stored = deflated(&noise).len();
    assert!(stored <= noise.len() + noise.len() / 8000 + 5, "{stored}");
}

/// Where every probability is a power of 1/2 the size is the entropy: n leading zeros come with 2^-(n + 1), two bits
/// on average, and 45 bytes are the standard deviation of this many. A header has less than 40 bytes.
#[test]
fn codes_are_as_short_as_the_entropy_says() {
    let bytes: Vec<u8> = noise(LONG_BLOCK).iter().map(|byte| byte.leading_zeros() as u8 + 1).collect();
    let (size, entropy) = (deflated(&bytes).len(), LONG_BLOCK / 4);
    assert!((entropy - 300..entropy + 40 + 300).contains(&size), "{size}");
}
