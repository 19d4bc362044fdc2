//! The orientation rules by name, for the command line.

use clap::ValueEnum;
use phalanx::OrientationRule;

/// Which way shape contexts are turned.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
pub(crate) enum Orientation {
    /// The image's axes.
    ImageAxes,
    /// The contour's tangent at each point.
    Tangent,
    /// The line to the contour's centroid at each point.
    Centroid,
    /// The contour's principal axis.
    PrincipalAxis,
    /// From the forearm's end to the hand's tip: the paper's rule.
    HandAxis,
    /// The forearm's axis, by its two sides.
    ForearmAxis,
}

impl Orientation {
    /// The name in tables and JSON.
    ///
    /// # Panics
    /// Never: every rule has a name on the command line.
    pub(crate) fn name(self) -> String {
        let name = self.to_possible_value().expect("every rule is a value of the command line");
        name.get_name().replace('_', " ")
    }

    pub(crate) fn rule(self) -> OrientationRule {
        match self {
            Self::ImageAxes => OrientationRule::ImageAxes,
            Self::Tangent => OrientationRule::Tangent,
            Self::Centroid => OrientationRule::Centroid,
            Self::PrincipalAxis => OrientationRule::PrincipalAxis,
            Self::HandAxis => OrientationRule::HandAxis,
            Self::ForearmAxis => OrientationRule::ForearmAxis,
        }
    }
}
