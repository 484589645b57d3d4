//! The figures of a flight: the eight panels of the paper's Figures 1 and 2, four of them again for the first seconds,
//! and pictures of the path, still and moving. What a panel shows is a [`Plot`] of the report.

pub mod axis;
pub mod drawing;
pub mod panel;
pub mod path;
pub mod replay;

use crate::reports::report::plot::Plot;
use crate::reports::report::track::Track;
use drawing::{Drawing, Inks};
use panel::Area;

/// The paper's Figure 1: position, yaw, and the norms of the position's and the attitude's error.
pub const FIGURE_1: [&str; 4] = ["Position", "Yaw", "Position error", "Attitude error (MRP)"];
/// The paper's Figure 2: thrust and torques with their bounds, filters and saturated feedbacks with theirs.
pub const FIGURE_2: [&str; 4] =
    ["Thrust", "Torques", "Position feedback and its filters", "Saturated attitude and rate feedback"];
/// What happens in the first seconds, which a whole flight squeezes into a few pixels.
pub const FIRST_SECONDS: [&str; 4] = ["Yaw", "Attitude error (MRP)", "Torques", "Saturated attitude and rate feedback"];
/// The part of a flight that the transient's figure shows.
const TRANSIENT_S: f64 = 5.0;

/// The plots of these titles, two by two.
#[must_use]
pub fn figure(plots: &[Plot], titles: [&str; 4], track: &Track) -> String {
    let titled = titles.iter().filter_map(|title| plots.iter().find(|plot| plot.title == *title));
    let tracks = std::slice::from_ref(track);
    four(titled.map(|plot| (plot, tracks)), (620.0, 430.0), &titles.join(", "))
}

/// The same of the first seconds.
#[must_use]
pub fn first_seconds(plots: &[Plot], track: &Track) -> String {
    figure(plots, FIRST_SECONDS, &track.until(TRANSIENT_S))
}

/// Four plots, each with its tracks and of that size, two by two.
#[must_use]
pub fn four<'a>(plots: impl Iterator<Item = (&'a Plot, &'a [Track])>, size: (f64, f64), about: &str) -> String {
    let mut drawing = Drawing::new(((2.0 * size.0) as u32, (2.0 * size.1) as u32));
    let corners = [(0.0, 0.0), (size.0, 0.0), (0.0, size.1), size];
    for ((plot, tracks), corner) in plots.zip(corners) {
        panel::draw(&mut drawing, Area { corner, size, em: 14.0, titled: true }, plot, tracks);
    }
    drawing.svg(Inks::Light, about)
}
