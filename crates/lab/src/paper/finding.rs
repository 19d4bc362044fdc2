//! What an experiment found, in a form that both a terminal and a page can show.

use std::fmt::Display;

use comfy_table::presets;
use image::{ImageFormat, RgbImage};

use anyhow::Result;

use crate::figures::chart::{CellMap, Chart};

/// One experiment's result.
pub(crate) struct Finding {
    pub(crate) verdict: Verdict,
    /// The verdict's reason: one sentence with the figures that decided.
    pub(crate) sentence: String,
    /// What else a reader should know; causes, where we contradict the paper.
    pub(crate) notes: Vec<String>,
    pub(crate) tables: Vec<Table>,
    pub(crate) figures: Vec<Figure>,
    /// The figures of the tables, unrounded.
    pub(crate) json: serde_json::Value,
}

/// Whether what the paper claims holds here.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Verdict {
    Holds,
    HoldsInPart,
    DoesNotHold,
}

impl Verdict {
    /// Of several claims of which some hold.
    pub(crate) fn of(claims: &[bool]) -> Self {
        match claims.iter().filter(|holds| **holds).count() {
            0 => Self::DoesNotHold,
            some if some < claims.len() => Self::HoldsInPart,
            _ => Self::Holds,
        }
    }

    pub(crate) fn words(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::HoldsInPart => "holds in part",
            Self::DoesNotHold => "does not hold",
        }
    }
}

/// Figures in rows, with a caption.
pub(crate) struct Table {
    pub(crate) caption: String,
    pub(crate) header: Vec<String>,
    pub(crate) rows: Vec<Vec<String>>,
}

impl Table {
    pub(crate) fn new<H: Display>(
        caption: impl Display,
        header: impl IntoIterator<Item = H>,
    ) -> Self {
        let header = header.into_iter().map(|cell| cell.to_string()).collect();
        Self { caption: caption.to_string(), header, rows: Vec::new() }
    }

    pub(crate) fn row<C: Display>(&mut self, cells: impl IntoIterator<Item = C>) {
        self.rows.push(cells.into_iter().map(|cell| cell.to_string()).collect());
    }

    pub(crate) fn markdown(&self) -> String {
        let mut table = comfy_table::Table::new();
        table.load_style(presets::ASCII_MARKDOWN).set_header(&self.header);
        table.add_rows(&self.rows);
        format!("{}\n\n{table}\n", self.caption)
    }
}

/// A picture with its caption.
pub(crate) struct Figure {
    pub(crate) caption: String,
    /// What is drawn, for those who cannot see it.
    pub(crate) alternative: String,
    pub(crate) content: Content,
}

pub(crate) enum Content {
    Svg(String),
    Png(Vec<u8>),
}

impl Figure {
    pub(crate) fn chart(caption: impl Display, chart: &Chart) -> Result<Self> {
        Ok(Self::new(caption, chart.words(), Content::Svg(chart.svg()?)))
    }

    pub(crate) fn cells(caption: impl Display, cells: &CellMap) -> Result<Self> {
        Ok(Self::new(caption, cells.words(), Content::Svg(cells.svg()?)))
    }

    pub(crate) fn svg(caption: impl Display, words: impl Display, svg: String) -> Self {
        Self::new(caption, words.to_string(), Content::Svg(svg))
    }

    pub(crate) fn picture(caption: impl Display, picture: &RgbImage) -> Result<Self> {
        let mut png = std::io::Cursor::new(Vec::new());
        picture.write_to(&mut png, ImageFormat::Png)?;
        let words = format!("a picture of {} × {} pixels", picture.width(), picture.height());
        Ok(Self::new(caption, words, Content::Png(png.into_inner())))
    }

    fn new(caption: impl Display, alternative: String, content: Content) -> Self {
        Self { caption: caption.to_string(), alternative, content }
    }

    /// The file's extension, its MIME type, and its bytes.
    pub(crate) fn file(&self) -> (&'static str, &'static str, &[u8]) {
        match &self.content {
            Content::Svg(svg) => ("svg", "image/svg+xml", svg.as_bytes()),
            Content::Png(png) => ("png", "image/png", png),
        }
    }
}
