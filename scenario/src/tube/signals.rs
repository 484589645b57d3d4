//! Bounds on an axis' signals in SI units, from bounds on what comes to its loop from outside.

use super::bounds::{Deviation, Peaks};
use super::cells::Cells;
use super::contraction::{norms, responses};
use super::refusal::NoTube;
use crate::file::Scenario;
use crate::sampled_loop::Axis;
use crate::sampled_loop::disturbed::{Input, Signal};
use controller_core::configuration::ExtendedLaw;
use core::num::NonZero;
use core::sync::atomic::{AtomicUsize, Ordering};
use std::thread::{self, available_parallelism};

/// What turns an axis' SI units into those of its loop, which counts time in samples and laterally forces over g.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Units {
    /// Of a force, per m/s^2.
    force: f64,
    /// Of the actuator's result, per rad/s^2 or m/s^2.
    actuator: f64,
    period: f64,
    /// Of the last filter, 1/s.
    k_f: f64,
}

/// What each input makes of each signal at most.
type Norms = Vec<[f64; Input::ALL.len()]>;

/// The greatest entries of all cells, worked out on as many threads as the machine has.
fn greatest_of(
    cells: &[[f64; 2]],
    of_cell: impl Fn([f64; 2]) -> Result<Norms, NoTube> + Sync,
    progress: &(dyn Fn(f64) -> bool + Sync),
) -> Result<Norms, NoTube> {
    let (next, threads) = (AtomicUsize::new(0), available_parallelism().map_or(1, NonZero::get));
    let worker = || {
        let mut greatest = vec![[0.0_f64; Input::ALL.len()]; Signal::ALL.len()];
        while let Some(cell) = cells.get(next.fetch_add(1, Ordering::Relaxed)) {
            raise(&mut greatest, &of_cell(*cell)?);
            if !progress(next.load(Ordering::Relaxed).min(cells.len()) as f64 / cells.len() as f64) {
                return Err(NoTube::Stopped);
            }
        }
        Ok(greatest)
    };
    let parts: Vec<Result<Norms, NoTube>> = thread::scope(|scope| {
        let workers: Vec<_> = (0..threads.min(cells.len())).map(|_| scope.spawn(worker)).collect();
        workers.into_iter().map(|worker| worker.join().unwrap_or(Err(NoTube::LeftOut))).collect()
    });
    let mut greatest = vec![[0.0; Input::ALL.len()]; Signal::ALL.len()];
    for part in parts {
        raise(&mut greatest, &part?);
    }
    Ok(greatest)
}

/// Raises each entry to that of `norms`.
fn raise(greatest: &mut Norms, norms: &Norms) {
    for (greatest, norm) in greatest.iter_mut().flatten().zip(norms.iter().flatten()) {
        *greatest = greatest.max(*norm);
    }
}

/// How much each input makes of each signal at most, in the loop's units, whatever cell of the tolerances is true.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisNorms {
    units: Units,
    norms: Norms,
    /// By what shares lag and gain differ from a cell's middle, and the greatest gain.
    shares: [f64; 2],
    gain_max: f64,
    worst: Vec<f64>,
}

impl AxisNorms {
    /// Of one axis of `scenario`, for all cells of the lag and of the gain.
    pub fn new(
        scenario: &Scenario,
        law: &ExtendedLaw,
        axis: Axis,
        [lag, gain]: [&Cells; 2],
        progress: &(dyn Fn(f64) -> bool + Sync),
    ) -> Result<Self, NoTube> {
        let k_f = f64::from(law.parameters.k_f);
        let period = scenario.timing.period();
        let g = f64::from(scenario.configuration.vehicle().gravity);
        let units = match axis {
            Axis::Vertical => Units { force: 1.0, actuator: 1.0, period, k_f },
            _ => Units { force: 1.0 / g, actuator: period * period, period, k_f },
        };
        let unsettled = |lag_factor, gain| NoTube::Unsettled { axis, lag_factor, gain };
        let loops = scenario.loops().map_err(|_| unsettled(1.0, 1.0))?;
        let cells: Vec<[f64; 2]> =
            lag.middles.iter().flat_map(|lag| gain.middles.iter().map(|gain| [*lag, *gain])).collect();
        let of_cell = |[lag_factor, gain]: [f64; 2]| {
            norms(&loops.disturbed(axis, lag_factor, gain).balanced()).ok_or_else(|| unsettled(lag_factor, gain))
        };
        let greatest = greatest_of(&cells, of_cell, progress)?;
        let worst = responses(&loops.disturbed(axis, 1.0, 1.0).balanced());
        let gain_max = gain.middles.iter().copied().fold(1.0, f64::max);
        Ok(Self { units, norms: greatest, shares: [lag.share, gain.share], gain_max, worst })
    }

    /// Of an axis along which nothing happens.
    pub fn still() -> Self {
        let units = Units { force: 0.0, actuator: 0.0, period: 0.0, k_f: 0.0 };
        let norms = vec![[0.0; Input::ALL.len()]; Signal::ALL.len()];
        Self { units, norms, shares: [0.0; 2], gain_max: 1.0, worst: Vec::new() }
    }

    /// Of a tick, s.
    pub fn period(&self) -> f64 {
        self.units.period
    }

    /// The sign of the gust that takes the loop farthest, a tick each, the oldest first.
    pub fn worst_gust(&self) -> Vec<f64> {
        self.worst.clone()
    }

    /// Bounds on the signals, for a gust, m/s^2, and what differs.
    pub fn peaks(&self, taken: &Deviation, gust: f64) -> Peaks {
        let Units { force, actuator, period: h, .. } = self.units;
        if h == 0.0 {
            return Peaks::default();
        }
        let inputs = Input::ALL.map(|input| match input {
            Input::Force => (taken.at(input) + gust) * force,
            Input::Feedback | Input::Estimate | Input::Unseen | Input::Shaken => taken.at(input) * force,
            Input::Actuator | Input::Command | Input::Bend | Input::Late | Input::Stray | Input::Uneven => {
                taken.at(input) * actuator
            }
        });
        let peak = |signal: Signal| -> f64 {
            self.norms[signal as usize].iter().zip(inputs).map(|(norm, input)| norm * input).sum()
        };
        let force_of = |signal: Signal| peak(signal) / force;
        let turn = |signal: Signal| peak(signal) / actuator;
        let [c, c_rate, c_acceleration] =
            [Signal::Desired, Signal::DesiredRate, Signal::DesiredAcceleration].map(force_of);
        let desired = [c, c_rate / h, c_acceleration / (h * h)];
        // Across: how e and c move between ticks. A chord is off by an eighth of h^2 times the second derivative.
        let delivered = turn(Signal::Actual).max(self.gain_max * turn(Signal::Command)) + taken.at(Input::Actuator);
        // Within a tick c'' fades, and the rest is as much as the tick's bend and its change.
        let fading = h * self.units.k_f * desired[2] * force;
        let bent = turn(Signal::BentActual).max(turn(Signal::BentOlder)).max(turn(Signal::BentNewer));
        let changed = [Input::Actuator, Input::Bend, Input::Uneven].map(|input| taken.at(input));
        let e_bend = bent + fading + changed.iter().sum::<f64>();
        let [e, e_rate] = [peak(Signal::Error), peak(Signal::ErrorRate) / h];
        Peaks {
            position: force_of(Signal::Position) * h * h,
            velocity: force_of(Signal::Velocity) * h,
            z_1: force_of(Signal::Z1) * h * h,
            z_2: force_of(Signal::Z2) * h,
            wanted: force_of(Signal::Wanted),
            force: force_of(Signal::Force),
            desired: [desired[0] + h * h / 8.0 * desired[2], desired[1], desired[2]],
            error: [e + h * h / 8.0 * e_bend, e_rate + 0.5 * h * e_bend],
            projected: [peak(Signal::Angle), peak(Signal::Rate) / h],
            jump: force_of(Signal::Jump) / (h * h),
            turned: delivered,
            bias: turn(Signal::Bias),
            command: turn(Signal::Command),
            behind: turn(Signal::BehindAtTick).max(turn(Signal::BehindAtArrival)),
        }
    }

    /// What the actuator follows beside a cell's middle: of a gain within `share` of it, and of a lag likewise.
    ///
    /// a' = ((1 + x) w - a) (1 + y) / lag, with |x| and |y| what follows from the shares, is
    /// a' = (w + v - a) / lag with v = x w + y ((1 + x) w - a).
    pub fn actuator_error(&self, peaks: &Peaks, taken: &Deviation) -> f64 {
        let [lag, gain] = self.shares;
        // The middle's lag over the true one, less one.
        let faster = lag / (1.0 - lag);
        let told = self.gain_max * peaks.command;
        gain * (1.0 + faster) * told + faster * (peaks.behind + taken.at(Input::Actuator))
    }
}
