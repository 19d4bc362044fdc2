#![doc = include_str!("../README.md")]

mod codes;
mod combination;
mod concatenation;
mod error;
mod pooled;
mod scratch;
mod vocabulary;

pub use codes::Codes;
pub use combination::{Estimate, inverse_variance, mean};
pub use concatenation::Concatenation;
pub use error::{Error, Result};
pub use pooled::Pooled;
pub use scratch::Scratch;
pub use vocabulary::Vocabulary;
