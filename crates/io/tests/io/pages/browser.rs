//! The page of a take: hostile names stay text, and a browser runs it without a word of complaint.

use std::path::Path;
use std::process::Command;

use glam::DVec2;
use phalanx_hand::{JOINTS, Side};
use phalanx_io::page::{ViewPicture, ViewPictures, view_page};
use phalanx_io::take::{FrameView, Take};

use crate::installed::{node_modules, program, run};
use crate::sample;

const HOSTILE: &str = "</script><script>throw 'script ran'</script><b>{{data}}\"'&";

/// A grey picture of 21×21 px.
const JPEG: &[u8] = include_bytes!("grey.jpg");

/// A take with hostile names and gaps, as many frames long.
fn hostile(frames: u64) -> Take {
    let mut take = sample::open_close(Side::Left);
    HOSTILE.clone_into(&mut take.header.views[0]);
    take.header.model = Some(HOSTILE.to_owned());
    take.frames[6].doubts.push(HOSTILE.to_owned());
    let once = take.frames.clone();
    take.frames = (0..frames)
        .map(|k| {
            let mut frame = once[k as usize % once.len()].clone();
            (frame.index, frame.time) = (k, k as f64 / 60.0);
            frame.views[0] = FrameView {
                overlap: frame.views[0].overlap.map(|o| o - 0.001 * (k % 97) as f64),
                ..frame.views[0]
            };
            frame
        })
        .collect();
    take
}

fn pictures() -> ViewPictures {
    let picture = |frame| ViewPicture {
        frame,
        jpeg: JPEG.to_vec(),
        joints: std::array::from_fn(|k| (k != 7).then(|| DVec2::splat(k as f64))),
        outline: vec![vec![DVec2::new(2.0, 3.0), DVec2::new(18.0, 4.0), DVec2::new(9.0, 17.0)]],
    };
    let pictures = [0, 20, 40].map(picture).to_vec();
    ViewPictures { name: HOSTILE.to_owned(), width: JOINTS as u32, height: JOINTS as u32, pictures }
}

#[test]
fn no_name_becomes_markup_and_nothing_comes_from_elsewhere() {
    let page = view_page(&hostile(80), HOSTILE, &[pictures()]).unwrap();
    assert_eq!(page.matches("<script").count(), 2, "the data and the page's own");
    assert_eq!(page.matches("</script").count(), 2);
    assert!(!page.contains("<b>") && page.contains("&lt;b&gt;{{data}}"));
    for outside in ["http:", "https:", "src=\"/", "@import", "fetch("] {
        assert!(!page.contains(outside), "{outside}");
    }
}

#[test]
fn empty_and_endless_takes_make_pages() {
    let mut take = hostile(1);
    take.frames.clear();
    assert!(view_page(&take, "empty", &[]).unwrap().contains("No frame can be trusted."));
    let page = view_page(&hostile(45_000), "long", &[]).unwrap();
    assert!(page.contains("every 3th is shown") && page.len() < 20 << 20);
    let beyond = view_page(&hostile(30), "short", &[pictures()]).unwrap_err().to_string();
    assert!(beyond.contains("picture of frame 40; the take has 30 frames"), "{beyond}");
}

#[test]
#[ignore = "installs Chromium from Debian, and playwright-core and axe-core from npm"]
fn a_browser_runs_the_page_and_axe_finds_nothing_serious() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("browser");
    let packages = ["playwright-core@1", "axe-core@4"];
    let Some(modules) = node_modules(&folder, &packages) else { return };
    let Some(()) = program("chromium", &["chromium", "fonts-dejavu-core"]) else { return };
    let pages = [
        ("drawn.html", view_page(&sample::open_close(Side::Right), "open and close", &[])),
        ("hostile.html", view_page(&hostile(80), HOSTILE, &[pictures()])),
        ("long.html", view_page(&hostile(10_000), "ten thousand frames", &[])),
    ];
    for (name, page) in pages {
        let file = folder.join(name);
        std::fs::write(&file, page.unwrap()).unwrap();
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/io/pages/browser.cjs");
        run(Command::new("node").arg(script).arg(&modules).arg(file));
    }
}
