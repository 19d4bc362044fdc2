//! Units of length.

use std::fmt;
use std::str::FromStr;

use crate::error::{Error, Result};

/// What a length of 1 is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    mm: f64,
}

impl Unit {
    /// A millimetre.
    pub const MILLIMETRE: Self = Self { mm: 1.0 };
    /// A metre.
    pub const METRE: Self = Self { mm: 1000.0 };

    /// So many millimetres, such as the side of a chessboard's squares.
    ///
    /// # Errors
    /// A number that is not positive and finite.
    pub fn of_mm(mm: f64) -> Result<Self> {
        if mm > 0.0 && mm.is_finite() {
            Ok(Self { mm })
        } else {
            Err(Error::calibration(format!("a unit of {mm} mm is no length")))
        }
    }

    /// The unit in millimetres.
    pub fn mm(self) -> f64 {
        self.mm
    }
}

/// `mm`, `cm`, `m`, or a number of millimetres.
///
/// ```
/// use phalanx_io::calibration::Unit;
///
/// assert_eq!("m".parse(), Ok(Unit::METRE));
/// assert_eq!("25.4".parse(), Unit::of_mm(25.4));
/// assert!("inch".parse::<Unit>().is_err());
/// ```
impl FromStr for Unit {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        match text.trim().to_ascii_lowercase().as_str() {
            "mm" | "millimetre" | "millimeter" | "millimetres" | "millimeters" => {
                Ok(Self::MILLIMETRE)
            }
            "cm" | "centimetre" | "centimeter" | "centimetres" | "centimeters" => Self::of_mm(10.0),
            "m" | "metre" | "meter" | "metres" | "meters" => Ok(Self::METRE),
            number => match number.parse() {
                Ok(mm) => Self::of_mm(mm),
                Err(_) => Err(Error::calibration(format!(
                    "`{text}` is no unit: give mm, cm, m, or the millimetres of one unit"
                ))),
            },
        }
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} mm", self.mm)
    }
}

/// The unit that the file proves, or else the one that was given.
pub(super) fn agreed(
    proved: Option<Unit>,
    given: Option<Unit>,
    hint: Option<&'static str>,
) -> Result<Unit> {
    match (proved, given) {
        (Some(proved), Some(given)) if proved != given => {
            Err(Error::calibration(format!("its unit is {proved}, not {given}")))
        }
        (Some(unit), _) | (None, Some(unit)) => Ok(unit),
        (None, None) => Err(Error::CalibrationUnit { hint: hint.unwrap_or_default() }),
    }
}
