//! Whether a map shows the steps of 8 bits.

use crate::map::{CodesRef, Depth, Encoding, NormalFormat};

/// Traces of 8 bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Banding {
    /// A map of 16 bits or floats.
    Fine {
        /// Every code is one of 8 bits, widened, and there are several: nothing is gained from the finer format.
        holds_8_bits: bool,
    },
    /// A map of 8 bits: along its rows and columns, in each channel.
    Coarse {
        /// Changes from a code to the next texel's.
        changes: u64,
        /// Those of one code between two plateaus of eight equal codes or more: terraces, where a finer format
        /// would have a slope.
        terraces: u64,
    },
}

/// Texels of a plateau. The direction turns by one code, 0.45 degrees, in 8 texels: less than 0.06 degrees for each.
const PLATEAU: u8 = 8;

/// Fewer terraces are no pattern.
const LEAST_TERRACES: u64 = 64;

impl Banding {
    /// Whether bands show: fine maps that hold 8 bits, coarse ones most of whose changes are terraces.
    pub fn shows(&self) -> bool {
        match *self {
            Self::Fine { holds_8_bits } => holds_8_bits,
            Self::Coarse { changes, terraces } => terraces >= LEAST_TERRACES && 2 * terraces > changes,
        }
    }
}

/// What is known after some rows.
pub(super) enum BandingTest {
    Fine(Widened),
    Coarse(Terraces),
}

impl BandingTest {
    pub fn new(format: NormalFormat) -> Self {
        match format.depth {
            Depth::Bits8 => Self::Coarse(Terraces::default()),
            _ => Self::Fine(Widened::new(format.encoding)),
        }
    }

    /// Looks at the codes of a row, `channels` for each texel.
    pub fn add_row(&mut self, row: CodesRef<'_>, channels: usize) {
        match (self, row) {
            (Self::Coarse(terraces), CodesRef::U8(codes)) => terraces.add_row(codes, channels),
            (Self::Fine(widened), row) => widened.add_row(row),
            (Self::Coarse(_), _) => {}
        }
    }

    pub fn result(&self) -> Banding {
        match self {
            Self::Fine(widened) => Banding::Fine { holds_8_bits: widened.is_certain() },
            Self::Coarse(terraces) => Banding::Coarse { changes: terraces.changes, terraces: terraces.terraces },
        }
    }
}

/// The ways in which 8 bits are widened; those that some code contradicts are gone.
pub(super) struct Widened {
    ways: Vec<fn(f64) -> bool>,
    encoding: Encoding,
    /// Different codes, until there are [`SEVERAL`].
    seen: Vec<f64>,
}

/// One code in 256 looks like a widened one by chance; so many different ones do not.
const SEVERAL: usize = 8;

impl Widened {
    fn new(encoding: Encoding) -> Self {
        // Codes are numbers here, those of snorm with their sign.
        let repeated: fn(f64) -> bool = |code| code % 257.0 == 0.0;
        let shifted: fn(f64) -> bool = |code| code % 256.0 == 0.0;
        let snorm: fn(f64) -> bool = |code| is_rounded(code, 127.0 / 32_767.0, 0.5);
        let biased: fn(f64) -> bool = |code| is_rounded(code - 32_768.0, 127.0 / 32_767.0, 0.5);
        let unorm_float: fn(f64) -> bool = |v| v == 0.0 || is_rounded(v + 1.0, 127.5, error_of(v));
        let snorm_float: fn(f64) -> bool = |v| is_rounded(v, 127.0, error_of(v));
        let ways = match encoding {
            Encoding::Unorm => vec![repeated, shifted],
            Encoding::Biased => vec![repeated, shifted, biased],
            Encoding::Snorm => vec![shifted, snorm],
            Encoding::Float => vec![unorm_float, snorm_float],
        };
        Self { ways, encoding, seen: Vec::new() }
    }

    fn add_row(&mut self, row: CodesRef<'_>) {
        match row {
            CodesRef::U8(_) => {}
            CodesRef::U16(codes) if self.encoding == Encoding::Snorm => {
                self.add_codes(codes.iter().map(|code| f64::from(*code as i16)));
            }
            CodesRef::U16(codes) => self.add_codes(codes.iter().map(|code| f64::from(*code))),
            CodesRef::F16(codes) => self.add_codes(codes.iter().map(|code| code.to_f64())),
            CodesRef::F32(codes) => self.add_codes(codes.iter().map(|code| f64::from(*code))),
        }
    }

    fn add_codes(&mut self, codes: impl Iterator<Item = f64> + Clone) {
        self.ways.retain(|way| codes.clone().all(way));
        if self.ways.is_empty() || self.seen.len() == SEVERAL {
            return;
        }
        for code in codes {
            if self.seen.len() < SEVERAL && !self.seen.contains(&code) {
                self.seen.push(code);
            }
        }
    }

    fn is_certain(&self) -> bool {
        !self.ways.is_empty() && self.seen.len() == SEVERAL
    }
}

/// Whether `value` is a multiple of 1 / `steps`, off by `error` at most.
fn is_rounded(value: f64, steps: f64, error: f64) -> bool {
    (value - (value * steps).round() / steps).abs() <= error
}

/// What rounding to a float may do to a component up to 1, or to a half if it is one exactly.
fn error_of(component: f64) -> f64 {
    let is_half = (component as f32).to_bits() & 0x1fff == 0;
    if is_half { 1.0 / 4096.0 } else { 1.0 / 8_388_608.0 }
}

/// Changes of 8-bit codes along rows and columns.
#[derive(Default)]
pub(super) struct Terraces {
    changes: u64,
    terraces: u64,
    /// The runs down the columns, of each code of a row.
    down: Vec<Run>,
}

/// A run of equal codes, down a column or along a row.
#[derive(Clone, Copy, Default)]
struct Run {
    code: u8,
    /// Its length so far, up to 255.
    length: u8,
    /// Whether it began with a step of one code from a plateau and is none itself yet.
    is_awaited: bool,
}

impl Run {
    /// The next code: whether it is a change, and whether it completes a terrace. Without branches, since noise would
    /// mislead them.
    #[inline(always)]
    fn add(&mut self, code: u8) -> (bool, bool) {
        let is_same = code == self.code;
        let steps_down = (self.length >= PLATEAU) & (code.abs_diff(self.code) == 1);
        let is_first = self.length == 0;
        self.length = if is_same { self.length.saturating_add(1) } else { 1 };
        let is_plateau = self.length >= PLATEAU;
        let completes = is_same & self.is_awaited & is_plateau;
        self.is_awaited = if is_same { self.is_awaited & !is_plateau } else { steps_down };
        self.code = code;
        (!is_same & !is_first, completes)
    }
}

impl Terraces {
    fn add_row(&mut self, row: &[u8], channels: usize) {
        self.down.resize(row.len(), Run::default());
        let mut along = [Run::default(); 3];
        let [mut changes, mut terraces] = [0u32; 2];
        let mut count = |(is_change, is_terrace): (bool, bool)| {
            changes += u32::from(is_change);
            terraces += u32::from(is_terrace);
        };
        for (texel, down) in row.chunks_exact(channels).zip(self.down.chunks_exact_mut(channels)) {
            for ((code, along), down) in texel.iter().zip(&mut along).zip(down) {
                count(along.add(*code));
                count(down.add(*code));
            }
        }
        self.changes += u64::from(changes);
        self.terraces += u64::from(terraces);
    }
}
