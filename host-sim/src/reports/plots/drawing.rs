//! What every figure is drawn on: lines and words on a ground. It is written as SVG, or as pixels, without the words.

use crate::reports::report::plot::{Color, LinePattern};
use crate::reports::report::text::escaped;
use std::fmt::Write;
use tiny_skia::{LineCap, LineJoin, Paint, PathBuilder, Pixmap, Stroke, StrokeDash, Transform};

/// A place in a drawing: pixels from the left and from the top.
pub type Point = (f64, f64);

/// Which side of a word its place is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// It begins there.
    Start,
    /// Its middle is there.
    Middle,
    /// It ends there.
    End,
}

/// What a drawing is made of.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// A line from point to point.
    Stroke {
        /// Where it goes.
        points: Vec<Point>,
        /// Its colour.
        color: Color,
        /// Pixels.
        width: f64,
        /// How it is drawn.
        line: LinePattern,
    },
    /// A line of text, on a rim of the ground's colour that keeps it legible on lines.
    Words {
        /// Where, on the line that letters stand on.
        at: Point,
        /// What is there.
        side: Side,
        /// Height of the type, pixels.
        size: f64,
        /// Its colour.
        color: Color,
        /// Whether it is a heading.
        bold: bool,
        /// What it says.
        text: String,
    },
}

/// How the colours of an SVG are named.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Inks {
    /// By their values, on white: a file of its own.
    Light,
    /// After the page that the SVG stands in, light or dark.
    Page,
}

impl Inks {
    fn named(self, color: Color) -> String {
        match self {
            Self::Light => color.hex().to_owned(),
            Self::Page => format!("var(--{})", color.name()),
        }
    }
}

/// A drawing.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    /// Width and height, pixels.
    pub size: (u32, u32),
    /// What is drawn, the lowest first.
    pub shapes: Vec<Shape>,
}

impl Drawing {
    /// An empty one.
    #[must_use]
    pub const fn new(size: (u32, u32)) -> Self {
        Self { size, shapes: Vec::new() }
    }

    /// Draws a line without gaps.
    pub fn stroke(&mut self, points: Vec<Point>, color: Color, width: f64) {
        self.shapes.push(Shape::Stroke { points, color, width, line: LinePattern::Solid });
    }

    /// Writes plain words.
    pub fn words(&mut self, text: impl Into<String>, at: Point, side: Side, size: f64, color: Color) {
        self.shapes.push(Shape::Words { at, side, size, color, bold: false, text: text.into() });
    }

    /// As SVG; `about` says what it shows to whoever does not see it.
    #[must_use]
    pub fn svg(&self, inks: Inks, about: &str) -> String {
        let ((width, height), about) = (self.size, escaped(about));
        let named = match inks {
            Inks::Light => format!("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\""),
            Inks::Page => "<svg".to_owned(),
        };
        let card = inks.named(Color::Card);
        let mut svg = format!(
            "{named} viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{about}\" font-family=\"sans-serif\" fill=\"none\" \
             stroke-linecap=\"round\" stroke-linejoin=\"round\">\n<rect width=\"{width}\" height=\"{height}\" fill=\"{card}\"/>\n"
        );
        for shape in &self.shapes {
            // A string takes whatever is written to it.
            let _ = match shape {
                Shape::Stroke { points, color, width, line } => {
                    let dashes = pattern(*line, *width).map_or(String::new(), |[dash, gap]| {
                        format!(" stroke-dasharray=\"{} {}\" stroke-linecap=\"butt\"", tenths(dash), tenths(gap))
                    });
                    let (stroke, width) = (inks.named(*color), tenths(*width));
                    let points: Vec<String> =
                        points.iter().map(|(x, y)| format!("{},{}", tenths(*x), tenths(*y))).collect();
                    let points = points.join(" ");
                    writeln!(
                        svg,
                        "<polyline stroke=\"{stroke}\" stroke-width=\"{width}\"{dashes} points=\"{points}\"/>"
                    )
                }
                Shape::Words { at: (x, y), side, size, color, bold, text } => {
                    let anchor = ["start", "middle", "end"][*side as usize];
                    let weight = if *bold { " font-weight=\"bold\"" } else { "" };
                    let (x, y, size, fill, text) =
                        (tenths(*x), tenths(*y), tenths(*size), inks.named(*color), escaped(text));
                    writeln!(
                        svg,
                        "<text x=\"{x}\" y=\"{y}\" text-anchor=\"{anchor}\" font-size=\"{size}\"{weight} fill=\"{fill}\" \
                         stroke=\"{card}\" stroke-width=\"5\" paint-order=\"stroke\">{text}</text>"
                    )
                }
            };
        }
        svg + "</svg>\n"
    }

    /// As pixels; none if it has none.
    #[must_use]
    pub fn pixels(&self) -> Option<Pixmap> {
        let mut pixels = Pixmap::new(self.size.0, self.size.1)?;
        pixels.fill(paint(Color::Card));
        for shape in &self.shapes {
            let Shape::Stroke { points, color, width, line } = shape else { continue };
            let mut path = PathBuilder::new();
            for (place, (x, y)) in points.iter().enumerate() {
                if place == 0 { path.move_to(*x as f32, *y as f32) } else { path.line_to(*x as f32, *y as f32) }
            }
            let dash = pattern(*line, *width).and_then(|dashes| StrokeDash::new(dashes.map(|d| d as f32).into(), 0.0));
            let stroke = Stroke {
                width: *width as f32,
                line_cap: LineCap::Round,
                line_join: LineJoin::Round,
                dash,
                ..Stroke::default()
            };
            let mut ink = Paint::default();
            ink.set_color(paint(*color));
            if let Some(path) = path.finish() {
                pixels.stroke_path(&path, &ink, &stroke, Transform::identity(), None);
            }
        }
        Some(pixels)
    }
}

/// Red, green and blue of a colour of the light scheme.
#[must_use]
pub fn channels(color: Color) -> [u8; 3] {
    let value = u32::from_str_radix(&color.hex()[1..], 16).unwrap_or(0).to_be_bytes();
    [value[1], value[2], value[3]]
}

fn paint(color: Color) -> tiny_skia::Color {
    let [red, green, blue] = channels(color);
    tiny_skia::Color::from_rgba8(red, green, blue, 255)
}

/// Lengths of a dash and of the gap behind it.
fn pattern(line: LinePattern, width: f64) -> Option<[f64; 2]> {
    match line {
        LinePattern::Solid => None,
        LinePattern::Dashed => Some([4.0 + width, 4.0]),
        LinePattern::Dotted => Some([1.0 + width, 3.0]),
    }
}

/// To a tenth of a pixel, in as few characters as that takes.
fn tenths(value: f64) -> String {
    let text = format!("{value:.1}");
    text.strip_suffix(".0").map_or_else(|| text.clone(), str::to_owned)
}
