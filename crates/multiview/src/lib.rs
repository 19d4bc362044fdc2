#![doc = include_str!("../README.md")]

mod codebook_trainer;
mod combination;
mod error;
mod pooled_encoder;
mod scratch;
mod view_encoders;

pub use codebook_trainer::CodebookTrainer;
pub use combination::{Estimate, inverse_variance, mean};
pub use error::{Error, Result};
pub use pooled_encoder::PooledEncoder;
pub use scratch::Scratch;
pub use view_encoders::ViewEncoders;
