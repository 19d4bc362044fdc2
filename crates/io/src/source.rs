//! Files as they come: bytes with a name, made text.

/// A file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Source<'a> {
    /// Its name, without folders: cameras of files that hold one are called by it.
    pub name: &'a str,
    /// What it holds.
    pub bytes: &'a [u8],
}

impl Source<'_> {
    /// The name without its extensions.
    pub(crate) fn stem(&self) -> &str {
        self.name.split('.').find(|part| !part.is_empty()).unwrap_or(self.name)
    }

    /// The text in UTF-8 or UTF-16, without a byte-order mark; `None` of what is none.
    pub(crate) fn decoded(&self) -> Option<String> {
        match self.bytes {
            [0xff, 0xfe, rest @ ..] => utf16(rest, u16::from_le_bytes),
            [0xfe, 0xff, rest @ ..] => utf16(rest, u16::from_be_bytes),
            [0xef, 0xbb, 0xbf, rest @ ..] => std::str::from_utf8(rest).ok().map(str::to_owned),
            bytes => std::str::from_utf8(bytes).ok().map(str::to_owned),
        }
    }
}

fn utf16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> Option<String> {
    let (pairs, rest) = bytes.as_chunks::<2>();
    let units = pairs.iter().map(|pair| unit(*pair));
    let text = char::decode_utf16(units).collect::<std::result::Result<String, _>>().ok();
    text.filter(|_| rest.is_empty())
}
