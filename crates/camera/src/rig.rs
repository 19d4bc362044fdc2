//! Cameras that look at one hand.

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

use crate::camera::Camera;
use crate::error::{Error, Result};
use crate::volume::Volume;

/// Any number of calibrated cameras and the volume in which the hand works.
///
/// Rigs are read from and written to TOML with [`from_toml`](Self::from_toml) and
/// [`to_toml`](Self::to_toml). A rig that came another way is checked with
/// [`validate`](Self::validate).
///
/// ```
/// use phalanx_camera::Rig;
///
/// let rig = Rig::from_toml(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/desk.toml")))?;
/// let [first, .., last] = &rig.cameras[..] else { panic!("a desk has several cameras") };
/// let pair = rig.select(&[&last.name, &first.name])?;
/// assert_eq!(pair.cameras[1], *first);
/// assert!(rig.camera("under the desk").is_err());
/// assert_eq!(Rig::from_toml(&pair.to_toml()?)?, pair);
/// # Ok::<(), phalanx_camera::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Rig {
    /// The cameras, in an order that every consumer keeps.
    pub cameras: Vec<Camera>,
    /// Where the hand works.
    pub volume: Volume,
}

impl Rig {
    /// The camera of this name.
    pub fn camera(&self, name: &str) -> Result<&Camera> {
        self.cameras.iter().find(|camera| camera.name == name).ok_or_else(|| Error::UnknownCamera {
            name: name.to_owned(),
            names: self.cameras.iter().map(|camera| camera.name.clone()).collect(),
        })
    }

    /// The rig of some of the cameras, in the order asked for.
    pub fn select(&self, names: &[impl AsRef<str>]) -> Result<Self> {
        let cameras = names.iter().map(|name| self.camera(name.as_ref()).cloned());
        let rig = Self { cameras: cameras.collect::<Result<_>>()?, volume: self.volume };
        rig.validate_names()?;
        Ok(rig)
    }

    /// Checks each camera and the volume, that names are unique, and that every camera has its
    /// principal point inside its picture, sees the middle of the volume, and has a lens that does not
    /// fold over where the volume is seen.
    pub fn validate(&self) -> Result<()> {
        self.validate_names()?;
        self.volume.validate()?;
        for camera in &self.cameras {
            camera.validate()?;
            self.validate_view(camera)?;
        }
        Ok(())
    }

    fn validate_names(&self) -> Result<()> {
        if self.cameras.is_empty() {
            return Err(Error::NoCamera);
        }
        for (index, camera) in self.cameras.iter().enumerate() {
            if self.cameras[..index].iter().any(|earlier| earlier.name == camera.name) {
                return Err(Error::DuplicateName { camera: camera.name.clone() });
            }
        }
        Ok(())
    }

    fn validate_view(&self, camera: &Camera) -> Result<()> {
        let name = || camera.name.clone();
        // An overflow to NaN counts as behind.
        let in_front = camera.extrinsics.to_camera(self.volume.center).z > 0.0;
        if !in_front {
            return Err(Error::VolumeBehind { camera: name() });
        }
        let point = camera.intrinsics.principal_point();
        if !camera.intrinsics.contains(point) {
            return Err(Error::PrincipalPoint { camera: name(), point });
        }
        if let Some(pixel) = self.fold_in_view(camera) {
            return Err(Error::Folding { camera: name(), pixel });
        }
        match camera.project(self.volume.center) {
            Some(pixel) if camera.intrinsics.contains(pixel) => Ok(()),
            _ => Err(Error::VolumeOutside { camera: name() }),
        }
    }

    /// Where a camera's picture of the volume reaches the fold of its lens: at the volume's corners,
    /// and the middles of its edges and sides.
    fn fold_in_view(&self, camera: &Camera) -> Option<DVec2> {
        let frame = self.volume.rest_frame();
        let half = [-0.5, 0.0, 0.5];
        let grid = half.iter().flat_map(|&x| half.iter().map(move |&y| (x, y)));
        let grid = grid.flat_map(|(x, y)| half.iter().map(move |&z| DVec3::new(x, y, z)));
        grid.filter_map(|share| {
            let world = frame.transform_point3(share * self.volume.size);
            let p = camera.extrinsics.to_camera(world);
            (p.z > 0.0).then(|| p.truncate() / p.z)
        })
        .find_map(|direction| camera.intrinsics.fold_before(direction))
    }
}
