//! Connected components of a mask, by runs and union-find.

use crate::mask::Mask;

/// Which pixels are labelled. The hand is 8-connected, so the background is 4-connected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Class {
    Hand,
    Background,
}

impl Class {
    fn holds(self, level: u8) -> bool {
        Mask::is_hand_level(level) == (self == Class::Hand)
    }
}

/// A horizontal run of pixels of one class: columns `start..end` of a row.
#[derive(Debug, Clone, Copy)]
struct Run {
    row: usize,
    start: usize,
    end: usize,
    /// An earlier run of the same component, or the run itself.
    parent: usize,
    /// Of the whole component, once its runs are joined; valid at its first run.
    region: Region,
}

/// Size of a component and whether it touches the image border.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Region {
    pub(crate) area: usize,
    pub(crate) touches_border: bool,
}

/// Columns `start..end` of a row of a component.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Span {
    pub(crate) row: usize,
    pub(crate) start: usize,
    pub(crate) end: usize,
}

/// The components of one class of a mask; its memory is used again.
#[derive(Debug, Clone, Default)]
pub(crate) struct Components {
    runs: Vec<Run>,
}

impl Components {
    /// Finds the components of `class` among `pixels`, rows of `width`.
    pub(crate) fn label(&mut self, pixels: &[u8], width: usize, class: Class) {
        self.runs.clear();
        let height = pixels.len() / width;
        let mut above = 0..0;
        for (row, levels) in pixels.chunks_exact(width).enumerate() {
            let first = self.runs.len();
            self.push_runs(levels, row, height, class);
            let this = first..self.runs.len();
            self.join_rows(above, this.clone(), class);
            above = this;
        }
        // Parents point backwards, so one sweep from the end leaves each sum at the first run.
        for i in (0..self.runs.len()).rev() {
            let Run { parent, region, .. } = self.runs[i];
            if parent != i {
                let whole = &mut self.runs[parent].region;
                whole.area += region.area;
                whole.touches_border |= region.touches_border;
            }
        }
        for i in 0..self.runs.len() {
            self.runs[i].parent = self.runs[self.runs[i].parent].parent;
        }
    }

    fn push_runs(&mut self, levels: &[u8], row: usize, height: usize, class: Class) {
        let width = levels.len();
        let mut column = 0;
        while let Some(gap) = levels[column..].iter().position(|&level| class.holds(level)) {
            let start = column + gap;
            let length = levels[start..].iter().position(|&level| !class.holds(level));
            let end = length.map_or(width, |length| start + length);
            let touches_border = row == 0 || row + 1 == height || start == 0 || end == width;
            let region = Region { area: end - start, touches_border };
            self.runs.push(Run { row, start, end, parent: self.runs.len(), region });
            column = end;
        }
    }

    fn join_rows(
        &mut self,
        above: std::ops::Range<usize>,
        this: std::ops::Range<usize>,
        class: Class,
    ) {
        let reach = usize::from(class == Class::Hand);
        let (mut i, mut j) = (above.start, this.start);
        while i < above.end && j < this.end {
            let (a, b) = (self.runs[i], self.runs[j]);
            if a.start < b.end + reach && b.start < a.end + reach {
                self.join(i, j);
            }
            if a.end < b.end { i += 1 } else { j += 1 }
        }
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.first(a), self.first(b));
        self.runs[a.max(b)].parent = a.min(b);
    }

    fn first(&mut self, mut run: usize) -> usize {
        while self.runs[run].parent != run {
            let grandparent = self.runs[self.runs[run].parent].parent;
            self.runs[run].parent = grandparent;
            run = grandparent;
        }
        run
    }

    /// All components of at least so many pixels, as identity and region, in reading order.
    pub(crate) fn at_least(&self, area: usize) -> impl Iterator<Item = usize> + '_ {
        let first = move |&(i, run): &(usize, &Run)| run.parent == i && run.region.area >= area;
        self.runs.iter().enumerate().filter(first).map(|(i, _)| i)
    }

    /// What one component consists of.
    pub(crate) fn spans(&self, component: usize) -> Vec<Span> {
        let own = self.runs.iter().filter(|run| run.parent == component);
        own.map(|&Run { row, start, end, .. }| Span { row, start, end }).collect()
    }

    /// The largest component, as its identity and region. Of equal ones, one that touches the
    /// image border, as a forearm does; then the first in reading order.
    pub(crate) fn largest(&self) -> Option<(usize, Region)> {
        let components = self.runs.iter().enumerate().filter(|(i, run)| run.parent == *i);
        components.map(|(i, run)| (i, run.region)).rev().max_by_key(|&(_, region)| region)
    }

    /// Writes `level` over each component that `selects`, given its identity and region.
    pub(crate) fn paint(
        &self,
        pixels: &mut [u8],
        width: usize,
        level: u8,
        selects: impl Fn(usize, Region) -> bool,
    ) {
        for run in &self.runs {
            if selects(run.parent, self.runs[run.parent].region) {
                pixels[run.row * width..][run.start..run.end].fill(level);
            }
        }
    }
}
