//! Zip archives whose files are stored as they are, as NumPy's `savez` makes them.

use std::collections::BTreeMap;

use crc32fast::hash;

/// Marks of the three kinds of record (PKWARE's APPNOTE 4.3.7, 4.3.12 and 4.3.16).
const LOCAL: u32 = 0x0403_4b50;
const CENTRAL: u32 = 0x0201_4b50;
const END: u32 = 0x0605_4b50;
/// The length of the last record without its comment.
const END_LENGTH: usize = 22;
/// The version of the format that stored files need.
const VERSION: u16 = 20;
/// 1 January 1980: no clock goes into the bytes.
const DATE: u16 = 0x21;

/// Joins files into an archive; `None` if it passes the format's 4 GiB.
pub(super) fn archive(files: &[(String, Vec<u8>)]) -> Option<Vec<u8>> {
    let (mut bytes, mut directory) = (Vec::new(), Vec::new());
    for (name, content) in files {
        let offset = u32::try_from(bytes.len()).ok()?;
        let size = u32::try_from(content.len()).ok()?;
        let mut common = shorts(&[VERSION, 0, 0, 0, DATE]);
        common.extend([hash(content), size, size].into_iter().flat_map(u32::to_le_bytes));
        common.extend(shorts(&[u16::try_from(name.len()).ok()?, 0]));
        bytes.extend(LOCAL.to_le_bytes());
        bytes.extend(&common);
        bytes.extend(name.as_bytes());
        bytes.extend(content);
        directory.extend(CENTRAL.to_le_bytes());
        directory.extend(VERSION.to_le_bytes());
        directory.extend(&common);
        // No comment, the first disk, no attributes.
        directory.extend([0; 10]);
        directory.extend(offset.to_le_bytes());
        directory.extend(name.as_bytes());
    }
    let count = u16::try_from(files.len()).ok()?;
    let (start, length) = (u32::try_from(bytes.len()).ok()?, u32::try_from(directory.len()).ok()?);
    bytes.extend(directory);
    bytes.extend(END.to_le_bytes());
    bytes.extend(shorts(&[0, 0, count, count]));
    bytes.extend([length, start].into_iter().flat_map(u32::to_le_bytes));
    bytes.extend([0; 2]);
    Some(bytes)
}

fn shorts(fields: &[u16]) -> Vec<u8> {
    fields.iter().flat_map(|field| field.to_le_bytes()).collect()
}

/// The files of an archive by name.
pub(super) fn files(bytes: &[u8]) -> Result<BTreeMap<String, &[u8]>, String> {
    let last = bytes.len().checked_sub(END_LENGTH).ok_or("it is no zip archive")?;
    // A comment of up to 64 KiB may follow the last record.
    let first = last.saturating_sub(usize::from(u16::MAX));
    let end = (first..=last).rev().find(|&at| u32_at(bytes, at) == Some(END));
    let end = end.ok_or("it is no zip archive")?;
    let count = u16_at(bytes, end + 10).ok_or(CUT)?;
    let mut at = u32_at(bytes, end + 16).ok_or(CUT)? as usize;
    let mut files = BTreeMap::new();
    for _ in 0..count {
        let (name, content, next) = entry(bytes, at)?;
        if files.insert(name.clone(), content).is_some() {
            return Err(format!("it holds '{name}' twice"));
        }
        at = next;
    }
    Ok(files)
}

const CUT: &str = "it is cut short";

/// The file that a record of the directory names, and where the next record stands.
fn entry(bytes: &[u8], at: usize) -> Result<(String, &[u8], usize), String> {
    if u32_at(bytes, at) != Some(CENTRAL) {
        return Err("its directory is damaged".to_owned());
    }
    let field = |offset| u32_at(bytes, at + offset).map(|value| value as usize).ok_or(CUT);
    let short = |at| u16_at(bytes, at).map(usize::from).ok_or(CUT);
    let name_length = short(at + 28)?;
    let name = bytes.get(at + 46..at + 46 + name_length).ok_or(CUT)?;
    let name = String::from_utf8_lossy(name).into_owned();
    if short(at + 10)? != 0 {
        return Err(format!("'{name}' is compressed; save it uncompressed (numpy.savez)"));
    }
    let (checksum, size, local) = (field(16)?, field(20)?, field(42)?);
    let start = local + 30 + short(local + 26)? + short(local + 28)?;
    let content = bytes.get(start..start + size).ok_or(CUT)?;
    if hash(content) as usize != checksum {
        return Err(format!("'{name}' is damaged: its checksum is wrong"));
    }
    let next = at + 46 + name_length + short(at + 30)? + short(at + 32)?;
    Ok((name, content, next))
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    bytes.get(at..)?.first_chunk().map(|chunk| u16::from_le_bytes(*chunk))
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..)?.first_chunk().map(|chunk| u32::from_le_bytes(*chunk))
}
