//! Work on long slices, cut into pieces for several threads.

use rayon::prelude::*;

/// Elements of a piece, some 20 microseconds of work: waking a thread takes as long.
const PIECE: usize = 1 << 13;

/// What `of_piece` makes of each piece of `values`; it is told the first index.
pub(super) fn of_pieces<T: Sync, R: Send>(values: &[T], of_piece: impl Fn(usize, &[T]) -> R + Sync) -> Vec<R> {
    if values.len() <= PIECE {
        return vec![of_piece(0, values)];
    }
    values.par_chunks(PIECE).enumerate().map(|(piece, values)| of_piece(piece * PIECE, values)).collect()
}

/// The same with values that may change.
pub(super) fn of_pieces_mut<T: Send, R: Send>(
    values: &mut [T],
    of_piece: impl Fn(usize, &mut [T]) -> R + Sync,
) -> Vec<R> {
    if values.len() <= PIECE {
        return vec![of_piece(0, values)];
    }
    values.par_chunks_mut(PIECE).enumerate().map(|(piece, values)| of_piece(piece * PIECE, values)).collect()
}
