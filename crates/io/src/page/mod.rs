//! Takes as web pages: one file each, nothing from a network.

mod data;

use serde_json::Value;

use crate::Result;
use crate::take::Take;

pub use data::{MOST_FRAMES, ViewPicture, ViewPictures};

/// The page on which people look at a take: the pictures with the estimated hand, a hand in three
/// dimensions, every angle's curve with its band, quality, doubts and the range of motion. Of more
/// than [`MOST_FRAMES`] frames every so-manieth is shown, and the page says so.
///
/// # Errors
/// A take that does not keep to [`Take::validate`]; a picture of a frame that the take has not.
pub fn view_page(take: &Take, name: &str, pictures: &[ViewPictures]) -> Result<String> {
    take.validate()?;
    let data = data::of(take, pictures)?;
    let scripts = [
        include_str!("take.js"),
        include_str!("hand.js"),
        include_str!("curves.js"),
        include_str!("view.js"),
    ];
    Ok(fill(
        include_str!("view.html"),
        &[
            ("title", &escape(name)),
            ("css", include_str!("view.css")),
            ("data", &script_data(&data)),
            ("js", &scripts.concat()),
        ],
    ))
}

/// JSON that cannot end the script element around it.
fn script_data(data: &Value) -> String {
    data.to_string().replace('<', "\\u003c")
}

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
