//! The figures of one flight of a campaign, and their shares of the certified bounds.
//!
//! | figure | |
//! |---|---|
//! | height lost | start minus lowest height |
//! | rise | greatest height above the start and above the reference |
//! | settled | since when it has been within [`SETTLED_DISTANCE_M`] of its reference, off the ground, for good |
//! | attitude | since when its attitude, heading included, has been within [`MRP_TOLERANCE`] of the desired one for good ([`claimed_error`]) |
//! | heading | since when its heading has been within [`HEADING_TOLERANCE_RAD`] of the reference's for good |
//! | in time | whether all three were within the first [`REACHED_BY_SHARE`] of the flight, as a flight by itself claims |
//! | final error | distance from the reference at the last tick |
//! | least command | the least of any rotor, part of a full one ([`LeastCommand`]) |
//! | share | the greatest part of a certified bound that was used: 1 is all of it |
//!
//! The share of a thrust or a rotor is its command over the greatest that is proven: the least is a constant near
//! zero, which many a flight touches. That of a torque is |tau| over its bound. A command below a least counts as
//! beyond. Once the law has found a rotor to be lost, no bound is certified but each rotor's range: from then on a
//! command counts as beyond if it leaves that, and shares are not counted. Flights in which a rotor fails:
//! `super::rotor_loss`.

use super::rotor_loss::{BOUND_TOLERANCE, RotorLoss, is_within_ranges};
use crate::flight::claims::REACHED_BY_SHARE;
use crate::flight::extremes::{MRP_TOLERANCE, claimed_error, heading_is_followed};
use crate::flight::least_command::LeastCommand;
use crate::flight::{Brief, Flight};
use controller_core::allocation::geometry::ROTORS_MAX;
use controller_core::certificate::Certificate;
use controller_core::reference::ReferenceBounds;
use scenario::Scenario;
use scenario::rotor_loss::PLACE_HELD_DISTANCE_M;

/// A vehicle that stays nearer to its reference has settled.
pub const SETTLED_DISTANCE_M: f64 = 0.2;
/// How near to its heading a vehicle must stay.
pub const HEADING_TOLERANCE_RAD: f64 = 0.2;

/// The figures of one flight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outcome {
    /// Start minus lowest height, m.
    pub height_lost: f64,
    /// Greatest height above the start and the reference, m.
    pub rise: f64,
    /// Since when it has been near its reference, s; none if it was away at the end.
    pub settled: Option<f64>,
    /// Likewise near its attitude.
    pub attitude: Option<f64>,
    /// Likewise near its heading.
    pub heading: Option<f64>,
    /// Whether it was there in time to have recovered, and not only at the end.
    pub in_time: bool,
    /// Distance from the reference at the last tick, m.
    pub final_error: f64,
    /// Ticks with a command that a rotor could not follow.
    pub clipped: u64,
    /// Ticks with a thrust, torque or rotor command beyond its certified bound.
    pub beyond: u64,
    /// Greatest share of each certified bound that was used.
    pub shares: Shares,
    /// Least command of any rotor.
    pub least_command: LeastCommand,
    /// How often the law's fallback came.
    pub fallback: u64,
    /// A rotor that failed, or was taken to.
    pub rotor: RotorLoss,
    /// Ticks flown: fewer than the flight has where it could not go on.
    pub ticks: u64,
}

/// Greatest shares of certified bounds.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Shares {
    /// Of the greatest thrust.
    pub thrust: f64,
    /// Of the torque about each body axis.
    pub torque: [f64; 3],
    /// Of each rotor's greatest thrust; zero for rotors that are not there.
    pub rotors: [f64; ROTORS_MAX],
}

impl Shares {
    /// The greatest of all.
    pub fn greatest(&self) -> f64 {
        self.torque.iter().chain(&self.rotors).copied().fold(self.thrust, f64::max)
    }
}

impl Outcome {
    /// Flies a whole `flight` of `scenario`, whose commands `certificate` bounds. Of a flight that cannot be flown to
    /// its end, the height lost and the final error are infinite.
    pub fn judge(scenario: &Scenario, mut flight: Flight, certificate: &Certificate) -> Self {
        let start = scenario.initial.position.z;
        let mut outcome = Self {
            height_lost: 0.0,
            rise: f64::NEG_INFINITY,
            settled: Some(0.0),
            attitude: Some(0.0),
            heading: Some(0.0),
            in_time: false,
            final_error: 0.0,
            clipped: 0,
            beyond: 0,
            shares: Shares::default(),
            least_command: LeastCommand::before_flight(scenario),
            fallback: 0,
            rotor: RotorLoss::before_flight(scenario),
            ticks: 0,
        };
        let rotors = scenario.configuration.rotors();
        for _ in 0..scenario.timing.ticks {
            let Ok(tick) = flight.brief_tick() else {
                let lost = f64::INFINITY;
                let rotor = outcome.rotor.unfinished();
                let never = Self { settled: None, attitude: None, heading: None, rotor, ..outcome };
                return Self { height_lost: lost, final_error: lost, ..never };
            };
            outcome.observe(&tick, start, scenario.timing.period_us, scenario.configuration.bounds());
            let lost = flight.lost();
            outcome.rotor.observe(&tick, lost);
            let within = match lost {
                None => outcome.shares.take(&tick, certificate),
                Some(lost) => is_within_ranges(&tick, rotors, lost.rotor),
            };
            outcome.beyond += u64::from(!within);
        }
        outcome.fallback = flight.fallback_times().into();
        let duration = scenario.timing.duration();
        let end = (scenario.timing.ticks * scenario.timing.period_us) as f64 / 1e6;
        let reached =
            [outcome.settled, outcome.attitude, outcome.heading].map(|since| since.filter(|time| *time < end));
        let in_time = reached.iter().all(|since| in_time(*since, duration));
        let [settled, attitude, heading] = reached;
        Self { settled, attitude, heading, in_time, ..outcome }
    }

    fn observe(&mut self, tick: &Brief, start: f64, period_us: u64, bounds: &ReferenceBounds) {
        let (position, wanted) = (&tick.state.position, tick.reference.position.map(f64::from));
        self.height_lost = self.height_lost.max(start - position.z);
        self.rise = self.rise.max(position.z - start.max(wanted.z));
        self.clipped += u64::from(tick.clipped);
        self.least_command.observe(&tick.rotor_thrusts);
        self.final_error = (position - wanted).norm();
        self.ticks += 1;
        let next = Some((tick.time_us + period_us) as f64 / 1e6);
        if self.final_error > SETTLED_DISTANCE_M || tick.standing {
            self.settled = next;
        }
        if claimed_error(&tick.mrp, &tick.reference, bounds) > MRP_TOLERANCE {
            self.attitude = next;
        }
        let followed = heading_is_followed(&tick.reference, bounds);
        if followed && tick.state.heading_error(&tick.reference.heading) > HEADING_TOLERANCE_RAD {
            self.heading = next;
        }
    }

    /// Whether it recovered and tracks: it was flown to its end, and was near its reference, attitude and heading in
    /// time and for good; or, where a rotor failed, it ends within [`PLACE_HELD_DISTANCE_M`] of its reference.
    pub fn tracks(&self) -> bool {
        if self.rotor.failure.is_some() { self.final_error <= PLACE_HELD_DISTANCE_M } else { self.in_time }
    }

    /// Whether it tracks, and no command went beyond its bound.
    pub fn holds(&self) -> bool {
        self.tracks() && self.beyond == 0
    }
}

/// Whether a flight of `duration`, s, has settled in time.
pub fn in_time(settled: Option<f64>, duration: f64) -> bool {
    settled.is_some_and(|since| since <= REACHED_BY_SHARE * duration)
}

impl Shares {
    /// Takes a tick's commands into account; returns whether they are within their bounds.
    fn take(&mut self, tick: &Brief, certificate: &Certificate) -> bool {
        let (thrust, proven) = (f64::from(tick.wrench.thrust), certificate.thrust());
        let raised = 1.0 + BOUND_TOLERANCE;
        let mut within = (proven.min / raised..=proven.max * raised).contains(&thrust);
        self.thrust = self.thrust.max(thrust / proven.max);
        let bounds = certificate.torque();
        for (greatest, (torque, proven)) in self.torque.iter_mut().zip(tick.wrench.torque.iter().zip(bounds.iter())) {
            let torque = f64::from(torque.abs());
            *greatest = greatest.max(torque / proven);
            within &= torque <= proven * raised;
        }
        for (rotor, (greatest, commanded)) in self.rotors.iter_mut().zip(&tick.rotor_thrusts).enumerate() {
            let commanded = f64::from(*commanded);
            let Some(proven) = certificate.rotor(rotor) else {
                within = false;
                continue;
            };
            *greatest = greatest.max(commanded / proven.max);
            within &= (proven.min - BOUND_TOLERANCE..=proven.max * raised).contains(&commanded);
        }
        within
    }
}
