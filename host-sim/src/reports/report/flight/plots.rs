//! The plots of a flight: which columns, against which bounds.

use crate::flight::claims::{
    PUBLISHED_MRP_ERROR, PUBLISHED_POSITION_ERROR_M, PUBLISHED_THRUST_N, PUBLISHED_TORQUE_N_M,
};
use crate::reports::report::plot::{Bound, Color, Curve, Plot};
use crate::reports::report::track::Track;
use controller_core::certificate::Certificate;
use controller_core::certificate::form::Interval;
use scenario::Scenario;

/// What the vehicle has, which may be far from what is ever commanded.
const LIMIT_LABEL: &str = "vehicle's limit";

/// Every plot for which `track` has columns; cut commands only where there are any.
#[must_use]
pub fn plots(scenario: &Scenario, certificate: &Certificate, track: &Track) -> Vec<Plot> {
    let mut plots = motion(scenario);
    plots.extend(commands(scenario, certificate));
    plots.extend(inside(scenario));
    plots.extend(estimates());
    plots.extend(surroundings());
    let cut = track.column("clipped").is_some_and(|clipped| clipped.contains(&1.0));
    plots.retain(|plot| {
        let mut columns = plot.curves.iter().map(|curve| curve.column.as_str());
        columns.all(|column| track.column(column).is_some() && (column != "clipped" || cut))
    });
    plots
}

/// Where it is, how it stands, and how far that is from what was asked.
fn motion(scenario: &Scenario) -> Vec<Plot> {
    let published = |value| if scenario.is_papers() { vec![ink(value, "published, steady state")] } else { vec![] };
    vec![
        Plot::new("Position", "m", [flown(["px", "py", "pz"]), desired(["pdx", "pdy", "pdz"])].concat()),
        Plot::new("Position error", "m", vec![Curve::new("position_error", "|p − p_d|", Color::Blue)])
            .logarithmic()
            .within(published(PUBLISHED_POSITION_ERROR_M)),
        Plot::new(
            "Yaw",
            "°",
            vec![Curve::new("yaw", "yaw", Color::Blue).broad(), Curve::new("yaw_d", "asked", Color::Ink).dashed()],
        ),
        Plot::new("Tilt of the thrust axis", "°", vec![Curve::new("tilt", "tilt", Color::Blue)]),
        Plot::new("Attitude error (MRP)", "", vec![Curve::new("mrp_error", "|ϑ|", Color::Blue)])
            .logarithmic()
            .within(published(PUBLISHED_MRP_ERROR)),
        Plot::new(
            "Attitude error, components",
            "",
            [axes(["mrp_x", "mrp_y", "mrp_z"]), vec![Curve::new("lift_sign", "m*, the lift", Color::Orange)]].concat(),
        ),
        Plot::new("Velocity", "m/s", axes(["vx", "vy", "vz"])),
        Plot::new("Body rates", "rad/s", [flown(["wx", "wy", "wz"]), desired(["wdx", "wdy", "wdz"])].concat()),
    ]
}

/// What the law commands, within what is proven and what the vehicle has.
fn commands(scenario: &Scenario, certificate: &Certificate) -> Vec<Plot> {
    let limits = scenario.configuration.limits();
    let mut thrust = interval(certificate.thrust(), "proven", Color::Ink);
    if scenario.is_papers() {
        thrust.extend([PUBLISHED_THRUST_N.0, PUBLISHED_THRUST_N.1].map(|value| ink(value, "published")));
    }
    thrust.push(ink(f64::from(limits.thrust_max), LIMIT_LABEL));
    let mut torque = both(certificate.torque().into(), "proven");
    if scenario.is_papers() {
        torque.extend(both(PUBLISHED_TORQUE_N_M, "published"));
    }
    torque.extend(both(limits.torque_max.map(f64::from).into(), LIMIT_LABEL));
    let mut plots = vec![
        Plot::new("Thrust", "N", vec![Curve::new("thrust", "thrust", Color::Blue)]).from_zero().within(thrust),
        Plot::new("Torques", "N m", axes(["tau_x", "tau_y", "tau_z"])).within(torque),
        Plot::new("Commands cut by the limits", "", vec![Curve::new("clipped", "1: cut", Color::Blue)]),
    ];
    if let Some(rotors) = scenario.configuration.rotors() {
        let curve = |rotor: usize| {
            Curve::new(format!("rotor_{}", rotor + 1), format!("rotor {}", rotor + 1), Color::at_place(rotor))
        };
        let proven = (0..rotors.len()).filter_map(|rotor| Some((rotor, certificate.rotor(rotor)?)));
        let mut bounds: Vec<Bound> = proven
            .flat_map(|(rotor, proven)| {
                interval(proven, &format!("rotor {}, proven", rotor + 1), Color::at_place(rotor))
            })
            .collect();
        let given = rotors.iter().map(|rotor| Interval { min: rotor.thrust_min.into(), max: rotor.thrust_max.into() });
        bounds.extend(given.take(1).flat_map(|given| interval(given, "a rotor's own limit", Color::Ink)));
        plots.push(Plot::new("Rotor thrusts", "N", (0..rotors.len()).map(curve).collect()).from_zero().within(bounds));
    }
    plots
}

/// What the law goes through on its way: filters and saturated feedbacks.
fn inside(scenario: &Scenario) -> Vec<Plot> {
    let gains = scenario.configuration.gains();
    let level =
        |value: f32, label: &str, color| Bound { value: value.into(), label: label.to_owned(), color, always: true };
    let m_p = gains.map(|gains| [level(gains.m_p, "M_p", Color::Ink), level(-gains.m_p, "M_p", Color::Ink)]);
    let norm = gains.map(|gains| ink(3f64.sqrt() * f64::from(gains.m_p), "√3 M_p"));
    let feedbacks =
        gains.map(|gains| [level(gains.m_theta, "M_ϑ", Color::Blue), level(gains.m_omega, "M_ω", Color::Vermilion)]);
    let curves = |columns: [(&str, &str); 3]| {
        columns
            .into_iter()
            .enumerate()
            .map(|(place, (column, label))| Curve::new(column, label, Color::at_place(place)))
            .collect()
    };
    let mut filters: Vec<Curve> =
        curves([("filter_input", "|ū_p|"), ("filter_first", "|u_f|"), ("filter_second", "|u_s|")]);
    // The second filter follows its input within a twentieth of a second and would hide it.
    filters[0].broad = true;
    let second = [("us_x", "u_s x"), ("us_y", "u_s y"), ("us_z", "u_s z")];
    vec![
        Plot::new("Position feedback and its filters", "m/s²", filters).within(norm.into_iter().collect()),
        Plot::new("First filter", "m/s²", curves([("uf_x", "u_f x"), ("uf_y", "u_f y"), ("uf_z", "u_f z")]))
            .within(m_p.clone().into_iter().flatten().collect()),
        Plot::new("Second filter", "m/s²", curves(second)).within(m_p.into_iter().flatten().collect()),
        Plot::new(
            "Saturated attitude and rate feedback",
            "N m",
            vec![Curve::new("s_theta", "|s_ϑ|", Color::Blue), Curve::new("s_omega", "|s_ω|", Color::Vermilion)],
        )
        .within(feedbacks.into_iter().flatten().collect()),
    ]
}

/// The law's estimates, and the errors of its measured state.
fn estimates() -> Vec<Plot> {
    let error = |title, unit, column| {
        Plot::new(title, unit, vec![Curve::new(column, "measured − true", Color::Blue)]).logarithmic()
    };
    vec![
        Plot::new("Estimated force per mass", "m/s²", axes(["d_x", "d_y", "d_z"])),
        Plot::new("Estimated torque", "N m", axes(["tau_d_x", "tau_d_y", "tau_d_z"])),
        Plot::new("Estimated thrust scale", "", vec![Curve::new("thrust_scale", "scale", Color::Blue)]),
        error("Error of the measured position", "m", "measured_position"),
        error("Error of the velocity", "m/s", "measured_velocity"),
        error("Error of the attitude", "°", "measured_attitude"),
        error("Error of the body rates", "rad/s", "measured_rate"),
    ]
}

fn surroundings() -> Vec<Plot> {
    vec![
        Plot::new("Wind", "m/s", axes(["wind_x", "wind_y", "wind_z"])),
        Plot::new("Battery voltage", "V", vec![Curve::new("voltage", "voltage", Color::Blue)]),
        Plot::new("Battery current", "A", vec![Curve::new("current", "current", Color::Blue)]),
    ]
}

/// Curves of a vector's components.
fn axes(columns: [&str; 3]) -> Vec<Curve> {
    let named = columns.into_iter().zip(["x", "y", "z"]).enumerate();
    named.map(|(axis, (column, name))| Curve::new(column, name, Color::at_place(axis))).collect()
}

/// Curves that stay visible beneath their reference once the two agree.
fn flown(columns: [&str; 3]) -> Vec<Curve> {
    axes(columns).into_iter().map(Curve::broad).collect()
}

/// What was asked of them.
fn desired(columns: [&str; 3]) -> Vec<Curve> {
    let named = columns.into_iter().zip(["x asked", "y asked", "z asked"]).enumerate();
    named.map(|(axis, (column, name))| Curve::new(column, name, Color::at_place(axis)).dashed()).collect()
}

fn ink(value: f64, label: &str) -> Bound {
    Bound { value, label: label.to_owned(), color: Color::Ink, always: label != LIMIT_LABEL }
}

fn interval(Interval { min: least, max: greatest }: Interval, label: &str, color: Color) -> Vec<Bound> {
    [least, greatest].map(|value| Bound { value, label: label.to_owned(), color, always: true }).into()
}

/// A level on each side of zero for each axis; equal levels are one.
fn both(levels: [f64; 3], label: &str) -> Vec<Bound> {
    let sides = |level: f64, named: String, color| {
        [level, -level].map(|value| Bound { value, label: named.clone(), color, always: label != LIMIT_LABEL })
    };
    if levels.iter().all(|level| *level == levels[0]) {
        return sides(levels[0], format!("each, {label}"), Color::Ink).into();
    }
    let named = levels.into_iter().zip(["x", "y", "z"]).enumerate();
    named.flat_map(|(axis, (level, name))| sides(level, format!("{name}, {label}"), Color::at_place(axis))).collect()
}
