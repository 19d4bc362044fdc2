//! From the cameras' pictures to what is seen in them, and to a pose.

use phalanx_camera::Camera;
use phalanx_segmentation::{Mask, Silhouette};

use crate::checking::doubt::{Cause, ViewDoubt};
use crate::error::{Error, Result};
use crate::estimator::answering::Workspace;
use crate::estimator::estimate::Estimate;
use crate::estimator::model::Estimator;
use crate::estimator::observation::{Observation, ObservedView};
use crate::images::picture::Picture;
use crate::losses;
use crate::window::Framing;

impl Estimator {
    /// Estimates the pose from the cameras' pictures, in the order of the rig. Pictures may be missing
    /// (`None`), and a view in which no hand is found counts as missing too, which is a
    /// [doubt](Cause::NotSeen); at least one must show the hand.
    ///
    /// Presets learn to answer any cameras, a rig of more than four those of the largest learnt subset: all,
    /// all but one, two or one. By other regressors every camera's view is needed.
    ///
    /// # Errors
    /// Another number of pictures, a picture of another shape than its camera's image, or no hand in any,
    /// or in one that is needed.
    pub fn estimate<'p, P>(&self, pictures: &[P], workspace: &mut Workspace) -> Result<Estimate>
    where
        P: Into<Option<Picture<'p>>> + Copy,
    {
        self.check_count(pictures.len())?;
        let pictures = pictures.iter().map(|&picture| picture.into()).enumerate();
        let mut given: Vec<(usize, Picture<'p>)> =
            pictures.filter_map(|(view, picture)| Some((view, picture?))).collect();
        for &(view, picture) in &given {
            self.check_shape(view, picture.size())?;
        }
        if given.is_empty() {
            return Err(self.wrong_count(0));
        }
        let mut not_seen = Vec::new();
        let mut first = None;
        loop {
            let error = match self.estimate_given(&given, workspace) {
                Ok(mut estimate) => {
                    estimate.doubts.extend(not_seen);
                    estimate.doubts.sort_by_key(|doubt| doubt.view);
                    return Ok(estimate);
                }
                Err(error) => error,
            };
            let Some(doubt) = self.not_seen(&error).filter(|_| self.subsets().is_some()) else {
                return Err(error);
            };
            given.retain(|(view, _)| *view != doubt.view);
            not_seen.push(doubt);
            let error = first.get_or_insert(error);
            if given.is_empty() {
                return Err(std::mem::replace(error, Error::NoHand));
            }
        }
    }

    /// The doubt about a view for which an estimate failed, if that is because it shows no hand.
    fn not_seen(&self, error: &Error) -> Option<ViewDoubt> {
        let (camera, reason) = losses::not_seen(error)?;
        let view = self.rig().cameras.iter().position(|known| known.name == camera)?;
        Some(ViewDoubt { view, cause: Cause::NotSeen(reason) })
    }

    /// Estimates the pose from the pictures of some cameras, by their numbers.
    fn estimate_given(
        &self,
        pictures: &[(usize, Picture<'_>)],
        workspace: &mut Workspace,
    ) -> Result<Estimate> {
        let observation = match self.framing() {
            Framing::Picture => self.see_whole(pictures, workspace)?,
            Framing::Window => self.see_through_windows(pictures, workspace)?,
        };
        self.estimate_observation(observation, workspace)
    }

    /// The silhouettes of whole pictures.
    fn see_whole(
        &self,
        pictures: &[(usize, Picture<'_>)],
        workspace: &mut Workspace,
    ) -> Result<Observation> {
        let describer = &mut workspace.description.describer;
        let see = |&(camera, picture): &(usize, Picture<'_>)| {
            let mut silhouette = Silhouette::default();
            describer
                .silhouette(picture, &mut silhouette)
                .map_err(|reason| Error::Silhouette { camera: self.camera(camera), reason })?;
            Ok(ObservedView { camera, silhouette, window: None, picture: picture.size() })
        };
        Ok(Observation { views: pictures.iter().map(see).collect::<Result<_>>()? })
    }

    /// The silhouettes of the hand in windows of pictures.
    fn see_through_windows(
        &self,
        pictures: &[(usize, Picture<'_>)],
        workspace: &mut Workspace,
    ) -> Result<Observation> {
        let mask = |&(camera, picture): &(usize, Picture<'_>)| {
            let mask = picture.mask();
            mask.map_err(|reason| Error::Silhouette { camera: self.camera(camera), reason })
        };
        let masks = pictures.iter().map(mask).collect::<Result<Vec<Mask>>>()?;
        let cameras: Vec<Camera> =
            pictures.iter().map(|(camera, _)| self.rig().cameras[*camera].clone()).collect();
        let windows = workspace.windows.find(&cameras, &masks, None)?;
        let mut silhouettes = vec![Silhouette::default(); windows.len()];
        workspace.windows.silhouettes(&windows, &mut silhouettes)?;
        let views = silhouettes.into_iter().zip(windows).zip(pictures);
        let view = |((silhouette, window), (camera, picture)): ((_, _), &(usize, Picture<'_>))| {
            ObservedView {
                camera: *camera,
                silhouette,
                window: Some(window),
                picture: picture.size(),
            }
        };
        Ok(Observation { views: views.map(view).collect() })
    }

    /// The picture must be a scaled copy of the camera's image, to within a pixel.
    fn check_shape(&self, view: usize, found: (u32, u32)) -> Result<()> {
        let intrinsics = &self.rig().cameras[view].intrinsics;
        let expected = (intrinsics.width, intrinsics.height);
        let height = f64::from(found.0) * f64::from(expected.1) / f64::from(expected.0);
        if (height - f64::from(found.1)).abs() <= 1.0 {
            return Ok(());
        }
        Err(Error::PictureShape { camera: self.camera(view), found, expected })
    }
}
