/// Heights up to this count as zero in a histogram. They would change χ² by less than f32 can show,
/// and without them no product of two denominators underflows.
const NEGLIGIBLE: f32 = 1e-12;

/// A vector prepared to be compared with many others at once.
#[derive(Debug, Clone, Default)]
pub(crate) struct Support {
    /// For Euclidean distances, the vector with the others' origin taken away.
    pub(crate) moved: Vec<f32>,
    bins: Vec<Bin>,
    filled: usize,
    /// The filled bins of a histogram, two by two.
    pub(crate) pairs: Vec<Pair>,
    /// Their sum; for Euclidean distances that of the squares.
    pub(crate) mass: f32,
}

#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Bin {
    pub(crate) index: usize,
    pub(crate) height: f32,
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct Pair {
    pub(crate) a: Bin,
    pub(crate) b: Bin,
    /// a²
    pub(crate) squared: f32,
    /// b² / a²
    pub(crate) ratio: f32,
}

impl Support {
    /// Sums the squares of the moved vector, in partial sums that do not wait for each other.
    pub(crate) fn sum_squares(&mut self) {
        let mut squares = [0.0; 16];
        for part in self.moved.chunks(squares.len()) {
            for (square, value) in squares.iter_mut().zip(part) {
                *square += value * value;
            }
        }
        self.mass = squares.iter().sum();
    }

    pub(crate) fn find_filled(&mut self, histogram: &[f32]) {
        self.bins.resize(histogram.len(), Bin::default());
        // Without a branch for the processor to guess.
        let mut filled = 0;
        for (index, &height) in histogram.iter().enumerate() {
            self.bins[filled] = Bin { index, height };
            filled += usize::from(height > NEGLIGIBLE);
        }
        self.filled = filled;
        let bins = &self.bins[..filled];
        self.mass = bins.iter().map(|bin| bin.height).sum();
        self.pairs.clear();
        self.pairs.extend(bins.chunks(2).map(|bins| Pair::new(bins[0], bins.get(1).copied())));
    }
}

impl Pair {
    fn new(a: Bin, b: Option<Bin>) -> Self {
        let squared = a.height * a.height;
        match b {
            Some(b) => Self { a, b, squared, ratio: b.height * b.height / squared },
            // Any b will do that keeps its denominator from zero.
            None => Self { a, b: Bin { index: a.index, height: 1.0 }, squared, ratio: 0.0 },
        }
    }
}
