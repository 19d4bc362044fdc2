//! What is said of a fitted frame.

use glam::{DAffine3, DVec3};
use phalanx_camera::Camera;
use phalanx_hand::{Dof, JOINTS, Pose};
use phalanx_refine::{Agreement, Posterior, SilhouetteObservation};

use super::flesh;
use super::found::Found;
use super::frame_fit::FrameFitter;
use super::known::Known;
use super::misfit;
use super::mistake::Mistake;
use super::starts;
use super::views;
use crate::error::Result;

/// A fitted frame.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameFit {
    /// The pose, in the take's volume; radians and mm.
    pub pose: Pose,
    /// Standard deviation of each number of the pose, in its unit.
    pub std: [f64; Dof::COUNT],
    /// The 21 joints in the world, mm.
    pub joints: [DVec3; JOINTS],
    /// Root mean square distance of each joint from where it is said to be, mm: what views and hand leave
    /// open, and that a joint may lie anywhere in the flesh about it, which no silhouette tells.
    pub joint_std: [f64; JOINTS],
    /// What became of each view, in the order of the cameras.
    pub views: Vec<ViewFit>,
    /// Why the pose may be wrong; none of a pose that agrees with what was seen.
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
    /// Whether its mask was used; not where it contradicts the other views, or there is no hand in it.
    pub is_mask_used: bool,
    /// What became of the camera's landmarks; `None` of a camera without any.
    pub landmarks: Option<LandmarkFit>,
}

/// What became of the landmarks of one camera of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LandmarkFit {
    /// Whether they were used; not where they contradict the other views.
    pub is_used: bool,
    /// Median distance of the joints, projected by the camera, from their points, px.
    pub distance_px: f64,
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
    /// A hand of the other side explains the take better: every pose may be wrong.
    OtherSide,
    /// The take is explained better if two cameras' pictures are exchanged: every pose may be wrong.
    Exchanged {
        /// The cameras' numbers.
        views: [usize; 2],
    },
    /// What hangs together with the hand looks more like a hand than like its arm: the hand may be at the arm's other end.
    OtherEnd,
    /// A view that was used shows something else than the pose.
    PoorFit {
        /// The view's number, in the order of the cameras.
        view: usize,
        /// Share of its border that the pose leaves unexplained, 0 to 1.
        unexplained: f64,
        /// Intersection over union of the drawn and the observed silhouette.
        overlap: f64,
    },
    /// The landmarks of a camera that were used are of something else than the pose.
    PoorLandmarks {
        /// The camera's number.
        view: usize,
        /// How much of them the pose leaves unexplained, 0 to 1.
        unexplained: f64,
    },
    /// Part of the hand is beyond the border of a view's picture, or the pose points another way than the
    /// hand that leaves the picture there; and no two views show all of it.
    CutOff {
        /// The view's number, in the order of the cameras.
        view: usize,
    },
}

impl From<Mistake> for FitDoubt {
    fn from(mistake: Mistake) -> Self {
        match mistake {
            Mistake::OtherSide => Self::OtherSide,
            Mistake::Exchanged(views) => Self::Exchanged { views },
        }
    }
}

/// What frames are reported with.
pub(super) struct Reporter<'a> {
    pub(super) cameras: &'a [Camera],
    /// Fits with the hand, its views weighted as their borders are known.
    pub(super) fitter: &'a FrameFitter<'a>,
    pub(super) known: &'a Known,
    pub(super) rest: DAffine3,
}

impl Reporter<'_> {
    /// The report of a frame.
    pub(super) fn report(&self, found: &Found) -> Result<FrameFit> {
        self.report_beside(found, self.fitter.silhouettes(found))
    }

    /// The same of a frame whose views show these silhouettes.
    pub(super) fn report_beside(
        &self,
        found: &Found,
        silhouettes: Vec<Option<SilhouetteObservation>>,
    ) -> Result<FrameFit> {
        let (fitter, hand) = (self.fitter, self.fitter.hand);
        let pose = found.pose_in(&self.rest, hand);
        let joints = hand.pose(&pose, &self.rest).joints;
        let mut doubts = Vec::from_iter(self.known.mistake.map(FitDoubt::from));
        let agreements = views::agreements(fitter, found, &silhouettes)?;
        let posterior =
            fitter.posterior(found, silhouettes, &self.known.hand.std)?.unwrap_or_else(|| {
                doubts.push(FitDoubt::Open);
                Posterior { std: [f64::INFINITY; Dof::COUNT], joints: [f64::INFINITY; JOINTS] }
            });
        let views: Vec<ViewFit> =
            (0..agreements.len()).map(|view| self.view(found, view, agreements[view])).collect();
        if found.backwards > DOUBTED_END {
            doubts.push(FitDoubt::OtherEnd);
        }
        for view in used(&views) {
            let Some(agreement) = agreements[view].filter(|_| !found.left_out[view]) else {
                continue;
            };
            if misfit::is_poor(&agreement, found.cameras_used()) {
                let Agreement { iou: overlap, unexplained } = agreement;
                doubts.push(FitDoubt::PoorFit { view, unexplained, overlap });
            }
        }
        for (view, unexplained) in views::points_unexplained(fitter, found)?.into_iter().enumerate()
        {
            let used = unexplained.filter(|_| !found.left_out_points(view));
            if let Some(unexplained) = used.filter(|used| misfit::of_points(*used) > 1.0) {
                doubts.push(FitDoubt::PoorLandmarks { view, unexplained });
            }
        }
        doubts.extend(self.cut_off(found, &views, &joints));
        let flesh = flesh::joint_std_mm(hand);
        Ok(FrameFit {
            pose,
            std: posterior.std,
            joints,
            joint_std: std::array::from_fn(|joint| posterior.joints[joint].hypot(flesh[joint])),
            views,
            doubts,
            converged: found.refined.converged,
        })
    }

    /// What became of a view, whose mask agrees so well with the pose.
    fn view(&self, found: &Found, view: usize, agreement: Option<Agreement>) -> ViewFit {
        let landmarks = self.landmarks(found, view);
        let is_mask_used = agreement.is_some() && !found.left_out[view];
        let missing = match (agreement, landmarks) {
            _ if is_mask_used || landmarks.is_some_and(|landmarks| landmarks.is_used) => None,
            (None, None) => Some(Missing::NoHand),
            _ => Some(Missing::Disagrees),
        };
        let overlap = agreement.map(|agreement| agreement.iou);
        ViewFit { missing, overlap, is_mask_used, landmarks }
    }

    /// What became of a camera's landmarks.
    fn landmarks(&self, found: &Found, view: usize) -> Option<LandmarkFit> {
        let (fitter, hand) = (self.fitter, self.fitter.hand);
        let seen = fitter.points_of(&found.points, view, &found.frame(hand))?;
        let residuals = seen.residuals(hand, &found.rest, &found.refined.pose);
        let mut distances: Vec<f64> = residuals.iter().flatten().map(|px| px.length()).collect();
        distances.sort_by(f64::total_cmp);
        let distance_px = *distances.get(distances.len() / 2)?;
        Some(LandmarkFit { is_used: !found.left_out_points(view), distance_px })
    }

    /// The views whose pictures lack part of the hand, where no two views that are used show all of it.
    fn cut_off(
        &self,
        found: &Found,
        views: &[ViewFit],
        joints: &[DVec3; JOINTS],
    ) -> impl Iterator<Item = FitDoubt> {
        // Pictures may end at the wrist as they may end behind it.
        let shows_all = |view: usize| {
            self.cameras[view].sees_all(&joints[1..]) && !self.fitter.leaves_picture(found, view)
        };
        let whole = used(views).filter(|&view| shows_all(view)).count();
        let is_cut_off =
            |&view: &usize| views[view].missing != Some(Missing::Disagrees) && !shows_all(view);
        let cut_off: Vec<usize> = (0..views.len()).filter(is_cut_off).collect();
        let doubted = if whole < ENOUGH.min(views.len()) { cut_off } else { Vec::new() };
        doubted.into_iter().map(|view| FitDoubt::CutOff { view })
    }

    /// A frame in which no view shows a hand, where it is expected to be.
    pub(super) fn unseen(&self, pose: &Pose, rest: &DAffine3) -> FrameFit {
        let pose = starts::in_frame(pose, rest, &self.rest, self.fitter.hand);
        FrameFit {
            pose,
            std: [f64::INFINITY; Dof::COUNT],
            joints: self.fitter.hand.pose(&pose, &self.rest).joints,
            joint_std: [f64::INFINITY; JOINTS],
            views: vec![NOTHING; self.cameras.len()],
            doubts: vec![FitDoubt::NotSeen],
            converged: false,
        }
    }

    /// A frame in which no view shows a hand, beside the nearest that does.
    pub(super) fn not_seen(&self, nearest: &FrameFit) -> FrameFit {
        FrameFit {
            views: vec![NOTHING; self.cameras.len()],
            doubts: vec![FitDoubt::NotSeen],
            converged: false,
            ..nearest.clone()
        }
    }
}

/// A hand is doubted that is at the arm's other end in nine of ten such frames.
const DOUBTED_END: f64 = 0.9;

/// So many views that show the whole hand place it in space.
const ENOUGH: usize = 2;

/// The views that were used.
fn used(views: &[ViewFit]) -> impl Iterator<Item = usize> {
    (0..views.len()).filter(|&view| views[view].missing.is_none())
}

/// A view that shows no hand.
const NOTHING: ViewFit =
    ViewFit { missing: Some(Missing::NoHand), overlap: None, is_mask_used: false, landmarks: None };

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
