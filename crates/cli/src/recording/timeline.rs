//! Which frames of several cameras belong together.

use std::collections::{BTreeMap, BTreeSet};

use super::Stamp;

/// A moment and the frame that each camera took then.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Moment {
    /// Seconds after the first moment, where cameras have clocks.
    pub(crate) time: Option<f64>,
    /// The number of each camera's frame; `None` where it has none at that moment.
    pub(crate) frames: Vec<Option<usize>>,
}

/// The moments of a recording, and what did not fit in.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Timeline {
    pub(crate) moments: Vec<Moment>,
    /// For each camera, how many of its frames belong to no moment.
    pub(crate) unmatched: Vec<usize>,
    /// For each camera, in how many moments it has no frame.
    pub(crate) missing: Vec<usize>,
}

impl Timeline {
    /// Matches the cameras' frames: by their times where every frame of every camera has one, else by their
    /// names.
    ///
    /// By time, the slowest camera sets the moments, others fill in where it has no frame, and each camera's
    /// nearest frame belongs to a moment if it is at most half of the slowest camera's period away.
    pub(crate) fn new(cameras: &[&[Stamp]]) -> Self {
        let times: Option<Vec<Vec<f64>>> =
            cameras.iter().map(|stamps| stamps.iter().map(|stamp| stamp.time).collect()).collect();
        let moments = match times {
            Some(times) => by_time(&times),
            None => by_name(cameras),
        };
        let of_moments = |camera: usize| moments.iter().map(move |moment| moment.frames[camera]);
        let used = |camera: usize| of_moments(camera).flatten().count();
        let count = cameras.len();
        Self {
            unmatched: (0..count).map(|camera| cameras[camera].len() - used(camera)).collect(),
            missing: (0..count)
                .map(|camera| of_moments(camera).filter(Option::is_none).count())
                .collect(),
            moments,
        }
    }
}

fn by_name(cameras: &[&[Stamp]]) -> Vec<Moment> {
    let known: Vec<BTreeMap<&str, usize>> = cameras
        .iter()
        .map(|stamps| {
            stamps.iter().enumerate().map(|(k, stamp)| (stamp.name.as_str(), k)).collect()
        })
        .collect();
    let mut moments: Vec<Moment> = Vec::new();
    // A camera's names follow each other as it has them; one that the cameras before it lack comes
    // where its neighbour is.
    let mut order: Vec<&str> = Vec::new();
    let mut ordered: BTreeSet<&str> = BTreeSet::new();
    for stamps in cameras {
        let mut after = 0;
        for stamp in *stamps {
            match order[after..].iter().position(|name| *name == stamp.name) {
                Some(at) => after += at + 1,
                None if ordered.contains(&*stamp.name) => {}
                None => {
                    order.insert(after, &stamp.name);
                    ordered.insert(&stamp.name);
                    after += 1;
                }
            }
        }
    }
    for name in order {
        let frames = known.iter().map(|names| names.get(name).copied()).collect();
        moments.push(Moment { time: None, frames });
    }
    moments
}

fn by_time(times: &[Vec<f64>]) -> Vec<Moment> {
    let periods: Vec<f64> = times.iter().map(|times| period(times)).collect();
    let mut slowest_first: Vec<usize> = (0..times.len()).collect();
    slowest_first.sort_by(|&a, &b| periods[b].total_cmp(&periods[a]));
    let period = slowest_first.first().map_or(0.0, |&slowest| periods[slowest]);
    let mut at: Vec<f64> = Vec::new();
    for camera in slowest_first {
        let far = |&time: &f64| {
            let after = at.partition_point(|other| *other < time);
            let near = after.saturating_sub(1)..at.len().min(after + 1);
            at[near].iter().all(|other| (other - time).abs() > FILLED * period)
        };
        let added: Vec<f64> = times[camera].iter().copied().filter(far).collect();
        at.extend(added);
        at.sort_by(f64::total_cmp);
    }
    let start = at.first().copied().unwrap_or_default();
    let mut next = vec![0; times.len()];
    let moment = |at: f64| {
        let mut frames = vec![None; times.len()];
        for (camera, times) in times.iter().enumerate() {
            if let Some(frame) = nearest(times, next[camera], at)
                && (times[frame] - at).abs() <= 0.5 * period
            {
                frames[camera] = Some(frame);
                next[camera] = frame + 1;
            }
        }
        Moment { time: Some(at - start), frames }
    };
    at.into_iter().map(moment).collect()
}

/// A camera's frame further than this share of the slowest one's period from all moments is a moment of its
/// own, so that what the slowest camera lost is not lost for the others: between the half period within
/// which frames match and the whole period after which the next one is due.
const FILLED: f64 = 0.75;

/// The median time from one frame to the next, which dropped frames and pauses do not change.
fn period(times: &[f64]) -> f64 {
    let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied().unwrap_or_default()
}

/// The frame at or after `from` whose time is nearest.
fn nearest(times: &[f64], from: usize, at: f64) -> Option<usize> {
    let after = from + times[from..].partition_point(|&time| time < at);
    let before = after.checked_sub(1).filter(|&frame| frame >= from);
    match (before, times.get(after)) {
        (Some(before), Some(&later)) if at - times[before] <= later - at => Some(before),
        (Some(before), None) => Some(before),
        (_, Some(_)) => Some(after),
        (None, None) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(names: &[&str]) -> Vec<Stamp> {
        names.iter().map(|name| Stamp { name: (*name).to_owned(), time: None }).collect()
    }

    fn timed(times: impl IntoIterator<Item = f64>) -> Vec<Stamp> {
        let stamp = |(k, time): (usize, f64)| Stamp { name: k.to_string(), time: Some(time) };
        times.into_iter().enumerate().map(stamp).collect()
    }

    fn frames(timeline: &Timeline) -> Vec<Vec<Option<usize>>> {
        timeline.moments.iter().map(|moment| moment.frames.clone()).collect()
    }

    #[test]
    fn frames_of_one_name_belong_together() {
        let (one, other) = (named(&["1", "2", "4"]), named(&["2", "3", "4", "5"]));
        let timeline = Timeline::new(&[&one, &other]);
        assert_eq!(
            frames(&timeline),
            [
                [Some(0), None],
                [Some(1), Some(0)],
                [None, Some(1)],
                [Some(2), Some(2)],
                [None, Some(3)]
            ]
        );
        assert_eq!((timeline.missing, timeline.unmatched), (vec![2, 1], vec![0, 0]));
    }

    #[test]
    fn the_slowest_camera_sets_the_moments() {
        let fast = timed((0..9).map(|k| f64::from(k) / 60.0 + 0.003));
        let slow = timed((0..5).map(|k| f64::from(k) / 30.0));
        let timeline = Timeline::new(&[&fast, &slow]);
        assert_eq!(timeline.moments.len(), 5);
        assert_eq!(timeline.moments[3].frames, [Some(6), Some(3)]);
        assert_eq!(timeline.unmatched, [4, 0]);
    }

    #[test]
    fn what_one_camera_lost_the_others_carry() {
        let tenths = |range: std::ops::Range<usize>| range.map(|k| k as f64 * 0.1);
        let whole = timed(tenths(0..40));
        let dropped = timed(tenths(0..2).chain(tenths(3..40)));
        let timeline = Timeline::new(&[&whole, &dropped]);
        assert_eq!(timeline.moments.len(), 40);
        assert_eq!(timeline.moments[2].frames, [Some(2), None]);
        assert_eq!(timeline.moments[3].frames, [Some(3), Some(2)]);
        let blind = timed(tenths(0..10).chain(tenths(30..40)));
        let timeline = Timeline::new(&[&blind, &whole]);
        assert_eq!(timeline.moments.len(), 40);
        assert_eq!((timeline.missing, timeline.unmatched), (vec![20, 0], vec![0, 0]));
    }
}
