//! One shape context drawn as a log-polar plate.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use phalanx_shape_context::{RINGS, SECTORS, sector_edges};

/// Width and height of the picture, and where the plate's middle is, px.
const SIZE: [f64; 2] = [480.0, 380.0];
const MIDDLE: [f64; 2] = [214.0, 190.0];
/// Breadth of a ring, px: all alike, since each is an octave.
const RING: f64 = 30.0;
/// What the rings end at.
const RADII: [&str; RINGS] = ["μ/8", "μ/4", "μ/2", "μ", "2μ"];
/// The colour of the fullest bin.
const FULL: [f64; 3] = [0.0, 60.0, 120.0];

/// The plate of a shape context, as SVG: five rings of twelve sectors, each the darker the more of
/// the contour it holds, the direction 0° to the right and angles as on the screen, clockwise.
pub(crate) fn svg(context: &[f32]) -> String {
    let most = context.iter().copied().fold(0.0, f32::max);
    let [width, height] = SIZE;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"16\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    for (bin, &share) in context.iter().enumerate() {
        let (ring, sector) = (bin / SECTORS, bin % SECTORS);
        line(&mut svg, &wedge(ring, sector_edges()[sector], &colour(f64::from(share / most))));
    }
    direction(&mut svg);
    labels(&mut svg);
    scale(&mut svg, f64::from(most));
    svg + "</svg>\n"
}

fn line(svg: &mut String, element: &str) {
    svg.push_str(element);
    svg.push('\n');
}

/// From white to the fullest.
fn colour(part: f64) -> String {
    let [red, green, blue] = FULL.map(|channel| (255.0 + (channel - 255.0) * part).round());
    format!("rgb({red},{green},{blue})")
}

/// A point of the plate.
fn at(radius: f64, angle: f64) -> [f64; 2] {
    [MIDDLE[0] + radius * angle.cos(), MIDDLE[1] + radius * angle.sin()]
}

fn wedge(ring: usize, start: f64, fill: &str) -> String {
    let (inner, outer) = (RING * ring as f64, RING * (ring + 1) as f64);
    let end = start + TAU / SECTORS as f64;
    let [a, b, c, d] = [at(inner, start), at(outer, start), at(outer, end), at(inner, end)];
    format!(
        "<path d=\"M{:.2} {:.2}L{:.2} {:.2}A{outer} {outer} 0 0 1 {:.2} {:.2}L{:.2} {:.2}\
         A{inner} {inner} 0 0 0 {:.2} {:.2}Z\" fill=\"{fill}\" stroke=\"#999\" \
         stroke-width=\"0.7\"/>",
        a[0], a[1], b[0], b[1], c[0], c[1], d[0], d[1], a[0], a[1]
    )
}

/// The line in the direction 0°.
fn direction(svg: &mut String) {
    let [[x, y], [tip, _]] = [MIDDLE, at(RING * RINGS as f64 + 14.0, 0.0)];
    let (back, up, down) = (tip - 9.0, y - 5.0, y + 5.0);
    line(
        svg,
        &format!(
            "<path d=\"M{x} {y}L{back} {y}M{tip} {y}L{back} {up}L{back} {down}Z\" \
             stroke=\"#d55e00\" stroke-width=\"2\" fill=\"#d55e00\"/>"
        ),
    );
}

/// What angles and radii are.
fn labels(svg: &mut String) {
    let mut text = |[x, y]: [f64; 2], anchor: &str, words: &str| {
        let element = format!(
            "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" \
             dominant-baseline=\"central\" paint-order=\"stroke\" stroke=\"white\" \
             stroke-width=\"3\">{words}</text>"
        );
        line(svg, &element);
    };
    let rim = RING * RINGS as f64 + 14.0;
    for (angle, anchor) in [(0, "start"), (90, "middle"), (180, "end"), (270, "middle")] {
        let [x, y] = at(rim + 4.0, f64::from(angle).to_radians());
        text([x, y], anchor, &format!("{angle}°"));
    }
    for (ring, radius) in RADII.into_iter().enumerate() {
        text(at(RING * (ring + 1) as f64, -TAU / 8.0), "middle", radius);
    }
}

/// Which colour is which share.
fn scale(svg: &mut String, most: f64) {
    const STEPS: usize = 20;
    let [left, top, width, height] = [426.0, 110.0, 16.0, 180.0];
    for step in 0..STEPS {
        let part = step as f64 / (STEPS - 1) as f64;
        let each = height / STEPS as f64;
        let y = top + height - each * (step + 1) as f64;
        let fill = colour(part);
        let _ = writeln!(
            svg,
            "<rect x=\"{left}\" y=\"{y:.1}\" width=\"{width}\" height=\"{:.1}\" fill=\"{fill}\"/>",
            each + 0.5
        );
    }
    let middle = left + width / 2.0;
    for (y, words) in [
        (top - 52.0, "share of".to_owned()),
        (top - 32.0, "points".to_owned()),
        (top - 8.0, format!("{:.0} %", 100.0 * most)),
        (top + height + 16.0, "0 %".to_owned()),
    ] {
        let _ =
            writeln!(svg, "<text x=\"{middle}\" y=\"{y}\" text-anchor=\"middle\">{words}</text>");
    }
}

#[cfg(test)]
mod tests {
    use phalanx_shape_context::BINS;

    use super::*;

    #[test]
    fn every_bin_is_drawn_and_the_fullest_darkest() {
        let mut context = [0.0; BINS];
        context[7] = 0.75;
        context[8] = 0.25;
        let svg = svg(&context);
        let wedges: Vec<&str> = svg.lines().filter(|line| line.contains('A')).collect();
        assert_eq!(wedges.len(), BINS);
        assert!(wedges[7].contains(&colour(1.0)));
        assert!(wedges[0].contains(&colour(0.0)));
    }
}
