//! Curves over time with their bounds, and a table of their extremes for readers who cannot see them.

use super::prose::{Cell, Table};
use super::track::Track;
use crate::plots::panel::Line;
use crate::table::short;
use serde_json::{Value, json};

/// Colours of Okabe and Ito, which stay apart under the common colour-vision deficiencies; the style sheet has their
/// values.
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
}

impl Color {
    /// For curves side by side: x (roll), y (pitch), z (yaw) are the first three.
    pub const CYCLE: [Self; 6] = [Self::Blue, Self::Vermilion, Self::Green, Self::Orange, Self::Purple, Self::Sky];

    /// The colour of the curve at this place.
    #[must_use]
    pub fn of(place: usize) -> Self {
        Self::CYCLE[place % Self::CYCLE.len()]
    }

    /// Its class in the style sheet.
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
    pub line: Line,
}

impl Curve {
    /// A full line from the page's first track.
    #[must_use]
    pub fn new(column: impl Into<String>, label: impl Into<String>, color: Color) -> Self {
        Self { track: 0, column: column.into(), label: label.into(), color, line: Line::Solid }
    }

    /// The same, dashed.
    #[must_use]
    pub fn dashed(self) -> Self {
        Self { line: Line::Dashed, ..self }
    }
}

/// A level that is not to be crossed.
#[derive(Debug, Clone, PartialEq)]
pub struct Bound {
    /// Where, in the plot's unit.
    pub value: f64,
    /// Its name.
    pub label: String,
    /// The colour of the curve that it belongs to, or [`Color::Ink`].
    pub color: Color,
    /// Whether the axis reaches it even where that flattens the curves. A reader can leave all bounds out.
    pub always: bool,
}

/// Curves over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    /// Its title.
    pub title: String,
    /// The unit of the vertical axis; empty for a number without one.
    pub unit: String,
    /// Whether the vertical axis shows decades.
    pub logarithmic: bool,
    /// The curves.
    pub curves: Vec<Curve>,
    /// The bounds.
    pub bounds: Vec<Bound>,
}

impl Plot {
    /// A plot without bounds.
    #[must_use]
    pub fn new(title: &str, unit: &str, curves: Vec<Curve>) -> Self {
        Self { title: title.to_owned(), unit: unit.to_owned(), logarithmic: false, curves, bounds: Vec::new() }
    }

    /// The same with decades on its vertical axis.
    #[must_use]
    pub fn logarithmic(self) -> Self {
        Self { logarithmic: true, ..self }
    }

    /// The same within `bounds`.
    #[must_use]
    pub fn within(self, bounds: Vec<Bound>) -> Self {
        Self { bounds, ..self }
    }

    /// Its data for the page's program.
    #[must_use]
    pub fn json(&self) -> Value {
        let curves = self.curves.iter().map(|curve| {
            json!({ "track": curve.track, "column": curve.column, "label": curve.label, "color": curve.color.name(),
                "line": curve.line.name() })
        });
        let bounds = self.bounds.iter().map(|bound| {
            json!({ "value": bound.value, "label": bound.label, "color": bound.color.name(), "always": bound.always, "text": self.measure(bound.value) })
        });
        json!({ "title": self.title, "unit": self.unit, "logarithmic": self.logarithmic,
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

    fn measure(&self, value: f64) -> String {
        match (value.is_finite(), self.unit.as_str()) {
            (false, _) => "none".to_owned(),
            (true, "") => short(value),
            (true, "°") => format!("{}°", short(value)),
            (true, unit) => format!("{} {unit}", short(value)),
        }
    }
}
