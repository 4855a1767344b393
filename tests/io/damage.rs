//! Damaged files of every format: an answer or a reason, never a panic.

use super::samples::{height_maps, normal_maps, raw_maps};
use super::support::{Folder, Noise};
use std::panic::RefUnwindSafe;
use std::path::{Path, PathBuf};
use texbake::io::{NormalReadOptions, ReadOptions};
use texbake::{Baker, BlendInputs, BlendMethod, BlendOptions, Codes, Error, HeightMap, NormalFormat, NormalMap};

/// A variant of a file: bytes replaced, mostly in its first part, where sizes and offsets stand; now and then cut, or
/// longer.
pub fn variant(whole: &[u8], noise: &mut Noise) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    let edits = 1 + noise.next() % 4;
    for _ in 0..edits {
        let reach = if noise.next().is_multiple_of(3) { bytes.len() } else { bytes.len().min(400) };
        let at = noise.next() as usize % reach;
        bytes[at] = match noise.next() % 4 {
            0 => 0,
            1 => 0xff,
            2 => bytes[at] ^ 1 << (noise.next() % 8),
            _ => noise.next() as u8,
        };
    }
    match noise.next() % 16 {
        0 | 1 => bytes.truncate(noise.next() as usize % bytes.len()),
        2 => bytes.extend((0..noise.next() % 64).map(|i| i as u8)),
        _ => (),
    }
    bytes
}

/// Variants per file; more are tried with TEXBAKE_DAMAGE=n.
pub fn variants() -> u32 {
    std::env::var("TEXBAKE_DAMAGE").ok().and_then(|count| count.parse().ok()).unwrap_or(1000)
}

/// Small enough that a file that claims more is refused, not tried.
pub const MAX_BYTES: u64 = 64 << 20;

#[test]
fn damaged_height_maps_never_panic() {
    let folder = Folder::new();
    let options = ReadOptions { max_bytes: MAX_BYTES, channel: Some("r".parse().unwrap()), ..Default::default() };
    for path in height_maps(&folder) {
        // The one EXR of which no channel is red, green or blue is read as it is found.
        let is_layered = path.ends_with("layers.exr");
        let options = if is_layered { ReadOptions { channel: None, ..options.clone() } } else { options.clone() };
        assert_no_panic(&[path], |path| HeightMap::read_with(path, &options).map(|_| ()));
    }
}

#[test]
fn damaged_normal_maps_never_panic() {
    let folder = Folder::new();
    let options = NormalReadOptions { max_bytes: MAX_BYTES, ..Default::default() };
    assert_no_panic(&normal_maps(&folder), |path| NormalMap::read_with(path, &options).map(|_| ()));
}

#[test]
fn headerless_files_of_a_wrong_size_never_panic() {
    let folder = Folder::new();
    for (layout, path) in raw_maps(&folder) {
        let raw = Some(layout.parse().unwrap());
        let options = ReadOptions { raw, max_bytes: MAX_BYTES, ..Default::default() };
        assert_no_panic(&[path], |path| HeightMap::read_with(path, &options).map(|_| ()));
    }
}

/// A mask goes all the way: it is read, rounded if it holds floats, and blended with.
#[test]
fn damaged_masks_never_panic() {
    let folder = Folder::new();
    let options = ReadOptions { max_bytes: MAX_BYTES, ..Default::default() };
    let is_mask = |path: &PathBuf| HeightMap::read_with(path, &options).is_ok();
    let masks: Vec<PathBuf> = height_maps(&folder).into_iter().filter(is_mask).collect();
    assert!(masks.len() > 10, "{masks:?}");
    assert_no_panic(&masks, |path| {
        let (mask, _) = HeightMap::read_with(path, &options)?;
        let size = mask.size();
        let flat = Codes::U8([128, 128, 255].repeat(size.texels()));
        let map = NormalMap::new(size, NormalFormat::default(), flat)?;
        let inputs = BlendInputs { base: &map, detail: &map, mask: Some(&mask) };
        let options = BlendOptions { method: BlendMethod::Masked, ..BlendOptions::default() };
        Baker::cpu().blend(&inputs, &options).map(|_| ())
    });
}

/// Reads variants of each file, of which some must be refused.
#[track_caller]
pub fn assert_no_panic(samples: &[PathBuf], read_file: impl Fn(&Path) -> Result<(), Error> + RefUnwindSafe) {
    for path in samples {
        let (read, refused) = read_variants(path, &read_file);
        assert!(refused > 0, "{}: {read} variants read, none was refused", path.display());
    }
}

/// Reads variants of a file: how many were read, and how many refused with a reason.
#[track_caller]
pub fn read_variants(path: &Path, read_file: impl Fn(&Path) -> Result<(), Error> + RefUnwindSafe) -> (u32, u32) {
    let whole = std::fs::read(path).unwrap();
    read_file(path).expect("undamaged, the file reads");
    let seed = whole.len() as u64;
    let mut noise = Noise(seed);
    let (mut read, mut refused) = (0, 0);
    for number in 0..variants() {
        let bytes = variant(&whole, &mut noise);
        // A file that is cut and written again goes to the disk at once; a new one does not.
        std::fs::remove_file(path).unwrap();
        std::fs::write(path, &bytes).unwrap();
        match std::panic::catch_unwind(|| read_file(path)) {
            Ok(Ok(())) => read += 1,
            Ok(Err(error)) => {
                assert!(!error.to_string().is_empty());
                refused += 1;
            }
            Err(_) => {
                let kept = std::env::temp_dir().join(path.file_name().unwrap());
                std::fs::write(&kept, &bytes).unwrap();
                panic!("variant {number} of {}, seed {seed}, panicked; it is {}", path.display(), kept.display());
            }
        }
    }
    std::fs::write(path, whole).unwrap();
    (read, refused)
}
