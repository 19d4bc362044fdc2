//! The methods by name.

use clap::ValueEnum;

use super::landmarks::Landmarks;
use super::method::Method;
use super::product::{Estimated, Products, RefinedFrames};
use super::reference::Reference;
use super::take::Input;
use super::tracked::{Tracked, Whose};
use super::whole_take::{Fits, FramesAlone, WholeTake};

/// What may be asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MethodName {
    /// `phalanx estimate`, frame by frame.
    Estimate,
    /// `phalanx estimate --refine`, frame by frame.
    Refined,
    /// The whole take at once, without a trained model.
    Take,
    /// Each frame alone, with the hand that the whole take told.
    Frame,
    /// Frame by frame as they come, with the hand that the whole take told.
    Tracked,
    /// Frame by frame as they come, the hand learnt on the way.
    Live,
    /// A detector's landmarks, triangulated: a baseline.
    Landmarks,
}

impl MethodName {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Estimate,
        Self::Refined,
        Self::Take,
        Self::Frame,
        Self::Tracked,
        Self::Live,
        Self::Landmarks,
    ];

    /// What it looks at; landmarks are a detector's, which looked at photographs.
    pub fn inputs(self) -> &'static [Input] {
        match self {
            Self::Landmarks => &[Input::Photographs],
            Self::Estimate | Self::Refined => &[Input::Masks, Input::Photographs],
            _ => &Input::ALL,
        }
    }
}

impl MethodName {
    /// Whether it can do without a camera in some frames.
    pub fn may_lose_cameras(self) -> bool {
        matches!(self, Self::Take | Self::Tracked | Self::Live)
    }
}

/// What methods need for some of a take's cameras, made once for all of them.
pub struct Prepared<'a> {
    reference: &'a Reference,
    products: Products,
    fits: Fits,
}

impl<'a> Prepared<'a> {
    /// Nothing is fitted or trained yet.
    pub fn new(reference: &'a Reference) -> Self {
        Self { reference, products: Products::default(), fits: Fits::new() }
    }

    /// A method, ready to run.
    pub fn method(&self, name: MethodName) -> Box<dyn Method + '_> {
        let Self { reference, products, fits } = self;
        match name {
            MethodName::Landmarks => Box::new(Landmarks(reference)),
            MethodName::Take => Box::new(WholeTake(fits)),
            MethodName::Tracked => Box::new(Tracked { fits, whose: Whose::OfTake }),
            MethodName::Live => Box::new(Tracked { fits, whose: Whose::Anyone }),
            MethodName::Frame => Box::new(FramesAlone(fits)),
            MethodName::Estimate => Box::new(Estimated { products, fits }),
            MethodName::Refined => Box::new(RefinedFrames { products, fits }),
        }
    }
}
