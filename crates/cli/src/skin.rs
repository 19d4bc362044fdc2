//! `phalanx skin`: how to tell the hand from the rest, learnt from the user's own pictures.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use image::RgbImage;
use phalanx::{Segmentation, Segmenter, photograph_from};
use phalanx_cli::files::Output;
use phalanx_sampling::spread_subset;
use phalanx_segmentation::{BackgroundModel, BackgroundParams, Mask, SkinModel, SkinTrainer};
use serde_json::json;

use crate::counts::counted;
use crate::form::Form;
use crate::input;
use crate::mask::given_mask;
use crate::recording::Recording;
use crate::recording::pictures::PictureFolder;

/// More pictures of a camera tell little more; of more some are drawn, for every n-th of a motion that repeats itself
/// would show one posture.
const MOST_PICTURES: usize = 30;
/// The seed by which they are drawn.
const SUBSET_SEED: u64 = 0;

#[derive(Args)]
pub(crate) struct Arguments {
    /// Pictures without a hand, by the cameras that stand as they will: a folder with a folder for each camera,
    /// named like it. Alone they give a model of each camera's background.
    #[arg(long, value_name = "DIR")]
    empty: Option<PathBuf>,
    /// Pictures with the hand, in folders likewise. They give a model of the colour of skin; what is hand in
    /// them is what differs from the empty pictures, or is white in the masks.
    #[arg(long, value_name = "DIR")]
    hand: Option<PathBuf>,
    /// Masks of the pictures with the hand, in folders and with names likewise: brighter than 127 is hand.
    #[arg(long, value_name = "DIR", requires = "hand", conflicts_with = "empty")]
    masks: Option<PathBuf>,
    /// Where the model goes, for `--segment FILE`.
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    #[command(flatten)]
    form: Form,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let Arguments { empty, hand, masks, out, form } = arguments;
    let folders = [empty, hand, masks].into_iter().flatten().map(|folder| folders_in(folder));
    let output = Output::new(out, &folders.collect::<Result<Vec<_>>>()?.concat())?;
    let (segmentation, said, text) = match (empty, hand, masks) {
        (Some(empty), None, None) => backgrounds(empty)?,
        (Some(empty), Some(hand), None) => {
            let backgrounds = learnt_backgrounds(empty)?;
            skin(hand, &|camera: &str, _: &str, picture: &RgbImage| {
                let model = backgrounds.get(camera);
                let model = model.with_context(|| format!("no empty pictures of '{camera}'"))?;
                Ok(model.segment(picture)?)
            })?
        }
        (None, Some(hand), Some(masks)) => skin(hand, &|camera, name, _| {
            let folder = masks.join(camera);
            let folder =
                PictureFolder::open(&folder).with_context(|| folder.display().to_string())?;
            let at = folder.stamps().iter().position(|stamp| stamp.name == name);
            let at =
                at.with_context(|| format!("camera '{camera}': picture {name} has no mask"))?;
            let path = folder.path(at);
            given_mask(&input::picture(&path, None)?).with_context(|| path.display().to_string())
        })?,
        _ => bail!(
            "give --empty for a model of the background, or --hand with --empty or --masks for one of skin"
        ),
    };
    output.write(&segmentation.to_bytes()?)?;
    form.say(&output, &said, || text)
}

/// A segmentation, and what is said of it as JSON and as text.
type Learnt = (Segmentation, serde_json::Value, String);

fn backgrounds(empty: &Path) -> Result<Learnt> {
    let models = learnt_backgrounds(empty)?;
    let names: Vec<String> = models.keys().cloned().collect();
    let text = format!("backgrounds of the cameras {}", names.join(", "));
    let cameras =
        models.into_iter().map(|(name, model)| (name, Segmenter::Background(model))).collect();
    Ok((Segmentation::ByCamera(cameras), json!({ "kind": "background", "cameras": names }), text))
}

fn learnt_backgrounds(empty: &Path) -> Result<BTreeMap<String, BackgroundModel>> {
    let mut models = BTreeMap::new();
    for (camera, folder) in cameras(empty)? {
        let pictures = photographs(&folder)?;
        let pictures: Vec<RgbImage> = pictures.into_iter().map(|(_, picture)| picture).collect();
        let model = BackgroundModel::from_frames(&pictures, BackgroundParams::default());
        models.insert(camera.clone(), model.with_context(|| format!("camera '{camera}'"))?);
    }
    Ok(models)
}

/// Learns the colour of skin; `mask` tells what is hand in a camera's picture of a name.
fn skin(hand: &Path, mask: &dyn Fn(&str, &str, &RgbImage) -> Result<Mask>) -> Result<Learnt> {
    let mut trainer = SkinTrainer::default();
    let mut pairs = Vec::new();
    for (camera, folder) in cameras(hand)? {
        for (name, picture) in photographs(&folder)? {
            let mask = mask(&camera, &name, &picture)?;
            let named = || format!("camera '{camera}', picture {name}");
            trainer.add_image(&picture, &mask).with_context(named)?;
            pairs.push((picture, mask));
        }
    }
    let model = trainer.finish(&counted(pairs.len(), "picture"))?;
    let [found, wrong] = [true, false].map(|is_hand| share_of_skin(&model, &pairs, is_hand));
    let of_hand = share_of_hand(&pairs);
    if wrong * (1.0 - of_hand) > of_hand {
        eprintln!(
            "phalanx: more of the rest is taken for skin than there is hand: masks that are made with this model will \
             not do; take things of that colour out of the pictures, or use a model of the background (--empty alone)"
        );
    }
    let text = format!(
        "the colour of skin from {}: {:.0} % of the hand is told, {:.1} % of the rest is taken for it",
        counted(pairs.len(), "picture"),
        100.0 * found,
        100.0 * wrong
    );
    let said = json!({ "kind": "skin", "pictures": pairs.len(), "hand": found, "rest": wrong });
    Ok((Segmentation::Shared(Segmenter::Skin(model)), said, text))
}

/// The share of the pixels of hand, or of the others, that a model takes for skin.
fn share_of_skin(model: &SkinModel, pairs: &[(RgbImage, Mask)], of_hand: bool) -> f64 {
    let (mut skin, mut all) = (0_usize, 0_usize);
    for (picture, mask) in pairs {
        for (rgb, level) in picture.pixels().zip(mask.pixels()) {
            if (level.0[0] > 127) == of_hand {
                all += 1;
                skin += usize::from(model.is_skin(rgb.0));
            }
        }
    }
    skin as f64 / all.max(1) as f64
}

/// The share of all pixels that are hand.
fn share_of_hand(pairs: &[(RgbImage, Mask)]) -> f64 {
    let hand: usize = pairs.iter().map(|(_, mask)| mask.area()).sum();
    let all: usize = pairs.iter().map(|(_, mask)| mask.len()).sum();
    hand as f64 / all.max(1) as f64
}

/// The cameras' folders of pictures, by name.
fn cameras(folder: &Path) -> Result<Vec<(String, PictureFolder)>> {
    let opened = folders_in(folder)?.into_iter().map(|path| {
        let camera = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok((camera, PictureFolder::open(&path)?))
    });
    let cameras: Vec<_> = opened.collect::<Result<_>>()?;
    ensure!(!cameras.is_empty(), "{}: it has no folder for a camera", folder.display());
    Ok(cameras)
}

/// The folders in a folder, by name.
fn folders_in(folder: &Path) -> Result<Vec<PathBuf>> {
    let name = || folder.display().to_string();
    let mut folders = Vec::new();
    for entry in std::fs::read_dir(folder).with_context(name)? {
        folders.push(entry.with_context(name)?.path());
    }
    folders.retain(|path| path.is_dir());
    folders.sort();
    Ok(folders)
}

/// A folder's pictures with their names, of many some.
fn photographs(folder: &PictureFolder) -> Result<Vec<(String, RgbImage)>> {
    let stamps = folder.stamps();
    let chosen = spread_subset(stamps.len(), MOST_PICTURES, SUBSET_SEED);
    let read = |at: usize| {
        let picture = photograph_from(&input::picture(&folder.path(at), None)?);
        Ok((stamps[at].name.clone(), picture))
    };
    chosen.into_iter().map(read).collect()
}
