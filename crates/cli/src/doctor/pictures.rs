//! What the cameras see, against the calibration.

use anyhow::Result;
use phalanx::{NoProgress, TakeSettings, fit_take};
use phalanx_camera::Rig;
use phalanx_hand::Side;

use crate::counts::counted;
use crate::finding::Finding;
use crate::recording::agreement::{agreement, named};
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
    let (moments, cameras) = (reader.moments().len(), source.cameras.len());
    let looked_at = if moments > MOMENTS {
        format!("{MOMENTS} of them, drawn from all, are looked at, the pictures of others are not")
    } else {
        "all are looked at".to_owned()
    };
    let mut findings = vec![Finding::good(
        "recording",
        format!("{} by {}; {looked_at}", counted(moments, "moment"), counted(cameras, "camera")),
    )];
    for (camera, &missing) in source.cameras.iter().zip(&reader.timeline.missing) {
        if missing > 0 {
            let text = format!("no picture at {}", counted(missing, "moment"));
            findings.push(Finding::doubtful(named(camera), text));
        }
    }
    let mut failures = Vec::new();
    let frames = reader.read_some(MOMENTS, &mut failures);
    findings.extend(failures.first().map(|failure| {
        let text = format!("{} cannot be used: {failure}", counted(failures.len(), "picture"));
        Finding::broken("recording", text)
    }));
    if failures.is_empty() && cameras > 1 {
        let fit = fit_take(&source.cameras, &frames, &TakeSettings::default(), &NoProgress)?;
        findings.extend((0..cameras).map(|view| agreement(&source, view, &fit)));
    }
    Ok(findings)
}
