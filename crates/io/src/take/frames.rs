//! A take in memory: one hand over time, with what is known of how sure each number is.

use glam::{DAffine3, DVec3};
use phalanx_hand::{Bone, Digit, Dof, HandShape, JOINTS, Pose, PosedHand};
use serde::{Deserialize, Serialize};

/// The version of all three forms; a reader refuses a newer one by name.
pub const FORMAT_VERSION: u32 = 1;

/// The names of the 21 joints in files, in the order of [`PosedHand::joints`].
pub const JOINT_NAMES: [&str; JOINTS] = [
    "wrist",
    "thumb_cmc",
    "thumb_mcp",
    "thumb_ip",
    "thumb_tip",
    "index_mcp",
    "index_pip",
    "index_dip",
    "index_tip",
    "middle_mcp",
    "middle_pip",
    "middle_dip",
    "middle_tip",
    "ring_mcp",
    "ring_pip",
    "ring_dip",
    "ring_tip",
    "little_mcp",
    "little_pip",
    "little_dip",
    "little_tip",
];

/// One hand over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Take {
    /// What holds for all frames.
    pub header: TakeHeader,
    /// The frames, in the order of their times.
    pub frames: Vec<TakeFrame>,
}

/// What holds for all frames of a take.
#[derive(Debug, Clone, PartialEq)]
pub struct TakeHeader {
    /// The person's hand: which side, and the lengths of its bones, mm.
    pub hand: HandShape,
    /// From the frame of the hand at rest to the world, mm: a rotation and a shift. The world is
    /// that of the cameras' calibration.
    pub world_from_hand: DAffine3,
    /// The names of the cameras, all different.
    pub views: Vec<String>,
    /// The frame rate, Hz, if it is one. The frames' own times count.
    pub rate_hz: Option<f64>,
    /// The hash of the model file that made the take.
    pub model: Option<String>,
}

/// One instant of a take.
#[derive(Debug, Clone, PartialEq)]
pub struct TakeFrame {
    /// The frame's number in the recording; ascending.
    pub index: u64,
    /// When it was, s; ascending.
    pub time: f64,
    /// The hand, if one was found.
    pub estimate: Option<PoseEstimate>,
    /// What became of each view, in the order of [`TakeHeader::views`].
    pub views: Vec<FrameView>,
    /// Why the frame should not be trusted: short codes such as `low-overlap`, without `;`. None
    /// where nothing was found amiss.
    pub doubts: Vec<String>,
}

/// A hand's pose with its deviations.
#[derive(Debug, Clone, PartialEq)]
pub struct PoseEstimate {
    /// The 28 numbers, rad and mm.
    pub pose: Pose,
    /// The standard deviation of each, rad and mm; none for a number that was not estimated.
    pub std: [Option<f64>; Dof::COUNT],
    /// The joints' centres in the world, mm, named by [`JOINT_NAMES`].
    pub joints: [DVec3; JOINTS],
    /// Their standard deviations along the world's axes, mm.
    pub joint_std: Option<[DVec3; JOINTS]>,
}

/// What became of one camera's picture of a frame.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct FrameView {
    /// Whether the picture had a part in the estimate.
    pub used: bool,
    /// How well the estimated hand, drawn again, covers the silhouette that was seen:
    /// intersection over union, 0 to 1.
    pub overlap: Option<f64>,
    /// Why what is there of it had none, or part of that; the estimate is that of the others, and not in doubt
    /// for it.
    pub left_out: Option<LeftOut>,
}

/// Why a camera's picture, or what was seen in it, had no part in an estimate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum LeftOut {
    /// It contradicts the others.
    Disagrees,
    /// It shows nothing where the others see the hand.
    NoHand,
    /// Its mask contradicts the others; its landmarks had a part.
    Mask,
    /// Its landmarks contradict the others; its mask had a part.
    Landmarks,
}

impl LeftOut {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Disagrees, Self::NoHand, Self::Mask, Self::Landmarks];

    /// Its name in files.
    pub fn code(self) -> &'static str {
        match self {
            Self::Disagrees => "disagrees",
            Self::NoHand => "no-hand",
            Self::Mask => "mask",
            Self::Landmarks => "landmarks",
        }
    }

    /// The one of this name.
    pub(super) fn of_code(code: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|reason| reason.code() == code)
    }
}

impl TakeHeader {
    /// The pose of a frame with its joints, and with their deviations as far as they follow from
    /// those of the 28 numbers taken as independent (first order).
    ///
    /// ```
    /// use glam::DAffine3;
    /// use phalanx_hand::{Dof, HandShape, Pose};
    /// use phalanx_io::take::TakeHeader;
    ///
    /// let header = TakeHeader {
    ///     hand: HandShape::adult(),
    ///     world_from_hand: DAffine3::IDENTITY,
    ///     views: vec!["top".to_owned()],
    ///     rate_hz: Some(30.0),
    ///     model: None,
    /// };
    /// let mut std = [None; Dof::COUNT];
    /// std[Dof::IndexDip.index()] = Some(0.1);
    /// let estimate = header.estimate(Pose::REST, std);
    /// let tip = estimate.joint_std.expect("one number has a deviation")[8];
    /// assert!((tip.y - 1.36).abs() < 0.01, "the index's tip is 13.6 mm from its last joint");
    /// ```
    pub fn estimate(&self, pose: Pose, std: [Option<f64>; Dof::COUNT]) -> PoseEstimate {
        let posed = self.posed(&pose);
        let joint_std = std.iter().any(Option::is_some).then(|| {
            let twists = self.hand.twists(&pose, &self.world_from_hand);
            std::array::from_fn(|joint| {
                let moved = joint_bone(joint).dofs().filter_map(|dof| {
                    let velocity = twists.of(dof).velocity(posed.joints[joint]);
                    std[dof.index()].map(|std| (velocity * std).powf(2.0))
                });
                moved.sum::<DVec3>().powf(0.5)
            })
        });
        PoseEstimate { pose, std, joints: posed.joints, joint_std }
    }

    /// The person's hand in a pose, in the world.
    pub fn posed(&self, pose: &Pose) -> PosedHand {
        self.hand.pose(pose, &self.world_from_hand)
    }
}

impl TakeFrame {
    /// The lowest overlap of the views that had a part in the estimate, 0 to 1.
    pub fn quality(&self) -> Option<f64> {
        let used = self.views.iter().filter(|view| view.used);
        used.filter_map(|view| view.overlap).reduce(f64::min)
    }

    /// Whether there is a pose and nothing was found amiss with it.
    pub fn is_trusted(&self) -> bool {
        self.estimate.is_some() && self.doubts.is_empty()
    }
}

/// The part of the hand that a joint moves with.
fn joint_bone(joint: usize) -> Bone {
    match joint.checked_sub(1).map(|k| (Digit::ALL[k / 4], k % 4)) {
        None | Some((_, 0)) => Bone::Palm,
        Some((digit, segment)) => Bone::Segment(digit, segment - 1),
    }
}
