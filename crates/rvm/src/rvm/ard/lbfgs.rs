//! Maximising a smooth function of many numbers.

use crate::linalg::axpy;

/// Steps whose curvature is remembered.
const MEMORY: usize = 12;
/// Share of the gain promised by the slope that a step must deliver.
const SUFFICIENT: f64 = 1e-4;
/// Halvings of a step before giving up.
const HALVINGS: usize = 25;

/// A point, the function's value there and its gradient.
#[derive(Debug, Clone)]
pub(super) struct Point {
    pub(super) at: Vec<f64>,
    pub(super) value: f64,
    pub(super) gradient: Vec<f64>,
}

/// Limited-memory BFGS (Nocedal and Wright 2006, algorithm 7.4) with backtracking, for at most
/// `steps` or until one gains no more than `tolerance`. `evaluate` says `None` where the function
/// has no value; no step goes there.
pub(super) fn maximise(
    start: Point,
    steps: usize,
    tolerance: f64,
    evaluate: impl Fn(&[f64]) -> Option<(f64, Vec<f64>)>,
) -> Point {
    let mut point = start;
    let mut pairs: Vec<Pair> = Vec::new();
    for _ in 0..steps {
        let direction = direction(&point.gradient, &pairs);
        let Some(next) = search(&point, &direction, &evaluate) else {
            if pairs.is_empty() {
                break;
            }
            // The remembered curvature may mislead; the gradient does not.
            pairs.clear();
            continue;
        };
        let gained = next.value - point.value;
        let moved = difference(&next.at, &point.at);
        let bent = difference(&point.gradient, &next.gradient);
        let curvature = dot(&moved, &bent);
        if curvature > 1e-10 * dot(&bent, &bent).sqrt() * dot(&moved, &moved).sqrt() {
            if pairs.len() == MEMORY {
                pairs.remove(0);
            }
            pairs.push(Pair { moved, bent, curvature });
        }
        point = next;
        if gained <= tolerance {
            break;
        }
    }
    point
}

/// A step, how much the gradient fell on it, and their inner product.
struct Pair {
    moved: Vec<f64>,
    bent: Vec<f64>,
    curvature: f64,
}

/// The gradient times the inverse of the curvature that the pairs saw.
fn direction(gradient: &[f64], pairs: &[Pair]) -> Vec<f64> {
    let mut direction = gradient.to_vec();
    let mut shares = Vec::with_capacity(pairs.len());
    for pair in pairs.iter().rev() {
        let share = dot(&pair.moved, &direction) / pair.curvature;
        axpy(&mut direction, -share, &pair.bent);
        shares.push(share);
    }
    let scale = match pairs.last() {
        Some(pair) => pair.curvature / dot(&pair.bent, &pair.bent),
        // A first step of length 1.
        None => dot(gradient, gradient).sqrt().max(f64::MIN_POSITIVE).recip(),
    };
    for value in &mut direction {
        *value *= scale;
    }
    for (pair, share) in pairs.iter().zip(shares.iter().rev()) {
        let by = share - dot(&pair.bent, &direction) / pair.curvature;
        axpy(&mut direction, by, &pair.moved);
    }
    direction
}

/// The first of a step and its halves that gains enough.
fn search(
    from: &Point,
    direction: &[f64],
    evaluate: impl Fn(&[f64]) -> Option<(f64, Vec<f64>)>,
) -> Option<Point> {
    let slope = dot(&from.gradient, direction);
    let mut length = 1.0;
    for _ in 0..HALVINGS {
        let mut at = from.at.clone();
        axpy(&mut at, length, direction);
        if let Some((value, gradient)) = evaluate(&at)
            && value > from.value + SUFFICIENT * length * slope
        {
            return Some(Point { at, value, gradient });
        }
        length *= 0.5;
    }
    None
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rosenbrock's valley, upside down.
    #[test]
    fn it_finds_the_end_of_a_bent_valley() {
        let evaluate = |at: &[f64]| {
            let (x, y) = (at[0], at[1]);
            let value = -((1.0 - x).powi(2) + 100.0 * (y - x * x).powi(2));
            let gradient = vec![2.0 * (1.0 - x) + 400.0 * x * (y - x * x), -200.0 * (y - x * x)];
            (y < 3.0).then_some((value, gradient))
        };
        let (value, gradient) = evaluate(&[-1.2, 1.0]).unwrap();
        let start = Point { at: vec![-1.2, 1.0], value, gradient };
        let found = maximise(start, 200, 1e-14, evaluate);
        assert!((found.at[0] - 1.0).abs() < 1e-5 && (found.at[1] - 1.0).abs() < 1e-5, "{found:?}");
    }
}
