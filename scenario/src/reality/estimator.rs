//! `[estimator]`: the controller flies on the core's estimator, fed by an IMU at 1 kHz and by poses that come late.
//!
//! ```toml
//! [estimator]
//! imu_noise = 1.0                      # times a BMI088's noise and biases; 0 for a perfect one
//! pose_rate = 100.0                    # Hz, 1000 over a whole number
//! pose_delay = 0.02                    # s, from the moment a pose is true to its arrival, whole milliseconds
//! position_noise = 0.001               # m, each pose
//! attitude_noise_deg = 0.3             # degrees about each axis, each pose
//! dropout = 0.0                        # the part of the poses that never arrive
//! outage = { start = 10.0, duration = 0.5 }   # s: no pose arrives meanwhile
//! seed = 0
//! ```
//!
//! Every key may be left out; these are the defaults, without the outage. The estimator believes a BMI088 and the
//! poses' noise as given. Instead of `[sensors]`, which has no estimator: a file has one of the two.

use super::numbers::{Allowed, seed};
use crate::section::{FieldError, Section};
use crate::timing::Timing;
use estimation::estimator::EstimatorParameters;
use estimation::imu::ImuParameters;

/// Samples of the IMU each second.
pub const IMU_RATE: f64 = 1e3;

/// Noise of a pose's attitude where the file says nothing, degrees.
const ATTITUDE_NOISE_DEG: f64 = 0.3;

/// The estimator's inputs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimator {
    /// Times a BMI088's densities and biases.
    pub imu_noise: f64,
    /// Milliseconds between poses.
    pub pose_every: u64,
    /// Milliseconds from the moment a pose is true to its arrival.
    pub pose_delay: u64,
    /// Standard deviation of a pose's position, m.
    pub position_noise: f64,
    /// Standard deviation of a pose's attitude about each axis, rad.
    pub attitude_noise: f64,
    /// Probability that a pose never arrives.
    pub dropout: f64,
    /// While no pose arrives.
    pub outage: Option<Outage>,
    /// Seed of the random generator.
    pub seed: u64,
}

/// A time without poses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outage {
    /// s.
    pub start: f64,
    /// s.
    pub duration: f64,
}

impl Default for Estimator {
    fn default() -> Self {
        Self {
            imu_noise: 1.0,
            pose_every: 10,
            pose_delay: 20,
            position_noise: 1e-3,
            attitude_noise: ATTITUDE_NOISE_DEG.to_radians(),
            dropout: 0.0,
            outage: None,
            seed: 0,
        }
    }
}

impl Estimator {
    /// The estimator's model of its sensors, for a vehicle under `gravity`, m/s^2.
    #[must_use]
    pub fn believed(&self, gravity: f32) -> EstimatorParameters {
        /// The least that single precision separates from zero, with room to spare.
        const LEAST: f64 = 1e-4;
        EstimatorParameters {
            position_noise: self.position_noise.max(LEAST) as f32,
            attitude_noise: self.attitude_noise.max(LEAST) as f32,
            gravity,
            ..EstimatorParameters::BMI088
        }
    }
}

/// The greatest delay of the law's body rates, s: [`ImuParameters::rates_late`].
#[must_use]
pub fn rates_delay(timing: &Timing) -> f64 {
    ImuParameters::BMI088.rates_late(timing.period_us).into()
}

/// Reads `[estimator]`.
///
/// # Errors
/// Names the field that is refused, or what `timing` or another section lacks for it.
pub fn read(root: &Section, timing: &Timing) -> Result<Option<Estimator>, FieldError> {
    let Some(section) = root.optional_section("estimator")? else {
        return Ok(None);
    };
    if root.has("sensors") {
        let problem = "has sensors of its own: leave [sensors] or [estimator] out";
        return Err(FieldError::new("estimator", problem.to_owned()));
    }
    section.allow(&[
        "imu_noise",
        "pose_rate",
        "pose_delay",
        "position_noise",
        "attitude_noise_deg",
        "dropout",
        "outage",
        "seed",
    ])?;
    check_timing(timing)?;
    let milliseconds = |key: &str, value: f64, what: &str| {
        let whole = value.round();
        let problem = || format!("must make {what} whole milliseconds, makes it {value} ms");
        if (value - whole).abs() > 1e-6 * value.max(1.0) {
            return Err(FieldError::new(section.path_of(key), problem()));
        }
        Ok(whole as u64)
    };
    let default = Estimator::default();
    let rate = IMU_RATE / default.pose_every as f64;
    let rate = Allowed::new(10.0..=200.0, "Hz").number_or(&section, "pose_rate", rate)?;
    let delay = default.pose_delay as f64 / IMU_RATE;
    let delay = Allowed::new(0.0..=0.15, "s").number_or(&section, "pose_delay", delay)?;
    Ok(Some(Estimator {
        imu_noise: Allowed::new(0.0..=100.0, "").number_or(&section, "imu_noise", default.imu_noise)?,
        pose_every: milliseconds("pose_rate", IMU_RATE / rate, "the time between two poses")?,
        pose_delay: milliseconds("pose_delay", IMU_RATE * delay, "the delay")?,
        position_noise: Allowed::new(0.0..=1.0, "m").number_or(&section, "position_noise", default.position_noise)?,
        attitude_noise: Allowed::new(0.0..=30.0, "degrees")
            .number_or(&section, "attitude_noise_deg", ATTITUDE_NOISE_DEG)?
            .to_radians(),
        dropout: Allowed::new(0.0..=0.99, "").number_or(&section, "dropout", default.dropout)?,
        outage: section.optional_section("outage")?.map(|outage| read_outage(&outage)).transpose()?,
        seed: seed(&section)?,
    }))
}

fn read_outage(section: &Section) -> Result<Outage, FieldError> {
    section.allow(&["start", "duration"])?;
    Ok(Outage {
        start: Allowed::new(0.0..=1e7, "s").number(section, "start")?,
        duration: Allowed::new(1e-3..=1e7, "s").number(section, "duration")?,
    })
}

/// The IMU's samples must fall on plant steps and ticks.
fn check_timing(timing: &Timing) -> Result<(), FieldError> {
    let whole = |ratio: f64| (ratio - ratio.round()).abs() < 1e-6 && ratio >= 1.0 - 1e-6;
    if !timing.period_us.is_multiple_of(1_000) || timing.period_us > 20_000 {
        let problem =
            "must be 50 to 1000 Hz, and 1000 over a whole number, with [estimator], whose IMU samples at 1 kHz";
        return Err(FieldError::new("control.rate", problem.to_owned()));
    }
    if !whole(1e-3 / timing.step()) {
        let problem = "must be 1 ms over a whole number with [estimator], whose IMU samples at 1 kHz";
        return Err(FieldError::new("plant.step", problem.to_owned()));
    }
    Ok(())
}
