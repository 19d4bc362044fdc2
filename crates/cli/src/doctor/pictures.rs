//! What the cameras see, against the calibration.

use anyhow::Result;
use phalanx::{FitDoubt, NoProgress, TakeFrame, TakeSettings, fit_take};
use phalanx_camera::Rig;
use phalanx_hand::Side;

use crate::counts::counted;
use crate::finding::Finding;
use crate::recording::agreement::{self, named};
use crate::recording::source::{RecordingArguments, Source};

/// Moments that are looked at.
const MOMENTS: usize = 12;

/// What the finding is of that a recording shows a left hand.
pub(super) const LEFT_HAND: &str = "left hand";

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
        findings.extend(of_hand(&source, &frames)?);
    }
    Ok(findings)
}

/// What a hand that is fitted to some moments says of the recording, whichever hand it is.
fn of_hand(source: &Source, frames: &[TakeFrame]) -> Result<Vec<Finding>> {
    let mut settings = TakeSettings::default();
    let fit = fit_take(&source.cameras, frames, &settings, &NoProgress)?;
    if !fit.frames.iter().any(|frame| frame.doubts.contains(&FitDoubt::OtherSide)) {
        return Ok(agreement::findings(source, &fit));
    }
    settings.hand.side = settings.hand.side.other();
    let fit = fit_take(&source.cameras, frames, &settings, &NoProgress)?;
    let text = "the recording seems to show one: `phalanx track` needs `--side left`";
    let findings = agreement::findings(source, &fit).into_iter();
    Ok(std::iter::once(Finding::good(LEFT_HAND, text)).chain(findings).collect())
}
