//! Why an answer does not explain what was seen: other readings of the same pictures, of which one may.

use std::f64::consts::{FRAC_PI_2, PI};

use phalanx_hand::{Dof, HandShape, Pose, sample_pose};
use phalanx_refine::PosePrior;

use crate::checking::doubt::{Cause, ViewDoubt};
use crate::checking::quick_fit::{Fitted, QuickFit};
use crate::checking::usual::mean;
use crate::error::Result;
use crate::estimator::answering::Workspace;
use crate::estimator::estimate::Estimate;
use crate::estimator::expert::Expert;
use crate::estimator::model::Estimator;
use crate::estimator::placement::PLACED;
use crate::images::picture::Picture;
use crate::localize::global_pose::initial_global;
use crate::synthesis::postures;
use crate::window::{Framing, Window};

/// Of more views than this only two are exchanged for each other; of fewer every order is tried.
const ORDERED: usize = 4;

/// Postures that fits start from: so far along the range of every angle.
const POSTURES: [f64; 3] = [0.1, 0.5, 0.9];

/// Turns about the forearm that fits start from, over the quarter that models learn.
const TURNS: [f64; 3] = [0.0, 0.5 * FRAC_PI_2, FRAC_PI_2];

/// Another reading of the pictures, and the hand that explains them best if it is true.
struct Reading {
    causes: Vec<ViewDoubt>,
    fitted: Fitted,
}

impl Estimator {
    /// The doubts about an estimate of these pictures with their likely causes. Where the hand is not what was
    /// seen ([`Cause::Unlike`]), it finds out what would explain the pictures: masks that are inverted, cameras
    /// in another order, a hand of the other side, another pose, one view that shows something else. That
    /// takes some tens of milliseconds, and nothing where there is no such doubt.
    ///
    /// With one view, a hand of the other side is another pose of this one, and a mask of something else
    /// is only a hand that is not explained.
    ///
    /// # Errors
    /// As of [`estimate`](Self::estimate).
    pub fn explain<'p, P>(
        &self,
        pictures: &[P],
        estimate: &Estimate,
        workspace: &mut Workspace,
    ) -> Result<Vec<ViewDoubt>>
    where
        P: Into<Option<Picture<'p>>> + Copy,
    {
        let (unlike, mut doubts): (Vec<ViewDoubt>, Vec<ViewDoubt>) =
            estimate.doubts.iter().partition(|doubt| doubt.cause.is_unexplained());
        let expert = self.expert(&estimate.observation)?;
        if unlike.is_empty() || expert.errors.is_none() {
            return Ok(estimate.doubts.clone());
        }
        let views = estimate.observation.views.iter();
        let picture = |camera: usize| -> Option<Seen<'p>> {
            Some(Seen { camera, picture: (*pictures.get(camera)?).into()? })
        };
        let seen: Vec<Seen<'p>> = views.filter_map(|view| picture(view.camera)).collect();
        if seen.len() != estimate.observation.views.len() {
            return Ok(estimate.doubts.clone());
        }
        let diagnosis = Diagnosis { estimator: self, expert, seen, estimate, unlike };
        doubts.extend(diagnosis.causes(workspace)?);
        doubts.sort_by_key(|doubt| doubt.view);
        Ok(doubts)
    }
}

/// A picture that shows the hand.
#[derive(Clone, Copy)]
struct Seen<'a> {
    camera: usize,
    picture: Picture<'a>,
}

/// An answer that does not explain what was seen.
struct Diagnosis<'a> {
    estimator: &'a Estimator,
    expert: Expert<'a>,
    /// The pictures of the views that it is an answer to.
    seen: Vec<Seen<'a>>,
    estimate: &'a Estimate,
    /// The views that it does not explain.
    unlike: Vec<ViewDoubt>,
}

impl Diagnosis<'_> {
    fn causes(&self, workspace: &mut Workspace) -> Result<Vec<ViewDoubt>> {
        let inverted: Vec<ViewDoubt> = self
            .seen
            .iter()
            .filter(|seen| seen.picture.looks_inverted())
            .map(|seen| ViewDoubt { view: seen.camera, cause: Cause::InvertedMask })
            .collect();
        if !inverted.is_empty() {
            return Ok(inverted);
        }
        let mut readings = vec![self.another_pose()?];
        if self.seen.len() > 1 {
            readings.push(self.other_side()?);
            for order in orders(self.seen.len()) {
                readings.push(self.in_order(&order, workspace)?);
            }
        }
        let explaining = readings.into_iter().flatten();
        let explaining =
            explaining.filter(|reading| self.short_of_borders(&reading.fitted).is_empty());
        if let Some(reading) = best(explaining) {
            return Ok(reading.causes);
        }
        Ok(match self.foreign_view()? {
            Some(seen) => vec![ViewDoubt { view: seen.camera, cause: seen.foreign() }],
            None => self.unlike.iter().map(|doubt| self.unexplained(*doubt)).collect(),
        })
    }

    /// The pictures are right, and the estimate is far from the pose that they show.
    fn another_pose(&self) -> Result<Option<Reading>> {
        let fitted =
            self.fit(&self.quick_fit(self.estimate), self.estimator.hand(), self.estimate)?;
        Ok(fitted.map(|fitted| Reading { causes: self.all(Cause::PoorEstimate), fitted }))
    }

    /// The hand is of the other side.
    fn other_side(&self) -> Result<Option<Reading>> {
        let hand = self.estimator.hand();
        let mirrored = HandShape { side: hand.side.other(), ..hand.clone() };
        let fitted = self.fit(&self.quick_fit(self.estimate), &mirrored, self.estimate)?;
        Ok(fitted.map(|fitted| Reading { causes: self.all(Cause::OtherSide), fitted }))
    }

    /// Each view shows what the camera of another should see: view `v` what that of view `order[v]` should.
    fn in_order(&self, order: &[usize], workspace: &mut Workspace) -> Result<Option<Reading>> {
        let mut pictures = vec![None; self.estimator.rig().cameras.len()];
        for (seen, &other) in self.seen.iter().zip(order) {
            pictures[self.seen[other].camera] = Some(seen.picture);
        }
        // Pictures that another camera cannot have taken are not its own.
        let Ok(estimate) = self.estimator.estimate(&pictures, workspace) else { return Ok(None) };
        if estimate.observation.views.len() < self.seen.len() {
            return Ok(None);
        }
        let fitted = self.fit(&self.quick_fit(&estimate), self.estimator.hand(), &estimate)?;
        let moved = self.seen.iter().zip(order.iter().map(|&other| self.seen[other].camera));
        let causes = moved
            .filter(|(seen, camera)| seen.camera != *camera)
            .map(|(seen, camera)| ViewDoubt {
                view: seen.camera,
                cause: Cause::SwappedCamera(camera),
            })
            .collect();
        Ok(fitted.map(|fitted| Reading { causes, fitted }))
    }

    /// The view without which all others are explained, if there are enough to tell.
    fn foreign_view(&self) -> Result<Option<Seen<'_>>> {
        let views = self.seen.len();
        if views < 3 {
            return Ok(None);
        }
        let all = self.quick_fit(self.estimate);
        let mut likeliest = (0.0, None);
        for view in 0..views {
            let others = all.without(view);
            let Some(fitted) = self.fit(&others, self.estimator.hand(), self.estimate)? else {
                continue;
            };
            let explained = mean(&fitted.borders);
            let short = self.short_of_borders(&fitted);
            if short.iter().all(|&short| short == view) && explained > likeliest.0 {
                likeliest = (explained, Some(self.seen[view]));
            }
        }
        Ok(likeliest.1)
    }

    fn short_of_borders(&self, fitted: &Fitted) -> Vec<usize> {
        self.expert.short_of_borders(&self.estimate.observation, &fitted.borders)
    }

    fn quick_fit(&self, estimate: &Estimate) -> QuickFit {
        let rig = self.estimator.rig();
        QuickFit::new(&rig.cameras, rig.volume.rest_frame(), &estimate.observation)
    }

    /// The best of a hand in any posture, turned about the forearm in any way, where the estimate has it.
    fn fit(&self, fit: &QuickFit, hand: &HandShape, estimate: &Estimate) -> Result<Option<Fitted>> {
        let pose = self.placed(hand, estimate)?;
        let deviation = |dof: Dof| match estimate.std[dof.index()] {
            None => 0.0,
            Some(std) if PLACED.contains(&dof) => std,
            Some(_) if dof.is_internal() => f64::INFINITY,
            Some(_) => PI,
        };
        let prior =
            PosePrior::independent(pose, &Dof::ALL.map(deviation))?.product(postures::coupled())?;
        fit.best(hand, &starts(&pose, &prior), &prior)
    }

    /// An estimate's pose for a hand of either side.
    fn placed(&self, hand: &HandShape, estimate: &Estimate) -> Result<Pose> {
        if self.estimator.framing() == Framing::Picture {
            return Ok(estimate.pose);
        }
        let views = estimate.observation.views.iter();
        let hands: Vec<_> =
            views.map(|view| view.window.as_ref().map(Window::pictured_hand)).collect();
        Ok(initial_global(self.estimator.rig(), hand, &estimate.pose, &hands)?.pose)
    }

    /// The same cause in all views that are not explained.
    fn all(&self, cause: Cause) -> Vec<ViewDoubt> {
        self.unlike.iter().map(|doubt| ViewDoubt { cause, ..*doubt }).collect()
    }

    fn unexplained(&self, doubt: ViewDoubt) -> ViewDoubt {
        let seen = self.seen.iter().find(|seen| seen.camera == doubt.view);
        match (doubt.cause, seen) {
            (Cause::CutOff, _) | (_, None) => doubt,
            (_, Some(seen)) => ViewDoubt { cause: seen.foreign(), ..doubt },
        }
    }
}

impl Seen<'_> {
    /// What is wrong with a view that shows something else.
    fn foreign(&self) -> Cause {
        match self.picture {
            Picture::Photograph(..) => Cause::Segmentation,
            Picture::Mask(_) => Cause::ForeignMask,
        }
    }
}

fn best(readings: impl Iterator<Item = Reading>) -> Option<Reading> {
    readings.max_by(|a, b| mean(&a.fitted.borders).total_cmp(&mean(&b.fitted.borders)))
}

/// The pose, and others in other postures and turned otherwise; what a prior knows stays.
fn starts(pose: &Pose, prior: &PosePrior) -> Vec<Pose> {
    let postures = POSTURES.map(|share| sample_pose(|| share));
    let postures = [pose].into_iter().chain(&postures);
    let mut starts = vec![*pose];
    for posture in postures {
        for turn in TURNS {
            let mut start = *pose;
            for &dof in prior.dofs() {
                match dof {
                    Dof::ThetaZ => start[dof] = turn,
                    dof if dof.is_internal() => start[dof] = posture[dof],
                    _ => {}
                }
            }
            starts.push(start);
        }
    }
    starts
}

/// All orders of so many things but the first, or of many things those with two exchanged.
fn orders(count: usize) -> Vec<Vec<usize>> {
    let identity: Vec<usize> = (0..count).collect();
    if count > ORDERED {
        let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b)));
        let exchanged = |(a, b)| {
            let mut order = identity.clone();
            order.swap(a, b);
            order
        };
        return pairs.map(exchanged).collect();
    }
    let mut orders = vec![Vec::new()];
    for _ in 0..count {
        let longer = |order: Vec<usize>| {
            let left: Vec<usize> = (0..count).filter(|next| !order.contains(next)).collect();
            left.into_iter().map(move |next| [order.as_slice(), &[next]].concat())
        };
        orders = orders.into_iter().flat_map(longer).collect();
    }
    orders.retain(|order| *order != identity);
    orders
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_other_order_is_tried() {
        assert_eq!(orders(2), [[1, 0]]);
        assert_eq!(orders(3), [[0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]]);
        assert_eq!((orders(4).len(), orders(5).len()), (23, 10));
    }
}
