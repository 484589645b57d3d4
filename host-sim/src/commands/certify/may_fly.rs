//! What a vehicle may fly: the fastest level circle of 3 m that certifies, and how much acceleration and jerk.
//!
//! Under the extended law a motion certifies if the judge of paths leaves nothing limited
//! ([`controller_core::certificate::path`]), under the paper's if the certificate holds for its bounds. On a circle of
//! radius r at the speed v the acceleration is v^2 / r, the jerk v^3 / r^2 and the snap v^4 / r^3. Full thrust holds
//! v^2 = r sqrt((T_max / m)^2 - g^2).

use crate::output::table::short;
use controller_core::certificate::Certificate;
use controller_core::certificate::path::{PathJudge, PathMotion};
use controller_core::configuration::Configuration;
use controller_core::reference::ReferenceBounds;
use scenario::Scenario;
use scenario::along::name;
use scenario::judge::judge;

/// Of the circle whose greatest speed is searched.
pub const CIRCLE_RADIUS_M: f64 = 3.0;

/// The greatest speed (m/s), acceleration (m/s^2) and jerk (m/s^3) that are searched.
const SEARCH_MAX: [f64; 3] = [100.0, 1_000.0, 10_000.0];
const HALVINGS_MAX: u32 = 40;

/// The fastest circle: its speed, m/s, and the row of which it takes most, if rows limit it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Circle {
    /// m/s.
    pub speed: f64,
    /// What limits it; none under the paper's law.
    pub limit: Option<&'static str>,
}

/// The fastest circle that certifies; none if not even hovering does.
#[must_use]
pub fn circle(scenario: &Scenario) -> Option<Circle> {
    let configuration = &scenario.configuration;
    let judge = judge::<f64>(configuration, scenario.force_kept);
    let certifies = |speed: f64| match &judge {
        Some(judge) => judge.shares(&turning(speed)).worst() < 1.0,
        None => holds(configuration, &bounds(speed)),
    };
    let sound = holds(configuration, &ReferenceBounds::REST);
    let speed = greatest(SEARCH_MAX[0], certifies).filter(|_| sound)?;
    Some(Circle { speed, limit: judge.map(|judge| name(judge.shares(&turning(speed)).row())) })
}

/// A circle's motion where it goes along y.
fn turning(speed: f64) -> PathMotion {
    let turn = speed / CIRCLE_RADIUS_M;
    PathMotion {
        velocity: [0.0, speed, 0.0],
        acceleration: [-speed * turn, 0.0, 0.0],
        jerk: [0.0, -speed * turn.powi(2), 0.0],
        snap: [speed * turn.powi(3), 0.0, 0.0],
        heading_rate: 0.0,
    }
}

fn bounds(speed: f64) -> ReferenceBounds {
    let turn = speed / CIRCLE_RADIUS_M;
    ReferenceBounds {
        horizontal_speed: speed as f32,
        horizontal_acceleration: (speed * turn) as f32,
        jerk: (speed * turn.powi(2)) as f32,
        snap: (speed * turn.powi(3)) as f32,
        ..ReferenceBounds::REST
    }
}

fn holds(configuration: &Configuration, bounds: &ReferenceBounds) -> bool {
    let configuration = configuration.with_bounds(*bounds);
    configuration
        .and_then(|configuration| Certificate::new(&configuration))
        .is_ok_and(|certificate| certificate.holds())
}

/// The greatest number that certifies, up to `most`; none if not even zero does.
fn greatest(most: f64, certifies: impl Fn(f64) -> bool) -> Option<f64> {
    let (mut holds, mut fails) = (0.0, most);
    for _ in 0..HALVINGS_MAX {
        let middle = 0.5 * (holds + fails);
        if certifies(middle) { holds = middle } else { fails = middle }
    }
    certifies(holds).then_some(holds)
}

/// The lines about acceleration and jerk, and last the one about the circle.
#[must_use]
pub fn lines(scenario: &Scenario) -> String {
    let configuration = &scenario.configuration;
    let gravity = f64::from(configuration.vehicle().gravity);
    let judge = judge::<f64>(configuration, scenario.force_kept);
    let beside = judge.as_ref().map_or(String::new(), |judge| straight(judge, scenario.force_kept));
    let Some(Circle { speed, limit }) = circle(scenario) else {
        return format!("{beside}{CIRCLE_RADIUS_M} m circle: none certifies, not even at rest\n");
    };
    let thrust = f64::from(configuration.limits().thrust_max);
    let rotors = configuration.rotors().map_or(f64::INFINITY, |rotors| f64::from(rotors.thrust_together().1));
    let held = thrust.min(rotors) / f64::from(configuration.vehicle().mass);
    let physical = (CIRCLE_RADIUS_M * (held * held - gravity * gravity).sqrt()).sqrt();
    let acceleration = speed * speed / CIRCLE_RADIUS_M;
    let limit = limit.map_or(String::new(), |limit| format!("; {limit} limits it"));
    format!(
        "{beside}{CIRCLE_RADIUS_M} m circle: {} m/s, {} m/s^2 ({:.2} g), {:.0} % of what all thrust holds{limit}\n",
        short(speed),
        short(acceleration),
        acceleration / gravity,
        100.0 * speed / physical,
    )
}

/// What certifies without turning.
fn straight(judge: &PathJudge, force_kept: f32) -> String {
    let rest =
        PathMotion { velocity: [0.0; 3], acceleration: [0.0; 3], jerk: [0.0; 3], snap: [0.0; 3], heading_rate: 0.0 };
    let across = |size: f64| [size, 0.0, 0.0];
    let accelerated = |size: f64| judge.shares(&PathMotion { acceleration: across(size), ..rest }).worst() < 1.0;
    let jerked = |size: f64| judge.shares(&PathMotion { jerk: across(size), ..rest }).worst() < 1.0;
    let found =
        [greatest(SEARCH_MAX[1], accelerated), greatest(SEARCH_MAX[2], jerked)].map(|found| found.unwrap_or(0.0));
    let [acceleration, jerk] = found.map(short);
    format!("a known path beside a force of {force_kept} m/s^2: {acceleration} m/s^2 across, from hover {jerk} m/s^3\n")
}

#[cfg(test)]
mod tests;
