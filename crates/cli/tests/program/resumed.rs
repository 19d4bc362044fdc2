//! `phalanx track`, killed and started again.

use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use phalanx::ItemRng;

use crate::desk::{CAMERAS, Desk, Outcome, run};
use crate::tracks::recorded;

const FRAMES: usize = 16;

/// Six of the frames tell the hand, and then all are tracked.
fn arguments(out: &str) -> [&str; 8] {
    ["track", "take", "--rig", "rig.toml", "--mask", "--fit-together=6", "--out", out]
}

fn track(desk: &Desk, out: &str, others: &[&str]) -> Outcome {
    run(desk.folder(), arguments(out).iter().chain(others))
}

fn lines(path: &Path) -> usize {
    std::fs::read_to_string(path).unwrap_or_default().lines().count()
}

/// Kills the program some time after so many lines are written; whether it had not ended before.
fn killed(desk: &Desk, out: &str, written: usize, later: Duration) -> bool {
    let mut program = Command::new(env!("CARGO_BIN_EXE_phalanx"));
    program.current_dir(desk.folder()).args(arguments(out)).stderr(Stdio::null());
    let mut child = program.spawn().unwrap();
    let rows = desk.path(&format!("{out}.unfinished"));
    while lines(&rows) < written && child.try_wait().unwrap().is_none() {
        sleep(Duration::from_millis(1));
    }
    sleep(later);
    child.kill().unwrap();
    child.wait().unwrap().code().is_none()
}

#[test]
fn a_run_that_is_killed_goes_on_to_the_same_bytes() {
    let desk = recorded(FRAMES);
    // One picture that cannot be read is counted once, whenever the run is broken off.
    desk.write(&format!("take/{}/0003.png", CAMERAS[0]), b"no picture");
    for (kind, written) in [("csv", 1), ("jsonl", 6), ("npz", 11)] {
        let (whole, broken) = (format!("whole.{kind}"), format!("broken.{kind}"));
        let unbroken = track(&desk, &whole, &[]);
        assert_eq!(unbroken.code, Some(1), "{unbroken:?}");
        assert!(killed(&desk, &broken, written, Duration::ZERO), "it ended too early");
        assert!(!desk.path(&broken).exists());
        let outcome = track(&desk, &broken, &[]);
        assert!(outcome.err.contains("going on after "), "{outcome:?}");
        let said = |outcome: &Outcome| {
            let last = outcome.err.lines().rev().take(2).map(|line| line.replace(&whole, &broken));
            last.collect::<Vec<_>>()
        };
        assert_eq!((outcome.code, said(&outcome)), (unbroken.code, said(&unbroken)));
        assert!(desk.read(&broken) == desk.read(&whole), "{kind}");
    }
    let left: Vec<String> = desk.listing();
    assert!(left.iter().all(|name| !name.contains(".unfinished")), "{left:?}");
    assert!(left.iter().all(|name| !name.contains(".checkpoint")), "{left:?}");
}

#[test]
fn what_was_broken_off_goes_on_with_the_same_alone() {
    let desk = recorded(FRAMES);
    assert!(killed(&desk, "take.csv", 3, Duration::ZERO), "it ended too early");
    let refused = |others: &[&str], words: &str| {
        let outcome = track(&desk, "take.csv", others);
        assert_eq!(outcome.code, Some(2), "{outcome:?}");
        let named = outcome.err.contains("take.csv.checkpoint: ") && outcome.err.contains(words);
        assert!(named && outcome.err.contains("remove the file"), "{outcome:?}");
    };
    refused(&["--rate", "10"], "--rate is 10, and was not given");
    refused(&["--side", "left"], "--side is left, and was right");
    let kept = desk.read("take.csv.checkpoint");
    let version = concat!("phalanx ", env!("CARGO_PKG_VERSION"));
    let end = kept.iter().position(|&byte| byte == b'\n').unwrap();
    let other = String::from_utf8(kept[..end].to_vec()).unwrap().replace(version, "phalanx 0.0.1");
    desk.write("take.csv.checkpoint", &[other.as_bytes(), &kept[end..]].concat());
    refused(&[], "and was phalanx 0.0.1");
    desk.write("take.csv.checkpoint", &kept);
    // One more, of another moment.
    desk.draw_frame("take", "9999.png", 0.2);
    refused(&[], &format!("the recording of camera '{}'", CAMERAS[0]));
    // A damaged one is said, and so are frames that are gone.
    for camera in CAMERAS {
        std::fs::remove_file(desk.path(&format!("take/{camera}/9999.png"))).unwrap();
    }
    std::fs::remove_file(desk.path("take.csv.unfinished")).unwrap();
    let outcome = track(&desk, "take.csv", &[]);
    assert!(outcome.code == Some(0) && outcome.err.contains("are gone"), "{outcome:?}");
}

#[test]
fn two_runs_do_not_write_one_output() {
    let desk = recorded(FRAMES);
    let other = std::fs::File::create(desk.path("take.csv.unfinished")).unwrap();
    other.lock().unwrap();
    let outcome = track(&desk, "take.csv", &[]);
    assert_eq!(outcome.code, Some(2), "{outcome:?}");
    assert!(outcome.err.contains("another run is writing it"), "{outcome:?}");
}

#[test]
fn rows_go_through_links_and_to_standard_output() {
    let desk = recorded(FRAMES);
    let whole = track(&desk, "take.csv", &[]);
    assert_eq!(whole.code, Some(0), "{whole:?}");
    let streamed = track(&desk, "-", &[]);
    assert!(streamed.out.as_bytes() == desk.read("take.csv"), "{}", streamed.err);
    #[cfg(unix)]
    {
        std::fs::create_dir(desk.path("elsewhere")).unwrap();
        std::os::unix::fs::symlink("elsewhere/take.csv", desk.path("link.csv")).unwrap();
        let linked = track(&desk, "link.csv", &[]);
        assert_eq!(linked.code, Some(0), "{linked:?}");
        assert!(desk.path("link.csv").is_symlink());
        assert!(desk.read("elsewhere/take.csv") == desk.read("take.csv"));
    }
}

/// How long a run takes until its first row, while the hand is fitted, and until it ends.
fn durations(desk: &Desk, out: &str) -> [Duration; 2] {
    let begun = Instant::now();
    let mut program = Command::new(env!("CARGO_BIN_EXE_phalanx"));
    let mut child = program
        .current_dir(desk.folder())
        .args(arguments(out))
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let rows = desk.path(&format!("{out}.unfinished"));
    while lines(&rows) == 0 && child.try_wait().unwrap().is_none() {
        sleep(Duration::from_millis(1));
    }
    let fitted = begun.elapsed();
    assert!(child.wait().unwrap().success());
    [fitted, begun.elapsed()]
}

#[test]
#[ignore = "kills a run twenty times"]
fn a_run_that_is_killed_at_any_instant_goes_on_to_the_same_bytes() {
    const KILLS: usize = 20;
    let desk = recorded(KILLS);
    let [fitted, ended] = durations(&desk, "whole.csv");
    let mut random = ItemRng::new(24, 0);
    let mut broken = [0, 0];
    for kill in 0..KILLS {
        // Half of them while the hand is fitted; of that nothing is kept.
        let is_early = kill % 2 == 0;
        let (from, to) = if is_early { (Duration::ZERO, fitted) } else { (fitted, ended) };
        let instant = from + to.saturating_sub(from).mul_f64(random.between(0.0, 1.0));
        let out = format!("broken-{kill}.csv");
        if killed(&desk, &out, 0, instant) {
            broken[usize::from(!is_early)] += 1;
        }
        let outcome = track(&desk, &out, &[]);
        assert_eq!(outcome.code, Some(0), "{outcome:?}");
        assert!(desk.read(&out) == desk.read("whole.csv"), "killed after {instant:?}");
        assert!(!desk.path(&format!("{out}.unfinished")).exists());
        assert!(!desk.path(&format!("{out}.checkpoint")).exists());
    }
    println!(
        "killed while the hand was fitted ({fitted:.1?}): {}, while it was tracked (to {ended:.1?}): {}",
        broken[0], broken[1]
    );
    // A computer that is quicker than it was may end runs before they are killed, even all that are killed late; those are
    // whole.
    assert!(broken.iter().sum::<usize>() >= KILLS / 4, "{broken:?} runs were broken off");
}
