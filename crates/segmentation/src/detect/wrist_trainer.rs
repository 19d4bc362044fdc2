//! Learns what hands look like at their wrists.

use crate::mask::Mask;

use crate::detect::cross_sections::FEATURES;
use crate::detect::detector::HandDetector;
use crate::detect::gaussian::Moments;
use crate::detect::wrist_model::WristModel;
use crate::error::{Error, Result};

/// Added to the variances of features: no silhouette is known more exactly.
const VARIANCE_FLOOR: f64 = 1e-3;

/// Learns a [`WristModel`] from silhouettes whose wrists are known.
#[derive(Debug, Clone, Default)]
pub struct WristTrainer {
    detector: HandDetector,
    moments: [Moments; 2],
    added: usize,
}

impl WristTrainer {
    /// CrossSections further from the wrist than this share of the hand's length are elsewhere.
    const APART: f64 = 0.15;

    /// Adds a silhouette of one hand whose arm leaves by the image border, and where its wrist is,
    /// in pixels; whether it could be used.
    ///
    /// # Errors
    /// No hand in the mask.
    pub fn add(&mut self, mask: &Mask, wrist: [f64; 2]) -> Result<bool> {
        let Some((sections, at)) = self.detector.sections_at(mask, wrist)? else {
            return Ok(false);
        };
        let Some(features) = sections.features(at) else { return Ok(false) };
        self.moments[0].add(&features);
        self.added += 1;
        let apart = Self::APART * (sections.count() - at) as f64;
        for section in 0..sections.count() {
            if (section as f64 - at as f64).abs() > apart
                && let Some(features) = sections.features(section)
            {
                self.moments[1].add(&features);
            }
        }
        Ok(true)
    }

    /// The model.
    ///
    /// # Errors
    /// Fewer silhouettes than features.
    pub fn finish(&self) -> Result<WristModel> {
        let parts = self.moments.each_ref().map(|moments| moments.finish(VARIANCE_FLOOR));
        let (found, needed) = (self.added, FEATURES);
        let model = WristModel::from_parts(Box::new(parts)).filter(|_| found >= needed);
        model.ok_or(Error::TooFewWrists { found, needed })
    }
}
