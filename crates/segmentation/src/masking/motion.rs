//! What moves in pictures of a camera that stands still, and its colours.

use image::RgbImage;

use crate::masking::background::BackgroundParams;
use crate::masking::chroma::chroma;
use crate::masking::colour_cells::{CELLS, cell_of};
use crate::masking::skin::SkinModel;

/// Of two colours of one place the one that is so many times likelier to be skin, as a logarithm, is the hand's.
const LIKELIER: f64 = 2.0;

/// Some pictures, and what they show of most places for most of the time.
pub(super) struct Frames<'a> {
    pub(super) colours: Vec<&'a [[u8; 3]]>,
    /// The median of each channel.
    pub(super) usual: Vec<[u8; 3]>,
    /// A colour that is further than this from the usual one is of something else.
    pub(super) limit: u8,
}

impl<'a> Frames<'a> {
    /// Of at least one picture, all of one size.
    pub(super) fn of(pictures: &'a [RgbImage]) -> Self {
        let colours: Vec<&[[u8; 3]]> =
            pictures.iter().map(|picture| picture.as_raw().as_chunks::<3>().0).collect();
        let pixels = colours.first().map_or(0, |colours| colours.len());
        let mut levels = Vec::with_capacity(colours.len());
        let mut median = |level: &dyn Fn(&[[u8; 3]]) -> u8| {
            levels.clear();
            levels.extend(colours.iter().map(|colours| level(colours)));
            *levels.select_nth_unstable(colours.len() / 2).1
        };
        let usual: Vec<[u8; 3]> = (0..pixels)
            .map(|at| std::array::from_fn(|channel| median(&|colours| colours[at][channel])))
            .collect();
        let mut deviations: Vec<u8> =
            (0..pixels).map(|at| median(&|colours| apart(colours[at], usual[at]))).collect();
        deviations.sort_unstable();
        let deviation = deviations.get(pixels / 2).copied().unwrap_or_default();
        let BackgroundParams { noise_floor, threshold, .. } = BackgroundParams::default();
        // Of a normal distribution half lies within .6745 deviations.
        let noise = (f64::from(deviation) / 0.6745).max(noise_floor);
        let limit = (threshold * noise).min(255.0) as u8;
        Self { colours, usual, limit }
    }

    /// Each colour that is not the usual one of its place, with that one.
    fn moving(&self) -> impl Iterator<Item = ([u8; 3], [u8; 3])> {
        let pairs = self.colours.iter().flat_map(|colours| colours.iter().zip(&self.usual));
        pairs
            .filter(|(own, usual)| apart(**own, **usual) > self.limit)
            .map(|(own, usual)| (*own, *usual))
    }

    /// Whether something moves at each place in any picture.
    fn moves(&self) -> Vec<bool> {
        let mut moves = vec![false; self.usual.len()];
        for colours in &self.colours {
            for ((moves, own), usual) in moves.iter_mut().zip(*colours).zip(&self.usual) {
                *moves |= apart(*own, *usual) > self.limit;
            }
        }
        moves
    }
}

/// The colours of hands that move and of what they move before, and of all that stands still, counted by cells.
pub(super) struct Seeds {
    pub(super) hand: Vec<f64>,
    pub(super) other: Vec<f64>,
}

impl Seeds {
    pub(super) fn of(frames: &Frames<'_>, skin: &SkinModel) -> Self {
        let (mut hand, mut other) = (vec![0.0; CELLS], vec![0.0; CELLS]);
        for (own, usual) in frames.moving() {
            let more = likelihood(skin, own) - likelihood(skin, usual);
            if more.abs() < LIKELIER {
                continue;
            }
            let [of_hand, of_other] = if more > 0.0 { [own, usual] } else { [usual, own] };
            hand[cell_of(of_hand)] += 1.0;
            other[cell_of(of_other)] += 1.0;
        }
        let still = frames.usual.iter().zip(frames.moves()).filter(|(_, moves)| !moves);
        still.for_each(|(&usual, _)| other[cell_of(usual)] += frames.colours.len() as f64);
        Self { hand, other }
    }
}

/// How much likelier a colour is skin than anything else, as a logarithm.
fn likelihood(skin: &SkinModel, rgb: [u8; 3]) -> f64 {
    /// The same of each chroma.
    const LEAST: f64 = 0.01 / (1 << 16) as f64;
    let (cb, cr) = chroma(rgb);
    let [skin, other] = skin.densities(cb, cr);
    ((skin + LEAST) / (other + LEAST)).ln()
}

/// How far two colours are apart in the channel in which they are furthest, levels.
pub(super) fn apart(one: [u8; 3], other: [u8; 3]) -> u8 {
    one.iter().zip(other).map(|(one, other)| one.abs_diff(other)).max().unwrap_or(0)
}
