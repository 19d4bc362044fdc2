//! The found hands' outlines over the pictures.

use std::path::Path;

use anyhow::Result;
use image::{GrayImage, Rgb, RgbImage};

use super::frame::FrameName;
use super::method::{Outcome, Sequence};
use super::overlap;
use super::score::FrameScore;
use super::statistics::mean;
use crate::figures::mosaic::mosaic;
use crate::files;

/// Of so many frames one is shown, and besides so many of the worst.
const EVERY: usize = 10;
const WORST: usize = 5;

const OUTLINE: Rgb<u8> = Rgb([230, 40, 160]);

/// Draws every tenth frame and then the five worst, a row each, a picture of every camera beside the
/// other, as large as they are; says which frames these are.
///
/// # Errors
/// Pictures that cannot be read or written.
pub fn write(
    path: &Path,
    sequence: &Sequence<'_>,
    outcomes: &[Outcome],
    scores: &[FrameScore],
) -> Result<String> {
    let tenth = (0..outcomes.len()).step_by(EVERY);
    let shown: Vec<usize> = tenth.chain(worst(outcomes, scores)).collect();
    let mut panels = Vec::new();
    for &number in &shown {
        for &view in sequence.views {
            let name = &sequence.frames[number];
            let camera = &sequence.take.cameras[view];
            let Some(shown) = camera.shown(name)? else { continue };
            let mut panel = shown.to_rgb8();
            if let Ok(found) = &outcomes[number].found
                && let Ok(drawn) = overlap::draw(&camera.camera, found)
            {
                outline(&mut panel, &drawn);
            }
            panels.push(panel);
        }
    }
    files::write_png(path, &mosaic(&panels, sequence.views.len() as u32, 4))?;
    let names: Vec<String> =
        shown.iter().map(|&number| FrameName::to_string(&sequence.frames[number])).collect();
    Ok(format!("{}: frames {}", path.display(), names.join(" ")))
}

/// The frames that were not refused whose joints are furthest off or, without a reference, of which least
/// is covered; the worst first.
fn worst(outcomes: &[Outcome], scores: &[FrameScore]) -> Vec<usize> {
    let badness = |score: &FrameScore| {
        mean(&score.joints_mm).or_else(|| Some(-mean(&score.overlaps)?)).unwrap_or_default()
    };
    let mut frames: Vec<usize> =
        (0..outcomes.len()).filter(|&number| outcomes[number].found.is_ok()).collect();
    frames.sort_by(|&a, &b| badness(&scores[b]).total_cmp(&badness(&scores[a])));
    frames.truncate(WORST);
    frames
}

/// Colours the border of a silhouette of the picture's size, two pixels wide.
fn outline(picture: &mut RgbImage, silhouette: &GrayImage) {
    let is_hand = |x: u32, y: u32| silhouette.get_pixel(x, y).0[0] > 127;
    for y in 1..silhouette.height() {
        for x in 1..silhouette.width() {
            if is_hand(x, y) != is_hand(x - 1, y) || is_hand(x, y) != is_hand(x, y - 1) {
                picture.put_pixel(x, y, OUTLINE);
                picture.put_pixel(x - 1, y - 1, OUTLINE);
            }
        }
    }
}
