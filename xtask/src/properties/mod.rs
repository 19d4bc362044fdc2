//! `cargo xtask properties`: the property tests at random, for as long as one likes.

mod campaign;
mod discovery;
mod trial;

use std::process::ExitCode;
use std::time::{Duration, Instant};

use anyhow::{Result, ensure};
use clap::Args;

use campaign::Campaign;
use phalanx_lab::files;

/// Where a campaign says how far it has come.
const STATE: &str = "target/properties.json";

/// The test command draws the same few cases of each property every time; this draws others.
///
/// It goes on where it stopped, by target/properties.json; remove that file to begin anew.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Cases of each property and seed; a tenth where a case takes longer than 20 ms.
    #[arg(long, value_name = "N", default_value_t = 1000)]
    cases: u32,
    /// Where the cases are drawn from; several with commas between them.
    #[arg(long, value_name = "S", value_delimiter = ',', default_value = "1")]
    seed: Vec<u32>,
    /// Stops after so many minutes, to go on another time.
    #[arg(long, value_name = "M")]
    minutes: Option<f64>,
    /// Only the properties in whose folder, test or name this occurs.
    #[arg(long, value_name = "TEXT", default_value = "")]
    only: String,
}

/// Exit code 1 if a property failed.
pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode> {
    let minutes = arguments.minutes.unwrap_or(f64::INFINITY);
    let limit = Duration::try_from_secs_f64(60.0 * minutes).unwrap_or(Duration::MAX);
    let mut properties = discovery::find()?;
    properties.retain(|property| property.to_string().contains(&arguments.only));
    ensure!(!properties.is_empty(), "no property is called anything like {:?}", arguments.only);

    let mut campaign = Campaign::read(files::in_repository(STATE))?;
    campaign.retry(&properties)?;
    let begin = Instant::now();
    while begin.elapsed() < limit {
        // Every property comes on evenly, so that a short time tries them all.
        let mut is_over = true;
        for &seed in &arguments.seed {
            for property in &properties {
                if begin.elapsed() < limit {
                    is_over &= !campaign.advance(property, seed, arguments.cases)?;
                }
            }
        }
        if is_over {
            break;
        }
    }
    files::print(&campaign.report(&properties, &arguments.seed, arguments.cases))?;
    Ok(if campaign.is_sound() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
