//! Runs of zeros, and how deflate writes them.

/// The shortest and the longest match.
const SHORTEST: usize = 3;
const LONGEST: usize = 258;

/// Zeros that are found for certain in a run of 15 of them.
const GROUP: usize = 8;

/// Zeros that repeat the zero before them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Run {
    /// Where they begin.
    pub start: usize,
    length: usize,
}

/// The length of a match as deflate writes it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Length {
    pub symbol: usize,
    pub extra: u32,
    pub extra_bits: u32,
}

impl Run {
    /// Zeros that matches cover: all but one or two that are left at times.
    pub fn matched(self) -> usize {
        let left = self.length % LONGEST;
        if left < SHORTEST { self.length - left } else { self.length }
    }

    /// The matches that cover them.
    pub fn lengths(self) -> impl Iterator<Item = Length> {
        let left = self.matched() % LONGEST;
        let long = std::iter::repeat_n(Length::of(LONGEST), self.length / LONGEST);
        long.chain((left > 0).then(|| Length::of(left)))
    }
}

impl Length {
    /// The symbol and the extra bits of a length from 3 to 258 (RFC 1951, section 3.2.5).
    fn of(length: usize) -> Self {
        let above = (length - SHORTEST) as u32;
        match above {
            // The longest has a symbol to itself.
            255 => Self { symbol: 285, extra: 0, extra_bits: 0 },
            0..8 => Self { symbol: 257 + above as usize, extra: 0, extra_bits: 0 },
            _ => {
                // Four symbols for each power of two.
                let extra_bits = above.ilog2() - 2;
                let symbol = 257 + 4 * extra_bits as usize + (above >> extra_bits) as usize;
                Self { symbol, extra: above & ((1 << extra_bits) - 1), extra_bits }
            }
        }
    }
}

/// The runs of at least 15 zeros, and some shorter ones, less their first zero.
pub(super) fn runs_of_zeros(bytes: &[u8]) -> Vec<Run> {
    let mut runs = Vec::new();
    let mut at = 0;
    while at + GROUP <= bytes.len() {
        if bytes[at..at + GROUP] != [0; GROUP] {
            at += GROUP;
            continue;
        }
        let before = bytes[..at].iter().rev().take(GROUP - 1).take_while(|byte| **byte == 0).count();
        let start = at - before;
        let end = zeros_end(bytes, at + GROUP);
        runs.push(Run { start: start + 1, length: end - start - 1 });
        at = (end + 1).next_multiple_of(GROUP);
    }
    runs
}

/// Where the zeros from `at` on end.
fn zeros_end(bytes: &[u8], at: usize) -> usize {
    let groups = bytes[at..].chunks_exact(GROUP).take_while(|group| **group == [0; GROUP]).count();
    let at = at + groups * GROUP;
    at + bytes[at..].iter().take(GROUP).take_while(|byte| **byte == 0).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of the table in RFC 1951, section 3.2.5.
    #[test]
    fn lengths_are_those_of_the_rfc() {
        let rows = [
            (3, 257, 0, 0),
            (10, 264, 0, 0),
            (11, 265, 0, 1),
            (12, 265, 1, 1),
            (13, 266, 0, 1),
            (18, 268, 1, 1),
            (19, 269, 0, 2),
            (114, 279, 15, 4),
            (115, 280, 0, 4),
            (130, 280, 15, 4),
            (131, 281, 0, 5),
            (257, 284, 30, 5),
            (258, 285, 0, 0),
        ];
        for (length, symbol, extra, extra_bits) in rows {
            assert_eq!(Length::of(length), Length { symbol, extra, extra_bits }, "{length}");
        }
    }

    #[test]
    fn runs_are_whole() {
        for before in 1..20 {
            for zeros in 0..600 {
                let mut bytes = vec![1; before];
                bytes.extend(vec![0; zeros]);
                bytes.extend([1; 9]);
                let runs = runs_of_zeros(&bytes);
                let expected = Run { start: before + 1, length: zeros.saturating_sub(1) };
                assert!(runs == [expected] || runs.is_empty() && zeros < 15, "{before} {zeros}: {runs:?}");
                if let [run] = runs[..] {
                    let least = zeros - 1 - 2;
                    assert!((least..zeros).contains(&run.matched()), "{before} {zeros}");
                }
            }
        }
    }
}
