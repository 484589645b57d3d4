//! The canvas of every figure: an SVG, finer than the drawing library's whole pixels.

use plotters::coord::Shift;
use plotters::prelude::*;

/// The drawing library counts in whole pixels: drawn so many times larger and shown smaller, curves are smooth.
pub const FINE: i32 = 8;

/// The result of drawing on a backend.
pub type DrawingResult<DB> = Result<(), DrawingAreaErrorKind<<DB as DrawingBackend>::ErrorType>>;

/// A figure could not be drawn.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PlotError(String);

impl std::fmt::Display for PlotError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "a figure could not be drawn: {}", self.0)
    }
}

impl std::error::Error for PlotError {}

/// An SVG of `size` pixels filled by `fill` on white.
///
/// # Errors
/// [`PlotError`] if the drawing library refuses.
pub fn draw<'a, F>(size: (u32, u32), fill: F) -> Result<String, PlotError>
where
    F: FnOnce(&DrawingArea<SVGBackend, Shift>) -> DrawingResult<SVGBackend<'a>>,
{
    let mut svg = String::new();
    let fine = (size.0 * FINE as u32, size.1 * FINE as u32);
    {
        let root = SVGBackend::with_string(&mut svg, fine).into_drawing_area();
        let drawn = root.fill(&WHITE).and_then(|()| fill(&root)).and_then(|()| root.present());
        drawn.map_err(|error| PlotError(error.to_string()))?;
    }
    let (drawn, shown) = (extent(fine), extent(size));
    Ok(svg.replacen(&drawn, &shown, 1))
}

/// The attributes of an SVG that say how large it is shown.
fn extent((width, height): (u32, u32)) -> String {
    format!("width=\"{width}\" height=\"{height}\"")
}
