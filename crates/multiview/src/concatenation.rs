//! Intermediate fusion: each view's histogram, joined.

use phalanx_codebook::{Codebook, SoftCounts, Voting};
use serde::{Deserialize, Serialize};

use crate::codes::join;
use crate::error::{Error, Result};
use crate::scratch::Scratch;

/// The fitted codebooks of the views; joins the views' histograms into one vector x (§ 2 of the
/// paper: "combine the information at an intermediate level").
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Parts", into = "Parts")]
pub struct Concatenation {
    codebooks: Vec<Codebook>,
    voting: Voting,
}

/// The stored form of a [`Concatenation`].
#[derive(Serialize, Deserialize)]
struct Parts {
    codebooks: Vec<Codebook>,
    voting: Voting,
}

impl TryFrom<Parts> for Concatenation {
    type Error = Error;

    fn try_from(parts: Parts) -> Result<Self> {
        Self::from_parts(parts.codebooks, parts.voting)
    }
}

impl From<Concatenation> for Parts {
    fn from(joined: Concatenation) -> Self {
        Self { codebooks: joined.codebooks, voting: joined.voting }
    }
}

impl Concatenation {
    /// Joins codebooks, one per view, in the order of the views.
    ///
    /// # Errors
    /// No view, or a codebook with fewer centres than each shape context votes into.
    ///
    /// ```
    /// use phalanx_codebook::{Codebook, Voting};
    /// use phalanx_multiview::{Concatenation, Scratch};
    ///
    /// let codebook = Codebook::from_parts(vec![1.0, 0.0, 0.0, 1.0], 2, 0.1)?;
    /// let joined = Concatenation::from_parts(vec![codebook.clone(), codebook], Voting::HARD)?;
    /// let views = [[0.9, 0.1], [0.2, 0.8]]; // one histogram each
    /// let mut x = [0.0; 4];
    /// joined.describe(&views, &mut Scratch::default(), &mut x)?;
    /// assert_eq!(x, [1.0, 0.0, 0.0, 1.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn from_parts(codebooks: Vec<Codebook>, voting: Voting) -> Result<Self> {
        if codebooks.is_empty() {
            return Err(Error::NoViews);
        }
        let Voting { neighbours } = voting;
        for (view, centres) in codebooks.iter().map(Codebook::len).enumerate() {
            if !(1..=centres).contains(&neighbours) {
                let reason = phalanx_codebook::Error::Neighbours { neighbours, centres };
                return Err(Error::View { view, reason });
            }
        }
        Ok(Self { codebooks, voting })
    }

    /// The codebooks, one per view.
    pub fn codebooks(&self) -> &[Codebook] {
        &self.codebooks
    }

    /// How shape contexts vote.
    pub fn voting(&self) -> Voting {
        self.voting
    }

    /// The number of views.
    pub fn views(&self) -> usize {
        self.codebooks.len()
    }

    /// The length of the joined vector: the centres of all views.
    pub fn dim(&self) -> usize {
        self.codebooks.iter().map(Codebook::len).sum()
    }

    /// Joins the histograms of one sample's views into `x`: each view's part is non-negative
    /// and sums to 1. `contexts[v]` holds the shape contexts of view v one after the other.
    ///
    /// # Errors
    /// Another number of views, an `x` of another length, or what a codebook says of its
    /// contexts.
    pub fn describe<C: AsRef<[f32]>>(
        &self,
        contexts: &[C],
        scratch: &mut Scratch,
        x: &mut [f64],
    ) -> Result<()> {
        let views: Vec<SoftCounts<'_>> = self
            .codebooks
            .iter()
            .map(|codebook| SoftCounts { codebook, voting: self.voting })
            .collect();
        join(views.iter(), contexts, scratch, x)
    }
}
