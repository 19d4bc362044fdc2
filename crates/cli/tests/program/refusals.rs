//! Whatever is wrong: exit code 2, a message that names it, no result, and nothing written.

use std::process::{Command, Stdio};

use image::{DynamicImage, GrayImage, ImageFormat, Luma, Rgb, RgbImage};

use crate::desk::{Desk, run};

impl Desk {
    /// Checks that the program refuses these arguments with a message that has all these parts,
    /// prints no result and leaves the folder as it was.
    fn refuses(&self, arguments: &[&str], parts: &[&str]) {
        self.write("overlay.png", b"an older file");
        let before = self.listing();
        let outcome = self.estimate(&[arguments, &["--overlay", "overlay.png"]].concat());
        assert_eq!(
            (outcome.code, outcome.out.as_str()),
            (Some(2), ""),
            "{arguments:?} {outcome:?}"
        );
        for part in parts {
            assert!(outcome.err.contains(part), "{arguments:?}: no '{part}' in: {}", outcome.err);
            assert_eq!(outcome.err.matches(part).count(), 1, "said twice: {}", outcome.err);
        }
        assert!(!outcome.err.contains("panicked"), "{}", outcome.err);
        assert_eq!(self.listing(), before);
        assert_eq!(self.read("overlay.png"), b"an older file");
    }

    /// As above, for two masks of which the second is this.
    fn refuses_mask(&self, mask: impl Into<DynamicImage>, parts: &[&str]) {
        self.save("bad.png", &mask.into());
        self.refuses(&["--mask", "side-mask.png", "bad.png"], parts);
    }

    fn refuses_file(&self, bytes: &[u8], parts: &[&str]) {
        self.write("bad.png", bytes);
        self.refuses(&["side.png", "bad.png"], &[&["bad.png"], parts].concat());
    }

    fn refuses_model(&self, bytes: &[u8], parts: &[&str]) {
        let model = self.read("model");
        self.write("model", bytes);
        self.refuses(&["side.png", "top.png"], &[&["phalanx: model: "], parts].concat());
        self.write("model", &model);
    }
}

fn uniform(width: u32, height: u32, level: u8) -> GrayImage {
    GrayImage::from_pixel(width, height, Luma([level]))
}

#[test]
fn missing_files() {
    let desk = Desk::new();
    desk.refuses(&["side.png", "nowhere.png"], &["nowhere.png", "No such file"]);
    let outcome = run(&desk.path(""), ["estimate", "--model", "no-model", "side.png", "top.png"]);
    assert_eq!((outcome.code, outcome.out.as_str()), (Some(2), ""));
    assert!(outcome.err.starts_with("phalanx: no-model: No such file"), "{}", outcome.err);
    // A folder is no picture.
    std::fs::create_dir(desk.path("folder.png")).unwrap();
    desk.refuses(&["side.png", "folder.png"], &["folder.png"]);
}

/// Reading one would go on until there is no more memory.
#[cfg(unix)]
#[test]
fn devices_that_have_no_end() {
    const DEVICE: &str = "/dev/zero";
    if !std::path::Path::new(DEVICE).exists() {
        println!("skipped: this system has no {DEVICE}");
        return;
    }
    let desk = Desk::new();
    for end in ["csv", "jsonl", "npz", "mp4", "json"] {
        std::os::unix::fs::symlink(DEVICE, desk.path(&format!("endless.{end}"))).unwrap();
    }
    desk.write_rig("rig.toml");
    for arguments in [
        &["estimate", "--model", DEVICE, "side.png", "top.png"][..],
        &["estimate", "--model", "model", DEVICE, "top.png"],
        &["estimate", "--model", "model", "--segment", DEVICE, "side.png", "top.png"],
        &["estimate", "--model", "model", "--refine", "--hand", DEVICE, "side.png", "top.png"],
        &["train", "--rig", DEVICE, "--out", "new"],
        &["train", "--poses", DEVICE, "--out", "new"],
        &["merge", DEVICE, "--out", "new"],
        &["rig", "import", DEVICE, "--out", "new"],
        &["rig", "check", DEVICE],
        &["report", "endless.csv"],
        &["report", "endless.jsonl"],
        &["report", "endless.npz"],
        &["track", "--rig", "rig.toml", "--out", "new.csv", "side=endless.mp4", "top=endless.mp4"],
        &["track", "--rig", "rig.toml", "--out", "new.csv", "--landmarks", "side=endless.json"],
    ] {
        let outcome = run(desk.folder(), arguments);
        assert_eq!((outcome.code, outcome.out.as_str()), (Some(2), ""), "{arguments:?}");
        assert!(outcome.err.contains("this is a device"), "{arguments:?}: {}", outcome.err);
    }
}

#[test]
fn files_that_are_no_pictures() {
    let desk = Desk::new();
    desk.refuses_file(b"", &["format could not be determined"]);
    desk.refuses_file(b"side,top\n1,2\n", &["format could not be determined"]);
    desk.refuses_file(&desk.read("model"), &["format could not be determined"]);
    desk.refuses(&["side.png", "model"], &["phalanx: model: ", "format could not be determined"]);
}

#[test]
fn truncated_and_damaged_pictures() {
    let desk = Desk::new();
    let png = desk.read("top.png");
    for length in [8, 20, 40, png.len() / 2, png.len() - 20] {
        desk.refuses_file(&png[..length], &[]);
    }
    let mut damaged = png.clone();
    let middle = damaged.len() / 2;
    damaged[middle] ^= 0x10;
    desk.refuses_file(&damaged, &[]);
    desk.refuses_file(&with_palette(7), &["palette ends within a colour"]);

    let photograph = desk.open("top.png").to_rgb8();
    photograph.save_with_format(desk.path("top.jpg"), ImageFormat::Jpeg).unwrap();
    let jpeg = desk.read("top.jpg");
    for share in [2, 5, 8] {
        desk.refuses_file(&jpeg[..jpeg.len() * share / 9], &["truncated"]);
    }
    // A segment shorter than its own length.
    desk.refuses_file(b"\xff\xd8\xff\xe0\0\x01", &["invalid length:1\"\n"]);
    photograph.save_with_format(desk.path("top.ppm"), ImageFormat::Pnm).unwrap();
    let ppm = desk.read("top.ppm");
    desk.refuses_file(&ppm[..ppm.len() / 2], &[]);
}

/// A PNG that claims to be this large and has no content.
fn claiming(width: u32, height: u32) -> Vec<u8> {
    png(&[&width.to_be_bytes()[..], &height.to_be_bytes(), &[8, 2, 0, 0, 0]].concat(), &[])
}

/// A PNG of one pixel, which has no content, with a palette of so many bytes.
fn with_palette(length: usize) -> Vec<u8> {
    png(&[0, 0, 0, 1, 0, 0, 0, 1, 8, 3, 0, 0, 0], &[(b"PLTE", &vec![9; length])])
}

/// A PNG with this header and, before its content of nothing, these chunks.
fn png(header: &[u8], chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
    // An empty zlib stream.
    let content = [0x78, 0x9c, 0x03, 0x00, 0x00, 0x00, 0x00, 0x01];
    let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
    let around = [(b"IDAT", &content[..]), (b"IEND", &[])];
    for (kind, content) in [(b"IHDR", header)].iter().chain(chunks).chain(&around) {
        let body = [kind.as_slice(), content].concat();
        file.extend((content.len() as u32).to_be_bytes());
        file.extend(&body);
        file.extend(crc32fast::hash(&body).to_be_bytes());
    }
    file
}

#[test]
fn huge_claims() {
    let desk = Desk::new();
    desk.refuses_file(&claiming(100_000, 100_000), &["larger than 16384 px on a side"]);
    desk.refuses_file(&claiming(u32::MAX >> 1, 1), &[]);
    desk.refuses_file(&claiming(16_000, 12_000), &[]);
    desk.refuses_file(&claiming(0, 0), &[]);
    desk.refuses_file(b"P6\n99999 99999\n255\n", &["larger than 16384 px on a side"]);
    desk.refuses_file(b"P6\n99999999999 9\n255\n", &[]);
}

#[test]
fn pictures_of_another_shape() {
    let desk = Desk::new();
    let expected = "camera 'top': the picture is 160×90";
    desk.refuses_mask(uniform(160, 90, 255), &[expected, "the camera's 120×90"]);
    desk.refuses_mask(uniform(1, 1, 255), &["camera 'top': image is 1×1 pixels"]);
}

#[test]
fn masks_without_a_silhouette() {
    let desk = Desk::new();
    desk.refuses_mask(uniform(120, 90, 0), &["camera 'top': empty mask"]);
    let expected = "bad.png: brighter than 127 is hand; the brightest pixel has level ";
    for level in [1, 127] {
        desk.refuses_mask(uniform(120, 90, level), &[&format!("{expected}{level}\n")]);
    }
    desk.refuses_mask(uniform(120, 90, 255), &["camera 'top': no contour"]);
    let disc = GrayImage::from_fn(120, 90, |x, y| {
        let (dx, dy) = (f64::from(x) - 60.0, f64::from(y) - 45.0);
        Luma([if dx.hypot(dy) < 25.0 { 255 } else { 0 }])
    });
    desk.refuses_mask(disc, &["camera 'top': no forearm"]);
}

#[test]
fn photographs_without_a_hand() {
    let desk = Desk::new();
    let meadow = RgbImage::from_fn(320, 240, |x, y| Rgb([40, 120 + (x % 9) as u8, (y % 50) as u8]));
    let refuses = |picture: RgbImage, cause: &str| {
        desk.save("bad.png", &picture.into());
        desk.refuses(&["side.png", "bad.png"], &["camera 'top': ", cause]);
    };
    refuses(meadow, "nothing as large as a hand has the colour of skin");
    let of = |colour| RgbImage::from_pixel(320, 240, Rgb(colour));
    refuses(of([120, 124, 120]), "the picture has no colour");
    refuses(of([20, 24, 20]), "the picture has no colour");
    refuses(of([70, 90, 140]), "more blue than red");
}

#[test]
fn too_few_or_too_many_pictures() {
    let desk = Desk::new();
    let expected = "one picture per camera, 2 (side, top), found";
    desk.refuses(&["side.png"], &[expected, "found 1"]);
    desk.refuses(&["side.png", "top.png", "top.png"], &[expected, "found 3"]);
    desk.refuses(&[], &["required arguments were not provided"]);
}

#[test]
fn windows_that_are_not_there() {
    let desk = Desk::new();
    for (window, parts) in [
        (
            "0,0,321,240",
            &["side.png: the window 0,0,321,240 reaches outside the picture of 320×240"][..],
        ),
        ("1,0,320,240", &["side.png: the window"]),
        ("4294967295,0,320,240", &["side.png: the window"]),
        ("0,0,0,240", &["expected X,Y,W,H with a width and a height"]),
        ("0,0,320", &["expected X,Y,W,H"]),
        ("0,0,320,240,1", &["expected X,Y,W,H"]),
        ("a,b,c,d", &["expected X,Y,W,H"]),
        ("-1,0,320,240", &["expected X,Y,W,H"]),
        ("", &["expected X,Y,W,H"]),
        ("0,0,100,240", &["camera 'side': the picture is 100×240"]),
    ] {
        desk.refuses(&["side.png", "top.png", &format!("--crop={window}")], parts);
    }
}

#[test]
fn models_that_are_none() {
    let desk = Desk::new();
    let model = desk.read("model");
    desk.refuses_model(b"", &["not a phalanx model"]);
    desk.refuses_model(&desk.read("top.png"), &["not a phalanx model"]);
    desk.refuses_model(&model[..model.len() / 2], &["truncated"]);
    desk.refuses_model(&model[..10], &["truncated"]);
    let mut corrupt = model.clone();
    corrupt[1000] ^= 1;
    desk.refuses_model(&corrupt, &["corrupt: checksum"]);
    let mut newer = model;
    newer[8] = 12;
    desk.refuses_model(&newer, &["the model has format 12; this version reads format 11"]);
}

#[test]
fn overlays_that_cannot_be_written() {
    let desk = Desk::new();
    desk.write("file", b"");
    std::fs::create_dir(desk.path("folder.png")).unwrap();
    let before = desk.listing();
    for (overlay, part) in [
        ("nowhere/overlay.png", "nowhere/overlay.png: there is no folder nowhere"),
        ("file/overlay.png", "file/overlay.png: there is no folder file"),
        ("folder.png", "folder.png: this is a folder"),
        ("overlay.jpg", "overlay.jpg: the overlay is written as PNG"),
        ("overlay", "overlay: the overlay is written as PNG"),
    ] {
        let outcome = desk.estimate(&["side.png", "top.png", "--overlay", overlay]);
        assert_eq!((outcome.code, outcome.out.as_str()), (Some(2), ""), "{overlay}");
        assert!(outcome.err.contains(part), "{}", outcome.err);
        assert_eq!(desk.listing(), before);
    }
}

#[test]
fn a_reader_that_goes_away_is_an_error_and_no_panic() {
    let desk = Desk::new();
    let mut program = Command::new(env!("CARGO_BIN_EXE_phalanx"));
    program
        .current_dir(desk.path(""))
        .args(["estimate", "--model", "model", "side.png", "top.png"]);
    let mut child = program.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.starts_with("phalanx: writing the result: "), "{message}");
}

#[test]
fn wrong_use() {
    let desk = Desk::new();
    for arguments in [&[][..], &["guess"], &["estimate"], &["estimate", "--model", "model"]] {
        let outcome = run(&desk.path(""), arguments);
        assert_eq!((outcome.code, outcome.out.as_str()), (Some(2), ""), "{arguments:?}");
        assert!(outcome.err.contains("Usage: phalanx"), "{}", outcome.err);
    }
    let help = run(&desk.path(""), ["estimate", "--help"]);
    assert_eq!((help.code, help.err.as_str()), (Some(0), ""));
    assert!(help.out.contains("--crop"));
}
