//! Stripes: rows of an image that one thread filters and deflates by itself.
//!
//! A slower [`Compression`] tries all that a faster one does, and the smallest is kept: it makes no stripe larger.

use super::deflate::{BitWriter, Coding, LONG_BLOCK, SHORT_BLOCK, deflate};
use super::filter::{Choice, Filter};
use crate::io::Compression;

/// The filters that are tried. After the first, those of smooth maps: Paeth's guesses are best where maps are nearly
/// flat or have 16 bits.
const CHOICES: [Choice; 3] = [Choice::Fixed(Filter::Paeth), Choice::Fixed(Filter::Average), Choice::LeastSum];

/// Codes alone. Short blocks follow a steep map more closely.
const LITERALS: [Coding; 2] = [Coding::Literals(LONG_BLOCK), Coding::Literals(SHORT_BLOCK)];

/// All matches that a long search finds, and a longer one.
const MATCHES: Coding = Coding::Matches(8);
const MOST_MATCHES: Coding = Coding::Matches(9);

/// Bytes in the middle of a stripe, from which it is guessed whether matches pay.
const SAMPLE_BYTES: usize = 16 << 10;

impl Compression {
    /// Bytes of filtered rows in a stripe, about: few keep memory and waiting short, but matches do not reach from one
    /// stripe into another.
    fn stripe_bytes(self) -> usize {
        match self {
            Self::Fast => 128 << 10,
            Self::Balanced | Self::Small => 512 << 10,
        }
    }

    /// Rows in a stripe: a number that depends on nothing but their length, so that the file's bytes do so too.
    pub(super) fn stripe_rows(self, row_bytes: usize) -> usize {
        (self.stripe_bytes() / (1 + row_bytes)).max(1)
    }

    /// Buffers of a stripe: its rows, and filtered; then two attempts, what zlib writes, and what it remembers. The only
    /// attempt of the fast level takes the rows' place.
    pub(super) fn buffers(self) -> usize {
        match self {
            Self::Fast => 2,
            Self::Balanced | Self::Small => 6,
        }
    }
}

/// A stripe on its way from rows to a piece of a zlib stream; its buffers serve the next one.
#[derive(Default)]
pub(super) struct Stripe {
    /// The row above, then the stripe's rows, as PNG orders their bytes.
    rows: Vec<u8>,
    row_bytes: usize,
    texel_bytes: usize,
    /// Whether the row above is not known: the stripe's first row does not look up.
    is_first: bool,
    /// What was filtered last.
    filtered: Vec<u8>,
    /// The smallest attempt so far, the Adler-32 of what was deflated, and how that was filtered; room for another.
    best: BitWriter,
    checksum: u32,
    choice: Option<Choice>,
    other: BitWriter,
}

impl Stripe {
    /// Begins anew with up to `count` rows of `row_bytes`, below the row `above` if that is known.
    pub fn begin(&mut self, count: usize, row_bytes: usize, texel_bytes: usize, above: Option<&[u8]>) {
        (self.row_bytes, self.texel_bytes, self.is_first) = (row_bytes, texel_bytes, above.is_none());
        // What was written there is not needed any more.
        self.best.exchange(&mut self.rows);
        self.rows.clear();
        self.rows.reserve_exact((1 + count) * row_bytes);
        match above {
            Some(above) => self.rows.extend_from_slice(above),
            None => self.rows.resize(row_bytes, 0),
        }
    }

    /// Room for the next row.
    pub fn next_row(&mut self) -> &mut [u8] {
        let start = self.rows.len();
        self.rows.resize(start + self.row_bytes, 0);
        &mut self.rows[start..]
    }

    /// Rows so far.
    pub fn count(&self) -> usize {
        self.rows.len() / self.row_bytes - 1
    }

    /// The last row, or the one above.
    pub fn last_row(&self) -> &[u8] {
        &self.rows[self.rows.len() - self.row_bytes..]
    }

    /// Filters and deflates the rows: `Fast` by one filter, and codes; `Balanced` by several, and matches where a sample
    /// says that they pay; `Small` with matches after every filter too.
    pub fn encoded(mut self, compression: Compression) -> Self {
        self.choice = None;
        match compression {
            Compression::Fast => self.encode_once(),
            Compression::Balanced => self.encode_well(),
            Compression::Small => {
                self.encode_well();
                self.attempts(&CHOICES, &[MOST_MATCHES]);
            }
        }
        self
    }

    fn encode_once(&mut self) {
        self.filter(CHOICES[0]);
        // The rows have served: the result takes their room.
        self.other.exchange(&mut self.rows);
        self.attempt(CHOICES[0], LITERALS[0]);
    }

    fn encode_well(&mut self) {
        self.attempts(&CHOICES, &LITERALS);
        let smallest = self.choice.unwrap_or(CHOICES[0]);
        self.filter(smallest);
        if self.matches_pay() {
            self.attempt(smallest, MATCHES);
        }
    }

    fn attempts(&mut self, choices: &[Choice], codings: &[Coding]) {
        for choice in choices {
            self.filter(*choice);
            codings.iter().for_each(|coding| self.attempt(*choice, *coding));
        }
    }

    fn filter(&mut self, choice: Choice) {
        self.filtered.clear();
        self.filtered.reserve_exact(self.count() * (1 + self.row_bytes));
        let rows = self.rows.chunks_exact(self.row_bytes);
        for (number, (row, above)) in rows.clone().skip(1).zip(rows).enumerate() {
            let choice = if number == 0 && self.is_first { Choice::Fixed(Filter::Sub) } else { choice };
            choice.apply(row, above, self.texel_bytes, &mut self.filtered);
        }
    }

    /// Deflates what was filtered by `choice`, and keeps the result if it is the smallest.
    fn attempt(&mut self, choice: Choice, coding: Coding) {
        self.other.clear();
        deflate(&self.filtered, coding, &mut self.other);
        if self.choice.is_none() || self.other.bytes().len() < self.best.bytes().len() {
            std::mem::swap(&mut self.best, &mut self.other);
            self.checksum = simd_adler32::adler32(&self.filtered.as_slice());
            self.choice = Some(choice);
        }
    }

    /// Whether a part of the stripe is much smaller with matches: they take a hundred times as long.
    fn matches_pay(&mut self) -> bool {
        let middle = self.filtered.len().saturating_sub(SAMPLE_BYTES) / 2;
        let sample = &self.filtered[middle..][..SAMPLE_BYTES.min(self.filtered.len())];
        let [literals, matches] = [LITERALS[1], MATCHES].map(|coding| {
            self.other.clear();
            deflate(sample, coding, &mut self.other);
            self.other.bytes().len()
        });
        matches < literals - literals / 16
    }

    /// The stripe's piece of the stream, once it is encoded.
    pub fn deflated(&self) -> &[u8] {
        self.best.bytes()
    }

    /// The Adler-32 of what was deflated, and its bytes.
    pub fn checksum(&self) -> (u32, u64) {
        (self.checksum, self.filtered.len() as u64)
    }
}
