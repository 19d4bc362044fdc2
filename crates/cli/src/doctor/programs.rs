//! The program itself, and those that it calls.

use std::process::Command;

use phalanx::Maker;

use crate::counts::counted;
use crate::finding::Finding;

pub(super) fn findings() -> Vec<Finding> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    vec![
        Finding::good("program", format!("{}, {}", Maker::here(), counted(threads, "thread"))),
        ffmpeg(),
    ]
}

fn ffmpeg() -> Finding {
    let version = Command::new("ffmpeg").arg("-version").output().ok();
    let version = version.filter(|output| output.status.success());
    let line = version.and_then(|output| {
        String::from_utf8_lossy(&output.stdout).lines().next().map(str::to_owned)
    });
    match line {
        Some(line) => Finding::good("ffmpeg", line),
        None => Finding::doubtful(
            "ffmpeg",
            "it is not on the path: of videos only H.264 in MP4 can be read; pictures need no ffmpeg",
        ),
    }
}
