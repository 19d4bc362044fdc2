//! In which axes and units positions are written.

use std::str::FromStr;

use glam::{DAffine3, DMat3, DVec3};

use crate::error::Error;
use crate::take::TakeHeader;

/// The axes and the unit of a file's positions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// The axes.
    pub axes: Axes,
    /// The unit.
    pub unit: LengthUnit,
}

/// The axes of a file's positions. By name: `world`, `hand`, or for each of the file's axes the
/// world's axis that it is, such as `xz-y`.
///
/// ```
/// use phalanx_io::export::Axes;
///
/// let y_up: Axes = "xz-y".parse()?; // of a world with Z up
/// assert!("xzy".parse::<Axes>().is_err(), "that is a mirror");
/// assert_eq!("world".parse::<Axes>()?, Axes::World);
/// # Ok::<(), phalanx_io::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Axes {
    /// The world of the cameras' calibration.
    World,
    /// The frame of the hand at rest: X to the thumb's side of a right hand, Y out of the back, Z
    /// along the fingers, the origin in the middle of the working volume.
    Hand,
    /// The world turned by a rotation.
    Turned(DMat3),
}

/// A unit of length.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LengthUnit {
    /// Millimetres.
    Millimetre,
    /// Centimetres.
    Centimetre,
    /// Metres.
    Metre,
}

impl FromStr for Axes {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self, Error> {
        match name {
            "world" => return Ok(Self::World),
            "hand" => return Ok(Self::Hand),
            _ => {}
        }
        let mut rows = Vec::new();
        let mut sign = 1.0;
        for letter in name.chars() {
            match letter {
                '+' => sign = 1.0,
                '-' => sign = -1.0,
                'x' => rows.push(DVec3::X * std::mem::replace(&mut sign, 1.0)),
                'y' => rows.push(DVec3::Y * std::mem::replace(&mut sign, 1.0)),
                'z' => rows.push(DVec3::Z * std::mem::replace(&mut sign, 1.0)),
                _ => return Err(Error::Axes { name: name.to_owned() }),
            }
        }
        match rows[..] {
            [x, y, z] if DMat3::from_cols(x, y, z).determinant() == 1.0 => {
                Ok(Self::Turned(DMat3::from_cols(x, y, z).transpose()))
            }
            _ => Err(Error::Axes { name: name.to_owned() }),
        }
    }
}

impl LengthUnit {
    /// How it is written.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Millimetre => "mm",
            Self::Centimetre => "cm",
            Self::Metre => "m",
        }
    }

    /// How many of it a millimetre is.
    pub fn per_mm(self) -> f64 {
        match self {
            Self::Millimetre => 1.0,
            Self::Centimetre => 0.1,
            Self::Metre => 0.001,
        }
    }
}

impl FromStr for LengthUnit {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self, Error> {
        let units = [Self::Millimetre, Self::Centimetre, Self::Metre];
        let named = units.into_iter().find(|unit| unit.symbol() == name);
        named.ok_or_else(|| Error::LengthUnit { name: name.to_owned() })
    }
}

impl Placement {
    /// The world's axes, mm.
    pub const WORLD: Self = Self { axes: Axes::World, unit: LengthUnit::Millimetre };

    /// From the world to the file's axes, mm to mm.
    pub(crate) fn file_from_world(self, header: &TakeHeader) -> DAffine3 {
        match self.axes {
            Axes::World => DAffine3::IDENTITY,
            Axes::Hand => header.world_from_hand.inverse(),
            Axes::Turned(rotation) => DAffine3::from_mat3(rotation),
        }
    }

    /// A point of the world, mm, in the file's axes and unit.
    pub(crate) fn point(self, header: &TakeHeader, point: DVec3) -> DVec3 {
        self.file_from_world(header).transform_point3(point) * self.unit.per_mm()
    }
}
