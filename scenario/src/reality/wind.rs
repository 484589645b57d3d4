//! `[wind]`: how the air moves. World frame, z up; where the air goes to, not where it comes from.
//!
//! ```toml
//! [wind]
//! steady = [3.0, 0.0, 0.0]                                       # m/s; left out: none
//! gust = { kind = "step", start = 5.0, velocity = [5.0, 0.0, 0.0] }
//! turbulence = { wind_at_20_feet = 5.0, altitude = 10.0, seed = 1 }
//! ```
//!
//! A gust is added to the steady wind from `start` (s) on:
//! - `"step"`: all of `velocity` (m/s) at once and for good;
//! - `"one-cosine"`: rises to it within `duration` (s) and stays, MIL-F-8785C's discrete gust;
//! - `"pulse"`: rises to it and falls back to nothing within `duration`, the shape of CS-25.341.
//!
//! Turbulence is MIL-F-8785C's in Dryden's form for low altitudes, at one `altitude` (m above ground, 3.048 to 304.8)
//! and for the wind at 20 feet (m/s) that states its strength. The pattern of the air drifts past the vehicle with
//! `airspeed` (m/s; left out: the steady wind's, which is what a hovering vehicle feels).

use super::numbers::{Allowed, seed};
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

/// Reads `[wind]`.
///
/// # Errors
/// Names the field that is refused.
pub fn read(root: &Section) -> Result<Option<Wind>, FieldError> {
    let Some(section) = root.optional_section("wind")? else {
        return Ok(None);
    };
    section.allow(&["steady", "gust", "turbulence"])?;
    let steady = speed().vector_or_zero(&section, "steady")?;
    let gust = section.optional_section("gust")?.map(|gust| read_gust(&gust)).transpose()?;
    let turbulence =
        section.optional_section("turbulence")?.map(|turbulence| read_turbulence(&turbulence, &steady)).transpose()?;
    Ok(Some(Wind { steady, gust, turbulence }))
}

/// Winds that a vehicle may be simulated in.
fn speed() -> Allowed {
    Allowed::new(-100.0..=100.0, "m/s")
}

fn read_gust(section: &Section) -> Result<Gust, FieldError> {
    section.allow(&["kind", "start", "velocity", "duration"])?;
    let duration = || Allowed::new(1e-3..=1e4, "s").number(section, "duration");
    let shape = match section.text("kind")? {
        "step" if section.has("duration") => {
            let problem = "a step has none: leave it out, or take kind = \"one-cosine\" or \"pulse\"";
            return Err(FieldError::new(section.path_of("duration"), problem));
        }
        "step" => Shape::Step,
        "one-cosine" => Shape::OneCosine(duration()?),
        "pulse" => Shape::Pulse(duration()?),
        other => {
            let problem = format!("must be \"step\", \"one-cosine\" or \"pulse\", found {other:?}");
            return Err(FieldError::new(section.path_of("kind"), problem));
        }
    };
    section.vector("velocity")?;
    Ok(Gust {
        shape,
        start: Allowed::new(0.0..=1e7, "s").number(section, "start")?,
        velocity: speed().vector_or_zero(section, "velocity")?,
    })
}

fn read_turbulence(section: &Section, steady: &Vector3<f64>) -> Result<Turbulence, FieldError> {
    section.allow(&["wind_at_20_feet", "altitude", "airspeed", "seed"])?;
    let allowed = Allowed::new(0.01..=100.0, "m/s");
    let airspeed = if section.has("airspeed") {
        allowed.number(section, "airspeed")?
    } else if steady.norm() >= 0.01 {
        steady.norm()
    } else {
        let problem = "missing, must be how fast the air drifts past the vehicle, m/s, where wind.steady does not say";
        return Err(FieldError::new(section.path_of("airspeed"), problem));
    };
    Ok(Turbulence {
        wind_at_20_feet: Allowed::new(0.0..=100.0, "m/s").number(section, "wind_at_20_feet")?,
        altitude: Allowed::new(3.048..=304.8, "m").number(section, "altitude")?,
        airspeed,
        seed: seed(section)?,
    })
}
