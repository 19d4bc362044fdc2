//! Models that the program trains by itself.

use std::process::{Command, Stdio};
use std::sync::LazyLock;

use phalanx::{Mask, draw_silhouette, working_camera};
use phalanx_camera::Rig;
use phalanx_hand::{Dof, HandShape, Pose};
use serde_json::Value;
use tempfile::TempDir;

use crate::desk::{Outcome, closing, run};

/// As quick as it goes: one camera, few scenes.
const QUICK: [&str; 7] = ["train", "--preset", "fast", "--samples", "150", "--cameras", "top"];

fn train(folder: &TempDir, arguments: &[&str]) -> Outcome {
    run(folder.path(), QUICK.iter().chain(arguments))
}

/// The hand before the built-in rig's camera from above.
fn seen_from_the_top(pose: &Pose) -> Mask {
    let rig = Rig::from_toml(include_str!("../../fixtures/desk.toml")).unwrap();
    let camera = rig.select(&["top"]).unwrap().cameras.remove(0);
    let camera = working_camera(&camera).unwrap();
    draw_silhouette(&camera, &HandShape::adult(), pose, &rig.volume.rest_frame()).unwrap()
}

/// What training does in an empty folder, and the model.
static TRAINED: LazyLock<(Outcome, Vec<u8>)> = LazyLock::new(|| {
    let folder = TempDir::new().unwrap();
    let outcome = train(&folder, &["--out", "hand.phalanx"]);
    (outcome, std::fs::read(folder.path().join("hand.phalanx")).unwrap_or_default())
});

#[test]
fn in_an_empty_folder_a_model_is_trained_and_estimates() {
    let folder = TempDir::new().unwrap();
    let (outcome, model) = &*TRAINED;
    assert_eq!(outcome.code, Some(0), "{}", outcome.err);
    assert!(
        outcome.out.starts_with("hand.phalanx: a model for the cameras top; "),
        "{}",
        outcome.out
    );
    assert!(outcome.err.contains("scenes to draw for 1 camera; about "), "{}", outcome.err);

    std::fs::write(folder.path().join("hand.phalanx"), model).unwrap();
    for (name, closed) in [("open.png", 0.0), ("closed.png", 1.0)] {
        seen_from_the_top(&closing(closed)).save(folder.path().join(name)).unwrap();
    }
    let bent = |name: &str, further: &[&str]| {
        let arguments = ["estimate", "--model", "hand.phalanx", "--mask", "--json", name];
        let outcome = run(folder.path(), arguments.iter().chain(further));
        assert_eq!(outcome.code, Some(0), "{}", outcome.err);
        let report: Value = serde_json::from_str(&outcome.out).unwrap();
        let fingers = [Dof::IndexPip, Dof::MiddlePip, Dof::RingPip];
        let bent = fingers.map(|dof| report["pose"][dof.name()]["value"].as_f64().unwrap());
        bent.iter().sum::<f64>() / 3.0
    };
    assert!(bent("closed.png", &[]) > bent("open.png", &[]) + 15.0);
    // It has learnt how its estimates err, so that refinement tries several poses.
    assert!(bent("closed.png", &["--refine"]) > bent("open.png", &["--refine"]) + 30.0);
}

#[test]
fn parts_are_merged_to_the_model_of_a_single_run() {
    let folder = TempDir::new().unwrap();
    let outcome = train(&folder, &["--shard", "1/1", "--out", "part"]);
    assert_eq!(outcome.code, Some(0), "{}", outcome.err);
    let outcome = run(folder.path(), ["merge", "part", "--out", "merged", "--json"]);
    assert_eq!(outcome.code, Some(0), "{}", outcome.err);
    let said: Value = serde_json::from_str(&outcome.out).unwrap();
    assert_eq!((&said["model"], &said["cameras"][0]), (&"merged".into(), &"top".into()));
    assert!(std::fs::read(folder.path().join("merged")).unwrap() == TRAINED.1);
    let outcome = run(folder.path(), ["merge", "part", "part", "--out", "twice"]);
    assert_eq!(outcome.code, Some(2));
    assert!(outcome.err.contains("part: two parts both hold samples 0 to 149"), "{}", outcome.err);
}

#[test]
fn what_was_trained_is_said_as_json() {
    let folder = TempDir::new().unwrap();
    let said = |arguments: &[&str]| -> Value {
        let outcome = train(&folder, &[arguments, &["--json"]].concat());
        assert_eq!(outcome.code, Some(0), "{}", outcome.err);
        serde_json::from_str(&outcome.out).unwrap()
    };
    let bytes = |name: &str| std::fs::metadata(folder.path().join(name)).unwrap().len();
    let model = said(&["--out", "hand.phalanx"]);
    let expected = serde_json::json!({
        "model": "hand.phalanx", "cameras": ["top"], "bytes": bytes("hand.phalanx"),
    });
    assert_eq!(model, expected);
    let part = said(&["--shard", "1/2", "--out", "part"]);
    assert_eq!(part, serde_json::json!({ "part": "part", "bytes": bytes("part"), "lost": 0 }));
}

/// Killed with what is done kept beside the output, and started again.
#[test]
fn a_killed_training_goes_on_to_the_same_bytes() {
    let folder = TempDir::new().unwrap();
    // Two blocks of scenes, and no model of errors, which takes longer than they do.
    let blocks = ["train", "--preset", "fast", "--samples", "1100", "--cameras", "top"];
    let longer = [&blocks[..], &["--shard", "1/1", "--out"]].concat();
    let kept = folder.path().join("hand.unfinished");
    let mut program = Command::new(env!("CARGO_BIN_EXE_phalanx"));
    let mut killed = program
        .current_dir(folder.path())
        .args(&longer)
        .arg("hand")
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    while !kept.exists() && killed.try_wait().unwrap().is_none() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    killed.kill().unwrap();
    killed.wait().unwrap();
    assert!(kept.exists() && !folder.path().join("hand").exists());

    let other = run(folder.path(), longer.iter().chain(&["hand", "--seed", "1"]));
    assert_eq!(other.code, Some(2), "{}", other.err);
    assert!(other.err.contains("hand.unfinished: an unfinished training"), "{}", other.err);
    let outcome = run(folder.path(), longer.iter().chain(&["hand"]));
    assert_eq!(outcome.code, Some(0), "{}", outcome.err);
    assert!(outcome.err.contains("going on after "), "{}", outcome.err);
    assert!(!kept.exists());
    std::fs::write(folder.path().join("whole.unfinished"), b"no part").unwrap();
    let whole = run(folder.path(), longer.iter().chain(&["whole"]));
    assert!(whole.err.contains("whole.unfinished: ") && whole.code == Some(0), "{}", whole.err);
    let read = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    assert!(read("hand") == read("whole"));
}

#[test]
fn what_cannot_be_trained_is_named_and_leaves_nothing() {
    let folder = TempDir::new().unwrap();
    let desk = include_str!("../../fixtures/desk.toml");
    // The hand works where no camera looks.
    let away = desk.replacen("center_mm = [0, 0, 0]", "center_mm = [0, 0, 600]", 1);
    assert_ne!(away, desk);
    std::fs::write(folder.path().join("away.toml"), away).unwrap();
    // It works where they often do not look.
    let wide = desk.replacen("size_mm = [100, 100, 100]", "size_mm = [900, 100, 900]", 1);
    assert_ne!(wide, desk);
    std::fs::write(folder.path().join("wide.toml"), wide).unwrap();
    for (arguments, said) in [
        (&["--samples", "3"][..], "3 is not between 100 and 10000000"),
        (&["--shard", "3/2"], "there is no shard 3 of 2"),
        (&["--cameras", "left"], "left"),
        (&["--rig", "missing.toml"], "missing.toml"),
        (&["--rig", "away.toml"], "the volume's center_mm lies outside its picture"),
        (&["--rig", "wide.toml", "--framing", "window"], "`phalanx rig volume` finds"),
        (&["--poses", "missing.csv"], "missing.csv"),
    ] {
        let arguments = ["train", "--preset", "fast", "--out", "out"].iter().chain(arguments);
        let samples: &[&str] = if arguments.clone().any(|argument| *argument == "--samples") {
            &[]
        } else {
            &["--samples", "150"]
        };
        let outcome = run(folder.path(), arguments.chain(samples));
        assert_eq!(outcome.code, Some(2), "{}", outcome.err);
        assert!(outcome.err.contains(said), "{said}: {}", outcome.err);
        assert!(!folder.path().join("out").exists());
    }
}
