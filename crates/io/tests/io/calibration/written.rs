//! What is written for other tools reads back.

use phalanx_camera::{Distortion, Rig, Volume};
use phalanx_io::calibration::{Unit, to_anipose_toml, to_opencv_yaml};

use super::reference::{RATIONAL, assert_same, brown, cameras, fisheye, read};

#[test]
fn exports_read_back_with_every_lens() {
    let rational = Distortion::from_coefficients(&RATIONAL).unwrap().into();
    for lens in [brown(), rational, fisheye(), Distortion::NONE.into()] {
        let cameras = cameras(lens);
        for (name, text) in
            [("a.toml", to_anipose_toml(&cameras)), ("a.yml", to_opencv_yaml(&cameras))]
        {
            let found = read(&[(name, text)], None).unwrap();
            assert_eq!((found.unit, found.notes), (Unit::MILLIMETRE, vec![]));
            assert_same(&found.cameras, &cameras, name);
            for (found, camera) in found.cameras.iter().zip(&cameras) {
                assert_eq!((&found.name, found.intrinsics), (&camera.name, camera.intrinsics));
                assert_eq!(found.extrinsics.translation, camera.extrinsics.translation);
            }
        }
    }
}

#[test]
fn rig_files_are_read_with_their_volume() {
    let cameras = cameras(fisheye());
    let rig = Rig { volume: Volume::between(&cameras, 200.0).unwrap(), cameras };
    let found = read(&[("rig.toml", rig.to_toml().unwrap())], None).unwrap();
    assert_eq!(found.volume, Some(rig.volume));
    assert_same(&found.cameras, &rig.cameras, "rig.toml");
}
