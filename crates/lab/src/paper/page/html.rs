//! The page: one file that needs neither network nor script.

use std::fmt::Write;

use anyhow::Result;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;

use crate::paper::{Content, Experiment, Figure, Finding, Table, Verdict};

const STYLE: &str = include_str!("style.css");
/// A dot in the first colour of the plots.
const ICON: &[u8] = b"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 16 16'>\
    <circle cx='8' cy='8' r='7' fill='#0072b2'/></svg>";

/// An experiment and what came of it.
pub(crate) struct Section<'a> {
    pub(crate) experiment: &'a Experiment,
    pub(crate) outcome: Result<Finding>,
}

/// The whole page.
pub(crate) fn page(sections: &[Section<'_>]) -> String {
    let icon = data_uri("image/svg+xml", ICON);
    let rows: String = sections.iter().map(summary_row).collect();
    let body: String = sections.iter().map(section).collect();
    format!(
        r#"<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<title>The paper's figures and claims, reproduced</title>
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<link rel="icon" href="{icon}">
<style>
{STYLE}</style>
</head>
<body>
<header>
<h1>The paper's figures and claims, reproduced</h1>
<p>The paper is T. E. de Campos and D. W. Murray, <cite>Regression-based Hand Pose Estimation from
Multiple Cameras</cite>, CVPR 2006. Every figure and claim of it that can be tested is put to the
test here with phalanx, section by section in the order of the paper: what the paper shows, what we
found, and whether it holds.</p>
<p><code>cargo xtask report</code> ran all of it and wrote this page, with each experiment’s figures
and unrounded numbers beside it; <code>--data DIR</code> adds the parts on real photographs, and
<code>cargo xtask experiment NAME</code> runs one part alone.</p>
<p>Our motion is not the paper’s, whose glove recordings are not public, and degrees follow from how
far a motion strays. So read an error as its ratio to that of the mean predictor, which answers
every picture with the mean pose of the training samples: 1 means that nothing was learnt, 0 that
nothing is wrong.</p>
</header>
<main>
<section id="summary">
<h2>Summary</h2>
<div class="scroll" role="region" tabindex="0" aria-labelledby="summary-heading">
<table>
<caption id="summary-heading">Every part of the paper that was tested.</caption>
<thead><tr><th scope="col">paper</th><th scope="col">verdict</th><th scope="col">why</th></tr></thead>
<tbody>
{rows}</tbody>
</table>
</div>
</section>
{body}</main>
</body>
</html>
"#
    )
}

fn summary_row(Section { experiment, outcome }: &Section<'_>) -> String {
    let Experiment { name, place, title, .. } = experiment;
    let why = match outcome {
        Ok(finding) => escaped(&finding.sentence),
        Err(error) => escaped(&format!("{error:#}")),
    };
    format!(
        "<tr><th scope=\"row\"><a href=\"#{name}\">{}</a>: {}</th><td>{}</td><td>{why}</td></tr>\n",
        escaped(place),
        escaped(title),
        badge(outcome),
    )
}

fn section(Section { experiment, outcome }: &Section<'_>) -> String {
    let Experiment { name, place, title, claim, .. } = experiment;
    let found = match outcome {
        Ok(finding) => found(place, finding, &badge(outcome)),
        Err(error) => format!("<p>{} {}</p>\n", badge(outcome), escaped(&format!("{error:#}"))),
    };
    format!(
        "<section id=\"{name}\">\n<h2>{}: {}</h2>\n<h3>The paper</h3>\n<p>{}</p>\n{found}\
         <p class=\"command\"><code>cargo xtask experiment {name}</code></p>\n</section>\n",
        escaped(place),
        escaped(title),
        escaped(&capitalised(claim)),
    )
}

fn found(place: &str, finding: &Finding, badge: &str) -> String {
    let mut html = "<h3>What we found</h3>\n".to_owned();
    if !finding.figures.is_empty() {
        let figures: String = finding.figures.iter().map(|one| figure(place, one)).collect();
        let _ = write!(html, "<div class=\"figures\">\n{figures}</div>\n");
    }
    html.extend(finding.tables.iter().map(table));
    let _ = write!(
        html,
        "<h3>Does it hold?</h3>\n<p class=\"verdict\">{badge} {}</p>\n",
        escaped(&finding.sentence)
    );
    html.extend(finding.notes.iter().map(|note| format!("<p>{}</p>\n", escaped(note))));
    html
}

fn figure(place: &str, figure: &Figure) -> String {
    let (_, mime, bytes) = figure.file();
    let class = match figure.content {
        Content::Svg(_) => "plot",
        Content::Png(_) => "picture",
    };
    format!(
        "<figure>\n<img class=\"{class}\" alt=\"{}\" src=\"{}\">\n<figcaption>{}</figcaption>\n\
         </figure>\n",
        escaped(&format!("{place}: {}", figure.alternative)),
        data_uri(mime, bytes),
        escaped(&figure.caption),
    )
}

fn table(table: &Table) -> String {
    let figures: Vec<bool> = (0..table.header.len()).map(|k| holds_figures(table, k)).collect();
    let class = |column: usize| if figures[column] { " class=\"figure\"" } else { "" };
    let heading = |(column, cell): (usize, &String)| {
        format!("<th scope=\"col\"{}>{}</th>", class(column), escaped(cell))
    };
    let header: String = table.header.iter().enumerate().map(heading).collect();
    let row = |cells: &Vec<String>| {
        let cell = |(k, cell): (usize, &String)| match k {
            0 => format!("<th scope=\"row\">{}</th>", escaped(cell)),
            _ => format!("<td{}>{}</td>", class(k), escaped(cell)),
        };
        format!("<tr>{}</tr>\n", cells.iter().enumerate().map(cell).collect::<String>())
    };
    let rows: String = table.rows.iter().map(row).collect();
    let caption = escaped(&table.caption);
    format!(
        "<figure class=\"table\">\n<figcaption>{caption}</figcaption>\n\
         <div class=\"scroll\" role=\"region\" tabindex=\"0\" aria-label=\"{caption}\">\n\
         <table>\n<thead><tr>{header}</tr></thead>\n<tbody>\n{rows}</tbody>\n</table>\n</div>\n\
         </figure>\n"
    )
}

/// Does a column hold nothing but figures? Then it lines up on the right.
fn holds_figures(table: &Table, column: usize) -> bool {
    let is_figure = |cell: &str| {
        let unsigned = cell.trim_start_matches(['-', '−', '+', '±', '~', '<', '>']);
        unsigned.starts_with(|c: char| c.is_ascii_digit())
    };
    let mut cells = table.rows.iter().filter_map(|row| row.get(column));
    cells.all(|cell| is_figure(cell) || ["", "–", "·"].contains(&cell.as_str()))
}

fn badge(outcome: &Result<Finding>) -> String {
    let (class, words) = match outcome.as_ref().map(|finding| finding.verdict) {
        Ok(verdict @ Verdict::Holds) => ("holds", verdict.words()),
        Ok(verdict @ Verdict::HoldsInPart) => ("in-part", verdict.words()),
        Ok(verdict @ Verdict::DoesNotHold) => ("not", verdict.words()),
        Err(_) => ("failed", "failed"),
    };
    format!("<strong class=\"badge {class}\">{words}</strong>")
}

fn data_uri(mime: &str, bytes: &[u8]) -> String {
    format!("data:{mime};base64,{}", BASE64_STANDARD.encode(bytes))
}

/// Text as HTML shows it, in content and in quoted attributes.
fn escaped(text: &str) -> String {
    let mut html = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => html.push_str("&amp;"),
            '<' => html.push_str("&lt;"),
            '>' => html.push_str("&gt;"),
            '"' => html.push_str("&quot;"),
            '\'' => html.push_str("&#39;"),
            other => html.push(other),
        }
    }
    html
}

fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().map(char::to_uppercase);
    first.into_iter().flatten().chain(letters).collect()
}

#[cfg(test)]
mod tests {
    use anyhow::anyhow;
    use image::RgbImage;

    use super::*;
    use crate::figures::chart::{Axis, Chart, Mark, Series};

    const HOSTILE: &str = "a < b & \"c\" > 'd' <script>alert(1)</script>";

    /// A page on which every text is hostile, with a plot, a picture and a failure.
    fn hostile() -> String {
        let experiment = Experiment {
            name: "hostile",
            place: HOSTILE,
            title: HOSTILE,
            claim: HOSTILE,
            run: |_| Err(anyhow!("not run")),
        };
        let line = Series::new(HOSTILE, Mark::Line, vec![(0.0, 0.0), (1.0, 1.0)]);
        let axis = || Axis::linear(HOSTILE);
        let chart = Chart { x: axis(), y: axis(), series: vec![line] };
        let mut table = Table::new(HOSTILE, [HOSTILE, "2"]);
        table.row([HOSTILE, "1.5"]);
        let finding = Finding {
            verdict: Verdict::Holds,
            sentence: HOSTILE.to_owned(),
            notes: vec![HOSTILE.to_owned()],
            tables: vec![table],
            figures: vec![
                Figure::chart(HOSTILE, &chart).unwrap(),
                Figure::picture(HOSTILE, &RgbImage::new(2, 2)).unwrap(),
            ],
            json: serde_json::Value::Null,
        };
        page(&[
            Section { experiment: &experiment, outcome: Ok(finding) },
            Section { experiment: &experiment, outcome: Err(anyhow!(HOSTILE)) },
        ])
    }

    #[test]
    fn nothing_that_is_told_becomes_markup() {
        let page = hostile();
        assert!(!page.contains("<script"));
        assert!(!page.contains("< b &"));
        assert!(!page.contains(" \"c\""));
        assert!(page.contains("a &lt; b &amp; &quot;c&quot; &gt; &#39;d&#39;"));
        assert!(page.contains("failed"), "the second section's experiment failed");
    }

    #[test]
    fn the_page_needs_no_network() {
        let page = hostile();
        assert!(!page.contains("http:") && !page.contains("https:") && !page.contains("url("));
        assert!(page.matches("src=\"").count() >= 2);
        assert_eq!(page.matches("src=\"").count(), page.matches("src=\"data:").count());
        let links = page.matches("href=\"").count();
        let local = page.matches("href=\"data:").count() + page.matches("href=\"#").count();
        assert_eq!(links, local);
    }

    #[test]
    fn columns_of_figures_line_up_on_the_right() {
        let mut table = Table::new("", ["name", "value"]);
        table.row(["first", "1.5"]);
        table.row(["second", "–"]);
        assert!(!holds_figures(&table, 0) && holds_figures(&table, 1));
    }
}
