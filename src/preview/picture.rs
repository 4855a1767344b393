//! Pixels, and the file that they become.

use super::palette::divided;
use crate::error::{Error, Result};
use crate::io::create_normals;
use crate::io::replace::Replacement;
use crate::map::{CodesRef, NormalFormat, Size};
use std::io::BufWriter;
use std::ops::Range;
use std::path::Path;

/// Rows of 8-bit sRGB pixels.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    size: Size,
    pixels: Vec<[u8; 3]>,
}

impl Picture {
    /// A picture of one colour.
    ///
    /// # Errors
    /// [`Error::Parameter`] if it has no pixels, or too many.
    pub fn filled([width, height]: [usize; 2], colour: [u8; 3]) -> Result<Self> {
        let size = Size::new(width, height)?;
        Ok(Self { size, pixels: vec![colour; size.texels()] })
    }

    /// The pixels of linear colours, each the mean of a square of `per_pixel` by `per_pixel` samples, `across` samples in
    /// a row.
    ///
    /// # Errors
    /// As [`Picture::filled`].
    pub fn of_samples(samples: &[[f32; 3]], across: usize, per_pixel: usize) -> Result<Self> {
        Self::of_means(samples, across, per_pixel, |mean: [f32; 3]| mean.map(to_srgb))
    }

    /// The same of any samples, with what becomes of their mean.
    ///
    /// # Errors
    /// As [`Picture::filled`].
    pub fn of_means<const N: usize>(
        samples: &[[f32; N]],
        across: usize,
        per_pixel: usize,
        colour: impl Fn([f32; N]) -> [u8; 3],
    ) -> Result<Self> {
        let size = Size::new(across / per_pixel, samples.len() / across.max(1) / per_pixel)?;
        let pixel = |i: usize| {
            let first = i / size.width() * per_pixel * across + i % size.width() * per_pixel;
            let square = (0..per_pixel * per_pixel).map(|s| samples[first + s / per_pixel * across + s % per_pixel]);
            let sum = square.fold([0.0; N], |sum, sample| std::array::from_fn(|i| sum[i] + sample[i]));
            colour(sum.map(|part| part / (per_pixel * per_pixel) as f32))
        };
        Ok(Self { size, pixels: (0..size.texels()).map(pixel).collect() })
    }

    /// Width and height in pixels.
    pub fn size(&self) -> Size {
        self.size
    }

    /// The pixels, row by row from the top.
    pub fn pixels(&self) -> &[[u8; 3]] {
        &self.pixels
    }

    /// The bytes of the rows, to draw into.
    pub(super) fn bytes_mut(&mut self) -> &mut [u8] {
        self.pixels.as_flattened_mut()
    }

    /// Puts another picture into this one, its upper left pixel at column x, row y; what does not fit is left away.
    pub fn paste(&mut self, other: &Self, [x, y]: [usize; 2]) {
        let (width, height) = (self.size.width(), self.size.height());
        let fitting = other.size.width().min(width.saturating_sub(x));
        for (row, pixels) in other.pixels.chunks(other.size.width()).enumerate().take(height.saturating_sub(y)) {
            let start = (y + row) * width + x;
            self.pixels[start..start + fitting].copy_from_slice(&pixels[..fitting]);
        }
    }

    /// Some of its rows.
    ///
    /// # Errors
    /// [`Error::Parameter`] if there are none.
    pub fn rows(&self, rows: Range<usize>) -> Result<Self> {
        let (width, last) = (self.size.width(), rows.end.min(self.size.height()));
        let size = Size::new(width, last.saturating_sub(rows.start))?;
        Ok(Self { size, pixels: self.pixels[rows.start * width..last * width].to_vec() })
    }

    /// Fails if a picture cannot be called `path`: it becomes a PNG.
    ///
    /// # Errors
    /// [`Error::File`] for another extension.
    pub fn check_output(path: &Path) -> Result<()> {
        match path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
            true => Ok(()),
            false => Err(Error::file(path, "a picture is a PNG file", "give a name that ends in .png")),
        }
    }

    /// Writes it as a PNG that appears when it is complete.
    ///
    /// # Errors
    /// As [`Picture::check_output`]; [`Error::Io`].
    pub fn write(&self, path: impl AsRef<Path>) -> Result<()> {
        Self::check_output(path.as_ref())?;
        // Three codes of 8 bits, as they are.
        let mut file = create_normals(path.as_ref(), self.size, NormalFormat::default())?;
        file.write(0, CodesRef::U8(self.pixels.as_flattened()))?;
        file.finish()
    }
}

impl Picture {
    /// Writes it as [`Picture::write`] does, with at most `count` colours, from 1 to 256: a third of the bytes or less.
    ///
    /// # Errors
    /// As [`Picture::write`].
    pub fn write_in_colours(&self, path: impl AsRef<Path>, count: usize) -> Result<()> {
        let path = path.as_ref();
        Self::check_output(path)?;
        let (palette, index) = divided(&self.pixels, count);
        let indices: Vec<u8> = self.pixels.iter().map(|pixel| index[pixel]).collect();
        let file = Replacement::create(path)?;
        let [width, height] = [self.size.width(), self.size.height()].map(|side| side as u32);
        let mut encoder = png::Encoder::new(BufWriter::new(file.output()?), width, height);
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_palette(palette.as_flattened());
        encoder.set_compression(png::Compression::High);
        // Indices near each other are no colours near each other.
        encoder.set_filter(png::Filter::NoFilter);
        let encoded = encoder.write_header().and_then(|mut writer| {
            writer.write_image_data(&indices)?;
            writer.finish()
        });
        encoded.map_err(|error| Error::io(path)(error.into()))?;
        file.commit()
    }
}

/// The code of a linear component (IEC 61966-2-1).
fn to_srgb(linear: f32) -> u8 {
    let linear = f64::from(linear).clamp(0.0, 1.0);
    let encoded = if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055 };
    (255.0 * encoded).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_means_of_squares() {
        let samples: Vec<[f32; 1]> = (0..16).map(|i| [i as f32]).collect();
        let picture = Picture::of_means(&samples, 4, 2, |[mean]| [(2.0 * mean) as u8; 3]).unwrap();
        assert_eq!(picture.pixels(), [[5; 3], [9; 3], [21; 3], [25; 3]]);
    }

    #[test]
    fn srgb_is_the_standards() {
        assert_eq!([-1.0, 0.0, 0.001, 0.214_041_14, 1.0, 2.0].map(to_srgb), [0, 0, 3, 128, 255, 255]);
    }

    #[test]
    fn what_is_pasted_beyond_a_border_is_left_away() {
        let mut picture = Picture::filled([3, 2], [0; 3]).unwrap();
        picture.paste(&Picture::filled([2, 2], [9; 3]).unwrap(), [2, 1]);
        let nines: Vec<usize> = (0..6).filter(|i| picture.pixels()[*i] == [9; 3]).collect();
        assert_eq!(nines, [5]);
    }
}
