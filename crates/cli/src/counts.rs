//! Numbers of things in words: one camera, two cameras.

use std::fmt::Display;

/// A number of things, as they are called if there is one.
pub(crate) fn counted(number: impl Copy + Display + PartialEq + From<u8>, thing: &str) -> String {
    let plural = if number == 1.into() { "" } else { "s" };
    format!("{number} {thing}{plural}")
}

/// What is said of one thing, or of another number of them.
pub(crate) const fn either(number: usize, one: &'static str, others: &'static str) -> &'static str {
    if number == 1 { one } else { others }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_is_no_plural() {
        let cameras = [0_usize, 1, 2].map(|number| counted(number, "camera"));
        assert_eq!(cameras, ["0 cameras", "1 camera", "2 cameras"]);
        assert_eq!([0, 1, 2].map(|number| either(number, "is", "are")), ["are", "is", "are"]);
    }
}
