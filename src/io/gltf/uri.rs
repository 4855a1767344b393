//! URIs of the files that belong to a model.

use base64::Engine;
use base64::engine::general_purpose::{GeneralPurpose, GeneralPurposeConfig};
use base64::engine::{DecodePaddingMode, general_purpose::STANDARD};
use std::path::{Component, Path, PathBuf};

/// What a URI stands for.
#[derive(Debug, PartialEq, Eq)]
pub(in crate::io) enum Uri {
    /// The bytes themselves; `None` if they are not base64.
    Data(Option<Vec<u8>>),
    /// A path in the model's folder that does not leave it.
    Relative(PathBuf),
    /// Anything else: a scheme, an absolute path, a path that leaves the folder.
    Other,
}

impl Uri {
    pub fn of(uri: &str) -> Self {
        if let Some(data) = uri.strip_prefix("data:") {
            return Self::Data(data.split_once(";base64,").and_then(|(_, text)| decode(text)));
        }
        let path = percent_decoded(uri).map(PathBuf::from);
        match path {
            // A colon in the first part ends a scheme, or a drive's letter; a backslash is a separator on some systems.
            Some(path) if !uri.is_empty() && stays_inside(&path) && !has_scheme(uri) => {
                // One file has one path: without `./`.
                Self::Relative(path.components().filter(|part| *part != Component::CurDir).collect())
            }
            _ => Self::Other,
        }
    }
}

/// Whether a URI is the bytes themselves.
pub(super) fn is_data(uri: &str) -> bool {
    uri.starts_with("data:")
}

/// Whether a URI begins with a scheme, such as `https:`.
pub(super) fn has_scheme(uri: &str) -> bool {
    uri.split_once(':').is_some_and(|(scheme, _)| !scheme.contains('/'))
}

/// A relative path that may leave the model's folder upwards.
pub(super) fn upward(uri: &str) -> Option<PathBuf> {
    let path = PathBuf::from(percent_decoded(uri).filter(|_| !uri.is_empty() && !has_scheme(uri))?);
    let is_relative = path.components().all(|part| !matches!(part, Component::RootDir | Component::Prefix(_)));
    (is_relative && !path.to_string_lossy().contains(['\\', '\0', ':'])).then_some(path)
}

/// The file in the folder of `model`.
pub(super) fn file_of(model: &Path, relative: &Path) -> PathBuf {
    model.with_file_name(relative)
}

/// A data URI of these bytes.
pub(super) fn data_uri(bytes: &[u8]) -> String {
    format!("data:application/octet-stream;base64,{}", STANDARD.encode(bytes))
}

/// A relative path, with slashes, as a URI.
pub(in crate::io) fn of_path(path: &str) -> String {
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-._~/".contains(&byte);
    let encode = |byte: u8| if is_plain(byte) { char::from(byte).to_string() } else { format!("%{byte:02X}") };
    path.bytes().map(encode).collect()
}

fn decode(text: &str) -> Option<Vec<u8>> {
    let lenient = GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent);
    GeneralPurpose::new(&base64::alphabet::STANDARD, lenient).decode(text).ok()
}

fn stays_inside(path: &Path) -> bool {
    path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir))
        && !path.to_string_lossy().contains(['\\', '\0', ':'])
}

fn percent_decoded(uri: &str) -> Option<String> {
    let mut bytes = Vec::new();
    let mut rest = uri.as_bytes();
    while let Some((&byte, after)) = rest.split_first() {
        rest = after;
        if byte != b'%' {
            bytes.push(byte);
            continue;
        }
        let digits = rest.split_at_checked(2).and_then(|(digits, after)| {
            rest = after;
            std::str::from_utf8(digits).ok().filter(|digits| digits.bytes().all(|digit| digit.is_ascii_hexdigit()))
        })?;
        bytes.push(u8::from_str_radix(digits, 16).ok()?);
    }
    String::from_utf8(bytes).ok()
}

#[cfg(test)]
mod tests {
    use super::Uri;

    #[test]
    fn paths_that_leave_the_folder_are_none() {
        for uri in
            ["../a", "/a", "a/../../b", "..%2Fa", "%2Fa", "a%5C..%5Cb", "C:/a", "C%3A/a", "http://a/b", "", "%", "a%0"]
        {
            assert_eq!(Uri::of(uri), Uri::Other, "{uri}");
        }
        // Up and down again stays inside, but no exporter writes it.
        assert_eq!(Uri::of("a/../b"), Uri::Other);
        for (uri, path) in [("a.bin", "a.bin"), ("a%20b/c%C3%A9.bin", "a b/cé.bin"), ("./a", "a"), ("a..b", "a..b")] {
            assert_eq!(Uri::of(uri), Uri::Relative(path.into()), "{uri}");
        }
    }

    #[test]
    fn data_uris() {
        assert_eq!(Uri::of("data:application/octet-stream;base64,AAEC"), Uri::Data(Some(vec![0, 1, 2])));
        assert_eq!(Uri::of("data:;base64,AAE"), Uri::Data(Some(vec![0, 1])));
        assert_eq!(Uri::of("data:;base64,A*E"), Uri::Data(None));
        assert_eq!(Uri::of("data:text/plain,abc"), Uri::Data(None));
        assert_eq!(Uri::of(&super::data_uri(&[255, 0])), Uri::Data(Some(vec![255, 0])));
        assert_eq!(super::of_path("a b_é.bin"), "a%20b_%C3%A9.bin");
    }
}
