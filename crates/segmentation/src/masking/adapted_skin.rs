//! Skin in one picture: a skin model adapted to the person and the light.

use image::RgbImage;

use crate::mask::Mask;
use crate::mask::cleanup::Cleanup;
use crate::mask::components::{Class, Components};
use crate::mask::majority::Majority;
use crate::mask::morphology::{dilate, erode};
use crate::masking::chroma::chroma;
use crate::masking::histogram::smooth;
use crate::masking::skin::SkinModel;

/// Cells of luma, Cb and Cr that a picture's colours are counted in. A picture has too few pixels for
/// cells of single levels; light changes luma more than it changes chroma.
const SIDES: [usize; 3] = [16, 64, 64];

/// Passes of the smoothing kernel over the counts: its standard deviation is one cell.
const SMOOTHING: u32 = 2;

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
            adapted.table = general.decide(&sure, &cells, model.parts().params.prior);
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

/// The cell of a colour, Cr contiguous.
#[inline]
fn cell_of(rgb: [u8; 3]) -> usize {
    let [luma, blue, red] = SIDES;
    let [r, g, b] = rgb.map(usize::from);
    // ITU-R BT.601, as `chroma`.
    let y = (77 * r + 150 * g + 29 * b) >> 8;
    let (cb, cr) = chroma(rgb);
    let [y, cb, cr] = [y * luma, usize::from(cb) * blue, usize::from(cr) * red].map(|v| v >> 8);
    (y * blue + cb) * red + cr
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

/// How likely a model has it that each chroma is skin, and anything else, in the cells of one luma.
struct General([Vec<f64>; 2]);

impl General {
    /// The model knows nothing of luma: to it all are as likely.
    fn of(model: &SkinModel) -> Self {
        let [luma, blue, red] = SIDES;
        let (high, wide) = (256 / blue, 256 / red);
        let mut planes = [vec![0.0; blue * red], vec![0.0; blue * red]];
        for (cb, cr) in (0..=255_u8).flat_map(|cb| (0..=255_u8).map(move |cr| (cb, cr))) {
            let cell = usize::from(cb) / high * red + usize::from(cr) / wide;
            let densities = model.densities(cb, cr).map(|density| density / luma as f64);
            planes.iter_mut().zip(densities).for_each(|(plane, density)| plane[cell] += density);
        }
        Self(planes)
    }

    /// Bayes' rule in every cell, from this and the colours of sure pixels.
    fn decide(&self, sure: &SurePixels, cells: &[usize], prior: f64) -> Vec<u8> {
        let is_skin = sure.skin.iter().map(|&level| Mask::is_hand_level(level));
        let is_other = sure.near_skin.iter().map(|&level| !Mask::is_hand_level(level));
        let [skin, other] = &self.0;
        let skin = adapted(skin, cells, is_skin);
        let other = adapted(other, cells, is_other);
        let is_skin = |(s, n): (&f64, &f64)| prior * s > (1.0 - prior) * n;
        skin.iter().zip(&other).map(|pair| if is_skin(pair) { 255 } else { 0 }).collect()
    }
}

/// The mean of a density and that of the selected pixels; the density itself where none is.
fn adapted(general: &[f64], cells: &[usize], selected: impl Iterator<Item = bool>) -> Vec<f64> {
    let mut counts = vec![0.0; SIDES.iter().product()];
    let own = cells.iter().zip(selected).filter(|(_, selected)| *selected);
    own.for_each(|(&cell, _)| counts[cell] += 1.0);
    let total: f64 = counts.iter().sum();
    let general = general.iter().cycle();
    if total == 0.0 {
        return general.take(counts.len()).copied().collect();
    }
    smooth(&mut counts, &SIDES, SMOOTHING);
    counts.iter().zip(general).map(|(count, general)| 0.5 * (general + count / total)).collect()
}
