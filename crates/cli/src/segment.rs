//! How the hand is told from the rest of pictures, as options.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use clap::Args;
use image::{DynamicImage, RgbImage};
use phalanx::{Picture, Segment, Segmentation, Segmenter, photograph_from};
use phalanx_cli::reading;
use phalanx_segmentation::{Mask, PlainBackground, SceneModel, SkinModel};

use crate::mask::{NO_COLOUR, OFF_BLACK_AND_WHITE, given_mask, is_like_a_mask, is_without_colour};

#[derive(Args, Clone, Default)]
pub(crate) struct SegmentArguments {
    /// The pictures are masks: brighter than 127 is hand.
    #[arg(long)]
    pub(crate) mask: bool,
    /// How the hand is told from the rest: `skin` by its colour, `plain` before a plain bright background,
    /// `plain-dark` before a dark one, or as a FILE of `phalanx skin` says. By default by its colour; in a recording in
    /// which much of what stands still looks like skin, by what moves.
    #[arg(long, value_name = "skin|plain|plain-dark|FILE", conflicts_with = "mask")]
    pub(crate) segment: Option<PathBuf>,
}

/// What pictures are.
pub(crate) enum Pictures {
    /// Masks: brighter than 127 is hand.
    Masks,
    /// Photographs, in which the hand is found so; or, before the scenes of some cameras, as these tell.
    Photographs(Segmentation, BTreeMap<String, SceneModel>),
}

/// A picture that an estimator can be asked about.
pub(crate) enum Prepared<'a> {
    Mask(Mask),
    Photograph(RgbImage, &'a Segmenter),
}

impl SegmentArguments {
    pub(crate) fn pictures(&self) -> Result<Pictures> {
        if self.mask {
            return Ok(Pictures::Masks);
        }
        let shared = match self.segment.as_deref().map_or(Some("skin"), Path::to_str) {
            Some("skin") => Segmenter::Skin(SkinModel::builtin()),
            Some("plain") => Segmenter::PlainBackground(PlainBackground::Bright),
            Some("plain-dark") => Segmenter::PlainBackground(PlainBackground::Dark),
            _ => return Ok(Pictures::Photographs(self.file()?, BTreeMap::new())),
        };
        Ok(Pictures::Photographs(Segmentation::Shared(shared), BTreeMap::new()))
    }

    /// The file that says how, if it is one that does.
    pub(crate) fn path(&self) -> Option<&PathBuf> {
        self.segment.as_ref()
    }

    fn file(&self) -> Result<Segmentation> {
        let path = self.segment.as_deref().unwrap_or(Path::new(""));
        let name = || format!("{} (--segment)", path.display());
        Segmentation::from_bytes(&reading::read(path).with_context(name)?).with_context(name)
    }

    /// The options as they are given on the command line, to be given again.
    pub(crate) fn given(&self) -> String {
        let mask = if self.mask { " --mask" } else { "" };
        let segment =
            self.segment.as_ref().map(|segment| format!(" --segment {}", segment.display()));
        mask.to_owned() + &segment.unwrap_or_default()
    }
}

impl Pictures {
    /// The mask of a camera's picture.
    ///
    /// # Errors
    /// A photograph that is given as a mask, or the reverse.
    pub(crate) fn mask(&self, camera: &str, picture: &DynamicImage) -> Result<Mask> {
        match self {
            Self::Masks => given_mask(picture).context("photographs go without --mask"),
            Self::Photographs(segmentation, scenes) => {
                let segmenter = segmentation.of_camera(camera)?;
                let photograph = photograph(picture, segmenter)?;
                let scene = scenes.get(camera).map(|scene| scene.segment(&photograph));
                Ok(scene.unwrap_or_else(|| segmenter.segment(&photograph))?)
            }
        }
    }

    /// A camera's picture for the estimator. A recorded background has the size of the picture, at which
    /// the hand is therefore found here.
    pub(crate) fn prepared(&self, camera: &str, picture: &DynamicImage) -> Result<Prepared<'_>> {
        let named = || format!("camera '{camera}'");
        if let Self::Photographs(segmentation, _) = self {
            let segmenter = segmentation.of_camera(camera)?;
            if !matches!(segmenter, Segmenter::Background(_)) {
                let photograph = photograph(picture, segmenter).with_context(named)?;
                return Ok(Prepared::Photograph(photograph, segmenter));
            }
        }
        self.mask(camera, picture).with_context(named).map(Prepared::Mask)
    }
}

/// A picture in which the hand is looked for in this way.
///
/// # Errors
/// A picture that is a mask, or one without colour in which skin is looked for.
fn photograph(picture: &DynamicImage, segmenter: &Segmenter) -> Result<RgbImage> {
    let photograph = photograph_from(picture);
    // A picture without colour shows no skin, so that nothing useful is refused. Before a plain background a
    // bright hand may be nearly white.
    let off = if matches!(segmenter, Segmenter::Skin(_)) { OFF_BLACK_AND_WHITE } else { 0 };
    ensure!(
        !is_like_a_mask(&photograph, off),
        "it is black and white, as masks are: for masks, give --mask"
    );
    let is_useless = matches!(segmenter, Segmenter::Skin(_)) && is_without_colour(&photograph);
    ensure!(!is_useless, NO_COLOUR);
    Ok(photograph)
}

impl Prepared<'_> {
    pub(crate) fn as_picture(&self) -> Picture<'_> {
        match self {
            Self::Mask(mask) => Picture::Mask(mask),
            Self::Photograph(photograph, segmenter) => Picture::Photograph(photograph, *segmenter),
        }
    }
}
