//! The proportions of one person's hand.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};

/// Which hand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// The right hand, in whose frame every shape is given.
    Right,
    /// The left hand: the mirror image.
    Left,
}

impl Side {
    /// That of the person's other hand.
    #[must_use]
    pub fn other(self) -> Self {
        match self {
            Self::Right => Self::Left,
            Self::Left => Self::Right,
        }
    }
}

/// The shape of a hand: lengths and radii in millimetres, angles in degrees, as in its file,
/// in the frame of a right hand at rest (origin at the wrist, +X to the thumb's side, +Y out of
/// the back, +Z towards the fingers).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HandShape {
    /// Which hand is drawn; the numbers are those of the right hand either way.
    pub side: Side,
    /// The thumb.
    pub thumb: ThumbShape,
    /// The index finger.
    pub index: FingerShape,
    /// The middle finger.
    pub middle: FingerShape,
    /// The ring finger.
    pub ring: FingerShape,
    /// The little finger.
    pub little: FingerShape,
    /// The palm.
    pub palm: PalmShape,
    /// The forearm.
    pub forearm: ForearmShape,
}

/// A finger: a planar chain of three segments on the knuckle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FingerShape {
    /// The knuckle (MCP), mm from the wrist.
    pub base_mm: DVec3,
    /// Direction of the finger at rest, turned about +Y towards the thumb, degrees.
    pub splay_deg: f64,
    /// Proximal, middle and distal segment, the last one up to the skin, mm.
    pub lengths_mm: [f64; 3],
    /// At MCP, PIP, DIP and tip, mm.
    pub radii_mm: [f64; 4],
}

/// The thumb: a planar chain of three segments on the wrist, its plane tilted against the
/// fingers' planes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ThumbShape {
    /// The base (CMC), mm from the wrist.
    pub base_mm: DVec3,
    /// Direction of the metacarpal at rest: away from the fingers, about +Y, degrees.
    pub splay_deg: f64,
    /// Direction of the metacarpal at rest: towards the palm's side, degrees.
    pub drop_deg: f64,
    /// Tilt of the thumb's plane about its metacarpal, the nail turning from the back of the
    /// hand outwards, degrees.
    pub roll_deg: f64,
    /// Metacarpal, proximal and distal segment, the last one up to the skin, mm.
    pub lengths_mm: [f64; 3],
    /// At CMC, MCP, IP and tip, mm.
    pub radii_mm: [f64; 4],
}

/// The palm: a slab between the wrist and the four knuckles, the sphere of the thumb, and the
/// webs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PalmShape {
    /// Half the distance between the centres of the wrist's two sides, mm.
    pub wrist_half_width_mm: f64,
    /// Radius of the wrist's sides, mm.
    pub wrist_radius_mm: f64,
    /// Radius of the slab at the knuckles, index to little, mm.
    pub knuckle_radii_mm: [f64; 4],
    /// How far the webs reach out along the proximal segments, as a fraction of their length.
    pub web_reach: f64,
    /// Radius of the webs between the fingers, mm.
    pub web_radius_mm: f64,
    /// Radius of the web between thumb and index finger, mm.
    pub thumb_web_radius_mm: f64,
    /// The heel of the hand on the little finger's side, mm from the wrist.
    pub heel_mm: DVec3,
    /// Radius of the heel, mm.
    pub heel_radius_mm: f64,
}

/// The forearm: a generalised cylinder of elliptic section that widens away from the wrist.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ForearmShape {
    /// From the wrist back, mm.
    pub length_mm: f64,
    /// Half its width at the wrist and at the far end, mm.
    pub half_widths_mm: [f64; 2],
    /// Its thickness over its width.
    pub flatness: f64,
}

/// From joint to joint, of segments the last of which is measured to the skin.
fn joint_distances([first, middle, last]: [f64; 3], radii: &[f64; 4]) -> [f64; 3] {
    [first, middle, last - radii[3]]
}

impl FingerShape {
    /// How far its four joints are from each other, knuckle to tip, mm.
    ///
    /// ```
    /// use phalanx_hand::HandShape;
    ///
    /// let index = HandShape::adult().index;
    /// let [_, _, to_tip] = index.joint_distances_mm();
    /// assert_eq!(to_tip, index.lengths_mm[2] - index.radii_mm[3]);
    /// ```
    pub fn joint_distances_mm(&self) -> [f64; 3] {
        joint_distances(self.lengths_mm, &self.radii_mm)
    }
}

impl ThumbShape {
    /// How far its four joints are from each other, base to tip, mm.
    pub fn joint_distances_mm(&self) -> [f64; 3] {
        joint_distances(self.lengths_mm, &self.radii_mm)
    }
}

impl HandShape {
    /// A mean adult's right hand, 185 mm from the wrist to the end of the middle finger and 81 mm broad at the knuckles.
    ///
    /// Segment lengths after the radiographic means of Buryanov and Kotiuk (2010), soft tissue of
    /// the tips included; widths after published hand anthropometry.
    pub fn adult() -> Self {
        let finger = |base: [f64; 3], splay_deg, lengths_mm, radii_mm| FingerShape {
            base_mm: DVec3::from_array(base),
            splay_deg,
            lengths_mm,
            radii_mm,
        };
        Self {
            side: Side::Right,
            thumb: ThumbShape {
                base_mm: DVec3::new(20.0, -9.0, 17.0),
                splay_deg: 42.0,
                drop_deg: 18.0,
                roll_deg: 62.0,
                lengths_mm: [46.2, 31.6, 27.3],
                radii_mm: [15.5, 12.5, 10.6, 8.4],
            },
            index: finger([26.0, 1.0, 88.0], 5.0, [39.8, 22.4, 20.6], [10.5, 9.2, 8.1, 7.0]),
            middle: finger([5.5, 3.0, 91.0], 0.5, [44.6, 26.3, 22.3], [10.8, 9.4, 8.3, 7.2]),
            ring: finger([-14.0, 1.5, 85.0], -5.0, [41.4, 25.7, 22.0], [10.2, 8.8, 7.8, 6.8]),
            little: finger([-31.5, -3.0, 76.0], -12.0, [32.7, 18.1, 20.0], [9.3, 7.8, 6.9, 6.0]),
            palm: PalmShape {
                wrist_half_width_mm: 13.0,
                wrist_radius_mm: 17.0,
                knuckle_radii_mm: [12.0, 12.5, 12.0, 11.0],
                web_reach: 0.36,
                web_radius_mm: 6.0,
                thumb_web_radius_mm: 8.0,
                heel_mm: DVec3::new(-24.0, -7.0, 28.0),
                heel_radius_mm: 14.5,
            },
            forearm: ForearmShape {
                length_mm: 250.0,
                half_widths_mm: [28.0, 44.0],
                flatness: 0.74,
            },
        }
    }

    /// Reads a shape from TOML, millimetres and degrees.
    ///
    /// # Errors
    /// Malformed TOML, an absent or unknown field, a number that no hand has.
    ///
    /// ```
    /// use phalanx_hand::HandShape;
    ///
    /// let adult = HandShape::adult();
    /// assert_eq!(HandShape::from_toml(&adult.to_toml())?, adult);
    /// assert!(HandShape::from_toml("side = 'right'").is_err());
    /// # Ok::<(), phalanx_hand::Error>(())
    /// ```
    pub fn from_toml(text: &str) -> Result<Self> {
        let shape: Self = toml::from_str(text).map_err(|error| toml_error(text, &error))?;
        shape.validate()?;
        Ok(shape)
    }

    /// Writes the shape as TOML.
    ///
    /// # Panics
    /// Never: plain tables of numbers always have a TOML form.
    pub fn to_toml(&self) -> String {
        toml::to_string(self).expect("plain tables of numbers")
    }

    /// The four fingers, index first.
    pub fn fingers(&self) -> [&FingerShape; 4] {
        [&self.index, &self.middle, &self.ring, &self.little]
    }

    /// Checks every number.
    ///
    /// # Errors
    /// [`Error::BadShape`] names the first field that no hand has.
    pub fn validate(&self) -> Result<()> {
        let thumb = &self.thumb;
        chain("thumb", thumb.base_mm, &thumb.lengths_mm, &thumb.radii_mm)?;
        for (field, angle) in [
            ("thumb.splay_deg", thumb.splay_deg),
            ("thumb.drop_deg", thumb.drop_deg),
            ("thumb.roll_deg", thumb.roll_deg),
        ] {
            within(field, angle, -120.0, 120.0)?;
        }
        let names = ["index", "middle", "ring", "little"];
        for (name, finger) in names.iter().zip(self.fingers()) {
            chain(name, finger.base_mm, &finger.lengths_mm, &finger.radii_mm)?;
            within(&format!("{name}.splay_deg"), finger.splay_deg, -60.0, 60.0)?;
        }
        let palm = &self.palm;
        within("palm.wrist_half_width_mm", palm.wrist_half_width_mm, 0.1, LONGEST_MM)?;
        within("palm.wrist_radius_mm", palm.wrist_radius_mm, 0.1, LONGEST_MM)?;
        each("palm.knuckle_radii_mm", &palm.knuckle_radii_mm, 0.1)?;
        within("palm.web_reach", palm.web_reach, 0.0, 1.0)?;
        within("palm.web_radius_mm", palm.web_radius_mm, 0.1, LONGEST_MM)?;
        within("palm.thumb_web_radius_mm", palm.thumb_web_radius_mm, 0.1, LONGEST_MM)?;
        each("palm.heel_mm", &palm.heel_mm.to_array(), -LONGEST_MM)?;
        within("palm.heel_radius_mm", palm.heel_radius_mm, 0.1, LONGEST_MM)?;
        let forearm = &self.forearm;
        within("forearm.length_mm", forearm.length_mm, 1.0, 2.0 * LONGEST_MM)?;
        each("forearm.half_widths_mm", &forearm.half_widths_mm, 0.1)?;
        within("forearm.flatness", forearm.flatness, 0.1, 1.0)
    }
}

/// The parser's words and the line, without the line's text, which may be long.
fn toml_error(text: &str, error: &toml::de::Error) -> Error {
    let before = error.span().and_then(|span| text.get(..span.start)).unwrap_or_default();
    let line = 1 + before.matches('\n').count();
    Error::Toml { line, message: error.message().to_owned() }
}

/// No part of a hand but the forearm is longer.
const LONGEST_MM: f64 = 300.0;

fn chain(name: &str, base: DVec3, lengths: &[f64; 3], radii: &[f64; 4]) -> Result<()> {
    each(&format!("{name}.base_mm"), &base.to_array(), -LONGEST_MM)?;
    each(&format!("{name}.lengths_mm"), lengths, 1.0)?;
    each(&format!("{name}.radii_mm"), radii, 0.1)
}

fn each(field: &str, values: &[f64], low: f64) -> Result<()> {
    values
        .iter()
        .enumerate()
        .try_for_each(|(k, &value)| within(&format!("{field}[{k}]"), value, low, LONGEST_MM))
}

fn within(field: &str, value: f64, low: f64, high: f64) -> Result<()> {
    if (low..=high).contains(&value) {
        return Ok(());
    }
    Err(Error::BadShape { field: field.to_owned(), value, low, high })
}
