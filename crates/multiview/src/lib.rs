#![doc = include_str!("../README.md")]

mod concatenation;
mod error;
mod vocabulary;

pub use concatenation::{Concatenation, Scratch};
pub use error::{Error, Result};
pub use vocabulary::Vocabulary;
