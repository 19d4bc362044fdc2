//! The baseline: a detector's landmarks, triangulated.

use anyhow::{Context, Result, ensure};
use glam::DVec3;
use phalanx::Progress;
use phalanx_camera::{Camera, Ray, triangulate};
use phalanx_hand::JOINTS;

use super::frame::FrameName;
use super::method::{Found, Method, Outcome, Sequence};
use super::reference::Reference;

/// Joints where the cameras' landmarks meet.
pub struct Landmarks<'a>(pub &'a Reference);

impl Method for Landmarks<'_> {
    fn name(&self) -> &'static str {
        "landmarks"
    }

    fn run(&self, sequence: &Sequence<'_>, _: &dyn Progress) -> Result<Vec<Outcome>> {
        let cameras = sequence.cameras();
        let outcome = |frame| Outcome {
            found: self.joints(frame, &cameras, sequence.views).map(|joints| Found {
                joints,
                solids: Vec::new(),
                deviations: None,
                doubts: Vec::new(),
                left_out: Vec::new(),
            }),
            cpu_ms: None, // the detector's would have to be in it
        };
        Ok(sequence.frames.iter().map(outcome).collect())
    }
}

impl Landmarks<'_> {
    fn joints(
        &self,
        frame: &FrameName,
        cameras: &[Camera],
        views: &[usize],
    ) -> Result<[DVec3; JOINTS]> {
        let mut joints = [DVec3::ZERO; JOINTS];
        for (joint, place) in joints.iter_mut().enumerate() {
            let ray = |(camera, &view): (&Camera, &usize)| -> Option<Ray> {
                camera.unproject(self.0.landmarks[view].get(frame)?[joint]?)
            };
            let rays: Vec<Ray> = cameras.iter().zip(views).filter_map(ray).collect();
            ensure!(rays.len() > 1, "joint {joint} has no landmark in two views");
            *place = triangulate(&rays).with_context(|| format!("joint {joint}"))?.point;
        }
        Ok(joints)
    }
}
