//! A folder with recordings, and the program in front of which a script can kill one job.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

use phalanx::draw_silhouette;
use phalanx_camera::Rig;
use phalanx_hand::{Digit, HandShape, Pose};
use tempfile::TempDir;

use crate::installed::run;

/// Four blocks of scenes, one for each part.
pub(crate) const TRAINING: [&str; 6] =
    ["--preset", "fast", "--samples", "3100", "--cameras", "top"];
pub(crate) const TRACKING: [&str; 3] = ["--rig", "rig.toml", "--mask"];
pub(crate) const RECORDINGS: usize = 4;

const PROGRAM: &str = env!("CARGO_BIN_EXE_phalanx");
const RIG: &str = include_str!("../../fixtures/desk.toml");

/// The model of a single run.
static WHOLE: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let folder = TempDir::new().expect("a folder");
    let model = folder.path().join("whole");
    run(Command::new(PROGRAM).arg("train").args(TRAINING).arg("--out").arg(&model));
    std::fs::read(model).expect("a model")
});

/// The takes of the recordings, tracked one by one.
static ALONE: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| {
    let work = Work::new();
    let take = |k: usize| {
        let mut track = Command::new(PROGRAM);
        track
            .arg("track")
            .arg(format!("recordings/{k}"))
            .args(TRACKING)
            .args(["--out", "take.csv"]);
        run(track.current_dir(work.0.path()));
        std::fs::read(work.path("take.csv")).expect("a take")
    };
    (0..RECORDINGS).map(take).collect()
});

/// A hand that closes, in a recording and a moment of it.
fn pose(recording: usize, moment: usize) -> Pose {
    let mut pose = Pose::REST;
    let closed = 0.1 + 0.1 * recording as f64 + 0.05 * moment as f64;
    for finger in Digit::FINGERS {
        for (dof, angle) in finger.dofs().into_iter().zip([0.0, 1.1, 1.4, 0.9]) {
            pose[dof] = closed * angle;
        }
    }
    pose
}

pub(crate) struct Work(TempDir);

impl Work {
    /// Recordings of three moments by three cameras, and a list of them.
    pub(crate) fn new() -> Self {
        let work = Self(TempDir::new().expect("a folder"));
        std::fs::write(work.path("rig.toml"), RIG).expect("a rig");
        let rig = Rig::from_toml(RIG).expect("a rig");
        let (hand, rest) = (HandShape::adult(), rig.volume.rest_frame());
        for (recording, camera) in
            (0..RECORDINGS).flat_map(|k| rig.cameras.iter().map(move |c| (k, c)))
        {
            let folder = work.path(&format!("recordings/{recording}")).join(&camera.name);
            std::fs::create_dir_all(&folder).expect("a folder");
            for moment in 0..3 {
                let mask = draw_silhouette(camera, &hand, &pose(recording, moment), &rest);
                let file = folder.join(format!("{moment}.png"));
                mask.expect("in sight").save(file).expect("a picture");
            }
        }
        let list: Vec<String> = (0..RECORDINGS).map(|k| format!("recordings/{k}")).collect();
        std::fs::write(work.path("recordings.txt"), list.join("\n") + "\n").expect("a list");
        std::fs::create_dir(work.path("bin")).expect("a folder");
        work.script("exec \"$real\" \"$@\"\n");
        work
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// The first job that does this shard is killed with the program in it.
    pub(crate) fn kill_once(&self, shard: &str) {
        let killing = format!(
            "case \" $* \" in *' {shard} '*)\n\
             mkdir killed 2>/dev/null && {{ \"$real\" \"$@\" & sleep 1; kill -9 $!; wait $!; exit $?; }}\n\
             esac\nexec \"$real\" \"$@\"\n"
        );
        self.script(&killing);
    }

    /// What stands for the program on the path.
    fn script(&self, lines: &str) {
        let path = self.path("bin/phalanx");
        std::fs::write(&path, format!("#!/bin/sh\nreal='{PROGRAM}'\n{lines}")).expect("a script");
        run(Command::new("chmod").arg("+x").arg(path));
    }

    /// The path on which the script is the program.
    pub(crate) fn search_path(&self) -> String {
        let others = std::env::var("PATH").expect("a path");
        format!("{}:{others}", self.path("bin").display())
    }

    /// Runs something in the folder.
    pub(crate) fn run_in(&self, command: &mut Command) -> Output {
        let command = command.current_dir(self.0.path()).env("PATH", self.search_path());
        command.output().expect("it starts")
    }

    pub(crate) fn assert_merged_is_whole(&self, parts: &[PathBuf]) {
        let merged = self.path("merged.phalanx");
        run(Command::new(PROGRAM).arg("merge").args(parts).arg("--out").arg(&merged));
        assert_is_whole(&merged);
    }

    pub(crate) fn assert_takes_are_as_one_by_one(&self) {
        for (k, alone) in ALONE.iter().enumerate() {
            let take = std::fs::read(self.path(&format!("takes/{k}.csv"))).expect("a take");
            assert!(take == *alone, "recording {k} differs");
        }
    }
}

/// A model has the bytes that one run gives.
pub(crate) fn assert_is_whole(model: &Path) {
    let model = std::fs::read(model).expect("a model");
    assert!(model == *WHOLE, "parts give another model than one run");
}
