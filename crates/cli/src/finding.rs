//! What was found of one thing.

use serde::{Serialize, Serializer};

/// A finding.
#[derive(Serialize)]
pub(crate) struct Finding {
    /// Of what.
    pub(crate) what: String,
    pub(crate) state: State,
    /// What is so, and what helps.
    pub(crate) text: String,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum State {
    Good,
    /// Results may suffer, or something cannot be done.
    Doubtful,
    /// Nothing good can come of it.
    Broken,
}

impl State {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Doubtful => "doubt",
            Self::Broken => "broken",
        }
    }
}

impl Serialize for State {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl Finding {
    fn new(state: State, what: impl Into<String>, text: impl Into<String>) -> Self {
        Self { what: what.into(), state, text: text.into() }
    }

    pub(crate) fn good(what: impl Into<String>, text: impl Into<String>) -> Self {
        Self::new(State::Good, what, text)
    }

    pub(crate) fn doubtful(what: impl Into<String>, text: impl Into<String>) -> Self {
        Self::new(State::Doubtful, what, text)
    }

    pub(crate) fn broken(what: impl Into<String>, text: impl Into<String>) -> Self {
        Self::new(State::Broken, what, text)
    }
}
