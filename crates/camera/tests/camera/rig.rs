//! The fixture, and every contradiction that a rig file can hold.

use glam::{DAffine3, DVec2, DVec3};
use phalanx_camera::{Error, Fisheye, Rig};

const DESK: &str = include_str!("../../fixtures/desk.toml");

const VOLUME: &str = "
    [volume]
    center_mm = [0, 0, 0]
    size_mm = [100, 100, 100]
    forearm = [0, 0, 1]
    up = [0, 1, 0]
";

const CAMERA: &str = "
    [[camera]]
    name = \"top\"
    width = 120
    height = 90
    focal_px = 265
    position_mm = [0, 700, 0]
    look_at_mm = [0, 0, 0]
    up = [1, 0, 0]
";

/// A rig of one camera, with some lines replaced.
fn edited(edits: &[(&str, &str)]) -> Result<Rig, Error> {
    let mut text = VOLUME.to_owned() + CAMERA;
    for (from, to) in edits {
        assert!(text.contains(from), "{from} is not in the text");
        text = text.replace(from, to);
    }
    Rig::from_toml(&text)
}

fn posed(rotation: &str) -> Result<Rig, Error> {
    let posed = format!("rotation = {rotation}\n translation_mm = [0, 0, 700]");
    edited(&[
        ("position_mm = [0, 700, 0]", &posed),
        ("look_at_mm = [0, 0, 0]", ""),
        ("up = [1, 0, 0]", ""),
    ])
}

#[test]
fn desk_cameras_are_one_camera_turned_about_the_forearm() {
    let desk = Rig::from_toml(DESK).unwrap();
    let names: Vec<&str> = desk.cameras.iter().map(|camera| camera.name.as_str()).collect();
    assert_eq!(names, ["side", "top", "other_side"]);
    assert_eq!(desk.volume.rest_frame(), DAffine3::IDENTITY);
    let point = DVec3::new(30.0, -10.0, 120.0);
    let top = desk.camera("top").unwrap().project(point).unwrap();
    for (name, degrees) in [("side", -70.0f64), ("top", 0.0), ("other_side", 70.0)] {
        let camera = desk.camera(name).unwrap();
        let turned = DAffine3::from_rotation_z(degrees.to_radians()).transform_point3(point);
        assert!((camera.project(turned).unwrap() - top).length() < 1e-3, "{name}");
        let ahead = camera.project(DVec3::Z * 180.0).unwrap();
        let wrist = camera.project(DVec3::ZERO).unwrap();
        assert!(ahead.x > wrist.x && (ahead.y - wrist.y).abs() < 1e-9, "{name}");
        let away = (camera.centre() - DVec3::Z * 70.0).length();
        assert!((away - 700.0).abs() < 1e-3, "{name}: {away}");
    }
}

#[test]
fn files_say_the_same_in_both_ways() {
    let looking = edited(&[]).unwrap();
    let camera = &looking.cameras[0];
    assert!((camera.centre() - DVec3::new(0.0, 700.0, 0.0)).length() < 1e-9);
    assert_eq!(camera.project(DVec3::ZERO), Some(DVec2::new(60.0, 45.0)));
    // Image right is +Z, image down is −X, the view is −Y.
    assert_eq!(posed("[[0, 0, 1], [-1, 0, 0], [0, -1, 0]]").unwrap(), looking);
    let optional = "focal_px = [265.0, 265]\n principal_point_px = [60, 45]\n \
                    distortion = [0, 0, 0, 0, 0]";
    assert_eq!(edited(&[("focal_px = 265", optional)]).unwrap(), looking);
}

#[test]
fn select_keeps_the_order_asked_for() {
    let desk = Rig::from_toml(DESK).unwrap();
    let two = desk.select(&["other_side", "side"]).unwrap();
    assert_eq!(two.cameras, [desk.cameras[2].clone(), desk.cameras[0].clone()]);
    assert!(
        matches!(desk.select(&["left"]), Err(Error::UnknownCamera { name, .. }) if name == "left")
    );
    assert!(matches!(desk.select(&["top", "top"]), Err(Error::DuplicateName { .. })));
    assert!(matches!(desk.select(&[""; 0]), Err(Error::NoCamera)));
}

/// Asserts that a rig is refused with this error, of the camera `top` where it names one.
macro_rules! refused {
    ($rig:expr, $variant:pat) => {
        match $rig {
            Err(error @ $variant) => {
                let message = error.to_string();
                assert!(
                    message.contains("camera `top`") || message.starts_with("volume"),
                    "{message}"
                );
            }
            other => panic!("{other:?} is not {}", stringify!($variant)),
        }
    };
}

#[test]
fn contradictory_cameras_are_refused_by_name() {
    let twice = VOLUME.to_owned() + CAMERA + CAMERA;
    refused!(Rig::from_toml(&twice), Error::DuplicateName { .. });
    assert_eq!(Rig::from_toml(VOLUME), Err(Error::NoCamera));
    for name in ["", "../top", ".", "a b", "a/b"] {
        let edit = format!("name = \"{name}\"");
        let rig = edited(&[("name = \"top\"", &edit)]);
        assert_eq!(rig, Err(Error::Name { camera: name.to_owned() }));
    }
    for size in ["width = 0", "width = 16385", "width = 4294967295"] {
        refused!(edited(&[("width = 120", size)]), Error::ImageSize { .. });
    }
    for focal in ["0", "-265", "nan", "inf", "[265, 0]", "1e9"] {
        let focal = format!("focal_px = {focal}");
        refused!(edited(&[("focal_px = 265", &focal)]), Error::FocalLength { .. });
    }
    let middle =
        |c: &str| edited(&[("width = 120", &format!("width = 120\n principal_point_px = {c}"))]);
    refused!(middle("[121, 45]"), Error::PrincipalPoint { .. });
    refused!(middle("[60, nan]"), Error::NotFinite { field: "principal_point_px", .. });
    let lens = |k: &str| edited(&[("width = 120", &format!("width = 120\n distortion = {k}"))]);
    refused!(lens("[nan, 0, 0, 0, 0]"), Error::NotFinite { field: "distortion", .. });
    for other in ["[0.1]", "[0.1, 0, 0]", "[0, 0, 0, 0, 0, 0]"] {
        refused!(lens(other), Error::DistortionCount { .. });
    }
}

/// A lens is refused where it folds over before the hand, and nowhere else.
#[test]
fn lenses_may_fold_over_where_no_hand_works() {
    let lens = |k1: f64, size: f64| {
        let size = format!("size_mm = [{size}, {size}, {size}]");
        let distortion = format!("width = 120\n distortion = [{k1}, 0, 0, 0, 0]");
        edited(&[("size_mm = [100, 100, 100]", &size), ("width = 120", &distortion)])
    };
    // The volume's nearest corners are at a radius of √2 · 50 / 650 = 0.109; the sides of the picture
    // at 0.226 and 0.170. r (1 + k1 r²) turns back at r = 1 / √(−3 k1).
    for k1 in [-2.0, -10.0, -25.0] {
        let rig = lens(k1, 100.0).unwrap();
        assert_eq!(rig.cameras[0].unproject(DVec2::ZERO), None, "{k1}");
        assert_eq!(Rig::from_toml(&rig.to_toml().unwrap()), Ok(rig));
    }
    refused!(lens(-30.0, 100.0), Error::Folding { .. });
    assert!(lens(-30.0, 80.0).is_ok());
    // A volume that reaches far beyond the picture, and a fold out of the picture's sight.
    assert!(lens(-1.0, 600.0).is_ok());
}

/// A much-used toolkit's sample: 1280 px wide, the fold 85 px within its sides.
#[test]
fn a_fold_at_the_sides_leaves_the_hand_in_the_middle() {
    let rig = edited(&[
        ("width = 120", "width = 1280\n distortion = [-0.285, 0, 0, 0, 0]"),
        ("height = 90", "height = 720"),
        ("focal_px = 265", "focal_px = 770"),
    ]);
    let camera = &rig.unwrap().cameras[0];
    assert_eq!(camera.unproject(DVec2::new(1270.0, 360.0)), None);
    let ray = camera.unproject(DVec2::new(1100.0, 360.0)).unwrap();
    let back = camera.project(ray.origin + ray.direction * 700.0).unwrap();
    assert!((back - DVec2::new(1100.0, 360.0)).length() < 1e-6);
}

#[test]
fn lenses_are_read_and_written_by_name() {
    let lens = |lines: &str| edited(&[("width = 120", &format!("width = 120\n {lines}"))]);
    let wide = lens("lens = \"fisheye\"\n distortion = [-0.01, 0.002, 0, 0.001]").unwrap();
    let fisheye = Fisheye { k1: -0.01, k2: 0.002, k3: 0.0, k4: 0.001 };
    assert_eq!(wide.cameras[0].intrinsics.lens, fisheye.into());
    assert_eq!(Rig::from_toml(&wide.to_toml().unwrap()), Ok(wide));
    refused!(
        lens("lens = \"fisheye\"\n distortion = [1, 0, 0, 0, 0]"),
        Error::DistortionCount { .. }
    );
    let four = lens("distortion = [-0.1, 0.02, 0, 0]").unwrap();
    assert_eq!(four, lens("lens = \"perspective\"\n distortion = [-0.1, 0.02, 0, 0, 0]").unwrap());
    assert!(four.to_toml().unwrap().contains("distortion = [-0.1, 0.02, 0.0, 0.0, 0.0]\n"));
    let rational = lens("distortion = [0.1, 0, 0, 0, 0, 0.2, 0.1, 0]").unwrap();
    assert_eq!(rational.cameras[0].intrinsics.lens.coefficients().len(), 8);
    assert_eq!(Rig::from_toml(&rational.to_toml().unwrap()), Ok(rational));
    assert!(
        matches!(lens("lens = \"omni\""), Err(Error::Toml { message }) if message.contains("omni"))
    );
    refused!(
        lens("distortion = [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1.6, 0]"),
        Error::NotFinite { .. }
    );
}

#[test]
fn contradictory_poses_are_refused_by_name() {
    let position = "position_mm = [0, 700, 0]";
    refused!(edited(&[(position, "")]), Error::Pose { .. });
    let both = format!("{position}\n translation_mm = [0, 0, 700]");
    refused!(edited(&[(position, &both)]), Error::Pose { .. });
    refused!(edited(&[(position, "position_mm = [0, 0, 0]")]), Error::LookAtIsPosition { .. });
    refused!(
        edited(&[(position, "position_mm = [0, nan, 0]")]),
        Error::NotFinite { field: "position_mm", .. }
    );
    for up in ["[0, 1, 0]", "[0, -3, 0]", "[0, 0, 0]"] {
        let up = format!("up = {up}");
        refused!(edited(&[("up = [1, 0, 0]", &up)]), Error::UpAlongView { .. });
    }
    refused!(posed("[[0, 0, 1], [-1, 0, 0], [0, -1.01, 0]]"), Error::NotOrthonormal { .. });
    refused!(posed("[[0, 0, 1], [-1, 0, 0], [0, -1, inf]]"), Error::NotFinite { .. });
    refused!(posed("[[0, 0, 1], [1, 0, 0], [0, -1, 0]]"), Error::Reflection { .. });
}

#[test]
fn volumes_that_make_no_sense_are_refused_by_name() {
    let center = "center_mm = [0, 0, 0]";
    refused!(edited(&[(center, "center_mm = [0, 800, 0]")]), Error::VolumeBehind { .. });
    refused!(edited(&[(center, "center_mm = [0, 0, 300]")]), Error::VolumeOutside { .. });
    refused!(edited(&[(center, "center_mm = [0, 0, inf]")]), Error::VolumeField { .. });
    let size = "size_mm = [100, 100, 100]";
    refused!(edited(&[(size, "size_mm = [100, 0, 100]")]), Error::VolumeField { .. });
    refused!(
        edited(&[("forearm = [0, 0, 1]", "forearm = [0, 0, 0]")]),
        Error::VolumeField { field: "forearm" }
    );
    refused!(
        edited(&[("forearm = [0, 0, 1]", "forearm = [0, -2, 0]")]),
        Error::VolumeUpAlongForearm
    );
    refused!(
        edited(&[("position_mm = [0, 700, 0]", "position_mm = [1e308, 1e308, 1e308]")]),
        Error::VolumeBehind { .. } | Error::LookAtIsPosition { .. } | Error::NotFinite { .. }
    );
}

#[test]
fn a_hand_is_as_large_as_focal_length_and_distance_say() {
    let desk = Rig::from_toml(DESK).unwrap();
    for (scale, camera) in desk.view_scales().unwrap().iter().zip(&desk.cameras) {
        let away = (camera.centre() - desk.volume.center).length();
        assert!((scale.distance - away).abs() < 1e-9);
        // A little off the axis, by 70 in 700 mm, the picture is enlarged by 1 / cos^1.5 of the angle.
        let expected = camera.intrinsics.fx / away * (away / 700.0).powf(1.5);
        assert!((scale.px_per_mm / expected - 1.0).abs() < 1e-3, "{scale:?} is not {expected}");
    }
    let angles: Vec<f64> =
        desk.view_angles().iter().map(|a| a.angle.to_degrees().round()).collect();
    assert_eq!(angles, [70.0, 138.0, 70.0]);
}

#[test]
fn absurd_sizes_of_hands_are_refused_by_name() {
    let with_height = |mm: &str| {
        let at = format!("position_mm = [0, {mm}, 0]");
        edited(&[("position_mm = [0, 700, 0]", &at)]).unwrap().view_scales()
    };
    for (height, length) in [("20", "2518 px"), ("9000", "6 px")] {
        let message = with_height(height).unwrap_err().to_string();
        assert!(message.contains("camera `top`") && message.contains(length), "{message}");
    }
    assert!(with_height("120").is_ok() && with_height("3500").is_ok());
}

#[test]
fn keys_are_checked() {
    for (from, to, word) in [
        ("width = 120", "widht = 120", "widht"),
        ("width = 120", "width = -1", "-1"),
        ("[volume]", "[volume]\n colour = 1", "colour"),
        ("focal_px = 265", "", "focal_px"),
        ("size_mm = [100, 100, 100]", "", "size_mm"),
    ] {
        match edited(&[(from, to)]) {
            Err(Error::Toml { message }) => assert!(message.contains(word), "{message}"),
            other => panic!("{other:?}"),
        }
    }
}
