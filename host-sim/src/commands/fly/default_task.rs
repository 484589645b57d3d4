//! What `fly` and `replay` fly of a file that holds a vehicle and no task, under the extended law.
//!
//! ```text
//! upside down in the middle of a circle -> recover -> catch up with the circle -> a gust
//! ```
//!
//! A file with `[initial]` or `[reference]` is flown as it is; so is one under the paper's law, whose certificate would
//! be about this circle, one whose vehicle may fly no circle, and one whose `duration` is too short for it. What is
//! added is TOML below the file's text, so that the report shows it, and it can be copied and changed.

use crate::commands::certify::may_fly::{CIRCLE_RADIUS_M, circle};
use crate::studies::campaign::draw::DRAG_PER_MASS_PER_S;
use scenario::campaign::default_wind;
use scenario::{Scenario, ScenarioError};
use std::f64::consts::TAU;
use toml_edit::{DocumentMut, value};

/// Of the greatest speed at which the circle certifies.
const SPEED_SHARE: f64 = 0.6;
/// The greatest speed: faster is hard to watch.
const SPEED_MAX_M_PER_S: f64 = 4.0;
/// Of the wind that a campaign blows by default.
const GUST_SHARE: f64 = 0.6;

/// Where the flight begins, and the circle's height.
const START_HEIGHT_M: f64 = 10.0;
/// Until the vehicle has caught up with the circle, at the latest.
const GUST_START_S: f64 = 8.0;
/// How long the gust takes to rise and fall.
const GUST_DURATION_S: f64 = 3.0;
/// Between the gust's end and the flight's, at least.
const CALM_AFTER_GUST_S: f64 = 5.0;
/// The longest flight; a circle that takes longer is not closed.
const FLIGHT_MAX_S: f64 = 60.0;

/// A flight, and the text of the file that would describe it.
pub struct FlownFile {
    /// The flight.
    pub scenario: Scenario,
    /// The file's text, with what was added.
    pub text: String,
    /// What was added, in a sentence; none where the file is flown as it is.
    pub added: Option<String>,
}

/// The flight of a file with this `text`, which errors call `file`.
///
/// # Errors
/// [`ScenarioError`], as of the file itself.
pub fn with_default_task(text: String, file: &str) -> Result<FlownFile, ScenarioError> {
    let scenario = Scenario::parse(&text, file)?;
    let shown = with_task(&text, &scenario).and_then(|(text, added)| {
        let scenario = Scenario::parse(&text, file).ok()?;
        Some(FlownFile { scenario, text, added: Some(added) })
    });
    Ok(shown.unwrap_or(FlownFile { scenario, text, added: None }))
}

/// The text with a task, and what that is; none for a file that has one.
fn with_task(text: &str, scenario: &Scenario) -> Option<(String, String)> {
    let mut document: DocumentMut = text.strip_prefix('\u{feff}').unwrap_or(text).parse().ok()?;
    let has = |section: &str| document.contains_key(section);
    if has("initial") || has("reference") || scenario.configuration.paper().is_some() {
        return None;
    }
    let speed = (SPEED_SHARE * circle(scenario)?.speed).min(SPEED_MAX_M_PER_S);
    // So that nobody reads a dozen digits.
    let turning = (1e3 * speed / CIRCLE_RADIUS_M).round() * 1e-3;
    if turning <= 0.0 {
        return None;
    }
    let height = START_HEIGHT_M + scenario.reality.ground.map_or(0.0, |ground| ground.height);
    let lap = TAU / turning;
    let duration = (GUST_START_S + lap.max(GUST_DURATION_S + CALM_AFTER_GUST_S)).ceil().min(FLIGHT_MAX_S);
    let mut task = format!(
        "
# NOT IN THE FILE: a flight to look at, added where a file has neither [initial] nor [reference].
[initial]
position = [0.0, 0.0, {height:?}]           # m
euler_deg = [179.0, 0.0, 0.0]         # upside down

[reference]
kind = \"harmonic\"                     # a circle
center = [0.0, 0.0, {height:?}]             # m
amplitude = [{CIRCLE_RADIUS_M:?}, {CIRCLE_RADIUS_M:?}, 0.0]           # m
frequency = [{turning}, {turning}, 0.0]       # rad/s
phase = [0.0, -1.570796326794897, 0.0]
"
    );
    let mut said = format!("upside down, then a circle of {CIRCLE_RADIUS_M} m at {:.2} m/s", turning * CIRCLE_RADIUS_M);
    let gust = (10.0 * GUST_SHARE * default_wind(&scenario.configuration)).round() * 0.1;
    if gust > 0.0 && !["wind", "disturbance", "battery", "failure"].into_iter().any(has) {
        said += &format!(", a gust of {gust:.1} m/s at {GUST_START_S} s");
        // A section [drag] would change the constants of the law: without one the gust is the force that it makes.
        task += &if has("drag") {
            format!(
                "\n[wind]\ngust = {{ kind = \"pulse\", start = {GUST_START_S:?}, duration = {GUST_DURATION_S:?}, \
                 velocity = [{gust:.1}, 0.0, 0.0] }}  # s, m/s\n"
            )
        } else {
            let push = DRAG_PER_MASS_PER_S * gust;
            format!(
                "\n[disturbance]\nacceleration = [{push:.2}, 0.0, 0.0]     # m/s^2: wind of {gust:.1} m/s\nstart = {GUST_START_S:?}                           # s\n"
            )
        };
    }
    if !has("duration") {
        document["duration"] = value(duration);
    } else if scenario.timing.duration() < duration {
        return None;
    }
    Some((format!("{document}{task}"), said))
}

#[cfg(test)]
mod tests;
