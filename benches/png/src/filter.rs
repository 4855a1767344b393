//! PNG's row filters, and ways to choose one.

#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Filter {
    None,
    Sub,
    Up,
    Paeth,
    /// Of sub, up and Paeth the one with the least sum of absolute differences, row by row.
    Least,
    /// Of none, sub, up and Paeth the one whose bytes have the least entropy in every eighth row of a stripe.
    Sampled,
}

/// Filters `rows` (of `row` bytes each, `bpp` bytes per pixel); `above` is the row before the first.
pub fn filtered(filter: Filter, rows: &[u8], above: Option<&[u8]>, row: usize, bpp: usize) -> Vec<u8> {
    let zeros = vec![0; row];
    let mut above = above.unwrap_or(&zeros);
    let mut out = vec![0; rows.len() / row * (row + 1)];
    let choice = if filter == Filter::Sampled { sampled(rows, row, bpp) } else { filter };
    let mut tries = [vec![0; row], vec![0; row], vec![0; row]];
    for (line, into) in rows.chunks_exact(row).zip(out.chunks_exact_mut(row + 1)) {
        let (tag, into) = into.split_at_mut(1);
        if choice == Filter::Least {
            let mut best = (u64::MAX, 0);
            for (k, kind) in [Filter::Sub, Filter::Up, Filter::Paeth].into_iter().enumerate() {
                filter_row(kind, line, above, bpp, &mut tries[k]);
                let sum = tries[k].iter().map(|&b| u64::from((b as i8).unsigned_abs())).sum();
                if sum < best.0 {
                    best = (sum, k);
                }
            }
            tag[0] = [1, 2, 4][best.1];
            into.copy_from_slice(&tries[best.1]);
        } else {
            tag[0] = match choice {
                Filter::None => 0,
                Filter::Sub => 1,
                Filter::Up => 2,
                _ => 4,
            };
            filter_row(choice, line, above, bpp, into);
        }
        above = line;
    }
    out
}

fn filter_row(filter: Filter, line: &[u8], above: &[u8], bpp: usize, into: &mut [u8]) {
    let (head, body) = into.split_at_mut(bpp);
    let (left, up_left) = (&line[..line.len() - bpp], &above[..above.len() - bpp]);
    match filter {
        Filter::None => {
            head.copy_from_slice(&line[..bpp]);
            body.copy_from_slice(&line[bpp..]);
        }
        Filter::Sub => {
            head.copy_from_slice(&line[..bpp]);
            for ((o, &x), &a) in body.iter_mut().zip(&line[bpp..]).zip(left) {
                *o = x.wrapping_sub(a);
            }
        }
        Filter::Up => {
            for ((o, &x), &b) in into.iter_mut().zip(line).zip(above) {
                *o = x.wrapping_sub(b);
            }
        }
        _ => {
            for ((o, &x), &b) in head.iter_mut().zip(line).zip(above) {
                *o = x.wrapping_sub(b);
            }
            for ((((o, &x), &a), &b), &c) in body.iter_mut().zip(&line[bpp..]).zip(left).zip(&above[bpp..]).zip(up_left)
            {
                *o = x.wrapping_sub(paeth(a, b, c));
            }
        }
    }
}

fn paeth(a: u8, b: u8, c: u8) -> u8 {
    let (a16, b16, c16) = (i16::from(a), i16::from(b), i16::from(c));
    let (pa, pb) = ((b16 - c16).abs(), (a16 - c16).abs());
    let pc = (a16 + b16 - 2 * c16).abs();
    let bc = if pb <= pc { b } else { c };
    if pa <= pb && pa <= pc { a } else { bc }
}

fn sampled(rows: &[u8], row: usize, bpp: usize) -> Filter {
    let kinds = [Filter::None, Filter::Sub, Filter::Up, Filter::Paeth];
    let mut counts = [[0u32; 256]; 4];
    let mut scratch = vec![0; row];
    let lines: Vec<_> = rows.chunks_exact(row).collect();
    for pair in lines.windows(2).step_by(8) {
        for (kind, count) in kinds.into_iter().zip(&mut counts) {
            filter_row(kind, pair[1], pair[0], bpp, &mut scratch);
            for &b in &scratch {
                count[b as usize] += 1;
            }
        }
    }
    let entropy = |count: &[u32; 256]| -> f64 {
        let total: u32 = count.iter().sum();
        count.iter().filter(|&&c| c > 0).map(|&c| f64::from(c) * (f64::from(total) / f64::from(c)).log2()).sum()
    };
    // With one row there is nothing to sample.
    (0..4).min_by(|&a, &b| entropy(&counts[a]).total_cmp(&entropy(&counts[b]))).map_or(Filter::Up, |k| kinds[k])
}
