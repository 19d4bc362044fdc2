//! Where in a mask a hand may be, and where its wrist is.

use crate::mask::Mask;

use crate::detect::cross_sections::{CrossSections, PROFILE};
use crate::detect::end_model::EndModel;
use crate::detect::geodesic::Geodesic;
use crate::detect::grid::Grid;
use crate::detect::wrist_model::WristModel;
use crate::error::{Error, Result};
use crate::mask::cleanup::Cleanup;
use crate::mask::components::{Class, Components};
use crate::mask::majority::Majority;

/// What may be a hand in a mask: a component, and where its wrist would be. All in pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HandDetection {
    /// The middle of the wrist.
    pub wrist: [f64; 2],
    /// Unit vector along the arm, towards the hand.
    pub direction: [f64; 2],
    /// The arm's width at the wrist.
    pub width: f64,
    /// How far the hand reaches beyond the wrist, along the direction.
    pub length: f64,
    /// How far it reaches to either side of the line through the wrist: the least and the most
    /// along the direction turned a quarter from +x towards +y.
    pub across: [f64; 2],
    /// The hand's area, without the arm, in pixels.
    pub area: f64,
    /// The area of all that hangs together with the hand behind the wrist, in pixels.
    pub behind: f64,
    /// How much arm can be seen behind the wrist before a side of it leaves the picture or it ends.
    pub arm: f64,
    /// Whether the hand itself reaches the image border, so that part of it may not be seen.
    pub cut_off: bool,
    /// How little it looks like a hand: the squared Mahalanobis distance of its sections from those
    /// of hands, about 11 for one.
    pub mahalanobis2: f64,
    /// How much likelier the hand is at this end of the arm than at the other, as the logarithm of the odds.
    pub ahead_log_odds: f64,
    /// What an [`EndModel`] tells that from: logarithms of the limb's widths ahead of the wrist and behind it, of the lengths
    /// ahead and behind and of the areas, in units of the wrist's width.
    pub profile: [f64; PROFILE],
    /// Which component of the mask it is, for [`HandDetector::isolate`].
    pub component: usize,
}

/// The most wrists that are considered along one arm: the finger of a hand that points may look like
/// a hand of its own.
const WRISTS: usize = 3;

/// The ends of a component that crosses no border: five tips, and where the arm is cut off.
const ENDS: usize = 6;

/// Of these ends the two that are farthest apart come first: an arm is longer than any digit, so that it is
/// one of them unless it is cut off near the wrist.
const LIKELY_ENDS: usize = 2;

/// Cosine of the angle up to which two arms point the same way.
const SAME_WAY: f64 = 0.5;

/// The odds, as a logarithm, of an end of an arm at which nothing may be a hand: one in twenty hands is not seen. A choice.
const NOT_SEEN: f64 = -3.0;

/// A section that may be a wrist.
struct Candidate {
    section: usize,
    evidence: f64,
    mahalanobis2: f64,
}

/// Compares what points one way along an arm with what points the other way, among all that may be the hand in one
/// component: from each one's own odds to those of its end.
fn compare_ends(hands: &mut [(bool, HandDetection)]) {
    let own: Vec<HandDetection> = hands.iter().map(|(_, hand)| *hand).collect();
    for (_, hand) in hands {
        let best = |sense: f64| {
            let along = |other: &HandDetection| {
                let ([a, b], [x, y]) = (hand.direction, other.direction);
                sense * (a * x + b * y)
            };
            let same = own.iter().filter(|other| along(other) > SAME_WAY);
            same.map(|other| other.ahead_log_odds).fold(NOT_SEEN, f64::max)
        };
        hand.ahead_log_odds = best(1.0) - best(-1.0);
    }
}

/// Finds hands in masks, one after another in the same memory.
#[derive(Debug, Clone, Default)]
pub struct HandDetector {
    majority: Majority,
    cleaned: Mask,
    components: Components,
    grid: Grid,
    geodesic: Geodesic,
    sections: CrossSections,
}

impl HandDetector {
    /// Everything in a mask of any size that may be a hand, the likeliest first: each component of
    /// at least [`Cleanup::min_hand`], with its arm coming from each place where it crosses the image
    /// border or, where it crosses none, from each of its ends, and with its wrist at each of the
    /// few likeliest places along the arm. Hands that are likelier at the arm's other end come after all others, and
    /// arms from an end that is not one of the two farthest apart last. Speckle is removed first.
    ///
    /// # Errors
    /// Unusable `cleanup`, an image without pixels, or nothing as large as a hand.
    ///
    /// ```
    /// use phalanx_segmentation::{Cleanup, HandDetector, Mask, WristModel};
    ///
    /// // A palm on an arm that comes from below.
    /// let mask = Mask::from_fn(160, 120, |x, y| {
    ///     let (dx, dy) = (x as f64 - 79.5, y as f64 - 40.0);
    ///     let palm = (dx / 22.0).powi(2) + (dy / 30.0).powi(2) < 1.0;
    ///     palm || (dx.abs() < 12.0 && dy > 0.0)
    /// });
    /// let mut detector = HandDetector::default();
    /// let hands = detector.find(&mask, &Cleanup::default(), WristModel::builtin())?;
    /// assert!(hands[0].direction[1] < -0.9, "it points up");
    /// assert!(detector.isolate(&hands[0]).is_hand(79, 40));
    /// # Ok::<(), phalanx_segmentation::Error>(())
    /// ```
    pub fn find(
        &mut self,
        mask: &Mask,
        cleanup: &Cleanup,
        model: &WristModel,
    ) -> Result<Vec<HandDetection>> {
        let mut found: Vec<(bool, HandDetection)> = Vec::new();
        for component in self.components_of(mask, cleanup)? {
            self.load(component);
            let first = found.len();
            for (number, source) in self.arm_ends().into_iter().enumerate() {
                let is_likely = number < LIKELY_ENDS || !self.grid.crossings().is_empty();
                let hands = self.hands_from(&source, component, model);
                found.extend(hands.into_iter().map(|hand| (is_likely, hand)));
            }
            compare_ends(&mut found[first..]);
        }
        found.sort_by(|(_, a), (_, b)| a.mahalanobis2.total_cmp(&b.mahalanobis2));
        found.sort_by_key(|(is_likely, hand)| (!is_likely, hand.ahead_log_odds < 0.0));
        let hands: Vec<HandDetection> = found.into_iter().map(|(_, hand)| hand).collect();
        if hands.is_empty() { Err(Error::NoHand) } else { Ok(hands) }
    }

    /// Each component of a mask that is as large as a hand, alone. Speckle is removed first; where wrists
    /// may be is not asked.
    ///
    /// # Errors
    /// As of [`find`](Self::find).
    pub fn components(&mut self, mask: &Mask, cleanup: &Cleanup) -> Result<Vec<Mask>> {
        let large = self.components_of(mask, cleanup)?;
        Ok(large.into_iter().map(|component| self.alone(component)).collect())
    }

    /// The mask of the last search with nothing but a hand's component, and its arm.
    pub fn isolate(&self, hand: &HandDetection) -> Mask {
        self.alone(hand.component)
    }

    fn alone(&self, own: usize) -> Mask {
        let mut mask = self.cleaned.clone();
        let width = mask.width() as usize;
        self.components.paint(&mut mask, width, 0, |component, _| component != own);
        mask
    }

    /// The sections of the largest component from its longest border crossing, and which of them
    /// passes nearest to a wrist.
    pub(crate) fn sections_at(
        &mut self,
        mask: &Mask,
        wrist: [f64; 2],
    ) -> Result<Option<(&CrossSections, usize)>> {
        self.components_of(mask, &Cleanup::default())?;
        let Some((largest, _)) = self.components.largest() else { return Ok(None) };
        self.load(largest);
        let crossing = self.grid.crossings().into_iter().max_by_key(Vec::len);
        let (Some(crossing), Some(cell)) = (crossing, self.grid.nearest(wrist)) else {
            return Ok(None);
        };
        self.geodesic.measure(&self.grid, &crossing);
        self.sections.fill(&self.grid, &self.geodesic);
        Ok(self.geodesic.distance(cell).map(|distance| (&self.sections, distance as usize)))
    }

    /// Cleans the mask and gives the components that are large enough.
    fn components_of(&mut self, mask: &Mask, cleanup: &Cleanup) -> Result<Vec<usize>> {
        cleanup.check()?;
        let (width, height) = mask.dimensions();
        if width == 0 || height == 0 {
            return Err(Error::ImageTooSmall { width, height, minimum: 1 });
        }
        if self.cleaned.dimensions() != mask.dimensions() {
            self.cleaned = Mask::new(width, height);
        }
        let (columns, radius) = (width as usize, cleanup.majority_radius as usize);
        self.majority.vote(mask, columns, radius, &mut self.cleaned);
        self.components.label(&self.cleaned, columns, Class::Hand);
        let needed = cleanup.needed(mask.len());
        let large: Vec<usize> = self.components.at_least(needed).collect();
        if large.is_empty() {
            let pixels = self.components.largest().map_or(0, |(_, region)| region.area);
            return Err(Error::EmptyMask { pixels, needed });
        }
        Ok(large)
    }

    fn load(&mut self, component: usize) {
        let (width, height) = self.cleaned.dimensions();
        let spans = self.components.spans(component);
        self.grid.fill(&spans, (width as usize, height as usize));
    }

    /// Where the arm may come from.
    fn arm_ends(&mut self) -> Vec<Vec<usize>> {
        let crossings = self.grid.crossings();
        if !crossings.is_empty() {
            return crossings;
        }
        let Some(any) = self.grid.cells().next() else { return Vec::new() };
        let mut ends = vec![self.geodesic.measure(&self.grid, &[any])];
        while ends.len() < ENDS {
            ends.push(self.geodesic.measure(&self.grid, &ends));
        }
        ends.into_iter().map(|end| vec![end]).collect()
    }

    /// What may be the hand of the grid's component whose arm comes from some of its cells: the
    /// likeliest wrists, at least a width apart.
    fn hands_from(
        &mut self,
        source: &[usize],
        component: usize,
        model: &WristModel,
    ) -> Vec<HandDetection> {
        self.geodesic.measure(&self.grid, source);
        self.sections.fill(&self.grid, &self.geodesic);
        let sections = &self.sections;
        let mut candidates: Vec<Candidate> = (0..sections.count())
            .filter_map(|section| {
                let features = sections.features(section)?;
                let (evidence, mahalanobis2) =
                    (model.evidence(&features), model.mahalanobis2(&features));
                Some(Candidate { section, evidence, mahalanobis2 })
            })
            .collect();
        candidates.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
        let mut chosen: Vec<Candidate> = Vec::with_capacity(WRISTS);
        for candidate in candidates {
            let apart = |other: &Candidate| {
                let width = sections.width(other.section).max(sections.width(candidate.section));
                candidate.section.abs_diff(other.section) as f64 >= width
            };
            if chosen.len() < WRISTS && chosen.iter().all(apart) {
                chosen.push(candidate);
            }
        }
        chosen.iter().filter_map(|candidate| self.hand_at(candidate, component)).collect()
    }

    /// The hand ahead of a section.
    fn hand_at(&self, candidate: &Candidate, component: usize) -> Option<HandDetection> {
        let section = candidate.section;
        let direction = self.direction(section)?;
        let profile = self.sections.profile(section)?;
        let (wrist, scale) = (self.sections.centres[section], self.grid.scale as f64);
        let mut hand = HandDetection {
            wrist,
            direction,
            width: self.sections.width(section) * scale,
            length: 0.0,
            across: [0.0; 2],
            area: 0.0,
            behind: 0.0,
            arm: self.visible_arm(section) * scale,
            cut_off: false,
            mahalanobis2: candidate.mahalanobis2,
            ahead_log_odds: self.ahead_log_odds(&profile),
            profile,
            component,
        };
        let ahead = |&cell: &usize| {
            self.geodesic.distance(cell).is_some_and(|distance| distance >= section as f64)
        };
        for cell in self.grid.cells() {
            if !ahead(&cell) {
                hand.behind += self.grid.area(cell);
                continue;
            }
            let [x, y] = self.grid.position(cell);
            let [dx, dy] = [x - wrist[0], y - wrist[1]];
            let along = dx * direction[0] + dy * direction[1];
            let side = dy * direction[0] - dx * direction[1];
            hand.length = hand.length.max(along + 0.5 * scale);
            hand.across[0] = hand.across[0].min(side - 0.5 * scale);
            hand.across[1] = hand.across[1].max(side + 0.5 * scale);
            hand.area += self.grid.area(cell);
            hand.cut_off |= self.grid.at_border[cell] && along > 0.5 * hand.width;
        }
        (hand.length > 0.0).then_some(hand)
    }

    /// How much likelier the hand is ahead of a section with this profile than behind it. What leaves the picture is no
    /// shorter than an arm, whatever can be seen of it.
    fn ahead_log_odds(&self, profile: &[f64; PROFILE]) -> f64 {
        let odds = EndModel::builtin().log_odds(profile);
        if self.sections.at_border.first().is_some_and(|at_border| *at_border) {
            return odds.max(0.0);
        }
        odds
    }

    /// The direction of the arm at a section: that in which the middles of the sections move, over
    /// one width behind it or, where less can be seen, ahead of it.
    fn direction(&self, section: usize) -> Option<[f64; 2]> {
        let width = self.sections.width(section);
        let behind = self.visible_arm(section).min(width);
        let ahead = 0.25 * width + 0.5 * (width - behind);
        let first = section - behind as usize;
        let last = (section + ahead as usize).min(self.sections.count() - 1);
        let centres = &self.sections.centres[first..=last];
        let middle = 0.5 * (centres.len() - 1) as f64;
        let moved = |axis: usize| -> f64 {
            centres.iter().zip(0..).map(|(c, k)| (f64::from(k) - middle) * c[axis]).sum()
        };
        let moved = [moved(0), moved(1)];
        let length = moved[0].hypot(moved[1]);
        (length > 0.0).then(|| moved.map(|component| component / length))
    }

    /// How many sections behind one are whole: the arm's end has no section across, and the image
    /// border cuts some.
    fn visible_arm(&self, section: usize) -> f64 {
        let behind = self.sections.at_border[..section].iter().rev();
        let whole = behind.take_while(|&&at_border| !at_border).count();
        if whole == section {
            // The arm ends within the picture, and its sections begin at a corner of its end.
            return (section as f64 - 0.5 * self.sections.width(section)).max(0.0);
        }
        whole as f64
    }
}
