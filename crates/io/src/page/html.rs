//! Templates of pages, and texts within them.

/// A template with each `{{key}}` replaced; what is put in is not looked at again.
pub(crate) fn fill(template: &str, values: &[(&str, &str)]) -> String {
    let mut pieces = template.split("{{");
    let mut page = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        let value = piece.split_once("}}").and_then(|(key, rest)| {
            let (_, value) = values.iter().find(|(name, _)| *name == key)?;
            Some([*value, rest])
        });
        page.extend(value.unwrap_or(["{{", piece]));
    }
    page
}

/// A text within a page: no part of it is markup.
pub(crate) fn escape(text: &str) -> String {
    text.chars()
        .map(|letter| match letter {
            '&' => "&amp;".to_owned(),
            '<' => "&lt;".to_owned(),
            '>' => "&gt;".to_owned(),
            '"' => "&quot;".to_owned(),
            '\'' => "&#39;".to_owned(),
            _ => letter.to_string(),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_put_in_is_not_looked_at_again() {
        let page = fill("<h1>{{a}}</h1>{{b}} {{c", &[("a", "{{b}}"), ("b", "{{a}}")]);
        assert_eq!(page, "<h1>{{b}}</h1>{{a}} {{c");
    }
}
