//! Whether the cameras of a recording see one hand.

use phalanx::{FitDoubt, Missing, TakeFit};
use phalanx_camera::Camera;

use crate::counts::counted;
use crate::finding::Finding;
use crate::recording::doubt;
use crate::recording::source::Source;

/// How a finding calls a camera.
pub(crate) fn named(camera: &Camera) -> String {
    format!("camera '{}'", camera.name)
}

/// What a fitted hand says of a recording: what is mistaken about all of it, else how well each camera agrees.
pub(crate) fn findings(source: &Source, fit: &TakeFit) -> Vec<Finding> {
    let cameras = &source.cameras;
    let doubts = fit.frames.iter().flat_map(|frame| &frame.doubts);
    let mut codes = doubts.map(|doubt| doubt::code(doubt, cameras));
    if let Some(remedy) = codes.find_map(|code| doubt::remedy(&code, fit.hand.side)) {
        return vec![Finding::broken("recording", remedy)];
    }
    (0..cameras.len()).map(|view| agreement(source, view, fit)).collect()
}

/// Whether what a camera shows meets what the others show in space. One that contradicts them at most moments
/// does not stand where the calibration has it, or its frames are of other moments.
fn agreement(source: &Source, view: usize, fit: &TakeFit) -> Finding {
    let look = source.advice();
    let views = || fit.frames.iter().map(|frame| frame.views[view]);
    let all = fit.frames.len();
    let moments = counted(all, "moment");
    let count = |reason| views().filter(|view| view.missing == Some(reason)).count();
    let (absent, contradicts) = (count(Missing::NoHand), count(Missing::Disagrees));
    let what = named(&source.cameras[view]);
    if 2 * contradicts > all {
        let text = format!(
            "it contradicts the other cameras at {contradicts} of {moments}: it was moved after the \
             calibration, the calibration or its unit is wrong, its frames are of other moments, or recordings \
             are exchanged, its own or two others'"
        );
        return Finding::broken(what, text);
    }
    if 2 * absent > all {
        let text = format!("no hand where the others see it, at {absent} of {moments}: {look}");
        return Finding::broken(what, text);
    }
    let overlaps: Vec<f64> = views().filter_map(|view| view.overlap).collect();
    let mean = overlaps.iter().sum::<f64>() / overlaps.len().max(1) as f64;
    let text = format!("a fitted hand overlaps what it sees by {mean:.2} on average");
    let is_doubt = |doubt: &&FitDoubt| matches!(doubt, FitDoubt::PoorFit { view: of, .. } | FitDoubt::CutOff { view: of } if *of == view);
    let doubts = fit.frames.iter().filter_map(|frame| frame.doubts.iter().find(is_doubt));
    let doubted = doubts.count();
    if 2 * doubted > all {
        let text = format!(
            "{text}; at {doubted} of {moments} the outline is not a hand's, or the picture's border cuts it off: {look}"
        );
        return Finding::doubtful(what, text);
    }
    if contradicts + absent == 0 {
        return Finding::good(what, text);
    }
    let at = [(contradicts, "contradicts the others"), (absent, "shows no hand")];
    let at = at.into_iter().filter(|(count, _)| *count > 0);
    let at: Vec<String> = at.map(|(count, does)| format!("at {count} it {does}")).collect();
    Finding::doubtful(what, format!("{text}; of {moments}, {}", at.join(", ")))
}
