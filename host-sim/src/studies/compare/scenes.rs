//! The circumstances that all laws are compared in, made from one scenario.
//!
//! | scene | task | new in it |
//! |---|---|---|
//! | own | the file's own flight | nothing |
//! | step | hover 1 m from where it is | |
//! | far step | hover 10 m away, across and up | position errors beyond the linear range |
//! | upside down | hover where it starts, roll -179 degrees, yaw 100 degrees off | |
//! | gust | hover; 5 m/s of wind begin after a second | a force within our law's promise |
//! | storm | hover; 12 m/s of wind begin after a second | force beyond it |
//! | noise | hover; gyro 0.01 rad/s, pose 2 mm and 0.2 degrees, all 20 ms late | |
//! | weak rotors | 1 m step with rotors that deliver 60 % | a thrust scale beyond our law's promise |
//! | heavy | upside down with 1.6 times the mass | likewise, and less thrust to spare |
//!
//! Drag is the file's, or 0.5 1/s. The file's wind, disturbances and failures are left out, but for its own flight.

use crate::flight::tasks::{hover, in_still_air, in_wind, of_mass_and_thrust, recovery};
use crate::studies::tune::trials::noise;
use controller_core::error::ParameterError;
use scenario::Scenario;

#[derive(Clone)]
pub struct Scene {
    /// Its name in tables.
    pub name: &'static str,
    /// The task, in a sentence.
    pub task: &'static str,
    /// The scenario to fly.
    pub scenario: Scenario,
}

/// All scenes, in the order of the table.
pub fn all(file: &Scenario) -> Result<Vec<Scene>, ParameterError> {
    let still_air = in_still_air(file);
    let at = |position: [f64; 3], duration: f64| hover(&still_air, position.into(), duration);
    let windy = |speed: f64, duration: f64| Ok::<_, ParameterError>(in_wind(&at([0.0; 3], duration)?, speed));
    let mut noisy = at([0.0; 3], 10.0)?;
    noisy.reality.sensors = Some(noise(file.timing.period()));
    let upside_down = recovery(&still_air, 20.0)?;
    let scenes = [
        ("own", "the file's own flight", file.clone()),
        ("step", "hover 1 m from where it is", at([-1.0, 0.0, 0.0], 12.0)?),
        ("far step", "hover 10 m away, across and up", at([-6.0, -6.0, -5.3], 30.0)?),
        ("upside down", "hover where it starts: roll −179°, yaw 100° off", upside_down.clone()),
        ("gust", "hover; 5 m/s of wind begin after a second", windy(5.0, 12.0)?),
        ("storm", "hover; 12 m/s of wind begin after a second", windy(12.0, 20.0)?),
        ("noise", "hover; noise of gyro and poses, all 20 ms late", noisy),
        (
            "weak rotors",
            "1 m step with rotors that deliver 60 %",
            of_mass_and_thrust(&at([-1.0, 0.0, 0.0], 20.0)?, 1.0, 0.6),
        ),
        ("heavy", "upside down with 1.6 times the mass", of_mass_and_thrust(&upside_down, 1.6, 1.0)),
    ];
    Ok(scenes.map(|(name, task, scenario)| Scene { name, task, scenario }).into())
}
