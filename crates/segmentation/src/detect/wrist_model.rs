//! What a wrist looks like in a silhouette.

use std::fmt::Write;
use std::sync::LazyLock;

use crate::detect::cross_sections::FEATURES;
use crate::detect::gaussian::{Features, Gaussian};
use crate::error::{Error, Result};

const MAGIC: &str = "phalanx wrist model 1";

/// The logarithm of the density of anything that is no part of a hand and its arm as they were learnt:
/// what is unlike both classes is elsewhere.
const ANYTHING: f64 = 0.0;

/// Mean and covariance at wrists, then elsewhere.
type Parts = [(Features, [Features; FEATURES]); 2];

/// Tells the wrist from other sections of a silhouette: the narrowest behind the palm, with a hand
/// of the right length and area ahead and an arm that widens behind. A quadratic discriminant: one
/// normal distribution of some numbers at wrists, and one elsewhere on hands and arms.
#[derive(Debug, Clone, PartialEq)]
pub struct WristModel {
    parts: Box<Parts>,
    classes: [Gaussian; 2],
}

impl WristModel {
    /// The model that is built in, learnt from drawn hands in every direction.
    pub fn builtin() -> &'static Self {
        static BUILTIN: LazyLock<WristModel> = LazyLock::new(|| {
            WristModel::from_bytes(include_bytes!("../../models/wrist.txt"))
                .expect("the model that is built in is well-formed")
        });
        &BUILTIN
    }

    /// How much more likely the features are at a wrist than elsewhere, as a logarithm.
    pub(crate) fn evidence(&self, features: &Features) -> f64 {
        let [wrist, elsewhere] = &self.classes;
        wrist.log_density(features) - elsewhere.log_density(features).max(ANYTHING)
    }

    /// How far the features are from those of wrists: a squared Mahalanobis distance, about 11 on
    /// average at wrists.
    pub(crate) fn mahalanobis2(&self, features: &Features) -> f64 {
        self.classes[0].distance(features)
    }

    pub(crate) fn from_parts(parts: Box<Parts>) -> Option<Self> {
        let [wrist, elsewhere] = parts.each_ref().map(|(mean, cov)| Gaussian::new(*mean, cov));
        Some(Self { classes: [wrist?, elsewhere?], parts })
    }

    /// The model as UTF-8 text: a line with the format's version, then for wrists and for elsewhere
    /// a line of means and one for each row of the covariance.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut text = format!("{MAGIC}\n");
        for (mean, covariance) in self.parts.iter() {
            for row in std::iter::once(mean).chain(covariance) {
                let numbers: Vec<String> =
                    row.iter().map(|number| format!("{number:.5}")).collect();
                writeln!(text, "{}", numbers.join(" ")).expect("writing to a string does not fail");
            }
        }
        text.into_bytes()
    }

    /// Reads what [`WristModel::to_bytes`] wrote.
    ///
    /// # Errors
    /// Anything else, with the line at fault.
    ///
    /// ```
    /// use phalanx_segmentation::WristModel;
    ///
    /// let bytes = WristModel::builtin().to_bytes();
    /// assert_eq!(WristModel::from_bytes(&bytes)?.to_bytes(), bytes);
    /// assert!(WristModel::from_bytes(b"a palm").is_err());
    /// # Ok::<(), phalanx_segmentation::Error>(())
    /// ```
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        let error = |line, reason| Error::WristModel { line, reason };
        let text = std::str::from_utf8(bytes).map_err(|_| error(1, "the text is not UTF-8"))?;
        let mut lines = text.lines().zip(1..);
        if lines.next().is_none_or(|(line, _)| line != MAGIC) {
            return Err(error(1, "the first line must be `phalanx wrist model 1`"));
        }
        let mut row = || -> Result<Features> {
            let (line, number) = lines.next().ok_or(error(0, "rows are missing"))?;
            numbers(line).ok_or(error(number, "expected one number for each feature"))
        };
        let mut class = || -> Result<(Features, [Features; FEATURES])> {
            let mean = row()?;
            let mut covariance = [[0.0; FEATURES]; FEATURES];
            for values in &mut covariance {
                *values = row()?;
            }
            Ok((mean, covariance))
        };
        let parts = [class()?, class()?];
        Self::from_parts(Box::new(parts)).ok_or(error(0, "a covariance is not positive definite"))
    }
}

fn numbers(line: &str) -> Option<Features> {
    let mut words = line.split(' ').map(|word| word.parse().ok());
    let mut features = [0.0; FEATURES];
    for feature in &mut features {
        *feature = words.next()??;
    }
    words.next().is_none().then_some(features)
}
