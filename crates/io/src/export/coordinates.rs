//! What models of other tools call the 28 numbers.

use std::str::FromStr;

use phalanx_hand::Dof;

use crate::error::Error;

/// A model whose names a file of angles has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CoordinateNames {
    /// Our own: all 28 numbers.
    Phalanx,
    /// The hand of the ARMS model of OpenSim (McFarland et al. 2021): 22 angles.
    OpenSim,
    /// MyoSuite's myoHand: 22 angles.
    MyoHand,
}

/// One of the 28 numbers as a model has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coordinate {
    /// The number.
    pub dof: Dof,
    /// The model's name of it.
    pub name: &'static str,
    /// The model's value is ours times this: 1 or −1.
    pub sign: f64,
    /// Whether the sign was tried out on the model itself. Others follow from the ranges that the
    /// model is published with.
    pub is_confirmed: bool,
}

/// Our number, the name in OpenSim's ARMS hand, and the sign and name in myoHand, whose ranges of
/// the deviation and of the thumb's last joint run the other way.
const TABLE: [(Dof, &str, f64, &str, f64); 22] = [
    (Dof::WristFlexion, "flexion", 1.0, "flexion", 1.0),
    (Dof::WristDeviation, "deviation", -1.0, "deviation", -1.0),
    (Dof::ThumbAbduction, "cmc_abduction", 1.0, "cmc_abduction", 1.0),
    (Dof::ThumbCmc, "cmc_flexion", 1.0, "cmc_flexion", 1.0),
    (Dof::ThumbMcp, "mp_flexion", 1.0, "mp_flexion", 1.0),
    (Dof::ThumbIp, "ip_flexion", 1.0, "ip_flexion", -1.0),
    (Dof::IndexAbduction, "2mcp_abduction", 1.0, "mcp2_abduction", 1.0),
    (Dof::IndexMcp, "2mcp_flexion", 1.0, "mcp2_flexion", 1.0),
    (Dof::IndexPip, "2pm_flexion", 1.0, "pm2_flexion", 1.0),
    (Dof::IndexDip, "2md_flexion", 1.0, "md2_flexion", 1.0),
    (Dof::MiddleAbduction, "3mcp_abduction", 1.0, "mcp3_abduction", 1.0),
    (Dof::MiddleMcp, "3mcp_flexion", 1.0, "mcp3_flexion", 1.0),
    (Dof::MiddlePip, "3pm_flexion", 1.0, "pm3_flexion", 1.0),
    (Dof::MiddleDip, "3md_flexion", 1.0, "md3_flexion", 1.0),
    (Dof::RingAbduction, "4mcp_abduction", 1.0, "mcp4_abduction", 1.0),
    (Dof::RingMcp, "4mcp_flexion", 1.0, "mcp4_flexion", 1.0),
    (Dof::RingPip, "4pm_flexion", 1.0, "pm4_flexion", 1.0),
    (Dof::RingDip, "4md_flexion", 1.0, "md4_flexion", 1.0),
    (Dof::LittleAbduction, "5mcp_abduction", 1.0, "mcp5_abduction", 1.0),
    (Dof::LittleMcp, "5mcp_flexion", 1.0, "mcp5_flexion", 1.0),
    (Dof::LittlePip, "5pm_flexion", 1.0, "pm5_flexion", 1.0),
    (Dof::LittleDip, "5md_flexion", 1.0, "md5_flexion", 1.0),
];

impl CoordinateNames {
    /// The numbers that the model knows, in the order of its file's columns.
    pub fn coordinates(self) -> Vec<Coordinate> {
        let own = |dof: Dof| Coordinate { dof, name: dof.name(), sign: 1.0, is_confirmed: true };
        let unconfirmed = |dof, name, sign| Coordinate { dof, name, sign, is_confirmed: false };
        match self {
            Self::Phalanx => Dof::ALL.map(own).to_vec(),
            Self::OpenSim => {
                TABLE.map(|(dof, name, sign, ..)| unconfirmed(dof, name, sign)).to_vec()
            }
            Self::MyoHand => {
                TABLE.map(|(dof, _, _, name, sign)| unconfirmed(dof, name, sign)).to_vec()
            }
        }
    }
}

impl FromStr for CoordinateNames {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self, Error> {
        match name {
            "phalanx" => Ok(Self::Phalanx),
            "opensim" => Ok(Self::OpenSim),
            "myohand" => Ok(Self::MyoHand),
            _ => Err(Error::CoordinateNames { name: name.to_owned() }),
        }
    }
}
