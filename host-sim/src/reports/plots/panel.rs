//! One panel: a plot's curves over time, its bounds as labelled dashed lines, and a legend above them.
//!
//! A label stands beside its own line, never on it, and on no other label; words are drawn last, on a rim of the
//! ground's colour. A bound that finds no room is drawn without its label.

use super::axis::Axis;
use super::drawing::{Drawing, Inks, Point, Shape, Side};
use crate::reports::report::plot::{Bound, Color, Curve, LinePattern, Plot};
use crate::reports::report::track::Track;

/// Where in a drawing a panel stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Area {
    /// Its upper left corner.
    pub corner: Point,
    /// Width and height, pixels.
    pub size: Point,
    /// Height of the type, pixels.
    pub em: f64,
    /// Whether the plot's title stands above.
    pub titled: bool,
}

/// Of a letter's height, near enough.
const LETTER_WIDTH_SHARE: f64 = 0.56;

/// The plot alone, for a page that has its title.
#[must_use]
pub fn picture(plot: &Plot, tracks: &[Track]) -> String {
    let mut drawing = Drawing::new((420, 250));
    draw(&mut drawing, Area { corner: (0.0, 0.0), size: (420.0, 250.0), em: 12.0, titled: false }, plot, tracks);
    drawing.svg(Inks::Page, &plot.title)
}

/// Draws `plot` of `tracks` into `area`.
pub fn draw(drawing: &mut Drawing, area: Area, plot: &Plot, tracks: &[Track]) {
    let Area { corner: (x, y), size: (width, height), em, titled } = area;
    let mut top = y;
    if titled {
        top += 1.4 * em;
        let (at, size, text) = ((x + 0.6 * em, top), 1.15 * em, plot.title.clone());
        drawing.shapes.push(Shape::Words { at, side: Side::Start, size, color: Color::Ink, bold: true, text });
        top += 0.3 * em;
    }
    let top = draw_legend(drawing, plot, (x + 0.6 * em, top), x + width, em);
    let of = |curve: &Curve| tracks.get(curve.track);
    let time = Axis {
        least: 0.0,
        greatest: plot.curves.iter().filter_map(of).map(Track::end).fold(1e-9, f64::max),
        logarithmic: false,
    };
    let values = plot.curves.iter().filter_map(|curve| of(curve)?.column(&curve.column)).flatten();
    let chart = Chart {
        left: x + 4.2 * em,
        right: x + width - 2.2 * em,
        top: top + 2.7 * em,
        bottom: y + height - 2.2 * em,
        time,
        value: Axis::vertical(plot, values.map(|value| f64::from(*value))),
        em,
    };
    chart.draw_axes(drawing, &plot.unit);
    for bound in plot.bounds.iter().filter(|bound| chart.shows(bound)) {
        let (points, color) = (chart.across(chart.y(bound.value)), bound.color);
        drawing.shapes.push(Shape::Stroke { points, color, width: 1.0, line: LinePattern::Dashed });
    }
    for curve in &plot.curves {
        if let Some(track) = of(curve) {
            chart.draw_curve(drawing, curve, track);
        }
    }
    chart.label_bounds(drawing, plot);
}

/// How thick a curve is.
const fn width(curve: &Curve) -> f64 {
    match (curve.broad, curve.line) {
        (true, _) => 4.0,
        (false, LinePattern::Solid) => 1.8,
        (false, _) => 1.4,
    }
}

/// Samples of the lines with their names, in rows as long as there is room; gives the lower end.
fn draw_legend(drawing: &mut Drawing, plot: &Plot, (left, top): Point, right: f64, em: f64) -> f64 {
    let (mut x, mut y) = (left, top + 1.3 * em);
    for curve in &plot.curves {
        let needed = 2.4 * em + LETTER_WIDTH_SHARE * em * curve.label.chars().count() as f64;
        if x > left && x + needed > right {
            (x, y) = (left, y + 1.4 * em);
        }
        let points = vec![(x, y - 0.35 * em), (x + 1.8 * em, y - 0.35 * em)];
        drawing.shapes.push(Shape::Stroke { points, color: curve.color, width: width(curve), line: curve.line });
        drawing.words(curve.label.clone(), (x + 2.3 * em, y), Side::Start, em, Color::Ink);
        x += needed + 1.2 * em;
    }
    y
}

/// The ground that curves are drawn on.
struct Chart {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
    time: Axis,
    value: Axis,
    em: f64,
}

impl Chart {
    fn x(&self, time: f64) -> f64 {
        self.left + self.time.share(time) * (self.right - self.left)
    }

    fn y(&self, value: f64) -> f64 {
        self.bottom - self.value.share(value) * (self.bottom - self.top)
    }

    fn across(&self, y: f64) -> Vec<Point> {
        vec![(self.left, y), (self.right, y)]
    }

    fn shows(&self, bound: &Bound) -> bool {
        (self.value.least..=self.value.greatest).contains(&bound.value)
    }

    /// Grid, numbers with their units, zero, and the axis of time.
    fn draw_axes(&self, drawing: &mut Drawing, unit: &str) {
        let em = self.em;
        for (value, text) in self.value.marks((self.bottom - self.top) / (3.4 * em)) {
            let (y, is_zero) = (self.y(value), value == 0.0 && !self.value.logarithmic);
            drawing.stroke(self.across(y), if is_zero { Color::Axis } else { Color::Grid }, 1.0);
            drawing.words(text, (self.left - 0.6 * em, y + 0.35 * em), Side::End, em, Color::Muted);
        }
        drawing.stroke(self.across(self.bottom), Color::Axis, 1.0);
        for (time, text) in self.time.marks((self.right - self.left) / (4.5 * em)) {
            let x = self.x(time);
            drawing.stroke(vec![(x, self.bottom), (x, self.bottom + 0.3 * em)], Color::Axis, 1.0);
            drawing.words(text, (x, self.bottom + 1.4 * em), Side::Middle, em, Color::Muted);
        }
        drawing.words("s", (self.right + 2.0 * em, self.bottom + 1.4 * em), Side::End, em, Color::Muted);
        drawing.words(unit, (self.left - 0.6 * em, self.top - em), Side::End, em, Color::Muted);
    }

    fn draw_curve(&self, drawing: &mut Drawing, curve: &Curve, track: &Track) {
        let values = track.column(&curve.column).unwrap_or_default();
        let points = values.iter().enumerate().map(|(row, value)| {
            let time = track.start + row as f64 * track.step;
            (self.x(time), self.y(f64::from(*value)))
        });
        let points: Vec<Point> = points.collect();
        for run in points.split(|(_, y)| !y.is_finite()).filter(|run| !run.is_empty()) {
            let points = thinned(run);
            drawing.shapes.push(Shape::Stroke { points, color: curve.color, width: width(curve), line: curve.line });
        }
    }

    /// What each bound is, with its value: at the right or in the middle, above its line or below. Of two equal bounds
    /// on both sides of zero one label says so.
    fn label_bounds(&self, drawing: &mut Drawing, plot: &Plot) {
        let mut written: Vec<[f64; 4]> = Vec::new();
        let shown: Vec<&Bound> = plot.bounds.iter().filter(|bound| self.shows(bound)).collect();
        let size = 0.9 * self.em;
        for bound in &shown {
            let mirrored = bound.value != 0.0
                && shown.iter().any(|other| other.label == bound.label && other.value == -bound.value);
            if mirrored && bound.value < 0.0 {
                continue;
            }
            let sign = if mirrored { "±" } else { "" };
            let text = format!("{}: {sign}{}", bound.label, plot.measure(bound.value));
            let (y, width) = (self.y(bound.value), LETTER_WIDTH_SHARE * size * text.chars().count() as f64);
            let crossed = |[_, top, _, bottom]: [f64; 4]| {
                shown.iter().map(|other| self.y(other.value)).any(|line| top < line && line < bottom)
            };
            let [outer, inner] = if bound.value >= 0.0 { [-1.0, 1.0] } else { [1.0, -1.0] };
            let rights = [self.right - 0.3 * self.em, self.left + 0.55 * (self.right - self.left)];
            let places = rights.into_iter().flat_map(|right| {
                [outer, inner].map(|side| {
                    let middle = y + side * 0.85 * size;
                    [right - width, middle - 0.6 * size, right, middle + 0.6 * size]
                })
            });
            let free = |place: &[f64; 4]| {
                let [left, top, right, bottom] = *place;
                let apart =
                    |other: &[f64; 4]| right < other[0] || other[2] < left || bottom < other[1] || other[3] < top;
                left > self.left && top > self.top - self.em && bottom < self.bottom && written.iter().all(apart)
            };
            let places: Vec<[f64; 4]> = places.filter(free).collect();
            let Some(place) = places.iter().find(|place| !crossed(**place)).or(places.first()) else { continue };
            written.push(*place);
            drawing.words(text, (place[2], place[3] - 0.25 * size), Side::End, size, bound.color);
        }
    }
}

/// The least and the greatest point of each column of pixels, in order, without the middle of a level stretch.
fn thinned(points: &[Point]) -> Vec<Point> {
    let by_height = |a: &&Point, b: &&Point| a.1.total_cmp(&b.1);
    let mut kept: Vec<Point> = Vec::new();
    let mut keep = |point: Point| {
        if let [.., before, last] = kept.as_mut_slice()
            && (before.1 - point.1).abs() < 0.05
            && (last.1 - point.1).abs() < 0.05
        {
            *last = point;
        } else {
            kept.push(point);
        }
    };
    for column in points.chunk_by(|a, b| a.0.floor() == b.0.floor()) {
        let (Some(least), Some(greatest)) = (column.iter().min_by(by_height), column.iter().max_by(by_height)) else {
            continue;
        };
        let (first, second) = if least.0 <= greatest.0 { (least, greatest) } else { (greatest, least) };
        keep(*first);
        if second.0 > first.0 {
            keep(*second);
        }
    }
    // Where the curve ends it is seen to end.
    if let Some(last) = points.last().filter(|last| kept.last() != Some(last)) {
        kept.push(*last);
    }
    kept
}

#[cfg(test)]
mod tests;
