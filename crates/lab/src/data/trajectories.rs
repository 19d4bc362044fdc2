//! The two trajectories of the paper's § 3, made by rule: `open-close` and `complex`.
//!
//! A digit's posture is drawn from a prior with the couplings of a real hand (DIP follows PIP by
//! about two thirds, the thumb's outer joints bend together, abduction narrows as the knuckle
//! bends) and reached along a minimum-jerk path (Flash and Hogan 1985), as people's fingers do.

use phalanx_hand::{Digit, Dof, Pose, sample_posture};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Frames of `open-close`, as in the paper.
const OPEN_CLOSE_FRAMES: usize = 78;
/// Frames of `complex`, as in the paper.
const COMPLEX_FRAMES: usize = 239;
/// The seed of the take of `complex` that is stored.
const COMPLEX_SEED: u64 = 2006;

/// A digit's abduction and three flexions, degrees.
type Posture = [f64; 4];

/// All fingers stretched at first, then a grasp, finger after finger with small lags, and a
/// short hold at both ends.
pub(crate) fn open_close() -> Vec<Pose> {
    const GRASP: [Posture; 5] = [
        [30.0, 28.0, 38.0, 42.0],
        [-2.0, 66.0, 82.0, 52.0],
        [1.5, 70.0, 88.0, 57.0],
        [-1.0, 72.0, 86.0, 56.0],
        [-2.0, 74.0, 78.0, 50.0],
    ];
    const OPEN: [Posture; 5] = [
        [2.0, -6.0, -4.0, -8.0],
        [3.0, -6.0, 3.0, 2.0],
        [-1.0, -5.0, 4.0, 2.0],
        [3.0, -5.0, 4.0, 2.0],
        [6.0, -7.0, 5.0, 3.0],
    ];
    /// When each digit sets out, in frames: the little finger leads, the thumb closes last.
    const START: [f64; 5] = [14.0, 8.0, 6.0, 4.0, 2.0];
    const DURATION: f64 = 58.0;
    (0..OPEN_CLOSE_FRAMES)
        .map(|frame| {
            let mut pose = Pose::REST;
            for (k, digit) in Digit::ALL.into_iter().enumerate() {
                // The knuckles lead the outer joints by a little, as in a real grasp.
                let joints: Posture = std::array::from_fn(|joint| {
                    let lag = [0.0, 0.0, 2.0, 4.0][joint];
                    let done = minimum_jerk((frame as f64 - START[k] - lag) / DURATION);
                    OPEN[k][joint] + done * (GRASP[k][joint] - OPEN[k][joint])
                });
                set(&mut pose, digit, joints);
            }
            pose
        })
        .collect()
}

/// The stored take of `complex`.
pub(crate) fn complex() -> Vec<Pose> {
    complex_take(COMPLEX_SEED)
}

/// A take in which the fingers move independently and in combination: a few times a second one
/// digit, two, or all five set out for a new posture, those that are still under way excepted, so
/// that movements overlap.
pub(crate) fn complex_take(seed: u64) -> Vec<Pose> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut movements = [Movement::default(); 5];
    let mut next_start = 0.0;
    (0..COMPLEX_FRAMES)
        .map(|frame| {
            let now = frame as f64;
            if now >= next_start {
                for digit in set_out(&mut random) {
                    movements[digit as usize].redirect(now, digit, &mut random);
                }
                next_start = now + 3.0 + 5.0 * uniform(&mut random);
            }
            let mut pose = Pose::REST;
            for (digit, movement) in Digit::ALL.into_iter().zip(&movements) {
                set(&mut pose, digit, movement.at(now));
            }
            pose
        })
        .collect()
}

/// The digits that set out together: half of the time one alone, mostly a pair otherwise, and
/// sometimes all five.
fn set_out(random: &mut Pcg64Mcg) -> Vec<Digit> {
    let first = (5.0 * uniform(random)) as usize;
    let other = (first + 1 + (4.0 * uniform(random)) as usize) % 5;
    match uniform(random) {
        kind if kind < 0.5 => vec![Digit::ALL[first]],
        kind if kind < 0.85 => vec![Digit::ALL[first], Digit::ALL[other]],
        _ => Digit::ALL.to_vec(),
    }
}

/// A digit's way from one posture to another.
#[derive(Clone, Copy, Default)]
struct Movement {
    from: Posture,
    to: Posture,
    start: f64,
    /// In frames; a quarter to half a second.
    duration: f64,
}

impl Movement {
    fn at(&self, frame: f64) -> Posture {
        let done = minimum_jerk((frame - self.start) / self.duration.max(1.0));
        std::array::from_fn(|joint| self.from[joint] + done * (self.to[joint] - self.from[joint]))
    }

    /// Sets out for a random posture, unless still under way.
    fn redirect(&mut self, frame: f64, digit: Digit, random: &mut Pcg64Mcg) {
        let (to, duration) = (random_posture(digit, random), 8.0 + 7.0 * uniform(random));
        if frame >= self.start + self.duration {
            *self = Self { from: self.to, to, start: frame, duration };
        }
    }
}

/// A posture of one digit from the coupled prior, degrees.
fn random_posture(digit: Digit, random: &mut Pcg64Mcg) -> Posture {
    sample_posture(digit, || uniform(random)).map(f64::to_degrees)
}

fn set(pose: &mut Pose, digit: Digit, joints: Posture) {
    for (dof, degrees) in digit.dofs().into_iter().zip(joints) {
        pose[dof] = degrees.to_radians();
    }
}

/// The minimum-jerk path from 0 to 1 over a time of 0 to 1.
fn minimum_jerk(time: f64) -> f64 {
    let t = time.clamp(0.0, 1.0);
    t * t * t * (10.0 + t * (6.0 * t - 15.0))
}

/// Uniform in [0, 1).
fn uniform(random: &mut Pcg64Mcg) -> f64 {
    (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

/// The columns that the trajectories' files hold.
pub(crate) fn columns() -> Vec<Dof> {
    Dof::ALL.into_iter().filter(|dof| dof.is_internal()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poses_are_plausible_and_motion_is_smooth() {
        for trajectory in [open_close(), complex(), complex_take(1)] {
            for (frame, pose) in trajectory.iter().enumerate() {
                assert_eq!(pose.out_of_range(), [], "frame {frame}");
            }
            for (frame, pair) in trajectory.windows(2).enumerate() {
                for dof in columns() {
                    let step = (pair[1][dof] - pair[0][dof]).abs().to_degrees();
                    // The steepest minimum-jerk path goes through its whole range in 8 frames.
                    assert!(step < 30.0, "{dof} jumps by {step} degrees after frame {frame}");
                }
            }
        }
    }

    #[test]
    fn the_sets_have_the_papers_lengths() {
        assert_eq!(open_close().len(), 78);
        assert_eq!(complex().len(), 239);
    }

    #[test]
    fn every_internal_angle_varies() {
        for trajectory in [open_close(), complex()] {
            for dof in columns() {
                assert!(trajectory.iter().any(|pose| pose[dof] != trajectory[0][dof]), "{dof}");
            }
        }
    }
}
