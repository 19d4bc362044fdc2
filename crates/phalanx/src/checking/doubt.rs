//! What is doubtful about an answer.

use std::fmt::{self, Display, Formatter};

use crate::losses::LossReason;

/// Why an answer may be wrong, as one view shows it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewDoubt {
    /// The view's number, in the order of the rig's cameras.
    pub view: usize,
    /// The likely cause.
    pub cause: Cause,
}

/// The likely cause of a doubt about a view.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Cause {
    /// No hand was found in it, for this reason; the answer is from the other views.
    NotSeen(LossReason),
    /// The forearm does not reach the border of the picture; its end was guessed.
    GuessedForearm,
    /// The hand crosses the border of the picture more than once.
    BorderCrossings(usize),
    /// The estimated hand reaches beyond the border of the picture.
    CutOff,
    /// More of the picture's border is hand than not.
    InvertedMask,
    /// The view shows what another camera should see: the one of this number.
    SwappedCamera(usize),
    /// The hand is of the other side than the model's.
    OtherSide,
    /// Another pose of the hand explains what the views show.
    PoorEstimate,
    /// The mask does not show the hand that the other views show, or no hand that could be explained.
    ForeignMask,
    /// What was found in the photograph is not the hand, or not all of it.
    Segmentation,
    /// The estimated hand is not what the view shows; [`Estimator::explain`](crate::Estimator::explain) finds
    /// out why.
    Unlike,
}

impl Cause {
    /// Whether all that is known is that the estimated hand is not what was seen.
    pub(crate) fn is_unexplained(self) -> bool {
        matches!(self, Self::Unlike | Self::CutOff)
    }

    /// A short name, for programs.
    pub fn name(self) -> &'static str {
        match self {
            Self::NotSeen(_) => "not_seen",
            Self::GuessedForearm => "guessed_forearm",
            Self::BorderCrossings(_) => "border_crossings",
            Self::CutOff => "cut_off",
            Self::InvertedMask => "inverted_mask",
            Self::SwappedCamera(_) => "swapped_camera",
            Self::OtherSide => "other_side",
            Self::PoorEstimate => "poor_estimate",
            Self::ForeignMask => "foreign_mask",
            Self::Segmentation => "segmentation",
            Self::Unlike => "unlike",
        }
    }
}

impl Display for Cause {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Self::BorderCrossings(crossings) => {
                return write!(
                    out,
                    "the hand crosses the border {crossings} times; the longest crossing is taken for \
                     the forearm"
                );
            }
            Self::NotSeen(reason) => {
                return write!(out, "{reason}; the estimate is from the other views");
            }
            Self::GuessedForearm => {
                "the forearm does not reach the border of the picture; its end was guessed"
            }
            Self::CutOff => "the estimated hand reaches beyond the border of the picture",
            Self::InvertedMask => {
                "the mask looks inverted: more of its border is hand than not; hand should be white"
            }
            Self::SwappedCamera(_) => "it shows what another camera should see",
            Self::OtherSide => {
                "a hand of the other side explains it better; the model is of one side only"
            }
            Self::PoorEstimate => "another pose explains what it shows; refine the estimate",
            Self::ForeignMask => {
                "what it shows is not the estimated hand; is it a mask of this hand, of the same moment?"
            }
            Self::Segmentation => {
                "what was taken for skin is not the estimated hand; look at light, white balance and \
                 background, or give masks"
            }
            Self::Unlike => "the estimated hand is not what it shows",
        })
    }
}
