//! Fig. 4: the training pose whose descriptor is nearest.

use anyhow::Result;
use image::RgbImage;
use phalanx::{
    Augmentation, ItemRng, OrientationRule, PoseContexts, Scene, ShapeVariation, describe_each,
    descriptors, draw_silhouette,
};
use phalanx_hand::{Dof, Pose};
use serde_json::json;

use super::digits_out;
use super::{Experiment, Figure, Finding, Table, Verdict};
use crate::baselines::neighbours::nearest_by_chi_squared;
use crate::context::Lab;
use crate::data::described::Described;
use crate::data::postures::{NAMED, Posture};
use crate::data::scene_list::SceneList;
use crate::figures::mosaic::{mosaic, tinted};

pub(crate) const EXPERIMENT: Experiment = Experiment {
    name: "fig-4",
    place: "Fig. 4",
    title: "the nearest training pose",
    claim: "the training pose with the nearest descriptor looks like the hand in the picture, though \
            the hand is another, and moved, turned and scaled; with three views more so than with \
            one.",
    run,
};

/// How many postures are shown; the first of those with names.
const POSTURES: usize = 9;
const THETA_Z_DEG: [f64; 4] = [0.0, 30.0, 60.0, 90.0];
/// So many times each posture is shown from each side, each time otherwise changed.
const DRAWS: usize = 5;
/// Where the changes' random numbers are from: of the hand's place and size, and of its bones and
/// the cameras.
const PLACES: u64 = 4;
const DAMAGES: u64 = 5;
/// Pictures of one draw.
const SHEET: usize = POSTURES * THETA_Z_DEG.len();

/// How the hand in the pictures differs from that of the training.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Change {
    Nothing,
    /// Other bones and radii (each by its own factor within 1 ± 0.1), all of the hand larger or
    /// smaller by up to 15 %, moved by up to 15 mm along each axis, and every camera rolled by up
    /// to 20°.
    Everything,
}

/// Pictures of some postures.
struct Subject {
    words: &'static str,
    postures: Vec<Pose>,
    change: Change,
}

impl Subject {
    /// What the paper's figure shows; and to tell causes apart, the same postures of the hand that
    /// was trained on, and postures that were trained on.
    fn all(described: &Described) -> [Self; 3] {
        let named: Vec<Pose> = NAMED[..POSTURES].iter().map(Posture::pose).collect();
        let frames = described.poses.iter().step_by(described.poses.len() / POSTURES);
        let frames = frames.take(POSTURES).copied().collect();
        let subject = |words, postures, change| Self { words, postures, change };
        [
            subject("new postures, changed hand", named.clone(), Change::Everything),
            subject("new postures, hand as trained", named, Change::Nothing),
            subject("trained postures, changed hand", frames, Change::Everything),
        ]
    }

    /// All pictures: draw by draw, and in each θ_Z by θ_Z.
    fn scenes(&self, lab: &Lab<'_>) -> Vec<Scene> {
        (0..DRAWS * SHEET).map(|number| self.scene(lab, number)).collect()
    }

    fn scene(&self, lab: &Lab<'_>, number: usize) -> Scene {
        let mut pose = self.postures[number % POSTURES];
        pose[Dof::ThetaZ] = THETA_Z_DEG[number / POSTURES % THETA_Z_DEG.len()].to_radians();
        if self.change == Change::Nothing {
            return Scene::nominal(&lab.rig, &lab.hand, pose);
        }
        let mut random = ItemRng::new(PLACES, number as u64);
        for dof in [Dof::TX, Dof::TY, Dof::TZ] {
            pose[dof] = random.between(-15.0, 15.0);
        }
        let scale = random.between(0.85, 1.15);
        let hand = lab.hand.scaled(|| scale);
        let damage = Augmentation {
            hands: ShapeVariation::Each { spread: 0.1 },
            camera_roll: 20_f64.to_radians(),
            ..Augmentation::NONE
        };
        damage.scene(&lab.rig, &hand, pose, DAMAGES, number)
    }
}

/// The neighbours that one choice of cameras finds.
struct Found {
    words: &'static str,
    subject: &'static str,
    reference: Reference,
    /// The training poses, by their numbers.
    neighbours: Vec<usize>,
    /// Means over the pictures, degrees.
    error_deg: f64,
    theta_z_deg: f64,
}

fn run(lab: &Lab<'_>) -> Result<Finding> {
    let described = lab.complex()?;
    let subjects = Subject::all(described);
    let pictures = subjects.each_ref().map(|subject| subject.scenes(lab));
    let mut found = Vec::new();
    for (subject, scenes) in subjects.iter().zip(&pictures) {
        found.extend(search(lab, described, subject.words, scenes)?);
    }
    let [one, three] = [&found[0], &found[1]];
    let reference = one.reference;
    let halfway = f64::midpoint(reference.random_deg, reference.best_deg);
    let mut claims = vec![one.error_deg < halfway, three.error_deg < one.error_deg];
    let mut sentence = format!(
        "The neighbour's joint angles are off by {:.1}° with one view and {:.1}° with three, where a \
         random training pose is off by {:.1}° and the best one by {:.1}°",
        one.error_deg, three.error_deg, reference.random_deg, reference.best_deg
    );
    let mut tables = vec![table(&found)];
    let mut figures = vec![Figure::picture(
        "Four blocks, θ_Z = 0°, 30°, 60° and 90°. In each, from above: the hand in the picture \
         (white), the training pose nearest by the top view alone (blue), and by three views \
         (orange).",
        &sheet(lab, described, &pictures[0], [one, three])?,
    )?];
    let mut rows: Vec<_> = found.iter().map(Found::json).collect();
    let mut notes = vec![
        format!(
            "{POSTURES} postures from {} sides, each {DRAWS} times: with other bones and radii \
                 (each within 1 ± 0.1), scaled by up to 15 %, moved by up to 15 mm, every camera \
                 rolled by up to 20°. A neighbour looks like the hand when it is nearer to the best \
                 training pose than to a random one.",
            THETA_Z_DEG.len()
        ),
        where_the_error_is_from(&found),
    ];
    let digits = lab.data.map(|data| data.join("digits"));
    if digits.as_ref().is_some_and(|folder| !folder.is_dir()) {
        notes.push("There are no photographs of digits; their part is left out.".to_owned());
    }
    if let Some(folder) = digits.filter(|folder| folder.is_dir()) {
        let real = digits_out::run(lab, &folder)?;
        claims.push(real.holds);
        sentence = format!("{sentence}; {}", real.sentence);
        tables.extend(real.tables);
        figures.push(real.figure);
        notes.push(real.note);
        rows.extend(real.rows);
    }
    Ok(Finding {
        verdict: Verdict::of(&claims),
        sentence: sentence + ".",
        notes,
        tables,
        figures,
        json: json!({ "rows": rows }),
    })
}

/// What new postures and what changes cost, each by itself.
fn where_the_error_is_from(found: &[Found]) -> String {
    let [new, changed] = [&found[3], &found[5]];
    let costlier = if new.error_deg > changed.error_deg { "postures" } else { "changes" };
    format!(
        "Where the error is from: new postures of the hand and the cameras as trained are off by \
         {:.1}° and {:.1}° (the best training pose by {:.1}°); postures of the training, changed as \
         above, by {:.1}° with one view and {:.1}° with three (a random pose by {:.1}°). With three \
         views it is the new {costlier} that cost more.",
        found[2].error_deg,
        new.error_deg,
        new.reference.best_deg,
        found[4].error_deg,
        changed.error_deg,
        changed.reference.random_deg
    )
}

/// The neighbours of all pictures, with one view and with all.
fn search(
    lab: &Lab<'_>,
    described: &Described,
    subject: &'static str,
    scenes: &[Scene],
) -> Result<Vec<Found>> {
    let list = SceneList(scenes.to_vec());
    let contexts = describe_each(&lab.rig, &list, OrientationRule::HandAxis, lab.progress)?;
    let contexts = contexts.into_iter().collect::<phalanx::Result<Vec<PoseContexts>>>()?;
    let reference = Reference::of(described, scenes);
    let with_views = |(words, views): (&'static str, Vec<usize>)| {
        let (codebooks, train) = described.whole(&views, 0)?;
        let seen: Vec<Vec<&[f32]>> = contexts
            .iter()
            .map(|all| views.iter().map(|&view| all[view].as_slice()).collect())
            .collect();
        let queries = descriptors(&codebooks, &seen)?;
        let neighbours = nearest_by_chi_squared(train.x.as_ref(), queries.as_ref());
        let of_all = |error: fn(&Pose, &Pose) -> f64| {
            let errors = neighbours.iter().zip(scenes);
            errors.map(|(&i, scene)| error(&described.poses[i], &scene.pose)).sum::<f64>()
                / scenes.len() as f64
        };
        let (error_deg, theta_z_deg) = (of_all(joint_error_deg), of_all(theta_z_error_deg));
        Ok(Found { words, subject, reference, neighbours, error_deg, theta_z_deg })
    };
    lab.one_and_all()?.into_iter().map(with_views).collect()
}

/// Mean difference of the 20 internal angles, degrees.
fn joint_error_deg(a: &Pose, b: &Pose) -> f64 {
    let internal = Dof::ALL.into_iter().filter(|dof| dof.is_internal());
    internal.map(|dof| (a[dof] - b[dof]).abs().to_degrees()).sum::<f64>() / Dof::INTERNAL as f64
}

fn theta_z_error_deg(a: &Pose, b: &Pose) -> f64 {
    (a[Dof::ThetaZ] - b[Dof::ThetaZ]).abs().to_degrees()
}

/// What a neighbour's error is to be compared with, degrees.
#[derive(Clone, Copy)]
struct Reference {
    /// Of a training pose taken blindly.
    random_deg: f64,
    /// Of the training pose with the most similar angles.
    best_deg: f64,
}

impl Reference {
    fn of(described: &Described, scenes: &[Scene]) -> Self {
        let (mut random_deg, mut best_deg) = (0.0, 0.0);
        for scene in scenes {
            let errors = || described.poses.iter().map(|pose| joint_error_deg(pose, &scene.pose));
            random_deg += errors().sum::<f64>() / described.poses.len() as f64;
            best_deg += errors().fold(f64::INFINITY, f64::min);
        }
        let count = scenes.len() as f64;
        Self { random_deg: random_deg / count, best_deg: best_deg / count }
    }
}

impl Found {
    fn json(&self) -> serde_json::Value {
        let Reference { random_deg, best_deg } = self.reference;
        json!({
            "pictures": self.subject, "views": self.words, "joint_error_deg": self.error_deg,
            "theta_z_error_deg": self.theta_z_deg, "random_pose_deg": random_deg,
            "best_pose_deg": best_deg,
        })
    }
}

fn table(found: &[Found]) -> Table {
    let header = ["pictures", "views", "joint angles", "a random pose", "the best pose", "θ_Z"];
    let mut table =
        Table::new("Mean errors of the nearest training pose and of others, degrees.", header);
    for Found { words, subject, reference, error_deg, theta_z_deg, .. } in found {
        let errors = [*error_deg, reference.random_deg, reference.best_deg, *theta_z_deg];
        let cells = errors.map(|degrees| format!("{degrees:.1}"));
        table.row([(*subject).to_owned(), (*words).to_owned()].into_iter().chain(cells));
    }
    table
}

/// The first draw's pictures from above, each over its two neighbours; one block for each θ_Z.
fn sheet(
    lab: &Lab<'_>,
    described: &Described,
    scenes: &[Scene],
    found: [&Found; 2],
) -> Result<RgbImage> {
    const COLOURS: [[u8; 3]; 2] = [[86, 180, 233], [230, 159, 0]];
    let view = lab.single()?;
    let camera = &lab.rig.cameras[view];
    let of_scene = |scene: &Scene, colour: [u8; 3]| -> Result<RgbImage> {
        let rest = &scene.views[view].rest;
        Ok(tinted(&draw_silhouette(camera, &scene.hand, &scene.pose, rest)?, colour))
    };
    let mut blocks = Vec::new();
    for start in (0..SHEET).step_by(POSTURES) {
        let block = start..start + POSTURES;
        let mut panels = scenes[block.clone()]
            .iter()
            .map(|scene| of_scene(scene, [235, 235, 235]))
            .collect::<Result<Vec<_>>>()?;
        for (found, colour) in found.iter().zip(COLOURS) {
            for &neighbour in &found.neighbours[block.clone()] {
                let scene = Scene::nominal(&lab.rig, &lab.hand, described.poses[neighbour]);
                panels.push(of_scene(&scene, colour)?);
            }
        }
        blocks.push(mosaic(&panels, POSTURES as u32, 3));
    }
    Ok(mosaic(&blocks, 1, 18))
}
