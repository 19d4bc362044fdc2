//! glTF 2.0 as one binary file: a skinned hand that moves.

use glam::{DAffine3, DQuat, DVec3};
use serde_json::{Value, json};

use crate::error::{Error, Result};
use crate::export::placement::{LengthUnit, Placement};
use crate::export::timing::filled_poses;
use crate::model::{BONE_NAMES, BONES, Skeleton, Skin};
use crate::take::{Take, TakeFrame};

/// The file's mark, version and the kinds of its two chunks.
const MARK: u32 = 0x4654_6C67;
const VERSION: u32 = 2;
const JSON: u32 = 0x4E4F_534A;
const BINARY: u32 = 0x004E_4942;

/// Kinds of numbers and of buffers, as OpenGL has them.
const U8: u32 = 5121;
const U16: u32 = 5123;
const F32: u32 = 5126;
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;

/// The take as a `.glb` file: a hand of 17 bones with a skin, and one animation that begins at
/// 0 s. Frames in which no hand was found are left out, and viewers move on between those around
/// them. By the format's rules lengths are metres and Y is up: choose the placement so.
///
/// # Errors
/// [`Error::NoPose`] for a take without one; [`Error::Unit`] for another unit than metres; a take
/// that does not keep to [`Take::validate`].
pub fn glb(take: &Take, placement: Placement) -> Result<Vec<u8>> {
    take.validate()?;
    if placement.unit != LengthUnit::Metre {
        return Err(Error::Unit { format: "glTF", units: "m" });
    }
    let found = |frame: &&TakeFrame| frame.estimate.is_some();
    let frames: Vec<TakeFrame> = take.frames.iter().filter(found).cloned().collect();
    let take = Take { header: take.header.clone(), frames };
    let poses = filled_poses(&take, "glTF")?;
    let (skeleton, skin) = (Skeleton::new(&take.header.hand), Skin::new(&take.header.hand));
    let mut file = Buffers::default();
    let mesh = file.mesh(&skin);
    let inverse = file.inverse_binds(&skeleton);
    let animation = {
        let start = take.frames.first().map_or(0.0, |frame| frame.time);
        let times: Vec<f32> = take.frames.iter().map(|frame| (frame.time - start) as f32).collect();
        let places: Vec<[f32; 3]> =
            poses.iter().map(|pose| metres(pose.translation()).to_array()).collect();
        let turns = poses.iter().map(|pose| skeleton.rotations(pose)).collect::<Vec<_>>();
        file.animation(&times, &places, &turns)
    };
    let placed = placement.file_from_world(&take.header) * take.header.world_from_hand;
    let json = json!({
        "asset": { "version": "2.0", "generator": concat!("phalanx ", env!("CARGO_PKG_VERSION")) },
        "scene": 0,
        "scenes": [{ "nodes": [BONES, BONES + 1] }],
        "nodes": nodes(&skeleton, &placed),
        "meshes": [mesh],
        "skins": [{
            "joints": (0..BONES).collect::<Vec<_>>(),
            "skeleton": 0,
            "inverseBindMatrices": inverse,
        }],
        "materials": [{
            "name": "skin",
            "pbrMetallicRoughness":
                { "baseColorFactor": [0.82, 0.66, 0.56, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.8 },
        }],
        "animations": [animation],
        "accessors": file.accessors,
        "bufferViews": file.views,
        "buffers": [{ "byteLength": file.bytes.len() }],
    });
    container(&json, file.bytes)
}

/// The bones, then what places them in the world, then the skin.
fn nodes(skeleton: &Skeleton, placed: &DAffine3) -> Vec<Value> {
    let bone = |k: usize| {
        let carried = |&child: &usize| skeleton.bones[child].parent == Some(k);
        let children: Vec<usize> = (0..BONES).filter(carried).collect();
        let this = &skeleton.bones[k];
        let mut node = json!({
            "name": BONE_NAMES[k],
            "translation": metres(this.offset).to_array(),
            "rotation": quaternion(this.rest),
        });
        if !children.is_empty() {
            node["children"] = json!(children);
        }
        node
    };
    let mut nodes: Vec<Value> = (0..BONES).map(bone).collect();
    nodes.push(json!({
        "name": "world",
        "translation": metres(placed.translation).to_array(),
        "rotation": quaternion(DQuat::from_mat3(&placed.matrix3).normalize()),
        "children": [0],
    }));
    nodes.push(json!({ "name": "hand", "mesh": 0, "skin": 0 }));
    nodes
}

fn metres(mm: DVec3) -> glam::Vec3 {
    (mm * 1e-3).as_vec3()
}

fn quaternion(turn: DQuat) -> [f32; 4] {
    turn.as_quat().normalize().to_array()
}

/// The file's bytes with what describes them.
#[derive(Default)]
struct Buffers {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Buffers {
    /// Adds numbers of one kind and gives their accessor's index.
    fn push(&mut self, bytes: &[u8], target: Option<u32>, accessor: Value) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let mut view =
            json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() });
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.bytes.extend(bytes);
        self.views.push(view);
        let mut accessor = accessor;
        accessor["bufferView"] = (self.views.len() - 1).into();
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// Vectors of reals; their bounds are given where `target` is that of vertices.
    fn reals<const N: usize>(
        &mut self,
        values: &[[f32; N]],
        kind: &str,
        target: Option<u32>,
    ) -> usize {
        let bytes: Vec<u8> =
            values.iter().flatten().flat_map(|value| value.to_le_bytes()).collect();
        let bound = |of: fn(f32, f32) -> f32, start: f32| -> Vec<f32> {
            (0..N).map(|k| values.iter().map(|value| value[k]).fold(start, of)).collect()
        };
        let accessor = json!({
            "componentType": F32,
            "count": values.len(),
            "type": kind,
            "min": bound(f32::min, f32::INFINITY),
            "max": bound(f32::max, f32::NEG_INFINITY),
        });
        self.push(&bytes, target, accessor)
    }

    fn mesh(&mut self, skin: &Skin) -> Value {
        let positions: Vec<[f32; 3]> =
            skin.positions.iter().map(|at| metres(*at).to_array()).collect();
        let normals: Vec<[f32; 3]> =
            skin.normals.iter().map(|n| n.as_vec3().normalize().to_array()).collect();
        let count = skin.bones.len();
        let joints: Vec<u8> = skin.bones.iter().flat_map(|&bone| [bone, 0, 0, 0]).collect();
        let weights: Vec<u8> = skin.bones.iter().flat_map(|_| [255, 0, 0, 0]).collect();
        let indices: Vec<u8> =
            skin.triangles.iter().flatten().flat_map(|corner| corner.to_le_bytes()).collect();
        let of_bytes = json!({ "componentType": U8, "count": count, "type": "VEC4" });
        let mut normalized = of_bytes.clone();
        normalized["normalized"] = true.into();
        let corners = json!({
            "componentType": U16, "count": 3 * skin.triangles.len(), "type": "SCALAR",
        });
        json!({ "primitives": [{
            "attributes": {
                "POSITION": self.reals(&positions, "VEC3", Some(VERTICES)),
                "NORMAL": self.reals(&normals, "VEC3", Some(VERTICES)),
                "JOINTS_0": self.push(&joints, Some(VERTICES), of_bytes),
                "WEIGHTS_0": self.push(&weights, Some(VERTICES), normalized),
            },
            "indices": self.push(&indices, Some(INDICES), corners),
            "material": 0,
        }] })
    }

    /// From the root's frame at rest to each bone's.
    fn inverse_binds(&mut self, skeleton: &Skeleton) -> usize {
        let matrices = skeleton.frames(&phalanx_hand::Pose::REST).map(|frame| {
            let inverse = frame.inverse();
            let placed = DAffine3 { translation: inverse.translation * 1e-3, ..inverse };
            glam::DMat4::from(placed).as_mat4().to_cols_array()
        });
        self.reals(&matrices, "MAT4", None)
    }

    /// Where the root goes and how every bone turns.
    fn animation(&mut self, times: &[f32], places: &[[f32; 3]], turns: &[[DQuat; BONES]]) -> Value {
        let times: Vec<[f32; 1]> = times.iter().map(|&time| [time]).collect();
        let input = self.reals(&times, "SCALAR", None);
        let mut samplers =
            vec![json!({ "input": input, "output": self.reals(places, "VEC3", None) })];
        let mut channels =
            vec![json!({ "sampler": 0, "target": { "node": 0, "path": "translation" } })];
        for bone in 0..BONES {
            let turns: Vec<[f32; 4]> = turns.iter().map(|turns| quaternion(turns[bone])).collect();
            let sampler = json!({ "input": input, "output": self.reals(&turns, "VEC4", None) });
            channels.push(json!({
                "sampler": samplers.len(),
                "target": { "node": bone, "path": "rotation" },
            }));
            samplers.push(sampler);
        }
        json!({ "name": "take", "samplers": samplers, "channels": channels })
    }
}

/// The two chunks in one file.
fn container(json: &Value, mut binary: Vec<u8>) -> Result<Vec<u8>> {
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    binary.resize(binary.len().next_multiple_of(4), 0);
    let too_long = |_| Error::TooLong { format: "glTF", most: u32::MAX as usize };
    let total = u32::try_from(12 + 8 + text.len() + 8 + binary.len()).map_err(too_long)?;
    let mut bytes: Vec<u8> =
        [MARK, VERSION, total].into_iter().flat_map(u32::to_le_bytes).collect();
    for (kind, chunk) in [(JSON, text), (BINARY, binary)] {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(kind.to_le_bytes());
        bytes.extend(chunk);
    }
    Ok(bytes)
}
