//! What a take must keep to: checked whenever one is read or written.

use std::collections::BTreeSet;

use glam::{DMat3, DVec3};

use crate::error::{Error, Result};
use crate::take::frames::{PoseEstimate, Take, TakeFrame, TakeHeader};

/// What parts the codes of doubts and the names of views in one cell.
pub(super) const SEPARATOR: char = ';';

/// More are no cameras around one hand.
const MOST_VIEWS: usize = 64;
/// How far from a rotation's the columns of a frame may be.
const SLACK: f64 = 1e-3;

impl Take {
    /// Checks that every number is finite, that deviations are positive or 0, that frames and
    /// times ascend, and that every frame speaks of as many views as the header names.
    ///
    /// # Errors
    /// [`Error::TakeHeader`] and [`Error::TakeFrame`] say what is wrong where.
    pub fn validate(&self) -> Result<()> {
        self.header.validate()?;
        let mut order = FrameOrder::default();
        self.frames.iter().try_for_each(|frame| order.check(frame, &self.header))
    }
}

/// Checks frame after frame.
#[derive(Debug, Default)]
pub(super) struct FrameOrder {
    last: Option<(u64, f64)>,
}

impl FrameOrder {
    /// After a frame with this index and time.
    pub(super) fn after(last: (u64, f64)) -> Self {
        Self { last: Some(last) }
    }

    /// Checks a frame, and that it follows the last one.
    pub(super) fn check(&mut self, frame: &TakeFrame, header: &TakeHeader) -> Result<()> {
        let checked = match self.last {
            Some((index, _)) if frame.index <= index => {
                Err(format!("it follows frame {index}; numbers must ascend"))
            }
            Some((_, time)) if frame.time <= time => {
                Err(format!("its time {} s does not follow {time} s", frame.time))
            }
            _ => frame.problem(header.views.len()).map_or(Ok(()), Err),
        };
        self.last = Some((frame.index, frame.time));
        checked.map_err(|what| Error::TakeFrame { frame: frame.index, what })
    }
}

impl TakeHeader {
    pub(super) fn validate(&self) -> Result<()> {
        self.problem().map_or(Ok(()), |what| Err(Error::TakeHeader { what }))
    }

    fn problem(&self) -> Option<String> {
        if let Err(error) = self.hand.validate() {
            return Some(error.to_string());
        }
        let rotation = self.world_from_hand.matrix3;
        let apart = rotation.transpose() * rotation - DMat3::IDENTITY;
        let is_rotation = apart.to_cols_array().iter().all(|entry| entry.abs() < SLACK);
        // Written so that NaN fails.
        if !(is_rotation && rotation.determinant() > 0.0) {
            return Some("the axes of world_from_hand make no rotation".to_owned());
        }
        if !self.world_from_hand.translation.is_finite() {
            return Some("the origin of world_from_hand is not finite".to_owned());
        }
        if self.rate_hz.is_some_and(|rate| !(rate.is_finite() && rate > 0.0)) {
            return Some("the frame rate is not a positive number".to_owned());
        }
        let views: BTreeSet<&String> = self.views.iter().collect();
        if views.len() < self.views.len() || views.len() > MOST_VIEWS {
            return Some(format!("the names of up to {MOST_VIEWS} views must differ"));
        }
        let name = self.views.iter().find(|name| !is_plain(name))?;
        Some(format!("the view's name '{}' {UNPLAIN}", name.escape_debug()))
    }
}

/// What [`is_plain`] refuses.
const UNPLAIN: &str = "is empty, begins or ends with a space, or holds ';' or a control character";

/// Whether a text can stand in a list within a cell.
fn is_plain(text: &str) -> bool {
    !text.is_empty()
        && text.trim() == text
        && !text.contains(|letter: char| letter == SEPARATOR || letter.is_control())
}

impl TakeFrame {
    fn problem(&self, views: usize) -> Option<String> {
        if !self.time.is_finite() {
            return Some("its time is not finite".to_owned());
        }
        if self.views.len() != views {
            return Some(format!("it speaks of {} views of {views}", self.views.len()));
        }
        let mut overlaps = self.views.iter().filter_map(|view| view.overlap);
        if let Some(overlap) = overlaps.find(|overlap| !(0.0..=1.0).contains(overlap)) {
            return Some(format!("an overlap of {overlap} is outside 0..1"));
        }
        if let Some(doubt) = self.doubts.iter().find(|doubt| !is_plain(doubt)) {
            return Some(format!("the doubt '{}' {UNPLAIN}", doubt.escape_debug()));
        }
        self.estimate.as_ref().and_then(PoseEstimate::problem)
    }
}

impl PoseEstimate {
    fn problem(&self) -> Option<String> {
        let is_deviation = |std: f64| std.is_finite() && std >= 0.0;
        let mut joint_std = self.joint_std.iter().flatten().flat_map(DVec3::to_array);
        if !self.pose.0.iter().all(|value| value.is_finite()) {
            return Some("a number of the pose is not finite".to_owned());
        }
        if !self.joints.iter().all(|joint| joint.is_finite()) {
            return Some("a joint is not finite".to_owned());
        }
        let sound =
            self.std.iter().flatten().all(|&std| is_deviation(std)) && joint_std.all(is_deviation);
        (!sound).then(|| "a deviation is negative or not finite".to_owned())
    }
}
