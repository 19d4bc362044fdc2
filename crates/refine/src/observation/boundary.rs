//! The boundary of a silhouette: its *edges*, the middles of the pixel edges between hand and background.

use glam::DVec2;
use phalanx_segmentation::Mask;

/// The pixels on both sides of an edge.
pub(crate) fn beside(edge: DVec2) -> [[u32; 2]; 2] {
    [-0.25, 0.25].map(|offset| [(edge.x + offset) as u32, (edge.y + offset) as u32])
}

/// Whether the pixels on both sides of an edge are known.
pub(crate) fn is_known(known: &Mask, edge: DVec2) -> bool {
    beside(edge).iter().all(|&[x, y]| known.is_hand(x, y))
}

/// The middles of the pixel edges between hand and background, px, row by row.
pub(crate) fn boundary_edges(mask: &Mask, edges: &mut Vec<DVec2>) {
    edges.clear();
    let rows: &[u8] = mask.as_raw();
    let mut above: &[u8] = &[];
    for (y, row) in rows.chunks_exact(mask.width() as usize).enumerate() {
        let y = y as f64;
        let (to_the_left, own) = (&row[..row.len() - 1], &row[1..]);
        changes(to_the_left, own, |x| edges.push(DVec2::new(x as f64 + 1.0, y + 0.5)));
        changes(above, row, |x| edges.push(DVec2::new(x as f64 + 0.5, y)));
        above = row;
    }
}

/// The pixels of two masks that are known, and hand in one of them alone, in order.
pub(crate) fn differing<'a>(
    [one, other]: [&'a Mask; 2],
    known: &'a Mask,
) -> impl Iterator<Item = usize> + 'a {
    let ((ones, one), (others, other)) = (one.as_chunks(), other.as_chunks());
    let (knowns, known) = known.as_chunks();
    let pieces = ones.iter().zip(others).zip(knowns).enumerate();
    let levels = |piece: &[u8; PIECE]| u64::from_le_bytes(*piece);
    let pieces = pieces.map(move |(k, ((one, other), known))| {
        (k, (levels(one) ^ levels(other)) & levels(known) & HAND_LEVELS)
    });
    // Nearly all of a picture is alike.
    let differing = pieces.filter(|(_, differing)| *differing != 0).flat_map(|(k, differing)| {
        (0..PIECE)
            .filter(move |at| differing >> (u8::BITS as usize * at) & 0x80 != 0)
            .map(move |at| PIECE * k + at)
    });
    let last = one.iter().zip(other).zip(known).enumerate();
    let last =
        last.filter(|(_, ((one, other), known))| Mask::is_hand_level((*one ^ *other) & *known));
    differing.chain(last.map(move |(at, _)| PIECE * ones.len() + at))
}

/// Pixels that are looked at together.
const PIECE: usize = 8;

/// Calls for every place at which one row of pixels is hand and the other is not.
fn changes(one: &[u8], other: &[u8], mut at: impl FnMut(usize)) {
    // Nearly all of a picture is alike.
    if one == other {
        return;
    }
    let ((ones, one_end), (others, other_end)) = (one.as_chunks::<PIECE>(), other.as_chunks());
    for (k, (one, other)) in ones.iter().zip(others).enumerate() {
        let mut differing = (u64::from_le_bytes(*one) ^ u64::from_le_bytes(*other)) & HAND_LEVELS;
        while differing != 0 {
            at(PIECE * k + (differing.trailing_zeros() / u8::BITS) as usize);
            differing &= differing - 1;
        }
    }
    for (k, (one, other)) in one_end.iter().zip(other_end).enumerate() {
        if Mask::is_hand_level(*one) != Mask::is_hand_level(*other) {
            at(PIECE * ones.len() + k);
        }
    }
}

/// The bit of each of eight levels that all levels of hand have and no other.
const HAND_LEVELS: u64 = u64::from_ne_bytes([0x80; 8]);

/// Which way the background is from an edge: from the mean of the hand's pixels around it to the
/// edge.
pub(crate) fn outwards(mask: &Mask, edge: DVec2) -> DVec2 {
    const RADIUS: f64 = 2.5;
    let range = |at: f64, size: u32| {
        let first = (at - RADIUS).max(0.0) as u32;
        first..size.min((at + RADIUS).ceil() as u32)
    };
    let mut sum = DVec2::ZERO;
    for y in range(edge.y, mask.height()) {
        for x in range(edge.x, mask.width()) {
            let sign = if mask.is_hand(x, y) { -1.0 } else { 1.0 };
            sum += (DVec2::new(f64::from(x), f64::from(y)) + 0.5 - edge) * sign;
        }
    }
    sum.normalize_or_zero()
}
