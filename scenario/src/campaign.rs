//! `[campaign]`: how far the circumstances of a campaign's flights may differ. Only `host-sim campaign` reads it.
//!
//! ```toml
//! [campaign]
//! flights = 1000                       # how many
//! seed = 0
//! duration = 60.0                      # s, each, 1 at least; 180 under the paper's law, which takes its time
//! reference = "in-turn"                # hover at the origin and the file's reference in turn; or "file", or "hover"
//! attitude = "uniform"                 # of all attitudes alike; or "file": that of [initial]
//! offset = 10.0                        # m, from the reference's first point
//! velocity = 5.0                       # m/s
//! rate = 15.0                          # rad/s, about body x and y
//! yaw_rate = 6.0                       # rad/s, about body z
//! wind = 5.0                           # m/s, steady, level, from any side
//! gust = 0.0                           # m/s, level, a step within the first half of the flight
//! turbulence = 0.0                     # m/s, wind at 20 feet
//! gyro_noise = 0.01                    # rad/s
//! position_noise = 0.002               # m
//! attitude_noise_deg = 0.2             # degrees
//! pose_delay = 0.0                     # s, of all that is measured
//! mass = 0.0                           # part of vehicle.mass, more or less
//! inertia = 0.0                        # part of vehicle.inertia, more or less
//! centre_of_mass = 0.0                 # m, body
//! thrust_scale = 0.0                   # part of all rotors' thrust, more or less
//! rotor_scales = 0.0                   # part of each rotor's thrust, more or less
//! rotor_failures = 0.0                 # share of the flights in which a rotor fails, within the first half
//! thrust_left = [0.0, 0.7]             # the share of its thrust that it then has left: least and greatest
//! ```
//!
//! Each number is the greatest value that is drawn: evenly from zero up, or within a ball of that radius, or as much on
//! either side; `rotor_failures` is a share of the flights. Every key may be left out; these are the defaults. Those of
//! `duration` and `wind` ([`default_wind`]) depend on the law.

use crate::body::GREATEST_TURN_PER_STEP;
use crate::reality::numbers::{Allowed, seed};
use crate::section::{FieldError, Section};
use crate::timing::Timing;
use controller_core::configuration::{Configuration, LawParameters};

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
    /// Of a file that says nothing of it: none fails.
    pub const DEFAULT: Self = Self { flights: 0.0, thrust_left: [0.0, 0.7] };
}

impl Campaign {
    /// The campaign of a file that says nothing of it.
    #[must_use]
    pub fn of(configuration: &Configuration, timing: &Timing) -> Self {
        let turn = greatest_rate(timing);
        let noise = NoiseRanges { gyro: 0.01, position: 2e-3, attitude: ATTITUDE_NOISE_DEG.to_radians(), delay: 0.0 };
        let ranges = Ranges {
            duration: if configuration.paper().is_some() { 180.0 } else { 60.0 },
            reference: Task::InTurn,
            attitude: true,
            offset: 10.0,
            velocity: 5.0,
            rate: turn.min(15.0),
            yaw_rate: turn.min(6.0),
            wind: default_wind(configuration),
            gust: 0.0,
            turbulence: 0.0,
            noise,
            model: ModelRanges::default(),
            failure: FailureRanges::DEFAULT,
        };
        Self { flights: 1000, seed: 0, ranges }
    }
}

/// The greatest body rate that the plant can follow, rad/s.
fn greatest_rate(timing: &Timing) -> f64 {
    GREATEST_TURN_PER_STEP / timing.step()
}

/// Degrees.
const ATTITUDE_NOISE_DEG: f64 = 0.2;

/// The default wind, m/s: 5, or less where the estimate of forces
/// cannot hold against it. A wind of 1 m/s pushes with about 0.5 m/s^2, and four fifths of the estimate's level are
/// taken. The paper's law, which estimates nothing and gives way to every constant force, gets none.
#[must_use]
pub fn default_wind(configuration: &Configuration) -> f64 {
    const GREATEST: f64 = 5.0;
    const BORNE: f64 = 0.8 / 0.5;
    match configuration.law() {
        LawParameters::Paper(_) => 0.0,
        LawParameters::Extended(law) => (BORNE * f64::from(law.parameters.force_across)).min(GREATEST),
    }
}

/// Reads `[campaign]`; the defaults if it is missing.
///
/// # Errors
/// Names the field that is refused, or the section that it cannot stand beside.
pub fn read(root: &Section, timing: &Timing, configuration: &Configuration) -> Result<Campaign, FieldError> {
    let default = Campaign::of(configuration, timing);
    let Some(section) = root.optional_section("campaign")? else {
        return Ok(default);
    };
    section.allow(&[
        "flights",
        "seed",
        "duration",
        "reference",
        "attitude",
        "offset",
        "velocity",
        "rate",
        "yaw_rate",
        "wind",
        "gust",
        "turbulence",
        "gyro_noise",
        "position_noise",
        "attitude_noise_deg",
        "pose_delay",
        "mass",
        "inertia",
        "centre_of_mass",
        "thrust_scale",
        "rotor_scales",
        "rotor_failures",
        "thrust_left",
    ])?;
    let measured = NOISE.into_iter().find(|key| section.has(key));
    let source = ["sensors", "estimator"].into_iter().find(|other| root.has(other));
    if let (Some(key), Some(other)) = (measured, source) {
        let problem = format!("[{other}] says what is measured: leave that section or this key out");
        return Err(FieldError::new(section.path_of(key), problem));
    }
    let of_rotors = OF_ROTORS.into_iter().find(|key| section.has(key));
    if let (Some(key), None) = (of_rotors, configuration.rotors()) {
        let problem = "needs [rotors]: add that section or leave this key out";
        return Err(FieldError::new(section.path_of(key), problem));
    }
    if section.has("rotor_failures") && root.has("failure") {
        let problem = "[failure] says which rotor fails: leave that section or this key out";
        return Err(FieldError::new(section.path_of("rotor_failures"), problem));
    }
    let ranges = read_ranges(&section, timing, &default.ranges)?;
    let flights = section.number_or("flights", default.flights as f64)?;
    if flights.fract() != 0.0 || !(1.0..=MOST_FLIGHTS).contains(&flights) {
        let problem = format!("must be a whole number from 1 to {MOST_FLIGHTS}, found {flights}");
        return Err(FieldError::new(section.path_of("flights"), problem));
    }
    Ok(Campaign { flights: flights as u64, seed: seed(&section)?, ranges })
}

/// The least duration of a flight, s: in less nothing that was thrown has time to miss its reference, or to come back
/// to it.
const LEAST_DURATION: f64 = 1.0;

/// The most flights of a campaign.
pub const MOST_FLIGHTS: f64 = 1e8;

/// The keys that a file with `[sensors]` may not have.
const NOISE: [&str; 4] = ["gyro_noise", "position_noise", "attitude_noise_deg", "pose_delay"];

/// The keys that a file without `[rotors]` may not have.
const OF_ROTORS: [&str; 3] = ["rotor_scales", "rotor_failures", "thrust_left"];

fn read_ranges(section: &Section, timing: &Timing, default: &Ranges) -> Result<Ranges, FieldError> {
    let up_to =
        |key: &str, greatest: f64, unit, default| Allowed::new(0.0..=greatest, unit).number_or(section, key, default);
    let part = |key: &str| up_to(key, 0.9, "", 0.0);
    let turn = greatest_rate(timing);
    let attitude = up_to("attitude_noise_deg", 30.0, "degrees", ATTITUDE_NOISE_DEG)?.to_radians();
    Ok(Ranges {
        duration: Allowed::new(LEAST_DURATION..=1e5, "s").number_or(section, "duration", default.duration)?,
        reference: read_choice(section, "reference", REFERENCES, default.reference)?,
        attitude: read_choice(section, "attitude", [("uniform", true), ("file", false)], default.attitude)?,
        offset: up_to("offset", 1e4, "m", default.offset)?,
        velocity: up_to("velocity", 1e3, "m/s", default.velocity)?,
        rate: up_to("rate", turn, "rad/s", default.rate)?,
        yaw_rate: up_to("yaw_rate", turn, "rad/s", default.yaw_rate)?,
        wind: up_to("wind", 100.0, "m/s", default.wind)?,
        gust: up_to("gust", 100.0, "m/s", default.gust)?,
        turbulence: up_to("turbulence", 100.0, "m/s", default.turbulence)?,
        noise: NoiseRanges {
            gyro: up_to("gyro_noise", 10.0, "rad/s", default.noise.gyro)?,
            position: up_to("position_noise", 100.0, "m", default.noise.position)?,
            attitude,
            delay: up_to("pose_delay", 1.0, "s", default.noise.delay)?,
        },
        model: ModelRanges {
            mass: part("mass")?,
            inertia: part("inertia")?,
            centre_of_mass: up_to("centre_of_mass", 10.0, "m", 0.0)?,
            thrust_scale: part("thrust_scale")?,
            rotor_scales: part("rotor_scales")?,
        },
        failure: FailureRanges {
            flights: up_to("rotor_failures", 1.0, "", default.failure.flights)?,
            thrust_left: read_thrust_left(section, default.failure.thrust_left)?,
        },
    })
}

/// The least and the greatest share of its thrust that a failing rotor has left.
fn read_thrust_left(section: &Section, default: [f64; 2]) -> Result<[f64; 2], FieldError> {
    const WANTED: &str = "[least, greatest], 0 <= least <= greatest < 1";
    if !section.has("thrust_left") {
        return Ok(default);
    }
    section.range("thrust_left", WANTED, |least, greatest| 0.0 <= least && least <= greatest && greatest < 1.0)
}

const REFERENCES: [(&str, Task); 3] = [("in-turn", Task::InTurn), ("file", Task::File), ("hover", Task::Hover)];

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
