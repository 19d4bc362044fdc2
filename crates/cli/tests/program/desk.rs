//! A folder with a model, pictures of a hand, and the program to run on them.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

use glam::DVec3;
use image::DynamicImage;
use phalanx::{Estimator, FixedPoses, NoProgress, Preset, Training, draw_silhouette};
use phalanx_camera::{Camera, Rig};
use phalanx_hand::{Digit, Dof, HandShape, JOINTS, Pose};
use phalanx_multiview::CodebookTrainer;
use phalanx_render::{Appearance, Renderer};
use tempfile::TempDir;

pub(crate) const CAMERAS: [&str; 2] = ["side", "top"];

fn rig() -> Rig {
    let desk = Rig::from_toml(include_str!("../../fixtures/desk.toml"));
    desk.and_then(|desk| desk.select(&CAMERAS)).unwrap()
}

/// A hand closed by a share of 0 to 1.
pub(crate) fn closing(closed: f64) -> Pose {
    let mut pose = Pose::REST;
    for finger in Digit::FINGERS {
        for (dof, degrees) in finger.dofs().into_iter().zip([0.0, 70.0, 88.0, 55.0]) {
            pose[dof] = (closed * degrees).to_radians();
        }
    }
    pose[Dof::ThetaZ] = 20_f64.to_radians();
    pose
}

static MODEL: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let mut vocabulary =
        CodebookTrainer { centres: 20, most_samples: 2000, ..CodebookTrainer::default() };
    vocabulary.clustering.restarts = 1;
    let training = Training { vocabulary, ..Training::default() };
    let poses: Vec<_> = (0..16).map(|k| closing(f64::from(k) / 15.0)).collect();
    let estimator = training.run(&rig(), &HandShape::adult(), &poses, &NoProgress);
    estimator.and_then(|estimator: Estimator| estimator.to_bytes()).unwrap()
});

/// What `phalanx demo --json --out demo` does in an empty folder, and that folder. It tracks sixty moments, so it is run
/// once for all.
pub(crate) static DEMO: LazyLock<(PathBuf, Outcome)> = LazyLock::new(|| {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("demo");
    if folder.exists() {
        std::fs::remove_dir_all(&folder).unwrap();
    }
    std::fs::create_dir_all(&folder).unwrap();
    let outcome = run(&folder, ["demo", "--json", "--out", "demo"]);
    (folder, outcome)
});

/// A temporary folder with `model`, and for each camera `<camera>-mask.png` (the mask) and
/// `<camera>.png` (a photograph, 320×240) of the hand half closed.
pub(crate) struct Desk {
    folder: TempDir,
}

impl Desk {
    pub(crate) fn new() -> Self {
        let desk = Self { folder: TempDir::new().unwrap() };
        desk.write("model", &MODEL);
        let (hand, pose, rest) = (HandShape::adult(), closing(0.5), rig().volume.rest_frame());
        for camera in rig().cameras {
            let mask = draw_silhouette(&camera, &hand, &pose, &rest).unwrap();
            desk.save(&format!("{}-mask.png", camera.name), &mask.into());
            let larger = camera.with_intrinsics(camera.intrinsics.resized(320, 240));
            let solids = hand.pose(&pose, &rest).primitives;
            let mut renderer = Renderer::new(&larger).unwrap();
            let photograph = renderer.shade(&solids, &Appearance::default(), 1).unwrap();
            desk.save(&format!("{}.png", camera.name), &photograph.into());
        }
        desk
    }

    /// Makes `model` know which of its answers to doubt.
    pub(crate) fn learn_doubts(&self) {
        let (rig, hand) = (rig(), HandShape::adult());
        let poses: Vec<Pose> = (0..200).map(|k| closing(f64::from(k) / 199.0)).collect();
        let scenes = FixedPoses { rig: &rig, hand: &hand, poses: &poses };
        let model = Estimator::from_bytes(&self.read("model")).unwrap();
        let model = model.fit_error_model(&scenes, &NoProgress).unwrap();
        self.write("model", &model.to_bytes().unwrap());
    }

    /// Makes `model` one that answers any of its cameras.
    pub(crate) fn learn_any_cameras(&self) {
        let mut training = Preset::Fast.training();
        (training.vocabulary.centres, training.vocabulary.most_samples) = (12, 2000);
        // Every digit and the whole hand move.
        let moving = |k: u8| {
            let mut pose = closing(f64::from(k) / 63.0);
            pose[Dof::ThumbMcp] = 0.01 * f64::from(k % 32);
            pose[Dof::ThetaZ] = 0.01 * f64::from(k % 16);
            pose
        };
        let poses: Vec<Pose> = (0..64).map(moving).collect();
        let estimator = training.run(&rig(), &HandShape::adult(), &poses, &NoProgress).unwrap();
        self.write("model", &estimator.to_bytes().unwrap());
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap()
    }

    pub(crate) fn write(&self, name: &str, bytes: &[u8]) {
        std::fs::write(self.path(name), bytes).unwrap();
    }

    pub(crate) fn save(&self, name: &str, image: &DynamicImage) {
        image.save(self.path(name)).unwrap();
    }

    pub(crate) fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// The hand's joints, closed by so much, in each camera's picture, px.
    pub(crate) fn points(closed: f64) -> [[[f64; 2]; JOINTS]; 2] {
        let (rig, joints) = (rig(), Self::joints(closed));
        let seen = |camera: &Camera| joints.map(|joint| camera.project(joint).unwrap().to_array());
        [seen(&rig.cameras[0]), seen(&rig.cameras[1])]
    }

    /// Draws a silhouette of the hand, closed by so much, into `<folder>/<camera>/<name>` for each
    /// camera.
    pub(crate) fn draw_frame(&self, folder: &str, name: &str, closed: f64) {
        self.draw_hand(&rig(), &HandShape::adult(), (folder, name), &closing(closed));
    }

    /// The same of a posed hand before the cameras of a rig.
    pub(crate) fn draw_hand(
        &self,
        rig: &Rig,
        hand: &HandShape,
        (folder, name): (&str, &str),
        pose: &Pose,
    ) {
        for camera in &rig.cameras {
            let folder = self.path(folder).join(&camera.name);
            std::fs::create_dir_all(&folder).unwrap();
            let mask = draw_silhouette(camera, hand, pose, &rig.volume.rest_frame());
            mask.unwrap().save(folder.join(name)).unwrap();
        }
    }

    /// Copies the first eight moments of the demo's recording into `eight`.
    pub(crate) fn copy_eight_moments(&self) {
        let recording = DEMO.0.join("demo/recording");
        for camera in ["side", "top", "other_side"] {
            let folder = self.path("eight").join(camera);
            std::fs::create_dir_all(&folder).unwrap();
            for moment in 0..8 {
                let name = format!("{moment:03}.png");
                std::fs::copy(recording.join(camera).join(&name), folder.join(name)).unwrap();
            }
        }
    }

    /// Where the joints of the hand are that is drawn closed by so much, mm.
    pub(crate) fn joints(closed: f64) -> [DVec3; JOINTS] {
        HandShape::adult().pose(&closing(closed), &rig().volume.rest_frame()).joints
    }

    /// Writes the rig of the cameras.
    pub(crate) fn write_rig(&self, name: &str) {
        self.write(name, rig().to_toml().unwrap().as_bytes());
    }

    pub(crate) fn open(&self, name: &str) -> DynamicImage {
        image::open(self.path(name)).unwrap()
    }

    /// Names of everything in the folder, sorted.
    pub(crate) fn listing(&self) -> Vec<String> {
        let name = |entry: std::io::Result<std::fs::DirEntry>| {
            entry.unwrap().file_name().into_string().unwrap()
        };
        let mut names: Vec<_> = std::fs::read_dir(self.folder.path()).unwrap().map(name).collect();
        names.sort();
        names
    }

    /// Runs `phalanx estimate --model model` with these further arguments, in the folder.
    pub(crate) fn estimate(&self, arguments: &[&str]) -> Outcome {
        run(self.folder.path(), ["estimate", "--model", "model"].iter().chain(arguments))
    }
}

/// Runs the program in a folder.
pub(crate) fn run(
    folder: &Path,
    arguments: impl IntoIterator<Item = impl AsRef<OsStr>>,
) -> Outcome {
    let mut program = Command::new(env!("CARGO_BIN_EXE_phalanx"));
    program.current_dir(folder).args(arguments).output().unwrap().into()
}

/// What the program did.
#[derive(Debug)]
pub(crate) struct Outcome {
    pub(crate) code: Option<i32>,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl From<Output> for Outcome {
    fn from(output: Output) -> Self {
        Self {
            code: output.status.code(),
            out: String::from_utf8(output.stdout).unwrap(),
            err: String::from_utf8(output.stderr).unwrap(),
        }
    }
}
