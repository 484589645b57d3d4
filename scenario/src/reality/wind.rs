//! `[wind]`: how the air moves. World frame, z up; where the air goes to, not where it comes from.
//!
//! A gust is added to the steady wind from `start` (s) on:
//! - `"step"`: all of `velocity` (m/s) at once and for good;
//! - `"one-cosine"`: rises to it within `duration` (s) and stays, MIL-F-8785C's discrete gust;
//! - `"pulse"`: rises to it and falls back to nothing within `duration`, the shape of CS-25.341.
//!
//! Turbulence is MIL-F-8785C's in Dryden's form for low altitudes, at one `altitude` (m above ground, 3.048 to 304.8)
//! and for the wind at 20 feet (m/s) that states its strength. The pattern of the air drifts past the vehicle with
//! `airspeed` (m/s; left out: the steady wind's, which is what a hovering vehicle feels).

use crate::key::{Bounds, Key, Layout, SEED, Values, read_seed};
use crate::section::{FieldError, Section};
use nalgebra::Vector3;

/// How the air moves.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Wind {
    /// m/s, world.
    pub steady: Vector3<f64>,
    /// A gust from a time on.
    pub gust: Option<Gust>,
    /// Turbulence, throughout.
    pub turbulence: Option<Turbulence>,
}

/// A gust.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gust {
    /// Its course in time.
    pub shape: Shape,
    /// When it begins, s.
    pub start: f64,
    /// Its greatest velocity, m/s, world.
    pub velocity: Vector3<f64>,
}

/// The course of a gust; durations in s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// At once, for good.
    Step,
    /// Rises along half a cosine, for good.
    OneCosine(f64),
    /// Rises and falls along a whole cosine.
    Pulse(f64),
}

/// Dryden turbulence at a low altitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turbulence {
    /// W_20, m/s.
    pub wind_at_20_feet: f64,
    /// h, m above ground.
    pub altitude: f64,
    /// V, m/s.
    pub airspeed: f64,
    /// Seed of the random generator.
    pub seed: u64,
}

/// Winds that a vehicle may be simulated in.
const SPEED: Bounds = Bounds::between(-100.0, 100.0, "m/s");

/// The keys of `[wind]`.
pub const LAYOUT: Layout = Layout {
    name: "wind",
    about: "How the air moves, world frame, z up; where it goes to. Needs [drag].",
    keys: &[Key::vector("steady", SPEED, "The steady wind.").or(0.0), Key::table(&GUST), Key::table(&TURBULENCE)],
};

const GUST: Layout = Layout {
    name: "gust",
    about: "A gust, added to the steady wind from a time on.",
    keys: &[
        Key::new("kind", Values::Choice(&["step", "one-cosine", "pulse"]), "At once; rising; rising and falling."),
        Key::number("start", Bounds::between(0.0, 1e7, "s"), "When it begins."),
        Key::vector("velocity", SPEED, "The greatest one."),
        Key::number("duration", Bounds::between(1e-3, 1e4, "s"), "Of the rise, or of the pulse; a step has none.")
            .optional(),
    ],
};

const TURBULENCE: Layout = Layout {
    name: "turbulence",
    about: "MIL-F-8785C's, in Dryden's form for low altitudes.",
    keys: &[
        Key::number("wind_at_20_feet", Bounds::between(0.0, 100.0, "m/s"), "States its strength."),
        Key::number("altitude", Bounds::between(3.048, 304.8, "m"), "Above ground."),
        Key::number("airspeed", AIRSPEED, "Past the vehicle; left out: the steady wind's.").optional(),
        SEED,
    ],
};

const AIRSPEED_MIN_M_PER_S: f64 = 0.01;
const AIRSPEED: Bounds = Bounds::between(AIRSPEED_MIN_M_PER_S, 100.0, "m/s");

/// Reads `[wind]`.
///
/// # Errors
/// Names the field that is refused.
pub fn read(root: &Section) -> Result<Option<Wind>, FieldError> {
    let Some(section) = root.open(&LAYOUT)? else {
        return Ok(None);
    };
    let steady = section.vector("steady")?;
    let gust = section.open(&GUST)?.map(|gust| read_gust(&gust)).transpose()?;
    let turbulence = section.open(&TURBULENCE)?.map(|turbulence| read_turbulence(&turbulence, &steady)).transpose()?;
    Ok(Some(Wind { steady, gust, turbulence }))
}

fn read_gust(section: &Section) -> Result<Gust, FieldError> {
    let shape = match section.choice("kind")? {
        "step" if section.has("duration") => {
            let problem = "a step has none: leave it out, or take kind = \"one-cosine\" or \"pulse\"";
            return Err(FieldError::new(section.path_of("duration"), problem));
        }
        "step" => Shape::Step,
        "one-cosine" => Shape::OneCosine(section.number("duration")?),
        _ => Shape::Pulse(section.number("duration")?),
    };
    Ok(Gust { shape, start: section.number("start")?, velocity: section.vector("velocity")? })
}

fn read_turbulence(section: &Section, steady: &Vector3<f64>) -> Result<Turbulence, FieldError> {
    let airspeed = match section.optional_number("airspeed")? {
        Some(airspeed) => airspeed,
        None if steady.norm() >= AIRSPEED_MIN_M_PER_S => steady.norm(),
        None => {
            let problem =
                "missing, must be how fast the air drifts past the vehicle, m/s, where wind.steady does not say";
            return Err(FieldError::new(section.path_of("airspeed"), problem));
        }
    };
    Ok(Turbulence {
        wind_at_20_feet: section.number("wind_at_20_feet")?,
        altitude: section.number("altitude")?,
        airspeed,
        seed: read_seed(section)?,
    })
}
