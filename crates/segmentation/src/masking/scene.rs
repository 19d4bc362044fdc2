//! A hand before a background that looks like skin, learnt from the recording that shows both.

use image::RgbImage;
use image::imageops::thumbnail;

use crate::error::{Error, Result};
use crate::mask::Mask;
use crate::mask::cleanup::Cleanup;
use crate::masking::box_mean::box_mean;
use crate::masking::colour_cells::{CELLS, General, cell_of};
use crate::masking::label::Label;
use crate::masking::motion::{Frames, Seeds, apart};
use crate::masking::skin::SkinModel;

/// Longest side of the pictures that are learnt from, px: a finger is then still several pixels wide.
const LONGEST: u32 = 480;

/// Passes over what is usually seen; the decisions of the last two hardly differ.
const PASSES: usize = 4;

/// Of the prior of a place so much is that of the whole picture, and the rest that of the places around it.
const WHOLE: f64 = 0.5;

/// The places around one are so much of the picture's diagonal away at most: about half a finger's width where a hand
/// fills a third of it.
const AROUND: f64 = 0.02;

/// Neither class is less likely to have a colour than a hundredth of what it had if all cells were as likely.
const LEAST: f64 = 0.01 / CELLS as f64;

/// A place decides together with those around it, up to so many pixels away, and none by more than this, as log-odds.
const BESIDE: usize = 2;
const MOST: f64 = 4.0;

/// A picture that looks the same for most of the time, in which a hand moves: the colours of that hand and of all else, what
/// each place usually shows, and whether that is hand.
///
/// A [`SkinModel`] does not tell a hand from wood, cardboard or a wall in warm light. Where something moves, a place shows
/// two colours, and the one that is much more like skin is the hand's. The colours of hands and of all that stands still
/// are counted so, and Bayes' rule decides between the two: of what a place usually shows, once, with a prior from the
/// places around it; where it shows something else, by that colour and by how often such a change there was a hand.
///
/// ```
/// use image::{Rgb, RgbImage};
/// use phalanx_segmentation::{SceneModel, Segment, SkinModel};
///
/// // A hand that moves over wood, which is skin to the model, and over a dark desk.
/// let picture = |k: u32| RgbImage::from_fn(96, 64, |x, y| {
///     let is_hand = (4 * k..4 * k + 24).contains(&x) && (20..44).contains(&y);
///     let background = if x < 48 { [180, 130, 80] } else { [70, 72, 75] };
///     Rgb(if is_hand { [205, 150, 130] } else { background })
/// });
/// let pictures: Vec<RgbImage> = (0..16).map(picture).collect();
/// let skin = SkinModel::builtin();
/// assert!(skin.is_skin([180, 130, 80]));
/// let scene = SceneModel::learn(&pictures, &skin)?.expect("wood that passes for skin");
/// let mask = scene.segment(&pictures[2])?;
/// assert!(mask.is_hand(20, 30) && !mask.is_hand(40, 50) && !mask.is_hand(90, 30));
/// # Ok::<(), phalanx_segmentation::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct SceneModel {
    /// Width and height of the pictures.
    size: (u32, u32),
    /// Width and height of what was learnt from them.
    learnt: (usize, usize),
    /// Density of each cell's colours, of hands and of anything else.
    hand: Vec<f64>,
    other: Vec<f64>,
    places: Vec<Place>,
    /// A colour that is further than this from the usual one is of something else.
    limit: u8,
}

/// What is known of a place of the picture; how much likelier than not it is hand, as logarithms.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Place {
    /// The colour that it usually shows.
    usual: [u8; 3],
    /// Where it shows that.
    odds: f64,
    /// Where it shows another, before the colour is known.
    prior_odds: f64,
}

impl SceneModel {
    /// So many pictures, spread over a recording, tell nearly as much as all.
    pub const PICTURES: usize = 48;

    /// Learns from pictures of one camera that stands still, spread over a recording. `None` where too little moves to learn
    /// from, and where the skin model alone will do: what it takes for skin is hand.
    ///
    /// # Errors
    /// No pictures, or pictures of several sizes.
    pub fn learn(pictures: &[RgbImage], skin: &SkinModel) -> Result<Option<Self>> {
        let size = pictures.first().ok_or(Error::NoFrames)?.dimensions();
        for picture in pictures {
            let found = picture.dimensions();
            if found != size {
                return Err(Error::SizeMismatch { what: "picture", expected: size, found });
            }
        }
        let by = size.0.max(size.1).div_ceil(LONGEST).max(1);
        let [width, height] = [size.0, size.1].map(|side| side.div_ceil(by));
        let small: Vec<RgbImage> =
            pictures.iter().map(|picture| thumbnail(picture, width, height)).collect();
        let frames = Frames::of(&small);
        let seeds = Seeds::of(&frames, skin);
        // As many as the least of hands has.
        let needed = Cleanup::default().needed(frames.usual.len());
        if seeds.hand.iter().sum::<f64>() < needed as f64 {
            return Ok(None);
        }
        let general = General::of(skin);
        let hand = general.adapted(Label::Skin, seeds.hand);
        let other = general.adapted(Label::NonSkin, seeds.other);
        let learnt = (width as usize, height as usize);
        let Frames { usual, limit, .. } = frames;
        let mut model = Self { size, learnt, hand, other, places: Vec::new(), limit };
        let odds = model.odds_of_usual(&usual);
        let place = |(usual, odds)| Place { usual, odds, prior_odds: 0.0 };
        model.places = usual.into_iter().zip(odds).map(place).collect();
        model.learn_moving(&small);
        Ok(Some(model).filter(|model| model.differs_from(skin)))
    }

    /// The mask of the hand, 255 in it and 0 elsewhere.
    ///
    /// # Errors
    /// A picture of another size than those that were learnt from.
    pub fn segment(&self, picture: &RgbImage) -> Result<Mask> {
        let found = picture.dimensions();
        if found != self.size {
            return Err(Error::SizeMismatch { what: "picture", expected: self.size, found });
        }
        let is_hand = self.is_hand(picture);
        let (width, height) = self.size;
        let mut mask = Mask::new(width, height);
        mask.iter_mut().zip(is_hand).for_each(|(level, is_hand)| *level = 255 * u8::from(is_hand));
        Ok(mask)
    }

    /// Whether of what is usually seen half as much passes for skin and is none as is hand.
    fn differs_from(&self, skin: &SkinModel) -> bool {
        let hand = self.places.iter().filter(|place| place.odds > 0.0).count();
        let other = self.places.iter().filter(|place| place.odds <= 0.0);
        let like_skin = other.filter(|place| skin.is_skin(place.usual));
        2 * like_skin.count() > hand
    }

    /// How much likelier than not what each place usually shows is hand, as a logarithm.
    fn odds_of_usual(&self, usual: &[[u8; 3]]) -> Vec<f64> {
        let (width, _) = self.learnt;
        let radius = self.around();
        let by_colour: Vec<f64> = usual.iter().map(|&rgb| self.odds_of(rgb)).collect();
        let mut odds = by_colour.clone();
        for _ in 0..PASSES {
            let is_hand =
                decided(&odds, width).into_iter().map(|is_hand| f64::from(u8::from(is_hand)));
            let around = box_mean(&is_hand.collect::<Vec<f64>>(), width, radius);
            odds =
                by_colour.iter().zip(around).map(|(own, share)| own + prior_odds(share)).collect();
        }
        odds
    }

    /// Learns how often a place and those around it are hand where they show something else than usual, from pictures as
    /// large as what was learnt. Only once: a prior that is learnt again from its own decisions bears itself out.
    fn learn_moving(&mut self, pictures: &[RgbImage]) {
        let mut counts = [vec![0.0; self.places.len()], vec![0.0; self.places.len()]];
        for picture in pictures {
            let (colours, _) = picture.as_raw().as_chunks::<3>();
            let decided = self.is_hand(picture);
            for (k, (&rgb, is_hand)) in colours.iter().zip(decided).enumerate() {
                if apart(rgb, self.places[k].usual) > self.limit {
                    counts[usize::from(is_hand)][k] += 1.0;
                }
            }
        }
        let radius = self.around();
        let [other, hand] = counts.map(|counts| box_mean(&counts, self.learnt.0, radius));
        for (place, (other, hand)) in self.places.iter_mut().zip(other.iter().zip(hand)) {
            let all = other + hand;
            place.prior_odds = prior_odds(if all > 0.0 { hand / all } else { 0.5 });
        }
    }

    /// How far away places are that a place has its prior from.
    fn around(&self) -> usize {
        let (width, height) = self.learnt;
        (AROUND * (width as f64).hypot(height as f64)).round() as usize
    }

    /// Whether each pixel of a picture of the whole scene is hand.
    fn is_hand(&self, picture: &RgbImage) -> Vec<bool> {
        let (columns, rows) = self.learnt;
        let (width, height) = (picture.width() as usize, picture.height() as usize);
        let (colours, _) = picture.as_raw().as_chunks::<3>();
        let odds = colours.chunks_exact(width).enumerate().flat_map(|(y, row)| {
            let places = &self.places[y * rows / height * columns..][..columns];
            row.iter().enumerate().map(move |(x, &rgb)| {
                let place = &places[x * columns / width];
                let is_usual = apart(rgb, place.usual) <= self.limit;
                if is_usual { place.odds } else { place.prior_odds + self.odds_of(rgb) }
            })
        });
        decided(&odds.collect::<Vec<f64>>(), width)
    }

    /// How much likelier than not a colour is hand, as a logarithm.
    fn odds_of(&self, rgb: [u8; 3]) -> f64 {
        let [hand, other] = [&self.hand, &self.other].map(|density| density[cell_of(rgb)] + LEAST);
        (hand / other).ln()
    }
}

/// The prior of a place, as log-odds, by the share of the places around it that are hand.
fn prior_odds(share: f64) -> f64 {
    let prior = WHOLE * 0.5 + (1.0 - WHOLE) * share;
    (prior / (1.0 - prior)).ln()
}

/// Whether each place is hand, by its log-odds and those of the places beside it.
fn decided(odds: &[f64], width: usize) -> Vec<bool> {
    let odds: Vec<f64> = odds.iter().map(|odds| odds.clamp(-MOST, MOST)).collect();
    box_mean(&odds, width, BESIDE).into_iter().map(|odds| odds > 0.0).collect()
}
