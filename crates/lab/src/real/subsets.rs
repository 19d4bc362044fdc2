//! Which cameras are used together.

use anyhow::{Context, Result};

/// Up to so many cameras every pair is used; of more, only those that follow each other.
const ALL_PAIRS: usize = 4;

/// All cameras, each pair and each alone, as their numbers; or the lists of names that are asked for.
///
/// # Errors
/// A name that no camera has.
pub(super) fn of(cameras: &[&str], wanted: &[String]) -> Result<Vec<Vec<usize>>> {
    if !wanted.is_empty() {
        let number = |name: &str| {
            let place = cameras.iter().position(|camera| *camera == name.trim());
            place.with_context(|| format!("no camera '{name}'; there are {}", cameras.join(", ")))
        };
        return wanted.iter().map(|names| names.split(',').map(number).collect()).collect();
    }
    let count = cameras.len();
    let mut subsets = vec![(0..count).collect::<Vec<_>>()];
    for first in 0..count {
        for second in first + 1..count {
            if count > 2 && (count <= ALL_PAIRS || second == first + 1) {
                subsets.push(vec![first, second]);
            }
        }
    }
    if count > 1 {
        subsets.extend((0..count).map(|view| vec![view]));
    }
    Ok(subsets)
}

#[cfg(test)]
mod tests {
    #[test]
    fn all_then_pairs_then_each() {
        let names = ["a", "b", "c"];
        let of = |cameras: &[&str]| super::of(cameras, &[]).unwrap();
        let expected: [&[usize]; 7] = [&[0, 1, 2], &[0, 1], &[0, 2], &[1, 2], &[0], &[1], &[2]];
        assert_eq!(of(&names), expected);
        assert_eq!(of(&names[..2]), [&[0, 1][..], &[0], &[1]]);
        assert_eq!(of(&names[..1]), [[0]]);
        assert_eq!(of(&["camera"; 16]).len(), 1 + 15 + 16);
    }

    #[test]
    fn cameras_are_asked_for_by_name() {
        let names = ["a", "b", "c"];
        let of = |wanted: &str| super::of(&names, &[wanted.to_owned()]);
        assert_eq!(of("c,a").unwrap(), [[2, 0]]);
        assert!(of("d").unwrap_err().to_string().contains("a, b, c"));
    }
}
