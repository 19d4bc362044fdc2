//! A silhouette cut into sections at equal distances from the arm's end.
//!
//! Distances are measured within the silhouette, so that sections stay across an arm that bends.

use crate::detect::geodesic::Geodesic;
use crate::detect::grid::Grid;

/// Weights of neighbouring sections in a smoothed width: the grid makes sections uneven.
const SMOOTHING: [f64; 5] = [1.0, 2.0, 3.0, 2.0, 1.0];

/// Where widths are looked at ahead of a section and behind it, in units of its own width.
const AHEAD: [f64; 6] = [0.25, 0.5, 1.0, 1.5, 2.0, 3.0];
const BEHIND: [f64; 3] = [0.25, 0.5, 1.0];

/// How many numbers describe a section.
pub(crate) const FEATURES: usize = AHEAD.len() + BEHIND.len() + 2;

/// Where widths are looked at to either side of a section to tell which side the hand is on, in units of its own
/// width: up to the elbow, and to the tip of the longest finger.
const ALONG: [f64; 10] = [0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0];

/// How many numbers describe the whole limb about a section.
pub(crate) const PROFILE: usize = 2 * ALONG.len() + 4;

/// CrossSections narrower than this have no shape, cells.
const NARROWEST: f64 = 4.0;

/// A width of nothing, in units of the section's own, as its logarithm must be finite.
const NOTHING: f64 = 0.1;

/// The sections of one component, one cell of distance each, from the arm's end to the furthest tip.
#[derive(Debug, Clone, Default)]
pub(crate) struct CrossSections {
    /// Smoothed, cells.
    widths: Vec<f64>,
    /// Cells from this section on.
    ahead: Vec<f64>,
    /// Middle of each section's cells, in pixels of the image.
    pub(crate) centres: Vec<[f64; 2]>,
    /// Whether a section touches the image border.
    pub(crate) at_border: Vec<bool>,
}

impl CrossSections {
    /// The sections of what has been measured.
    pub(crate) fn fill(&mut self, grid: &Grid, distances: &Geodesic) {
        let mut counts: Vec<f64> = Vec::new();
        self.centres.clear();
        self.at_border.clear();
        for cell in grid.cells() {
            let Some(distance) = distances.distance(cell) else { continue };
            let section = distance as usize;
            if section >= counts.len() {
                counts.resize(section + 1, 0.0);
                self.centres.resize(section + 1, [0.0; 2]);
                self.at_border.resize(section + 1, false);
            }
            counts[section] += 1.0;
            let [x, y] = grid.position(cell);
            let centre = &mut self.centres[section];
            *centre = [centre[0] + x, centre[1] + y];
            self.at_border[section] |= grid.at_border[cell];
        }
        for (centre, &count) in self.centres.iter_mut().zip(&counts) {
            *centre = centre.map(|sum| sum / count);
        }
        let smoothed = |section: usize| {
            let near = (section.saturating_sub(2)..counts.len()).take_while(|&k| k <= section + 2);
            let weighted = near.map(|k| {
                let weight = SMOOTHING[k + 2 - section];
                (weight * counts[k], weight)
            });
            let (sum, weight) = weighted.fold((0.0, 0.0), |(s, w), (a, b)| (s + a, w + b));
            sum / weight
        };
        self.widths.clear();
        self.widths.extend((0..counts.len()).map(smoothed));
        self.ahead.clear();
        self.ahead.resize(counts.len(), 0.0);
        let mut sum = 0.0;
        for (ahead, &count) in self.ahead.iter_mut().zip(&counts).rev() {
            sum += count;
            *ahead = sum;
        }
    }

    /// How many there are.
    pub(crate) fn count(&self) -> usize {
        self.widths.len()
    }

    /// The width of a section, cells.
    pub(crate) fn width(&self, section: usize) -> f64 {
        self.widths[section]
    }

    /// What a section and its surroundings look like, whatever their size: logarithms of the widths
    /// ahead and behind, of the length ahead and of the area ahead, in units of the section's width.
    /// Behind the arm's end it goes on as it ends. `None` of a section too narrow to tell.
    pub(crate) fn features(&self, section: usize) -> Option<[f64; FEATURES]> {
        let own = self.widths[section];
        if own < NARROWEST {
            return None;
        }
        let mut features = [0.0; FEATURES];
        let (widths, whole) = features.split_at_mut(AHEAD.len() + BEHIND.len());
        let (ahead, behind) = widths.split_at_mut(AHEAD.len());
        let relative = |width: f64| (width / own + NOTHING).ln();
        for (feature, offset) in ahead.iter_mut().zip(AHEAD) {
            *feature = relative(self.width_at(section as f64 + offset * own));
        }
        for (feature, offset) in behind.iter_mut().zip(BEHIND) {
            *feature = relative(self.width_at((section as f64 - offset * own).max(0.0)));
        }
        whole[0] = ((self.count() - section) as f64 / own).ln();
        whole[1] = (self.ahead[section] / (own * own)).ln();
        Some(features)
    }

    /// What the whole limb looks like about a section, whatever its size: logarithms of the widths ahead, of those
    /// behind, of the lengths ahead and behind and of the areas ahead and behind, in units of the section's width. There
    /// is nothing beyond either end. `None` of a section too narrow to tell.
    pub(crate) fn profile(&self, section: usize) -> Option<[f64; PROFILE]> {
        let own = self.widths[section];
        if own < NARROWEST {
            return None;
        }
        let width = |offset: f64| {
            let at = section as f64 + offset * own;
            (if at < 0.0 { 0.0 } else { self.width_at(at) }) / own
        };
        let mut profile = [0.0; PROFILE];
        let (widths, whole) = profile.split_at_mut(2 * ALONG.len());
        let (ahead, behind) = widths.split_at_mut(ALONG.len());
        for ((ahead, behind), offset) in ahead.iter_mut().zip(behind).zip(ALONG) {
            (*ahead, *behind) = (width(offset), width(-offset));
        }
        let area = |cells: f64| cells / (own * own);
        whole[0] = (self.count() - section) as f64 / own;
        whole[1] = section as f64 / own;
        whole[2] = area(self.ahead[section]);
        whole[3] = area(self.ahead[0] - self.ahead[section]);
        Some(profile.map(|number| (number + NOTHING).ln()))
    }

    /// The width between two sections; nothing beyond the tip.
    fn width_at(&self, distance: f64) -> f64 {
        let (section, share) = (distance as usize, distance.fract());
        let width = |k: usize| self.widths.get(k).copied().unwrap_or(0.0);
        (1.0 - share) * width(section) + share * width(section + 1)
    }
}
