//! `phalanx view`.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use glam::DVec2;
use image::codecs::jpeg::JpegEncoder;
use phalanx::draw_silhouette;
use phalanx_camera::{Camera, Rig};
use phalanx_cli::files::Output;
use phalanx_io::page::{ViewPicture, ViewPictures, view_page};
use phalanx_io::take::{Take, TakeFrame, TakeHeader};
use phalanx_segmentation::Contour;

use crate::{input, take_file};

/// More pictures make a page that browsers open slowly; of more some are taken, evenly spaced.
const MOST_PICTURES: usize = 600;
/// Wider pictures are made smaller, px.
const WIDEST: u32 = 640;
/// The quality of the pictures in the page, of 100.
const JPEG_QUALITY: u8 = 75;

#[derive(Args)]
pub(crate) struct Arguments {
    /// The take: .csv, .jsonl or .npz.
    #[arg(value_name = "TAKE")]
    take: PathBuf,
    /// The recording's pictures: a folder for each camera, named like it, in which the pictures in
    /// the order of their names are the frames that the take numbers from 0.
    #[arg(long, value_name = "DIR", requires = "rig")]
    frames: Option<PathBuf>,
    /// The cameras, to draw the estimated hand over their pictures.
    #[arg(long, value_name = "RIG.toml", requires = "frames")]
    rig: Option<PathBuf>,
    /// Where the page goes.
    #[arg(long, value_name = "FILE.html")]
    out: PathBuf,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    if take_file::extension(&arguments.out) != "html" {
        bail!("{}: the page is HTML; name it so", arguments.out.display());
    }
    let output = Output::new(&arguments.out, &[&arguments.take])?;
    let take = take_file::read(&arguments.take)?;
    let pictures = match (&arguments.frames, &arguments.rig) {
        (Some(frames), Some(rig)) => pictures(&take, frames, rig)?,
        _ => Vec::new(),
    };
    let page = view_page(&take, &take_file::name(&arguments.take), &pictures)?;
    output.write(page.as_bytes())
}

/// The pictures of the cameras that the take, the rig and the folder all have.
fn pictures(take: &Take, folder: &Path, rig: &Path) -> Result<Vec<ViewPictures>> {
    let text = std::fs::read_to_string(rig).with_context(|| rig.display().to_string())?;
    let rig = Rig::from_toml(&text).with_context(|| rig.display().to_string())?;
    let views = &take.header.views;
    let cameras: Vec<&Camera> = rig
        .cameras
        .iter()
        .filter(|camera| views.contains(&camera.name) && folder.join(&camera.name).is_dir())
        .collect();
    ensure!(
        !cameras.is_empty(),
        "{}: no folder is named as a camera of the take and the rig ({})",
        folder.display(),
        views.join(", ")
    );
    let most = MOST_PICTURES / cameras.len();
    let of_camera = |camera: &&Camera| of_camera(take, folder, camera, most);
    cameras.iter().map(of_camera).collect()
}

fn of_camera(take: &Take, folder: &Path, camera: &Camera, most: usize) -> Result<ViewPictures> {
    let paths = sorted(&folder.join(&camera.name))?;
    let step = take.frames.len().div_ceil(most).max(1);
    let size = |length: u32| (length * WIDEST).div_ceil(camera.intrinsics.width.max(WIDEST));
    let [width, height] = [camera.intrinsics.width, camera.intrinsics.height].map(size);
    let mut pictures = Vec::new();
    for (frame, this) in take.frames.iter().enumerate().step_by(step) {
        let Some(path) = usize::try_from(this.index).ok().and_then(|k| paths.get(k)) else {
            continue;
        };
        let picture = input::picture(path, None)?.resize_exact(
            width,
            height,
            image::imageops::FilterType::Triangle,
        );
        let mut jpeg = Vec::new();
        let encoder = JpegEncoder::new_with_quality(&mut jpeg, JPEG_QUALITY);
        picture
            .to_rgb8()
            .write_with_encoder(encoder)
            .with_context(|| path.display().to_string())?;
        let scale = f64::from(width) / f64::from(camera.intrinsics.width);
        let joints = std::array::from_fn(|joint| {
            let at = this.estimate.as_ref()?.joints[joint];
            camera.project(at).map(|at| at * scale)
        });
        let outline = outline(take, this, camera, (width, height));
        pictures.push(ViewPicture { frame, jpeg, joints, outline });
    }
    Ok(ViewPictures { name: camera.name.clone(), width, height, pictures })
}

/// The outline of a frame's estimated hand in a picture of a size; empty where there is none or it is out of
/// sight.
fn outline(
    take: &Take,
    frame: &TakeFrame,
    camera: &Camera,
    (width, height): (u32, u32),
) -> Vec<Vec<DVec2>> {
    let TakeHeader { hand, world_from_hand, .. } = &take.header;
    let Some(estimate) = &frame.estimate else { return Vec::new() };
    let camera = camera.with_intrinsics(camera.intrinsics.resized(width, height));
    let Ok(mask) = draw_silhouette(&camera, hand, &estimate.pose, world_from_hand) else {
        return Vec::new();
    };
    let piece = |piece: &[[f64; 2]]| piece.iter().copied().map(DVec2::from_array).collect();
    Contour::trace(&mask).pieces().map(piece).collect()
}

/// A folder's files in the order of their names.
fn sorted(folder: &Path) -> Result<Vec<PathBuf>> {
    let name = || folder.display().to_string();
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder).with_context(name)? {
        paths.push(entry.with_context(name)?.path());
    }
    paths.sort_unstable();
    Ok(paths)
}
