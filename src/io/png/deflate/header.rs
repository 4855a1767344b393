//! The header of a block with codes of its own: the lengths of the codes, which have codes themselves (RFC 1951, section
//! 3.2.7).

use super::SYMBOLS;
use super::bits::BitWriter;
use super::codes::{Code, codes};

/// The most bits of the code of a length.
const LONGEST: u32 = 7;

/// The lengths from 0 to 15, and what repeats them.
const LENGTHS: usize = 19;

/// The order in which the lengths of the lengths' codes stand: those that are seldom used last.
const ORDER: [usize; LENGTHS] = [16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15];

/// Literals and the end of the block always have lengths; the lengths of matches only if there are any.
const LEAST_SYMBOLS: usize = 257;

/// The one distance, whose code is a single 0.
const DISTANCE: u32 = 1;

/// What stands in the header.
pub(super) struct Header {
    /// Symbols whose lengths are given.
    symbols: usize,
    words: Vec<Word>,
    codes: [Code; LENGTHS],
    /// Codes in the order above, of which the others are not used.
    shown: usize,
}

/// A length, or what repeats one, with extra bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Word {
    symbol: usize,
    extra: usize,
    extra_bits: u32,
}

impl Header {
    /// The header of a block with these codes and one distance.
    pub fn new(block: &[Code; SYMBOLS]) -> Self {
        let is_used = |code: &Code| code.length() > 0;
        let symbols = block.iter().rposition(is_used).map_or(0, |last| last + 1).max(LEAST_SYMBOLS);
        let lengths: Vec<u32> = block[..symbols].iter().map(|code| code.length()).chain([DISTANCE]).collect();
        let words = words(&lengths);
        let mut counts = [0; LENGTHS];
        words.iter().for_each(|word| counts[word.symbol] += 1);
        let codes = codes(&counts, LONGEST);
        let shown = ORDER.iter().rposition(|symbol| is_used(&codes[*symbol])).map_or(0, |last| last + 1).max(4);
        Self { symbols, words, codes, shown }
    }

    /// How many bits it has.
    pub fn bits(&self) -> usize {
        let of_words = self.words.iter().map(|word| self.codes[word.symbol].length() + word.extra_bits);
        3 + 5 + 5 + 4 + 3 * self.shown + of_words.sum::<u32>() as usize
    }

    pub fn write(&self, out: &mut BitWriter) {
        out.bits(0b100, 3);
        out.bits((self.symbols - LEAST_SYMBOLS) as u64, 5);
        out.bits(0, 5); // one distance
        out.bits(self.shown as u64 - 4, 4);
        ORDER[..self.shown].iter().for_each(|symbol| out.bits(self.codes[*symbol].length().into(), 3));
        for word in &self.words {
            out.code(self.codes[word.symbol]);
            out.bits(word.extra as u64, word.extra_bits);
        }
    }
}

/// Lengths, with those that repeat in as few words as the RFC has for them.
fn words(lengths: &[u32]) -> Vec<Word> {
    let mut words = Vec::new();
    for run in lengths.chunk_by(|a, b| a == b) {
        let once = Word { symbol: run[0] as usize, extra: 0, extra_bits: 0 };
        let mut left = run.len();
        if run[0] > 0 {
            // The others repeat it.
            words.push(once);
            left -= 1;
        }
        while left >= 3 {
            let (symbol, least, most, extra_bits) = match run[0] {
                0 if left < 11 => (17, 3, 10, 3),
                0 => (18, 11, 138, 7),
                _ => (16, 3, 6, 2),
            };
            let repeated = left.min(most);
            words.push(Word { symbol, extra: repeated - least, extra_bits });
            left -= repeated;
        }
        words.extend(std::iter::repeat_n(once, left));
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In the words of RFC 1951, section 3.2.7.
    fn repeated(words: &[Word]) -> Vec<u32> {
        let mut lengths: Vec<u32> = Vec::new();
        for word in words {
            let (length, times) = match word.symbol {
                16 => (*lengths.last().unwrap(), 3 + word.extra),
                17 => (0, 3 + word.extra),
                18 => (0, 11 + word.extra),
                length => (length as u32, 1),
            };
            lengths.extend(std::iter::repeat_n(length, times));
        }
        lengths
    }

    #[test]
    fn every_run_is_repeated() {
        for length in [0, 1, 12] {
            for times in 1..300 {
                let lengths = [&[3][..], &vec![length; times], &[7]].concat();
                let words = words(&lengths);
                assert_eq!(repeated(&words), lengths, "{times} x {length}");
                assert!(words.iter().all(|word| word.extra < 1 << word.extra_bits), "{words:?}");
            }
        }
        // The RFC's own example, 12 lengths of 8 as 1 + 6 + 5; and the longest run of zeros.
        let eights: Vec<[usize; 2]> = words(&[8; 12]).iter().map(|word| [word.symbol, word.extra]).collect();
        assert_eq!(eights, [[8, 0], [16, 3], [16, 2]]);
        assert_eq!(words(&[0; 138]), [Word { symbol: 18, extra: 127, extra_bits: 7 }]);
    }
}
