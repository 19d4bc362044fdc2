//! Errors, and how often the truth is as near as the deviations promise.

use phalanx_hand::{Dof, JOINTS};

use crate::evaluation::reference::{Clock, Reference};
use crate::export::frame_rate;
use crate::take::{PoseEstimate, Take};

/// Shares of a normal distribution within so many deviations of its middle: what is promised of
/// the truth. 50, 68 and 95 % among them.
pub const LEVELS: [(f64, f64); 9] = [
    (0.10, 0.125_661),
    (0.25, 0.318_639),
    (0.40, 0.524_401),
    (0.50, 0.674_490),
    (0.60, 0.841_621),
    (0.68, 0.994_458),
    (0.80, 1.281_552),
    (0.90, 1.644_854),
    (0.95, 1.959_964),
];

/// The errors of a number (`N` = 1, rad or mm), or of a joint along the axes of the world (`N` = 3, mm).
#[derive(Debug, Clone, PartialEq)]
pub struct Scores<const N: usize> {
    /// How many frames were compared.
    pub count: usize,
    /// The mean of the errors: estimated less reference.
    pub bias: [f64; N],
    /// The mean of their sizes; of a joint, of its distances.
    pub mean: f64,
    /// The root of the mean of their squares.
    pub rms: f64,
    /// How many of the comparisons had a deviation.
    pub promised: usize,
    /// The share of those within what each of [`LEVELS`] promises.
    pub coverage: [f64; LEVELS.len()],
}

/// A take beside a reference.
#[derive(Debug, Clone, PartialEq)]
pub struct Evaluation {
    /// How many frames have a pose and a row of the reference.
    pub matched: usize,
    /// Of the take's frames with a pose, how many have no row within half a frame.
    pub unmatched: usize,
    /// Each of the 28 numbers.
    pub dofs: [Scores<1>; Dof::COUNT],
    /// Each joint.
    pub joints: [Scores<3>; JOINTS],
}

/// Compares frame by frame, each with the row of the reference nearest to its time (within half a
/// frame) or of its number. `lag` is taken from the take's times, s.
pub fn evaluate(take: &Take, reference: &Reference, lag: f64) -> Evaluation {
    let mut dofs = [(); Dof::COUNT].map(|()| Sums::NONE);
    let mut joints = [(); JOINTS].map(|()| Sums::NONE);
    let (mut matched, mut unmatched) = (0, 0);
    for (frame, estimate) in take.frames.iter().filter_map(|f| Some((f, f.estimate.as_ref()?))) {
        let (instant, slack) = match reference.clock {
            Clock::Time => (frame.time - lag, 0.5 / frame_rate(take)),
            Clock::Frame => (frame.index as f64, 0.0),
        };
        let Some(row) = nearest(&reference.instants, instant, slack) else {
            unmatched += 1;
            continue;
        };
        matched += 1;
        for dof in Dof::ALL {
            let error = turn(dof, estimate.pose[dof] - reference.poses[row][dof.index()]);
            dofs[dof.index()].add(error.abs(), [(error, estimate.std[dof.index()])]);
        }
        for (joint, sums) in joints.iter_mut().enumerate() {
            add_joint(sums, estimate, joint, reference, row);
        }
    }
    Evaluation {
        matched,
        unmatched,
        dofs: dofs.each_ref().map(Sums::scores),
        joints: joints.each_ref().map(Sums::scores),
    }
}

fn add_joint(
    sums: &mut Sums<3>,
    estimate: &PoseEstimate,
    joint: usize,
    reference: &Reference,
    row: usize,
) {
    let error = estimate.joints[joint] - reference.joints[row][joint];
    let std = estimate.joint_std.map(|std| std[joint]);
    let along = [0, 1, 2].map(|axis| (error[axis], std.map(|std| std[axis])));
    sums.add(error.length(), along);
}

/// The row nearest to an instant, if it is within the slack.
fn nearest(instants: &[f64], instant: f64, slack: f64) -> Option<usize> {
    // Times in files have six decimals.
    const DECIMALS: f64 = 1e-5;
    let after = instants.partition_point(|&other| other < instant);
    let near = [after.checked_sub(1), Some(after)].into_iter().flatten();
    let apart = |row: &usize| instants.get(*row).map(|other| (other - instant).abs());
    let row = near.filter(|row| apart(row).is_some_and(|apart| apart <= slack + DECIMALS));
    row.min_by(|a, b| apart(a).partial_cmp(&apart(b)).unwrap_or(std::cmp::Ordering::Equal))
}

/// An angle about an axis of the world, the short way round.
fn turn(dof: Dof, error: f64) -> f64 {
    match dof {
        Dof::ThetaX | Dof::ThetaY | Dof::ThetaZ => error.sin().atan2(error.cos()),
        _ => error,
    }
}

/// Sums of errors as they come.
struct Sums<const N: usize> {
    count: usize,
    signed: [f64; N],
    sizes: f64,
    squares: f64,
    promised: usize,
    within: [usize; LEVELS.len()],
}

impl<const N: usize> Sums<N> {
    const NONE: Self = Self {
        count: 0,
        signed: [0.0; N],
        sizes: 0.0,
        squares: 0.0,
        promised: 0,
        within: [0; LEVELS.len()],
    };

    /// Adds an error of a size, unless it is NaN, and its parts with their deviations.
    fn add(&mut self, size: f64, parts: [(f64, Option<f64>); N]) {
        if size.is_nan() {
            return;
        }
        self.count += 1;
        self.sizes += size;
        self.squares += size * size;
        for (signed, (error, std)) in self.signed.iter_mut().zip(parts) {
            *signed += error;
            let Some(std) = std else { continue };
            self.promised += 1;
            for (within, (_, deviations)) in self.within.iter_mut().zip(LEVELS) {
                *within += usize::from(error.abs() <= deviations * std);
            }
        }
    }

    fn scores(&self) -> Scores<N> {
        let [count, promised] = [self.count, self.promised].map(|count| count.max(1) as f64);
        Scores {
            count: self.count,
            bias: self.signed.map(|signed| signed / count),
            mean: self.sizes / count,
            rms: (self.squares / count).sqrt(),
            promised: self.promised,
            coverage: self.within.map(|within| within as f64 / promised),
        }
    }
}
