//! How long, how often: `duration`, `[control] rate` and `[plant] step`. All may be left out.
//!
//! Time is counted in integer microseconds. The control period is a whole number of them and of plant steps, so that a
//! tick never falls between two steps.

use crate::key::{Bounds, Key, Layout};
use crate::section::{FieldError, Section};
use std::ops::RangeInclusive;

/// The clock of a flight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timing {
    /// Control ticks in the flight.
    pub ticks: u64,
    /// Time between ticks, us.
    pub period_us: u64,
    /// Plant steps between ticks.
    pub steps_per_tick: u32,
}

/// Longest flight, s: nearly four months.
const DURATION_MAX_S: f64 = 1e7;
/// Time between two ticks, shortest and longest, s.
const CONTROL_PERIODS_S: RangeInclusive<f64> = 1.0 / CONTROL_RATE_MAX_HZ..=1.0 / CONTROL_RATE_MIN_HZ;
/// Duration where it is left out, s.
const DEFAULT_DURATION_S: f64 = 20.0;
/// The filters advance by at most a tenth of a second at a time.
const CONTROL_RATE_MIN_HZ: f64 = 10.0;
/// Beyond it the certificate's allowance does not cover what the rounding of the filters adds up to.
const CONTROL_RATE_MAX_HZ: f64 = 4000.0;
/// Rate where `[control]` is left out, Hz.
const DEFAULT_CONTROL_RATE_HZ: f64 = 100.0;
/// Longest plant step where `[plant]` is left out, s.
const DEFAULT_PLANT_STEP_MAX_S: f64 = 1e-3;
/// More plant steps than this between two ticks are a slip of the pen.
const STEPS_PER_TICK_MAX: f64 = 1e5;
/// How far from a whole number a quotient of the file's decimal fractions may be, relative.
const WHOLE_TOLERANCE: f64 = 1e-9;

const RATE: Bounds = Bounds::between(CONTROL_RATE_MIN_HZ, CONTROL_RATE_MAX_HZ, "Hz").checked_later();

/// The key `duration`.
pub const DURATION: Key = Key::number(
    "duration",
    Bounds::between(0.0, DURATION_MAX_S, "s").checked_later(),
    "Of the flight; left out: 20 s, or 5 s more than a path through points.",
)
.optional();

/// The keys of `[control]`.
pub const CONTROL: Layout = Layout {
    name: "control",
    about: "The law, and how often it acts.",
    keys: &[
        Key::choice("law", &["paper", "extended"], "Left out: \"paper\" beside a gain of that law alone."),
        Key::number("rate", RATE, "1/rate: whole microseconds.").or(DEFAULT_CONTROL_RATE_HZ),
        Key::number("thrust_floor", Bounds::physical("N"), "The least thrust, under the paper's law only.").optional(),
    ],
};

/// The keys of `[plant]`.
pub const PLANT: Layout = Layout {
    name: "plant",
    about: "The integration of the simulated vehicle. Left out: the longest step of at most 1 ms that fits.",
    keys: &[Key::number("step", Bounds::physical("s"), "1/control.rate is a whole number of them.")],
};

impl Timing {
    /// Reads `duration`, `[control]` and `[plant]` from the file's root.
    ///
    /// # Errors
    /// Names the field that does not fit, with the nearest value that does.
    pub fn read(root: &Section) -> Result<Self, FieldError> {
        let period_us = read_period(root)?;
        let steps_per_tick = read_steps(root, period_us)?;
        let duration = root.number_or("duration", DEFAULT_DURATION_S)?;
        let period = period_us as f64 * 1e-6;
        if !(duration >= period && duration <= DURATION_MAX_S) {
            let allowed = format!("must be from one control period, {period} s, to {DURATION_MAX_S:e} s");
            return Err(FieldError::new("duration", format!("{allowed}, found {duration}")));
        }
        let ticks = (duration / period * (1.0 + WHOLE_TOLERANCE)).floor() as u64;
        Ok(Self { ticks, period_us, steps_per_tick })
    }

    /// The same for so many seconds, as far as flights may last.
    #[must_use]
    pub fn lasting(self, duration: f64) -> Self {
        Self { ticks: (duration.min(DURATION_MAX_S) / self.period()).ceil() as u64, ..self }
    }

    /// The same plant step and duration, with a control rate of so many Hz.
    ///
    /// # Errors
    /// In words, without the field's name.
    pub fn at_rate(self, rate: f64) -> Result<Self, String> {
        let period_us = whole_period(rate)?;
        let steps = period_us * u64::from(self.steps_per_tick);
        if !steps.is_multiple_of(self.period_us) {
            let (step, period) = (self.step(), period_us as f64 * 1e-6);
            return Err(format!(
                "1/rate must be a whole number of plant steps of {step} s, found {rate} Hz = {period} s"
            ));
        }
        let steps_per_tick =
            u32::try_from(steps / self.period_us).map_err(|_| "has too many plant steps".to_owned())?;
        Ok(Self { ticks: self.ticks * self.period_us / period_us, period_us, steps_per_tick })
    }

    /// The control period, s.
    #[must_use]
    pub fn period(&self) -> f64 {
        self.period_us as f64 * 1e-6
    }

    /// The plant's integration step, s.
    #[must_use]
    pub fn step(&self) -> f64 {
        self.period() / f64::from(self.steps_per_tick)
    }

    /// From the first tick to one period after the last, s.
    #[must_use]
    pub fn duration(&self) -> f64 {
        (self.ticks * self.period_us) as f64 / 1e6
    }
}

/// Whether a law in a caller's own loop may be stepped by `period`, s.
///
/// # Errors
/// In words, with the range that a file's rate has as well.
pub fn check_period(period: f64) -> Result<(), String> {
    let (shortest, longest) = (CONTROL_PERIODS_S.start(), CONTROL_PERIODS_S.end());
    if CONTROL_PERIODS_S.contains(&period) {
        return Ok(());
    }
    Err(format!("must be from {shortest} to {longest} s, found {period}"))
}

fn read_period(root: &Section) -> Result<u64, FieldError> {
    const FIELD: &str = "control.rate";
    let Some(control) = root.open(&CONTROL)? else {
        return Ok((1e6 / DEFAULT_CONTROL_RATE_HZ) as u64);
    };
    let rate = control.number("rate")?;
    whole_period(rate).map_err(|problem| FieldError::new(FIELD, problem))
}

/// The time between two ticks at `rate`, Hz, us.
fn whole_period(rate: f64) -> Result<u64, String> {
    if !(CONTROL_RATE_MIN_HZ..=CONTROL_RATE_MAX_HZ).contains(&rate) {
        return Err(format!("must be from {CONTROL_RATE_MIN_HZ} to {CONTROL_RATE_MAX_HZ} Hz, found {rate}"));
    }
    let period_us = 1e6 / rate;
    let whole = period_us.round();
    if (period_us - whole).abs() > WHOLE_TOLERANCE * period_us {
        return Err(format!(
            "1/rate must be a whole number of microseconds, found {rate} Hz = {period_us:.3} us (nearest: {} Hz)",
            1e6 / whole
        ));
    }
    Ok(whole as u64)
}

fn read_steps(root: &Section, period_us: u64) -> Result<u32, FieldError> {
    const FIELD: &str = "plant.step";
    let period = period_us as f64 * 1e-6;
    let Some(plant) = root.open(&PLANT)? else {
        return Ok((period / DEFAULT_PLANT_STEP_MAX_S * (1.0 - WHOLE_TOLERANCE)).ceil() as u32);
    };
    let step = plant.number("step")?;
    let least = period / STEPS_PER_TICK_MAX;
    if step < least || step <= 0.0 {
        let allowed =
            format!("must be greater than zero and at least 1/{STEPS_PER_TICK_MAX:e} of 1/control.rate, {least:e} s");
        return Err(FieldError::new(FIELD, format!("{allowed}, found {step}")));
    }
    let steps = period / step;
    let whole = steps.round().max(1.0);
    if (steps - whole).abs() > WHOLE_TOLERANCE * whole {
        let problem = format!(
            "1/control.rate must be a whole number of steps, found {period} s / {step} s = {steps:.4} (nearest: {:e} s)",
            period / whole
        );
        return Err(FieldError::new(FIELD, problem));
    }
    Ok(whole as u32)
}

#[cfg(test)]
mod tests;
