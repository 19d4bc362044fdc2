//! Trains a skin model for one's own camera and light from pictures and their masks (over 127 is skin),
//! and says how many of their pixels it and the built-in model tell rightly:
//! `cargo run --release --example train_skin -- one.jpg one-mask.png two.jpg two-mask.png > skin.txt`

use std::io::Write;

use image::RgbImage;
use phalanx_segmentation::{Mask, SkinModel, SkinTrainer};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let paths: Vec<String> = std::env::args().skip(1).collect();
    let (pairs, []) = paths.as_chunks::<2>() else {
        return Err("usage: train_skin PICTURE MASK [PICTURE MASK ...]".into());
    };
    let mut examples = Vec::new();
    for [picture, mask] in pairs {
        examples.push((image::open(picture)?.to_rgb8(), Mask::from(image::open(mask)?.to_luma8())));
    }
    let mut trainer = SkinTrainer::default();
    for (picture, mask) in &examples {
        trainer.add_image(picture, mask)?;
    }
    let model = trainer.finish(&format!("{} pictures of one's own", pairs.len()))?;
    for (name, model) in [("built in", &SkinModel::builtin()), ("trained", &model)] {
        eprintln!("{name}: {:.1} % of the pixels", 100.0 * right(model, &examples));
    }
    std::io::stdout().write_all(&model.to_bytes())?;
    Ok(())
}

/// The share of all pixels that a model puts on the right side.
fn right(model: &SkinModel, examples: &[(RgbImage, Mask)]) -> f64 {
    let (mut right, mut all) = (0, 0);
    for (picture, mask) in examples {
        let found = model.classify(picture);
        right += found
            .iter()
            .zip(mask.iter())
            .filter(|(a, b)| Mask::is_hand_level(**a) == Mask::is_hand_level(**b))
            .count();
        all += mask.len();
    }
    right as f64 / all as f64
}
