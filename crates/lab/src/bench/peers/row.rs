//! One figure: theirs, ours, and what was aimed at.

use serde::Serialize;

/// One line of the page.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Row {
    /// The problem.
    pub(crate) work: String,
    /// What of it is measured.
    pub(crate) figure: &'static str,
    /// Its unit; empty for a plain number.
    pub(crate) unit: &'static str,
    /// The peer, where there is one.
    pub(crate) peer: &'static str,
    /// The peer's figure, or why there is none.
    pub(crate) theirs: Figure,
    /// Ours.
    pub(crate) ours: Figure,
    pub(crate) target: Target,
}

/// A figure that was measured, or why it was not.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Figure {
    Value(f64),
    Skipped(String),
    /// Nobody's.
    None,
}

/// What ours should be.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Target {
    /// Not aimed at.
    Open,
    /// At most so much.
    AtMost(f64),
    /// At most so many times theirs.
    AtMostTheirs(f64),
    /// Lower than theirs.
    BelowTheirs,
    /// Not lower than theirs by more than this fraction of it.
    NotLowerBy(f64),
}

/// How ours compares with what was aimed at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Verdict {
    Met,
    Missed,
    Skipped,
    Open,
}

impl<E: std::fmt::Display> From<Result<f64, E>> for Figure {
    fn from(result: Result<f64, E>) -> Self {
        match result {
            Ok(value) => Self::Value(value),
            Err(error) => Self::Skipped(format!("{error:#}")),
        }
    }
}

impl Figure {
    fn value(&self) -> Option<f64> {
        match self {
            Self::Value(value) => Some(*value),
            Self::Skipped(_) | Self::None => None,
        }
    }
}

impl Row {
    /// What there is to say of work whose data the peers could not make.
    pub(crate) fn skipped(work: &str, peer: &'static str, reason: &anyhow::Error) -> Self {
        Self {
            work: work.to_owned(),
            figure: "all",
            unit: "",
            peer,
            theirs: Figure::Skipped(format!("{reason:#}")),
            ours: Figure::None,
            target: Target::BelowTheirs,
        }
    }

    /// Ours over theirs.
    pub(crate) fn ratio(&self) -> Option<f64> {
        Some(self.ours.value()? / self.theirs.value()?)
    }

    pub(crate) fn verdict(&self) -> Verdict {
        let met = match (self.target, self.ours.value(), self.theirs.value()) {
            (Target::Open, ..) => return Verdict::Open,
            (Target::AtMost(most), Some(ours), _) => ours <= most,
            (Target::AtMostTheirs(factor), Some(ours), Some(theirs)) => ours <= factor * theirs,
            (Target::BelowTheirs, Some(ours), Some(theirs)) => ours < theirs,
            (Target::NotLowerBy(fraction), Some(ours), Some(theirs)) => {
                ours >= theirs - fraction * theirs.abs()
            }
            _ => return Verdict::Skipped,
        };
        if met { Verdict::Met } else { Verdict::Missed }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn verdict(ours: f64, theirs: f64, target: Target) -> Verdict {
        let [ours, theirs] = [ours, theirs].map(Figure::Value);
        Row { work: String::new(), figure: "", unit: "", peer: "", theirs, ours, target }.verdict()
    }

    #[test]
    fn targets_are_relative_to_theirs_where_they_say_so() {
        assert_eq!(verdict(1.0, 9.0, Target::AtMost(1.0)), Verdict::Met);
        assert_eq!(verdict(3.1, 9.0, Target::AtMostTheirs(1.0 / 3.0)), Verdict::Missed);
        assert_eq!(verdict(9.0, 9.0, Target::BelowTheirs), Verdict::Missed);
        assert_eq!(verdict(-100.05, -100.0, Target::NotLowerBy(1e-3)), Verdict::Met);
        assert_eq!(verdict(-100.2, -100.0, Target::NotLowerBy(1e-3)), Verdict::Missed);
        assert_eq!(verdict(f64::NAN, 1.0, Target::AtMostTheirs(1.0)), Verdict::Missed);
        assert_eq!(verdict(9.0, 1.0, Target::Open), Verdict::Open);
    }

    #[test]
    fn without_the_peer_only_absolute_targets_are_judged() {
        let row = |target| Row {
            work: String::new(),
            figure: "",
            unit: "",
            peer: "someone",
            theirs: Figure::Skipped("no python".to_owned()),
            ours: Figure::Value(1.0),
            target,
        };
        assert_eq!(row(Target::AtMost(2.0)).verdict(), Verdict::Met);
        assert_eq!(row(Target::BelowTheirs).verdict(), Verdict::Skipped);
        assert_eq!(row(Target::AtMostTheirs(1.0)).verdict(), Verdict::Skipped);
    }
}
