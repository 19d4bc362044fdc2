//! Draws the outline of the hand in a photograph as an SVG, a dot where the forearm ends:
//! `cargo run --example outline -- photograph.jpg > outline.svg`

use phalanx_segmentation::{Cleanup, Segment, Silhouette, SkinModel, clean, downsample};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("usage: outline PHOTOGRAPH")?;
    let photograph = downsample(&image::open(path)?.to_rgb8(), 120, 90)?;
    let mask = clean(&SkinModel::builtin().segment(&photograph)?, &Cleanup::default())?;
    let silhouette = Silhouette::from_mask(&mask)?;

    println!(r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 120 90">"#);
    println!(r#"<rect width="100%" height="100%" fill="white"/>"#);
    for piece in silhouette.contour.pieces() {
        let points: Vec<_> = piece.iter().map(|[x, y]| format!("{x},{y}")).collect();
        println!(r#"<polyline fill="none" stroke="black" points="{}"/>"#, points.join(" "));
    }
    let [x, y] = silhouette.forearm.end;
    println!(r#"<circle cx="{x}" cy="{y}" r="2"/></svg>"#);
    Ok(())
}
