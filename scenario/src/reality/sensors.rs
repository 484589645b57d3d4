//! `[sensors]`: noise, bias and delay of the state that the controller gets.
//!
//! Every key may be left out, for perfect, immediate sensors. Noise is white and normal, on each axis alone; the number
//! is its standard deviation.

use crate::key::{Bounds, Key, Layout, SEED, read_seed};
use crate::sampled_loop::DELAY_MAX_SAMPLES;
use crate::section::{FieldError, Section};
use crate::timing::Timing;
use nalgebra::Vector3;

/// Noise, bias and delay of the measured state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensors {
    /// Standard deviation of the gyro, rad/s.
    pub gyro_noise: f64,
    /// rad/s, body.
    pub gyro_bias: Vector3<f64>,
    /// Standard deviation of a pose's position, m.
    pub position_noise: f64,
    /// Standard deviation of a pose's attitude about each body axis, rad.
    pub attitude_noise: f64,
    /// Where the velocity comes from.
    pub velocity: VelocitySource,
    /// Control periods between two poses.
    pub pose_every: u64,
    /// Probability that a pose never arrives.
    pub dropout: f64,
    /// Control periods from a sample to its use.
    pub delay_ticks: u64,
    /// Control periods by which poses are later than that; no file says so.
    pub pose_delay_ticks: u64,
    /// By how much gyro and accelerometer are later than that, s; no file says so.
    pub imu_delay: f64,
    /// Seed of the random generator.
    pub seed: u64,
}

/// Where the velocity comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum VelocitySource {
    /// The true one, with noise of this standard deviation, m/s.
    Exact {
        /// m/s.
        noise: f64,
    },
    /// From the poses' positions, by an alpha-beta filter with a double pole.
    AlphaBeta {
        /// rad/s.
        bandwidth: f64,
    },
    /// The same filter, carried on with an accelerometer.
    Observer {
        /// rad/s.
        bandwidth: f64,
        /// Standard deviation of the accelerometer, m/s^2.
        noise: f64,
        /// m/s^2, body.
        bias: Vector3<f64>,
    },
}

const POSE_RATE: Bounds = Bounds::between(0.1, 4000.0, "Hz").checked_later();
const DELAY: Bounds = Bounds::not_negative("s").checked_later();
const ACCELERATION: Bounds = Bounds::between(-100.0, 100.0, "m/s^2");

/// The keys of `[sensors]`.
pub const LAYOUT: Layout = Layout {
    name: "sensors",
    about: "Noise, bias and delay of the state that the controller gets. Noise is white and normal on each axis; the \
            number is its standard deviation. Not beside [estimator].",
    keys: &[
        Key::number("gyro_noise", Bounds::between(0.0, 10.0, "rad/s"), "Of each sample.").or(0.0),
        Key::vector("gyro_bias", Bounds::between(-10.0, 10.0, "rad/s"), "Body.").or(0.0),
        Key::number("position_noise", Bounds::between(0.0, 100.0, "m"), "Of each pose.").or(0.0),
        Key::number("attitude_noise_deg", Bounds::between(0.0, 30.0, "degrees"), "Of each pose.").or(0.0),
        Key::choice("velocity", &["exact", "alpha-beta", "observer"], "Its source; left out: \"exact\"."),
        Key::number("velocity_noise", Bounds::between(0.0, 100.0, "m/s"), "Only of \"exact\".").or(0.0),
        Key::number("velocity_bandwidth", Bounds::between(0.01, 1e4, "rad/s"), "Not of \"exact\".").optional(),
        Key::number("accelerometer_noise", Bounds::between(0.0, 100.0, "m/s^2"), "Only of \"observer\".").or(0.0),
        Key::vector("accelerometer_bias", ACCELERATION, "Body; only of \"observer\".").or(0.0),
        Key::number("pose_rate", POSE_RATE, "control.rate over a whole number.").optional(),
        Key::number("dropout", Bounds::between(0.0, 0.99, ""), "The share of the poses that never arrive.").or(0.0),
        Key::number("delay", DELAY, "Of all; a whole number of control periods.").or(0.0),
        SEED,
    ],
};

/// The keys of [`LAYOUT`] that some sources of the velocity have.
const VELOCITY_KEYS: [&str; 4] = ["velocity_noise", "velocity_bandwidth", "accelerometer_noise", "accelerometer_bias"];

/// Reads `[sensors]`, beside a delay of `sampling` control periods on the way to the rotors.
///
/// # Errors
/// Names the field that is refused.
pub fn read(root: &Section, timing: &Timing, sampling: f64) -> Result<Option<Sensors>, FieldError> {
    let Some(section) = root.open(&LAYOUT)? else {
        return Ok(None);
    };
    let velocity = read_velocity(&section)?;
    let pose_every = read_pose_rate(&section, timing)?;
    let dropout = section.number("dropout")?;
    if let VelocitySource::AlphaBeta { .. } = velocity {
        for (is_left_out, key) in [(pose_every > 1, "pose_rate"), (dropout > 0.0, "dropout")] {
            if is_left_out {
                let problem = "leaves ticks without a pose, for which loops cannot be judged with sensors.velocity = \"alpha-beta\": \
                               leave it out, or take \"observer\"";
                return Err(FieldError::new(section.path_of(key), problem));
            }
        }
    }
    Ok(Some(Sensors {
        gyro_noise: section.number("gyro_noise")?,
        gyro_bias: section.vector("gyro_bias")?,
        position_noise: section.number("position_noise")?,
        attitude_noise: section.number("attitude_noise_deg")?.to_radians(),
        velocity,
        pose_every,
        dropout,
        delay_ticks: read_delay(&section, timing, sampling)?,
        pose_delay_ticks: 0,
        imu_delay: 0.0,
        seed: read_seed(&section)?,
    }))
}

fn read_velocity(section: &Section) -> Result<VelocitySource, FieldError> {
    let kind = if section.has("velocity") { section.choice("velocity")? } else { "exact" };
    let known = match kind {
        "exact" => &VELOCITY_KEYS[..1],
        "alpha-beta" => &VELOCITY_KEYS[1..2],
        _ => &VELOCITY_KEYS[1..],
    };
    if let Some(key) = VELOCITY_KEYS.into_iter().find(|key| section.has(key) && !known.contains(key)) {
        let problem =
            format!("means nothing with sensors.velocity = \"{kind}\": leave it out, or take another velocity");
        return Err(FieldError::new(section.path_of(key), problem));
    }
    Ok(match kind {
        "exact" => VelocitySource::Exact { noise: section.number("velocity_noise")? },
        "alpha-beta" => VelocitySource::AlphaBeta { bandwidth: section.number("velocity_bandwidth")? },
        _ => VelocitySource::Observer {
            bandwidth: section.number("velocity_bandwidth")?,
            noise: section.number("accelerometer_noise")?,
            bias: section.vector("accelerometer_bias")?,
        },
    })
}

/// How far from a whole number a quotient of the file's decimal fractions may be, relative.
const WHOLE_TOLERANCE: f64 = 1e-6;

fn read_pose_rate(section: &Section, timing: &Timing) -> Result<u64, FieldError> {
    let control = 1.0 / timing.period();
    let rate = section.number_or("pose_rate", control)?;
    Bounds::between(0.1, control * (1.0 + WHOLE_TOLERANCE), "Hz").check(section.path_of("pose_rate"), rate)?;
    let ticks = control / rate;
    let whole = ticks.round();
    if (ticks - whole).abs() > WHOLE_TOLERANCE * ticks {
        let problem = format!(
            "must be control.rate = {control} Hz over a whole number, found {rate} (nearest: {} Hz)",
            control / whole
        );
        return Err(FieldError::new(section.path_of("pose_rate"), problem));
    }
    Ok(whole as u64)
}

/// Together with `sampling`, control periods, no longer than the sampled loops can be judged with.
fn read_delay(section: &Section, timing: &Timing, sampling: f64) -> Result<u64, FieldError> {
    let period = timing.period();
    let greatest = (f64::from(DELAY_MAX_SAMPLES) - sampling).floor() * period;
    let delay = Bounds::between(0.0, greatest, "s").check(section.path_of("delay"), section.number("delay")?)?;
    let ticks = delay / period;
    let whole = ticks.round();
    if (ticks - whole).abs() > WHOLE_TOLERANCE * ticks.max(1.0) {
        let problem = format!(
            "must be a whole number of control periods, found {delay} s (nearest: {:e} s; sampling.delay may be finer)",
            whole * period
        );
        return Err(FieldError::new(section.path_of("delay"), problem));
    }
    Ok(whole as u64)
}
