//! TGA, BMP, JPEG and WebP, and files that are no image.

use super::support::{Folder, Values, read_all_ways, read_error};
use texbake::io::ReadOptions;

fn default() -> ReadOptions {
    ReadOptions::default()
}

fn channel(name: &str) -> ReadOptions {
    ReadOptions { channel: Some(name.parse().unwrap()), ..default() }
}

/// An uncompressed TGA: type 3 is grey, 2 is colour; 0x20 in the descriptor means that rows stand from the top.
fn tga(kind: u8, width: u16, height: u16, bits: u8, descriptor: u8, rows: &[u8]) -> Vec<u8> {
    let mut file = vec![0, 0, kind, 0, 0, 0, 0, 0, 0, 0, 0, 0];
    file.extend(width.to_le_bytes());
    file.extend(height.to_le_bytes());
    file.extend([bits, descriptor]);
    file.extend(rows);
    file
}

/// An uncompressed 24-bit BMP, rows from the bottom, padded to four bytes.
fn bmp(width: i32, height: i32, rows: &[u8]) -> Vec<u8> {
    let mut file = b"BM".to_vec();
    for word in [54 + rows.len() as u32, 0, 54, 40, width as u32, height as u32, 1 | 24 << 16, 0, 0, 0, 0, 0, 0] {
        file.extend(word.to_le_bytes());
    }
    file.extend(rows);
    file
}

#[test]
fn tga_goes_by_its_extension() {
    let folder = Folder::new();
    let top = tga(3, 2, 2, 8, 0x20, &[1, 2, 3, 4]);
    assert_eq!(read_all_ways(&folder.file("a.tga", &top), &default()).unwrap(), Values::U8(vec![1, 2, 3, 4]));
    let bottom = tga(3, 2, 2, 8, 0, &[1, 2, 3, 4]);
    assert_eq!(read_all_ways(&folder.file("b.TGA", &bottom), &default()).unwrap(), Values::U8(vec![3, 4, 1, 2]));
    let colour = tga(2, 1, 1, 24, 0x20, &[30, 20, 10]);
    assert_eq!(read_all_ways(&folder.file("c.tga", &colour), &channel("r")).unwrap(), Values::U8(vec![10]));
    let message = read_error(&folder.file("d.dat", &top), &default());
    assert!(message.contains("this is no format that texbake knows; texbake reads PNG, TIFF, EXR"), "{message}");
    for length in [3, 17, 20] {
        let message = read_error(&folder.file("e.tga", &top[..length]), &default());
        assert!(message.contains("truncated"), "{length}: {message}");
    }
    let message = read_error(&folder.file("z.tga", &tga(3, 0, 2, 8, 0, &[])), &default());
    assert!(message.contains("0 x 2") || message.contains("damaged"), "{message}");
}

#[test]
fn bmp_reads_from_the_bottom() {
    let folder = Folder::new();
    let file = bmp(2, 2, &[3, 3, 3, 4, 4, 4, 0, 0, 1, 1, 1, 2, 2, 2, 0, 0]);
    // The content says what it is, whatever the name.
    let path = folder.file("b.png", &file);
    assert_eq!(read_all_ways(&path, &default()).unwrap(), Values::U8(vec![1, 2, 3, 4]));
    for length in [20, 60, file.len() - 1] {
        let message = read_error(&folder.file("c.bmp", &file[..length]), &default());
        assert!(message.contains("truncated") || message.contains("damaged"), "{length}: {message}");
    }
    let message = read_error(&folder.file("h.bmp", &bmp(60000, 60000, &[])), &default());
    assert!(message.contains("the header claims 60000 x 60000 texels"), "{message}");
}

#[test]
fn webp_without_loss() {
    let folder = Folder::new();
    let rows: Vec<u8> = (0..48).flat_map(|i| [i * 5; 3]).collect();
    let mut file = Vec::new();
    let encoder = image::codecs::webp::WebPEncoder::new_lossless(&mut file);
    encoder.encode(&rows, 8, 6, image::ExtendedColorType::Rgb8).unwrap();
    let path = folder.file("w.webp", &file);
    let expected = (0..48).map(|i| i * 5).collect();
    assert_eq!(read_all_ways(&path, &default()).unwrap(), Values::U8(expected));
    for length in [13, 20, file.len() / 2] {
        let message = read_error(&folder.file("c.webp", &file[..length]), &default());
        assert!(message.contains("truncated") || message.contains("damaged"), "{length}: {message}");
    }
}

#[test]
fn jpeg_grey_is_flat_where_the_picture_is() {
    let folder = Folder::new();
    let mut file = Vec::new();
    let encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(&mut file, 100);
    // One grey per 8 x 8 block is coded by its mean alone, which quality 100 keeps.
    let rows: Vec<u8> = (0..16 * 8).map(|i| if i % 16 < 8 { 40 } else { 200 }).collect();
    { encoder }.encode(&rows, 16, 8, image::ExtendedColorType::L8).unwrap();
    let path = folder.file("j.jpg", &file);
    assert_eq!(read_all_ways(&path, &default()).unwrap(), Values::U8(rows));
    for length in [3, 20, file.len() - 2] {
        let message = read_error(&folder.file("c.jpg", &file[..length]), &default());
        assert!(message.contains("truncated"), "{length}: {message}");
    }
}

#[test]
fn text_is_no_image() {
    let folder = Folder::new();
    let message = read_error(&folder.file("t.png", b"hello"), &default());
    assert!(message.contains("this is no format that texbake knows"), "{message}");
    let message = read_error(&folder.file("u.tga", b"hello"), &default());
    assert!(message.contains("truncated"), "{message}");
    std::fs::create_dir(folder.path("d.png")).unwrap();
    assert!(read_error(&folder.path("d.png"), &default()).contains("directory"));
}

#[cfg(unix)]
#[test]
fn a_long_file_is_not_read_for_its_length() {
    let folder = Folder::new();
    let lengthen = |path: &std::path::Path| {
        std::fs::File::options().write(true).open(path).unwrap().set_len(1 << 40).unwrap();
    };
    // A sparse tebibyte, of which the header describes 16 bytes.
    let path = folder.file("b.bmp", &bmp(2, 2, &[3, 3, 3, 4, 4, 4, 0, 0, 1, 1, 1, 2, 2, 2, 0, 0]));
    lengthen(&path);
    assert_eq!(read_all_ways(&path, &default()).unwrap(), Values::U8(vec![1, 2, 3, 4]));
    let path = folder.file("t.tga", &tga(3, 2, 2, 8, 0x20, &[1, 2, 3, 4]));
    lengthen(&path);
    assert_eq!(read_all_ways(&path, &default()).unwrap(), Values::U8(vec![1, 2, 3, 4]));
    for (name, first) in [("j.jpg", b"\xff\xd8\xff\xe0".as_slice()), ("w.webp", b"RIFF\0\0\0\0WEBP")] {
        let path = folder.file(name, first);
        lengthen(&path);
        let message = read_error(&path, &default());
        assert!(message.contains("its 1099511627776 bytes, above the limit of 4294967296; raise it"), "{message}");
    }
}
