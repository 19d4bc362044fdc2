//! Which pixels of a picture are hand: by the colour of skin, or unlike the background.

pub(crate) mod adapted_skin;
pub(crate) mod background;
pub(crate) mod box_mean;
pub(crate) mod chroma;
pub(crate) mod colour_cells;
pub(crate) mod histogram;
pub(crate) mod label;
pub(crate) mod motion;
pub(crate) mod otsu;
pub(crate) mod plain_background;
pub(crate) mod scene;
pub(crate) mod segment;
pub(crate) mod skin;
pub(crate) mod skin_file;
