//! `[sensors]`: noise, bias and delay of the state that the controller gets.
//!
//! ```toml
//! [sensors]
//! gyro_noise = 0.01                    # rad/s, each sample
//! gyro_bias = [0.005, 0.0, 0.0]        # rad/s, body
//! position_noise = 0.002               # m, each pose
//! attitude_noise_deg = 0.2             # degrees, each pose
//! velocity = "observer"                # or "exact", or "alpha-beta"; left out: "exact"
//! velocity_noise = 0.0                 # m/s, each sample; "exact" only
//! velocity_bandwidth = 20.0            # rad/s; "alpha-beta" and "observer" only
//! accelerometer_noise = 0.1            # m/s^2, each sample; "observer" only
//! accelerometer_bias = [0.0, 0.0, 0.0] # m/s^2, body; "observer" only
//! pose_rate = 50.0                     # Hz, control.rate over a whole number; left out: control.rate
//! dropout = 0.01                       # the part of the poses that never arrive
//! delay = 0.02                         # s, of all of it; a whole number of control periods
//! seed = 1
//! ```
//!
//! Every key may be left out, for perfect, immediate sensors. Noise is white and normal, on each axis alone; the number
//! is its standard deviation.

use super::numbers::{Allowed, seed};
use crate::sampled_loop::GREATEST_DELAY;
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

/// Reads `[sensors]`, beside a delay of `sampling` control periods on the way to the rotors.
///
/// # Errors
/// Names the field that is refused.
pub fn read(root: &Section, timing: &Timing, sampling: f64) -> Result<Option<Sensors>, FieldError> {
    let Some(section) = root.optional_section("sensors")? else {
        return Ok(None);
    };
    section.allow(&[
        "gyro_noise",
        "gyro_bias",
        "position_noise",
        "attitude_noise_deg",
        "velocity",
        "velocity_noise",
        "velocity_bandwidth",
        "accelerometer_noise",
        "accelerometer_bias",
        "pose_rate",
        "dropout",
        "delay",
        "seed",
    ])?;
    let velocity = read_velocity(&section)?;
    let pose_every = read_pose_rate(&section, timing)?;
    let dropout = Allowed::new(0.0..=0.99, "").number_or(&section, "dropout", 0.0)?;
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
        gyro_noise: Allowed::new(0.0..=10.0, "rad/s").number_or(&section, "gyro_noise", 0.0)?,
        gyro_bias: Allowed::new(-10.0..=10.0, "rad/s").vector_or_zero(&section, "gyro_bias")?,
        position_noise: Allowed::new(0.0..=100.0, "m").number_or(&section, "position_noise", 0.0)?,
        attitude_noise: Allowed::new(0.0..=30.0, "degrees")
            .number_or(&section, "attitude_noise_deg", 0.0)?
            .to_radians(),
        velocity,
        pose_every,
        dropout,
        delay_ticks: read_delay(&section, timing, sampling)?,
        pose_delay_ticks: 0,
        imu_delay: 0.0,
        seed: seed(&section)?,
    }))
}

fn read_velocity(section: &Section) -> Result<VelocitySource, FieldError> {
    const OPTIONS: [&str; 4] = ["velocity_noise", "velocity_bandwidth", "accelerometer_noise", "accelerometer_bias"];
    let kind = if section.has("velocity") { section.text("velocity")? } else { "exact" };
    let known: &[&str] = match kind {
        "exact" => &OPTIONS[..1],
        "alpha-beta" => &OPTIONS[1..2],
        "observer" => &OPTIONS[1..],
        other => {
            let problem = format!("must be \"exact\", \"alpha-beta\" or \"observer\", found {other:?}");
            return Err(FieldError::new(section.path_of("velocity"), problem));
        }
    };
    if let Some(key) = OPTIONS.into_iter().find(|key| section.has(key) && !known.contains(key)) {
        let problem =
            format!("means nothing with sensors.velocity = \"{kind}\": leave it out, or take another velocity");
        return Err(FieldError::new(section.path_of(key), problem));
    }
    let bandwidth = || Allowed::new(0.01..=1e4, "rad/s").number(section, "velocity_bandwidth");
    Ok(match kind {
        "alpha-beta" => VelocitySource::AlphaBeta { bandwidth: bandwidth()? },
        "observer" => VelocitySource::Observer {
            bandwidth: bandwidth()?,
            noise: Allowed::new(0.0..=100.0, "m/s^2").number_or(section, "accelerometer_noise", 0.0)?,
            bias: Allowed::new(-100.0..=100.0, "m/s^2").vector_or_zero(section, "accelerometer_bias")?,
        },
        _ => {
            VelocitySource::Exact { noise: Allowed::new(0.0..=100.0, "m/s").number_or(section, "velocity_noise", 0.0)? }
        }
    })
}

/// How far from a whole number a quotient of the file's decimal fractions may be, relative.
const WHOLE: f64 = 1e-6;

fn read_pose_rate(section: &Section, timing: &Timing) -> Result<u64, FieldError> {
    let control = 1.0 / timing.period();
    let rate = Allowed::new(0.1..=control * (1.0 + WHOLE), "Hz").number_or(section, "pose_rate", control)?;
    let ticks = control / rate;
    let whole = ticks.round();
    if (ticks - whole).abs() > WHOLE * ticks {
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
    let greatest = (f64::from(GREATEST_DELAY) - sampling).floor() * period;
    let delay = Allowed::new(0.0..=greatest, "s").number_or(section, "delay", 0.0)?;
    let ticks = delay / period;
    let whole = ticks.round();
    if (ticks - whole).abs() > WHOLE * ticks.max(1.0) {
        let problem = format!(
            "must be a whole number of control periods, found {delay} s (nearest: {:e} s; sampling.delay may be finer)",
            whole * period
        );
        return Err(FieldError::new(section.path_of("delay"), problem));
    }
    Ok(whole as u64)
}
