//! Which frame of a take.

use std::fmt;
use std::str::FromStr;

use anyhow::{Context, Result, ensure};

/// The name of a frame: a number, with or without leading zeros, or any other text.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum FrameName {
    /// Frames with numbers come first, in the order of their numbers.
    Number(u64),
    /// Others by their names.
    Text(String),
}

impl From<&str> for FrameName {
    fn from(text: &str) -> Self {
        text.trim().parse().map_or_else(|_| Self::Text(text.trim().to_owned()), Self::Number)
    }
}

impl fmt::Display for FrameName {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => write!(formatter, "{number:04}"),
            Self::Text(text) => formatter.write_str(text),
        }
    }
}

/// Ranges of frame numbers, such as `14-185,187-198`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FrameRanges(Vec<[u64; 2]>);

impl FrameRanges {
    /// Whether a frame is in one of the ranges.
    pub fn hold(&self, frame: &FrameName) -> bool {
        let FrameName::Number(number) = frame else { return false };
        self.0.iter().any(|[first, last]| (first..=last).contains(&number))
    }
}

impl FromStr for FrameRanges {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        let range = |part: &str| {
            let (first, last) = part.split_once('-').unwrap_or((part, part));
            let number = |text: &str| {
                text.trim().parse::<u64>().context("expected ranges such as 14-185,187-198")
            };
            let [first, last] = [number(first)?, number(last)?];
            ensure!(first <= last, "{first}-{last} ends before it begins");
            Ok([first, last])
        };
        Ok(Self(text.split(',').map(range).collect::<Result<_>>()?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leading_zeros_do_not_matter() {
        assert_eq!(FrameName::from("0012"), FrameName::from("12"));
        assert_eq!(FrameName::from("0012").to_string(), "0012");
        assert!(FrameName::from("9") < FrameName::from("0010"));
        assert!(FrameName::from("10") < FrameName::from("a"));
    }

    #[test]
    fn ranges_include_both_ends() {
        let ranges: FrameRanges = "14-16, 20".parse().unwrap();
        let held = (0..30).filter(|&number| ranges.hold(&FrameName::Number(number)));
        assert_eq!(held.collect::<Vec<_>>(), [14, 15, 16, 20]);
        assert!("3-1".parse::<FrameRanges>().is_err());
        assert!("x".parse::<FrameRanges>().is_err());
    }
}
