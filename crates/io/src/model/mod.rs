//! The hand as other tools draw it: bones that turn, and a skin on them.

mod bones;
mod skin;

pub(crate) use bones::{BONE_NAMES, BONES, Skeleton, SkeletonBone};
pub(crate) use skin::Skin;
