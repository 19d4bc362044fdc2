//! Training in parts and tracking of many recordings, by the files of the guide, on real Slurm and Snakemake.
//!
//! Slurm comes from Debian, Snakemake from PyPI: `cargo test --workspace --test cluster -- --ignored`.

#[path = "../installed/mod.rs"]
mod installed;
mod slurm;
mod work;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::SystemTime;

use slurm::Slurm;
use work::Work;

/// A file of the guide.
fn guide(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/guide/cluster");
    folder.join(name).canonicalize().expect("a file of the guide")
}

fn is_there(path: &Path) -> bool {
    path.exists()
}

fn changed(path: &Path) -> SystemTime {
    path.metadata().and_then(|file| file.modified()).expect("a file")
}

#[test]
#[ignore = "installs Slurm from Debian"]
fn slurm_redoes_a_killed_part_alone_and_tracks_as_one_by_one() {
    let packages = ["slurmctld", "slurmd", "slurm-client"];
    let Some(()) = installed::program("slurmctld", &packages) else { return };
    let work = Work::new();
    work.kill_once("3/4");
    let slurm = Slurm::start(&work);
    let part = |k: usize| work.path(&format!("parts/{k}-of-4"));
    let train = || slurm.run("1-4", &guide("train.sh"), &[&["4"], &work::TRAINING[..]].concat());
    train();
    let done = [1, 2, 3, 4].map(|k| is_there(&part(k)));
    assert_eq!(done, [true, true, false, true], "{}", slurm.said());
    let before = [1, 2, 4].map(|k| changed(&part(k)));
    train();
    assert_eq!([1, 2, 4].map(|k| changed(&part(k))), before, "parts that were there are kept");
    assert!(is_there(&part(3)), "{}", slurm.said());
    work.assert_merged_is_whole(&[1, 2, 3, 4].map(part));
    let options = [&["recordings.txt"], &work::TRACKING[..]].concat();
    slurm.run(&format!("1-{}", work::RECORDINGS), &guide("track.sh"), &options);
    work.assert_takes_are_as_one_by_one();
}

#[test]
#[ignore = "installs Snakemake from PyPI"]
fn snakemake_redoes_a_killed_part_alone_and_tracks_as_one_by_one() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("snakemake");
    std::fs::create_dir_all(&folder).expect("a folder");
    let Some(python) = installed::python(&folder, &["snakemake==9.27.1"]) else { return };
    let work = Work::new();
    work.kill_once("3/4");
    let snakemake = |target: &str, options: String| {
        let mut snakemake = Command::new(&python);
        snakemake.args(["-m", "snakemake", "--cores", "2", "--keep-going", "--snakefile"]);
        snakemake.arg(guide("Snakefile")).arg(target).args(["--config", &options]);
        work.run_in(&mut snakemake)
    };
    let train = || snakemake("hand.phalanx", format!("train={}", work::TRAINING.join(" ")));
    let part = |k: usize| work.path(&format!("parts/{k}-of-4"));
    assert!(!train().status.success(), "a job was killed");
    let before = [1, 2, 4].map(|k| changed(&part(k)));
    assert!(!is_there(&part(3)));
    let again = train();
    assert!(again.status.success(), "{again:?}");
    assert_eq!([1, 2, 4].map(|k| changed(&part(k))), before, "parts that were there are kept");
    work::assert_is_whole(&work.path("hand.phalanx"));
    let tracked = snakemake("takes", format!("track={}", work::TRACKING.join(" ")));
    assert!(tracked.status.success(), "{tracked:?}");
    work.assert_takes_are_as_one_by_one();
}
