//! A folder with recordings, and the program in front of which a script can kill one job.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

use crate::installed::run;

/// Four blocks of scenes, one for each part.
pub(crate) const TRAINING: [&str; 6] =
    ["--preset", "fast", "--samples", "4000", "--cameras", "top"];
pub(crate) const TRACKING: [&str; 3] = ["--rig", "rig.toml", "--mask"];
pub(crate) const RECORDINGS: usize = 8;

const PROGRAM: &str = env!("CARGO_BIN_EXE_phalanx");

pub(crate) struct Work(TempDir);

impl Work {
    /// Eight recordings of a few moments, of those that `phalanx demo` draws.
    pub(crate) fn new() -> Self {
        let work = Self(TempDir::new().expect("a folder"));
        run(Command::new(PROGRAM).arg("demo").current_dir(work.0.path()));
        let demo = work.path("phalanx-demo");
        std::fs::copy(demo.join("rig.toml"), work.path("rig.toml")).expect("a rig");
        for entry in std::fs::read_dir(demo.join("recording")).expect("a recording") {
            let camera = entry.expect("a camera").path();
            let name = camera.file_name().expect("a name");
            let mut pictures: Vec<PathBuf> = std::fs::read_dir(&camera)
                .expect("pictures")
                .map(|p| p.expect("one").path())
                .collect();
            pictures.sort();
            for (k, picture) in pictures.iter().enumerate() {
                let to = work.path("recordings").join((k % RECORDINGS).to_string()).join(name);
                std::fs::create_dir_all(&to).expect("a folder");
                std::fs::copy(picture, to.join(picture.file_name().expect("a name")))
                    .expect("a copy");
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
        self.assert_is_whole(&merged);
    }

    /// A model has the bytes that one run gives.
    pub(crate) fn assert_is_whole(&self, model: &Path) {
        let whole = self.path("whole.phalanx");
        run(Command::new(PROGRAM).arg("train").args(TRAINING).arg("--out").arg(&whole));
        let [model, whole] = [model, &whole].map(|path| std::fs::read(path).expect("a model"));
        assert!(model == whole, "parts give another model than one run");
    }

    pub(crate) fn assert_takes_are_as_one_by_one(&self) {
        for k in 0..RECORDINGS {
            let [recording, alone] =
                ["recordings/", "alone-"].map(|begin| self.path(&format!("{begin}{k}")));
            let alone = alone.with_extension("csv");
            let mut track = Command::new(PROGRAM);
            track.arg("track").arg(recording).args(TRACKING).arg("--out").arg(&alone);
            run(track.current_dir(self.0.path()));
            let take = std::fs::read(self.path(&format!("takes/{k}.csv"))).expect("a take");
            assert!(take == std::fs::read(alone).expect("a take"), "recording {k} differs");
        }
    }
}
