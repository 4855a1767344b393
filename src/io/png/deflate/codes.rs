//! Huffman codes for counted symbols.

use super::bits::LONGEST_CODE;

/// A symbol's code: its bits in the order in which they are written, and their number.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Code(u32);

impl Code {
    /// The bits, the first one lowest.
    #[inline(always)]
    pub fn bits(self) -> u32 {
        self.0 & 0xffff
    }

    /// Their number; 0 for a symbol without a code.
    #[inline(always)]
    pub fn length(self) -> u32 {
        self.0 >> 16
    }
}

/// Codes of at most `longest` bits that waste nothing, for symbols of which at least two occur.
pub(super) fn codes<const SYMBOLS: usize>(counts: &[u32; SYMBOLS], longest: u32) -> [Code; SYMBOLS] {
    canonical(&lengths(counts, longest))
}

/// The length of each symbol's code.
fn lengths<const SYMBOLS: usize>(counts: &[u32; SYMBOLS], longest: u32) -> [u32; SYMBOLS] {
    let mut rising: Vec<usize> = (0..SYMBOLS).filter(|symbol| counts[*symbol] > 0).collect();
    // A stable sort: the same codes everywhere.
    rising.sort_by_key(|symbol| counts[*symbol]);
    let mut lengths = [0; SYMBOLS];
    let weights: Vec<u64> = rising.iter().map(|symbol| counts[*symbol].into()).collect();
    for (symbol, depth) in rising.iter().zip(depths(weights)) {
        lengths[*symbol] = depth.min(longest);
    }
    fill(&mut lengths, &rising, longest);
    lengths
}

/// How deep in Huffman's tree each leaf is, of weights that rise.
///
/// Inner nodes are made in the order of their weights, so the two lightest are at the heads of two queues.
fn depths(mut weights: Vec<u64>) -> impl Iterator<Item = u32> {
    let leaves = weights.len();
    let nodes = 2 * leaves - 1;
    let mut parents = vec![0; nodes];
    let (mut next_leaf, mut next_inner) = (0, leaves);
    for node in leaves..nodes {
        let mut weight = 0;
        for _ in 0..2 {
            let is_leaf = next_leaf < leaves && (next_inner == node || weights[next_leaf] <= weights[next_inner]);
            let next = if is_leaf { &mut next_leaf } else { &mut next_inner };
            parents[*next] = node;
            weight += weights[*next];
            *next += 1;
        }
        weights.push(weight);
    }
    let mut depths = vec![0; nodes];
    for node in (0..nodes - 1).rev() {
        depths[node] = depths[parents[node]] + 1;
    }
    depths.into_iter().take(leaves)
}

/// Lengthens codes that were cut too short to be told apart, and shortens common ones as far as there is room.
fn fill(lengths: &mut [u32], rising: &[usize], longest: u32) {
    // Kraft's sum, of which a code of n bits takes 2^-n; all of it is taken in the end.
    let whole = 1 << longest;
    let share = |length: u32| 1 << (longest - length);
    let mut taken: u32 = rising.iter().map(|symbol| share(lengths[*symbol])).sum();
    while taken > whole {
        // The least loss: the rarest among the longest that may grow.
        let may_grow = rising.iter().rev().filter(|symbol| lengths[**symbol] < longest);
        let Some(symbol) = may_grow.max_by_key(|symbol| lengths[**symbol]) else { return };
        lengths[*symbol] += 1;
        taken -= share(lengths[*symbol]);
    }
    for symbol in rising.iter().rev() {
        while lengths[*symbol] > 1 && taken + share(lengths[*symbol]) <= whole {
            taken += share(lengths[*symbol]);
            lengths[*symbol] -= 1;
        }
    }
}

/// The codes that deflate gives to these lengths (RFC 1951, section 3.2.2).
fn canonical<const SYMBOLS: usize>(lengths: &[u32; SYMBOLS]) -> [Code; SYMBOLS] {
    let mut counts = [0; LONGEST_CODE as usize + 1];
    lengths.iter().filter(|length| **length > 0).for_each(|length| counts[*length as usize] += 1);
    let mut next = [0; LONGEST_CODE as usize + 1];
    for length in 1..next.len() {
        next[length] = (next[length - 1] + counts[length - 1]) << 1;
    }
    lengths.map(|length| {
        if length == 0 {
            return Code::default();
        }
        let code: u32 = next[length as usize];
        next[length as usize] += 1;
        // Codes are written from their highest bit on.
        Code(code.reverse_bits() >> (32 - length) | length << 16)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The example of RFC 1951, section 3.2.2.
    #[test]
    fn codes_of_the_rfc() {
        let codes = canonical(&[3, 3, 3, 3, 3, 2, 4, 4]);
        let written = [0b010, 0b110, 0b001, 0b101, 0b011, 0b00, 0b0111, 0b1111];
        assert_eq!(codes.map(Code::bits), written);
        assert_eq!(codes.map(Code::length), [3, 3, 3, 3, 3, 2, 4, 4]);
    }

    /// Huffman's own example (Proceedings of the I.R.E. 40, 1952, table I): 3.42 bits on average.
    #[test]
    fn lengths_are_huffmans() {
        let counts = [20, 18, 10, 10, 10, 6, 6, 4, 4, 4, 4, 3, 1];
        let bits: u32 = counts.iter().zip(lengths(&counts, LONGEST_CODE)).map(|(count, length)| count * length).sum();
        assert_eq!(bits, 342);
        assert_eq!(lengths(&[0, 9, 0, 1], LONGEST_CODE), [0, 1, 0, 1]);
    }

    /// Every code is short enough, and together they take all bit strings.
    #[test]
    fn no_bit_string_is_wasted() {
        let fibonacci: [u32; 40] = {
            let mut counts = [1; 40];
            (2..40).for_each(|n| counts[n] = counts[n - 1] + counts[n - 2]);
            counts
        };
        let doubling: [u32; 30] = std::array::from_fn(|n| 1 << n);
        let one_common: [u32; 286] = std::array::from_fn(|n| if n == 7 { 100_000 } else { 1 });
        for longest in [9, LONGEST_CODE] {
            let few = lengths(&fibonacci, longest);
            for lengths in [&few[..], &lengths(&doubling, longest), &lengths(&one_common, longest)] {
                assert!(lengths.iter().all(|length| (1..=longest).contains(length)), "{lengths:?}");
                assert_eq!(lengths.iter().map(|length| 1 << (longest - length)).sum::<u32>(), 1 << longest);
            }
        }
    }
}
