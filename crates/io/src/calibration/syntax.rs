//! Which syntax a text has, by its first line that says something.

use crate::error::{Error, Result};

/// How a calibration is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Syntax {
    Json,
    Toml,
    Yaml,
    Xml,
    ColmapCameras,
    ColmapImages,
    Biocv,
}

impl Syntax {
    pub(super) fn of(text: &str) -> Result<Self> {
        let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
        let mut said = lines.by_ref().filter(|line| !line.starts_with('#'));
        let unknown = || {
            Error::calibration(
                "it is not recognised: TOML, YAML, XML or JSON of a calibration, COLMAP's text, and \
                 bioCV's .calib are read",
            )
        };
        let first = said.next().ok_or_else(unknown)?;
        let words: Vec<&str> = first.split_whitespace().collect();
        let is_number = |word: &&str| word.parse::<f64>().is_ok();
        let is_count = |word: &&str| word.parse::<u32>().is_ok();
        match words[..] {
            _ if first.starts_with('<') => Ok(Self::Xml),
            _ if first.starts_with('{') => Ok(Self::Json),
            _ if first.starts_with('[') => Ok(list_or_section(first)),
            _ if first.starts_with('%') || first.starts_with("---") => Ok(Self::Yaml),
            [id, model, width, height, _, ..]
                if [id, width, height].iter().all(is_count)
                    && model.starts_with(|c: char| c.is_ascii_uppercase()) =>
            {
                Ok(Self::ColmapCameras)
            }
            [_, _, _, _, _, _, _, _, _, _, ..] if words[..9].iter().all(is_number) => {
                Ok(Self::ColmapImages)
            }
            [width] if is_count(&width) && said.next().is_some_and(|line| is_count(&line)) => {
                Ok(Self::Biocv)
            }
            _ => match first.find(['=', ':']) {
                Some(at) if first[at..].starts_with('=') => Ok(Self::Toml),
                Some(_) => Ok(Self::Yaml),
                None => Err(unknown()),
            },
        }
    }
}

/// A first line with a bracket: a section of TOML, or a list of JSON.
fn list_or_section(line: &str) -> Syntax {
    let name = line.trim_start_matches('[');
    let is_name = |c: char| c.is_alphanumeric() || matches!(c, '_' | '-' | '.' | '"' | '\'' | ' ');
    match name.split_once(']') {
        Some((name, _)) if !name.trim().is_empty() && name.chars().all(is_name) => Syntax::Toml,
        _ => Syntax::Json,
    }
}
