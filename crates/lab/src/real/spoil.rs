//! A view's masks made wrong on purpose: no view alone may drag a pose along.

use std::fmt;
use std::str::FromStr;

use anyhow::{Context, Result, bail};
use glam::DVec2;
use image::{GrayImage, Luma};

use super::reference::Points;

/// Half the width and height of a face as shares of the root of the mask's area; hand and arm are a few
/// hands' area together, and a face is as long as a hand.
const FACE: [f64; 2] = [0.3, 0.4];

/// How far the thumb reaches to the sides of its bones, as a share of the distance from wrist to middle
/// knuckle.
const THUMB: f64 = 0.14;

/// What is shown instead of the mask.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Instead {
    /// The mask with something as large as a face joined to it.
    Face,
    /// The thumb alone, by the landmarks.
    Thumb,
    /// The mask of another frame, half a take away.
    Other,
    /// Nothing.
    Nothing,
}

/// Which of the frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Frames {
    All,
    /// Every second one.
    Half,
}

/// Which masks of a take are spoilt, and how: `KIND:CAMERA` or `KIND:CAMERA:half`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Spoil {
    instead: Instead,
    camera: String,
    frames: Frames,
}

impl FromStr for Spoil {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        let parts: Vec<&str> = text.split(':').collect();
        let (kind, camera, frames) = match parts[..] {
            [kind, camera] => (kind, camera, Frames::All),
            [kind, camera, "half"] => (kind, camera, Frames::Half),
            _ => bail!("expected KIND:CAMERA or KIND:CAMERA:half"),
        };
        let instead = match kind {
            "face" => Instead::Face,
            "thumb" => Instead::Thumb,
            "other" => Instead::Other,
            "nothing" => Instead::Nothing,
            _ => bail!("'{kind}' is none of face, thumb, other and nothing"),
        };
        Ok(Self { instead, camera: camera.to_owned(), frames })
    }
}

impl fmt::Display for Spoil {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = match self.instead {
            Instead::Face => "face",
            Instead::Thumb => "thumb",
            Instead::Other => "other",
            Instead::Nothing => "nothing",
        };
        let half = if self.frames == Frames::Half { "-half" } else { "" };
        write!(formatter, "{kind}-{}{half}", self.camera)
    }
}

impl Spoil {
    /// Whether a camera's mask of the frame of this number is spoilt.
    pub fn concerns(&self, camera: &str, frame: usize) -> bool {
        camera == self.camera && (self.frames == Frames::All || frame % 2 == 1)
    }

    /// The number of the frame whose mask is taken in place of this one's.
    pub fn taken_from(&self, frame: usize, frames: usize) -> usize {
        if self.instead == Instead::Other { (frame + frames / 2) % frames } else { frame }
    }

    /// The spoilt mask.
    ///
    /// # Errors
    /// A thumb without landmarks.
    pub fn apply(&self, mask: &GrayImage, landmarks: Option<&Points<DVec2>>) -> Result<GrayImage> {
        Ok(match self.instead {
            Instead::Other => mask.clone(),
            Instead::Nothing => GrayImage::new(mask.width(), mask.height()),
            Instead::Face => with_face(mask),
            Instead::Thumb => {
                let landmarks = landmarks.context("a thumb is cut out by landmarks, which lack")?;
                let [wrist, knuckle] =
                    [0, 9].map(|joint| landmarks[joint].context("a landmark lacks"));
                let reach = THUMB * wrist?.distance(knuckle?);
                let thumb: Vec<DVec2> = (2..5).filter_map(|joint| landmarks[joint]).collect();
                within(mask, |pixel| thumb.windows(2).any(|bone| off(bone, pixel) <= reach))
            }
        })
    }
}

/// The mask and an ellipse about its highest pixel.
fn with_face(mask: &GrayImage) -> GrayImage {
    let hand = || mask.enumerate_pixels().filter(|(.., level)| level.0[0] > 127);
    let Some((x, y, _)) = hand().next() else { return mask.clone() };
    let middle = DVec2::new(f64::from(x), f64::from(y)) + 0.5;
    let half = DVec2::from_array(FACE) * (hand().count() as f64).sqrt();
    GrayImage::from_fn(mask.width(), mask.height(), |x, y| {
        let pixel = DVec2::new(f64::from(x), f64::from(y)) + 0.5;
        let is_face = ((pixel - middle) / half).length() <= 1.0;
        if is_face { Luma([255]) } else { *mask.get_pixel(x, y) }
    })
}

/// The part of a mask.
fn within(mask: &GrayImage, holds: impl Fn(DVec2) -> bool) -> GrayImage {
    GrayImage::from_fn(mask.width(), mask.height(), |x, y| {
        let is_in = holds(DVec2::new(f64::from(x), f64::from(y)) + 0.5);
        if is_in { *mask.get_pixel(x, y) } else { Luma([0]) }
    })
}

/// How far a point is from the line between two others.
fn off(bone: &[DVec2], point: DVec2) -> f64 {
    let along = bone[1] - bone[0];
    let share = ((point - bone[0]).dot(along) / along.length_squared()).clamp(0.0, 1.0);
    point.distance(bone[0] + share * along)
}

#[cfg(test)]
mod tests {
    use phalanx_hand::JOINTS;

    use super::*;

    /// A block of 40 × 40 pixels.
    fn block() -> GrayImage {
        let inside = |at: u32| (40..80).contains(&at);
        GrayImage::from_fn(120, 120, |x, y| Luma([if inside(x) && inside(y) { 255 } else { 0 }]))
    }

    fn area(mask: &GrayImage) -> usize {
        mask.iter().filter(|&&level| level > 127).count()
    }

    #[test]
    fn masks_are_spoilt_as_asked_for() {
        let of = |text: &str| text.parse::<Spoil>().unwrap();
        assert_eq!(area(&of("nothing:a").apply(&block(), None).unwrap()), 0);
        assert_eq!(of("other:a").apply(&block(), None).unwrap(), block());
        let faced = area(&of("face:a").apply(&block(), None).unwrap());
        // An ellipse of 12 by 16 px, a quarter of which is in the block.
        assert!(faced > 1600 + 350 && faced < 1600 + 550, "{faced}");
        let mut landmarks = [None; JOINTS];
        for (joint, x) in [(0, 40.0), (9, 80.0), (2, 50.0), (3, 60.0), (4, 70.0)] {
            landmarks[joint] = Some(DVec2::new(x, 60.0));
        }
        let thumb = area(&of("thumb:a").apply(&block(), Some(&landmarks)).unwrap());
        assert!(thumb > 20 * 10 && thumb < 35 * 12, "{thumb}");
        assert!(of("thumb:a").apply(&block(), None).is_err());
    }

    #[test]
    fn half_of_the_frames_are_every_second_one() {
        let spoil: Spoil = "other:cam1:half".parse().unwrap();
        assert_eq!(spoil.to_string(), "other-cam1-half");
        assert!(spoil.concerns("cam1", 3) && !spoil.concerns("cam1", 2));
        assert!(!spoil.concerns("cam0", 3));
        assert_eq!(spoil.taken_from(50, 60), 20);
        assert!("face".parse::<Spoil>().is_err() && "ear:cam0".parse::<Spoil>().is_err());
    }
}
