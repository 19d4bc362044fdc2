//! Hand-like contours on the pixel grid: five lobes around a palm, from a polar curve.

/// A lobe of the curve: its direction in radians, its width, and how far it reaches.
pub(crate) type Lobe = (f64, f64, f64);

/// Fingers of an open hand.
pub(crate) const HAND: [Lobe; 6] = [
    (-2.55, 0.16, 1.0),
    (-2.0, 0.12, 1.45),
    (-1.6, 0.12, 1.6),
    (-1.2, 0.12, 1.5),
    (-0.8, 0.12, 1.2),
    (1.57, 0.3, 1.2),
];

/// The pixels that the curve `palm * (1 + Σ reach * exp(-(angle / width)²))` passes, in order and
/// without repeating the last one, about `centre`.
pub(crate) fn star(centre: [f64; 2], palm: f64, lobes: &[Lobe]) -> Vec<[f64; 2]> {
    let steps = 20_000;
    let mut points: Vec<[f64; 2]> = (0..steps)
        .map(|step| {
            let angle = std::f64::consts::TAU * f64::from(step) / f64::from(steps);
            let reach: f64 = lobes
                .iter()
                .map(|&(at, width, reach)| {
                    let (sin, cos) = (angle - at).sin_cos();
                    reach * (-(sin.atan2(cos) / width).powi(2)).exp()
                })
                .sum();
            let radius = palm * (1.0 + reach);
            [(centre[0] + radius * angle.cos()).round(), (centre[1] + radius * angle.sin()).round()]
        })
        .collect();
    points.dedup();
    if points.first() == points.last() {
        points.pop();
    }
    points
}
