//! `timestamps.csv`: when each camera took its frames.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use phalanx_camera::Camera;

use super::Stamp;
use crate::counts::counted;
use phalanx_cli::reading;

/// The frame times of each camera, where there is a file of them.
///
/// # Errors
/// A file that cannot be read, or lacks a camera.
pub(crate) fn of_cameras(path: Option<&Path>, cameras: &[Camera]) -> Result<Vec<Option<Vec<f64>>>> {
    let Some(path) = path else { return Ok(vec![None; cameras.len()]) };
    let mut all = read(path)?;
    let of = |camera: &Camera| {
        let times = all.remove(&camera.name);
        let times = times.with_context(|| {
            format!("{}: there are no times of camera '{}'", path.display(), camera.name)
        })?;
        Ok(Some(times))
    };
    cameras.iter().map(of).collect()
}

/// A camera's frames at the times that were written apart, if any were.
///
/// # Errors
/// Another number of times than frames.
pub(crate) fn stamped<'a>(
    stamps: &'a [Stamp],
    camera: &Camera,
    times: Option<&[f64]>,
) -> Result<Cow<'a, [Stamp]>> {
    let Some(times) = times else { return Ok(Cow::Borrowed(stamps)) };
    ensure!(
        times.len() == stamps.len(),
        "camera '{}' has {}, but {}",
        camera.name,
        counted(stamps.len(), "frame"),
        counted(times.len(), "time")
    );
    let with_time = |(stamp, &time): (&Stamp, &f64)| Stamp { time: Some(time), ..stamp.clone() };
    Ok(stamps.iter().zip(times).map(with_time).collect())
}

/// Frame times in seconds by camera, ascending; a row for each frame with the columns `cam_id` and
/// `frame_time`, in any order.
///
/// # Errors
/// A file that cannot be read, absent columns, a time that is no number.
fn read(path: &Path) -> Result<BTreeMap<String, Vec<f64>>> {
    let text = reading::read_text(path).with_context(|| path.display().to_string())?;
    parse(&text).with_context(|| path.display().to_string())
}

fn parse(text: &str) -> Result<BTreeMap<String, Vec<f64>>> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let (_, header) = lines.next().context("the file is empty")?;
    let names: Vec<&str> = cells(header).collect();
    let column = |name: &str| {
        names.iter().position(|found| *found == name).with_context(|| {
            format!("there is no column '{name}'; cam_id and frame_time are expected")
        })
    };
    let (camera, time) = (column("cam_id")?, column("frame_time")?);
    let mut times: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for (number, line) in lines {
        let row: Vec<&str> = cells(line).collect();
        let (Some(camera), Some(time)) = (row.get(camera), row.get(time)) else {
            bail!("line {}: a cell is missing", number + 1);
        };
        let seconds: f64 = time.parse().with_context(|| format!("line {}: {time}", number + 1))?;
        ensure!(seconds.is_finite(), "line {}: {time} is not a time", number + 1);
        times.entry((*camera).to_owned()).or_default().push(seconds);
    }
    for times in times.values_mut() {
        times.sort_by(f64::total_cmp);
    }
    Ok(times)
}

fn cells(line: &str) -> impl Iterator<Item = &str> {
    line.split(',').map(|cell| cell.trim().trim_matches('"'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_may_come_in_any_order() {
        let times = parse("\u{feff}cam_id,frame_time\n1,0.5\n0,0.1\r\n1,0.2\n\n").unwrap();
        assert_eq!(times["0"], [0.1]);
        assert_eq!(times["1"], [0.2, 0.5]);
    }

    #[test]
    fn errors_name_the_line() {
        for (text, words) in [
            ("cam_id,time\n0,1\n", "frame_time"),
            ("cam_id,frame_time\n0,NaN\n", "line 2"),
            ("cam_id,frame_time\n0,1\n0\n", "line 3"),
            ("", "empty"),
        ] {
            let error = format!("{:#}", parse(text).unwrap_err());
            assert!(error.contains(words), "{error}");
        }
    }
}
