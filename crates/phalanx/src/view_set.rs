//! Some of a rig's cameras.

use serde::{Deserialize, Serialize};

/// Some of a rig's cameras, of which there are at most [`MOST`](Self::MOST); bit v stands for camera v.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct ViewSet(u64);

impl ViewSet {
    /// Cameras that there may be; of more only all are learnt.
    const MOST: usize = u64::BITS as usize;

    /// Cameras of which every subset is learnt. Of more there are too many.
    const ALL_LEARNT: usize = 4;

    /// These cameras.
    pub(crate) fn of(views: impl IntoIterator<Item = usize>) -> Self {
        Self(views.into_iter().fold(0, |bits, view| bits | 1 << view))
    }

    /// The subsets of so many cameras that are learnt beside all: of up to four every one; of more each
    /// camera alone, each two, and all but each one.
    pub(crate) fn learnt(cameras: usize) -> Vec<Self> {
        let all = 0..cameras;
        match cameras {
            2..=Self::ALL_LEARNT => (1..(1 << cameras) - 1).map(Self).collect(),
            5..=Self::MOST => {
                let up_to_two =
                    all.clone().flat_map(|a| (a..cameras).map(move |b| Self::of([a, b])));
                let but_one =
                    all.clone().map(|out| Self::of(all.clone().filter(|&view| view != out)));
                up_to_two.chain(but_one).collect()
            }
            _ => Vec::new(),
        }
    }

    /// As a number, a bit a camera.
    pub(crate) fn bits(self) -> u64 {
        self.0
    }

    pub(crate) fn count(self) -> usize {
        self.0.count_ones() as usize
    }

    pub(crate) fn contains(self, view: usize) -> bool {
        self.0 >> view & 1 == 1
    }

    pub(crate) fn is_within(self, other: Self) -> bool {
        self.0 & !other.0 == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_subset_of_few_cameras_is_learnt_and_of_many_some() {
        let learnt = |cameras| -> Vec<Vec<usize>> {
            let views = |set: ViewSet| (0..cameras).filter(|&view| set.contains(view)).collect();
            ViewSet::learnt(cameras).into_iter().map(views).collect()
        };
        assert_eq!(learnt(1), [[0; 0]; 0]);
        assert_eq!(learnt(2), [[0], [1]]);
        assert_eq!(learnt(3), [&[0][..], &[1], &[0, 1], &[2], &[0, 2], &[1, 2]]);
        assert_eq!(learnt(4).len(), 14);
        let of_five = learnt(5);
        assert_eq!(of_five.iter().map(Vec::len).filter(|&count| count == 1).count(), 5);
        assert_eq!(of_five.iter().map(Vec::len).filter(|&count| count == 2).count(), 10);
        assert_eq!(of_five.iter().map(Vec::len).filter(|&count| count == 4).count(), 5);
    }
}
