//! What stands still in a recording and looks like skin.

use std::collections::BTreeMap;
use std::path::Path;

use image::RgbImage;
use phalanx::{Progress, photograph_from};
use phalanx_camera::Camera;
use phalanx_sampling::spread_subset;
use phalanx_segmentation::{SceneModel, SkinModel};

use crate::progress::Bar;

/// The seed by which the pictures are drawn that are learnt from.
const SUBSET_SEED: u64 = 0;

/// A minute of most videos, which are decoded from their beginning: the pictures are drawn from no more frames.
const MOST_FRAMES: usize = 1800;

/// Learns the scenes of those cameras whose recordings need it, which is said on standard error. What cannot be read is
/// said when the recording is read for its hands; of pictures of several sizes no scene is learnt.
pub(crate) fn learn<'a>(
    recordings: impl Iterator<Item = (&'a Camera, &'a Path)>,
) -> BTreeMap<String, SceneModel> {
    let recordings: Vec<_> = recordings.collect();
    let skin = SkinModel::builtin();
    let mut scenes = BTreeMap::new();
    let bar = Bar::new();
    bar.begin("look at what stands still", recordings.len());
    for (camera, path) in recordings {
        let photographs = some_of(path);
        if let Ok(Some(scene)) = SceneModel::learn(&photographs, &skin) {
            bar.say(&format!(
                "camera '{}': what stands still looks like skin; its colours were learnt from {} pictures; \
                 --segment skin goes by colour alone",
                camera.name,
                photographs.len()
            ));
            scenes.insert(camera.name.clone(), scene);
        }
        bar.step();
    }
    scenes
}

/// Some photographs of a recording, from everywhere in its beginning.
fn some_of(path: &Path) -> Vec<RgbImage> {
    let Ok(mut recording) = super::open(path) else { return Vec::new() };
    let frames = recording.stamps().len().min(MOST_FRAMES);
    let some = spread_subset(frames, SceneModel::PICTURES, SUBSET_SEED);
    let read = some.into_iter().filter_map(|frame| recording.read(frame).ok());
    read.map(|picture| photograph_from(&picture)).collect()
}
