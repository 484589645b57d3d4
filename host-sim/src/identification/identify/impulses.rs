//! Impulses of the model's rotors between ticks, for a lag and a delay that are yet to be identified.
//!
//! A command c_k of rotor speed acts from t_k + D on, and speeds follow it with the first-order lag tau:
//!
//! ```text
//! w = c + (w_0 - c) e^(-t/tau)
//! integral of w^2 over L = c^2 L + 2 c (w_0 - c) tau (1 - E) + (w_0 - c)^2 tau / 2 (1 - E^2),   E = e^(-L/tau)
//! ```
//!
//! exactly. Slow commands show the *whole* delay S = D + tau to first order, and lag apart from delay only to second
//! order, by tau^2. So the unknowns are S, s, and u = tau^2, s^2. Noise may ask for u < 0: there the response is the
//! reflection 2 W(0) - W(-u), smooth through u = 0, so that what is found is unbiased; a lag is read from it
//! afterwards.
//!
//! Body rates behind [`LowPasses`] are the integral of torques behind the same filters, which are linear. So torques
//! are filtered here, and S is without the filters' delay. Counted as a delay alone, their shape would be taken for
//! lag.

use super::flight_log::FlightLog;
use super::low_passes::LowPasses;
use controller_core::allocation::{Mixer, Rotors};
use nalgebra::{Vector3, Vector4};

/// A shorter lag counts as zero.
const LAG_MIN_S: f64 = 1e-6;

/// Speeds commanded at each tick, rad/s, and what a squared speed gives.
#[derive(Debug, Clone)]
pub struct Commands {
    /// Per tick.
    speeds: Vec<Vec<f64>>,
    /// Per rotor: thrust and torque over squared speed.
    columns: Vec<Vector4<f64>>,
    /// s.
    period: f64,
    /// Of the measured body rates.
    pub(super) low_passes: Option<LowPasses>,
}

/// A part of a period.
struct Span {
    /// s.
    length: f64,
    /// e^(-length / lag).
    left: f64,
    /// By how many ticks more the command is late that acts in it: one before the newer has arrived.
    more: f64,
    /// Whether a sample of the low-passes ends with it.
    is_sampled: bool,
}

/// Integrals over one period: of thrust, N s, and of torque, N m s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Impulse {
    /// N s.
    pub thrust: f64,
    /// N m s, body.
    pub torque: Vector3<f64>,
}

impl Commands {
    /// The rotor speeds that the model's allocation commands.
    ///
    /// # Errors
    /// If the allocation refuses a wrench of the log.
    pub fn new(log: &FlightLog, rotors: &Rotors) -> Result<Self, String> {
        let mixer = Mixer::new(rotors);
        let speeds = log.moments.iter().map(|moment| {
            let allocation = mixer
                .allocate(&moment.commanded)
                .map_err(|error| format!("t = {}: thrust and torque cannot be allocated: {error}", moment.time))?;
            Ok(rotors.iter().zip(&allocation.thrusts).map(|(rotor, f)| f64::from(rotor.speed_at(*f))).collect())
        });
        let columns = rotors.iter().zip(rotors.effectiveness());
        Ok(Self {
            speeds: speeds.collect::<Result<_, String>>()?,
            columns: columns.map(|(rotor, column)| column * f64::from(rotor.thrust_coefficient)).collect(),
            period: log.period,
            low_passes: LowPasses::of_log(log),
        })
    }

    /// The rotors' impulses from each tick to the next, with the whole delay S and u, the squared lag.
    #[must_use]
    pub fn impulses(&self, whole: f64, squared: f64) -> Vec<Impulse> {
        if squared >= 0.0 {
            return self.lagging(whole, squared.sqrt());
        }
        let (none, mirror) = (self.lagging(whole, 0.0), self.lagging(whole, (-squared).sqrt()));
        let reflect = |(none, mirror): (&Impulse, &Impulse)| Impulse {
            thrust: 2.0 * none.thrust - mirror.thrust,
            torque: none.torque * 2.0 - mirror.torque,
        };
        none.iter().zip(&mirror).map(reflect).collect()
    }

    fn lagging(&self, whole: f64, lag: f64) -> Vec<Impulse> {
        let lag = lag.max(LAG_MIN_S);
        let ticks = ((whole - lag) / self.period).floor();
        let spans = self.spans(whole - lag - ticks * self.period, lag);
        let mut low_passes = self.low_passes.clone();
        let last = self.speeds.len().saturating_sub(1);
        let command = |tick: usize, more: f64| &self.speeds[((tick as f64 - ticks - more).max(0.0) as usize).min(last)];
        let mut speeds = self.speeds.first().cloned().unwrap_or_default();
        let pieces = (0..last).map(|tick| {
            let mut given = Impulse { thrust: 0.0, torque: Vector3::zeros() };
            let mut sampled = Vector3::zeros();
            for Span { length, left, more, is_sampled } in &spans {
                let mut sum = Vector4::zeros();
                for ((speed, command), column) in speeds.iter_mut().zip(command(tick, *more)).zip(&self.columns) {
                    let apart = *speed - command;
                    let squared = command * command * length
                        + 2.0 * command * apart * lag * (1.0 - left)
                        + 0.5 * apart * apart * lag * (1.0 - left * left);
                    *speed = command + apart * left;
                    sum += column * squared;
                }
                given.thrust += sum.x;
                sampled += Vector3::new(sum.y, sum.z, sum.w);
                if *is_sampled {
                    given.torque += match &mut low_passes {
                        Some(low_passes) => low_passes.take(&sampled),
                        None => sampled,
                    };
                    sampled = Vector3::zeros();
                }
            }
            given
        });
        pieces.collect()
    }

    /// The parts of a period in which newer commands arrive `late` after its beginning.
    fn spans(&self, late: f64, lag: f64) -> Vec<Span> {
        let samples = self.low_passes.as_ref().map_or(1, LowPasses::samples);
        let ends = (1..=samples).map(|sample| (self.period * sample as f64 / samples as f64, true));
        let mut ends: Vec<(f64, bool)> = ends.chain([(late, false)]).collect();
        ends.sort_by(|one, other| one.0.total_cmp(&other.0));
        let mut begin = 0.0;
        let span = |(end, is_sampled)| {
            let (length, more) = (end - begin, if end <= late { 1.0 } else { 0.0 });
            begin = end;
            Span { length, left: (-length / lag).exp(), more, is_sampled }
        };
        ends.into_iter().map(span).collect()
    }
}
