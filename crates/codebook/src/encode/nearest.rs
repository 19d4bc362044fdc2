//! The nearest of some centres.

/// A centre's distance and, to settle ties, its index, in one number that orders them: the bits of
/// floats that are not negative are in the order of the floats.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Rank(u64);

impl Rank {
    fn new(centre: usize, distance: f32) -> Self {
        Self(u64::from(distance.to_bits()) << 32 | centre as u64)
    }

    pub(crate) fn distance(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }

    pub(crate) fn centre(self) -> usize {
        self.0 as u32 as usize
    }
}

/// The `count` nearest centres, in no particular order.
pub(crate) fn find_nearest<'a>(
    distances: &[f32],
    count: usize,
    ranks: &'a mut Vec<Rank>,
) -> &'a [Rank] {
    ranks.clear();
    ranks.extend(distances.iter().enumerate().map(|(centre, &d)| Rank::new(centre, d)));
    if count < ranks.len() {
        ranks.select_nth_unstable(count);
    }
    &ranks[..count]
}
