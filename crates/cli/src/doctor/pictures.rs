//! What the cameras see, against the calibration.

use anyhow::Result;
use phalanx::{FitDoubt, Missing, NoProgress, TakeFit, TakeSettings, fit_take};
use phalanx_camera::{Camera, Rig};
use phalanx_hand::Side;

use super::finding::Finding;
use crate::recording::source::{RecordingArguments, Source};

/// Moments that are looked at.
const MOMENTS: usize = 12;

/// A recording's findings; one that cannot be read is the only one.
pub(super) fn findings(rig: &Rig, recording: &RecordingArguments) -> Vec<Finding> {
    seen(rig, recording)
        .unwrap_or_else(|error| vec![Finding::broken("recording", format!("{error:#}"))])
}

fn seen(rig: &Rig, recording: &RecordingArguments) -> Result<Vec<Finding>> {
    let source = Source::new(rig, recording, Side::Right)?;
    let mut reader = source.reader()?;
    let cameras = source.cameras.len();
    let mut findings = vec![Finding::good(
        "recording",
        format!("{} moments by {cameras} cameras", reader.moments().len()),
    )];
    for (camera, &missing) in source.cameras.iter().zip(&reader.timeline.missing) {
        if missing > 0 {
            let text = format!("no picture at {missing} moments");
            findings.push(Finding::doubtful(named(camera), text));
        }
    }
    let mut failures = Vec::new();
    let frames = reader.read_some(MOMENTS, &mut failures);
    findings.extend(failures.first().map(|failure| {
        let text = format!("{} pictures cannot be used: {failure}", failures.len());
        Finding::broken("recording", text)
    }));
    if failures.is_empty() && cameras > 1 {
        let fit = fit_take(&source.cameras, &frames, &TakeSettings::default(), &NoProgress)?;
        let views = source.cameras.iter().enumerate();
        findings.extend(views.map(|(view, camera)| agreement(camera, view, &fit)));
    }
    Ok(findings)
}

fn named(camera: &Camera) -> String {
    format!("camera '{}'", camera.name)
}

/// Whether what a camera shows meets what the others show in space. One that contradicts them at most moments
/// does not stand where the calibration has it, or its frames are of other moments.
fn agreement(camera: &Camera, view: usize, fit: &TakeFit) -> Finding {
    let views = || fit.frames.iter().map(|frame| frame.views[view]);
    let moments = fit.frames.len();
    let count = |reason| views().filter(|view| view.missing == Some(reason)).count();
    let (absent, contradicts) = (count(Missing::NoHand), count(Missing::Disagrees));
    let what = named(camera);
    if 2 * contradicts > moments {
        let text = format!(
            "it contradicts the other cameras at {contradicts} of {moments} moments: it was moved after the \
             calibration, the calibration is wrong, or its frames are of other moments"
        );
        return Finding::broken(what, text);
    }
    if 2 * absent > moments {
        let text = format!(
            "no hand where the others see it, at {absent} of {moments} moments: look at the light, or give masks"
        );
        return Finding::broken(what, text);
    }
    let overlaps: Vec<f64> = views().filter_map(|view| view.overlap).collect();
    let mean = overlaps.iter().sum::<f64>() / overlaps.len().max(1) as f64;
    let text = format!("a fitted hand overlaps what it sees by {mean:.2} on average");
    let is_doubt = |doubt: &&FitDoubt| matches!(doubt, FitDoubt::PoorFit { view: of, .. } | FitDoubt::CutOff { view: of } if *of == view);
    let doubts = fit.frames.iter().filter_map(|frame| frame.doubts.iter().find(is_doubt));
    let doubted = doubts.count();
    if 2 * doubted > moments {
        let text = format!(
            "{text}, which is not as of a hand, or of one that is cut off, at {doubted} of {moments} moments: look at \
             the light, or give masks"
        );
        return Finding::doubtful(what, text);
    }
    if contradicts + absent == 0 {
        return Finding::good(what, text);
    }
    let text = format!(
        "{text}; of {moments} moments it contradicts at {contradicts}, shows no hand at {absent}"
    );
    Finding::doubtful(what, text)
}
