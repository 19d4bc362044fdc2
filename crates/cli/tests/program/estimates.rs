//! What the program prints and draws.

use image::{DynamicImage, GrayImage, ImageEncoder, ImageFormat, Luma, RgbImage, imageops};
use phalanx::Estimator;
use phalanx_hand::{Dof, Unit};
use serde_json::Value;

use crate::desk::{CAMERAS, Desk, Outcome, closing, run};

const MASKS: [&str; 3] = ["--mask", "side-mask.png", "top-mask.png"];
const PHOTOGRAPHS: [&str; 2] = ["side.png", "top.png"];

/// Checks that it went well and without a word on standard error.
fn well(outcome: Outcome) -> String {
    assert_eq!((outcome.code, outcome.err.as_str()), (Some(0), ""));
    outcome.out
}

fn json(desk: &Desk, arguments: &[&str]) -> Value {
    serde_json::from_str(&well(desk.estimate(&[&["--json"], arguments].concat()))).unwrap()
}

/// Whether the training poses vary a number.
fn learnt(dof: Dof) -> bool {
    closing(0.0)[dof] != closing(1.0)[dof]
}

/// A number of the pose, as the JSON has it.
fn value(report: &Value, dof: Dof) -> f64 {
    report["pose"][dof.name()]["value"].as_f64().unwrap()
}

#[test]
fn json_holds_the_pose_the_joints_and_the_views() {
    let desk = Desk::new();
    for pictures in [&MASKS[..], &PHOTOGRAPHS] {
        let report = json(&desk, pictures);
        assert_eq!(report["pose"].as_object().unwrap().len(), 28);
        for dof in Dof::ALL {
            let figure = &report["pose"][dof.name()];
            let unit = if dof.unit() == Unit::Angle { "deg" } else { "mm" };
            assert_eq!(figure["unit"], unit, "{dof}");
            let std = &figure["std"];
            assert!(if learnt(dof) { std.as_f64() > Some(0.0) } else { std.is_null() }, "{dof}");
            assert_eq!(figure["interval_95"].as_f64().is_some(), learnt(dof), "{dof}");
            let truth = dof.unit().to_file(closing(0.5)[dof]);
            assert!((value(&report, dof) - truth).abs() < 12.0, "{dof}: {figure} for {truth}");
        }
        let joints = report["joints_mm"].as_array().unwrap();
        assert_eq!(joints.len(), 21);
        assert!(joints.iter().all(|joint| joint.as_array().unwrap().len() == 3));
        let views = report["views"].as_array().unwrap();
        assert_eq!(views.len(), 2);
        for (view, camera) in views.iter().zip(CAMERAS) {
            assert_eq!(view["camera"], camera);
            assert_eq!(
                (&view["forearm"], &view["border_crossings"]),
                (&"border".into(), &1.into())
            );
        }
    }
}

#[test]
fn the_pose_is_written_in_its_order() {
    let desk = Desk::new();
    let text = well(desk.estimate(&[&["--json"], &MASKS[..]].concat()));
    let places: Vec<_> = Dof::ALL.map(|dof| text.find(&format!("\"{dof}\"")).unwrap()).into();
    assert!(places.is_sorted());
}

#[test]
fn the_table_has_a_line_for_each_number() {
    let desk = Desk::new();
    let table = well(desk.estimate(&MASKS));
    let report = json(&desk, &MASKS);
    assert_eq!(table.lines().count(), 28);
    for (line, dof) in table.lines().zip(Dof::ALL) {
        let words: Vec<_> = line.split_whitespace().collect();
        assert_eq!((words[0], words.len()), (dof.name(), 5), "{line}");
        assert_eq!(words[2] == "±", learnt(dof), "{line}");
        assert_eq!(line.ends_with(", not learnt"), !learnt(dof), "{line}");
        let printed: f64 = words[1].parse().unwrap();
        assert!((printed - value(&report, dof)).abs() < 0.051, "{line}");
    }
}

#[test]
fn a_repeated_run_prints_the_same() {
    let desk = Desk::new();
    let arguments = [&["--json"], &PHOTOGRAPHS[..]].concat();
    assert_eq!(well(desk.estimate(&arguments)), well(desk.estimate(&arguments)));
}

#[test]
fn one_picture_may_serve_two_cameras() {
    let desk = Desk::new();
    let outcome = desk.estimate(&["--mask", "top-mask.png", "top-mask.png"]);
    assert_eq!((outcome.code, outcome.out.lines().count()), (Some(0), 28));
}

#[test]
fn an_overlay_shows_the_pictures_side_by_side_and_what_was_seen() {
    let desk = Desk::new();
    let plain = well(desk.estimate(&PHOTOGRAPHS));
    desk.write("seen.png", b"an older file");
    let drawn = well(desk.estimate(&["side.png", "top.png", "--overlay", "seen.png"]));
    assert_eq!(plain, drawn);
    let overlay = desk.open("seen.png").to_rgb8();
    assert_eq!(overlay.dimensions(), (640, 240));
    let count = |colour: [u8; 3]| overlay.pixels().filter(|pixel| pixel.0 == colour).count();
    assert!(count([40, 220, 90]) > 500, "the contour that was seen");
    assert!(count([255, 210, 0]) > 50, "the forearm's axis");
    assert!(count([230, 40, 160]) > 200, "the hand that was estimated");
    // Far from the hand the photographs are as they were.
    let corner = desk.open("top.png").to_rgb8();
    assert_eq!(overlay.get_pixel(320, 0), corner.get_pixel(0, 0));
    assert!(desk.listing().iter().all(|name| !name.starts_with(".tmp")));
}

#[cfg(unix)]
#[test]
fn an_overlay_is_as_readable_as_any_new_file() {
    use std::os::unix::fs::PermissionsExt;
    let desk = Desk::new();
    well(desk.estimate(&["side.png", "top.png", "--overlay", "seen.png"]));
    let mode = |name| std::fs::metadata(desk.path(name)).unwrap().permissions().mode();
    assert_eq!(mode("seen.png"), mode("model"));
}

#[test]
fn a_crop_looks_at_its_window_only() {
    let desk = Desk::new();
    for camera in CAMERAS {
        let mut wide = RgbImage::from_pixel(500, 300, image::Rgb([84, 98, 112]));
        // What is outside the window would be taken for the hand.
        for (x, _, pixel) in wide.enumerate_pixels_mut() {
            if x > 450 {
                pixel.0 = [224, 172, 140];
            }
        }
        let photograph = desk.open(&format!("{camera}.png")).to_rgb8();
        imageops::replace(&mut wide, &photograph, 100, 30);
        desk.save(&format!("{camera}-wide.png"), &wide.into());
    }
    let arguments =
        ["side-wide.png", "top-wide.png", "--crop", "100,30,320,240", "--overlay", "seen.png"];
    assert_eq!(well(desk.estimate(&arguments)), well(desk.estimate(&PHOTOGRAPHS)));
    assert_eq!(desk.open("seen.png").to_rgb8().dimensions(), (640, 240));
}

#[test]
fn a_turned_camera_is_turned_back() {
    let desk = Desk::new();
    let expected = well(desk.estimate(&PHOTOGRAPHS));
    for camera in CAMERAS {
        // Stored upside down, with a note that says so: orientation 3 in a one-entry EXIF block.
        let exif = b"MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x03\0\0\0\0\0\0";
        let turned = imageops::rotate180(&desk.open(&format!("{camera}.png")).to_rgb8());
        let mut png = Vec::new();
        let mut encoder = image::codecs::png::PngEncoder::new(&mut png);
        encoder.set_exif_metadata(exif.to_vec()).unwrap();
        let size = turned.dimensions();
        encoder.write_image(&turned, size.0, size.1, image::ExtendedColorType::Rgb8).unwrap();
        desk.write(&format!("{camera}-turned.png"), &png);
    }
    assert_eq!(well(desk.estimate(&["side-turned.png", "top-turned.png"])), expected);
}

#[test]
fn other_formats_and_depths_are_read() {
    let desk = Desk::new();
    let expected = well(desk.estimate(&MASKS));
    for camera in CAMERAS {
        let mask = desk.open(&format!("{camera}-mask.png"));
        desk.save(&format!("{camera}-rgba16.png"), &DynamicImage::ImageRgba16(mask.to_rgba16()));
        // A wrong name: the content decides.
        mask.save_with_format(desk.path(&format!("{camera}.jpg")), ImageFormat::Pnm).unwrap();
        // The same photograph, lossy.
        desk.save(&format!("{camera}.jpeg"), &desk.open(&format!("{camera}.png")));
    }
    well(desk.estimate(&["side.jpeg", "top.jpeg"]));
    assert_eq!(well(desk.estimate(&["--mask", "side-rgba16.png", "top-rgba16.png"])), expected);
    assert_eq!(well(desk.estimate(&["--mask", "side.jpg", "top.jpg"])), expected);
}

#[test]
fn what_follows_a_jpeg_is_not_looked_at() {
    let desk = Desk::new();
    desk.save("top.jpg", &desk.open("top.png"));
    let expected = well(desk.estimate(&["side.png", "top.jpg"]));
    desk.write("top.jpg", &[&desk.read("top.jpg")[..], b"a film \xff\xda and more"].concat());
    assert_eq!(well(desk.estimate(&["side.png", "top.jpg"])), expected);
}

/// The mask with everything left of a column taken away.
fn cut(mask: &DynamicImage, column: u32) -> GrayImage {
    let mask = mask.to_luma8();
    GrayImage::from_fn(mask.width(), mask.height(), |x, y| {
        if x < column { Luma([0]) } else { *mask.get_pixel(x, y) }
    })
}

#[test]
fn a_forearm_that_stays_inside_is_a_doubt_on_standard_error() {
    let desk = Desk::new();
    desk.save("cut.png", &cut(&desk.open("top-mask.png"), 3).into());
    let outcome = desk.estimate(&["--json", "--mask", "side-mask.png", "cut.png"]);
    assert_eq!(outcome.code, Some(0));
    assert_eq!(
        outcome.err,
        "phalanx: camera 'top': the forearm does not reach the border of the picture; \
         its end was guessed\n"
    );
    let report: Value = serde_json::from_str(&outcome.out).unwrap();
    let view = &report["views"][1];
    assert_eq!((&view["forearm"], &view["border_crossings"]), (&"stump".into(), &0.into()));
}

#[test]
fn a_second_crossing_is_a_doubt_on_standard_error() {
    let desk = Desk::new();
    let mut mask = desk.open("top-mask.png").to_luma8();
    for (x, y) in (60..120).flat_map(|x| (42..46).map(move |y| (x, y))) {
        mask.put_pixel(x, y, Luma([255]));
    }
    desk.save("through.png", &mask.into());
    let outcome = desk.estimate(&["--mask", "side-mask.png", "through.png"]);
    assert_eq!((outcome.code, outcome.out.lines().count()), (Some(0), 28));
    assert!(outcome.err.contains("camera 'top': the hand crosses the border 2 times"));
}

#[test]
fn an_estimate_that_cannot_be_drawn_is_a_doubt_on_standard_error() {
    let desk = Desk::new();
    let model = Estimator::from_bytes(&desk.read("model")).unwrap();
    // The camera comes so near that the wrist fills its image.
    let mut rig = model.rig().clone();
    let wrist = &mut rig.cameras[1].extrinsics.translation;
    (wrist.x, wrist.z) = (0.0, 60.0);
    let (hand, descriptor) = (model.hand().clone(), model.descriptor().clone());
    let near = Estimator::from_parts(rig, hand, descriptor, model.regressor().clone());
    desk.write("model", &near.unwrap().to_bytes().unwrap());
    let outcome = desk.estimate(&[&MASKS[..], &["--overlay", "seen.png"]].concat());
    assert_eq!((outcome.code, outcome.out.lines().count()), (Some(0), 28));
    let doubt = "phalanx: camera 'top': the estimated hand is not drawn: no contour";
    assert!(outcome.err.starts_with(doubt), "{}", outcome.err);
    assert!(desk.path("seen.png").exists());
}

/// Several frames at once, as files and as folders, are the frames one by one.
#[test]
fn several_frames_are_estimated_by_one_run() {
    let desk = Desk::new();
    let names = ["2.png", "10.png", "note.png"];
    for (name, closed) in names.into_iter().zip([0.2, 0.8, 0.4]) {
        desk.draw_frame("takes", name, closed);
    }
    desk.write("takes/top/note.png", b"no picture");
    let at = |name: &str| CAMERAS.map(|camera| format!("takes/{camera}/{name}"));
    let single = |name: &str| {
        let [side, top] = at(name);
        json(&desk, &["--mask", &side, &top])
    };
    let lines = |outcome: &Outcome| -> Vec<Value> {
        outcome.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
    };
    for given in [&["takes"][..], &["takes/side", "takes/top"]] {
        let outcome = desk.estimate(&[&["--mask", "--json"], given].concat());
        assert_eq!(outcome.code, Some(1), "a frame failed: {}", outcome.err);
        let [two, ten, note] = &lines(&outcome)[..] else { panic!("{}", outcome.out) };
        for (line, frame) in [(two, "2"), (ten, "10")] {
            let expected = single(&format!("{frame}.png"));
            assert_eq!((&line["frame"], &line["pose"]), (&frame.into(), &expected["pose"]));
        }
        assert!(note["pose"].is_null() && note["error"].as_str().unwrap().contains("note.png"));
        assert!(outcome.err.contains("phalanx: frame note: "), "{}", outcome.err);
    }
    let files = names[..2].iter().flat_map(|name| at(name)).collect::<Vec<_>>();
    let files: Vec<&str> = ["--mask"].into_iter().chain(files.iter().map(String::as_str)).collect();
    let table = well(desk.estimate(&files));
    assert!(table.starts_with("frame 1\nthumb") && table.contains("\n\nframe 2\nthumb"), "{table}");
    let outcome = desk.estimate(&["--mask", "takes", "--overlay", "seen.png"]);
    assert_eq!(outcome.code, Some(2));
    assert!(outcome.err.contains("--overlay draws one frame; 3 are given"), "{}", outcome.err);
    std::fs::remove_file(desk.path("takes/side/2.png")).unwrap();
    let outcome = desk.estimate(&["--mask", "--json", "takes"]);
    assert!(outcome.out.contains("camera 'side': nothing is seen of the hand"), "{}", outcome.out);
}

#[test]
fn some_of_the_cameras_answer_and_are_said() {
    let desk = Desk::new();
    desk.learn_any_cameras();
    let expected = json(&desk, &["--mask", "top=top-mask.png"]);
    let cameras = |report: &Value| -> Vec<Value> {
        let views = report["views"].as_array().unwrap().iter();
        views.map(|view| view["camera"].clone()).collect()
    };
    assert_eq!(cameras(&expected), ["top"]);
    let both = json(&desk, &MASKS);
    assert_eq!(cameras(&both), CAMERAS);
    assert_eq!(json(&desk, &["--mask", "top=top-mask.png", "side=side-mask.png"]), both);
    assert_eq!(json(&desk, &["--mask", "-", "top-mask.png"]), expected);
    let refined = desk.estimate(&["--mask", "-", "top-mask.png", "--refine"]);
    assert_eq!(refined.code, Some(0), "{}", refined.err);
    well(desk.estimate(&["--mask", "-", "top-mask.png", "--overlay", "seen.png"]));
    assert_eq!(desk.open("seen.png").width(), desk.open("top-mask.png").width());

    desk.save("empty.png", &image::GrayImage::new(120, 90).into());
    let blank = desk.estimate(&["--json", "--mask", "empty.png", "top-mask.png"]);
    assert!(
        blank.err.starts_with("phalanx: camera 'side': no hand in the picture; "),
        "{}",
        blank.err
    );
    let blank: Value = serde_json::from_str(&blank.out).unwrap();
    assert_eq!((&blank["pose"], &blank["views"]), (&expected["pose"], &expected["views"]));
    let doubt = &blank["doubts"][0];
    assert_eq!((&doubt["view"], &doubt["cause"]), (&"side".into(), &"not_seen".into()));

    std::fs::create_dir_all(desk.path("takes/top")).unwrap();
    std::fs::copy(desk.path("top-mask.png"), desk.path("takes/top/a.png")).unwrap();
    for folder in ["takes", "top=takes/top"] {
        assert_eq!(json(&desk, &["--mask", folder])["pose"], expected["pose"]);
    }
    let refused = |given: &[&str], said: &str| {
        let outcome = desk.estimate(&[&["--mask"], given].concat());
        assert_eq!(outcome.code, Some(2), "{given:?}");
        assert!(outcome.err.contains(said), "{given:?}: {}", outcome.err);
    };
    refused(&["-", "-"], "one picture per camera, 2 (side, top), found 0");
    refused(&["top=top-mask.png", "top=top-mask.png"], "camera 'top' is given twice");
    refused(&["empty.png", "empty.png"], "camera 'side': empty mask");
}

/// Desk pictures before a background that a model of skin cannot tell from the hand.
#[test]
fn a_recorded_background_and_an_own_model_of_skin_tell_the_hand() {
    let desk = Desk::new();
    let skin_coloured = [200, 150, 122];
    for camera in CAMERAS {
        for folder in ["empty", "hand", "masks"] {
            std::fs::create_dir_all(desk.path(folder).join(camera)).unwrap();
        }
        let mask = desk.open(&format!("{camera}-mask.png"));
        let (width, height) = (mask.width(), mask.height());
        let table = RgbImage::from_pixel(width, height, image::Rgb(skin_coloured));
        let blue = RgbImage::from_fn(width, height, |x, y| {
            let is_hand = mask.to_luma8().get_pixel(x, y).0[0] > 127;
            image::Rgb(if is_hand { [60, 70, 190] } else { skin_coloured })
        });
        desk.save(&format!("empty/{camera}/a.png"), &table.into());
        desk.save(&format!("hand/{camera}/b.png"), &blue.into());
        desk.save(&format!("masks/{camera}/b.png"), &mask);
    }
    let learn = |arguments: &[&str]| run(desk.folder(), ["skin"].iter().chain(arguments));
    for (arguments, said) in [
        (&["--empty", "empty", "--out", "background"][..], "backgrounds of the cameras side, top"),
        (
            &["--hand", "hand", "--empty", "empty", "--out", "own"],
            "100 % of the hand is told, 0.0 %",
        ),
        (&["--hand", "hand", "--masks", "masks", "--out", "masked"], "from 2 pictures"),
    ] {
        let outcome = learn(arguments);
        assert_eq!(outcome.code, Some(0), "{}", outcome.err);
        assert!(outcome.out.contains(said), "{}", outcome.out);
    }
    let outcome = learn(&["--empty", "empty", "--out", "background", "--json"]);
    let said: serde_json::Value = serde_json::from_str(&outcome.out).unwrap();
    assert!(said.is_object(), "{said}");
    let expected = json(&desk, &MASKS);
    let pictures = ["hand/side/b.png", "hand/top/b.png"];
    for model in ["background", "own", "masked", "plain"] {
        let report = json(&desk, &[&["--segment", model], &pictures[..]].concat());
        for dof in [Dof::IndexPip, Dof::MiddlePip, Dof::RingPip] {
            let off = (value(&report, dof) - value(&expected, dof)).abs();
            assert!(off < 5.0, "{model}: {dof} is {off}° off");
        }
    }
    let refused = |arguments: &[&str], said: &str| {
        let outcome = desk.estimate(&[arguments, &pictures[..]].concat());
        assert_eq!(outcome.code, Some(2), "{arguments:?}");
        assert!(outcome.err.contains(said), "{arguments:?}: {}", outcome.err);
    };
    refused(&["--segment", "model"], "model (--segment): not a phalanx segmentation");
    refused(&["--segment", "nowhere"], "nowhere (--segment): ");
    refused(&["--segment", "plain", "--mask"], "cannot be used with");
    assert_eq!(learn(&["--out", "nothing"]).code, Some(2));
}

#[test]
fn inverted_masks_are_doubted_by_view_and_cause() {
    let desk = Desk::new();
    desk.learn_doubts();
    let right = desk.estimate(&[&["--json"], &MASKS[..]].concat());
    assert_eq!((right.code, right.err.as_str()), (Some(0), ""));
    let right: Value = serde_json::from_str(&right.out).unwrap();
    assert!(right["views"][0]["overlap"].as_f64().unwrap() > 0.8);
    let mut inverted = desk.open("top-mask.png");
    inverted.invert();
    desk.save("inverted.png", &inverted);
    let outcome = desk.estimate(&["--json", "--mask", "side-mask.png", "inverted.png"]);
    assert_eq!(outcome.code, Some(0), "{}", outcome.err);
    assert!(outcome.err.contains("camera 'top': the mask looks inverted"), "{}", outcome.err);
    let report: Value = serde_json::from_str(&outcome.out).unwrap();
    let doubt = report["doubts"].as_array().unwrap().iter();
    let mut inverted = doubt.filter(|doubt| doubt["cause"] == "inverted_mask");
    assert_eq!(inverted.next().unwrap()["view"], "top");
}
