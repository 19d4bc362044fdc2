//! A camera that is lost for half of the frames.

use std::fmt;
use std::str::FromStr;

use anyhow::{Result, ensure};

/// The camera that is lost in the second and in the last quarter of a take's frames, so that it goes twice
/// and comes back once.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Lose(String);

impl FromStr for Lose {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        ensure!(!text.is_empty(), "expected a camera's name");
        Ok(Self(text.to_owned()))
    }
}

impl fmt::Display for Lose {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "lose-{}", self.0)
    }
}

impl Lose {
    /// Whether a camera is lost in the frame of this number among so many.
    pub fn concerns(&self, camera: &str, frame: usize, frames: usize) -> bool {
        camera == self.0 && 4 * frame / frames.max(1) % 2 == 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_the_frames_are_lost_in_two_pieces() {
        let lose: Lose = "cam1".parse().unwrap();
        let lost: Vec<usize> = (0..8).filter(|&k| lose.concerns("cam1", k, 8)).collect();
        assert_eq!(lost, [2, 3, 6, 7]);
        assert!(!lose.concerns("cam0", 2, 8) && "".parse::<Lose>().is_err());
    }
}
