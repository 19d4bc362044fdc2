//! `phalanx track` on drawn recordings.

use std::path::Path;
use std::process::Command;

use crate::desk::{CAMERAS, DEMO, Desk, Outcome, run};
use phalanx_io::take::{Take, read_csv, read_json_lines};

/// How far the hand is closed in a frame.
pub(crate) fn closed(frame: usize) -> f64 {
    0.5 - 0.5 * (0.9 * frame as f64).cos()
}

/// The desk's rig with both cameras, and masks of a hand that closes and opens.
pub(crate) fn recorded(frames: usize) -> Desk {
    let desk = Desk::new();
    desk.write_rig("rig.toml");
    for frame in 0..frames {
        desk.draw_frame("take", &format!("{frame:04}.png"), closed(frame));
    }
    desk
}

fn track(desk: &Desk, arguments: &[&str]) -> Outcome {
    run(desk.folder(), ["track", "--rig", "rig.toml", "--mask"].iter().chain(arguments))
}

pub(crate) fn take(desk: &Desk, name: &str) -> Take {
    read_csv(desk.read(name).as_slice()).unwrap()
}

/// Mean distance of the joints from where they were drawn, mm.
pub(crate) fn error_mm(take: &Take) -> f64 {
    let mut distances = Vec::new();
    for (number, frame) in take.frames.iter().enumerate() {
        let drawn = Desk::joints(closed(number));
        let estimate = frame.estimate.as_ref().unwrap();
        distances.extend(estimate.joints.iter().zip(drawn).map(|(at, drawn)| at.distance(drawn)));
    }
    distances.iter().sum::<f64>() / distances.len() as f64
}

#[test]
fn folders_of_masks_become_angles() {
    let desk = recorded(8);
    let outcome =
        track(&desk, &["take", "--out", "take.csv", "--rate", "10", "--save-hand", "me.toml"]);
    assert_eq!(outcome.code, Some(0), "{outcome:?}");
    let whole = take(&desk, "take.csv");
    assert_eq!(whole.frames.len(), 8);
    assert!((whole.frames[3].time - 0.3).abs() < 1e-9);
    let error = error_mm(&whole);
    assert!(error < 8.0, "{error} mm");

    // Named one by one, and with the hand that was saved, it is the same recording.
    let named = [
        format!("{}=take/{}", CAMERAS[1], CAMERAS[1]),
        format!("{}=take/{}", CAMERAS[0], CAMERAS[0]),
    ];
    let outcome = track(&desk, &[&named[0], &named[1], "--hand", "me.toml", "--out", "again.csv"]);
    assert!(outcome.err.contains("the hand is "), "{outcome:?}");
    assert_eq!(outcome.code, Some(0), "{outcome:?}");
    let error = error_mm(&take(&desk, "again.csv"));
    assert!(error < 8.0, "{error} mm");
}

#[test]
fn what_cannot_be_read_is_named_and_the_rest_is_done() {
    let desk = recorded(6);
    desk.write(&format!("take/{}/0002.png", CAMERAS[0]), b"no picture");
    std::fs::remove_file(desk.path(&format!("take/{}/0004.png", CAMERAS[1]))).unwrap();
    let outcome = track(&desk, &["take", "--out", "take.jsonl"]);
    assert_eq!(outcome.code, Some(1), "{outcome:?}");
    assert!(outcome.err.contains(&format!("frame 0002, camera {}", CAMERAS[0])), "{outcome:?}");
    assert!(outcome.err.contains("has no picture at 1 moment\n"), "{outcome:?}");
    let take = read_json_lines(desk.read("take.jsonl").as_slice()).unwrap();
    let view = &take.frames[2].views[0];
    assert!(
        !view.used && view.left_out.is_none(),
        "it shows nothing, and not that there is no hand"
    );
    assert_eq!(String::from_utf8(desk.read("take.jsonl")).unwrap().lines().count(), 1 + 6);
}

#[test]
fn wrong_use_is_refused_by_name() {
    let desk = recorded(2);
    for (arguments, words) in [
        (&["take", "--out", "take.trc"][..], ".csv, .jsonl or .npz"),
        (&["nowhere", "elsewhere", "--out", "t.csv"], "nowhere"),
        (&["a", "b", "c", "--out", "t.csv"], "3 recordings for the 2 cameras"),
        (&["nowhere", "--out", "t.csv"], "nowhere: there is no such file or folder"),
        (&["take", "--fit-together", "5", "--out", "t.csv"], "at least 6 moments tell a hand"),
        (&["take", "--rate", "0", "--out", "t.csv"], "frames a second, over 0"),
        (&["take", "--hand", "me.toml", "--out", "t.csv"], "me.toml"),
        (&["take", "--timestamps", "times.csv", "--out", "t.csv"], "times.csv"),
    ] {
        let outcome = track(&desk, arguments);
        assert_eq!(outcome.code, Some(2), "{outcome:?}");
        assert!(outcome.err.contains(words), "{outcome:?}");
    }
    desk.save(&format!("take/{}/0000.png", CAMERAS[0]), &image::DynamicImage::new_luma8(90, 120));
    let outcome = track(&desk, &["take", "--out", "t.csv"]);
    assert!(outcome.err.contains("is it turned or cropped"), "{outcome:?}");
}

/// Masks are no photographs, also where a video or a JPEG file has blurred them.
#[test]
fn masks_without_their_option_are_told() {
    let desk = recorded(2);
    let refuses = || {
        let outcome = run(desk.folder(), ["track", "--rig", "rig.toml", "take", "--out", "t.csv"]);
        assert_eq!(outcome.code, Some(2), "{outcome:?}");
        assert!(outcome.err.contains("none of the 4 pictures can be used"), "{outcome:?}");
        assert!(outcome.err.contains("give --mask"), "{outcome:?}");
    };
    refuses();
    for (camera, frame) in CAMERAS.iter().flat_map(|camera| [(camera, 0), (camera, 1)]) {
        let name = format!("take/{camera}/{frame:04}");
        let mask = desk.open(&format!("{name}.png")).to_rgb8();
        mask.save(desk.path(&format!("{name}.jpg"))).unwrap();
        std::fs::remove_file(desk.path(&format!("{name}.png"))).unwrap();
    }
    refuses();
}

/// Photographs are no masks: parts of them that are bright are fitted as a hand, which nothing tells.
#[test]
fn photographs_given_as_masks_are_told() {
    let desk = recorded(2);
    for (camera, frame) in CAMERAS.iter().flat_map(|camera| [(camera, 0), (camera, 1)]) {
        let photograph = desk.open(&format!("{camera}.png")).to_rgb8();
        std::fs::remove_file(desk.path(&format!("take/{camera}/{frame:04}.png"))).unwrap();
        photograph.save(desk.path(&format!("take/{camera}/{frame:04}.jpg"))).unwrap();
    }
    let told = "photographs go without --mask: it is like a photograph, not like a mask: ";
    let tracked = track(&desk, &["take", "--out", "t.csv"]);
    assert!(tracked.err.contains("none of the 4 pictures can be used"), "{tracked:?}");
    let estimated = desk.estimate(&["--mask", "side.png", "top.png"]);
    for outcome in [tracked, estimated] {
        assert_eq!(outcome.code, Some(2), "{outcome:?}");
        assert!(outcome.err.contains(told), "{outcome:?}");
    }
    let looked = run(desk.folder(), ["doctor", "--rig", "rig.toml", "take", "--mask"]);
    assert_eq!(looked.code, Some(2), "{looked:?}");
    assert!(looked.out.contains(told), "{looked:?}");
}

/// Skin is found by its colour.
#[test]
fn photographs_without_colour_are_told() {
    let desk = recorded(2);
    for (camera, frame) in CAMERAS.iter().flat_map(|camera| [(camera, 0), (camera, 1)]) {
        let grey = desk.open(&format!("{camera}.png")).to_luma8();
        desk.save(&format!("take/{camera}/{frame:04}.png"), &grey.into());
    }
    let outcome = run(desk.folder(), ["track", "--rig", "rig.toml", "take", "--out", "t.csv"]);
    assert_eq!(outcome.code, Some(2), "{outcome:?}");
    assert!(outcome.err.contains("none of the 4 pictures can be used"), "{outcome:?}");
    assert!(outcome.err.contains("the picture has no colour"), "{outcome:?}");
}

/// Boards pass for skin, and are told from the hand by what moves.
#[test]
fn a_hand_before_what_looks_like_skin_is_tracked() {
    let desk = recorded(12);
    for (camera, frame) in CAMERAS.iter().flat_map(|camera| (0..12).map(move |k| (camera, k))) {
        let name = format!("take/{camera}/{frame:04}.png");
        let mask = desk.open(&name).to_luma8();
        let photograph = image::RgbImage::from_fn(mask.width(), mask.height(), |x, y| {
            let grain = ((x * 7919 + y * 104_729 + frame) % 5) as u8;
            let colour = match mask.get_pixel(x, y).0[0] > 127 {
                true => [205, 150, 130],
                false if x / 32 % 2 == 0 => [180, 130, 80],
                false => [90, 95, 100],
            };
            image::Rgb(colour.map(|level| level + grain))
        });
        desk.save(&name, &photograph.into());
    }
    let tracked = |segment: &[&str]| {
        let given = ["track", "--rig", "rig.toml", "take", "--out", "t.csv"];
        run(desk.folder(), given.iter().chain(segment))
    };
    let learnt = tracked(&[]);
    let said = "what stands still looks like skin; its colours were learnt from 12 pictures";
    assert_eq!(learnt.code, Some(0), "{learnt:?}");
    assert_eq!(learnt.err.matches(said).count(), 2, "{learnt:?}");
    let error = error_mm(&take(&desk, "t.csv"));
    assert!(error < 8.0, "{error} mm");
    let by_colour = tracked(&["--segment", "skin"]);
    assert!(!by_colour.err.contains(said), "{by_colour:?}");
}

/// One camera tells no hand's proportions: none are said, nor kept for another recording.
#[test]
fn a_hand_that_the_recording_does_not_tell_is_nobodys() {
    let desk = recorded(6);
    let one = format!("{0}=take/{0}", CAMERAS[1]);
    let outcome = track(&desk, &[&one, "--out", "one.csv", "--save-hand", "me.toml"]);
    assert_eq!(outcome.code, Some(0), "{outcome:?}");
    assert!(outcome.err.contains("a mean hand of 184 mm was fitted"), "{outcome:?}");
    assert!(outcome.err.contains("me.toml: not written"), "{outcome:?}");
    assert!(!desk.path("me.toml").exists());
    assert!(outcome.err.contains("hardly tells a right hand from a left one"), "{outcome:?}");
    // Nor does the recording say when its pictures were taken.
    assert!(outcome.err.contains("30 a second are assumed"), "{outcome:?}");
}

#[test]
fn videos_give_the_angles_of_their_pictures() {
    if Command::new("ffmpeg").arg("-version").output().is_err() {
        eprintln!("skipped: ffmpeg, which makes the test's videos, is not installed");
        return;
    }
    let desk = recorded(6);
    for camera in CAMERAS {
        encode(&desk.path(&format!("take/{camera}")), &desk.path(&format!("{camera}.mp4")));
        encode(&desk.path(&format!("take/{camera}")), &desk.path(&format!("{camera}.mkv")));
    }
    for ending in ["mp4", "mkv"] {
        let videos = CAMERAS.map(|camera| format!("{camera}.{ending}"));
        let outcome = track(&desk, &[&videos[0], &videos[1], "--out", "video.csv"]);
        assert_eq!(outcome.code, Some(0), "{outcome:?}");
        let video = take(&desk, "video.csv");
        assert_eq!(video.frames.len(), 6);
        assert!((video.frames[5].time - 0.5).abs() < 1e-6);
        let error = error_mm(&video);
        assert!(error < 8.0, "{ending}: {error} mm");
    }
}

/// Ten pictures a second as H.264, with frames that are stored out of order.
fn encode(folder: &Path, video: &Path) {
    let mut ffmpeg = Command::new("ffmpeg");
    ffmpeg.args(["-v", "error", "-y", "-framerate", "10", "-i"]).arg(folder.join("%04d.png"));
    ffmpeg.args(["-c:v", "libx264", "-bf", "2", "-crf", "10", "-pix_fmt", "yuv420p"]).arg(video);
    assert!(ffmpeg.status().unwrap().success());
}

#[test]
fn the_demo_goes_to_a_new_folder_and_to_no_other() {
    let (folder, outcome) = &*DEMO;
    assert_eq!(outcome.code, Some(0), "{outcome:?}");
    let said: serde_json::Value = serde_json::from_str(&outcome.out).unwrap();
    assert_eq!((&said["folder"], &said["frames"]), (&"demo".into(), &60.into()));
    let demo = folder.join("demo");
    let whole = read_csv(std::fs::File::open(demo.join("take.csv")).unwrap()).unwrap();
    assert_eq!(whole.frames.len(), 60);
    assert!(whole.frames.iter().all(phalanx_io::take::TakeFrame::is_trusted));
    assert!(demo.join("sheet.png").is_file() && demo.join("rig.toml").is_file());
    let again = run(folder, ["demo", "--out", "demo"]);
    assert_eq!(again.code, Some(2), "{again:?}");
    assert!(again.err.contains("not empty"), "{again:?}");
}

/// Photographs of a hand before a plain wall.
#[test]
fn the_hand_is_told_as_segment_says() {
    let desk = recorded(8);
    for camera in CAMERAS {
        for frame in 0..8 {
            let name = format!("take/{camera}/{frame:04}.png");
            let mask = desk.open(&name).to_luma8();
            let colour = |level: u8| if level > 127 { [170, 110, 90] } else { [225, 225, 225] };
            let photograph = image::RgbImage::from_fn(mask.width(), mask.height(), |x, y| {
                image::Rgb(colour(mask.get_pixel(x, y).0[0]))
            });
            desk.save(&name, &photograph.into());
        }
    }
    let given = ["track", "--rig", "rig.toml", "take", "--segment", "plain", "--out", "take.csv"];
    let outcome = run(desk.folder(), given);
    assert_eq!(outcome.code, Some(0), "{outcome:?}");
    let error = error_mm(&take(&desk, "take.csv"));
    assert!(error < 8.0, "{error} mm");
    let given =
        ["rig", "volume", "rig.toml", "take", "--segment", "plain", "--json", "--out", "v.toml"];
    let outcome = run(desk.folder(), given);
    assert_eq!(outcome.code, Some(0), "{outcome:?}");
    let said: serde_json::Value = serde_json::from_str(&outcome.out).unwrap();
    assert!(said.is_object(), "{said}");
}

/// What is wrong with a whole recording is said, not only frame by frame.
#[test]
fn a_recording_of_other_moments_or_cameras_is_told() {
    let desk = recorded(6);
    let [first, second] = CAMERAS;
    std::fs::create_dir_all(desk.path("named")).unwrap();
    std::fs::rename(desk.path(&format!("take/{first}")), desk.path(&format!("named/{first}")))
        .unwrap();
    for frame in 0..6 {
        let folder = desk.path(&format!("named/{first}"));
        let name = |name: String| folder.join(name);
        std::fs::rename(name(format!("{frame:04}.png")), name(format!("image{frame}.png")))
            .unwrap();
    }
    let given = [format!("{first}=named/{first}"), format!("{second}=take/{second}")];
    let outcome = track(&desk, &[&given[0], &given[1], "--out", "t.csv"]);
    assert_eq!(outcome.code, Some(2), "{outcome:?}");
    assert!(outcome.err.contains("its first is 'image0', another's '0000'"), "{outcome:?}");

    // Two of three cameras exchanged.
    desk.copy_eight_moments();
    std::fs::copy(DEMO.0.join("demo/rig.toml"), desk.path("three.toml")).unwrap();
    let given = ["side=eight/other_side", "top=eight/top", "other_side=eight/side"];
    let rest = ["track", "--rig", "three.toml", "--mask", "--out", "t.csv"];
    let outcome = run(desk.folder(), rest.iter().chain(&given));
    assert!(
        outcome.err.contains("cameras side and other_side seem to have each other's pictures"),
        "{outcome:?}"
    );
}
