//! A skin model as a short text that names its source: parameters, then the non-empty bins.

use std::fmt::Write;
use std::str::FromStr;

use crate::error::{Error, Result};
use crate::masking::skin::{SkinModel, SkinParams, SkinParts};

const MAGIC: &str = "phalanx skin model 1";

impl SkinModel {
    /// The model as bytes: a first line with the format's version, the source, the parameters, and
    /// one line `cb cr skin non-skin` for each bin that is not empty, in order. The bytes are UTF-8
    /// text, and equal models give equal bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let SkinParts { source, params, skin, non_skin } = self.parts();
        let SkinParams { bits, smoothing, prior } = params;
        let mut text = format!(
            "{MAGIC}\nsource {source}\nbits {bits}\nsmoothing {smoothing}\nprior {prior}\n"
        );
        for (bin, (s, n)) in
            skin.iter().zip(non_skin).enumerate().filter(|(_, (s, n))| **s > 0 || **n > 0)
        {
            let (cb, cr) = (bin / params.side(), bin % params.side());
            writeln!(text, "{cb} {cr} {s} {n}").expect("writing to a string does not fail");
        }
        text.into_bytes()
    }

    /// Reads what [`SkinModel::to_bytes`] wrote; anything else is an error that names the line.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        let text = std::str::from_utf8(bytes)
            .map_err(|_| Error::Model { line: 1, reason: "the text is not UTF-8" })?;
        let mut lines = Lines { lines: text.lines(), line: 0 };
        if lines.next() != Some(MAGIC) {
            return Err(lines.error("the first line must be `phalanx skin model 1`"));
        }
        let source = lines.field("source ")?.to_owned();
        let params = SkinParams {
            bits: lines.number("bits ")?,
            smoothing: lines.number("smoothing ")?,
            prior: lines.number("prior ")?,
        };
        params.check()?;
        let bins = params.side().pow(2);
        let mut parts = SkinParts { source, params, skin: vec![0; bins], non_skin: vec![0; bins] };
        let mut first_free = 0;
        while let Some(row) = lines.next() {
            let [cb, cr, skin, non_skin] =
                numbers(row).ok_or_else(|| lines.error("expected four whole numbers"))?;
            if cb.max(cr) as usize >= params.side() {
                return Err(lines.error("the bin is outside the histogram"));
            }
            let bin = cb as usize * params.side() + cr as usize;
            if bin < first_free {
                return Err(lines.error("the bins are not in order"));
            }
            (parts.skin[bin], parts.non_skin[bin]) = (skin, non_skin);
            first_free = bin + 1;
        }
        Self::from_parts(parts)
    }
}

fn numbers(row: &str) -> Option<[u32; 4]> {
    let mut words = row.split(' ').map(u32::from_str);
    let mut next = || words.next()?.ok();
    let row = [next()?, next()?, next()?, next()?];
    words.next().is_none().then_some(row)
}

/// The lines of a text, counted.
struct Lines<'a> {
    lines: std::str::Lines<'a>,
    line: usize,
}

impl<'a> Lines<'a> {
    fn next(&mut self) -> Option<&'a str> {
        self.line += 1;
        self.lines.next()
    }

    fn field(&mut self, name: &'static str) -> Result<&'a str> {
        let line = self.next().and_then(|line| line.strip_prefix(name));
        line.ok_or_else(|| self.error("expected source, bits, smoothing and prior, a line each"))
    }

    fn number<T: FromStr>(&mut self, name: &'static str) -> Result<T> {
        let word = self.field(name)?;
        word.parse().map_err(|_| self.error("not a number in range"))
    }

    fn error(&self, reason: &'static str) -> Error {
        Error::Model { line: self.line, reason }
    }
}
