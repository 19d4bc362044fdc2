//! NumPy's array files (NEP 1, format 1.0): little endian, row by row.

use std::fmt::Write as _;

/// The first bytes of a file of format 1.0.
const MAGIC: &[u8; 8] = b"\x93NUMPY\x01\x00";
/// The header's end and the array's beginning stand at a multiple of this.
const ALIGNMENT: usize = 64;

/// An array of one of the kinds that are read; those of four bytes are held as of eight.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Array {
    /// The extent of each axis, the last running fastest.
    pub(crate) shape: Vec<usize>,
    /// As many entries as the shape says.
    pub(crate) data: Data,
}

/// The entries of an array.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Data {
    Real(Vec<f64>),
    Integer(Vec<i64>),
    Flag(Vec<bool>),
    Text(Vec<String>),
}

impl Array {
    /// A list.
    pub(crate) fn list(data: Data) -> Self {
        Self { shape: vec![data.len()], data }
    }

    /// The array as a `.npy` file.
    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        let mut shape = String::new();
        for extent in &self.shape {
            write!(shape, "{extent},").expect("writing to a string");
        }
        let descr = self.data.descr();
        let mut header =
            format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({shape}), }}");
        let unpadded = MAGIC.len() + 2 + header.len() + 1;
        let padding = unpadded.next_multiple_of(ALIGNMENT) - unpadded;
        header.extend(std::iter::repeat_n(' ', padding));
        header.push('\n');
        let mut bytes = MAGIC.to_vec();
        // The shapes written here have at most three axes.
        bytes.extend(u16::try_from(header.len()).expect("a short header").to_le_bytes());
        bytes.extend(header.as_bytes());
        self.data.write(&mut bytes);
        bytes
    }

    /// Reads a `.npy` file of one of the kinds.
    pub(crate) fn from_bytes(bytes: &[u8]) -> Result<Self, String> {
        let rest = bytes.strip_prefix(MAGIC).ok_or("it is no NumPy array of format 1.0")?;
        let (length, rest) = rest.split_first_chunk().ok_or("it is cut short")?;
        let length = usize::from(u16::from_le_bytes(*length));
        let (header, rest) = rest.split_at_checked(length).ok_or("its header is cut short")?;
        let header = std::str::from_utf8(header).map_err(|_| "its header is no text")?;
        if !header.contains("'fortran_order': False") {
            return Err("it stands column by column; save it row by row (C order)".to_owned());
        }
        let descr = between(header, "'descr': '", "'").ok_or("its header names no kind")?;
        let shape = between(header, "'shape': (", ")").ok_or("its header names no shape")?;
        let extents = shape.split(',').map(str::trim).filter(|extent| !extent.is_empty());
        let shape: Vec<usize> = extents
            .map(|extent| extent.parse().map_err(|_| format!("its shape is ({shape})")))
            .collect::<Result<_, _>>()?;
        let count = shape.iter().try_fold(1, |count: usize, &extent| count.checked_mul(extent));
        let count = count.ok_or("its shape is too large")?;
        Ok(Self { data: Data::read(descr, count, rest)?, shape })
    }
}

fn between<'a>(text: &'a str, start: &str, end: &str) -> Option<&'a str> {
    let (_, rest) = text.split_once(start)?;
    rest.split_once(end).map(|(inner, _)| inner)
}

impl Data {
    fn len(&self) -> usize {
        match self {
            Self::Real(values) => values.len(),
            Self::Integer(values) => values.len(),
            Self::Flag(values) => values.len(),
            Self::Text(values) => values.len(),
        }
    }

    /// NumPy's name of the kind.
    fn descr(&self) -> String {
        match self {
            Self::Real(_) => "<f8".to_owned(),
            Self::Integer(_) => "<i8".to_owned(),
            Self::Flag(_) => "|b1".to_owned(),
            Self::Text(texts) => format!("<U{}", longest(texts)),
        }
    }

    fn write(&self, bytes: &mut Vec<u8>) {
        match self {
            Self::Real(values) => bytes.extend(values.iter().flat_map(|value| value.to_le_bytes())),
            Self::Integer(values) => {
                bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
            }
            Self::Flag(values) => bytes.extend(values.iter().map(|&value| u8::from(value))),
            Self::Text(texts) => {
                let width = longest(texts);
                for text in texts {
                    let letters = text.chars().map(u32::from).chain(std::iter::repeat(0));
                    bytes.extend(letters.take(width).flat_map(u32::to_le_bytes));
                }
            }
        }
    }

    fn read(descr: &str, count: usize, bytes: &[u8]) -> Result<Self, String> {
        let width = descr.strip_prefix("<U").and_then(|width| width.parse::<usize>().ok());
        let size = match (descr, width) {
            ("<f8" | "<i8", _) => Some(8),
            ("<f4", _) => Some(4),
            ("|b1", _) => Some(1),
            (_, Some(width)) => width.checked_mul(4),
            _ => return Err(format!("its kind '{descr}' is none of <f8, <f4, <i8, |b1 and <U")),
        };
        let expected = size.and_then(|size| size.checked_mul(count));
        if expected != Some(bytes.len()) {
            return Err(format!("it holds {} bytes, not {count} entries {descr}", bytes.len()));
        }
        Ok(match (descr, width) {
            ("<f8", _) => Self::Real(eights(bytes).map(f64::from_le_bytes).collect()),
            ("<f4", _) => {
                Self::Real(fours(bytes).map(|own| f32::from_le_bytes(own).into()).collect())
            }
            ("<i8", _) => Self::Integer(eights(bytes).map(i64::from_le_bytes).collect()),
            (_, None) => Self::Flag(bytes.iter().map(|&byte| byte != 0).collect()),
            // Entries without a letter take no byte.
            (_, Some(0)) => Self::Text(vec![String::new(); count.min(MOST_EMPTY)]),
            (_, Some(width)) => Self::Text(bytes.chunks(4 * width).map(text).collect()),
        })
    }
}

/// More empty texts are in no take.
const MOST_EMPTY: usize = 1 << 16;

fn eights(bytes: &[u8]) -> impl Iterator<Item = [u8; 8]> {
    let (chunks, _) = bytes.as_chunks();
    chunks.iter().copied()
}

fn fours(bytes: &[u8]) -> impl Iterator<Item = [u8; 4]> {
    let (chunks, _) = bytes.as_chunks();
    chunks.iter().copied()
}

/// Letters of four bytes each, up to the first that is 0.
fn text(letters: &[u8]) -> String {
    let (letters, _) = letters.as_chunks();
    let letters = letters.iter().map(|&letter| u32::from_le_bytes(letter));
    letters
        .take_while(|&letter| letter != 0)
        .map(|letter| char::from_u32(letter).unwrap_or(char::REPLACEMENT_CHARACTER))
        .collect()
}

fn longest(texts: &[String]) -> usize {
    texts.iter().map(|text| text.chars().count()).max().unwrap_or(0).max(1)
}
