//! One panel: curves over time, bounds as labelled dashed lines, and a legend above the data.
//!
//! Colours are Okabe and Ito's, which stay apart under the common colour-vision deficiencies; a reference is also
//! dashed.

use super::canvas::{DrawingResult, FINE};
use plotters::coord::Shift;
use plotters::coord::ranged1d::{AsRangedCoord, ValueFormatter};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Blue: the first axis, or the only curve.
pub const BLUE: RGBColor = RGBColor(0, 114, 178);
/// Vermilion: the second axis.
pub const VERMILION: RGBColor = RGBColor(213, 94, 0);
/// Bluish green: the third axis.
pub const GREEN: RGBColor = RGBColor(0, 158, 115);
/// Nearly black: bounds that belong to no axis, and references.
pub const INK: RGBColor = RGBColor(60, 60, 60);
/// Grid lines.
const GRID: RGBColor = RGBColor(228, 228, 228);

/// The width of a chart in pixels, near enough: a curve needs no more than its extremes in each.
const COLUMNS: usize = 520;

/// The vertical axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Evenly spaced numbers.
    Linear,
    /// Evenly spaced decades.
    Log,
}

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Line {
    /// Without gaps.
    Solid,
    /// In dashes: a reference, or one of many laws, so that not colour alone separates them.
    Dashed,
    /// In dots: a second such pattern.
    Dotted,
}

impl Line {
    /// Its class in the style sheet.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Solid => "solid",
            Self::Dashed => "dashed",
            Self::Dotted => "dotted",
        }
    }

    /// Lengths of a dash and of the gap behind it.
    const fn pattern(self) -> Option<(i32, i32)> {
        match self {
            Self::Solid => None,
            Self::Dashed => Some((7 * FINE, 4 * FINE)),
            Self::Dotted => Some((2 * FINE, 3 * FINE)),
        }
    }
}

/// A line through the samples.
pub struct Curve {
    /// Its name in the legend; none, no entry.
    pub label: String,
    /// Its colour.
    pub color: RGBColor,
    /// How it is drawn.
    pub line: Line,
    /// Pixels; a curve that others may cover is wider, so that its rim shows.
    pub width: u32,
    /// (s, the panel's unit).
    pub points: Vec<(f64, f64)>,
}

/// A level that must not be crossed.
pub struct Bound {
    /// Where, in the panel's unit.
    pub value: f64,
    /// The label at the line's end.
    pub label: String,
    /// Its colour: the one of the curve it belongs to, or [`INK`].
    pub color: RGBColor,
}

/// A chart over time.
pub struct Panel {
    /// Above the chart.
    pub title: &'static str,
    /// Beside the vertical axis, with the unit.
    pub quantity: &'static str,
    /// The vertical axis.
    pub scale: Scale,
    /// The curves.
    pub curves: Vec<Curve>,
    /// The bounds.
    pub bounds: Vec<Bound>,
}

impl Panel {
    /// Draws into `area`.
    ///
    /// # Errors
    /// As the backend's.
    pub fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> DrawingResult<DB> {
        area.draw(&Text::new(
            self.title,
            (14 * FINE, 10 * FINE),
            font(17).into_font().style(FontStyle::Bold).color(&INK),
        ))?;
        self.draw_legend(area)?;
        let (low, high) = self.vertical_range();
        let chart_area = area.margin(58 * FINE, 6 * FINE, 8 * FINE, 22 * FINE);
        match self.scale {
            Scale::Linear => self.draw_chart(&chart_area, low..high, &|value| format_linear(*value, high - low)),
            Scale::Log => self.draw_chart(&chart_area, (low..high).log_scale(), &|value| format_decade(*value)),
        }
    }

    /// A row of line samples with names, between title and chart, where no data can be.
    fn draw_legend<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> DrawingResult<DB> {
        const SAMPLE: i32 = 26 * FINE;
        const CHARACTER: i32 = 8 * FINE;
        let mut x = 16 * FINE;
        for curve in self.curves.iter().filter(|curve| !curve.label.is_empty()) {
            draw_dashes(area, x, x + SAMPLE, 43 * FINE, curve)?;
            x += SAMPLE + 6 * FINE;
            area.draw(&Text::new(curve.label.as_str(), (x, 35 * FINE), font(15).into_font().color(&INK)))?;
            x += CHARACTER * curve.label.chars().count() as i32 + 18 * FINE;
        }
        Ok(())
    }

    fn draw_chart<DB, Y>(
        &self,
        area: &DrawingArea<DB, Shift>,
        vertical: Y,
        label: &dyn Fn(&f64) -> String,
    ) -> DrawingResult<DB>
    where
        DB: DrawingBackend,
        Y: AsRangedCoord<Value = f64>,
        Y::CoordDescType: ValueFormatter<f64> + Ranged<ValueType = f64>,
    {
        let end = self.end();
        let mut chart = ChartBuilder::on(area)
            .x_label_area_size(46 * FINE)
            .y_label_area_size(76 * FINE)
            .build_cartesian_2d(0.0..end, vertical)?;
        let axis = font(15).into_font().color(&INK);
        chart
            .configure_mesh()
            .bold_line_style(GRID.stroke_width(FINE as u32))
            .light_line_style(TRANSPARENT)
            .axis_style(INK.stroke_width(FINE as u32))
            .set_all_tick_mark_size(5 * FINE)
            .label_style(axis.clone())
            .axis_desc_style(font(15).into_font().color(&INK))
            .x_labels(9)
            .y_labels(7)
            .x_label_formatter(&|value| format_linear(*value, end))
            .y_label_formatter(&label)
            .x_desc("time [s]")
            .y_desc(self.quantity)
            .draw()?;
        for (index, bound) in self.bounds.iter().enumerate() {
            let line = [(0.0, bound.value), (end, bound.value)];
            chart.draw_series(DashedLineSeries::new(
                line,
                7 * FINE,
                5 * FINE,
                bound.color.stroke_width(FINE as u32),
            ))?;
            // Outside the bound; inside, where another one lies just outside.
            let up = (bound.value >= 0.0) != self.is_inner(bound);
            let (side, gap) = if up { (VPos::Bottom, -3 * FINE) } else { (VPos::Top, 3 * FINE) };
            let style = font(13).into_font().color(&bound.color).pos(Pos::new(HPos::Right, side));
            let left = 6 * FINE + LABEL_WIDTH * self.crowd(index) as i32;
            let text = EmptyElement::at((end, bound.value)) + Text::new(bound.label.clone(), (-left, gap), style);
            chart.plotting_area().draw(&text)?;
        }
        for curve in &self.curves {
            let style = curve.color.stroke_width(curve.width * FINE as u32);
            let mut points = thinned(&curve.points, end);
            if self.scale == Scale::Log {
                points.iter_mut().for_each(|point| point.1 = point.1.max(LEAST_ON_LOG));
            }
            match curve.line.pattern() {
                Some((dash, gap)) => chart.draw_series(DashedLineSeries::new(points, dash, gap, style))?,
                None => chart.draw_series(LineSeries::new(points, style))?,
            };
        }
        Ok(())
    }

    /// Whether two bounds lie so close that their labels would touch.
    fn close(&self, a: &Bound, b: &Bound) -> bool {
        let (low, high) = self.vertical_range();
        self.scale == Scale::Linear && (a.value - b.value).abs() < 0.06 * (high - low)
    }

    /// Whether another bound lies close by, further from zero.
    fn is_inner(&self, bound: &Bound) -> bool {
        self.bounds.iter().any(|other| self.close(other, bound) && other.value.abs() > bound.value.abs())
    }

    /// How many labels before this one stand in its place.
    fn crowd(&self, index: usize) -> usize {
        let Some(bound) = self.bounds.get(index) else { return 0 };
        let same_side = |other: &&Bound| self.close(other, bound) && self.is_inner(other) == self.is_inner(bound);
        self.bounds.iter().take(index).filter(same_side).count()
    }

    /// The end of the time axis: one sample after the last, so that a flight of 40 s ends at 40.
    fn end(&self) -> f64 {
        let end_of = |curve: &Curve| match curve.points.as_slice() {
            [.., before, last] => 2.0 * last.0 - before.0,
            [only] => only.0,
            [] => 0.0,
        };
        // A hair more, so that rounding does not take the last label away.
        self.curves.iter().map(end_of).fold(1e-3, f64::max) * (1.0 + 1e-9)
    }

    /// The range of all curves and bounds, with room for the bounds' labels.
    fn vertical_range(&self) -> (f64, f64) {
        let values = self.curves.iter().flat_map(|curve| curve.points.iter().map(|point| point.1));
        let values = values.chain(self.bounds.iter().map(|bound| bound.value));
        let (low, high) = match self.scale {
            Scale::Linear => values.fold((f64::MAX, f64::MIN), |(l, h), value| (l.min(value), h.max(value))),
            Scale::Log => {
                let seen = values.filter(|value| *value > LEAST_ON_LOG);
                let (low, high) = seen.fold((f64::MAX, f64::MIN), |(l, h), value| (l.min(value), h.max(value)));
                let (low, high) = if low > high { (LEAST_ON_LOG, 1.0) } else { (low, high) };
                let (least, most) = (low.log10().floor(), high.log10().ceil().max(low.log10().floor() + 1.0));
                // A hair more, as at the end.
                return (10f64.powf(least) * (1.0 - 1e-9), 10f64.powf(most) * (1.0 + 1e-9));
            }
        };
        let room = if high - low > 1e-9 { 0.1 * (high - low) } else { 1.0 };
        (low - room, high + room)
    }
}

/// The one typeface, at a size in pixels; the drawing library makes type smaller than asked, by a factor of 1.24.
fn font(size: i32) -> (&'static str, i32) {
    ("sans-serif", size * FINE * 124 / 100)
}

/// Below this an error on a logarithmic axis is single precision's noise, and drawn as this.
const LEAST_ON_LOG: f64 = 1e-7;
/// Room for the label of a bound, pixels.
const LABEL_WIDTH: i32 = 124 * FINE;

/// A horizontal sample of the curve's line in a legend.
fn draw_dashes<DB: DrawingBackend>(
    area: &DrawingArea<DB, Shift>,
    from: i32,
    to: i32,
    y: i32,
    curve: &Curve,
) -> DrawingResult<DB> {
    let style = curve.color.stroke_width(curve.width * FINE as u32);
    let (dash, gap) = curve.line.pattern().unwrap_or((to - from, 0));
    let mut x = from;
    while x < to {
        area.draw(&PathElement::new(vec![(x, y), ((x + dash).min(to), y)], style))?;
        x += dash + gap;
    }
    Ok(())
}

/// The least and the greatest point of each column of pixels, in order of time.
fn thinned(points: &[(f64, f64)], end: f64) -> Vec<(f64, f64)> {
    let column = |point: &(f64, f64)| (point.0 / end * COLUMNS as f64) as usize;
    let by_value = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
    let mut kept = Vec::with_capacity(2 * COLUMNS);
    for chunk in points.chunk_by(|a, b| column(a) == column(b)) {
        let (Some(least), Some(greatest)) = (chunk.iter().min_by(by_value), chunk.iter().max_by(by_value)) else {
            continue;
        };
        let (first, second) = if least.0 <= greatest.0 { (least, greatest) } else { (greatest, least) };
        kept.push(*first);
        if second.0 > first.0 {
            kept.push(*second);
        }
    }
    kept
}

/// As many decimals as the axis' span needs.
fn format_linear(value: f64, span: f64) -> String {
    let decimals = if span > 8.0 { 0 } else { (1.0 - span.log10()).ceil().clamp(1.0, 6.0) as usize };
    // Rounding can leave a minus before a zero.
    let text = format!("{value:.decimals$}");
    if text.trim_start_matches('-').chars().all(|c| c == '0' || c == '.') { "0".into() } else { text }
}

/// A power of ten with a raised exponent.
fn format_decade(value: f64) -> String {
    let exponent = value.log10().round() as i32;
    let raised: String = exponent
        .to_string()
        .chars()
        .map(|c| match c {
            '-' => '⁻',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            other => char::from_u32('⁰' as u32 + other.to_digit(10).unwrap_or(0)).unwrap_or(other),
        })
        .collect();
    format!("10{raised}")
}

#[cfg(test)]
mod tests {
    use super::super::canvas::draw;
    use super::*;

    #[test]
    fn thinning_keeps_every_columns_extremes() {
        let mut points: Vec<(f64, f64)> = (0..100_000).map(|i| (f64::from(i) * 1e-3, 0.0)).collect();
        points[50_000].1 = 7.0;
        points[50_001].1 = -7.0;
        let kept = thinned(&points, 100.0);
        assert!(kept.len() <= 2 * COLUMNS + 2);
        assert!(kept.contains(&points[50_000]) && kept.contains(&points[50_001]));
        assert!(kept.windows(2).all(|pair| pair[0].0 < pair[1].0));
    }

    #[test]
    fn labels_read_well() {
        assert_eq!((format_decade(1e-5), format_decade(10.0)), ("10⁻⁵".into(), "10¹".into()));
        assert_eq!((format_linear(-0.0, 20.0), format_linear(0.25, 0.5)), ("0".into(), "0.25".into()));
    }

    #[test]
    fn both_ends_of_a_logarithmic_axis_have_labels() {
        let points = vec![(0.0, 1e-4), (1.0, 1e2)];
        let curve = Curve { label: String::new(), color: BLUE, line: Line::Solid, width: 2, points };
        let panel = Panel { title: "", quantity: "m", scale: Scale::Log, curves: vec![curve], bounds: Vec::new() };
        let drawn = draw((700, 450), |root| panel.draw(root)).unwrap();
        for end in ["10⁻⁴", "10²"] {
            assert!(drawn.contains(end), "{end}");
        }
    }
}
