//! How the codebooks of the views are learnt.

use phalanx_codebook::{AnyEncoder, Codebook, KMeans, SoftAssignment, Vlad};
use phalanx_sampling::random_subset;

use crate::error::{Error, Result};
use crate::pooled_encoder::PooledEncoder;
use crate::view_encoders::ViewEncoders;

/// The codebooks to learn: the paper's 90 centres, shared as evenly as they go by the views, so that
/// descriptors of one view and of three have the same length (§ 2); or all in one codebook, for
/// [`pool`](Self::pool).
#[derive(Debug, Clone, PartialEq)]
pub struct CodebookTrainer {
    /// Centres of all views together.
    pub centres: usize,
    /// How the shape contexts vote.
    pub assignment: SoftAssignment,
    /// At most this many shape contexts are clustered for a codebook, drawn at random from all.
    pub most_samples: usize,
    /// The clustering; its number of centres is replaced by each view's share, and each view
    /// has a seed of its own that follows from this one.
    pub clustering: KMeans,
}

impl Default for CodebookTrainer {
    fn default() -> Self {
        Self {
            centres: 90,
            assignment: SoftAssignment::default(),
            most_samples: 20_000,
            clustering: KMeans::default(),
        }
    }
}

impl CodebookTrainer {
    /// Learns a codebook for each view. `contexts[i][v]` holds the shape contexts of sample i
    /// in view v, `dim` numbers each, one after the other.
    ///
    /// # Errors
    /// No view, views that differ in number between samples, a view that is not a whole number
    /// of shape contexts, or what clustering reports.
    pub fn fit<S, V>(&self, contexts: &[S], dim: usize) -> Result<ViewEncoders>
    where
        S: AsRef<[V]>,
        V: AsRef<[f32]>,
    {
        ViewEncoders::soft_histograms(self.codebooks(contexts, dim)?, self.assignment)
    }

    /// Learns a codebook for each view, to code shape contexts by their residuals to its centres;
    /// `contexts` as in [`fit`](Self::fit).
    ///
    /// # Errors
    /// As of [`fit`](Self::fit).
    ///
    /// ```
    /// use phalanx_multiview::CodebookTrainer;
    ///
    /// // 40 samples of two views, five 3-bin histograms each.
    /// let histogram = |k: usize| {
    ///     let (a, b) = ((k % 7) as f32 / 12.0, (k % 5) as f32 / 12.0);
    ///     vec![a, b, 1.0 - a - b]
    /// };
    /// let sample = |i: usize| vec![(i..i + 5).flat_map(histogram).collect::<Vec<f32>>(); 2];
    /// let samples: Vec<_> = (0..40).map(sample).collect();
    ///
    /// let vocabulary = CodebookTrainer { centres: 4, ..CodebookTrainer::default() };
    /// let codes = vocabulary.fit_residuals(&samples, 3)?;
    /// assert_eq!(codes.dim(), 4 * 3); // two centres a view, three residuals a centre
    /// # Ok::<(), phalanx_multiview::Error>(())
    /// ```
    pub fn fit_residuals<S, V>(&self, contexts: &[S], dim: usize) -> Result<ViewEncoders>
    where
        S: AsRef<[V]>,
        V: AsRef<[f32]>,
    {
        let codebooks = self.codebooks(contexts, dim)?;
        ViewEncoders::from_parts(
            codebooks.into_iter().map(|codebook| AnyEncoder::Vlad(Vlad { codebook })).collect(),
        )
    }

    /// A codebook for each view.
    fn codebooks<S, V>(&self, contexts: &[S], dim: usize) -> Result<Vec<Codebook>>
    where
        S: AsRef<[V]>,
        V: AsRef<[f32]>,
    {
        let views = check(contexts, dim)?;
        let codebooks = (0..views).map(|view| {
            let clustering = KMeans {
                centres: self.centres / views + usize::from(view < self.centres % views),
                seed: self.clustering.seed.wrapping_mul(1_000_003).wrapping_add(view as u64),
                ..self.clustering
            };
            let of_view = contexts.iter().map(|sample| sample.as_ref()[view].as_ref());
            let fit = clustering.fit(&some_of(of_view, dim, self.most_samples), dim);
            fit.map(|fit| fit.codebook).map_err(|reason| Error::View { view, reason })
        });
        codebooks.collect()
    }

    /// Learns one codebook, of all the centres, from all views together; `contexts` as in
    /// [`fit`](Self::fit). Low-level fusion.
    ///
    /// # Errors
    /// As of [`fit`](Self::fit).
    ///
    /// ```
    /// use phalanx_multiview::{Scratch, CodebookTrainer};
    ///
    /// // 40 samples of two views, five 3-bin histograms each.
    /// let histogram = |k: usize| {
    ///     let (a, b) = ((k % 7) as f32 / 12.0, (k % 5) as f32 / 12.0);
    ///     vec![a, b, 1.0 - a - b]
    /// };
    /// let sample = |i: usize| vec![(i..i + 5).flat_map(histogram).collect::<Vec<f32>>(); 2];
    /// let samples: Vec<_> = (0..40).map(sample).collect();
    ///
    /// let pooled = CodebookTrainer { centres: 6, ..CodebookTrainer::default() }.pool(&samples, 3)?;
    /// let mut x = vec![0.0; pooled.dim()];
    /// pooled.describe(&samples[0], &mut Scratch::default(), &mut x)?;
    /// assert!((x.iter().sum::<f64>() - 1.0).abs() < 1e-6);
    /// # Ok::<(), phalanx_multiview::Error>(())
    /// ```
    pub fn pool<S, V>(&self, contexts: &[S], dim: usize) -> Result<PooledEncoder>
    where
        S: AsRef<[V]>,
        V: AsRef<[f32]>,
    {
        check(contexts, dim)?;
        let clustering = KMeans { centres: self.centres, ..self.clustering };
        let of_all = contexts.iter().flat_map(AsRef::as_ref).map(AsRef::as_ref);
        let fit = clustering.fit(&some_of(of_all, dim, self.most_samples), dim);
        PooledEncoder::from_parts(fit.map_err(Error::Pooled)?.codebook, self.assignment)
    }
}

/// The number of views, once every sample has as many and each is whole shape contexts.
fn check<S: AsRef<[V]>, V: AsRef<[f32]>>(contexts: &[S], dim: usize) -> Result<usize> {
    let views = contexts.first().map_or(0, |sample| sample.as_ref().len());
    if views == 0 {
        return Err(Error::NoViews);
    }
    for (sample, of_views) in contexts.iter().map(AsRef::as_ref).enumerate() {
        if of_views.len() != views {
            return Err(Error::ViewCount { expected: views, found: of_views.len() });
        }
        for (view, values) in of_views.iter().map(|view| view.as_ref().len()).enumerate() {
            if dim == 0 || !values.is_multiple_of(dim) {
                return Err(Error::Shape { sample, view, values, dim });
            }
        }
    }
    Ok(views)
}

/// The seed of the shape contexts that are clustered.
const SUBSET_SEED: u64 = 0;

/// At most `most` of the shape contexts, drawn at random. Every n-th would have the same phase of a motion
/// that repeats itself.
fn some_of<'a>(
    contexts: impl Iterator<Item = &'a [f32]> + Clone,
    dim: usize,
    most: usize,
) -> Vec<f32> {
    let total = contexts.clone().map(<[f32]>::len).sum::<usize>() / dim;
    let chosen = random_subset(total, most, SUBSET_SEED);
    let mut some = Vec::with_capacity(chosen.len() * dim);
    let mut chosen = chosen.into_iter().peekable();
    for (number, context) in contexts.flat_map(|values| values.chunks_exact(dim)).enumerate() {
        if chosen.next_if_eq(&number).is_some() {
            some.extend_from_slice(context);
        }
    }
    some
}
