//! How likely skin, and anything else, has a colour of each cell of luma and chroma.

use crate::masking::chroma::chroma;
use crate::masking::histogram::smooth;
use crate::masking::label::Label;
use crate::masking::skin::SkinModel;

/// Cells of luma, Cb and Cr that colours are counted in. A picture has too few pixels for cells of single levels; light
/// changes luma more than it changes chroma.
const SIDES: [usize; 3] = [16, 64, 64];

/// All cells.
pub(super) const CELLS: usize = SIDES[0] * SIDES[1] * SIDES[2];

/// Passes of the smoothing kernel over the counts: its standard deviation is one cell.
const SMOOTHING: u32 = 2;

/// The cell of a colour, Cr contiguous.
#[inline]
pub(super) fn cell_of(rgb: [u8; 3]) -> usize {
    let [luma, blue, red] = SIDES;
    let [r, g, b] = rgb.map(usize::from);
    // ITU-R BT.601, as `chroma`.
    let y = (77 * r + 150 * g + 29 * b) >> 8;
    let (cb, cr) = chroma(rgb);
    let [y, cb, cr] = [y * luma, usize::from(cb) * blue, usize::from(cr) * red].map(|v| v >> 8);
    (y * blue + cb) * red + cr
}

/// How likely a model has it that each chroma is skin, and anything else, in the cells of one luma.
pub(super) struct General([Vec<f64>; 2]);

impl General {
    /// The model knows nothing of luma: to it all are as likely.
    pub(super) fn of(model: &SkinModel) -> Self {
        let [luma, blue, red] = SIDES;
        let (high, wide) = (256 / blue, 256 / red);
        let mut planes = [vec![0.0; blue * red], vec![0.0; blue * red]];
        for (cb, cr) in (0..=255_u8).flat_map(|cb| (0..=255_u8).map(move |cr| (cb, cr))) {
            let cell = usize::from(cb) / high * red + usize::from(cr) / wide;
            let densities = model.densities(cb, cr).map(|density| density / luma as f64);
            planes.iter_mut().zip(densities).for_each(|(plane, density)| plane[cell] += density);
        }
        Self(planes)
    }

    /// The density of a class in every cell: the mean of the model's and of what was counted, so that a colour that the
    /// counts leave open stays as the model has it; the model's own where nothing was counted.
    pub(super) fn adapted(&self, class: Label, mut counts: Vec<f64>) -> Vec<f64> {
        let [skin, other] = &self.0;
        let general = match class {
            Label::Skin => skin,
            Label::NonSkin => other,
        };
        let total: f64 = counts.iter().sum();
        let general = general.iter().cycle();
        if total == 0.0 {
            return general.take(counts.len()).copied().collect();
        }
        smooth(&mut counts, &SIDES, SMOOTHING);
        counts.iter().zip(general).map(|(count, general)| 0.5 * (general + count / total)).collect()
    }
}
