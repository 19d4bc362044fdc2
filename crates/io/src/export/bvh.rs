//! BVH: the person's own bones and their turns, for animation.

use glam::{DAffine3, DMat3, DQuat, DVec3, EulerRot};

use crate::error::Result;
use crate::export::placement::Placement;
use crate::export::timing::{filled_poses, frame_rate};
use crate::model::{BONE_NAMES, BONES, Skeleton, SkeletonBone};
use crate::take::Take;

/// A bone's channels. The turns compose in this order: R = R_Z R_X R_Y.
const TURNS: &str = "Zrotation Xrotation Yrotation";

/// The take as a BVH file: the wrist's place and 17 bones, degrees. Where no hand was found the
/// pose before is kept. The rate is even: see [`largest_jitter`](super::largest_jitter).
///
/// # Errors
/// [`crate::Error::NoPose`] for a take without one; a take that does not keep to [`Take::validate`].
pub fn bvh(take: &Take, placement: Placement) -> Result<String> {
    take.validate()?;
    let poses = filled_poses(take, "BVH")?;
    let skeleton = Skeleton::new(&take.header.hand);
    let scale = placement.unit.per_mm();
    let mut lines = vec!["HIERARCHY".to_owned()];
    push_bone(&mut lines, &skeleton, 0, 0, scale);
    let period = 1.0 / frame_rate(take);
    lines.extend(["MOTION".to_owned(), format!("Frames: {}", poses.len())]);
    lines.push(format!("Frame Time: {period:.7}"));
    let file_from_hand = placement.file_from_world(&take.header) * take.header.world_from_hand;
    for pose in &poses {
        let place = file_from_hand.transform_point3(pose.translation()) * scale;
        let mut cells = place.to_array().to_vec();
        for (bone, rotation) in skeleton.rotations(pose).into_iter().enumerate() {
            let turn = if bone == 0 { turn_of(&file_from_hand) * rotation } else { rotation };
            let (z, x, y) = turn.to_euler(EulerRot::ZXY);
            cells.extend([z, x, y].map(f64::to_degrees));
        }
        let cells: Vec<String> = cells.iter().map(|cell| format!("{cell:.6}")).collect();
        lines.push(cells.join(" "));
    }
    lines.push(String::new());
    Ok(lines.join("\n"))
}

fn turn_of(frame: &DAffine3) -> DQuat {
    let DMat3 { x_axis, y_axis, z_axis } = frame.matrix3;
    DQuat::from_mat3(&DMat3::from_cols(x_axis, y_axis, z_axis)).normalize()
}

/// A bone and all that it carries.
fn push_bone(lines: &mut Vec<String>, skeleton: &Skeleton, bone: usize, depth: usize, scale: f64) {
    let indent = "\t".repeat(depth);
    let (kind, channels) = match depth {
        0 => ("ROOT", "6 Xposition Yposition Zposition"),
        _ => ("JOINT", "3"),
    };
    let SkeletonBone { offset, tip, .. } = &skeleton.bones[bone];
    lines.push(format!("{indent}{kind} {}", BONE_NAMES[bone]));
    lines.push(format!("{indent}{{"));
    lines.push(format!("{indent}\tOFFSET {}", cells(*offset * scale)));
    lines.push(format!("{indent}\tCHANNELS {channels} {TURNS}"));
    for child in (0..BONES).filter(|&child| skeleton.bones[child].parent == Some(bone)) {
        push_bone(lines, skeleton, child, depth + 1, scale);
    }
    if let Some(tip) = tip {
        lines.extend(["End Site", "{"].map(|line| format!("{indent}\t{line}")));
        lines.push(format!("{indent}\t\tOFFSET {}", cells(*tip * scale)));
        lines.push(format!("{indent}\t}}"));
    }
    lines.push(format!("{indent}}}"));
}

fn cells(point: DVec3) -> String {
    format!("{:.6} {:.6} {:.6}", point.x, point.y, point.z)
}
