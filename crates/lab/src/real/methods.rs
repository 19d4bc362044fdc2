//! The methods by name.

use anyhow::{Result, anyhow};
use clap::ValueEnum;
use phalanx::Progress;

use super::landmarks::Landmarks;
use super::method::{Method, Outcome, Sequence};
use super::product::{Estimated, Product, RefinedFrames};
use super::reference::Reference;
use super::take::{Input, Take};

/// What may be asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MethodName {
    /// `phalanx estimate`, frame by frame.
    Estimate,
    /// `phalanx estimate --refine`, frame by frame.
    Refined,
    /// A detector's landmarks, triangulated: a baseline.
    Landmarks,
}

impl MethodName {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Estimate, Self::Refined, Self::Landmarks];

    /// Whether a take's cameras need a trained model for it.
    fn needs_model(self) -> bool {
        matches!(self, Self::Estimate | Self::Refined)
    }

    /// What it looks at; landmarks are a detector's, which looked at photographs.
    pub fn inputs(self) -> &'static [Input] {
        match self {
            Self::Landmarks => &[Input::Photographs],
            _ => &Input::ALL,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Estimate => "estimate",
            Self::Refined => "refined",
            Self::Landmarks => "landmarks",
        }
    }
}

/// What methods need for some of a take's cameras, made once for all of them.
pub struct Prepared<'a> {
    reference: &'a Reference,
    product: Option<Result<Product>>,
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
        Self { reference, product: needed.then(|| Product::train(take, views, progress)) }
    }

    /// A method, ready to run.
    pub fn method(&self, name: MethodName) -> Box<dyn Method + '_> {
        match (name, &self.product) {
            (MethodName::Landmarks, _) => Box::new(Landmarks(self.reference)),
            (MethodName::Estimate, Some(Ok(product))) => Box::new(Estimated(product)),
            (MethodName::Refined, Some(Ok(product))) => Box::new(RefinedFrames(product)),
            (name, Some(Err(error))) => Box::new(Refusing(name.name(), format!("{error:#}"))),
            (name, None) => Box::new(Refusing(name.name(), "no model was trained".to_owned())),
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
