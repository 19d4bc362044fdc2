//! Plots of the experiments, as SVG.

use std::fmt::Display;
use std::ops::Range;

use anyhow::{Result, anyhow};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Width and height of a plot, px: legible on a telephone, three beside each other on a desk.
const SIZE: (u32, u32) = (460, 330);
const TEXT: (&str, u32) = ("sans-serif", 16);
/// Height of a line of the legend, and an upper bound of the width of its letters, px.
const LEGEND: (i32, i32) = (18, 8);
/// Colours that the colour-blind can tell apart (Okabe and Ito 2008).
const PALETTE: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(90, 90, 90),
];

/// One quantity along an axis.
pub(crate) struct Axis {
    /// What it is, with its unit.
    pub(crate) label: &'static str,
    pub(crate) scale: Scale,
}

/// How values lie along an axis.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Scale {
    Linear,
    /// Linear, and 0 is shown whatever the values are.
    FromZero,
    /// By powers of ten; values are above 0.
    Logarithmic,
}

impl Axis {
    pub(crate) fn linear(label: &'static str) -> Self {
        Self { label, scale: Scale::Linear }
    }

    pub(crate) fn from_zero(label: &'static str) -> Self {
        Self { label, scale: Scale::FromZero }
    }

    pub(crate) fn logarithmic(label: &'static str) -> Self {
        Self { label, scale: Scale::Logarithmic }
    }

    fn place(&self, value: f64) -> f64 {
        if self.scale == Scale::Logarithmic { value.log10() } else { value }
    }

    /// What the values cover, with some room.
    fn range(&self, values: impl Iterator<Item = f64>) -> Range<f64> {
        let values = values.map(|value| self.place(value)).filter(|value| value.is_finite());
        let (mut low, mut high) =
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        if self.scale == Scale::FromZero {
            low = low.min(0.0);
        }
        if low > high {
            (low, high) = (0.0, 1.0);
        }
        let room = 0.05 * (high - low).max(1e-9);
        let at_zero = self.scale == Scale::FromZero && low == 0.0;
        (if at_zero { 0.0 } else { low - room })..(high + room)
    }

    fn tick(&self, place: f64) -> String {
        let value = if self.scale == Scale::Logarithmic { 10_f64.powf(place) } else { place };
        match value.abs() {
            // Ticks are sums of steps: zero is missed by a rounding error.
            size if size < 1e-12 => "0".to_owned(),
            size if !(0.01..1e5).contains(&size) => format!("{value:.0e}"),
            size if size < 1.0 => trimmed(&format!("{value:.2}")).to_owned(),
            size if size < 10.0 => trimmed(&format!("{value:.1}")).to_owned(),
            _ => format!("{value:.0}"),
        }
    }
}

/// A decimal number without the zeros at its end.
fn trimmed(number: &str) -> &str {
    number.trim_end_matches('0').trim_end_matches('.')
}

/// Points that belong together.
pub(crate) struct Series {
    pub(crate) name: String,
    pub(crate) points: Vec<(f64, f64)>,
    pub(crate) mark: Mark,
}

/// How a series is drawn.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Mark {
    Line,
    LineAndDots,
    Dots,
    /// Dots that stand out among others.
    Discs,
}

impl Series {
    pub(crate) fn new(name: impl Display, mark: Mark, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.to_string(), points, mark }
    }
}

/// Series over two axes.
pub(crate) struct Chart {
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    pub(crate) series: Vec<Series>,
}

impl Chart {
    /// What is drawn, in words.
    pub(crate) fn words(&self) -> String {
        let names: Vec<&str> = self.series.iter().map(|series| series.name.as_str()).collect();
        format!("plot of {} against {}: {}", self.y.label, self.x.label, names.join(", "))
    }

    /// The plot. Every series has a colour of its own and is named above, if there are several.
    pub(crate) fn svg(&self) -> Result<String> {
        draw(|area| {
            let named = if self.series.len() > 1 { self.legend() } else { Vec::new() };
            let height = named.last().map_or(0, |&(_, y, _)| y + LEGEND.0);
            let (strip, area) = area.split_vertically(height);
            for (series, y, x) in named {
                let colour = colour(series);
                let dash = Rectangle::new([(x, y + 10), (x + 16, y + 13)], colour.filled());
                strip.draw(&dash)?;
                let left = TEXT.into_text_style(&strip).pos(Pos::new(HPos::Left, VPos::Center));
                strip.draw(&Text::new(
                    self.series[series].name.as_str(),
                    (x + 20, y + 12),
                    left,
                ))?;
            }
            self.plot(&area)
        })
    }

    /// Where each series' name stands above the plot: which series, y and x.
    fn legend(&self) -> Vec<(usize, i32, i32)> {
        let (mut x, mut y) = (56, 2);
        let mut places = Vec::new();
        for (k, series) in self.series.iter().enumerate() {
            let width = 32 + LEGEND.1 * series.name.chars().count() as i32;
            if x > 56 && x + width > SIZE.0 as i32 {
                (x, y) = (56, y + LEGEND.0);
            }
            places.push((k, y, x));
            x += width;
        }
        places
    }

    fn plot(&self, area: &Canvas<'_>) -> Drawn {
        let points = || self.series.iter().flat_map(|series| series.points.iter());
        let x = self.x.range(points().map(|p| p.0));
        let y = self.y.range(points().map(|p| p.1));
        let mut chart = ChartBuilder::on(area)
            .margin(8)
            .x_label_area_size(44)
            .y_label_area_size(56)
            .build_cartesian_2d(x, y)?;
        chart
            .configure_mesh()
            .x_labels(6)
            .y_labels(6)
            .light_line_style(TRANSPARENT)
            .x_desc(self.x.label)
            .y_desc(self.y.label)
            .x_label_formatter(&|x| self.x.tick(*x))
            .y_label_formatter(&|y| self.y.tick(*y))
            .label_style(TEXT)
            .axis_desc_style(TEXT)
            .draw()?;
        for (k, series) in self.series.iter().enumerate() {
            let colour = colour(k);
            let points: Vec<(f64, f64)> =
                series.points.iter().map(|p| (self.x.place(p.0), self.y.place(p.1))).collect();
            if matches!(series.mark, Mark::Line | Mark::LineAndDots) {
                chart
                    .draw_series(LineSeries::new(points.iter().copied(), colour.stroke_width(2)))?;
            }
            let radius = match series.mark {
                Mark::Dots => 2,
                Mark::Line | Mark::LineAndDots => 3,
                Mark::Discs => 5,
            };
            let dots = points.into_iter().filter(|_| series.mark != Mark::Line);
            chart.draw_series(dots.map(|point| Circle::new(point, radius, colour.filled())))?;
        }
        Ok(())
    }
}

fn colour(series: usize) -> RGBColor {
    PALETTE[series % PALETTE.len()]
}

/// Which cells of a matrix are set.
pub(crate) struct CellMap {
    /// What columns and rows are.
    pub(crate) x: &'static str,
    pub(crate) y: &'static str,
    /// Row by row, each of as many cells.
    pub(crate) rows: Vec<Vec<bool>>,
    /// Names of neighbouring columns and rows, with how many each has; lines part them.
    pub(crate) column_groups: Vec<(String, usize)>,
    pub(crate) row_groups: Vec<(String, usize)>,
}

/// Where the cells of a map begin, px: right of the rows' names.
const CELLS: (i32, i32) = (86, 8);
/// Size of the part of the picture that cells fill, px: room for the columns' names is below.
const CELLS_SIZE: (i32, i32) = (SIZE.0 as i32 - CELLS.0 - 10, SIZE.1 as i32 - CELLS.1 - 46);

impl CellMap {
    /// What is drawn, in words.
    pub(crate) fn words(&self) -> String {
        format!("map of cells: {} in rows, {} in columns", self.y, self.x)
    }

    pub(crate) fn svg(&self) -> Result<String> {
        let columns = self.rows.first().map_or(0, Vec::len);
        let rows = self.rows.len();
        let x = |column: usize| CELLS.0 + (column as i32 * CELLS_SIZE.0) / columns.max(1) as i32;
        let y = |row: usize| CELLS.1 + (row as i32 * CELLS_SIZE.1) / rows.max(1) as i32;
        let (right, bottom) = (x(columns), y(rows));
        draw(|area| {
            for (row, cells) in self.rows.iter().enumerate() {
                for column in (0..columns).filter(|&column| cells[column]) {
                    let corners = [(x(column), y(row)), (x(column + 1), y(row + 1))];
                    area.draw(&Rectangle::new(corners, PALETTE[0].filled()))?;
                }
            }
            let centred = TEXT.into_text_style(area).pos(Pos::new(HPos::Center, VPos::Center));
            let upright = centred.transform(FontTransform::Rotate270);
            let before = TEXT.into_text_style(area).pos(Pos::new(HPos::Right, VPos::Center));
            let line = |from, to| PathElement::new([from, to], BLACK.stroke_width(1));
            for (name, from, to) in places(&self.column_groups) {
                area.draw(&line((x(from), CELLS.1), (x(from), bottom)))?;
                let middle = i32::midpoint(x(from), x(to));
                area.draw(&Text::new(name, (middle, bottom + 12), centred.clone()))?;
            }
            for (name, from, to) in places(&self.row_groups) {
                area.draw(&line((CELLS.0, y(from)), (right, y(from))))?;
                let middle = i32::midpoint(y(from), y(to));
                area.draw(&Text::new(name, (CELLS.0 - 6, middle), before.clone()))?;
            }
            area.draw(&line((right, CELLS.1), (right, bottom)))?;
            area.draw(&line((CELLS.0, bottom), (right, bottom)))?;
            let middle = (i32::midpoint(CELLS.0, right), i32::midpoint(CELLS.1, bottom));
            area.draw(&Text::new(self.x, (middle.0, bottom + 32), centred))?;
            area.draw(&Text::new(self.y, (12, middle.1), upright))
        })
    }
}

/// Each group's name with where it begins and ends.
fn places(groups: &[(String, usize)]) -> impl Iterator<Item = (&str, usize, usize)> {
    groups.iter().scan(0, |end, (name, size)| {
        let begin = *end;
        *end += size;
        Some((name.as_str(), begin, *end))
    })
}

type Canvas<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;
type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;

/// Draws on a white canvas.
fn draw(paint: impl FnOnce(&Canvas<'_>) -> Drawn) -> Result<String> {
    let mut svg = String::new();
    {
        let area = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        let failed = |error| anyhow!("drawing a plot: {error}");
        area.fill(&WHITE).map_err(failed)?;
        paint(&area).map_err(failed)?;
        area.present().map_err(failed)?;
    }
    Ok(svg)
}
