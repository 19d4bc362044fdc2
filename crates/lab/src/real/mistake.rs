//! A whole take made wrong on purpose: it must not be fitted without a doubt.

use std::str::FromStr;

use anyhow::{Context, Result, bail};

use super::take::Take;

/// What is mistaken: `other-side`, or `exchanged:CAMERA+CAMERA`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Mistake {
    /// The hand is taken for one of the other side.
    OtherSide,
    /// Each of two cameras has the pictures of the other.
    Exchanged([String; 2]),
}

impl FromStr for Mistake {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        if text == "other-side" {
            return Ok(Self::OtherSide);
        }
        let pair = text.strip_prefix("exchanged:").and_then(|pair| pair.split_once('+'));
        let Some((one, other)) = pair else {
            bail!("expected other-side or exchanged:CAMERA+CAMERA");
        };
        Ok(Self::Exchanged([one.to_owned(), other.to_owned()]))
    }
}

impl Mistake {
    /// Makes it in a take.
    ///
    /// # Errors
    /// A camera that the take has not.
    pub(super) fn make(&self, take: &mut Take) -> Result<()> {
        match self {
            Self::OtherSide => take.side = take.side.other(),
            Self::Exchanged(pair) => {
                let names = take.camera_names();
                let view = |camera: &String| {
                    let view = names.iter().position(|name| name == camera);
                    view.with_context(|| format!("{} has no camera '{camera}'", take.name))
                };
                let [one, other] = [view(&pair[0])?, view(&pair[1])?];
                take.cameras.swap(one, other);
                let [one, other] = take.cameras.get_disjoint_mut([one, other])?;
                std::mem::swap(&mut one.camera, &mut other.camera);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mistakes_are_read_by_name() {
        assert_eq!("other-side".parse::<Mistake>().unwrap(), Mistake::OtherSide);
        let pair = ["a", "b"].map(str::to_owned);
        assert_eq!("exchanged:a+b".parse::<Mistake>().unwrap(), Mistake::Exchanged(pair));
        assert!("exchanged:a".parse::<Mistake>().is_err());
    }
}
