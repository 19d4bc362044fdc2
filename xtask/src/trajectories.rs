//! The two trajectories of the paper's § 3, made by rule: `open-close` and `complex`.
//!
//! A digit's posture is drawn from a coupled prior (DIP follows PIP by about two thirds, PIP and
//! MCP flex together in part, abduction narrows as the knuckle bends) and reached along a
//! minimum-jerk path (Flash and Hogan 1985), as people's fingers do.

use phalanx_hand::{Digit, Dof, Pose, abduction_limit};
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
        [0.0, 70.0, 88.0, 57.0],
        [-1.0, 72.0, 86.0, 56.0],
        [-2.0, 74.0, 78.0, 50.0],
    ];
    const OPEN: [Posture; 5] = [
        [2.0, -6.0, -4.0, -8.0],
        [3.0, -6.0, 3.0, 2.0],
        [0.0, -5.0, 4.0, 2.0],
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

/// A take in which the fingers move independently and in combination: beats of a quarter to
/// half a second, in each of which one digit, two, or all of them go to a new posture.
pub(crate) fn complex_take(seed: u64) -> Vec<Pose> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut now = [[0.0; 4]; 5];
    let mut poses = Vec::with_capacity(COMPLEX_FRAMES);
    while poses.len() < COMPLEX_FRAMES {
        let next = next_postures(&now, &mut random);
        let frames = 8 + (uniform(&mut random) * 7.0) as usize;
        for frame in 0..frames {
            let done = minimum_jerk((frame + 1) as f64 / frames as f64);
            let mut pose = Pose::REST;
            for (k, digit) in Digit::ALL.into_iter().enumerate() {
                let joints = std::array::from_fn(|j| now[k][j] + done * (next[k][j] - now[k][j]));
                set(&mut pose, digit, joints);
            }
            poses.push(pose);
        }
        now = next;
    }
    poses.truncate(COMPLEX_FRAMES);
    poses
}

/// The postures at the end of a beat: of every two beats one moves a single digit; the other
/// half is shared by pairs of digits and by all five.
fn next_postures(now: &[Posture; 5], random: &mut Pcg64Mcg) -> [Posture; 5] {
    let mut next = *now;
    let kind = uniform(random);
    let first = (uniform(random) * 5.0) as usize;
    let second = (first + 1 + (uniform(random) * 4.0) as usize) % 5;
    for (k, digit) in Digit::ALL.into_iter().enumerate() {
        let moves = match kind {
            x if x < 0.5 => k == first,
            x if x < 0.75 => k == first || k == second,
            _ => true,
        };
        if moves {
            next[k] = random_posture(digit, random);
        }
    }
    next
}

/// A posture of one digit from the coupled prior, degrees.
fn random_posture(digit: Digit, random: &mut Pcg64Mcg) -> Posture {
    // The arcsine law: a digit at rest is more often nearly straight or nearly bent than halfway.
    let mut curl = || (std::f64::consts::FRAC_PI_2 * uniform(random)).sin().powi(2);
    let (outer, own) = (curl(), curl());
    let base = 0.5 * (outer + own);
    let spread = 2.0 * uniform(random) - 1.0;
    let wobble = 2.0 * uniform(random) - 1.0;
    if digit == Digit::Thumb {
        return [12.5 + 22.5 * spread, -8.0 + 46.0 * base, -4.0 + 54.0 * outer, -8.0 + 72.0 * outer + 6.0 * wobble];
    }
    let mcp = -10.0 + 95.0 * base;
    let pip = 102.0 * outer;
    let dip = (pip * 2.0 / 3.0 + 6.0 * wobble).clamp(0.0, 78.0);
    [spread * 0.7 * abduction_limit(mcp.to_radians()).to_degrees(), mcp, pip, dip]
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
