//! Lists that files hold as objects with a key for each entry.

use std::collections::BTreeMap;
use std::marker::PhantomData;

use phalanx_hand::{Dof, JOINTS};
use serde::de::{Deserialize, Deserializer, Error as _};
use serde::ser::{Serialize, Serializer};

use crate::take::frames::JOINT_NAMES;

/// The keys of an object.
pub(super) trait Keys<const N: usize> {
    /// In the order of the list.
    fn names() -> [&'static str; N];
}

/// The 28 numbers of a pose.
#[derive(Debug, Clone, Copy)]
pub(super) struct Dofs;

/// The 21 joints.
#[derive(Debug, Clone, Copy)]
pub(super) struct Joints;

impl Keys<{ Dof::COUNT }> for Dofs {
    fn names() -> [&'static str; Dof::COUNT] {
        Dof::ALL.map(Dof::name)
    }
}

impl Keys<JOINTS> for Joints {
    fn names() -> [&'static str; JOINTS] {
        JOINT_NAMES
    }
}

/// A list whose file form is an object with exactly the keys `K`.
#[derive(Debug, Clone, Copy)]
pub(super) struct ByName<K, V, const N: usize>(pub(super) [V; N], PhantomData<K>);

/// By the names of the 28 numbers.
pub(super) type ByDof<V> = ByName<Dofs, V, { Dof::COUNT }>;
/// By the names of the 21 joints.
pub(super) type ByJoint<V> = ByName<Joints, V, JOINTS>;

impl<K, V, const N: usize> From<[V; N]> for ByName<K, V, N> {
    fn from(values: [V; N]) -> Self {
        Self(values, PhantomData)
    }
}

impl<K: Keys<N>, V: Serialize, const N: usize> Serialize for ByName<K, V, N> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(K::names().into_iter().zip(&self.0))
    }
}

impl<'de, K: Keys<N>, V: Deserialize<'de> + Copy, const N: usize> Deserialize<'de>
    for ByName<K, V, N>
{
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let named = BTreeMap::<String, V>::deserialize(deserializer)?;
        let names = K::names();
        if let Some(name) = named.keys().find(|name| !names.contains(&name.as_str())) {
            return Err(D::Error::custom(format!("unknown name '{name}'")));
        }
        let values = names.map(|name| named.get(name).copied().ok_or(name));
        if let Some(name) = values.iter().find_map(|value| value.as_ref().err()) {
            return Err(D::Error::custom(format!("'{name}' is absent")));
        }
        // Every entry is there by now.
        let mut found = values.into_iter().flatten();
        let values = std::array::from_fn(|_| found.next().expect("as many as names"));
        Ok(Self(values, PhantomData))
    }
}
