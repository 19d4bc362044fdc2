//! What speaks against a fitted recording, in one word, and what to do about it.

use phalanx::FitDoubt;
use phalanx_camera::Camera;
use phalanx_hand::Side;

use crate::side::SideName;

const OTHER_SIDE: &str = "other-side";
const EXCHANGED: &str = "exchanged:";

/// A doubt in one word, with the cameras that it is about.
pub(crate) fn code(doubt: &FitDoubt, cameras: &[Camera]) -> String {
    match doubt {
        FitDoubt::NotSeen => "no-hand".to_owned(),
        FitDoubt::Open => "open".to_owned(),
        FitDoubt::OtherSide => OTHER_SIDE.to_owned(),
        FitDoubt::Exchanged { views: [one, other] } => {
            format!("{EXCHANGED}{}+{}", cameras[*one].name, cameras[*other].name)
        }
        FitDoubt::OtherEnd => "other-end".to_owned(),
        FitDoubt::PoorFit { view, .. } => format!("poor-fit:{}", cameras[*view].name),
        FitDoubt::PoorLandmarks { view, .. } => format!("poor-landmarks:{}", cameras[*view].name),
        FitDoubt::CutOff { view } => format!("cut-off:{}", cameras[*view].name),
        _ => "doubtful".to_owned(),
    }
}

/// What to do about a doubt of a whole recording, whose hand was fitted as one of a side; `None` of a doubt of a frame.
pub(crate) fn remedy(code: &str, side: Side) -> Option<String> {
    if code == OTHER_SIDE {
        let [own, other] = [side, side.other()].map(SideName::from);
        return Some(format!(
            "the hand looks like a {other} one, not a {own} one: give `--side {other}`"
        ));
    }
    let (one, other) = code.strip_prefix(EXCHANGED)?.split_once('+')?;
    Some(format!(
        "the cameras {one} and {other} seem to have each other's pictures: say whose each recording is, as in {one}=PATH"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn doubts_of_a_recording_say_what_to_do_and_others_do_not() {
        let said = remedy(OTHER_SIDE, Side::Right).unwrap();
        assert!(said.contains("--side left") && said.contains("not a right one"), "{said}");
        let said = remedy("exchanged:top+side", Side::Left).unwrap();
        assert!(said.contains("top and side") && said.contains("top=PATH"), "{said}");
        assert_eq!(remedy("cut-off:top", Side::Left), None);
    }
}
