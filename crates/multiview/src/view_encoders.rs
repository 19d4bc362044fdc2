//! Intermediate fusion: each view's code, joined.

use phalanx_codebook::{AnyEncoder, Codebook, Encoder, SoftAssignment};
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::scratch::Scratch;

/// The encoders of the views; joins the views' codes into one vector x (§ 2 of the paper: "combine
/// the information at an intermediate level").
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<AnyEncoder>", into = "Vec<AnyEncoder>")]
pub struct ViewEncoders {
    views: Vec<AnyEncoder>,
}

impl ViewEncoders {
    /// Joins encoders, one per view, in the order of the views.
    ///
    /// # Errors
    /// No view, or votes into more neighbours than a codebook has centres.
    ///
    /// ```
    /// use phalanx_codebook::{AnyEncoder, Codebook, Vlad};
    /// use phalanx_multiview::{Scratch, ViewEncoders};
    ///
    /// let codebook = Codebook::from_parts(vec![1.0, 0.0, 0.0, 1.0], 2, 0.1)?;
    /// let view = AnyEncoder::Vlad(Vlad { codebook });
    /// let joined = ViewEncoders::from_parts(vec![view.clone(), view])?;
    /// let mut x = vec![0.0; joined.dim()];
    /// joined.describe(&[[0.9, 0.1], [0.2, 0.8]], &mut Scratch::default(), &mut x)?;
    /// assert_eq!(x.len(), 8);
    /// assert!(x[0] < 0.0 && x[1] > 0.0, "the first histogram is to this side of its centre");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn from_parts(views: Vec<AnyEncoder>) -> Result<Self> {
        if views.is_empty() {
            return Err(Error::NoViews);
        }
        for (view, encoder) in views.iter().enumerate() {
            if let AnyEncoder::SoftHistogram { codebook, assignment } = encoder {
                let (neighbours, centres) = (assignment.neighbours, codebook.len());
                if !(1..=centres).contains(&neighbours) {
                    let reason = phalanx_codebook::Error::Neighbours { neighbours, centres };
                    return Err(Error::View { view, reason });
                }
            }
        }
        Ok(Self { views })
    }

    /// Joins soft histograms: the paper's choice. Each view's part of x is non-negative and sums
    /// to 1.
    ///
    /// # Errors
    /// As of [`from_parts`](Self::from_parts).
    ///
    /// ```
    /// use phalanx_codebook::{Codebook, SoftAssignment};
    /// use phalanx_multiview::{Scratch, ViewEncoders};
    ///
    /// let codebook = Codebook::from_parts(vec![1.0, 0.0, 0.0, 1.0], 2, 0.1)?;
    /// let both = vec![codebook.clone(), codebook];
    /// let joined = ViewEncoders::soft_histograms(both, SoftAssignment::HARD)?;
    /// let views = [[0.9, 0.1], [0.2, 0.8]]; // one histogram each
    /// let mut x = [0.0; 4];
    /// joined.describe(&views, &mut Scratch::default(), &mut x)?;
    /// assert_eq!(x, [1.0, 0.0, 0.0, 1.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn soft_histograms(codebooks: Vec<Codebook>, assignment: SoftAssignment) -> Result<Self> {
        let view = |codebook| AnyEncoder::SoftHistogram { codebook, assignment };
        Self::from_parts(codebooks.into_iter().map(view).collect())
    }

    /// The encoders, one per view.
    pub fn views(&self) -> &[AnyEncoder] {
        &self.views
    }

    /// The codebooks of the views, in order; Fisher vectors have none.
    pub fn codebooks(&self) -> Vec<&Codebook> {
        self.views.iter().filter_map(AnyEncoder::codebook).collect()
    }

    /// The length of the joined vector.
    pub fn dim(&self) -> usize {
        self.views.iter().map(Encoder::dim).sum()
    }

    /// Joins the codes of one sample's views into `x`. `contexts[v]` holds the shape contexts of
    /// view v one after the other.
    ///
    /// # Errors
    /// Another number of views, an `x` of another length, or what an encoder says of its contexts.
    pub fn describe<C: AsRef<[f32]>>(
        &self,
        contexts: &[C],
        scratch: &mut Scratch,
        x: &mut [f64],
    ) -> Result<()> {
        let all: Vec<Option<&[f32]>> = contexts.iter().map(|view| Some(view.as_ref())).collect();
        self.describe_some(&all, scratch, x)
    }

    /// Joins the codes of the views that there are into `x`; the part of one that is missing is zero.
    ///
    /// # Errors
    /// As of [`describe`](Self::describe).
    pub fn describe_some(
        &self,
        contexts: &[Option<&[f32]>],
        scratch: &mut Scratch,
        x: &mut [f64],
    ) -> Result<()> {
        if contexts.len() != self.views.len() {
            return Err(Error::ViewCount { expected: self.views.len(), found: contexts.len() });
        }
        if x.len() != self.dim() {
            return Err(Error::OutputLength { expected: self.dim(), found: x.len() });
        }
        let mut rest = x;
        for (view, (encoder, contexts)) in self.views.iter().zip(contexts).enumerate() {
            let part;
            (part, rest) = rest.split_at_mut(encoder.dim());
            let Some(contexts) = contexts else {
                part.fill(0.0);
                continue;
            };
            encoder
                .encode(contexts, &mut scratch.coding, part)
                .map_err(|reason| Error::View { view, reason })?;
        }
        Ok(())
    }
}

impl TryFrom<Vec<AnyEncoder>> for ViewEncoders {
    type Error = Error;

    fn try_from(views: Vec<AnyEncoder>) -> Result<Self> {
        Self::from_parts(views)
    }
}

impl From<ViewEncoders> for Vec<AnyEncoder> {
    fn from(encoders: ViewEncoders) -> Self {
        encoders.views
    }
}
