//! An estimate as text and JSON.

use std::fmt::{self, Display, Formatter, Write as _};

use anyhow::Result;
use phalanx::{Cause, Estimate, Estimator, ObservedView, ViewDoubt};
use phalanx_hand::{Dof, Unit};
use phalanx_segmentation::ForearmCue;
use serde::{Serialize, Serializer};

/// A frame of several in JSON: its estimate, or why there is none.
#[derive(Serialize)]
struct Line<'a> {
    frame: &'a str,
    #[serde(flatten)]
    report: Option<Report<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<&'a str>,
}

/// The JSON of an estimate: degrees and millimetres.
#[derive(Serialize)]
struct Report<'a> {
    pose: Figures<'a>,
    /// 21 joints in the world.
    joints_mm: Vec<[f64; 3]>,
    /// Those that it is estimated from.
    views: Vec<View<'a>>,
    /// What should be known before the estimate is trusted.
    doubts: &'a [Doubt],
}

/// Why an estimate may be wrong.
#[derive(Serialize)]
pub(crate) struct Doubt {
    /// The camera whose view shows it; none of a doubt about the whole.
    view: Option<String>,
    cause: &'static str,
    /// The cause in words.
    text: String,
}

impl Doubt {
    pub(crate) fn whole(cause: &'static str, text: String) -> Self {
        Self { view: None, cause, text }
    }

    pub(crate) fn view(camera: &str, cause: &'static str, text: String) -> Self {
        Self { view: Some(camera.to_owned()), cause, text }
    }

    pub(crate) fn of_view(estimator: &Estimator, doubt: &ViewDoubt) -> Self {
        let cameras = &estimator.rig().cameras;
        let text = match doubt.cause {
            Cause::SwappedCamera(other) => {
                format!("it shows what camera '{}' should see", cameras[other].name)
            }
            cause => cause.to_string(),
        };
        Self::view(&cameras[doubt.view].name, doubt.cause.name(), text)
    }

    /// The same, with a reason.
    pub(crate) fn because(self, why: Option<&str>) -> Self {
        match why {
            Some(why) => Self { text: format!("{}; {why}", self.text), ..self },
            None => self,
        }
    }
}

impl Display for Doubt {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        match &self.view {
            Some(camera) => write!(out, "camera '{camera}': {}", self.text),
            None => out.write_str(&self.text),
        }
    }
}

/// Each number of the pose by name, in the pose's order.
struct Figures<'a>(&'a Estimate);

impl Serialize for Figures<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(Dof::ALL.map(|dof| (dof.name(), Figure::of(self.0, dof))))
    }
}

/// One number of the pose.
#[derive(Serialize)]
struct Figure {
    value: f64,
    /// None for a number that is not estimated.
    std: Option<f64>,
    /// Half of the interval that holds the truth in 95 of 100 cases.
    interval_95: Option<f64>,
    unit: &'static str,
}

impl Figure {
    fn of(estimate: &Estimate, dof: Dof) -> Self {
        let unit = dof.unit();
        Self {
            value: unit.to_file(estimate.pose[dof]),
            std: estimate.std[dof.index()].map(|std| unit.to_file(std)),
            interval_95: estimate.interval(dof).map(|half| unit.to_file(half)),
            unit: match unit {
                Unit::Angle => "deg",
                Unit::Length => "mm",
            },
        }
    }
}

/// What was seen of the forearm in one view.
#[derive(Serialize)]
struct View<'a> {
    camera: &'a str,
    forearm: &'static str,
    border_crossings: usize,
    /// Intersection over union of the estimated hand with what was seen, 0 to 1.
    overlap: Option<f64>,
}

/// The estimate as JSON, one object over several lines.
pub(crate) fn json(estimator: &Estimator, estimate: &Estimate, doubts: &[Doubt]) -> Result<String> {
    Ok(serde_json::to_string_pretty(&Report::new(estimator, estimate, doubts))? + "\n")
}

/// A frame of several as a line of JSON.
pub(crate) fn json_line(
    estimator: &Estimator,
    frame: &str,
    estimated: Option<(&Estimate, &[Doubt])>,
    error: Option<&str>,
) -> Result<String> {
    let report = estimated.map(|(estimate, doubts)| Report::new(estimator, estimate, doubts));
    Ok(serde_json::to_string(&Line { frame, report, error })? + "\n")
}

impl<'a> Report<'a> {
    fn new(estimator: &'a Estimator, estimate: &'a Estimate, doubts: &'a [Doubt]) -> Self {
        let cameras = &estimator.rig().cameras;
        let seen = estimate.observation.views.iter().enumerate();
        let views = seen.map(|(view, ObservedView { camera, silhouette, .. })| View {
            camera: &cameras[*camera].name,
            overlap: estimate.overlaps.get(view).copied(),
            forearm: match silhouette.forearm.cue {
                ForearmCue::Border => "border",
                ForearmCue::SmoothEnd => "stump",
            },
            border_crossings: silhouette.forearm.crossings,
        });
        Self {
            pose: Figures(estimate),
            joints_mm: estimate.joints.map(<[f64; 3]>::from).to_vec(),
            views: views.collect(),
            doubts,
        }
    }
}

/// A frame of several as a table under its name.
pub(crate) fn named_text(frame: &str, estimate: Option<&Estimate>) -> String {
    let table = estimate.map_or_else(|| "no estimate\n".to_owned(), text);
    format!("frame {frame}\n{table}\n")
}

/// The estimate as a table for people.
pub(crate) fn text(estimate: &Estimate) -> String {
    let mut text = String::new();
    for dof in Dof::ALL {
        let Figure { value, std, unit, .. } = Figure::of(estimate, dof);
        let spread = match std {
            Some(std) => format!("± {std:5.1} {unit}"),
            None => format!("{unit}, not learnt"),
        };
        writeln!(text, "{dof:18} {value:8.1} {spread}").expect("writing to a string");
    }
    text
}
