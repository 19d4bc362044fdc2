//! What the experiments share: the desk, the mean hand, and the paper's two data sets as its
//! cameras see them.

use std::cell::OnceCell;
use std::path::Path;

use anyhow::Result;
use phalanx::Progress;
use phalanx_camera::Rig;
use phalanx_hand::HandShape;

use crate::data::data_set::DataSet;
use crate::data::described::Described;
use crate::eval::table1::single_view;
use crate::files;

/// The experiments' common ground. The data sets are drawn when they are first asked for.
pub(crate) struct Lab<'a> {
    pub(crate) rig: Rig,
    pub(crate) hand: HandShape,
    /// A folder of real photographs, where there is one.
    pub(crate) data: Option<&'a Path>,
    pub(crate) progress: &'a dyn Progress,
    open_close: OnceCell<Described>,
    complex: OnceCell<Described>,
}

impl<'a> Lab<'a> {
    pub(crate) fn new(data: Option<&'a Path>, progress: &'a dyn Progress) -> Result<Self> {
        Ok(Self {
            rig: files::rig(None)?,
            hand: files::hand(None)?,
            data,
            progress,
            open_close: OnceCell::new(),
            complex: OnceCell::new(),
        })
    }

    /// The number of the camera of single-view experiments: the top.
    pub(crate) fn single(&self) -> Result<usize> {
        single_view(&self.rig)
    }

    /// The numbers of all cameras.
    pub(crate) fn all_views(&self) -> Vec<usize> {
        (0..self.rig.cameras.len()).collect()
    }

    /// The single view, then all, each with the words that tables use for it.
    pub(crate) fn one_and_all(&self) -> Result<[(&'static str, Vec<usize>); 2]> {
        Ok([("one view", vec![self.single()?]), ("three views", self.all_views())])
    }

    pub(crate) fn open_close(&self) -> Result<&Described> {
        self.described(&self.open_close, "open-close")
    }

    pub(crate) fn complex(&self) -> Result<&Described> {
        self.described(&self.complex, "complex")
    }

    fn described<'b>(&self, cell: &'b OnceCell<Described>, name: &str) -> Result<&'b Described> {
        if cell.get().is_none() {
            let described =
                DataSet::stored(name)?.describe(&self.rig, &self.hand, self.progress)?;
            let _ = cell.set(described);
        }
        Ok(cell.get().expect("it was set above"))
    }
}
