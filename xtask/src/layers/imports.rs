//! What a file imports from its own crate.

/// The paths that a source names, without its tests and comments: those that begin with `crate`,
/// `super` or `self`, and all that `use` names.
pub(super) fn paths(source: &str) -> Vec<String> {
    let mut paths = Vec::new();
    // The tree of the `use` that we are in.
    let mut tree: Option<String> = None;
    for line in code(source) {
        let start = line.strip_prefix("pub").map_or(line, after_visibility);
        if let Some(begun) = start.strip_prefix("use ") {
            tree = Some(begun.to_owned());
        } else if let Some(tree) = &mut tree {
            tree.push_str(line);
        } else {
            named(line, &mut paths);
        }
        if let Some(whole) = tree.take_if(|tree| tree.ends_with(';')) {
            expand("", whole.trim_end_matches(';'), &mut paths);
        }
    }
    paths
}

/// What follows a `pub`, with or without brackets.
fn after_visibility(rest: &str) -> &str {
    let open = rest.strip_prefix('(').and_then(|scope| scope.split_once(')'));
    open.map_or(rest, |(_, rest)| rest).trim_start()
}

/// Paths within the crate that code names where it needs them.
fn named(code: &str, paths: &mut Vec<String>) {
    for (at, root) in code.match_indices("crate::") {
        let path = &code[at + root.len()..];
        let end = path.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':'));
        let path = path[..end.unwrap_or(path.len())].trim_end_matches(':');
        paths.extend((!path.is_empty()).then(|| format!("{root}{path}")));
    }
}

/// The paths of a tree like `a::{b, c::{d, e}}`.
fn expand(prefix: &str, tree: &str, paths: &mut Vec<String>) {
    let tree = tree.trim();
    let (Some(open), Some(close)) = (tree.find('{'), tree.rfind('}')) else {
        let path = tree.split(" as ").next().unwrap_or(tree);
        paths.extend((!path.is_empty()).then(|| format!("{prefix}{path}")));
        return;
    };
    let prefix = format!("{prefix}{}", &tree[..open]);
    let (mut depth, mut start) = (0, open + 1);
    for (at, c) in tree[..close].char_indices().skip_while(|&(at, _)| at <= open) {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                expand(&prefix, &tree[start..at], paths);
                start = at + 1;
            }
            _ => {}
        }
    }
    expand(&prefix, &tree[start..close], paths);
}

/// The lines of a source up to its tests, which end it, without comments.
fn code(source: &str) -> impl Iterator<Item = &str> {
    let end = source.find("#[cfg(test)]\nmod tests").unwrap_or(source.len());
    source[..end].lines().map(str::trim).filter(|line| !line.starts_with("//"))
}

#[cfg(test)]
mod tests {
    use super::paths;

    #[test]
    fn trees_are_spelt_out_and_tests_left_out() {
        let source = "
//! [`a`](crate::a)
use std::fmt;
pub(crate) use crate::{a::B, c::{self, D as E,
    f::*}};

fn g() -> crate::h::I {}

#[cfg(test)]
mod tests {
    use crate::j;
}
";
        let wanted = ["std::fmt", "crate::a::B", "crate::c::self", "crate::c::D", "crate::c::f::*"];
        assert_eq!(paths(source), [&wanted[..], &["crate::h::I"]].concat());
    }
}
