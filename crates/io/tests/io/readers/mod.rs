//! Readers of other tools open what is written, and read the same values. The test installs them
//! from their registries (PyPI, npm), so it runs only when asked to:
//! `cargo test --workspace --test io -- --ignored readers`.

use std::path::{Path, PathBuf};
use std::process::Command;

use phalanx_hand::Side;
use phalanx_io::export::{
    Axes, CoordinateNames, LengthUnit, Placement, bvh, c3d, deviation_file, glb, motion_file, trc,
};
use phalanx_io::take::{Take, json_schema, write_csv, write_json_lines, write_npz};

use crate::installed::{self, node_modules, run};
use crate::sample;

const PYTHON: [&str; 6] =
    ["bvh==0.3", "ezc3d==1.7.2", "jsonschema", "numpy", "opensim==4.6", "pandas"];
const NODE: &str = "gltf-validator@2.0.0-dev.3.10";

/// Where the readers are installed and the files written.
fn folder() -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join("readers")
}

fn script(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/io/readers").join(name)
}

fn write_all(take: &Take, folder: &Path) {
    std::fs::create_dir_all(folder).unwrap();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.join(name), bytes).unwrap();
    let placed = |axes, unit| Placement { axes, unit };
    let (millimetre, metre) = (LengthUnit::Millimetre, LengthUnit::Metre);
    let (mut csv, mut lines) = (Vec::new(), Vec::new());
    write_csv(take, &mut csv).unwrap();
    write_json_lines(take, &mut lines).unwrap();
    write("take.csv", &csv);
    write("take.jsonl", &lines);
    write("take.npz", &write_npz(take).unwrap());
    write("schema.json", json_schema().to_string().as_bytes());
    let y_up = Axes::Turned(glam::DMat3::from_rotation_x(-std::f64::consts::FRAC_PI_2));
    write("take.trc", trc(take, "take.trc", placed(y_up, metre)).unwrap().as_bytes());
    for (name, names) in [
        ("phalanx", CoordinateNames::Phalanx),
        ("opensim", CoordinateNames::OpenSim),
        ("myohand", CoordinateNames::MyoHand),
    ] {
        let files =
            [motion_file, deviation_file].map(|file| file(take, names, millimetre).unwrap());
        write(&format!("{name}.mot"), files[0].as_bytes());
        write(&format!("{name}_std.sto"), files[1].as_bytes());
    }
    write("take.c3d", &c3d(take, Placement::WORLD).unwrap());
    let centimetres = placed(Axes::World, LengthUnit::Centimetre);
    write("take.bvh", bvh(take, centimetres).unwrap().as_bytes());
    write("take.glb", &glb(take, placed(Axes::World, metre)).unwrap());
}

#[test]
#[ignore = "installs opensim, ezc3d, bvh, pandas and jsonschema from PyPI"]
fn python_s_readers_read_the_same_values() {
    let Some(python) = installed::python(&folder(), &PYTHON) else { return };
    for (name, side) in [("right", Side::Right), ("left", Side::Left)] {
        let files = folder().join(name);
        write_all(&sample::open_close(side), &files);
        // OpenSim leaves a log where it runs.
        run(Command::new(&python).arg(script("readers.py")).arg(&files).current_dir(&files));
    }
}

#[test]
#[ignore = "installs gltf-validator from npm"]
fn the_validator_of_gltf_finds_nothing() {
    let files = folder().join("validated");
    write_all(&sample::open_close(Side::Left), &files);
    let Some(modules) = node_modules(&folder(), &[NODE]) else { return };
    run(Command::new("node")
        .arg(script("validate.cjs"))
        .arg(modules.join("gltf-validator"))
        .arg(files.join("take.glb")));
}
