//! What is said of a fitted frame.

use glam::{DAffine3, DVec3};
use phalanx_camera::Camera;
use phalanx_hand::{Dof, JOINTS, Pose};
use phalanx_refine::Posterior;

use super::frame_fit::{Found, FrameFitter};
use super::proportions::KnownHand;
use super::views::{self, Usual};
use crate::Result;

/// A fitted frame.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameFit {
    /// The pose, in the take's volume; radians and mm.
    pub pose: Pose,
    /// Standard deviation of each number of the pose, in its unit.
    pub std: [f64; Dof::COUNT],
    /// The 21 joints in the world, mm.
    pub joints: [DVec3; JOINTS],
    /// Root mean square distance of each joint from where it is said to be, mm.
    pub joint_std: [f64; JOINTS],
    /// What became of each view, in the order of the cameras.
    pub views: Vec<ViewFit>,
    /// Why the pose may be wrong; none of a pose that explains what was seen as well as is usual.
    pub doubts: Vec<FitDoubt>,
    /// Whether the fit ended where the energy has a minimum.
    pub converged: bool,
}

/// What became of one view of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewFit {
    /// Why the view was not used; `None` if it was.
    pub missing: Option<Missing>,
    /// Intersection over union of the drawn and the observed silhouette, of what is known; `None` where
    /// nothing was observed.
    pub overlap: Option<f64>,
}

/// Why a view was not used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Missing {
    /// Nothing like a hand is seen where the other views say that it is.
    NoHand,
    /// What it shows contradicts the other views.
    Disagrees,
}

/// Why a pose may be wrong.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum FitDoubt {
    /// No view shows a hand; the pose is that of the nearest frame that does.
    NotSeen,
    /// The views leave the pose open; its deviations are infinite.
    Open,
    /// More of the borders is left unexplained than is usual: this share, of at most so much.
    PoorFit {
        /// Share of the borders, 0 to 1.
        unexplained: f64,
        /// What is usual at most.
        usual: f64,
    },
    /// Part of the hand is beyond the border of a view's picture.
    CutOff {
        /// The view's number, in the order of the cameras.
        view: usize,
    },
}

/// What frames are reported with.
pub(super) struct Reporter<'a> {
    pub(super) cameras: &'a [Camera],
    /// Fits with the hand, its views weighted as their borders are known.
    pub(super) fitter: &'a FrameFitter<'a>,
    pub(super) hand: &'a KnownHand,
    pub(super) rest: DAffine3,
    pub(super) usual: Usual,
}

impl Reporter<'_> {
    /// The report of a frame.
    pub(super) fn report(&self, found: &Found) -> Result<FrameFit> {
        let (fitter, hand) = (self.fitter, self.fitter.hand);
        let pose = found.pose_in(&self.rest, hand);
        let joints = hand.pose(&pose, &self.rest).joints;
        let frame = found.frame(hand);
        let evidence = fitter.evidence(&found.crops, &found.left_out, &frame);
        // About the hand's own frame, where no angle is near the edge of its range.
        let own = found.pose_in(&frame, hand);
        let known = &self.hand.std;
        let posterior =
            fitter.refinement.posterior(hand, &frame, &evidence, &own, fitter.prior, known);
        let mut doubts = Vec::new();
        let posterior = match posterior {
            Ok(posterior) => posterior,
            Err(phalanx_refine::Error::Precision { .. }) => {
                doubts.push(FitDoubt::Open);
                Posterior { std: [f64::INFINITY; Dof::COUNT], joints: [f64::INFINITY; JOINTS] }
            }
            Err(error) => return Err(error.into()),
        };
        let agreements = views::agreements(fitter, found)?;
        let views = agreements.iter().zip(&found.left_out).map(|(agreement, &left_out)| ViewFit {
            missing: match (agreement, left_out) {
                (None, _) => Some(Missing::NoHand),
                (_, true) => Some(Missing::Disagrees),
                _ => None,
            },
            overlap: agreement.map(|agreement| agreement.iou),
        });
        let views: Vec<ViewFit> = views.collect();
        let used = || (0..views.len()).filter(|&view| views[view].missing.is_none());
        let shares = used().filter_map(|view| Some(agreements[view]?.unexplained));
        let unexplained = shares.sum::<f64>() / used().count().max(1) as f64;
        if unexplained > self.usual.most {
            doubts.push(FitDoubt::PoorFit { unexplained, usual: self.usual.most });
        }
        let cut_off = used().filter(|&view| !self.cameras[view].sees_all(&joints));
        doubts.extend(cut_off.map(|view| FitDoubt::CutOff { view }));
        Ok(FrameFit {
            pose,
            std: posterior.std,
            joints,
            joint_std: posterior.joints,
            views,
            doubts,
            converged: found.refined.converged,
        })
    }

    /// A frame in which no view shows a hand, beside the nearest that does.
    pub(super) fn not_seen(&self, nearest: &FrameFit) -> FrameFit {
        let nothing = ViewFit { missing: Some(Missing::NoHand), overlap: None };
        FrameFit {
            views: vec![nothing; self.cameras.len()],
            doubts: vec![FitDoubt::NotSeen],
            converged: false,
            ..nearest.clone()
        }
    }
}

/// Whether a camera's picture shows points of the world.
trait SeesAll {
    fn sees_all(&self, points: &[DVec3]) -> bool;
}

impl SeesAll for Camera {
    fn sees_all(&self, points: &[DVec3]) -> bool {
        let is_seen =
            |&point: &DVec3| self.project(point).is_some_and(|at| self.intrinsics.contains(at));
        points.iter().all(is_seen)
    }
}
