//! The range of motion of a take, with deviations.

use phalanx_hand::{Digit, Dof};

use crate::take::{PoseEstimate, Take};

/// The angles of a report: the 20 of the digits and the two of the wrist.
pub const ANGLES: usize = Dof::INTERNAL + 2;

/// Which frames count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrameChoice {
    /// Those with a pose and without a doubt: one wrong frame would be the largest or smallest.
    Trusted,
    /// All with a pose.
    All,
}

/// A number with its standard deviation, rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// The number.
    pub value: f64,
    /// Its deviation, if it is known.
    pub std: Option<f64>,
}

/// The range of motion of a take.
#[derive(Debug, Clone, PartialEq)]
pub struct RangeOfMotion {
    /// How many frames counted.
    pub counted: usize,
    /// How many the take has.
    pub frames: usize,
    /// Each angle's range, in the order of [`Dof::ALL`].
    pub angles: [AngleRange; ANGLES],
    /// Each digit's total active motion, thumb first.
    pub totals: [Measured; 5],
}

/// The range of one angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AngleRange {
    /// The smallest.
    pub smallest: Measured,
    /// The largest.
    pub largest: Measured,
    /// The largest less the smallest.
    pub range: Measured,
}

impl Measured {
    /// The difference of two numbers whose errors are taken as independent.
    #[must_use]
    pub fn minus(self, other: Self) -> Self {
        let std = self.std.zip(other.std).map(|(a, b)| a.hypot(b));
        Self { value: self.value - other.value, std }
    }

    fn plus(self, other: Self) -> Self {
        Self { value: self.value + other.value, ..self.minus(other) }
    }

    /// The number if it is above 0; at most 0 counts as 0.
    fn positive(self) -> Self {
        Self { value: self.value.max(0.0), ..self }
    }
}

impl RangeOfMotion {
    /// Of a take; none if no frame counts.
    ///
    /// A digit's total active motion is the sum of its flexions (MCP, PIP and DIP; MCP and IP of
    /// the thumb) in the frame where that is largest, less the flexion that is left in the frame
    /// where it is smallest; stretching beyond straight counts as straight (American Society for
    /// Surgery of the Hand). Deviations are those of the frames concerned, taken as independent.
    pub fn of(take: &Take, choice: FrameChoice) -> Option<Self> {
        let counts = |frame: &&crate::take::TakeFrame| match choice {
            FrameChoice::Trusted => frame.is_trusted(),
            FrameChoice::All => true,
        };
        let frames = take.frames.iter().filter(counts);
        let estimates: Vec<&PoseEstimate> = frames.filter_map(|f| f.estimate.as_ref()).collect();
        if estimates.is_empty() {
            return None;
        }
        Some(Self {
            counted: estimates.len(),
            frames: take.frames.len(),
            angles: std::array::from_fn(|k| angle_range(&estimates, Dof::ALL[k])),
            totals: Digit::ALL.map(|digit| total_active_motion(&estimates, digit)),
        })
    }
}

fn measured(estimate: &PoseEstimate, dof: Dof) -> Measured {
    Measured { value: estimate.pose[dof], std: estimate.std[dof.index()] }
}

/// The estimates in which something is smallest and largest; there is at least one.
fn extremes<'a>(
    estimates: &[&'a PoseEstimate],
    of: impl Fn(&PoseEstimate) -> f64,
) -> [&'a PoseEstimate; 2] {
    let mut ends = [estimates[0]; 2];
    for &estimate in estimates {
        if of(estimate) < of(ends[0]) {
            ends[0] = estimate;
        }
        if of(estimate) > of(ends[1]) {
            ends[1] = estimate;
        }
    }
    ends
}

fn angle_range(estimates: &[&PoseEstimate], dof: Dof) -> AngleRange {
    let ends = extremes(estimates, |estimate| estimate.pose[dof]);
    let [smallest, largest] = ends.map(|estimate| measured(estimate, dof));
    AngleRange { smallest, largest, range: largest.minus(smallest) }
}

fn total_active_motion(estimates: &[&PoseEstimate], digit: Digit) -> Measured {
    let [_, cmc_or_mcp, mcp_or_pip, last] = digit.dofs();
    let flexions = match digit {
        Digit::Thumb => vec![mcp_or_pip, last],
        _ => vec![cmc_or_mcp, mcp_or_pip, last],
    };
    let [open, closed] =
        extremes(estimates, |estimate| flexions.iter().map(|&dof| estimate.pose[dof]).sum());
    let zero = Measured { value: 0.0, std: Some(0.0) };
    let sum = |part: &dyn Fn(Dof) -> Measured| {
        flexions.iter().map(|&dof| part(dof)).fold(zero, Measured::plus)
    };
    let flexed = sum(&|dof| measured(closed, dof));
    flexed.minus(sum(&|dof| measured(open, dof).positive()))
}
