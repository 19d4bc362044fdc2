//! What a camera gives.

use image::{GrayImage, RgbImage};
use phalanx_segmentation::{BackgroundModel, SkinModel, Wall};

use crate::error::Result;

/// One camera's picture of the hand.
#[derive(Debug, Clone, Copy)]
pub enum Picture<'a> {
    /// A colour photograph and how to find the hand in it.
    Photograph(&'a RgbImage, &'a Segmenter),
    /// A silhouette: over 127 is hand.
    Mask(&'a GrayImage),
}

impl Picture<'_> {
    /// Width and height, px.
    pub fn size(&self) -> (u32, u32) {
        match self {
            Self::Photograph(image, _) => image.dimensions(),
            Self::Mask(mask) => mask.dimensions(),
        }
    }

    /// The raw mask, as large as the picture.
    pub(crate) fn mask(&self) -> Result<GrayImage, phalanx_segmentation::Error> {
        match self {
            Self::Photograph(image, segmenter) => segmenter.segment(image),
            Self::Mask(mask) => Ok((*mask).clone()),
        }
    }
}

/// How the hand is told from the rest of a photograph.
#[derive(Debug, Clone)]
pub enum Segmenter {
    /// By the colour of skin (§ 2 of the paper).
    Skin(SkinModel),
    /// By its difference from the recorded background of the same camera, at the size at which it is segmented: the
    /// working size, or the picture's where windows are described.
    Background(BackgroundModel),
    /// By its difference from a plain wall.
    Wall(Wall),
}

impl Segmenter {
    /// The raw mask of a picture at the working size.
    pub(crate) fn segment(
        &self,
        image: &RgbImage,
    ) -> Result<GrayImage, phalanx_segmentation::Error> {
        match self {
            Self::Skin(model) => Ok(model.segment(image)),
            Self::Background(model) => model.segment(image),
            Self::Wall(wall) => wall.segment(image),
        }
    }
}
