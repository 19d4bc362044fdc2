//! `phalanx track`.

mod arguments;
mod conclusion;
mod identity;
mod journal;
mod recorded;
mod rows;
mod streaming;
pub(crate) mod take;

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Result;
use phalanx::TakeSettings;
use phalanx_cli::files::Output;
use phalanx_hand::HandShape;

pub(crate) use arguments::Arguments;
use conclusion::Tally;
use identity::Identity;
use journal::Journal;
use recorded::Recorded;
use rows::{Kind, Rows};
use streaming::Streaming;

use crate::counts::counted;
use crate::progress::Bar;
use crate::recording::source::Source;
use crate::rig::check;

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode> {
    let kind = arguments.kind()?;
    let rig = check::read(&arguments.rig)?;
    let source = Source::new(&rig, &arguments.recording, arguments.side())?;
    let given = [Some(&arguments.rig), arguments.hand.as_ref(), arguments.recording.segment.path()];
    let inputs: Vec<&PathBuf> = source.inputs().chain(given.into_iter().flatten()).collect();
    let out = Output::new(&arguments.out, &inputs)?;
    let hand_out = arguments.save_hand.as_ref().map(|path| Output::new(path, &inputs));
    let hand_out = hand_out.transpose()?;
    hand_out.iter().try_for_each(|hand| hand.check_apart(&out))?;
    let save = |hand: &HandShape, tally: &Tally| match &hand_out {
        Some(out) if tally.hand_not_told => {
            eprintln!(
                "phalanx: {}: not written, since the recording does not tell the hand's proportions",
                out.path().display()
            );
            Ok(())
        }
        Some(out) => out.write(hand.to_toml().as_bytes()),
        None => Ok(()),
    };
    let recorded = Recorded::open(&source, arguments.rate)?;
    recorded.tell(arguments.rate);
    let settings = (arguments.fitted_together(), &arguments.settings()?);
    let mut journal = Journal::beside(&out, Identity::of(arguments, &source)?);
    let bar = Bar::new();
    let (hand, tally) = if recorded.times().len() <= settings.0 {
        journal.read()?;
        let (hand, rows) = fitted(recorded, settings, (&out, kind), &bar)?;
        save(&hand, &rows.tally)?;
        (hand, rows.finish()?)
    } else {
        let streaming = streaming(recorded, settings, (&out, kind), &journal, &bar)?;
        let hand = streaming.hand.clone();
        save(&hand, streaming.tally())?;
        (hand, streaming.run(&mut journal, &bar)?)
    };
    journal.remove();
    drop(bar);
    tally.conclude(&source.cameras, &hand, arguments.said_side(), &arguments.out)
}

/// A recording that is fitted as a whole.
fn fitted(
    mut recorded: Recorded<'_>,
    (most, settings): (usize, &TakeSettings),
    (out, kind): (&Output, Kind),
    bar: &Bar,
) -> Result<(HandShape, Rows)> {
    let mut failures = Vec::new();
    let fit = recorded.fit(most, settings, bar, &mut failures)?;
    let header = recorded.header(&fit.hand, fit.volume.volume.rest_frame());
    let mut rows = Rows::new(out, kind, header, None, Tally::of_fit(&fit, settings))?;
    rows.tally.add_failures(failures);
    for (moment, frame) in fit.frames.iter().enumerate() {
        rows.push(&recorded.frame(moment, Some(frame)))?;
    }
    Ok((fit.hand, rows))
}

/// A recording that is tracked: from its beginning, or where an earlier run was broken off.
fn streaming<'a>(
    recorded: Recorded<'a>,
    settings: (usize, &TakeSettings),
    (out, kind): (&Output, Kind),
    journal: &Journal,
    bar: &Bar,
) -> Result<Streaming<'a>> {
    match journal.read()? {
        Some(point) if Rows::are_there(out, point.bytes) => {
            let (done, all) = (point.moment, recorded.times().len());
            bar.say(&format!("going on after {done} of {}", counted(all, "frame")));
            Streaming::resumed(recorded, point, (out, kind))
        }
        earlier => {
            if earlier.is_some() {
                bar.say("the frames of the run that was broken off are gone; all begins anew");
            }
            Streaming::begun(recorded, settings, (out, kind), bar)
        }
    }
}
