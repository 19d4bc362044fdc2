//! What can be wrong with a file.

/// The result of this crate's fallible calls.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// What is wrong with a file; each message says where, and what to do.
#[non_exhaustive]
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// A camera contradicts itself.
    #[error(transparent)]
    Camera(#[from] phalanx_camera::Error),
    /// A calibration that cannot be read.
    #[error("calibration: {what}")]
    Calibration {
        /// What is wrong, and where.
        what: String,
    },
    /// A field of a camera in a calibration that is absent or cannot be right.
    #[error("camera `{camera}`: {field} {what}")]
    CalibrationField {
        /// The camera.
        camera: String,
        /// The field, as the file calls it.
        field: String,
        /// What is wrong.
        what: String,
    },
    /// A calibration that does not say its unit.
    #[error(
        "calibration: it does not say what a length of 1 is{hint}: give the unit, mm, m or the \
         millimetres of one unit, such as a chessboard's square"
    )]
    CalibrationUnit {
        /// What the unit is likely to be, in brackets.
        hint: &'static str,
    },
    /// Two cameras nearer to each other, or farther apart, than those of any hand's rig.
    #[error(
        "cameras `{first}` and `{second}` are {mm:.1} mm apart, where 20 mm to 20 m are believed: is the \
         unit right?"
    )]
    CalibrationDistance {
        /// One camera.
        first: String,
        /// The other.
        second: String,
        /// Between them, mm.
        mm: f64,
    },
    /// Landmarks that cannot be read.
    #[error("landmarks: {file}: {what}")]
    Landmarks {
        /// The file.
        file: String,
        /// What is wrong, where, and what to do.
        what: String,
    },
    /// A take's header that is none, of another version, or contradicts itself.
    #[error("take: header: {what}")]
    TakeHeader {
        /// What is wrong.
        what: String,
    },
    /// A frame of a take that contradicts itself or the frames before it.
    #[error("take: frame {frame}: {what}")]
    TakeFrame {
        /// The frame's number.
        frame: u64,
        /// What is wrong.
        what: String,
    },
    /// A line of a take's file that cannot be read.
    #[error("take: line {line}: {what}")]
    TakeLine {
        /// The line, from 1.
        line: u64,
        /// What is wrong.
        what: String,
    },
    /// A column of a take's table that is absent or stands twice.
    #[error("take: column '{column}' {what}")]
    TakeColumn {
        /// The column's name.
        column: String,
        /// What is wrong.
        what: &'static str,
    },
    /// An array of a take's archive that is absent, damaged or of another kind.
    #[error("take: array '{array}': {what}")]
    TakeArray {
        /// The array's name.
        array: String,
        /// What is wrong.
        what: String,
    },
    /// What the writer reports.
    #[error("take: it cannot be written: {what}")]
    Write {
        /// The writer's own words.
        what: String,
    },
    /// A take without any pose, for a format that cannot hold gaps alone.
    #[error("{format}: no frame of the take has a pose")]
    NoPose {
        /// The format.
        format: &'static str,
    },
    /// A take with more frames than a format can hold.
    #[error("{format} holds at most {most}; write the take in parts, or in another format")]
    TooLong {
        /// The format.
        format: &'static str,
        /// How many of what.
        most: usize,
    },
    /// A unit that a format does not have.
    #[error("{format} has lengths in {units}")]
    Unit {
        /// The format.
        format: &'static str,
        /// The units that it has.
        units: &'static str,
    },
    /// No unit of length.
    #[error("'{name}' is no unit of length (mm, cm or m)")]
    LengthUnit {
        /// The name that was met.
        name: String,
    },
    /// No axes, or a mirror.
    #[error(
        "'{name}' names no axes: 'world', 'hand', or the world's axis that each of the file's is, without a mirror, such as 'xz-y'"
    )]
    Axes {
        /// The name that was met.
        name: String,
    },
    /// No model's names.
    #[error("'{name}' names no model (phalanx, opensim or myohand)")]
    CoordinateNames {
        /// The name that was met.
        name: String,
    },
    /// A reference to compare a take with that is none.
    #[error("reference: {what}")]
    Reference {
        /// What is wrong.
        what: String,
    },
    /// A picture that does not belong to a take.
    #[error("picture: {what}")]
    Picture {
        /// What is wrong.
        what: String,
    },
}

impl Error {
    /// A calibration that cannot be read.
    pub(crate) fn calibration(what: impl AsRef<str>) -> Self {
        Self::Calibration { what: shortened(what.as_ref()) }
    }

    /// Landmarks that cannot be read.
    pub(crate) fn landmarks(file: &str, what: impl AsRef<str>) -> Self {
        Self::Landmarks { file: shortened(file), what: shortened(what.as_ref()) }
    }

    /// A field that cannot be right.
    pub(crate) fn field(camera: &str, field: &str, what: impl AsRef<str>) -> Self {
        Self::CalibrationField {
            camera: shortened(camera),
            field: shortened(field),
            what: shortened(what.as_ref()),
        }
    }
}

/// A text that may quote a file, cut where it is too long to be read.
fn shortened(text: &str) -> String {
    const MOST: usize = 400;
    match text.char_indices().nth(MOST) {
        None => text.to_owned(),
        Some((end, _)) => format!("{}…", &text[..end]),
    }
}

/// What a writer reports, as an error of this crate.
pub(crate) fn unwritten(error: &impl std::fmt::Display) -> Error {
    Error::Write { what: error.to_string() }
}
