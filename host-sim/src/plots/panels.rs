//! The eight panels: which curves, against which bounds.

use super::panel::{BLUE, Bound, Curve, GREEN, INK, Line, Panel, Scale, VERMILION};
use super::record::Sample;
use crate::claims::{PUBLISHED_MRP_ERROR, PUBLISHED_POSITION_ERROR, PUBLISHED_THRUST, PUBLISHED_TORQUE};
use crate::table::short;
use controller_core::certificate::Certificate;
use plotters::style::RGBColor;
use scenario::Scenario;

/// The axes' colours, x (roll), y (pitch), z (yaw).
const AXES: [RGBColor; 3] = [BLUE, VERMILION, GREEN];

/// Position on each axis, with its reference.
#[must_use]
pub fn position(samples: &[Sample]) -> Panel {
    Panel {
        title: "Position",
        quantity: "position [m]",
        scale: Scale::Linear,
        curves: vec![
            flown(samples, "x", AXES[0], |s| s.position.x),
            flown(samples, "y", AXES[1], |s| s.position.y),
            flown(samples, "z", AXES[2], |s| s.position.z),
            desired(samples, "reference", |s| s.desired_position.x),
            desired(samples, "", |s| s.desired_position.y),
            desired(samples, "", |s| s.desired_position.z),
        ],
        bounds: vec![],
    }
}

/// Yaw without jumps, with its reference.
#[must_use]
pub fn yaw(samples: &[Sample]) -> Panel {
    Panel {
        title: "Yaw",
        quantity: "yaw [°]",
        scale: Scale::Linear,
        curves: vec![flown(samples, "yaw", BLUE, |s| s.yaw), desired(samples, "reference", |s| s.desired_yaw)],
        bounds: vec![],
    }
}

/// |p - p_d|; for the paper's scenario with the level it reaches.
#[must_use]
pub fn position_error(scenario: &Scenario, samples: &[Sample]) -> Panel {
    let published = format!("published, steady state: {PUBLISHED_POSITION_ERROR} m");
    let level = bound(PUBLISHED_POSITION_ERROR, published);
    let error = curve(samples, "position error", BLUE, |s| s.position_error);
    error_norm(scenario, "Position error norm", "|p − p_d| [m]", error, level)
}

/// |theta~|; for the paper's scenario with the level it reaches.
#[must_use]
pub fn mrp_error(scenario: &Scenario, samples: &[Sample]) -> Panel {
    let level = bound(PUBLISHED_MRP_ERROR, format!("published, steady state: {PUBLISHED_MRP_ERROR}"));
    let error = curve(samples, "MRP error", BLUE, |s| s.mrp_error);
    error_norm(scenario, "MRP error norm", "|ϑ| [–]", error, level)
}

/// An error over decades; `published` is a level for the paper's scenario only.
fn error_norm(
    scenario: &Scenario,
    title: &'static str,
    quantity: &'static str,
    error: Curve,
    published: Bound,
) -> Panel {
    let bounds = scenario.is_papers().then_some(published).into_iter().collect();
    Panel { title, quantity, scale: Scale::Log, curves: vec![error], bounds }
}

/// Thrust between the published bounds (the paper's scenario) or the certificate's sharp ones (any other), and the
/// vehicle's limit unless it is so far away that it would flatten the curve.
#[must_use]
pub fn thrust(scenario: &Scenario, samples: &[Sample]) -> Panel {
    let (name, interval) = if scenario.is_papers() {
        ("published", Some(PUBLISHED_THRUST))
    } else {
        ("proven", proven(scenario).map(|proven| (proven.thrust().least, proven.thrust().greatest)))
    };
    let limit = f64::from(scenario.configuration.limits().thrust_max);
    let ends = interval.into_iter().flat_map(|(least, greatest)| [least, greatest]);
    let mut bounds: Vec<Bound> = ends.map(|end| bound(end, format!("{name}: {} N", short(end)))).collect();
    if bounds.iter().all(|bound| limit < 2.0 * bound.value) || scenario.is_papers() {
        bounds.push(bound(limit, format!("limit: {} N", short(limit))));
    }
    Panel {
        title: "Thrust",
        quantity: "thrust [N]",
        scale: Scale::Linear,
        curves: vec![curve(samples, "T", BLUE, |s| s.thrust)],
        bounds,
    }
}

/// The certificate, whose bounds hold for every flight from a reset.
fn proven(scenario: &Scenario) -> Option<Certificate> {
    Certificate::new(&scenario.configuration).ok()
}

/// Torques with the published bound of each axis (the paper's scenario) or the certificate's sharp one (any other).
#[must_use]
pub fn moments(scenario: &Scenario, samples: &[Sample]) -> Panel {
    Panel {
        title: "Moments",
        quantity: "torque [N m]",
        scale: Scale::Linear,
        curves: vec![
            curve(samples, "roll", AXES[0], |s| s.torque.x),
            curve(samples, "pitch", AXES[1], |s| s.torque.y),
            curve(samples, "yaw", AXES[2], |s| s.torque.z),
        ],
        bounds: moment_bounds(scenario),
    }
}

/// Equal bounds are drawn once.
fn moment_bounds(scenario: &Scenario) -> Vec<Bound> {
    let proven = || proven(scenario).map(|certificate| certificate.torque().into());
    let Some(values): Option<[f64; 3]> = (if scenario.is_papers() { Some(PUBLISHED_TORQUE) } else { proven() }) else {
        return Vec::new();
    };
    let equal = values.iter().all(|value| *value == values[0]);
    let named = if equal { [("each", INK); 3] } else { [("roll", AXES[0]), ("pitch", AXES[1]), ("yaw", AXES[2])] };
    let both = |(value, (name, color)): (f64, (&str, RGBColor))| {
        [
            Bound { value, label: format!("{name} {}", short(value)), color },
            Bound { value: -value, label: format!("{name} −{}", short(value)), color },
        ]
    };
    values.into_iter().zip(named).take(if equal { 1 } else { 3 }).flat_map(both).collect()
}

/// |ubar_p|, |u_f|, |u_s| below sqrt(3) M_p under the paper's law.
#[must_use]
pub fn filters(scenario: &Scenario, samples: &[Sample]) -> Panel {
    let level = scenario.configuration.gains().map(|gains| 3f64.sqrt() * f64::from(gains.m_p));
    let feedback = curve(samples, "|ū_p|", BLUE, |s| s.filter_norms.x);
    Panel {
        title: "Saturated position feedback and its filters",
        quantity: "norm [m/s²]",
        scale: Scale::Linear,
        curves: vec![
            // The filter u_s follows within a twentieth of a second and would hide it.
            Curve { width: 5, ..feedback },
            curve(samples, "|u_f|", VERMILION, |s| s.filter_norms.y),
            curve(samples, "|u_s|", GREEN, |s| s.filter_norms.z),
        ],
        bounds: level.map(|level| bound(level, format!("√3 M_p = {level:.3}"))).into_iter().collect(),
    }
}

/// |s_theta| below M_theta, |s_omega| below M_omega under the paper's law.
#[must_use]
pub fn feedbacks(scenario: &Scenario, samples: &[Sample]) -> Panel {
    let levels = scenario.configuration.gains().map(|gains| {
        [("M_ϑ", gains.m_theta, BLUE), ("M_ω", gains.m_omega, VERMILION)].map(|(name, level, color)| {
            let level = f64::from(level);
            Bound { value: level, label: format!("{name} = {}", short(level)), color }
        })
    });
    Panel {
        title: "Saturated attitude and rate feedback",
        quantity: "norm [N m]",
        scale: Scale::Linear,
        curves: vec![
            curve(samples, "|s_ϑ|", BLUE, |s| s.feedback_norms.0),
            curve(samples, "|s_ω|", VERMILION, |s| s.feedback_norms.1),
        ],
        bounds: levels.into_iter().flatten().collect(),
    }
}

fn bound(value: f64, label: String) -> Bound {
    Bound { value, label, color: INK }
}

fn curve(samples: &[Sample], label: &str, color: RGBColor, get: fn(&Sample) -> f64) -> Curve {
    let points = samples.iter().map(|sample| (sample.time, get(sample))).collect();
    Curve { label: label.to_owned(), color, line: Line::Solid, width: 2, points }
}

/// A curve that shows beneath its reference once the two agree.
fn flown(samples: &[Sample], label: &str, color: RGBColor, get: fn(&Sample) -> f64) -> Curve {
    Curve { width: 3, ..curve(samples, label, color, get) }
}

fn desired(samples: &[Sample], label: &str, get: fn(&Sample) -> f64) -> Curve {
    Curve { line: Line::Dashed, width: 1, ..curve(samples, label, INK, get) }
}
