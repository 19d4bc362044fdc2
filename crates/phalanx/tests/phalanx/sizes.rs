//! Pictures of other sizes than the rig's give the answers of its own size, end to end.

use glam::DVec2;
use image::{Rgb, RgbImage};
use phalanx::{
    Augmentation, Estimate, Estimator, Framing, NoProgress, Picture, Preset, Refiner, SceneSampler,
    SceneSource, Segmenter, Trainer, Workspace, draw_overlay, draw_silhouette, draw_window_overlay,
    working_window,
};
use phalanx_camera::Rig;
use phalanx_hand::{Dof, HandShape, JOINTS, Pose};
use phalanx_refine::{BundleAdjustment, NuisanceParameters, PoseFitSettings};
use phalanx_render::{Appearance, Renderer};
use phalanx_segmentation::{Mask, Silhouette, SkinModel};

/// Sizes of pictures, of the rig's. A half is for rigs as large as this one: less than the working size is
/// another matter.
const SIZES: [f64; 4] = [0.5, 1.5, 2.7, 4.0];
/// Hands that were not learnt from.
const HANDS: usize = 5;
/// How far apart answers to the middle one of the hands may be: an estimate's numbers of their deviation, any joint, mm,
/// and the overlays of all of a picture's width. Windows find wrists some pixels off where borders are drawn
/// otherwise; pixels of another size are worth a hundred millimetres.
const MOST: [f64; 3] = [0.5, 10.0, 0.03];

/// What overlays draw the observed and the estimated hand in.
const OBSERVED: Rgb<u8> = Rgb([40, 220, 90]);
const ESTIMATED: Rgb<u8> = Rgb([230, 40, 160]);

/// The desk's cameras with pictures of 640×480.
fn rig(cameras: &[&str]) -> Rig {
    let desk = Rig::from_toml(include_str!("../../fixtures/desk.toml")).unwrap();
    resized(&desk.select(cameras).unwrap(), (640, 480))
}

fn resized(rig: &Rig, (width, height): (u32, u32)) -> Rig {
    let mut rig = rig.clone();
    for camera in &mut rig.cameras {
        camera.intrinsics = camera.intrinsics.resized(width, height);
    }
    rig
}

/// Pictures of a posed hand before the cameras, of a size.
struct Views {
    size: (u32, u32),
    masks: Vec<Mask>,
    photographs: Vec<RgbImage>,
}

impl Views {
    fn of(rig: &Rig, pose: &Pose, times: f64) -> Self {
        let size = [640.0, 480.0].map(|side| (times * side) as u32).into();
        let solids = HandShape::adult().pose(pose, &rig.volume.rest_frame()).primitives;
        let (mut masks, mut photographs) = (Vec::new(), Vec::new());
        for camera in &resized(rig, size).cameras {
            let mut renderer = Renderer::new(camera).unwrap();
            masks.push(renderer.silhouette(&solids).unwrap().into());
            photographs.push(renderer.shade(&solids, &Appearance::default(), 3).unwrap());
        }
        Self { size, masks, photographs }
    }

    /// What is said of the masks, and of the photographs.
    fn estimates(&self, estimator: &Estimator) -> [Estimate; 2] {
        let skin = Segmenter::Skin(SkinModel::builtin());
        let masks: Vec<_> = self.masks.iter().map(Picture::Mask).collect();
        let photographs: Vec<_> =
            self.photographs.iter().map(|image| Picture::Photograph(image, &skin)).collect();
        [masks, photographs]
            .map(|pictures| estimator.estimate(&pictures, &mut Workspace::default()).unwrap())
    }
}

/// The mean place of what an overlay draws of the observed and of the estimated hand, of the picture's width.
fn overlay(estimator: &Estimator, estimate: &Estimate, (width, height): (u32, u32)) -> Vec<DVec2> {
    let rig = estimator.rig();
    let rest = rig.volume.rest_frame();
    let mut places = Vec::new();
    for view in &estimate.observation.views {
        let camera = view.window.as_ref().map_or(&rig.cameras[view.camera], |seen| &seen.camera);
        let drawn = draw_silhouette(camera, estimator.hand(), &estimate.pose, &rest).unwrap();
        let drawn = Silhouette::from_mask(&drawn).unwrap();
        for (estimated, colour) in [(None, OBSERVED), (Some(&drawn), ESTIMATED)] {
            let mut canvas = RgbImage::new(width, height);
            if let Some(window) = &view.window {
                draw_window_overlay(&mut canvas, window, &view.silhouette, estimated);
            } else {
                let window = working_window((width, height)).unwrap();
                let rule = estimator.orientation();
                draw_overlay(&mut canvas, window, &view.silhouette, rule, estimated);
            }
            places.push(mean_place(&canvas, colour) / f64::from(width));
        }
    }
    places
}

fn mean_place(canvas: &RgbImage, colour: Rgb<u8>) -> DVec2 {
    let drawn = canvas.enumerate_pixels().filter(|(.., pixel)| **pixel == colour);
    let (sum, count) = drawn.fold((DVec2::ZERO, 0.0), |(sum, count), (x, y, _)| {
        (sum + DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5), count + 1.0)
    });
    sum / count
}

/// How far apart two answers are: of a deviation, and joints, mm, at most.
fn apart(usual: &Estimate, other: &Estimate) -> [f64; 2] {
    let deviations = Dof::ALL.into_iter().filter_map(|dof| {
        Some((usual.pose[dof] - other.pose[dof]).abs() / usual.std[dof.index()]?)
    });
    let joints = (0..JOINTS).map(|joint| usual.joints[joint].distance(other.joints[joint]));
    [deviations.fold(0.0, f64::max), joints.fold(0.0, f64::max)]
}

/// The hand that some estimates show.
fn calibrated(estimator: &Estimator, estimates: &[Estimate]) -> HandShape {
    let nuisance = Some(NuisanceParameters::default());
    let settings = PoseFitSettings { nuisance, ..PoseFitSettings::default() };
    let refiner = Refiner::for_estimator(estimator, settings).unwrap();
    let frames: Vec<_> =
        estimates.iter().map(|estimate| refiner.frame(estimate).unwrap()).collect();
    refiner.calibrate(&BundleAdjustment::default(), &frames).unwrap().hand
}

/// All that is said of some hands in pictures of a size, of masks and of photographs.
struct Answers {
    estimates: Vec<Estimate>,
    refined: Vec<Estimate>,
    overlays: Vec<DVec2>,
    hand: HandShape,
}

fn answers(estimator: &Estimator, poses: &[Pose], times: f64) -> [Answers; 2] {
    let refiner = Refiner::for_estimator(estimator, PoseFitSettings::of_strangers()).unwrap();
    let views: Vec<Views> =
        poses.iter().map(|pose| Views::of(estimator.rig(), pose, times)).collect();
    let estimates: Vec<_> = views.iter().map(|views| views.estimates(estimator)).collect();
    [0, 1].map(|kind| {
        let estimates: Vec<Estimate> = estimates.iter().map(|both| both[kind].clone()).collect();
        let refine = |estimate: &Estimate| {
            refiner.refine_estimate(estimator, estimate.clone()).unwrap().refined
        };
        let overlays = views.iter().zip(&estimates);
        Answers {
            refined: estimates.iter().map(refine).collect(),
            overlays: overlays.flat_map(|(v, e)| overlay(estimator, e, v.size)).collect(),
            hand: calibrated(estimator, &estimates),
            estimates,
        }
    })
}

impl Answers {
    /// Says how far others are from these, hand by hand, and whether that is too far. A few pixels of a border may lead
    /// a fit to another minimum, so that the middle hand counts, and of refined estimates, whose deviations are some
    /// tenths of a degree, the joints.
    fn disagree(&self, other: &Self, name: &str) -> bool {
        let sorted = |these: &[Estimate], others: &[Estimate]| {
            let apart: Vec<_> = these.iter().zip(others).map(|(a, b)| apart(a, b)).collect();
            [0, 1].map(|k| {
                let mut all: Vec<f64> = apart.iter().map(|apart| apart[k]).collect();
                all.sort_by(f64::total_cmp);
                all
            })
        };
        let estimated = sorted(&self.estimates, &other.estimates);
        let refined = sorted(&self.refined, &other.refined);
        let overlays = self.overlays.iter().zip(&other.overlays);
        let drawn = overlays.map(|(this, other)| this.distance(*other)).fold(0.0, f64::max);
        let [this, other] = [&self.hand, &other.hand]
            .map(|hand| hand.pose(&Pose::REST, &glam::DAffine3::IDENTITY).joints);
        let hand = this.iter().zip(&other).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
        println!(
            "{name}: estimated {:.2?} σ {:.1?} mm, refined {:.2?} σ {:.1?} mm, overlay {drawn:.4}, hand {hand:.1} mm",
            estimated[0], estimated[1], refined[0], refined[1],
        );
        let [deviations, mm, width] = MOST;
        estimated[0][HANDS / 2] > deviations
            || estimated[1][HANDS / 2] > mm
            || refined[1][HANDS / 2] > mm
            || hand > mm
            || drawn > width
    }
}

#[test]
#[ignore = "trains three models and draws pictures of up to five megapixels"]
fn pictures_of_any_size_give_the_same_answers() {
    let mut disagreeing = Vec::new();
    for (name, framing, cameras) in [
        ("whole pictures", Framing::Picture, &["side", "top", "other_side"][..]),
        ("windows", Framing::Window, &["side", "top", "other_side"]),
        ("windows of two views", Framing::Window, &["side", "top"]),
    ] {
        let (rig, hand) = (rig(cameras), HandShape::adult());
        let trainer = Trainer::preset(Preset::Fast).framing(framing);
        let estimator = trainer.fit(&rig, &hand, &NoProgress).unwrap();
        let augmentation = Augmentation::NONE;
        let sampler = SceneSampler { augmentation, ..trainer.sampler().with_seed(21) };
        let scenes = sampler.scenes(&rig, &hand, HANDS);
        let poses: Vec<Pose> = (0..HANDS).map(|number| scenes.scene(number).pose).collect();
        let usual = answers(&estimator, &poses, 1.0);
        for times in SIZES {
            let others = answers(&estimator, &poses, times);
            for (kind, (usual, other)) in
                ["masks", "photographs"].iter().zip(usual.iter().zip(&others))
            {
                let name = format!("{name}, {kind}, ×{times}");
                if usual.disagree(other, &name) {
                    disagreeing.push(name);
                }
            }
        }
    }
    assert!(disagreeing.is_empty(), "{disagreeing:#?}");
}
