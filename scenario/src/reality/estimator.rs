//! `[estimator]`: the controller flies on the core's estimator, fed by an IMU at 1 kHz and by poses that come late.
//!
//! Every key may be left out. The estimator believes a BMI088 and the
//! poses' noise as given. Instead of `[sensors]`, which has no estimator: a file has one of the two.

use crate::key::{Bounds, Key, Layout, SEED};
use crate::section::{FieldError, Section};
use crate::timing::Timing;
use estimation::estimator::EstimatorParameters;
use estimation::imu::ImuParameters;
use estimation::imu::rotor_notches::RotorNotches;

/// Of its samples.
pub const IMU_RATE_HZ: f64 = 1e3;

/// The default of a pose.
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
        /// The minimum that single precision separates from zero, with room to spare.
        const NOISE_MIN: f64 = 1e-4;
        EstimatorParameters {
            position_noise: self.position_noise.max(NOISE_MIN) as f32,
            attitude_noise: self.attitude_noise.max(NOISE_MIN) as f32,
            gravity,
            ..EstimatorParameters::BMI088
        }
    }
}

/// The maximum delay of the law's body rates, s: [`ImuParameters::rates_late`] of the latest of all sensors that boards
/// have, since any board may carry what flies on a desk, and its second sensor may take over. They differ by 0.15 ms.
#[must_use]
pub fn rates_delay(timing: &Timing) -> f64 {
    latest(|sensor| sensor.rates_late(timing.period_us))
}

/// What the notches that follow the rotors add to that at most, s: [`RotorNotches::delay_max`].
#[must_use]
pub fn notches_delay() -> f64 {
    latest(|sensor| RotorNotches::delay_max(sensor.rate))
}

/// The greatest of what each sensor has, s.
fn latest(late: impl Fn(&ImuParameters) -> f32) -> f64 {
    ImuParameters::DRIVEN.iter().map(|(_, sensor)| f64::from(late(sensor))).fold(0.0, f64::max)
}

/// The keys of `[estimator]`; their defaults are those of [`Estimator`].
pub const LAYOUT: Layout = Layout {
    name: "estimator",
    about: "The controller flies on the core's estimator, fed by an IMU at 1 kHz and by poses that come late. Not \
            beside [sensors].",
    keys: &[
        Key::number("imu_noise", Bounds::between(0.0, 100.0, ""), "Times a BMI088's noise and biases.").or(1.0),
        Key::number("pose_rate", Bounds::between(10.0, 200.0, "Hz"), "1000 over a whole number.").or(100.0),
        Key::number("pose_delay", Bounds::between(0.0, 0.15, "s"), "Until a pose arrives; whole milliseconds.")
            .or(0.02),
        Key::number("position_noise", Bounds::between(0.0, 1.0, "m"), "Of each pose.").or(1e-3),
        Key::number("attitude_noise_deg", Bounds::between(0.0, 30.0, "degrees"), "About each axis, of each pose.")
            .or(ATTITUDE_NOISE_DEG),
        Key::number("dropout", Bounds::between(0.0, 0.99, ""), "The share of the poses that never arrive.").or(0.0),
        Key::table(&OUTAGE),
        SEED,
    ],
};

const OUTAGE: Layout = Layout {
    name: "outage",
    about: "A time in which no pose arrives.",
    keys: &[
        Key::number("start", Bounds::between(0.0, 1e7, "s"), "When it begins."),
        Key::number("duration", Bounds::between(1e-3, 1e7, "s"), "How long it lasts."),
    ],
};

/// Reads `[estimator]`.
///
/// # Errors
/// Names the field that is refused, or what `timing` or another section lacks for it.
pub fn read(root: &Section, timing: &Timing) -> Result<Option<Estimator>, FieldError> {
    if root.has("estimator") && root.has("sensors") {
        return Err(FieldError::new("estimator", "has sensors of its own: leave [sensors] or [estimator] out"));
    }
    let Some(section) = root.open(&LAYOUT)? else {
        return Ok(None);
    };
    check_timing(timing)?;
    let milliseconds = |key: &str, value: f64, what: &str| {
        let whole = value.round();
        let problem = || format!("must make {what} whole milliseconds, makes it {value} ms");
        if (value - whole).abs() > 1e-6 * value.max(1.0) {
            return Err(FieldError::new(section.path_of(key), problem()));
        }
        Ok(whole as u64)
    };
    let (rate, delay) = (section.number("pose_rate")?, section.number("pose_delay")?);
    let outage = section.open(&OUTAGE)?.map(|outage| {
        Ok::<_, FieldError>(Outage { start: outage.number("start")?, duration: outage.number("duration")? })
    });
    Ok(Some(Estimator {
        imu_noise: section.number("imu_noise")?,
        pose_every: milliseconds("pose_rate", IMU_RATE_HZ / rate, "the time between two poses")?,
        pose_delay: milliseconds("pose_delay", IMU_RATE_HZ * delay, "the delay")?,
        position_noise: section.number("position_noise")?,
        attitude_noise: section.number("attitude_noise_deg")?.to_radians(),
        dropout: section.number("dropout")?,
        outage: outage.transpose()?,
        seed: section.seed()?,
    }))
}

/// The IMU's samples must fall on plant steps and ticks.
fn check_timing(timing: &Timing) -> Result<(), FieldError> {
    let whole = |ratio: f64| (ratio - ratio.round()).abs() < 1e-6 && ratio >= 1.0 - 1e-6;
    if !timing.period_us.is_multiple_of(1_000) || timing.period_us > 20_000 {
        let problem =
            "must be 50 to 1000 Hz, and 1000 over a whole number, with [estimator], whose IMU samples at 1 kHz";
        return Err(FieldError::new("control.rate", problem));
    }
    if !whole(1e-3 / timing.step()) {
        let problem = "must be 1 ms over a whole number with [estimator], whose IMU samples at 1 kHz";
        return Err(FieldError::new("plant.step", problem));
    }
    Ok(())
}
