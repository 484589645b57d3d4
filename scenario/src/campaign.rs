//! `[campaign]`: how far the circumstances of a campaign's flights may differ. Only `host-sim campaign` reads it.
//!
//! Each number is the greatest value that is drawn: evenly from zero up, or within a ball of that radius, or as much on
//! either side; `rotor_failures` is a share of the flights. Every key may be left out. The defaults of `duration` and
//! `wind` ([`default_wind`]) depend on the law.

use crate::body::ROTATION_PER_STEP_MAX_RAD;
use crate::key::{Bounds, Key, Layout, SEED, Values, read_seed};
use crate::section::{FieldError, Section};
use crate::timing::Timing;
use controller_core::configuration::{Configuration, LawParameters};
use toml::Table;

/// A campaign as the file describes it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Campaign {
    /// How many flights.
    pub flights: u64,
    /// Seed of all draws.
    pub seed: u64,
    /// The ranges of the draws.
    pub ranges: Ranges,
}

/// How far circumstances may differ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ranges {
    /// Of each flight, s.
    pub duration: f64,
    /// The vehicle's task.
    pub reference: Task,
    /// Whether attitudes are drawn, of all attitudes alike; otherwise flights start in the file's.
    pub attitude: bool,
    /// Greatest distance from the reference's first point, m.
    pub offset: f64,
    /// m/s.
    pub velocity: f64,
    /// About body x and y, rad/s.
    pub rate: f64,
    /// About body z, rad/s.
    pub yaw_rate: f64,
    /// Steady, level, m/s.
    pub wind: f64,
    /// Level, begins within the first half of the flight, m/s.
    pub gust: f64,
    /// Wind at 20 feet, m/s.
    pub turbulence: f64,
    /// The sensors' errors.
    pub noise: NoiseRanges,
    /// The model's errors.
    pub model: ModelRanges,
    /// A rotor's failure.
    pub failure: FailureRanges,
}

/// A vehicle's task.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Task {
    /// The file's reference.
    File,
    /// To hover at the origin.
    Hover,
    /// To hover in flights of even number, the file's reference in the others.
    InTurn,
}

/// Greatest standard deviations of the measurements, and how late it may come.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct NoiseRanges {
    /// rad/s.
    pub gyro: f64,
    /// m.
    pub position: f64,
    /// rad.
    pub attitude: f64,
    /// s.
    pub delay: f64,
}

/// Greatest errors of the model, as shares of its values but for the centre of mass.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ModelRanges {
    /// Part of the mass.
    pub mass: f64,
    /// Part of all moments of inertia.
    pub inertia: f64,
    /// m, body.
    pub centre_of_mass: f64,
    /// Part of the thrust of all rotors together.
    pub thrust_scale: f64,
    /// Part of the thrust of each rotor.
    pub rotor_scales: f64,
}

/// How often one rotor fails, and what it has left then.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FailureRanges {
    /// Share of the flights in which one does.
    pub flights: f64,
    /// Least and greatest share of its commanded thrust that it delivers from then on.
    pub thrust_left: [f64; 2],
}

impl FailureRanges {
    /// None fails.
    pub const DEFAULT: Self = Self { flights: 0.0, thrust_left: [0.0, 0.7] };
}

/// The greatest body rate that the plant can follow, rad/s.
fn angular_velocity_max(timing: &Timing) -> f64 {
    ROTATION_PER_STEP_MAX_RAD / timing.step()
}

/// The default wind, m/s: 5, or less where the estimate of forces
/// cannot hold against it. A wind of 1 m/s pushes with about 0.5 m/s^2, and four fifths of the estimate's level are
/// taken. The paper's law, which estimates nothing and gives way to every constant force, gets none.
#[must_use]
pub fn default_wind(configuration: &Configuration) -> f64 {
    const WIND_MAX_M_PER_S: f64 = 5.0;
    const WIND_PER_FORCE_LEVEL_S: f64 = 0.8 / 0.5;
    match configuration.law() {
        LawParameters::Paper(_) => 0.0,
        LawParameters::Extended(law) => {
            (WIND_PER_FORCE_LEVEL_S * f64::from(law.parameters.force_across)).min(WIND_MAX_M_PER_S)
        }
    }
}

const DURATION: Bounds = Bounds::between(DURATION_MIN_S, 1e5, "s");
const ANGULAR_RATE: Bounds = Bounds::not_negative("rad/s").checked_later();
const WIND_SPEED: Bounds = Bounds::between(0.0, 100.0, "m/s");
const SHARE: Bounds = Bounds::between(0.0, 0.9, "");

/// The most flights of a campaign.
pub const FLIGHTS_MAX: f64 = 1e8;

/// In less no flight has time to miss its reference, or to come back to it.
const DURATION_MIN_S: f64 = 1.0;

/// The keys of `[campaign]`.
pub const LAYOUT: Layout = Layout {
    name: "campaign",
    about: "How far the circumstances of the flights of `host-sim campaign` may differ: each number is the greatest \
            value that is drawn.",
    keys: &[
        Key::new("flights", Values::Whole(Bounds::between(1.0, FLIGHTS_MAX, "")), "How many.").or(1000.0),
        SEED,
        Key::number("duration", DURATION, "Of each; left out: 60, under the paper's law 180.").optional(),
        Key::choice("reference", &["in-turn", "file", "hover"], "Left out: \"hover\" and \"file\" in order."),
        Key::choice("attitude", &["uniform", "file"], "Left out: of all alike; or that of [initial]."),
        Key::number("offset", Bounds::between(0.0, 1e4, "m"), "From the reference's first point.").or(10.0),
        Key::number("velocity", Bounds::between(0.0, 1e3, "m/s"), "In any direction.").or(5.0),
        Key::number("rate", ANGULAR_RATE, "About body x and y; left out: 15, or what plant.step allows.").optional(),
        Key::number("yaw_rate", ANGULAR_RATE, "About body z; left out: 6, or what plant.step allows.").optional(),
        Key::number("wind", WIND_SPEED, "Steady, level; left out: what the law bears, at most 5.").optional(),
        Key::number("gust", WIND_SPEED, "Level, a step within the first half of the flight.").or(0.0),
        Key::number("turbulence", WIND_SPEED, "Wind at 20 feet.").or(0.0),
        Key::number("gyro_noise", Bounds::between(0.0, 10.0, "rad/s"), "Standard deviation.").or(0.01),
        Key::number("position_noise", Bounds::between(0.0, 100.0, "m"), "Standard deviation.").or(2e-3),
        Key::number("attitude_noise_deg", Bounds::between(0.0, 30.0, "degrees"), "Standard deviation.").or(0.2),
        Key::number("pose_delay", Bounds::between(0.0, 1.0, "s"), "Of all that is measured.").or(0.0),
        Key::number("mass", SHARE, "Share of vehicle.mass, more or less.").or(0.0),
        Key::number("inertia", SHARE, "Share of vehicle.inertia, more or less.").or(0.0),
        Key::number("centre_of_mass", Bounds::between(0.0, 10.0, "m"), "Body.").or(0.0),
        Key::number("thrust_scale", SHARE, "Share of all rotors' thrust, more or less.").or(0.0),
        Key::number("rotor_scales", SHARE, "Share of each rotor's thrust, more or less.").or(0.0),
        Key::number("rotor_failures", Bounds::SHARE, "Share of the flights in which a rotor fails.").or(0.0),
        Key::new("thrust_left", Values::Range(Bounds::SHARE), "Of such a rotor; left out: [0, 0.7].").optional(),
    ],
};

/// The keys that a file with `[sensors]` may not have.
const NOISE_KEYS: [&str; 4] = ["gyro_noise", "position_noise", "attitude_noise_deg", "pose_delay"];

/// The keys that a file without `[rotors]` may not have.
const ROTOR_KEYS: [&str; 3] = ["rotor_scales", "rotor_failures", "thrust_left"];

/// Reads `[campaign]`; the defaults if it is missing.
///
/// # Errors
/// Names the field that is refused, or the section that it cannot stand beside.
pub fn read(root: &Section, timing: &Timing, configuration: &Configuration) -> Result<Campaign, FieldError> {
    let missing = Table::new();
    let section = match root.open(&LAYOUT)? {
        Some(section) => section,
        None => Section::root(&missing).with(&LAYOUT)?,
    };
    let measured = NOISE_KEYS.into_iter().find(|key| section.has(key));
    let source = ["sensors", "estimator"].into_iter().find(|other| root.has(other));
    if let (Some(key), Some(other)) = (measured, source) {
        let problem = format!("[{other}] says what is measured: leave that section or this key out");
        return Err(FieldError::new(section.path_of(key), problem));
    }
    let of_rotors = ROTOR_KEYS.into_iter().find(|key| section.has(key));
    if let (Some(key), None) = (of_rotors, configuration.rotors()) {
        let problem = "needs [rotors]: add that section or leave this key out";
        return Err(FieldError::new(section.path_of(key), problem));
    }
    if section.has("rotor_failures") && root.has("failure") {
        let problem = "[failure] says which rotor fails: leave that section or this key out";
        return Err(FieldError::new(section.path_of("rotor_failures"), problem));
    }
    let ranges = read_ranges(&section, timing, configuration)?;
    let flights = section.number("flights")?;
    if flights.fract() != 0.0 || !(1.0..=FLIGHTS_MAX).contains(&flights) {
        let problem = format!("must be a whole number from 1 to {FLIGHTS_MAX}, found {flights}");
        return Err(FieldError::new(section.path_of("flights"), problem));
    }
    Ok(Campaign { flights: flights as u64, seed: read_seed(&section)?, ranges })
}

fn read_ranges(section: &Section, timing: &Timing, configuration: &Configuration) -> Result<Ranges, FieldError> {
    let number = |key: &str| section.number(key);
    let rate_max = angular_velocity_max(timing);
    let rate = |key: &str, default: f64| {
        let rate = section.number_or(key, default.min(rate_max))?;
        Bounds::between(0.0, rate_max, "rad/s").check(section.path_of(key), rate)
    };
    let duration = if configuration.paper().is_some() { 180.0 } else { 60.0 };
    Ok(Ranges {
        duration: section.number_or("duration", duration)?,
        reference: read_choice(section, "reference", TASK_NAMES, Task::InTurn)?,
        attitude: read_choice(section, "attitude", [("uniform", true), ("file", false)], true)?,
        offset: number("offset")?,
        velocity: number("velocity")?,
        rate: rate("rate", 15.0)?,
        yaw_rate: rate("yaw_rate", 6.0)?,
        wind: section.number_or("wind", default_wind(configuration))?,
        gust: number("gust")?,
        turbulence: number("turbulence")?,
        noise: NoiseRanges {
            gyro: number("gyro_noise")?,
            position: number("position_noise")?,
            attitude: number("attitude_noise_deg")?.to_radians(),
            delay: number("pose_delay")?,
        },
        model: ModelRanges {
            mass: number("mass")?,
            inertia: number("inertia")?,
            centre_of_mass: number("centre_of_mass")?,
            thrust_scale: number("thrust_scale")?,
            rotor_scales: number("rotor_scales")?,
        },
        failure: FailureRanges {
            flights: number("rotor_failures")?,
            thrust_left: read_thrust_left(section, FailureRanges::DEFAULT.thrust_left)?,
        },
    })
}

/// The least and the greatest share of its thrust that a failing rotor has left.
fn read_thrust_left(section: &Section, default: [f64; 2]) -> Result<[f64; 2], FieldError> {
    const REQUIREMENT: &str = "[least, greatest], 0 <= least <= greatest < 1";
    if !section.has("thrust_left") {
        return Ok(default);
    }
    section.range("thrust_left", REQUIREMENT, |least, greatest| 0.0 <= least && least <= greatest && greatest < 1.0)
}

const TASK_NAMES: [(&str, Task); 3] = [("in-turn", Task::InTurn), ("file", Task::File), ("hover", Task::Hover)];

fn read_choice<T: Copy, const N: usize>(
    section: &Section,
    key: &str,
    choices: [(&str, T); N],
    default: T,
) -> Result<T, FieldError> {
    if !section.has(key) {
        return Ok(default);
    }
    let found = section.text(key)?;
    choices.iter().find(|(name, _)| *name == found).map(|(_, choice)| *choice).ok_or_else(|| {
        let names = choices.map(|(name, _)| format!("\"{name}\"")).join(", ");
        FieldError::new(section.path_of(key), format!("must be one of {names}, found {found:?}"))
    })
}

#[cfg(test)]
mod tests;
