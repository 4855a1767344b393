//! Bits, the first one lowest in its byte, as deflate packs them (RFC 1951, section 3.1.1).

use super::codes::Code;

/// The most bits of a code: four codes and the seven bits before them fit a word.
pub(super) const LONGEST_CODE: u32 = 12;

/// Bits that become bytes; the room is kept for the next stripe.
#[derive(Debug, Default)]
pub struct BitWriter {
    /// Room, of which the first `length` bytes are written.
    room: Vec<u8>,
    length: usize,
    /// Bits that do not fill a byte yet.
    word: u64,
    held: u32,
}

impl BitWriter {
    /// What was written; whole bytes only.
    pub fn bytes(&self) -> &[u8] {
        &self.room[..self.length]
    }

    /// Forgets what was written.
    pub fn clear(&mut self) {
        (self.length, self.word, self.held) = (0, 0, 0);
    }

    /// Forgets what was written, and goes on in other room; its own is left there.
    pub fn exchange(&mut self, room: &mut Vec<u8>) {
        self.clear();
        std::mem::swap(&mut self.room, room);
    }

    /// Makes room for `bytes` more, and for the word that the last of them may be a part of.
    pub(super) fn reserve(&mut self, bytes: usize) {
        let wanted = self.length + bytes + size_of::<u64>();
        if self.room.len() < wanted {
            self.room.resize(wanted, 0);
        }
    }

    /// Writes the lowest `count` bits of `value`, at most 48, whose others are zero.
    pub fn bits(&mut self, value: u64, count: u32) {
        self.reserve(0);
        let mut rest = Rest { word: self.word, held: self.held, at: self.length };
        rest.put(value, count, &mut self.room);
        self.keep(rest);
    }

    /// Writes a code.
    pub(super) fn code(&mut self, code: Code) {
        self.bits(code.bits().into(), code.length());
    }

    /// Writes the code of each byte; there must be room for them.
    pub(super) fn literals(&mut self, bytes: &[u8], codes: &[Code; 256]) {
        let mut rest = Rest { word: self.word, held: self.held, at: self.length };
        let mut fours = bytes.chunks_exact(4);
        for four in &mut fours {
            let [a, b, c, d] = [four[0], four[1], four[2], four[3]].map(|byte| codes[usize::from(byte)]);
            let first = a.bits() | b.bits() << a.length();
            let second = c.bits() | d.bits() << c.length();
            let first_length = a.length() + b.length();
            let both = u64::from(first) | u64::from(second) << first_length;
            rest.put(both, first_length + c.length() + d.length(), &mut self.room);
        }
        for byte in fours.remainder() {
            let code = codes[usize::from(*byte)];
            rest.put(code.bits().into(), code.length(), &mut self.room);
        }
        self.keep(rest);
    }

    /// Goes on with a byte's first bit.
    pub fn align(&mut self) {
        if self.held > 0 {
            self.reserve(1);
            self.room[self.length] = self.word as u8;
            self.length += 1;
            (self.word, self.held) = (0, 0);
        }
    }

    /// Writes whole bytes, aligned.
    pub fn whole(&mut self, bytes: &[u8]) {
        debug_assert_eq!(self.held, 0, "bytes begin where a byte begins");
        self.reserve(bytes.len());
        self.room[self.length..][..bytes.len()].copy_from_slice(bytes);
        self.length += bytes.len();
    }

    fn keep(&mut self, rest: Rest) {
        (self.word, self.held, self.length) = (rest.word, rest.held, rest.at);
    }
}

/// The end of the written bits, in registers.
struct Rest {
    word: u64,
    held: u32,
    at: usize,
}

impl Rest {
    #[inline(always)]
    fn put(&mut self, value: u64, count: u32, room: &mut [u8]) {
        self.word |= value << self.held;
        self.held += count;
        room[self.at..self.at + size_of::<u64>()].copy_from_slice(&self.word.to_le_bytes());
        self.at += (self.held / 8) as usize;
        // At most 55 bits were held.
        self.word >>= self.held & !7;
        self.held &= 7;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_fill_bytes_from_the_lowest() {
        let mut writer = BitWriter::default();
        for (value, count) in [(0b1, 1), (0b01, 2), (0x1f, 5), (0xabc, 12)] {
            writer.bits(value, count);
        }
        writer.align();
        writer.align();
        writer.whole(&[7, 8]);
        assert_eq!(writer.bytes(), [0b1111_1011, 0xbc, 0x0a, 7, 8]);
        writer.clear();
        writer.bits((1 << 48) - 2, 48);
        assert_eq!(writer.bytes(), [0xfe, 0xff, 0xff, 0xff, 0xff, 0xff]);
    }
}
