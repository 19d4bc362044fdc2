//! Intermediate fusion by any coding: each view's code, joined.

use phalanx_codebook::{AnyCoding, Coding};
use serde::{Deserialize, Serialize};

use crate::concatenation::Concatenation;
use crate::error::{Error, Result};
use crate::scratch::Scratch;

/// The codings of the views, whose codes are one after the other the descriptor x. With soft counts
/// it describes as a [`Concatenation`] does.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<AnyCoding>", into = "Vec<AnyCoding>")]
pub struct Codes {
    views: Vec<AnyCoding>,
}

impl Codes {
    /// Joins codings, one per view, in the order of the views.
    ///
    /// # Errors
    /// No view, or votes into more neighbours than a codebook has centres.
    ///
    /// ```
    /// use phalanx_codebook::{AnyCoding, Codebook, Vlad};
    /// use phalanx_multiview::{Codes, Scratch};
    ///
    /// let codebook = Codebook::from_parts(vec![1.0, 0.0, 0.0, 1.0], 2, 0.1)?;
    /// let view = AnyCoding::Vlad(Vlad { codebook });
    /// let joined = Codes::from_parts(vec![view.clone(), view])?;
    /// let mut x = vec![0.0; joined.dim()];
    /// joined.describe(&[[0.9, 0.1], [0.2, 0.8]], &mut Scratch::default(), &mut x)?;
    /// assert_eq!(x.len(), 8);
    /// assert!(x[0] < 0.0 && x[1] > 0.0, "the first histogram is to this side of its centre");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn from_parts(views: Vec<AnyCoding>) -> Result<Self> {
        if views.is_empty() {
            return Err(Error::NoViews);
        }
        for (view, coding) in views.iter().enumerate() {
            if let AnyCoding::Counts { codebook, voting } = coding {
                Concatenation::from_parts(vec![codebook.clone()], *voting)
                    .map_err(|error| error.in_view(view))?;
            }
        }
        Ok(Self { views })
    }

    /// The codings, one per view.
    pub fn views(&self) -> &[AnyCoding] {
        &self.views
    }

    /// The length of the joined vector.
    pub fn dim(&self) -> usize {
        self.views.iter().map(Coding::dim).sum()
    }

    /// Joins the codes of one sample's views into `x`. `contexts[v]` holds the shape contexts of
    /// view v one after the other.
    ///
    /// # Errors
    /// Another number of views, an `x` of another length, or what a coding says of its contexts.
    pub fn describe<C: AsRef<[f32]>>(
        &self,
        contexts: &[C],
        scratch: &mut Scratch,
        x: &mut [f64],
    ) -> Result<()> {
        join(self.views.iter(), contexts, scratch, x)
    }
}

impl From<Concatenation> for Codes {
    fn from(joined: Concatenation) -> Self {
        let voting = joined.voting();
        let coding = |codebook: &_| AnyCoding::Counts { codebook: Clone::clone(codebook), voting };
        Self { views: joined.codebooks().iter().map(coding).collect() }
    }
}

impl TryFrom<Vec<AnyCoding>> for Codes {
    type Error = Error;

    fn try_from(views: Vec<AnyCoding>) -> Result<Self> {
        Self::from_parts(views)
    }
}

impl From<Codes> for Vec<AnyCoding> {
    fn from(codes: Codes) -> Self {
        codes.views
    }
}

/// The codes of the views, one after the other.
pub(crate) fn join<'a, T: Coding + 'a, C: AsRef<[f32]>>(
    codings: impl ExactSizeIterator<Item = &'a T> + Clone,
    contexts: &[C],
    scratch: &mut Scratch,
    x: &mut [f64],
) -> Result<()> {
    if contexts.len() != codings.len() {
        return Err(Error::ViewCount { expected: codings.len(), found: contexts.len() });
    }
    let dim = codings.clone().map(Coding::dim).sum();
    if x.len() != dim {
        return Err(Error::OutputLength { expected: dim, found: x.len() });
    }
    let mut rest = x;
    for (view, (coding, contexts)) in codings.zip(contexts).enumerate() {
        let part;
        (part, rest) = rest.split_at_mut(coding.dim());
        coding
            .encode(contexts.as_ref(), &mut scratch.coding, part)
            .map_err(|reason| Error::View { view, reason })?;
    }
    Ok(())
}
