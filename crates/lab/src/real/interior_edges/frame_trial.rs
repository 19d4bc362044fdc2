//! One frame, fitted by silhouettes alone and with edges inside them.

use anyhow::Result;
use glam::{DAffine3, DVec2};
use image::DynamicImage;
use phalanx::{FrameFit, Mask, TakeFit};
use phalanx_camera::Camera;
use phalanx_hand::{Dof, HandShape, Pose};
use phalanx_refine::{DrawnTerm, PoseFit, PoseFitSettings, PosePrior, SilhouetteObservation};

use super::information::{Seen, of_edges};
use super::photograph::Photograph;

/// How far off an edge inside the silhouette is, px: as far as silhouettes' borders are taken to be, half of it, and a
/// quarter.
pub(super) const NOISES: [f64; 3] = [2.0, 1.0, 0.5];

/// Standard deviation of a place of a silhouette's border, px.
const BORDER_NOISE: f64 = 2.0;

/// How often edges are looked for, each time about the pose that those before led to.
const ROUNDS: usize = 3;

/// One frame of a trial, ready to be fitted.
pub(super) struct FrameTrial<'a> {
    hand: &'a HandShape,
    rest: DAffine3,
    start: Pose,
    evidence: Vec<SilhouetteObservation>,
    views: Vec<Seen<'a>>,
    prior: PosePrior,
}

/// What came of a frame.
pub(super) struct Fitted {
    /// The pose by silhouettes, and those with edges known to each of [`NOISES`].
    pub(super) poses: Vec<Pose>,
    /// How many edges were found last.
    pub(super) edges: usize,
}

impl<'a> FrameTrial<'a> {
    /// Of a frame of a fitted take.
    ///
    /// # Errors
    /// Masks of another size than the cameras' pictures.
    pub(super) fn new(
        cameras: &'a [Camera],
        take: &'a TakeFit,
        fit: &FrameFit,
        masks: &[Option<Mask>],
        pictures: &[DynamicImage],
    ) -> Result<Self> {
        let rest = take.volume.volume.rest_frame();
        let (mut evidence, mut views) = (Vec::new(), Vec::new());
        for (k, camera) in cameras.iter().enumerate() {
            let Some(mask) = masks[k].as_ref().filter(|_| fit.views[k].is_mask_used) else {
                continue;
            };
            let [wrist, knuckle] = [0, 9].map(|joint| camera.project(fit.joints[joint]));
            let Some((wrist, knuckle)) = wrist.zip(knuckle) else { continue };
            // The arm behind the hand is not compared.
            let length = 2.0 * wrist.distance(knuckle);
            let is_known = |place: DVec2| place.distance(knuckle) < length;
            evidence.push(SilhouetteObservation::within(camera, mask, is_known)?);
            let photograph = Photograph::new(&pictures[k], mask.hand_pixels());
            views.push(Seen { camera, photograph });
        }
        let prior = PosePrior::independent(fit.pose, &deviations())?;
        Ok(Self { hand: &take.hand, rest, start: fit.pose, evidence, views, prior })
    }

    /// Fits it in every way.
    ///
    /// # Errors
    /// A hand that a camera cannot draw.
    pub(super) fn fitted(&self) -> Result<Fitted> {
        if self.evidence.is_empty() {
            return Ok(Fitted { poses: vec![self.start; NOISES.len() + 1], edges: 0 });
        }
        let alone = self.fit(&self.start, &self.prior)?.pose;
        let (mut poses, mut edges) = (vec![alone], 0);
        for noise in NOISES {
            let mut pose = alone;
            for _ in 0..ROUNDS {
                let (known, found) =
                    of_edges(&self.views, self.hand, &self.rest, &pose, &self.prior, noise)?;
                edges = found;
                pose = self.fit(&pose, &self.prior.product(&known)?)?.pose;
            }
            poses.push(pose);
        }
        Ok(Fitted { poses, edges })
    }

    fn fit(&self, start: &Pose, prior: &PosePrior) -> Result<PoseFit> {
        let mut settings = PoseFitSettings {
            max_restarts: 0,
            drawn: DrawnTerm::Area,
            ..PoseFitSettings::of_noise(BORDER_NOISE)
        };
        settings.levels.remove(0);
        for level in &mut settings.levels {
            level.every *= 2;
        }
        Ok(settings.fit(self.hand, &self.rest, &self.evidence, start, prior)?)
    }
}

/// How far a pose is from that of the take, radians and mm.
fn deviations() -> [f64; Dof::COUNT] {
    std::array::from_fn(|index| match Dof::ALL[index] {
        Dof::TX | Dof::TY | Dof::TZ => 10.0,
        Dof::ThetaX | Dof::ThetaY | Dof::ThetaZ => 0.2,
        Dof::WristDeviation | Dof::WristFlexion => 0.25,
        _ => 0.35,
    })
}
