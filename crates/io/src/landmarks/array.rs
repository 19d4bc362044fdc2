//! NumPy arrays: frames × 21 × 2 or 3, or cameras × frames × 21 × 2 or 3.

use phalanx_hand::{JOINTS, Landmark};

use crate::landmarks::track::{LandmarkTrack, hand, landmark};
use crate::npy::{Array, Data};

pub(super) fn read(bytes: &[u8]) -> Result<Vec<LandmarkTrack>, String> {
    let Array { shape, data } = Array::from_bytes(bytes)?;
    let (views, frames, numbers) = match shape[..] {
        [frames, JOINTS, numbers @ (2 | 3)] => (1, frames, numbers),
        [views, frames, JOINTS, numbers @ (2 | 3)] => (views, frames, numbers),
        _ => {
            return Err(format!(
                "its shape is {shape:?}, not [frames, {JOINTS}, 2 or 3] or [cameras, frames, {JOINTS}, 2 or \
                 3]: save the {JOINTS} points of one hand, such as array[:, :, first:first + {JOINTS}]"
            ));
        }
    };
    let entries: Vec<f64> = match data {
        Data::Real(entries) => entries,
        Data::Integer(entries) => entries.into_iter().map(|entry| entry as f64).collect(),
        Data::Flag(_) | Data::Text(_) => return Err("its entries are no numbers".to_owned()),
    };
    if entries.is_empty() {
        return Err("it holds no frame".to_owned());
    }
    let point = |numbers: &[f64]| -> Result<Option<Landmark>, String> {
        let confidence = numbers.get(2).copied().unwrap_or(1.0);
        if confidence.is_finite() && !(0.0..=1.0).contains(&confidence) {
            return Err(format!(
                "a point's third number is {confidence}, no confidence from 0 to 1: save x and y alone, \
                 array[..., :2]"
            ));
        }
        Ok(landmark(numbers[0], numbers[1], confidence))
    };
    let frame = |(k, entries): (usize, &[f64])| {
        let points = entries.chunks_exact(numbers).map(point).collect::<Result<_, _>>();
        let points = points.map_err(|what: String| format!("frame {}: {what}", k % frames))?;
        Ok((None, hand(points)?))
    };
    let of_frames = entries.chunks_exact(JOINTS * numbers).enumerate().map(frame);
    let of_frames: Vec<_> = of_frames.collect::<Result<_, String>>()?;
    debug_assert_eq!(of_frames.len(), views * frames);
    of_frames.chunks(frames).map(|own| LandmarkTrack::of(None, own.iter().copied())).collect()
}
