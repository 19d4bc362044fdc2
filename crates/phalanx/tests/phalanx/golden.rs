//! Pictures of a hand that must not change unnoticed: `fixtures/golden/`. With the environment
//! variable `PHALANX_REGENERATE=1` they are drawn anew and then compared.

use std::io::Cursor;
use std::path::PathBuf;

use image::{DynamicImage, ImageFormat};
use phalanx::draw_silhouette;
use phalanx_camera::Rig;
use phalanx_hand::{Digit, Dof, HandShape, Pose, Side};
use phalanx_render::{Appearance, Renderer};

/// A silhouette's pixels whose centre lies on the outline may differ from one CPU to another.
const BOUNDARY_PIXELS: usize = 3;

fn folder() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/golden"))
}

fn rig() -> Rig {
    Rig::from_toml(include_str!("../../fixtures/desk.toml")).unwrap()
}

fn posed(degrees: &[(Dof, f64)]) -> Pose {
    let mut pose = Pose::REST;
    for &(dof, value) in degrees {
        pose[dof] = value.to_radians();
    }
    pose
}

/// Index finger and thumb stretched, the others closed, the hand half turned up.
fn pointing() -> Pose {
    let mut pose = posed(&[(Dof::ThetaZ, 40.0), (Dof::ThumbAbduction, 20.0)]);
    for finger in [Digit::Middle, Digit::Ring, Digit::Little] {
        for (dof, degrees) in finger.dofs().into_iter().zip([0.0_f64, 70.0, 95.0, 60.0]) {
            pose[dof] = degrees.to_radians();
        }
    }
    pose
}

fn hand(side: Side) -> HandShape {
    HandShape { side, ..HandShape::adult() }
}

/// The pictures by name: every pose in every camera, and the left hand from above.
fn silhouettes() -> Vec<(String, DynamicImage)> {
    let (rig, flat, pointing) = (rig(), Pose::REST, pointing());
    let rest = rig.volume.rest_frame();
    let mut pictures = Vec::new();
    for camera in &rig.cameras {
        for (name, side, pose) in [
            ("flat", Side::Right, &flat),
            ("pointing", Side::Right, &pointing),
            ("pointing-left", Side::Left, &pointing),
        ] {
            let mask = draw_silhouette(camera, &hand(side), pose, &rest).unwrap();
            pictures.push((format!("{name}-{}.png", camera.name), mask.into()));
        }
    }
    pictures
}

fn photograph() -> (String, DynamicImage) {
    let rig = rig();
    let camera = rig.camera("top").unwrap();
    let camera = camera.with_intrinsics(camera.intrinsics.resized(160, 120));
    let solids = hand(Side::Right).pose(&pointing(), &rig.volume.rest_frame()).primitives;
    let mut renderer = Renderer::new(&camera).unwrap();
    let picture = renderer.shade(&solids, &Appearance::default(), 2006).unwrap();
    ("photograph-top.png".to_owned(), picture.into())
}

/// The stored picture of this name; drawn anew first, if that is asked for.
fn stored(name: &str, drawn: &DynamicImage) -> DynamicImage {
    let path = folder().join(name);
    if std::env::var_os("PHALANX_REGENERATE").is_some_and(|value| value == "1") {
        let mut png = Cursor::new(Vec::new());
        drawn.write_to(&mut png, ImageFormat::Png).unwrap();
        std::fs::create_dir_all(folder()).unwrap();
        std::fs::write(&path, png.get_ref()).unwrap();
    }
    let bytes = std::fs::read(&path).unwrap_or_else(|error| {
        panic!("{}: {error}; PHALANX_REGENERATE=1 makes it", path.display())
    });
    image::load_from_memory(&bytes).unwrap()
}

#[test]
fn pictures_are_as_stored() {
    silhouettes_are_as_stored();
    the_photograph_is_as_stored();
    nothing_else_is_stored();
}

fn silhouettes_are_as_stored() {
    for (name, drawn) in silhouettes() {
        let (stored, drawn) = (stored(&name, &drawn).to_luma8(), drawn.to_luma8());
        assert_eq!(stored.dimensions(), (120, 90), "{name}");
        let differing = drawn.iter().zip(stored.iter()).filter(|(a, b)| a != b).count();
        assert!(differing <= BOUNDARY_PIXELS, "{name}: {differing} pixels differ");
    }
}

fn the_photograph_is_as_stored() {
    let (name, drawn) = photograph();
    let (stored, drawn) = (stored(&name, &drawn).to_rgb8(), drawn.to_rgb8());
    assert_eq!(stored.dimensions(), (160, 120));
    // The last bit of a logarithm can move a level by one; at the outline a sample can be lost.
    let off = drawn.iter().zip(stored.iter()).filter(|(a, b)| a.abs_diff(**b) > 1).count();
    assert!(off <= 30, "{off} of {} levels differ", drawn.len());
}

fn nothing_else_is_stored() {
    let mut expected: Vec<_> = silhouettes().into_iter().map(|(name, _)| name).collect();
    expected.push(photograph().0);
    expected.sort();
    let name = |entry: std::io::Result<std::fs::DirEntry>| {
        entry.unwrap().file_name().into_string().unwrap()
    };
    let mut found: Vec<_> = std::fs::read_dir(folder()).unwrap().map(name).collect();
    found.sort();
    assert_eq!(found, expected);
}
