//! Headerless files.

use super::support::{Folder, Values, read_all_ways, read_error};
use texbake::io::{RawLayout, ReadOptions};

fn raw(layout: &str) -> ReadOptions {
    ReadOptions { raw: Some(layout.parse().unwrap()), ..Default::default() }
}

#[test]
fn every_type_reads_its_own_bytes() {
    let folder = Folder::new();
    let bytes = folder.file("a.raw", &[0, 1, 2, 3, 254, 255]);
    assert_eq!(read_all_ways(&bytes, &raw("2x3:u8")).unwrap(), Values::U8(vec![0, 1, 2, 3, 254, 255]));

    let words = folder.file("b.raw", &[0x01, 0x02, 0xff, 0x00, 0x00, 0x80, 0xff, 0xff]);
    assert_eq!(read_all_ways(&words, &raw("2x2:u16le")).unwrap(), Values::U16(vec![0x0201, 0x00ff, 0x8000, 0xffff]));
    assert_eq!(read_all_ways(&words, &raw("2x2:u16be")).unwrap(), Values::U16(vec![0x0102, 0xff00, 0x0080, 0xffff]));

    let floats = folder.file("c.raw", &[0x00, 0x00, 0xc0, 0x3f, 0x00, 0x00, 0x20, 0xc1]);
    assert_eq!(read_all_ways(&floats, &raw("1x2:f32le")).unwrap(), Values::F32(vec![1.5, -10.0]));
    let floats = folder.file("d.raw", &[0x3f, 0xc0, 0x00, 0x00, 0xc1, 0x20, 0x00, 0x00]);
    assert_eq!(read_all_ways(&floats, &raw("2x1:f32be")).unwrap(), Values::F32(vec![1.5, -10.0]));
}

#[test]
fn a_length_that_differs_is_refused_with_both_lengths() {
    let folder = Folder::new();
    for length in [0, 17, 19] {
        let path = folder.file("t.r16", &vec![7; length]);
        let message = read_error(&path, &raw("3x3:u16le"));
        assert!(message.contains(&format!("it holds {length} bytes, and 3x3:u16le is 18 bytes")), "{message}");
    }
}

#[test]
fn heights_that_are_no_numbers_are_named_by_position() {
    let folder = Folder::new();
    let mut bytes: Vec<u8> = [0.0f32; 12].iter().flat_map(|h| h.to_le_bytes()).collect();
    bytes[4 * 7..4 * 8].copy_from_slice(&f32::INFINITY.to_le_bytes());
    let path = folder.file("t.raw", &bytes);
    let message = read_error(&path, &raw("3x4:f32le"));
    assert!(message.starts_with("the height at column 1, row 2 is inf"), "{message}");
}

#[test]
fn a_layout_is_a_size_and_a_type() {
    for text in ["1025x1025:u16le", "1x1:u8", "7x3:f32be", "2x9:u16be", "5x5:f32le"] {
        assert_eq!(text.parse::<RawLayout>().unwrap().to_string(), text);
    }
    for text in ["", "4x4", "4x4:u16", "4x-4:u8", "4x+4:u8", "x4:u8", "4:u8", "4x4:u8le", "4x4:U8", "0x4:u16"] {
        let message = text.parse::<RawLayout>().unwrap_err().to_string();
        assert!(message.starts_with(&format!("raw is {text}: it must be WIDTHxHEIGHT:TYPE")), "{message}");
    }
    for text in ["0x4:u8", "4x0:u8", "2147483648x1:f32le", "9999999999x1:u8", "1x99999999999999999999:u8"] {
        let message = text.parse::<RawLayout>().unwrap_err().to_string();
        let range = "at least 1x1 and at most 2147483647 texels on each side";
        assert_eq!(message, format!("raw is {text}: it must be {range}"));
    }
}
