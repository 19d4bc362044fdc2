//! Histograms over a grid of colours.

/// Convolves a grid of any number of dimensions, the last of them contiguous, with the binomial kernel:
/// `passes` of ¼ (1 2 1) along each. Sums and powers of two only, so that every machine decides alike.
pub(crate) fn smooth(values: &mut [f64], sides: &[usize], passes: u32) {
    let mut stride = 1;
    for &side in sides.iter().rev() {
        let (mut line, mut passed) = (vec![0.0; side], vec![0.0; side]);
        for first in (0..values.len()).filter(|cell| cell / stride % side == 0) {
            let cells = (first..).step_by(stride).take(side);
            line.iter_mut().zip(cells.clone()).for_each(|(v, cell)| *v = values[cell]);
            // Most lines are empty, and remain so.
            if line.iter().all(|&v| v == 0.0) {
                continue;
            }
            for _ in 0..passes {
                pass(&line, &mut passed);
                std::mem::swap(&mut line, &mut passed);
            }
            cells.zip(&line).for_each(|(cell, &v)| values[cell] = v);
        }
        stride *= side;
    }
}

/// ¼ (1 2 1) along a line, whose ends go on beyond it.
fn pass(line: &[f64], passed: &mut [f64]) {
    let mean = |before, here, after| (before + 2.0 * here + after) / 4.0;
    let last = line.len() - 1;
    passed[0] = mean(line[0], line[0], line[1]);
    passed[last] = mean(line[last - 1], line[last], line[last]);
    for (v, &[before, here, after]) in passed[1..last].iter_mut().zip(line.array_windows()) {
        *v = mean(before, here, after);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All passes, each over the whole grid.
    fn slow(values: &[f64], [deep, high, wide]: [usize; 3], passes: u32) -> Vec<f64> {
        let mut values = values.to_vec();
        for axis in [2, 1, 0] {
            for _ in 0..passes {
                let at = |cell: usize, step: isize| {
                    let mut place = [cell / (high * wide), cell / wide % high, cell % wide];
                    let side = [deep, high, wide][axis] as isize;
                    place[axis] = (place[axis] as isize + step).clamp(0, side - 1) as usize;
                    values[(place[0] * high + place[1]) * wide + place[2]]
                };
                let pass = |cell| (at(cell, -1) + 2.0 * at(cell, 0) + at(cell, 1)) / 4.0;
                values = (0..values.len()).map(pass).collect();
            }
        }
        values
    }

    #[test]
    fn lines_are_smoothed_as_the_grid_is() {
        let sides = [4, 8, 16];
        for passes in [0, 1, 5, 16] {
            let mut values = vec![0.0; 512];
            for (cell, count) in [(0, 7.0), (33, 1.0), (300, 90.0), (511, 4.0)] {
                values[cell] = count;
            }
            let expected = slow(&values, sides, passes);
            smooth(&mut values, &sides, passes);
            assert_eq!(values, expected);
        }
    }
}
