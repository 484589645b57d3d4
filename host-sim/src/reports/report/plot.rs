//! Curves over time and what bounds them, with a table of their extremes for whoever reads rather than looks.
//!
//! The one description of a plot: the page's program draws it from [`Plot::json`], [`crate::reports::plots::panel`] as SVG.

use super::prose::{Cell, Table};
use super::track::Track;
use crate::output::table::short;
use serde_json::{Value, json};

/// The style sheet, which has the colours' values.
pub const STYLE_SHEET: &str = include_str!("../../../report/page.css");

/// Colours of Okabe and Ito, which stay apart under the common colour-vision deficiencies, and those of axes and
/// grounds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Color {
    /// The first axis, or the only curve.
    Blue,
    /// The second axis.
    Vermilion,
    /// The third axis.
    Green,
    /// A fourth curve, and references in space.
    Orange,
    /// A fifth curve.
    Purple,
    /// A sixth curve.
    Sky,
    /// A seventh rival.
    Grey,
    /// Bounds that belong to no curve; our law beside others.
    Ink,
    /// Words on axes.
    Muted,
    /// Lines at round numbers.
    Grid,
    /// The axes, and zero.
    Axis,
    /// A path's shadow on the floor.
    Shadow,
    /// The ground that all is drawn on.
    Card,
}

impl Color {
    /// For curves side by side: x (roll), y (pitch), z (yaw) are the first three.
    pub const COLOR_CYCLE: [Self; 6] =
        [Self::Blue, Self::Vermilion, Self::Green, Self::Orange, Self::Purple, Self::Sky];

    /// The colour of the curve at this place.
    #[must_use]
    pub fn at_place(place: usize) -> Self {
        Self::COLOR_CYCLE[place % Self::COLOR_CYCLE.len()]
    }

    /// What the style sheet calls it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Blue => "blue",
            Self::Vermilion => "vermilion",
            Self::Green => "green",
            Self::Orange => "orange",
            Self::Purple => "purple",
            Self::Sky => "sky",
            Self::Grey => "grey",
            Self::Ink => "ink",
            Self::Muted => "muted",
            Self::Grid => "grid",
            Self::Axis => "axis",
            Self::Shadow => "shadow",
            Self::Card => "card",
        }
    }

    /// Its value in the light scheme: `#rrggbb`.
    #[must_use]
    pub fn hex(self) -> &'static str {
        let value = STYLE_SHEET.split_once(&format!("--{}: ", self.name())).and_then(|(_, value)| value.get(..7));
        value.unwrap_or("#000000")
    }
}

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LinePattern {
    /// Without gaps.
    Solid,
    /// In dashes: something asked for rather than flown; or one of many laws, so that not colour alone tells them
    /// apart.
    Dashed,
    /// In dots: a second such pattern.
    Dotted,
}

impl LinePattern {
    /// What the style sheet calls it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Solid => "solid",
            Self::Dashed => "dashed",
            Self::Dotted => "dotted",
        }
    }
}

/// A column of a track, drawn.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Curve {
    /// Which of the page's tracks.
    pub track: usize,
    /// Which of its columns.
    pub column: String,
    /// Its name in the legend.
    pub label: String,
    /// Its colour.
    pub color: Color,
    /// How it is drawn.
    pub line: LinePattern,
    /// Whether it is drawn so broad that its rim shows beneath a curve that covers it.
    pub broad: bool,
}

impl Curve {
    /// A full line from the page's first track.
    #[must_use]
    pub fn new(column: impl Into<String>, label: impl Into<String>, color: Color) -> Self {
        Self { track: 0, column: column.into(), label: label.into(), color, line: LinePattern::Solid, broad: false }
    }

    /// The same, dashed.
    #[must_use]
    pub fn dashed(self) -> Self {
        Self { line: LinePattern::Dashed, ..self }
    }

    /// The same, broad.
    #[must_use]
    pub fn broad(self) -> Self {
        Self { broad: true, ..self }
    }
}

/// A level that is not to be crossed.
#[derive(Debug, Clone, PartialEq)]
pub struct Bound {
    /// Where, in the plot's unit.
    pub value: f64,
    /// What it is.
    pub label: String,
    /// The colour of the curve that it belongs to, or [`Color::Ink`].
    pub color: Color,
    /// Whether the axis reaches it even where that flattens the curves. A reader can leave all bounds out.
    pub always: bool,
}

/// Curves over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    /// What is shown.
    pub title: String,
    /// The unit of the vertical axis; empty for a number without one.
    pub unit: String,
    /// Whether the vertical axis shows decades.
    pub logarithmic: bool,
    /// Whether the vertical axis reaches zero though nothing drawn comes near.
    pub from_zero: bool,
    /// What is drawn.
    pub curves: Vec<Curve>,
    /// What it is measured against.
    pub bounds: Vec<Bound>,
}

impl Plot {
    /// A plot without bounds.
    #[must_use]
    pub fn new(title: &str, unit: &str, curves: Vec<Curve>) -> Self {
        let (title, unit) = (title.to_owned(), unit.to_owned());
        Self { title, unit, logarithmic: false, from_zero: false, curves, bounds: Vec::new() }
    }

    /// The same with decades on its vertical axis.
    #[must_use]
    pub fn logarithmic(self) -> Self {
        Self { logarithmic: true, ..self }
    }

    /// The same with zero on its vertical axis.
    #[must_use]
    pub fn from_zero(self) -> Self {
        Self { from_zero: true, ..self }
    }

    /// The same within `bounds`.
    #[must_use]
    pub fn within(self, bounds: Vec<Bound>) -> Self {
        Self { bounds, ..self }
    }

    /// What the page's program reads.
    #[must_use]
    pub fn json(&self) -> Value {
        let curves = self.curves.iter().map(|curve| {
            json!({ "track": curve.track, "column": curve.column, "label": curve.label, "color": curve.color.name(),
                "line": curve.line.name(), "broad": curve.broad })
        });
        let bounds = self.bounds.iter().map(|bound| {
            json!({ "value": bound.value, "label": bound.label, "color": bound.color.name(), "always": bound.always, "text": self.measure(bound.value) })
        });
        json!({ "title": self.title, "unit": self.unit, "logarithmic": self.logarithmic, "fromZero": self.from_zero,
            "curves": curves.collect::<Vec<_>>(), "bounds": bounds.collect::<Vec<_>>() })
    }

    /// Least, greatest and last value of each curve, then the bounds.
    #[must_use]
    pub fn table(&self, tracks: &[Track]) -> Table {
        let mut table =
            Table::new(format!("{}, in figures", self.title), &["curve", "least", "greatest", "at the end"]);
        for curve in &self.curves {
            let values = tracks.get(curve.track).and_then(|track| track.column(&curve.column)).unwrap_or_default();
            let seen = values.iter().copied().filter(|value| value.is_finite());
            let (least, greatest) = seen.fold((f32::INFINITY, f32::NEG_INFINITY), |(l, g), v| (l.min(v), g.max(v)));
            let last = values.last().copied().unwrap_or(f32::NAN);
            let figures = [least, greatest, last].map(|value| Cell::number(self.measure(f64::from(value))));
            table.rows.push([vec![Cell::text(curve.label.clone())], figures.to_vec()].concat());
        }
        for bound in &self.bounds {
            let cells = [bound.label.clone(), String::new(), self.measure(bound.value), String::new()];
            let [name, rest @ ..] = cells;
            table.rows.push([vec![Cell::text(name)], rest.map(Cell::Number).to_vec()].concat());
        }
        table
    }

    /// A value with the plot's unit.
    #[must_use]
    pub fn measure(&self, value: f64) -> String {
        match (value.is_finite(), self.unit.as_str()) {
            (false, _) => "none".to_owned(),
            (true, "") => short(value),
            (true, "°") => format!("{}°", short(value)),
            (true, unit) => format!("{} {unit}", short(value)),
        }
    }
}
