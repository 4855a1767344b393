//! Fewer colours, for smaller files.

use std::collections::BTreeMap;

/// A colour, and how many pixels have it.
type Counted = ([u8; 3], u64);

/// At most `count` colours, and which of them each colour of `pixels` becomes: those of cells of the colour space that are
/// divided, the one with the largest sum of squared deviations first, at its mean along the channel that has most of it.
pub(super) fn divided(pixels: &[[u8; 3]], count: usize) -> (Vec<[u8; 3]>, BTreeMap<[u8; 3], u8>) {
    let mut all = BTreeMap::new();
    for pixel in pixels {
        *all.entry(*pixel).or_insert(0u64) += 1;
    }
    let mut cells = vec![Cell::of(all.into_iter().collect())];
    while cells.len() < count.clamp(1, 256) {
        let largest = (0..cells.len()).max_by(|&a, &b| cells[a].deviation().total_cmp(&cells[b].deviation()));
        let Some(largest) = largest.filter(|&largest| cells[largest].deviation() > 0.0) else { break };
        let halves = cells.swap_remove(largest).halves();
        cells.extend(halves);
    }
    let palette = cells.iter().map(|it| it.mean.map(|part| part.round() as u8)).collect();
    let index = |(index, it): (usize, &Cell)| it.colours.iter().map(|(c, _)| (*c, index as u8)).collect::<Vec<_>>();
    (palette, cells.iter().enumerate().flat_map(index).collect())
}

/// Colours near each other.
struct Cell {
    colours: Vec<Counted>,
    mean: [f64; 3],
    /// Sums of squared deviations from the mean.
    deviations: [f64; 3],
}

impl Cell {
    fn of(colours: Vec<Counted>) -> Self {
        let pixels = colours.iter().map(|(_, count)| *count as f64).sum::<f64>().max(1.0);
        let sum = |term: &dyn Fn(f64) -> f64, i: usize| {
            colours.iter().map(|(colour, count)| *count as f64 * term(colour[i].into())).sum::<f64>()
        };
        let mean = [0, 1, 2].map(|i| sum(&|part| part, i) / pixels);
        let deviations = [0, 1, 2].map(|i| sum(&|part| (part - mean[i]).powi(2), i));
        Self { colours, mean, deviations }
    }

    fn deviation(&self) -> f64 {
        self.deviations.iter().sum()
    }

    fn halves(self) -> [Self; 2] {
        let widest = (0..3).max_by(|&a, &b| self.deviations[a].total_cmp(&self.deviations[b])).unwrap_or_default();
        let (below, above) =
            self.colours.into_iter().partition(|(colour, _)| f64::from(colour[widest]) < self.mean[widest]);
        [Self::of(below), Self::of(above)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_that_are_few_are_kept() {
        let pixels = [[1, 2, 3], [200, 0, 9], [1, 2, 3], [7, 7, 7]];
        for count in [3, 256] {
            let (palette, index) = divided(&pixels, count);
            assert_eq!(palette.len(), 3);
            assert!(pixels.iter().all(|pixel| palette[usize::from(index[pixel])] == *pixel));
        }
    }

    #[test]
    fn colours_near_each_other_become_one() {
        let pixels: Vec<[u8; 3]> = (0..100u8).map(|i| if i < 50 { [i / 25, 0, 0] } else { [255, i / 25, 0] }).collect();
        let (palette, index) = divided(&pixels, 2);
        let of = |pixel: [u8; 3]| palette[usize::from(index[&pixel])];
        assert_eq!((palette.len(), of([0, 0, 0]), of([255, 3, 0])), (2, [1, 0, 0], [255, 3, 0]));
    }
}
