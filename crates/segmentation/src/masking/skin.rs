//! Which colours are skin: a histogram classifier over Cb and Cr.

use image::RgbImage;

use crate::mask::Mask;
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::masking::chroma::chroma;
use crate::masking::histogram::smooth;
use crate::masking::label::Label;

/// How histograms become a decision.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SkinParams {
    /// Histogram bins along each of Cb and Cr are 2 to this power; 4 to 8.
    pub bits: u32,
    /// Half width, in bins, of the binomial kernel that both histograms are smoothed with; 0 to 16.
    /// Its standard deviation is the square root of half of it.
    pub smoothing: u32,
    /// Share of the pixels that are skin before their colour is known; strictly between 0 and 1.
    pub prior: f64,
}

impl Default for SkinParams {
    fn default() -> Self {
        Self { bits: 7, smoothing: 16, prior: 0.5 }
    }
}

impl SkinParams {
    pub(crate) fn check(&self) -> Result<()> {
        let in_range = |ok: bool, name, value, allowed| {
            if ok { Ok(()) } else { Err(Error::Parameter { name, value, allowed }) }
        };
        in_range((4..=8).contains(&self.bits), "bits", self.bits.into(), "4 to 8")?;
        in_range(self.smoothing <= 16, "smoothing", self.smoothing.into(), "0 to 16")?;
        let prior = self.prior;
        in_range(prior > 0.0 && prior < 1.0, "prior", prior, "strictly between 0 and 1")
    }

    pub(crate) fn side(&self) -> usize {
        1 << self.bits
    }

    /// Row-major bin of a colour: Cb selects the row.
    #[inline]
    fn bin(self, rgb: [u8; 3]) -> usize {
        let (cb, cr) = chroma(rgb);
        self.bin_of_chroma(cb, cr)
    }

    #[inline]
    fn bin_of_chroma(self, cb: u8, cr: u8) -> usize {
        let drop = 8 - self.bits;
        (usize::from(cb >> drop) << self.bits) | usize::from(cr >> drop)
    }
}

/// Everything that a [`SkinModel`] is made of.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SkinParts {
    /// Where the training pixels come from, one line of text.
    pub source: String,
    /// How the histograms become a decision.
    pub params: SkinParams,
    /// Training pixels of skin in each bin, row-major: 2^bits rows of Cb, 2^bits columns of Cr.
    pub skin: Vec<u32>,
    /// Training pixels of anything else, likewise.
    pub non_skin: Vec<u32>,
}

/// Counts training pixels and makes a [`SkinModel`] of them.
///
/// The model that [`SkinModel::builtin`] returns is `SkinTrainer::default()` fed with every row of
/// the data set that [`BUILTIN_SOURCE`] names and finished with that source; the order of the rows
/// does not matter.
///
/// ```
/// use phalanx_segmentation::{Label, SkinModel, SkinTrainer};
///
/// let mut trainer = SkinTrainer::default();
/// trainer.add_pixel([205, 150, 125], Label::Skin);
/// trainer.add_pixel([60, 120, 200], Label::NonSkin);
/// let model = trainer.finish("two pixels")?;
/// assert!(model.is_skin([205, 150, 125]) && !model.is_skin([60, 120, 200]));
/// assert_eq!(SkinModel::from_bytes(&model.to_bytes())?, model);
/// # Ok::<(), phalanx_segmentation::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct SkinTrainer {
    params: SkinParams,
    skin: Vec<u32>,
    non_skin: Vec<u32>,
}

/// The training data of [`SkinModel::builtin`].
pub const BUILTIN_SOURCE: &str = "UCI Machine Learning Repository, data set 229: Skin Segmentation, \
     Rajen Bhatt and Abhinav Dhall, licence CC BY 4.0, https://archive.ics.uci.edu/dataset/229";

impl Default for SkinTrainer {
    fn default() -> Self {
        let bins = SkinParams::default().side().pow(2);
        Self { params: SkinParams::default(), skin: vec![0; bins], non_skin: vec![0; bins] }
    }
}

impl SkinTrainer {
    /// A trainer without pixels.
    pub fn new(params: SkinParams) -> Result<Self> {
        params.check()?;
        let bins = params.side().pow(2);
        Ok(Self { params, skin: vec![0; bins], non_skin: vec![0; bins] })
    }

    /// Counts one pixel, given as red, green, blue.
    pub fn add_pixel(&mut self, rgb: [u8; 3], label: Label) {
        let histogram = match label {
            Label::Skin => &mut self.skin,
            Label::NonSkin => &mut self.non_skin,
        };
        let count = &mut histogram[self.params.bin(rgb)];
        *count = count.saturating_add(1);
    }

    /// Counts every pixel of an image; those of the mask are skin.
    pub fn add_image(&mut self, image: &RgbImage, mask: &Mask) -> Result<()> {
        if image.dimensions() != mask.dimensions() {
            let (expected, found) = (image.dimensions(), mask.dimensions());
            return Err(Error::SizeMismatch { what: "skin mask", expected, found });
        }
        for (rgb, level) in image.pixels().zip(mask.pixels()) {
            let label = if Mask::is_hand_level(level.0[0]) { Label::Skin } else { Label::NonSkin };
            self.add_pixel(rgb.0, label);
        }
        Ok(())
    }

    /// The model of all pixels counted so far. `source` says in one line where they come from.
    pub fn finish(self, source: &str) -> Result<SkinModel> {
        let Self { params, skin, non_skin } = self;
        SkinModel::from_parts(SkinParts { source: source.to_owned(), params, skin, non_skin })
    }
}

/// Tells skin from anything else by its chroma: Bayes' rule on two smoothed histograms.
///
/// ```
/// use image::{Rgb, RgbImage};
/// use phalanx_segmentation::SkinModel;
///
/// let mut picture = RgbImage::from_pixel(4, 3, Rgb([90, 120, 160]));
/// picture.put_pixel(2, 1, Rgb([205, 150, 125]));
/// let mask = SkinModel::builtin().classify(&picture);
/// assert_eq!((mask[(2, 1)].0, mask[(0, 0)].0), ([255], [0]));
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "SkinParts", into = "SkinParts")]
pub struct SkinModel {
    parts: SkinParts,
    /// The smoothed densities p(c | skin) and p(c | non-skin) in each bin, per level of Cb and of Cr.
    densities: [Vec<f64>; 2],
    /// 255 where a bin is skin, 0 elsewhere.
    table: Vec<u8>,
}

impl SkinModel {
    /// The model trained on [`BUILTIN_SOURCE`].
    ///
    /// # Panics
    /// Never: the bytes are part of the crate and a test reads them.
    pub fn builtin() -> Self {
        Self::from_bytes(include_bytes!("../../models/skin.txt"))
            .expect("the shipped model is valid")
    }

    /// Builds the model from histograms. Each class needs a pixel.
    pub fn from_parts(parts: SkinParts) -> Result<Self> {
        let SkinParts { source, params, skin, non_skin } = &parts;
        params.check()?;
        if source.contains(['\n', '\r']) {
            return Err(Error::Model { line: 2, reason: "the source must be one line" });
        }
        let bins = params.side().pow(2);
        for (name, histogram) in [("skin bins", skin), ("non-skin bins", non_skin)] {
            if histogram.len() != bins {
                let value = histogram.len() as f64;
                return Err(Error::Parameter { name, value, allowed: "2^(2·bits)" });
            }
        }
        for (label, histogram) in [(Label::Skin, skin), (Label::NonSkin, non_skin)] {
            if histogram.iter().all(|&count| count == 0) {
                return Err(Error::NoTrainingPixels(label));
            }
        }
        let smoothed = [&parts.skin, &parts.non_skin].map(|histogram| {
            let mut values: Vec<f64> = histogram.iter().map(|&n| f64::from(n)).collect();
            smooth(&mut values, &[parts.params.side(); 2], parts.params.smoothing);
            values
        });
        let table = decide(&parts, &smoothed);
        let levels = f64::from(1_u32 << (2 * (8 - parts.params.bits)));
        let [near_skin, near_other] = smoothed;
        let density = |near: Vec<f64>, histogram: &[u32]| {
            let pixels = levels * total(histogram);
            near.into_iter().map(|near| near / pixels).collect()
        };
        let densities = [density(near_skin, &parts.skin), density(near_other, &parts.non_skin)];
        Ok(Self { parts, densities, table })
    }

    /// What the model is made of.
    pub fn parts(&self) -> &SkinParts {
        &self.parts
    }

    /// Takes the model apart.
    pub fn into_parts(self) -> SkinParts {
        self.parts
    }

    /// Whether a colour, given as red, green, blue, is skin.
    #[inline]
    pub fn is_skin(&self, rgb: [u8; 3]) -> bool {
        self.table[self.parts.params.bin(rgb)] != 0
    }

    /// The mask of the pixels whose chroma is that of skin (§ 2 of the paper), each looked at alone. Its
    /// [`Segment::segment`](crate::Segment::segment), which adapts the model to the picture, is right more often.
    pub fn classify(&self, image: &RgbImage) -> Mask {
        let mut mask = Mask::new(image.width(), image.height());
        self.fill(image, &mut mask);
        mask
    }

    /// [`SkinModel::classify`] into a mask that is used again; it takes the image's size.
    pub fn classify_into(&self, image: &RgbImage, mask: &mut Mask) {
        if mask.dimensions() != image.dimensions() {
            *mask = Mask::new(image.width(), image.height());
        }
        self.fill(image, mask);
    }

    /// The densities p(c | skin) and p(c | non-skin) of a chroma, per level of Cb and of Cr.
    pub(crate) fn densities(&self, cb: u8, cr: u8) -> [f64; 2] {
        let bin = self.parts.params.bin_of_chroma(cb, cr);
        let [skin, other] = &self.densities;
        [skin[bin], other[bin]]
    }

    fn fill(&self, image: &RgbImage, mask: &mut Mask) {
        let (colours, _) = image.as_raw().as_chunks::<3>();
        let params = self.parts.params;
        for (level, &rgb) in mask.iter_mut().zip(colours) {
            *level = self.table[params.bin(rgb)];
        }
    }
}

impl TryFrom<SkinParts> for SkinModel {
    type Error = Error;

    fn try_from(parts: SkinParts) -> Result<Self> {
        Self::from_parts(parts)
    }
}

impl From<SkinModel> for SkinParts {
    fn from(model: SkinModel) -> Self {
        model.parts
    }
}

/// Bayes' rule in every bin: skin where prior · p(c | skin) > (1 − prior) · p(c | non-skin).
/// A colour that neither class has near it is not skin.
fn decide(parts: &SkinParts, [skin, non_skin]: &[Vec<f64>; 2]) -> Vec<u8> {
    let odds = parts.params.prior / (1.0 - parts.params.prior);
    let skin_weight = odds * total(&parts.non_skin) / total(&parts.skin);
    let decision = |(s, n): (&f64, &f64)| if skin_weight * s > *n { 255 } else { 0 };
    skin.iter().zip(non_skin).map(decision).collect()
}

fn total(histogram: &[u32]) -> f64 {
    histogram.iter().map(|&n| f64::from(n)).sum()
}
