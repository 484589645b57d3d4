//! The eight panels of the paper's Figures 1 and 2, and a picture of the path, as SVG text.

pub mod panel;
pub mod path;

pub mod record;

use crate::claims::{PUBLISHED_THRUST, PUBLISHED_TORQUE, theorem_1_thrust};
use crate::scenario::Scenario;
use panel::{BLUE, Bound, Curve, GREEN, INK, Panel, Scale, VERMILION};
use plotters::prelude::*;
use record::Sample;

/// Width and height of a figure, pixels.
const SIZE: (u32, u32) = (1240, 860);

/// A figure could not be drawn.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PlotError(String);

impl std::fmt::Display for PlotError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "a figure could not be drawn: {}", self.0)
    }
}

impl std::error::Error for PlotError {}

/// Figure 1: position, yaw, and the norms of their errors.
///
/// # Errors
/// [`PlotError`] if the drawing library refuses.
pub fn figure_1(samples: &[Sample]) -> Result<String, PlotError> {
    let reference =
        |label: &str, get: fn(&Sample) -> f64| Curve { dashed: true, color: INK, ..curve(samples, label, BLUE, get) };
    let position = Panel {
        title: "Position",
        quantity: "position [m]",
        scale: Scale::Linear,
        curves: vec![
            curve(samples, "x", BLUE, |s| s.position.x),
            curve(samples, "y", VERMILION, |s| s.position.y),
            curve(samples, "z", GREEN, |s| s.position.z),
            reference("reference", |s| s.desired_position.x),
            reference("", |s| s.desired_position.y),
            reference("", |s| s.desired_position.z),
        ],
        bounds: vec![],
    };
    let yaw = Panel {
        title: "Yaw",
        quantity: "yaw [°]",
        scale: Scale::Linear,
        curves: vec![curve(samples, "yaw", BLUE, |s| s.yaw), reference("reference", |s| s.desired_yaw)],
        bounds: vec![],
    };
    let position_error = Panel {
        title: "Position error norm",
        quantity: "|p − p_d| [m]",
        scale: Scale::Log,
        curves: vec![curve(samples, "position error", BLUE, |s| s.position_error)],
        bounds: vec![],
    };
    let mrp_error = Panel {
        title: "MRP error norm",
        quantity: "|ϑ| [–]",
        scale: Scale::Log,
        curves: vec![curve(samples, "MRP error", BLUE, |s| s.mrp_error)],
        bounds: vec![],
    };
    figure([position, yaw, position_error, mrp_error])
}

/// Figure 2: thrust and moments with their bounds, filters and saturated feedbacks with theirs.
///
/// # Errors
/// [`PlotError`] if the drawing library refuses.
pub fn figure_2(scenario: &Scenario, samples: &[Sample]) -> Result<String, PlotError> {
    let bound = |value: f64, label: String| Bound { value, label, color: INK };
    let gains = scenario.configuration.gains();
    let thrust = Panel {
        title: "Thrust",
        quantity: "thrust [N]",
        scale: Scale::Linear,
        curves: vec![curve(samples, "T", BLUE, |s| s.thrust)],
        bounds: thrust_bounds(scenario),
    };
    let moments = Panel {
        title: "Moments",
        quantity: "torque [N m]",
        scale: Scale::Linear,
        curves: vec![
            curve(samples, "roll", BLUE, |s| s.torque.x),
            curve(samples, "pitch", VERMILION, |s| s.torque.y),
            curve(samples, "yaw", GREEN, |s| s.torque.z),
        ],
        bounds: moment_bounds(scenario),
    };
    let filters = Panel {
        title: "Saturated position feedback and its filters",
        quantity: "norm [m/s²]",
        scale: Scale::Linear,
        curves: vec![
            curve(samples, "|ū_p|", BLUE, |s| s.filter_norms.x),
            curve(samples, "|u_f|", VERMILION, |s| s.filter_norms.y),
            curve(samples, "|u_s|", GREEN, |s| s.filter_norms.z),
        ],
        bounds: vec![bound(
            3f64.sqrt() * f64::from(gains.m_p),
            format!("√3 M_p = {:.3}", 3f64.sqrt() * f64::from(gains.m_p)),
        )],
    };
    let feedbacks = Panel {
        title: "Saturated attitude and rate feedback",
        quantity: "norm [N m]",
        scale: Scale::Linear,
        curves: vec![
            curve(samples, "|s_ϑ|", BLUE, |s| s.feedback_norms.0),
            curve(samples, "|s_ω|", VERMILION, |s| s.feedback_norms.1),
        ],
        bounds: vec![
            bound(f64::from(gains.m_theta), format!("M_ϑ = {}", gains.m_theta)),
            bound(f64::from(gains.m_omega), format!("M_ω = {}", gains.m_omega)),
        ],
    };
    figure([thrust, moments, filters, feedbacks])
}

/// The published thrust interval for the paper's scenario, Theorem 1's for any other, and the vehicle's limit.
fn thrust_bounds(scenario: &Scenario) -> Vec<Bound> {
    let (name, (least, greatest)) =
        if scenario.is_papers() { ("published", PUBLISHED_THRUST) } else { ("Theorem 1", theorem_1_thrust(scenario)) };
    let limit = f64::from(scenario.configuration.limits().thrust_max);
    let bound = |value: f64, label: String| Bound { value, label, color: INK };
    vec![
        bound(least, format!("{name}: {least:.2} N")),
        bound(greatest, format!("{name}: {greatest:.2} N")),
        bound(limit, format!("limit: {limit:.2} N")),
    ]
}

/// The published bound of each axis for the paper's scenario, the vehicle's limits for any other; equal ones drawn once.
fn moment_bounds(scenario: &Scenario) -> Vec<Bound> {
    let limits = scenario.configuration.limits().torque_max.map(f64::from);
    let values = if scenario.is_papers() { PUBLISHED_TORQUE } else { limits.into() };
    let equal = values.iter().all(|value| *value == values[0]);
    let named = [("roll", BLUE), ("pitch", VERMILION), ("yaw", GREEN)];
    let mut bounds = Vec::new();
    for (value, (name, color)) in values.into_iter().zip(named).take(if equal { 1 } else { 3 }) {
        let (name, color) = if equal { ("limit", INK) } else { (name, color) };
        bounds.push(Bound { value, label: format!("{name} {value:.2}"), color });
        bounds.push(Bound { value: -value, label: format!("{name} −{value:.2}"), color });
    }
    bounds
}

fn curve(samples: &[Sample], label: &str, color: RGBColor, get: fn(&Sample) -> f64) -> Curve {
    let points = samples.iter().map(|sample| (sample.time, get(sample))).collect();
    Curve { label: label.to_owned(), color, dashed: false, points }
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

/// An SVG of `size` filled by `fill` on white.
fn draw<'a, F>(size: (u32, u32), fill: F) -> Result<String, PlotError>
where
    F: FnOnce(&DrawingArea<SVGBackend, plotters::coord::Shift>) -> panel::DrawingResult<SVGBackend<'a>>,
{
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        let drawn = root.fill(&WHITE).and_then(|()| fill(&root)).and_then(|()| root.present());
        drawn.map_err(|error| PlotError(error.to_string()))?;
    }
    Ok(svg)
}
