//! What is fitted on each split.

use super::method::{Counts, Method};
use crate::data::described::Described;

/// A method at a number of columns, under the names of the rows that it fills.
#[derive(Clone, PartialEq, Eq)]
pub(super) struct Job {
    pub(super) method: Method,
    pub(super) counts: Counts,
    pub(super) rows: Vec<&'static str>,
}

/// What is fitted on each split: every method at the paper's counts, and the selecting ones at the counts of the most views too, where those differ.
pub(super) fn jobs(data_set: &Described, views: usize, most_views: usize) -> Vec<Job> {
    let (paper, equal) = (counts(data_set, views), counts(data_set, most_views));
    let mut jobs = Vec::new();
    for method in Method::COUNTED {
        if paper == equal {
            jobs.push(Job { method, counts: paper, rows: vec!["paper", "equal"] });
        } else {
            jobs.push(Job { method, counts: paper, rows: vec!["paper"] });
            jobs.push(Job { method, counts: equal, rows: vec!["equal"] });
        }
    }
    let uncounted = |method| Job { method, counts: paper, rows: vec!["paper"] };
    jobs.extend(Method::UNCOUNTED.map(uncounted));
    jobs
}

/// The paper's counts for a number of views; of samples, as many as there are.
pub(super) fn counts(data_set: &Described, views: usize) -> Counts {
    Counts::paper(views, &data_set.name).at_most(data_set.poses.len().div_ceil(2))
}
