//! Which end of an arm the hand is at.

use std::fmt::Write;
use std::sync::LazyLock;

use crate::detect::cross_sections::PROFILE;
use crate::error::{Error, Result};

const MAGIC: &str = "phalanx end model 1";

/// Weights of a constant, of the numbers of a profile, and of their products.
const WEIGHTS: usize = 1 + PROFILE + PROFILE * (PROFILE + 1) / 2;

/// How far from the mean a number counts as it is, in standard deviations: products of what was never seen say nothing.
const REACH: f64 = 4.0;

/// Tells whether the hand is ahead of a wrist or behind it, from how wide the limb is on either side: an arm that ends
/// in a sleeve has two ends in the picture. Logistic regression on the numbers of a [profile] and their products.
///
/// [profile]: crate::HandDetection::profile
#[derive(Debug, Clone, PartialEq)]
pub struct EndModel(EndParts);

/// What an [`EndModel`] is made of.
#[derive(Debug, Clone, PartialEq)]
pub struct EndParts {
    /// The mean of each number of a profile.
    pub means: [f64; PROFILE],
    /// Its standard deviation.
    pub deviations: [f64; PROFILE],
    /// The weight of each of the [`terms`](Self::terms).
    pub weights: Vec<f64>,
}

impl EndParts {
    /// What is weighed of a profile: 1, its numbers as so many standard deviations from the mean, and their products.
    pub fn terms(&self, profile: &[f64; PROFILE]) -> Vec<f64> {
        let standard = |k: usize| (profile[k] - self.means[k]) / self.deviations[k];
        let z: [f64; PROFILE] = std::array::from_fn(|k| standard(k).clamp(-REACH, REACH));
        let products = (0..PROFILE).flat_map(|i| (i..PROFILE).map(move |j| z[i] * z[j]));
        std::iter::once(1.0).chain(z).chain(products).collect()
    }
}

impl EndModel {
    /// The model that is built in, learnt from drawn hands whose arms end anywhere.
    pub fn builtin() -> &'static Self {
        static BUILTIN: LazyLock<EndModel> = LazyLock::new(|| {
            EndModel::from_bytes(include_bytes!("../../models/end.txt"))
                .expect("the model that is built in is well-formed")
        });
        &BUILTIN
    }

    /// # Errors
    /// Another number of weights than terms, deviations that are not positive, and numbers that are not finite.
    pub fn from_parts(parts: EndParts) -> Result<Self> {
        let numbers = || parts.means.iter().chain(&parts.deviations).chain(&parts.weights);
        if parts.weights.len() != WEIGHTS {
            return Err(Error::EndModel("there must be one weight for each term"));
        }
        if !numbers().all(|number| number.is_finite()) {
            return Err(Error::EndModel("numbers must be finite"));
        }
        if parts.deviations.iter().any(|deviation| *deviation <= 0.0) {
            return Err(Error::EndModel("deviations must be positive"));
        }
        Ok(Self(parts))
    }

    /// How much likelier the hand is ahead of a wrist with this profile than behind it, as the logarithm of the odds.
    pub fn log_odds(&self, profile: &[f64; PROFILE]) -> f64 {
        self.0.terms(profile).iter().zip(&self.0.weights).map(|(term, weight)| term * weight).sum()
    }

    /// The model as UTF-8 text: a line with the format's version, then means, deviations and weights, a line each.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut text = format!("{MAGIC}\n");
        for row in [&self.0.means[..], &self.0.deviations, &self.0.weights] {
            let numbers: Vec<String> = row.iter().map(|number| format!("{number:.5}")).collect();
            writeln!(text, "{}", numbers.join(" ")).expect("writing to a string does not fail");
        }
        text.into_bytes()
    }

    /// Reads what [`EndModel::to_bytes`] wrote.
    ///
    /// # Errors
    /// Anything else.
    ///
    /// ```
    /// use phalanx_segmentation::EndModel;
    ///
    /// let bytes = EndModel::builtin().to_bytes();
    /// assert_eq!(EndModel::from_bytes(&bytes)?.to_bytes(), bytes);
    /// assert!(EndModel::from_bytes(b"an elbow").is_err());
    /// # Ok::<(), phalanx_segmentation::Error>(())
    /// ```
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        let text =
            std::str::from_utf8(bytes).map_err(|_| Error::EndModel("the text is not UTF-8"))?;
        let mut lines = text.lines();
        if lines.next() != Some(MAGIC) {
            return Err(Error::EndModel("the first line must be `phalanx end model 1`"));
        }
        let mut row = || -> Result<Vec<f64>> {
            let line = lines.next().ok_or(Error::EndModel("rows are missing"))?;
            let numbers = line.split(' ').map(str::parse).collect::<std::result::Result<_, _>>();
            numbers.map_err(|_| Error::EndModel("expected numbers, a space between them"))
        };
        let mut of_profile = || -> Result<[f64; PROFILE]> {
            let wrong = |_| Error::EndModel("expected one number for each of a profile");
            row()?.try_into().map_err(wrong)
        };
        let (means, deviations) = (of_profile()?, of_profile()?);
        Self::from_parts(EndParts { means, deviations, weights: row()? })
    }
}
