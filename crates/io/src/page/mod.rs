//! Takes as web pages: one file each, nothing from a network.

mod data;
pub(crate) mod html;

use serde_json::Value;

use crate::error::Result;
use crate::page::html::{escape, fill};
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
