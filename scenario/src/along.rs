//! The file's own reference, judged along itself: where it takes most of what its vehicle leaves, of what, and how much
//! more slowly it certifies.
//!
//! Under the extended law only: there the bounds of `[reference_bounds]` are those of streams, and what is known
//! beforehand is judged as it is ([`controller_core::certificate::path`]). A path that is k times as slow has its n-th
//! derivative divided by k^n.

use crate::file::Scenario;
use crate::judge::judge;
use crate::path::Place;
use crate::reference::ReferenceKind;
use controller_core::certificate::path::along::MaxShare;
use controller_core::certificate::path::{PathJudge, PathRow};
use controller_core::heading::Heading;
use controller_core::reference::harmonic::HarmonicParameters;
use controller_core::reference::{Reference, ReferenceBounds, Trajectory};
use std::f64::consts::TAU;
use std::fmt;

/// The greatest stretch that is looked for, how finely it and the force are looked for.
const STRETCH_MAX: f64 = 50.0;
const HALVINGS_MAX: u32 = 12;

/// How far, relative, frequencies may be from multiples of the lowest one.
const FREQUENCY_TOLERANCE_SHARE: f64 = 1e-9;

/// What a scenario's reference takes of what its vehicle leaves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Along {
    /// The most that it takes.
    pub taken: MaxShare,
    /// Where.
    pub at: Place,
    /// Until when it was judged, microseconds.
    pub end_us: u64,
    /// The force per mass that is kept free beside it, m/s^2.
    pub force_kept: f32,
    /// How it would certify; none if it does.
    pub remedy: Option<Remedy>,
}

/// The changes with which a reference certifies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Remedy {
    /// So many times as slowly; none where it does not even at rest.
    pub slower: Option<f64>,
    /// With so little force kept free, m/s^2; none where it does not with any.
    pub force_kept: Option<f32>,
}

impl Along {
    /// Of the reference of `scenario`; none under the paper's law.
    #[must_use]
    pub fn judge(scenario: &Scenario) -> Option<Self> {
        let judge = |force: f32| judge::<f64>(&scenario.configuration, force);
        let own = judge(scenario.force_kept)?;
        let end = end_us(scenario);
        let along = |judge: &PathJudge, slower: f64| {
            MaxShare::along(
                judge,
                &Slower { trajectory: &*scenario.trajectory, factor: slower },
                (end as f64 * slower) as u64,
            )
        };
        let taken = MaxShare::along(&own, &*scenario.trajectory, end);
        let position = scenario.trajectory.at(taken.at_us).position.map(f64::from);
        let at = Place { position, time: taken.at_us as f64 * 1e-6 };
        let remedy = (taken.share >= 1.0).then(|| {
            let slow_enough = |slower: f64| along(&own, slower).share < 1.0;
            let slower = least(1.0, STRETCH_MAX, slow_enough).map(|slower| (slower * 100.0).ceil() / 100.0);
            let light_enough = |less: f64| {
                judge(scenario.force_kept - less as f32).is_some_and(|judge| along(&judge, 1.0).share < 1.0)
            };
            let less = least(0.0, f64::from(scenario.force_kept), light_enough);
            Remedy { slower, force_kept: less.map(|less| scenario.force_kept - less as f32) }
        });
        Some(Self { taken, at, end_us: end, force_kept: scenario.force_kept, remedy })
    }

    /// Whether nothing is limited along it.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.taken.share < 1.0
    }
}

/// The least number from one that is not `enough` to one that may be; none where `most` is not.
fn least(few: f64, most: f64, enough: impl Fn(f64) -> bool) -> Option<f64> {
    if !enough(most) {
        return None;
    }
    let (mut fails, mut holds) = (few, most);
    for _ in 0..HALVINGS_MAX {
        let middle = if few > 0.0 { (fails * holds).sqrt() } else { 0.5 * (fails + holds) };
        if enough(middle) { holds = middle } else { fails = middle }
    }
    Some(holds)
}

/// Until when a reference is judged, microseconds: to its end, over one period, or as long as the flight.
#[must_use]
pub fn end_us(scenario: &Scenario) -> u64 {
    let flight = || scenario.timing.ticks * scenario.timing.period_us;
    match &scenario.reference {
        ReferenceKind::Hover { .. } => 0,
        ReferenceKind::Route(route) => (route.duration() * 1e6).round() as u64,
        ReferenceKind::Harmonic(harmonic) => {
            common_period(harmonic).map_or_else(flight, |period| (period * 1e6).ceil() as u64)
        }
    }
}

/// After how long a harmonic motion repeats, s, if its frequencies are multiples of the lowest one; zero at rest.
fn common_period(harmonic: &HarmonicParameters) -> Option<f64> {
    let HarmonicParameters { amplitude, frequency, heading, .. } = harmonic;
    let axes = amplitude.iter().zip(frequency).chain([(&heading.amplitude, &heading.frequency)]);
    let moving: Vec<f64> = axes.filter(|(size, rate)| **size * **rate != 0.0).map(|(_, rate)| rate.abs()).collect();
    let Some(lowest) = moving.iter().copied().reduce(f64::min) else { return Some(0.0) };
    let is_multiple = |rate: &f64| ((rate / lowest).round() / (rate / lowest) - 1.0).abs() < FREQUENCY_TOLERANCE_SHARE;
    moving.iter().all(is_multiple).then_some(TAU / lowest)
}

/// A trajectory that is flown more slowly by a factor.
struct Slower<'a> {
    trajectory: &'a dyn Trajectory,
    factor: f64,
}

impl Slower<'_> {
    fn time(&self, time_us: u64) -> u64 {
        (time_us as f64 / self.factor).round() as u64
    }
}

impl Trajectory for Slower<'_> {
    fn at(&self, time_us: u64) -> Reference {
        let Reference { position, velocity, acceleration, jerk, snap, heading } =
            self.trajectory.at(self.time(time_us));
        let k = (1.0 / self.factor) as f32;
        Reference {
            position,
            velocity: velocity * k,
            acceleration: acceleration * (k * k),
            jerk: jerk * (k * k * k),
            snap: snap * (k * k * k * k),
            heading: Heading::new(heading.direction(), heading.rate() * k, heading.acceleration() * (k * k))
                .unwrap_or(heading),
        }
    }

    fn bounds(&self) -> ReferenceBounds {
        crate::trajectory::stretch::stretched(&self.trajectory.bounds(), self.factor)
    }

    fn fifth_derivative(&self, from_us: u64, to_us: u64) -> f64 {
        self.trajectory.fifth_derivative(self.time(from_us), self.time(to_us)) / self.factor.powi(5)
    }
}

/// What a row is about.
#[must_use]
pub fn name(row: PathRow) -> &'static str {
    match row {
        PathRow::Fall => "its fall",
        PathRow::Thrust => "thrust",
        PathRow::TurningRate => "the rate of turning",
        PathRow::Torque => "torque",
        PathRow::Floor => "the thrust that torque needs",
        PathRow::Cone => "tilt",
    }
}

impl fmt::Display for Along {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { taken: MaxShare { share, row, .. }, at, force_kept, remedy, .. } = self;
        write!(
            f,
            "reference, {}: takes {:.1} % of what is left beside a force of {force_kept} m/s^2, ",
            name(*row),
            100.0 * share
        )?;
        write!(f, "most at {at}")?;
        let Some(Remedy { slower, force_kept }) = remedy else { return Ok(()) };
        if let Some(slower) = slower {
            write!(f, "; {slower:.2} times as slowly it certifies")?;
        }
        if let Some(force) = force_kept {
            let down = (force * 100.0).floor() / 100.0;
            write!(
                f,
                "{} with reference.force_kept = {down}",
                if slower.is_some() { ", or" } else { "; it certifies" }
            )?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
