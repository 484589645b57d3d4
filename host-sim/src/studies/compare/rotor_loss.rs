//! A rotor that fails: ours beside others, from the failure to the ground.
//!
//! Rotor 1 keeps 0, 30, 50 or 70 % of its thrust, 10 m above the ground:
//!
//! | scene | fails | task |
//! |---|---|---|
//! | hover | after 4 s | hover |
//! | circle | after 5 s, in motion | a circle of 1 m at 0.25 Hz |
//! | wind | after 4 s | hover in 5 m/s of wind |
//! | upside down | after 0.15 s, as it turns | hover, from roll -179 degrees, yaw 100 degrees off, at rest |
//!
//! The reference goes on for 3 s, stops on the circle, and goes down at 0.6 m/s into the ground. Nobody tells a law of
//! the failure. A flight ends where it first touches the ground; one that does not, or that comes to no number, never
//! lands. Drag is as in [`super::scenes`].

use super::rows::FigureRow;
use super::scenes::Scene;
use crate::flight::law_on_vehicle::LawOnVehicle;
use crate::flight::tasks::{hover, in_still_air, recovery};
use controller_core::error::ParameterError;
use controller_core::reference::knot::Knot;
use controller_core::reference::spline::{self, Stage};
use controller_core::reference::waypoints::Waypoint;
use nalgebra::{Vector2, Vector3};
use scenario::Scenario;
use scenario::reality::failure::Failure;
use scenario::reality::ground::Ground;
use scenario::reality::wind::Wind;
use scenario::rotor_loss::{PLACE_HELD_DISTANCE_M, SOFT_LANDING_SPEED_M_PER_S};
use scenario::trajectory::stretch;
use std::f64::consts::TAU;
use std::sync::Arc;

/// The shares of its thrust that the rotor keeps.
const SHARES_LEFT: [f64; 4] = [0.0, 0.3, 0.5, 0.7];
/// Of the hover above the ground.
const HOVER_HEIGHT_M: f64 = 10.0;
/// How long the reference goes on after the failure, how fast it then goes down, and how far below the ground.
const AFTER_FAILURE_S: f64 = 3.0;
const DESCENT_SPEED_M_PER_S: f64 = 0.6;
const BELOW_GROUND_M: f64 = 10.0;
/// Between two points of the way down and of the circle.
const DESCENT_POINT_PERIOD_S: f64 = 1.0;
const CIRCLE_POINT_PERIOD_S: f64 = 0.5;
/// The circle's radius, and its rate.
const CIRCLE_RADIUS_M: f64 = 1.0;
const CIRCLE_RATE_RAD_PER_S: f64 = 0.25 * TAU;
/// How long both motions take to reach their speed, and the circle to stop.
const SPEED_UP_S: f64 = 2.0;
/// The wind of that scene.
const WIND_SPEED_M_PER_S: f64 = 5.0;

/// How much height a vehicle that lands well may lose.
const HEIGHT_LOST_MAX_M: f64 = 5.0;

/// One law in one scene, from the failure on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Landing {
    /// How far below its reference it came before that goes down, m.
    pub height_lost: f64,
    /// How far beside it it came until it landed, m.
    pub farthest: f64,
    /// How far beside it it touched the ground, m, and how fast it then fell, m/s; infinite where it did not.
    pub away: f64,
    /// Likewise.
    pub speed: f64,
}

impl Landing {
    /// Whether it lands well.
    pub fn is_soft(&self) -> bool {
        self.speed < SOFT_LANDING_SPEED_M_PER_S
            && self.away < PLACE_HELD_DISTANCE_M
            && self.height_lost < HEIGHT_LOST_MAX_M
    }
}

/// All scenes of a vehicle with rotors, in the order of the table.
pub fn all(file: &Scenario) -> Result<Vec<Scene>, ParameterError> {
    let still_air = in_still_air(file);
    let resting = hover(&still_air, Vector3::zeros(), 0.0)?;
    let mut windy = resting.clone();
    windy.reality.wind = Some(Wind { steady: Vector3::x() * WIND_SPEED_M_PER_S, ..Wind::default() });
    let mut circling = resting.clone();
    circling.initial.position.x = CIRCLE_RADIUS_M;
    let tasks = [
        ("hover", ["hover, 0 %", "hover, 30 %", "hover, 50 %", "hover, 70 %"], resting, 4.0),
        ("1 m circle at 0.25 Hz", ["circle, 0 %", "circle, 30 %", "circle, 50 %", "circle, 70 %"], circling, 5.0),
        ("hover in 5 m/s of wind", ["wind, 0 %", "wind, 30 %", "wind, 50 %", "wind, 70 %"], windy, 4.0),
        (
            "hover, from upside down",
            ["upside down, 0 %", "upside down, 30 %", "upside down, 50 %", "upside down, 70 %"],
            recovery(&still_air, 0.0)?,
            0.15,
        ),
    ];
    let mut scenes = Vec::new();
    for (task, names, scenario, time) in tasks {
        for (name, thrust_left) in names.into_iter().zip(SHARES_LEFT) {
            let failing = failing(&scenario, Failure { rotor: 0, time, thrust_left })?;
            scenes.push(Scene { name, task, scenario: failing });
        }
    }
    Ok(scenes)
}

/// `scenario` with this failure, and a reference that goes down after it.
fn failing(scenario: &Scenario, failure: Failure) -> Result<Scenario, ParameterError> {
    let mut failing = scenario.clone();
    let from = failing.initial.position.xy();
    let mut points = if from == Vector2::zeros() {
        vec![(0.0, from), (failure.time + AFTER_FAILURE_S, from)]
    } else {
        circle(failure.time + AFTER_FAILURE_S)
    };
    let (begin, place) = points.pop().unwrap_or((0.0, from));
    let mut knots: Vec<Knot> = Vec::new();
    let down = (0..)
        .map(|number| f64::from(number) * DESCENT_POINT_PERIOD_S)
        .map(|time| (time, DESCENT_SPEED_M_PER_S * moved(time)));
    let down = down.take_while(|(_, depth)| *depth <= HOVER_HEIGHT_M + BELOW_GROUND_M);
    let up_there = points.into_iter().map(|(time, across)| (time, across.push(0.0)));
    for (time, position) in up_there.chain(down.map(|(time, depth)| (begin + time, place.push(-depth)))) {
        let point = Waypoint { time, position: position.into(), heading: 0.0 };
        knots.push(point.knot(knots.last(), ["reference.time", "reference.position", "reference.heading"])?);
    }
    let mut stages = vec![Stage::EMPTY; knots.len()];
    spline::solve(&mut knots, &mut stages);
    failing.timing = failing.timing.lasting(knots.last().map_or(0.0, |knot| knot.time_us as f64 * 1e-6));
    if let Some(path) = stretch::path(&knots)? {
        failing.trajectory = Arc::new(path);
    }
    failing.reality.failure = Some(failure);
    failing.reality.ground = Some(Ground { height: -HOVER_HEIGHT_M });
    Ok(failing)
}

/// Points of the circle, s and m, from rest to where it rests again: it begins to stop at `end`, s.
fn circle(end: f64) -> Vec<(f64, Vector2<f64>)> {
    let angle = |time: f64| CIRCLE_RATE_RAD_PER_S * (moved(time) - 0.5 * (time - end).max(0.0).powi(2) / SPEED_UP_S);
    let place = |time: f64| Vector2::new(angle(time).cos(), angle(time).sin()) * CIRCLE_RADIUS_M;
    let last = end + SPEED_UP_S;
    let count = (last / CIRCLE_POINT_PERIOD_S).round() as u32;
    let times = (0..=count).map(|number| f64::from(number) * CIRCLE_POINT_PERIOD_S);
    // Twice the same place: it rests there.
    times.map(|time| (time, place(time))).chain([(last + CIRCLE_POINT_PERIOD_S, place(last))]).collect()
}

/// How far, over its speed, something has moved that takes [`SPEED_UP_S`] to reach that, s.
fn moved(time: f64) -> f64 {
    let started = time.min(SPEED_UP_S);
    time - started + 0.5 * started * started / SPEED_UP_S
}

/// Flies `scene`; none if it comes to no number.
pub fn fly_loss_scene(law: &LawOnVehicle, scene: &Scene) -> Option<Landing> {
    let scenario = &scene.scenario;
    let failure = scenario.reality.failure?;
    let mut flight = law.flight(scenario).ok()?;
    let mut landing = Landing { height_lost: 0.0, farthest: 0.0, away: f64::INFINITY, speed: f64::INFINITY };
    for _ in 0..scenario.timing.ticks {
        let tick = flight.brief_tick().ok()?;
        if tick.time_us as f64 * 1e-6 < failure.time {
            continue;
        }
        let touchdown = flight.take_touchdown();
        let place = touchdown.map_or(tick.state.position, |touchdown| touchdown.position);
        let off = place - tick.reference.position.map(f64::from);
        landing.farthest = landing.farthest.max(off.xy().norm());
        if tick.time_us as f64 * 1e-6 < failure.time + AFTER_FAILURE_S {
            landing.height_lost = landing.height_lost.max(-off.z);
        }
        if let Some(touchdown) = touchdown {
            return Some(Landing { away: off.xy().norm(), speed: touchdown.speed, ..landing });
        }
    }
    Some(landing)
}

/// The rows of each law's figures in each of the `scenes`, in the laws' order.
pub fn rows(scenes: &[(&'static str, Vec<Option<Landing>>)]) -> Vec<FigureRow> {
    type Get = fn(&Landing) -> f64;
    const LOSS_FIGURES: [(&str, &str, Get); 4] = [
        ("height lost", "m", |landing| landing.height_lost),
        ("farthest away across", "m", |landing| landing.farthest),
        ("lands away from its place", "m", |landing| landing.away),
        ("lands with", "m/s", |landing| landing.speed),
    ];
    let of_scene = |(scene, landings): &(&'static str, Vec<Option<Landing>>)| {
        let values = |get: Get| landings.iter().map(|one| one.as_ref().map_or(f64::INFINITY, get)).collect();
        let row =
            |(figure, unit, get)| FigureRow { scene, figure, unit, values: values(get), grain: 0.01, limit: None };
        LOSS_FIGURES.map(row)
    };
    scenes.iter().flat_map(of_scene).collect()
}

#[cfg(test)]
mod tests;
