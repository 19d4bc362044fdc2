//! What tools call a hand's joints.

use phalanx_hand::JOINTS;

const FINGERS: [[&str; 2]; 5] = [
    ["thumb", "thumb"],
    ["index", "pointer"],
    ["middle", "long"],
    ["ring", "annular"],
    ["little", "pinky"],
];

/// The joint that a name means: `wrist`, a digit with one of its joints in any spelling
/// (`INDEX_FINGER_MCP`, `index-mcp`, `IndexMCP`), or a number, 0 to 20, alone or behind other letters.
pub(super) fn joint(name: &str) -> Option<usize> {
    let plain: String =
        name.chars().filter(char::is_ascii_alphanumeric).collect::<String>().to_lowercase();
    if plain.ends_with("wrist") {
        return Some(0);
    }
    let of = |(digit, names): (usize, &[&str; 2])| {
        let at = names.iter().find_map(|name| Some(plain.find(name)? + name.len()))?;
        let joints =
            if digit == 0 { ["cmc", "mcp", "ip", "tip"] } else { ["mcp", "pip", "dip", "tip"] };
        let joint = plain[at..].trim_start_matches("finger");
        Some(1 + 4 * digit + joints.iter().position(|own| *own == joint)?)
    };
    let named = FINGERS.iter().enumerate().find_map(of);
    let number = || {
        let digits = plain.trim_start_matches(|c: char| !c.is_ascii_digit());
        digits.parse().ok().filter(|&joint: &usize| joint < JOINTS)
    };
    named.or_else(number)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::take::JOINT_NAMES;

    #[test]
    fn joints_are_known_by_many_names() {
        for (k, name) in JOINT_NAMES.into_iter().enumerate() {
            assert_eq!(joint(name), Some(k), "{name}");
            assert_eq!(joint(&name.to_uppercase().replace('_', "-")), Some(k), "{name}");
            assert_eq!(joint(&k.to_string()), Some(k));
        }
        for (name, known) in [
            ("INDEX_FINGER_MCP", Some(5)),
            ("PINKY_TIP", Some(20)),
            ("right_wrist", Some(0)),
            ("hand_17", Some(17)),
            ("hand_21", None),
            ("index_knuckle", None),
            ("nose", None),
        ] {
            assert_eq!(joint(name), known, "{name}");
        }
    }
}
