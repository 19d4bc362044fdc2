//! `convert`, `view`, `report` and `evaluate` on takes.

use std::process::{Command, Output};

use glam::DAffine3;
use phalanx::draw_mask;
use phalanx_camera::{Intrinsics, Rig};
use phalanx_hand::{Dof, HandShape};
use phalanx_io::take::{FrameView, Take, TakeFrame, TakeHeader, read_csv, read_npz, write_csv};
use tempfile::TempDir;

use crate::desk::closing;

/// A folder with `take.csv`: a hand that closes and opens, in 30 frames; the last is doubted.
struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        let header = TakeHeader {
            hand: HandShape::adult(),
            world_from_hand: DAffine3::IDENTITY,
            views: vec!["top".to_owned()],
            rate_hz: Some(30.0),
            model: None,
        };
        let closed = |k: u64| 0.5 - 0.5 * (k as f64 / 29.0 * std::f64::consts::TAU).cos();
        let frame = |k: u64| TakeFrame {
            index: k,
            time: k as f64 / 30.0,
            estimate: Some(header.estimate(closing(closed(k)), [Some(0.02); Dof::COUNT])),
            views: vec![FrameView { used: true, overlap: Some(0.9), left_out: None }],
            doubts: if k == 29 { vec!["low-overlap".to_owned()] } else { vec![] },
        };
        let take = Take { frames: (0..30).map(frame).collect(), header };
        let folder = Self(TempDir::new().unwrap());
        write_csv(&take, std::fs::File::create(folder.0.path().join("take.csv")).unwrap()).unwrap();
        folder
    }

    fn run(&self, arguments: &[&str]) -> Output {
        let program = env!("CARGO_BIN_EXE_phalanx");
        Command::new(program).args(arguments).current_dir(self.0.path()).output().unwrap()
    }

    fn printed(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success() && said.is_empty(), "{arguments:?}: {said}");
        String::from_utf8(output.stdout).unwrap()
    }

    /// Writes a file; where it is, is said in a line, and nothing is printed.
    fn writes(&self, arguments: &[&str]) {
        let output = self.run(arguments);
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success() && output.stdout.is_empty(), "{arguments:?}: {said}");
        let out = arguments.iter().skip_while(|argument| **argument != "--out").nth(1).unwrap();
        let is_told = said.starts_with("phalanx: ") && said.contains(&format!(" frames; {out}"));
        assert!(is_told && said.lines().count() == 1, "{arguments:?}: {said}");
    }

    fn refusal(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        assert_eq!(output.status.code(), Some(2));
        String::from_utf8(output.stderr).unwrap()
    }

    fn file(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.0.path().join(name)).unwrap()
    }
}

#[test]
fn a_take_is_written_as_every_format_and_read_again() {
    let folder = Folder::new();
    for name in ["a.jsonl", "a.npz", "a.trc", "a.mot", "a.bvh", "a.c3d", "a.glb", "a.csv"] {
        folder.writes(&["convert", "take.csv", "--out", name]);
        assert!(folder.file(name).len() > 1000, "{name}");
    }
    assert_eq!(folder.file("a.csv"), folder.file("take.csv"));
    assert!(folder.file("a_std.sto").starts_with(b"Standard deviations"));
    folder.writes(&["convert", "a.jsonl", "--out", "b.npz"]);
    assert_eq!(read_npz(&folder.file("b.npz")).unwrap().frames.len(), 30);
    folder.writes(&["convert", "take.csv", "--out", "m.trc", "--unit", "m", "--axes", "xz-y"]);
    assert!(String::from_utf8(folder.file("m.trc")).unwrap().contains("\tm\t"));
    std::fs::create_dir(folder.0.path().join("b_std.sto")).unwrap();
    let half = folder.refusal(&["convert", "take.csv", "--out", "b.mot"]);
    assert!(half.contains("b_std.sto: this is a folder"), "{half}");
    assert!(!folder.0.path().join("b.mot").exists(), "nothing without its deviations");
    let guessed = folder.run(&["convert", "take.csv", "--out", "o.mot", "--names", "opensim"]);
    assert!(String::from_utf8(guessed.stderr).unwrap().contains("not yet confirmed"));
}

#[test]
fn a_page_and_a_report_are_written() {
    let folder = Folder::new();
    folder.writes(&["view", "take.csv", "--out", "take.html"]);
    assert!(folder.file("take.html").starts_with(b"<!doctype html>"));
    let text = folder.printed(&["report", "take.csv"]);
    assert!(text.contains("take: 29 of 30 frames count") && text.contains("index total"));
    assert!(folder.printed(&["report", "take.csv", "--all-frames"]).contains("30 of 30"));
    let both = folder.printed(&["report", "take.csv", "take.csv"]);
    assert!(both.lines().any(|line| line.starts_with("index.pip") && line.ends_with("0.0 ± 2.3")));
    folder.printed(&["report", "take.csv", "--out", "range.csv"]);
    folder.printed(&["report", "take.csv", "--out", "range.html"]);
    assert!(folder.file("range.html").starts_with(b"<!doctype html>"));
}

#[test]
fn pictures_are_shown_with_joints_and_outline_of_the_hand() {
    let folder = Folder::new();
    let at = |name: &str| folder.0.path().join(name);
    std::fs::write(at("rig.toml"), include_str!("../../fixtures/desk.toml")).unwrap();
    std::fs::create_dir_all(at("frames/top")).unwrap();
    for frame in ["0.png", "1.png"] {
        image::RgbImage::new(40, 30).save(at("frames/top").join(frame)).unwrap();
    }
    let arguments = ["view", "take.csv", "--frames", "frames", "--rig", "rig.toml", "--out"];
    folder.writes(&[&arguments[..], &["take.html"]].concat());
    let page = String::from_utf8(folder.file("take.html")).unwrap();
    let (_, outlines) = page.split_once("\"outlines\":[\"").unwrap();
    let (outlines, _) = outlines.split_once("\"]").unwrap();
    let outlines: Vec<&str> = outlines.split("\",\"").collect();
    assert!(outlines.len() == 2 && outlines.iter().all(|outline| outline.len() > 500));
    assert_eq!(page.matches("data:image/jpeg").count(), 2);

    let over_one = folder.refusal(&[&arguments[..], &["frames/top/1.png"]].concat());
    assert!(over_one.contains("this is the input frames/top"), "{over_one}");

    let other = include_str!("../../fixtures/desk.toml").replace("\"top\"", "\"above\"");
    std::fs::write(at("other.toml"), other).unwrap();
    let given = ["view", "take.csv", "--frames", "above=frames/top", "--rig", "other.toml"];
    let said = folder.refusal(&[&given[..], &["--out", "other.html"]].concat());
    assert!(said.contains(") has a recording; the rig's cameras are side, above, "), "{said}");

    // The same on a sheet, and as a video: two pictures of black, with an outline.
    let filmed = |others: &[&str]| {
        folder.writes(&[&arguments[..arguments.len() - 1], others].concat());
    };
    filmed(&["--out", "sheet.png", "--every", "15"]);
    let sheet = image::open(at("sheet.png")).unwrap().to_rgb8();
    // Two lines of words are above each picture.
    assert_eq!(sheet.dimensions(), (120, 2 * 110));
    let drawn = |rows: std::ops::Range<u32>| {
        sheet
            .enumerate_pixels()
            .filter(|(_, y, pixel)| rows.contains(y) && pixel.0 != [0; 3])
            .count()
    };
    assert!(drawn(0..20) > 100 && drawn(110..130) > 100, "each frame is named");
    assert!(drawn(20..110) > 100 && drawn(130..220) == 0, "frame 15 has no picture");
    if Command::new("ffmpeg").arg("-version").output().is_err() {
        eprintln!("skipped: ffmpeg, which makes videos, is not installed");
        return;
    }
    filmed(&["--out", "film.mp4", "--every", "3"]);
    let count = ["-v", "error", "-count_packets", "-show_entries", "stream=nb_read_packets,width"];
    let probe =
        Command::new("ffprobe").args(count).args(["-of", "csv=p=0"]).arg(at("film.mp4")).output();
    assert_eq!(String::from_utf8(probe.unwrap().stdout).unwrap().trim(), "120,10");
}

/// The outline is that of the whole picture, of whatever shape: here of a camera whose picture is larger and
/// wider than what models look at.
#[test]
fn the_outline_lies_on_the_hand_in_pictures_of_any_size() {
    let folder = Folder::new();
    let at = |name: &str| folder.0.path().join(name);
    let mut rig = Rig::from_toml(include_str!("../../fixtures/desk.toml")).unwrap();
    for camera in &mut rig.cameras {
        let (cx, cy) = (camera.intrinsics.cx + 40.0, camera.intrinsics.cy + 15.0);
        let wider = Intrinsics { width: 200, height: 120, cx, cy, ..camera.intrinsics };
        *camera = camera.with_intrinsics(wider.resized(500, 300));
    }
    std::fs::write(at("rig.toml"), rig.to_toml().unwrap()).unwrap();
    std::fs::create_dir_all(at("frames/top")).unwrap();
    image::RgbImage::new(500, 300).save(at("frames/top/0.png")).unwrap();
    let frames = ["--frames", "frames", "--rig", "rig.toml", "--every", "40", "--out"];
    folder.writes(&[&["view", "take.csv"][..], &frames, &["sheet.png"]].concat());
    let sheet = image::open(at("sheet.png")).unwrap().to_rgb8();
    let sheet = image::imageops::crop_imm(&sheet, 0, 40, 500, 300).to_image();
    let hand = draw_mask(
        rig.camera("top").unwrap(),
        &HandShape::adult(),
        &closing(0.0),
        &DAffine3::IDENTITY,
    );
    let hand = hand.unwrap();
    let drawn: Vec<_> = sheet.enumerate_pixels().filter(|(.., pixel)| pixel.0 != [0; 3]).collect();
    assert!(drawn.len() > 500 && drawn.iter().all(|&(x, y, _)| hand.is_hand(x, y)));
    let inside = |&(x, y, _): &(u32, u32, _)| {
        x > 0
            && y > 0
            && x < 499
            && y < 299
            && (0..9).all(|k| hand.is_hand(x + k % 3 - 1, y + k / 3 - 1))
    };
    assert!(!drawn.iter().any(inside), "only its border is drawn");
}

/// Pictures are matched by the times that the take was made with, and others are refused.
#[test]
fn a_page_needs_the_times_of_its_take() {
    let folder = Folder::new();
    let at = |name: &str| folder.0.path().join(name);
    std::fs::write(at("rig.toml"), include_str!("../../fixtures/desk.toml")).unwrap();
    std::fs::create_dir_all(at("frames/top")).unwrap();
    let mut times = "cam_id,frame_time\n".to_owned();
    for frame in 0..30 {
        let picture = image::RgbImage::from_pixel(8, 6, image::Rgb([8 * frame; 3]));
        picture.save(at("frames/top").join(format!("{frame:02}.png"))).unwrap();
        times += &["top,", &(7.0 + f64::from(frame) / 30.0).to_string(), "\n"].concat();
    }
    std::fs::write(at("times.csv"), &times).unwrap();
    std::fs::write(at("other.csv"), times.replace("7.1", "7.15")).unwrap();
    let given = ["view", "take.csv", "--frames", "top=frames/top", "--rig", "rig.toml"];
    let view = [&given[..], &["--out", "take.html"]].concat();
    folder.writes(&[&view[..], &["--timestamps", "times.csv"]].concat());
    let said = folder.refusal(&[&view[..], &["--timestamps", "other.csv"]].concat());
    assert!(said.contains("when the take was made"), "{said}");
    // Made by a clock, which pictures alone do not have.
    let mut take = read_csv(&folder.file("take.csv")[..]).unwrap();
    take.header.rate_hz = None;
    write_csv(&take, std::fs::File::create(at("take.csv")).unwrap()).unwrap();
    let said = folder.refusal(&view);
    assert!(said.contains("give the --timestamps"), "{said}");
}

/// What other commands print, they print as JSON when asked.
#[test]
fn json_is_printed_where_text_is() {
    let folder = Folder::new();
    let json = |arguments: &[&str]| -> serde_json::Value {
        serde_json::from_slice(&folder.run(&[arguments, &["--json"]].concat()).stdout).unwrap()
    };
    let converted = json(&["convert", "take.csv", "--out", "a.bvh"]);
    assert_eq!((&converted["file"], &converted["frames"]), (&"a.bvh".into(), &30.into()));
    let report = json(&["report", "take.csv", "take.csv"]);
    let row = report["rows"].as_array().unwrap().iter().find(|row| row["angle"] == "index.pip");
    let groups = row.unwrap()["groups"].as_array().unwrap();
    assert_eq!((groups.len(), &groups[2]["of"]), (3, &"difference".into()));
    assert_eq!(groups[2]["range"]["value"], 0.0);
}

#[test]
fn a_take_agrees_with_itself() {
    let folder = Folder::new();
    for name in ["reference.trc", "reference.jsonl", "reference.npz"] {
        folder.writes(&["convert", "take.csv", "--out", name]);
    }
    for reference in ["take.csv", "reference.trc", "reference.jsonl", "reference.npz"] {
        let text = folder.printed(&["evaluate", "take.csv", "--reference", reference]);
        assert!(text.contains("30 frames compared, 0 without"), "{text}");
        assert!(text.contains("0.0 ms late"), "{text}");
        assert!(text.contains("reliability of all joints"), "{text}");
        let arguments = ["evaluate", "take.csv", "--reference", reference, "--json"];
        let json: serde_json::Value = serde_json::from_str(&folder.printed(&arguments)).unwrap();
        assert!(json["compared"].as_array().unwrap().len() >= 21);
    }
}

#[test]
fn a_reference_in_radians_is_asked_about() {
    let folder = Folder::new();
    std::fs::write(folder.0.path().join("r.csv"), "time,index.pip\n0,0.1\n0.5,1.4\n").unwrap();
    let output = folder.run(&["evaluate", "take.csv", "--reference", "r.csv"]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success() && said.contains("r.csv: no angle exceeds 6.28°"), "{said}");
}

#[test]
fn wrong_use_is_refused_with_what_to_do() {
    let folder = Folder::new();
    let says = |arguments: &[&str], what: &str| {
        let said = folder.refusal(arguments);
        assert!(said.contains(what), "{arguments:?}: {said}");
    };
    says(&["convert", "take.csv", "--out", "take.xls"], "must end with");
    says(&["convert", "take.txt", "--out", "take.bvh"], "ends with .csv, .jsonl or .npz");
    says(&["convert", "take.csv", "--out", "t.trc", "--axes", "yxz"], "without a mirror");
    says(&["convert", "take.csv", "--out", "t.glb", "--unit", "mm"], "glTF has lengths in m");
    says(&["view", "take.csv", "--out", "take.pdf"], ".html for a page, .png for a sheet");
    says(&["view", "take.csv", "--out", "sheet.png"], "give --frames and --rig");
    let at = |name: &str| folder.0.path().join(name);
    std::fs::write(at("rig.toml"), include_str!("../../fixtures/desk.toml")).unwrap();
    std::fs::create_dir_all(at("frames/top")).unwrap();
    image::RgbImage::new(90, 90).save(at("frames/top/0.png")).unwrap();
    let view = ["view", "take.csv", "--frames", "frames", "--rig", "rig.toml", "--out", "s.png"];
    says(&view, "frame 0: the picture has 90×90 px, but the camera was calibrated for 120×90");
    std::fs::write(at("hand.toml"), HandShape::adult().to_toml()).unwrap();
    says(&["rig", "check", "hand.toml"], "hand.toml: this is a hand, not a rig");
    let mut take = read_csv(&folder.file("take.csv")[..]).unwrap();
    take.frames.iter_mut().for_each(|frame| frame.doubts.push("other-side".to_owned()));
    write_csv(&take, std::fs::File::create(at("doubted.csv")).unwrap()).unwrap();
    says(&["report", "doubted.csv"], "no frame can be trusted: other-side in 30 of 30 frames");
    says(&["report", "take.csv", "--out", "take.pdf"], "must end with .csv or .html");
    says(&["evaluate", "take.csv", "--reference", "x.c3d"], "ends with .csv, .trc, .mot");
}
