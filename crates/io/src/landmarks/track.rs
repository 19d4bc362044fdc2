//! What a detector saw in one camera's pictures.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use glam::DVec2;
use phalanx_hand::{JOINTS, Landmark, Landmarks};

use crate::error::{Error, Result};

/// A hand's points in one camera's pictures, frame by frame.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LandmarkTrack {
    /// The camera, of a file that holds several by name.
    pub camera: Option<String>,
    /// The points of each frame, by its number; none of frames without a hand.
    pub frames: BTreeMap<u64, Landmarks>,
    /// How many frames a file holds that does not number them: their numbers are their places in it.
    pub places: Option<u64>,
}

/// Coordinates none of which is larger are shares of a picture's width and height: no hand is three
/// pixels large.
const MOST_SHARE: f64 = 2.0;

impl LandmarkTrack {
    /// The points in pixels of a picture of so many: as they are, or where none of them is beyond 2, times
    /// the picture's width and height.
    #[must_use]
    pub fn in_pixels(mut self, (width, height): (u32, u32)) -> Self {
        let points = || self.frames.values().flatten().flatten();
        if points().any(|point| point.at.abs().max_element() > MOST_SHARE) {
            return self;
        }
        let size = DVec2::new(f64::from(width), f64::from(height));
        self.frames.values_mut().flatten().flatten().for_each(|point| point.at *= size);
        self
    }

    /// Adds the frames of another file of the same camera, which has numbers for them.
    ///
    /// # Errors
    /// A frame that both have, or files that do not number their frames.
    pub fn join(&mut self, other: Self, file: &str) -> Result<()> {
        if other.places.is_some() {
            let what = "its name has no frame's number, as that of each of several files must";
            return Err(Error::landmarks(file, what));
        }
        other.frames.into_iter().try_for_each(|(number, points)| match self.frames.entry(number) {
            Entry::Vacant(free) => {
                free.insert(points);
                Ok(())
            }
            Entry::Occupied(_) => {
                Err(Error::landmarks(file, format!("frame {number} is in another file too")))
            }
        })
    }

    /// Of frames in order, each with the number that the file has for it; all of them or none.
    pub(super) fn of(
        camera: Option<String>,
        frames: impl IntoIterator<Item = (Option<u64>, Option<Landmarks>)>,
    ) -> Result<Self, String> {
        let mut track = Self { camera, ..Self::default() };
        let (mut has_numbers, mut count) = (None, 0);
        for (place, (number, points)) in (0..).zip(frames) {
            if *has_numbers.get_or_insert(number.is_some()) != number.is_some() {
                return Err(format!(
                    "frame {place} of the file: some frames have a number and some none"
                ));
            }
            count = place + 1;
            let number = number.unwrap_or(place);
            if let Some(points) = points.filter(has_any)
                && track.frames.insert(number, points).is_some()
            {
                return Err(format!("frame {number} comes twice"));
            }
        }
        track.places = (has_numbers == Some(false)).then_some(count);
        Ok(track)
    }
}

/// The last number of a name, such as that of `take_000000000012_keypoints`: what frames are numbered by.
///
/// ```
/// use phalanx_io::landmarks::number_in_name;
///
/// assert_eq!(number_in_name("cam1_frame0042.png"), Some(42));
/// assert_eq!(number_in_name("thumb"), None);
/// ```
pub fn number_in_name(name: &str) -> Option<u64> {
    let is_digit = |c: char| c.is_ascii_digit();
    let end = name.rfind(is_digit)? + 1;
    let digits = name[..end].trim_end_matches(is_digit).len();
    name[digits..end].parse().ok()
}

/// A point of three numbers as files have it; `None` where one is not a number or the detector is not sure
/// of it at all.
pub(super) fn landmark(x: f64, y: f64, confidence: f64) -> Option<Landmark> {
    let is_seen = x.is_finite() && y.is_finite() && confidence > 0.0;
    is_seen.then(|| Landmark { at: DVec2::new(x, y), confidence: confidence.min(1.0) })
}

/// So many points as a hand has.
pub(super) fn hand(points: Vec<Option<Landmark>>) -> Result<Option<Landmarks>, String> {
    if points.is_empty() {
        return Ok(None);
    }
    let count = points.len();
    let points: Landmarks =
        points.try_into().map_err(|_| format!("{count} points, not the {JOINTS} of a hand"))?;
    Ok(Some(points).filter(has_any))
}

fn has_any(points: &Landmarks) -> bool {
    points.iter().any(Option::is_some)
}
