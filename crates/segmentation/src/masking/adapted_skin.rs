//! Skin in one picture: a skin model adapted to the person and the light.

use image::RgbImage;

use crate::mask::Mask;
use crate::mask::cleanup::Cleanup;
use crate::mask::components::{Class, Components};
use crate::mask::majority::Majority;
use crate::mask::morphology::{dilate, erode};
use crate::masking::colour_cells::{CELLS, General, cell_of};
use crate::masking::label::Label;
use crate::masking::skin::SkinModel;

/// How often the picture's colours are counted; the second mask differs from the first by the colours
/// that the model alone did not know, further ones hardly from the second.
const ROUNDS: usize = 2;

/// How far a border mixes the colours of its two sides, px: cameras keep chroma at half the resolution.
const MIXED: usize = 2;

/// Tells skin from anything else in one picture by its luma and chroma.
///
/// A [`SkinModel`] says which regions of the picture are skin; their colours and those of the rest,
/// away from the borders between them, are counted, and Bayes' rule decides between the two. A class's
/// density is the mean of the model's and the picture's own, so that a colour that the picture leaves
/// open stays as the model has it, and a picture without any skin is segmented by the model alone.
/// The idea is that of Vezhnevets, Sazonov and Andreeva (2003), § 4: static models find the skin that
/// an adapted one is learnt from.
///
/// ```
/// use image::{Rgb, RgbImage};
/// use phalanx_segmentation::{AdaptedSkin, SkinModel};
///
/// // A hand that is darker towards its wrist, before a grey wall.
/// let picture = RgbImage::from_fn(80, 60, |x, y| {
///     let light = 1.0 - f64::from(y) / 120.0;
///     let is_hand = (20..60).contains(&x) && y >= 10;
///     let colour = if is_hand { [205.0, 150.0, 125.0] } else { [150.0, 155.0, 165.0] };
///     Rgb(colour.map(|level| (light * level) as u8))
/// });
/// let model = SkinModel::builtin();
/// let mask = AdaptedSkin::new(&model, &picture).segment(&picture);
/// assert!(mask.is_hand(40, 15) && mask.is_hand(40, 55) && !mask.is_hand(5, 30));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct AdaptedSkin {
    /// 255 where a cell is skin, 0 elsewhere.
    table: Vec<u8>,
}

impl AdaptedSkin {
    /// The model adapted to a picture.
    pub fn new(model: &SkinModel, picture: &RgbImage) -> Self {
        let (colours, _) = picture.as_raw().as_chunks::<3>();
        let cells: Vec<usize> = colours.iter().map(|&rgb| cell_of(rgb)).collect();
        let general = General::of(model);
        let mut levels = model.classify(picture).into_image().into_raw();
        let mut adapted = Self { table: Vec::new() };
        for _ in 0..ROUNDS {
            let sure = SurePixels::of(levels, picture.width() as usize);
            adapted.table = decide(&general, &sure, &cells, model.parts().params.prior);
            levels = cells.iter().map(|&cell| adapted.table[cell]).collect();
        }
        adapted
    }

    /// The mask of skin: 255 where it is, 0 elsewhere, as large as the picture.
    pub fn segment(&self, picture: &RgbImage) -> Mask {
        let mut mask = Mask::new(picture.width(), picture.height());
        let (colours, _) = picture.as_raw().as_chunks::<3>();
        mask.iter_mut().zip(colours).for_each(|(level, &rgb)| *level = self.table[cell_of(rgb)]);
        mask
    }
}

/// Pixels of which a mask leaves no doubt what they are.
struct SurePixels {
    /// Over 127 where a pixel and all around it are skin.
    skin: Vec<u8>,
    /// Over 127 where something near a pixel is skin.
    near_skin: Vec<u8>,
}

impl SurePixels {
    /// Of a mask's regions that are large enough for a hand.
    fn of(mut levels: Vec<u8>, width: usize) -> Self {
        let cleanup = Cleanup::default();
        if levels.is_empty() {
            return Self { skin: Vec::new(), near_skin: Vec::new() };
        }
        let mut voted = vec![0; levels.len()];
        let radius = cleanup.majority_radius as usize;
        Majority::default().vote(&levels, width, radius, &mut voted);
        let mut components = Components::default();
        components.label(&voted, width, Class::Hand);
        let needed = cleanup.needed(voted.len());
        components.paint(&mut voted, width, 0, |_, region| region.area < needed);
        levels.copy_from_slice(&voted);
        Self { skin: erode(&levels, width, MIXED), near_skin: dilate(&levels, width, MIXED) }
    }
}

/// Bayes' rule in every cell, from what is known of all pictures and the colours of sure pixels.
fn decide(general: &General, sure: &SurePixels, cells: &[usize], prior: f64) -> Vec<u8> {
    let is_skin = sure.skin.iter().map(|&level| Mask::is_hand_level(level));
    let is_other = sure.near_skin.iter().map(|&level| !Mask::is_hand_level(level));
    let skin = general.adapted(Label::Skin, counts(cells, is_skin));
    let other = general.adapted(Label::NonSkin, counts(cells, is_other));
    let is_skin = |(s, n): (&f64, &f64)| prior * s > (1.0 - prior) * n;
    skin.iter().zip(&other).map(|pair| if is_skin(pair) { 255 } else { 0 }).collect()
}

/// How many of the selected pixels have a colour of each cell.
fn counts(cells: &[usize], selected: impl Iterator<Item = bool>) -> Vec<f64> {
    let mut counts = vec![0.0; CELLS];
    let own = cells.iter().zip(selected).filter(|(_, selected)| *selected);
    own.for_each(|(&cell, _)| counts[cell] += 1.0);
    counts
}
