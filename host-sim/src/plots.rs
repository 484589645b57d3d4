//! The figures of a flight, as SVG text: the eight panels of the paper's Figures 1 and 2, four of them again for the
//! first seconds, and a picture of the path.

pub mod canvas;
pub mod panel;
pub mod panels;
pub mod path;
pub mod record;

use canvas::{PlotError, draw};
use panel::Panel;
use record::Sample;
use scenario::Scenario;

/// Width and height of a figure, pixels.
const SIZE: (u32, u32) = (1240, 860);
/// The part of a flight in the transient's figure, s.
const FIRST_SECONDS: f64 = 5.0;

/// The paper's Figure 1: position, yaw, and the norms of the position's and the attitude's error.
///
/// # Errors
/// [`PlotError`] if the drawing library refuses.
pub fn figure_1(scenario: &Scenario, samples: &[Sample]) -> Result<String, PlotError> {
    figure([
        panels::position(samples),
        panels::yaw(samples),
        panels::position_error(scenario, samples),
        panels::mrp_error(scenario, samples),
    ])
}

/// The paper's Figure 2: thrust and moments with their bounds, filters and saturated feedbacks with theirs.
///
/// # Errors
/// [`PlotError`] if the drawing library refuses.
pub fn figure_2(scenario: &Scenario, samples: &[Sample]) -> Result<String, PlotError> {
    figure([
        panels::thrust(scenario, samples),
        panels::moments(scenario, samples),
        panels::filters(scenario, samples),
        panels::feedbacks(scenario, samples),
    ])
}

/// The first seconds of yaw, attitude error, moments and attitude feedback, which a whole flight squeezes into a few
/// pixels.
///
/// # Errors
/// [`PlotError`] if the drawing library refuses.
pub fn first_seconds(scenario: &Scenario, samples: &[Sample]) -> Result<String, PlotError> {
    let first = &samples[..samples.partition_point(|sample| sample.time < FIRST_SECONDS)];
    figure([
        panels::yaw(first),
        panels::mrp_error(scenario, first),
        panels::moments(scenario, first),
        panels::feedbacks(scenario, first),
    ])
}

/// Four panels, two by two.
fn figure(panels: [Panel; 4]) -> Result<String, PlotError> {
    draw(SIZE, |root| {
        for (area, panel) in root.split_evenly((2, 2)).iter().zip(&panels) {
            panel.draw(area)?;
        }
        Ok(())
    })
}
