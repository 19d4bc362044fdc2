//! Where along the hand the contour points are that vote for a codebook's centres.

use anyhow::{Context, Result, ensure};
use glam::{DAffine3, DVec2, DVec3};
use phalanx::{Describer, Picture, draw_silhouette, working_camera};
use phalanx_camera::Camera;
use phalanx_codebook::{AnyEncoder, Encoder, Scratch};
use phalanx_hand::{HandShape, Pose};
use phalanx_segmentation::Silhouette;
use phalanx_shape_context::BINS;
use rayon::prelude::*;

use crate::context::Lab;
use crate::data::described::Described;

/// Where along the hand a feature's votes come from: means over all poses weighted by the votes,
/// mm along the forearm's direction.
pub(super) struct Place {
    /// Distance from the wrist, on either side.
    pub(super) from_wrist: f64,
    /// Distance from the foremost point of the contour.
    pub(super) from_tip: f64,
    /// The distance of all contour points from the wrist, whatever they vote for.
    pub(super) all_from_wrist: f64,
}

impl Place {
    pub(super) fn is_near_the_wrist(&self) -> bool {
        self.from_wrist < self.from_tip
    }
}

/// The place of every centre of a camera's codebook.
pub(super) fn places(
    described: &Described,
    camera: usize,
    along: &[Vec<f64>],
    encoder: &AnyEncoder,
) -> Result<Vec<Place>> {
    /// Sums over contour points: the votes for each centre, those times the distances from wrist
    /// and tip, and the distances from the wrist.
    struct Sums {
        votes: Vec<[f64; 3]>,
        points: [f64; 2],
    }
    let of_pose = |scratch: &mut Scratch, pose: usize| -> Result<Sums> {
        let (along, mut x) = (&along[pose], vec![0.0; encoder.dim()]);
        let contexts = described.contexts[pose][camera].chunks(BINS);
        ensure!(contexts.len() == along.len(), "pose {pose} was described otherwise");
        let tip = along.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let mut sums = Sums { votes: vec![[0.0; 3]; encoder.dim()], points: [0.0; 2] };
        for (context, place) in contexts.zip(along) {
            encoder.encode(context, scratch, &mut x)?;
            for (sums, vote) in sums.votes.iter_mut().zip(&x) {
                add(sums, [*vote, vote * place.abs(), vote * (tip - place)]);
            }
            add(&mut sums.points, [1.0, place.abs()]);
        }
        Ok(sums)
    };
    let poses: Vec<Result<Sums>> =
        (0..described.poses.len()).into_par_iter().map_init(Scratch::default, of_pose).collect();
    let mut total = Sums { votes: vec![[0.0; 3]; encoder.dim()], points: [0.0; 2] };
    for sums in poses {
        let sums = sums?;
        total.votes.iter_mut().zip(sums.votes).for_each(|(total, sum)| add(total, sum));
        add(&mut total.points, sums.points);
    }
    let [points, all_wrist] = total.points;
    let place = |[votes, wrist, tip]: [f64; 3]| Place {
        from_wrist: wrist / votes,
        from_tip: tip / votes,
        all_from_wrist: all_wrist / points,
    };
    Ok(total.votes.into_iter().map(place).collect())
}

fn add<const N: usize>(total: &mut [f64; N], terms: [f64; N]) {
    total.iter_mut().zip(terms).for_each(|(total, term)| *total += term);
}

/// Of every pose, how far each contour point is ahead of the wrist in one camera, mm.
pub(super) fn along_the_hand(
    lab: &Lab<'_>,
    described: &Described,
    camera: usize,
) -> Result<Vec<Vec<f64>>> {
    let seen_by = &lab.rig.cameras[camera];
    let (wrist, ahead) = forearm_in(&working_camera(seen_by)?, lab)?;
    let (hand, rest) = (&lab.hand, lab.rig.volume.rest_frame());
    let of_pose = |describer: &mut Describer, pose: &Pose| -> Result<Vec<f64>> {
        let silhouette = silhouette(seen_by, hand, pose, &rest, describer)?;
        let along =
            |&point: &[f64; 2]| (DVec2::from(point) - wrist).dot(ahead) / ahead.length_squared();
        Ok(silhouette.contour.points.iter().map(along).collect())
    };
    described.poses.par_iter().map_init(Describer::default, of_pose).collect()
}

/// The wrist in a camera's image, and what a millimetre along the forearm is there, px.
fn forearm_in(camera: &Camera, lab: &Lab<'_>) -> Result<(DVec2, DVec2)> {
    const SPAN_MM: f64 = 100.0;
    let rest = lab.rig.volume.rest_frame();
    let seen = |z: f64| {
        let place = rest.transform_point3(DVec3::new(0.0, 0.0, z));
        camera.project(place).with_context(|| format!("camera '{}' looks away", camera.name))
    };
    Ok((seen(0.0)?, (seen(SPAN_MM)? - seen(0.0)?) / SPAN_MM))
}

/// What the data set's description saw.
pub(super) fn silhouette(
    camera: &Camera,
    hand: &HandShape,
    pose: &Pose,
    rest: &DAffine3,
    describer: &mut Describer,
) -> Result<Silhouette> {
    let mask = draw_silhouette(camera, hand, pose, rest)?;
    let mut silhouette = Silhouette::default();
    describer.silhouette(Picture::Mask(&mask), &mut silhouette)?;
    Ok(silhouette)
}
