//! What files say, put together.

use phalanx_camera::Volume;

use crate::calibration::record::Record;
use crate::calibration::unit::Unit;

/// What files say, before units and conventions are one.
#[derive(Debug, Default)]
pub(super) struct Document {
    pub(super) records: Vec<Record>,
    pub(super) volume: Option<Volume>,
    /// The unit that the files prove.
    pub(super) unit: Option<Unit>,
    /// What else is known of it, in brackets.
    pub(super) hint: Option<&'static str>,
    pub(super) notes: Vec<String>,
}
