//! How well landmarks are known, from how fits leave them.

use glam::DVec2;
use phalanx_hand::JOINTS;

/// How well the points of one camera are known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LandmarkNoise {
    /// Standard deviation of a point along each axis, in the residuals' unit, robustly.
    pub deviation: f64,
    /// How many points of a frame, on average, tell no more than one does that errs independently.
    pub correlated: f64,
    /// Which share of a point's variance, 0 to 1, is the same in every frame: where a detector's joints are
    /// elsewhere than the model's, more frames tell no more.
    pub persistent: f64,
}

/// The median length of a vector whose two parts are normal is this many of their deviations (Rayleigh's
/// distribution): √(2 ln 2).
const MEDIAN_OF_LENGTHS: f64 = 1.177_41;

/// Residuals further out than this many deviations are of something else than a point's noise.
const OUTLYING: f64 = 3.5;

impl LandmarkNoise {
    /// From the residuals of one camera in some frames; `None` of none.
    ///
    /// The deviation is the median length of a residual, scaled as of a normal distribution. With ρ the mean
    /// product of two points' residuals in a frame over the mean square, n points tell as much of their mean
    /// as n / (1 + (n − 1) ρ) that are independent.
    pub fn of(frames: &[[Option<DVec2>; JOINTS]]) -> Option<Self> {
        let mut lengths: Vec<f64> = frames.iter().flatten().flatten().map(|r| r.length()).collect();
        if lengths.is_empty() {
            return None;
        }
        let middle = lengths.len() / 2;
        let (_, median, _) = lengths.select_nth_unstable_by(middle, f64::total_cmp);
        let deviation = (*median / MEDIAN_OF_LENGTHS).max(f64::MIN_POSITIVE);
        let usual = |residual: &DVec2| residual.length() <= OUTLYING * deviation;
        let frames: Vec<[Option<DVec2>; JOINTS]> =
            frames.iter().map(|frame| frame.map(|residual| residual.filter(usual))).collect();
        let within = correlation(frames.iter().map(|frame| frame.iter().copied()));
        let across = correlation((0..JOINTS).map(|joint| frames.iter().map(move |own| own[joint])));
        let points = frames.iter().map(|frame| frame.iter().flatten().count());
        let points = points.sum::<usize>() as f64 / frames.len() as f64;
        let correlated = 1.0 + (points - 1.0).max(0.0) * within;
        Some(Self { deviation, correlated, persistent: across })
    }
}

/// The mean product of two residuals of a group over the mean square of one, 0 to 1.
fn correlation<G: Iterator<Item = Option<DVec2>>>(groups: impl Iterator<Item = G>) -> f64 {
    let (mut squares, mut count, mut products, mut pairs) = (0.0, 0.0, 0.0, 0.0);
    for group in groups {
        let (mut sum, mut own, mut members) = (DVec2::ZERO, 0.0, 0.0);
        for residual in group.flatten() {
            sum += residual;
            own += residual.length_squared();
            members += 1.0;
        }
        squares += own;
        count += members;
        products += sum.length_squared() - own;
        pairs += members * (members - 1.0);
    }
    if pairs == 0.0 || squares == 0.0 {
        return 0.0;
    }
    (products / pairs / (squares / count)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Sums of twelve uniform numbers less six are all but normal.
    fn normal() -> impl Strategy<Value = f64> {
        prop::array::uniform12(0.0..1.0_f64).prop_map(|uniform| uniform.iter().sum::<f64>() - 6.0)
    }

    fn vectors(count: usize) -> impl Strategy<Value = Vec<DVec2>> {
        let vector = (normal(), normal()).prop_map(|(x, y)| DVec2::new(x, y));
        // What is shrunk would no longer be normal.
        prop::collection::vec(vector, count).no_shrink()
    }

    proptest! {
        #![proptest_config(crate::property::cases(16))]

        /// Independent parts, one of each frame and one of each joint, are told apart; points that are
        /// something else altogether do not matter.
        #[test]
        fn parts_that_err_together_are_found(
            alone in vectors(40 * JOINTS),
            of_frames in vectors(40),
            of_joints in vectors(JOINTS),
            share in 0.0..1.0_f64,
        ) {
            let mean = of_joints.iter().sum::<DVec2>() / JOINTS as f64;
            let frame = |f: usize| {
                std::array::from_fn(|j| {
                    let together = share * of_frames[f] + (1.0 - share) * (of_joints[j] - mean);
                    let outlier = if (f + 7 * j).is_multiple_of(29) { 90.0 } else { 0.0 };
                    (f + j != 11).then(|| 3.0 * (alone[f * JOINTS + j] + together) + outlier)
                })
            };
            let frames: Vec<[Option<DVec2>; JOINTS]> = (0..40).map(frame).collect();
            let noise = LandmarkNoise::of(&frames).unwrap();
            // Of what was drawn, as few numbers differ much from what they are drawn from.
            let variance_of = |vectors: &[DVec2], mean: DVec2| {
                let squares = vectors.iter().map(|vector| vector.distance_squared(mean));
                squares.sum::<f64>() / (2 * vectors.len()) as f64
            };
            let one = share.powi(2) * variance_of(&of_frames, DVec2::ZERO);
            let other = (1.0 - share).powi(2) * variance_of(&of_joints, mean);
            let variance = 1.0 + one + other;
            // Of 21 joints one that is far off counts in part as something else.
            prop_assert!((noise.deviation / (3.0 * variance.sqrt()) - 1.0).abs() < 0.15);
            prop_assert!((noise.persistent - other / variance).abs() < 0.25, "{noise:?}, {share}");
            let within = (noise.correlated - 1.0) / 19.0;
            prop_assert!((within - one / variance).abs() < 0.25, "{noise:?}, {share}");
        }
    }

    #[test]
    fn no_residual_tells_nothing() {
        assert_eq!(LandmarkNoise::of(&[]), None);
        assert_eq!(LandmarkNoise::of(&[[None; JOINTS]; 3]), None);
    }
}
