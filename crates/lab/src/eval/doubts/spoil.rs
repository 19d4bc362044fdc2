//! What is wrong with masks.

use image::imageops;
use phalanx::{Cause, ItemRng, Mask};

use crate::eval::doubts::outcome::Outcome;

/// What is wrong with the masks of a scene.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Spoil {
    /// Nothing: the hand and the cameras that the model is of.
    Nothing,
    /// Nothing: a hand of someone else, cameras a little turned, ragged borders.
    Stranger,
    /// A left hand before a model of right ones.
    OtherSide,
    /// Two cameras are exchanged, each pair in turn.
    Swapped,
    /// Hand is black.
    Inverted,
    /// One view has no hand.
    Empty,
    /// One view shows the hand in another pose.
    ForeignPose,
    /// All views show a blob.
    NoHand,
}

impl Spoil {
    /// All that can be wrong with so many views.
    pub(super) fn of_views(views: usize) -> Vec<Self> {
        let mut spoils = vec![Self::Nothing, Self::Stranger, Self::OtherSide];
        if views > 1 {
            spoils.push(Self::Swapped);
        }
        spoils.extend([Self::Inverted, Self::Empty]);
        if views > 1 {
            spoils.push(Self::ForeignPose);
        }
        spoils.push(Self::NoHand);
        spoils
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Nothing => "right",
            Self::Stranger => "right, of other hands",
            Self::OtherSide => "left hand",
            Self::Swapped => "two cameras exchanged",
            Self::Inverted => "inverted",
            Self::Empty => "one empty",
            Self::ForeignPose => "one of another pose",
            Self::NoHand => "all of something else",
        }
    }

    /// Whether nothing is wrong.
    pub(super) fn is_right(self) -> bool {
        matches!(self, Self::Nothing | Self::Stranger)
    }

    /// The masks of a scene as they are spoilt; `others` are those of another pose.
    pub(super) fn of(self, mut masks: Vec<Mask>, others: &[Mask], number: usize) -> Vec<Mask> {
        let view = number % masks.len();
        match self {
            Self::Nothing | Self::Stranger | Self::OtherSide => {}
            Self::Swapped => masks.swap(view, (view + 1) % others.len()),
            Self::Inverted => masks.iter_mut().for_each(|mask| imageops::invert(&mut **mask)),
            Self::Empty => masks[view].fill(0),
            Self::ForeignPose => masks[view] = others[view].clone(),
            Self::NoHand => {
                let mut random = ItemRng::new(0, number as u64);
                for mask in &mut masks {
                    draw_blob(mask, &mut random);
                }
            }
        }
        masks
    }

    /// Whether an outcome names the view and the cause.
    pub(super) fn is_named(self, number: usize, views: usize, outcome: &Outcome) -> bool {
        let view = number % views;
        let has = |view: Option<usize>, cause: Cause| match outcome {
            Outcome::Refused(_) => false,
            Outcome::Answered(doubts) => doubts
                .iter()
                .any(|doubt| doubt.cause == cause && view.is_none_or(|view| doubt.view == view)),
        };
        let refused = |at: Option<usize>| matches!(outcome, Outcome::Refused(view) if at.is_none_or(|at| at == *view));
        match self {
            Self::Nothing | Self::Stranger => false,
            Self::OtherSide => has(None, Cause::OtherSide),
            Self::Swapped => {
                let other = (view + 1) % views;
                has(Some(view), Cause::SwappedCamera(other))
                    && has(Some(other), Cause::SwappedCamera(view))
            }
            // The message of a refusal says so too.
            Self::Inverted => refused(None) || has(None, Cause::InvertedMask),
            Self::Empty => refused(Some(view)) || is_left_out(outcome, view),
            Self::ForeignPose => has(Some(view), Cause::ForeignMask),
            Self::NoHand => refused(None) || has(None, Cause::ForeignMask),
        }
    }
}

/// Whether the answer is from the other views, and says so.
fn is_left_out(outcome: &Outcome, view: usize) -> bool {
    let Outcome::Answered(doubts) = outcome else { return false };
    doubts.iter().any(|doubt| doubt.view == view && matches!(doubt.cause, Cause::NotSeen(_)))
}

/// An ellipse somewhere in the middle, as large as a hand.
fn draw_blob(mask: &mut Mask, random: &mut ItemRng) {
    let (width, height) = (f64::from(mask.width()), f64::from(mask.height()));
    let middle = [random.between(0.3, 0.7) * width, random.between(0.3, 0.7) * height];
    let radii = [random.between(0.1, 0.25) * width, random.between(0.1, 0.3) * height];
    for (x, y, level) in mask.enumerate_pixels_mut() {
        let at = [f64::from(x), f64::from(y)];
        let far: f64 = (0..2).map(|k| ((at[k] - middle[k]) / radii[k]).powi(2)).sum();
        level.0[0] = if far < 1.0 { 255 } else { 0 };
    }
}
