//! Contact sheets: what was seen in each frame.

use std::path::Path;

use anyhow::Result;
use glam::DAffine3;
use image::{Rgb, RgbImage, imageops};
use phalanx::{WORKING_SIZE, Window};
use phalanx_hand::{HandShape, Pose};
use phalanx_render::Renderer;
use phalanx_segmentation::{Mask, Silhouette};

use super::{Look, Seen};
use crate::figures::mosaic::mosaic;
use crate::files;

/// Frames on a sheet, beside each other and below.
const COLUMNS: u32 = 3;
const ROWS: u32 = 6;
/// Height of a panel, px.
const HEIGHT: u32 = 180;
const SKIN: Rgb<u8> = Rgb([40, 220, 90]);
const WRIST: Rgb<u8> = Rgb([255, 210, 0]);
const FRAME: Rgb<u8> = Rgb([230, 40, 160]);

/// One row of panels for each frame: in each view the photograph with the mask's border, the wrist
/// and the window, and what the window shows with the silhouette's contour.
pub(super) fn write(folder: &Path, looks: &[Look]) -> Result<()> {
    let panels: Vec<RgbImage> = looks.iter().map(panel).collect();
    let sheet = (COLUMNS * ROWS) as usize;
    for (panels, number) in panels.chunks(sheet).zip(1..) {
        let path = folder.join(format!("windows-{number}.png"));
        files::write_png(&path, &mosaic(panels, COLUMNS, 6))?;
    }
    Ok(())
}

/// One row for each frame, as of [`fit`].
pub(super) fn write_fits(
    folder: &Path,
    name: &str,
    looks: &[&Look],
    hand: &HandShape,
    rest: &DAffine3,
    poses: &[Pose],
) -> Result<()> {
    let mut panels = Vec::new();
    for (look, pose) in looks.iter().zip(poses) {
        panels.extend(fit(look, hand, rest, pose)?);
    }
    let sheet = (COLUMNS * ROWS) as usize;
    for (panels, number) in panels.chunks(sheet).zip(1..) {
        let path = folder.join(format!("{name}-{number}.png"));
        files::write_png(&path, &mosaic(panels, COLUMNS, 6))?;
    }
    Ok(())
}

/// The photograph through each window, the silhouette's contour (green) and that of a fitted hand
/// (magenta); nothing where no hand was found.
pub(super) fn fit(
    look: &Look,
    hand: &HandShape,
    rest: &DAffine3,
    pose: &Pose,
) -> Result<Option<RgbImage>> {
    let Ok(seen) = &look.seen else { return Ok(None) };
    let solids = hand.pose(pose, rest).primitives;
    let mut views = Vec::new();
    for (view, window) in seen.windows.iter().enumerate() {
        let drawn = Renderer::new(&window.camera)?.silhouette(&solids)?;
        let mut panel = through(&look.images[view], window, &seen.silhouettes[view]);
        if let Ok(drawn) = Silhouette::from_mask(&drawn.into()) {
            trace(&mut panel, &drawn, FRAME, 1);
        }
        views.push(panel);
    }
    Ok(Some(beside(&views)))
}

fn panel(look: &Look) -> RgbImage {
    let seen = look.seen.as_ref().ok();
    let mut panels = Vec::new();
    for view in 0..look.images.len() {
        let mut photograph = look.images[view].clone();
        outline(&mut photograph, &look.masks[view]);
        let window = seen.map(|Seen { windows, silhouettes, .. }| {
            draw_window(&mut photograph, &windows[view]);
            through(&look.images[view], &windows[view], &silhouettes[view])
        });
        let width = photograph.width() * HEIGHT / photograph.height();
        panels.push(imageops::resize(&photograph, width, HEIGHT, imageops::FilterType::Triangle));
        panels.extend(window);
    }
    beside(&panels)
}

/// Pictures of one height in a row.
fn beside(panels: &[RgbImage]) -> RgbImage {
    const GAP: u32 = 2;
    let width = panels.iter().map(|panel| panel.width() + GAP).sum::<u32>() - GAP;
    let mut row = RgbImage::new(width, HEIGHT);
    let mut x = 0;
    for panel in panels {
        imageops::replace(&mut row, panel, x, 0);
        x += i64::from(panel.width() + GAP);
    }
    row
}

/// Colours the mask's border.
fn outline(picture: &mut RgbImage, mask: &Mask) {
    let is_skin = |x: u32, y: u32| mask.is_hand(x, y);
    for y in 1..mask.height() {
        for x in 1..mask.width() {
            if is_skin(x, y) != is_skin(x - 1, y) || is_skin(x, y) != is_skin(x, y - 1) {
                dot(picture, [f64::from(x), f64::from(y)], 1, SKIN);
            }
        }
    }
}

fn dot(picture: &mut RgbImage, [x, y]: [f64; 2], radius: i64, colour: Rgb<u8>) {
    let (x, y) = (x as i64, y as i64);
    for y in y - radius..=y + radius {
        for x in x - radius..=x + radius {
            if (0..i64::from(picture.width())).contains(&x)
                && (0..i64::from(picture.height())).contains(&y)
            {
                picture.put_pixel(x as u32, y as u32, colour);
            }
        }
    }
}

/// The wrist, a line as long as the hand, and the window's border.
fn draw_window(picture: &mut RgbImage, window: &Window) {
    let hand = &window.hand;
    dot(picture, hand.wrist, 8, WRIST);
    for step in 0..200 {
        let along = hand.length * f64::from(step) / 200.0;
        let point = [0, 1].map(|k| hand.wrist[k] + along * hand.direction[k]);
        dot(picture, point, 2, WRIST);
    }
    let (width, height) = (f64::from(WORKING_SIZE.0), f64::from(WORKING_SIZE.1));
    for step in 0..500 {
        let share = f64::from(step) / 500.0;
        let (x, y) = (share * width, share * height);
        for point in [[x, 0.0], [x, height], [0.0, y], [width, y]] {
            if let Some(point) = window.to_picture(point) {
                dot(picture, point, 2, FRAME);
            }
        }
    }
}

/// The photograph through the window, and the silhouette's contour.
fn through(image: &RgbImage, window: &Window, silhouette: &Silhouette) -> RgbImage {
    let times = f64::from(HEIGHT) / f64::from(WORKING_SIZE.1);
    let width = (f64::from(WORKING_SIZE.0) * times) as u32;
    let mut view = RgbImage::from_fn(width, HEIGHT, |x, y| {
        let pixel = [f64::from(x), f64::from(y)].map(|c| (c + 0.5) / times);
        let inside = |[x, y]: [f64; 2]| {
            (x >= 0.0 && y >= 0.0).then(|| image.get_pixel_checked(x as u32, y as u32)).flatten()
        };
        window.to_picture(pixel).and_then(inside).copied().unwrap_or(Rgb([0, 0, 0]))
    });
    trace(&mut view, silhouette, SKIN, 0);
    view
}

/// Colours the contour of what a window shows, in the enlarged window.
fn trace(view: &mut RgbImage, silhouette: &Silhouette, colour: Rgb<u8>, radius: i64) {
    let times = f64::from(HEIGHT) / f64::from(WORKING_SIZE.1);
    for &[x, y] in &silhouette.contour.points {
        dot(view, [x * times, y * times], radius, colour);
    }
}
