//! The methods by name.

use anyhow::{Result, anyhow};
use clap::ValueEnum;
use phalanx::Progress;

use super::landmarks::Landmarks;
use super::method::{Method, Outcome, Sequence};
use super::product::{Estimated, Product, RefinedFrames};
use super::reference::Reference;
use super::take::{Input, Take};
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

    /// Whether a take's cameras need a trained model for it.
    fn needs_model(self) -> bool {
        matches!(self, Self::Estimate | Self::Refined)
    }

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
    product: Option<Result<Product>>,
    fits: Fits,
}

impl<'a> Prepared<'a> {
    /// Trains a model if one of the methods needs it. If that fails, these methods refuse every frame.
    pub fn new(
        take: &Take,
        views: &[usize],
        reference: &'a Reference,
        methods: &[MethodName],
        progress: &dyn Progress,
    ) -> Self {
        let needed = methods.iter().any(|method| method.needs_model());
        Self {
            reference,
            product: needed.then(|| Product::train(take, views, progress)),
            fits: Fits::new(),
        }
    }

    /// A method, ready to run.
    pub fn method(&self, name: MethodName) -> Box<dyn Method + '_> {
        match name {
            MethodName::Landmarks => Box::new(Landmarks(self.reference)),
            MethodName::Take => Box::new(WholeTake(&self.fits)),
            MethodName::Tracked => Box::new(self.tracked(Whose::OfTake)),
            MethodName::Live => Box::new(self.tracked(Whose::Anyone)),
            MethodName::Frame => Box::new(FramesAlone(&self.fits)),
            MethodName::Estimate => {
                self.trained("estimate", |product| Box::new(Estimated(product)))
            }
            MethodName::Refined => {
                self.trained("refined", |product| Box::new(RefinedFrames(product)))
            }
        }
    }

    fn tracked(&self, whose: Whose) -> Tracked<'_> {
        Tracked { fits: &self.fits, whose }
    }

    /// A method that needs a model; if there is none, it refuses every frame.
    fn trained<'b>(
        &'b self,
        name: &'static str,
        method: impl Fn(&'b Product) -> Box<dyn Method + 'b>,
    ) -> Box<dyn Method + 'b> {
        match &self.product {
            Some(Ok(product)) => method(product),
            Some(Err(error)) => Box::new(Refusing(name, format!("{error:#}"))),
            None => Box::new(Refusing(name, "no model was trained".to_owned())),
        }
    }
}

/// Refuses every frame for one reason.
struct Refusing(&'static str, String);

impl Method for Refusing {
    fn name(&self) -> &'static str {
        self.0
    }

    fn run(&self, sequence: &Sequence<'_>, _: &dyn Progress) -> Result<Vec<Outcome>> {
        let refused = |_| Outcome { found: Err(anyhow!(self.1.clone())), cpu_ms: None };
        Ok(sequence.frames.iter().map(refused).collect())
    }
}
