//! The chain from setpoints to rotor thrusts, of a configuration that is certified: governor, law, allocation.
//!
//! `taking_over` brings a flight to rest, or takes it up, from the vehicle's motion; `without_pose` levels and goes
//! down; `delivered` estimates delivered over commanded thrust; `levelling` says
//! what the law would do about a lean on the bench.
//!
//! Starting on the ground, braking and a jump of the estimate all start the governor at a steady velocity, with the
//! heading at rest: nothing to fade out, so no bridge is needed, and such a start fits in a tick.

use super::braking::Braking;
use super::lift_off::LiftOff;
use super::policy::{Aboard, Handover};
use super::refusal::Grounded;
use super::rules::REFUSAL_MAX_US;
use super::sinking::Sinking;
use super::spool::Spool;
use controller_core::allocation::remaining::LostRotor;
use controller_core::allocation::{Mixer, Thrusts};
use controller_core::certificate::certified::Certified;
use controller_core::error::InputError;
use controller_core::extended::measured::Measured;
use controller_core::governor::{self, FollowingReport, Governor, GovernorLimits, HeadingSetpoint, Motion, Setpoint};
use controller_core::heading::Heading;
use controller_core::law::Command;
use controller_core::law::Law;
use controller_core::reference::Reference;
use controller_core::state::{State, Wrench};
use nalgebra::Vector3;

/// The horizontal speed at which a vehicle may go down.
const REST_SPEED_MAX_M_PER_S: f32 = 0.05;

/// Where a take-off is over: the reference's distance from the height, and its speed.
const TAKEN_OFF_DISTANCE_MAX_M: f32 = 0.01;
const TAKEN_OFF_SPEED_MAX_M_PER_S: f32 = 0.01;

/// Where a chain's governor and mixer lie, 9 KB and 6 KB. Its user makes it, where it stays.
#[derive(Debug, Clone, PartialEq)]
pub struct Memory {
    governor: governor::Memory,
    mixer: Mixer,
}

impl Memory {
    /// For any chain. All zeros: a static one takes no flash.
    pub const EMPTY: Self = Self { governor: governor::Memory::EMPTY, mixer: Mixer::NONE };
}

/// A tick of the law: its inputs and its output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flown {
    /// The state: estimated, or (levelling) on the reference with the estimated attitude.
    pub state: State,
    /// The reference.
    pub reference: Reference,
    /// The wrench that the law commands.
    pub wrench: Wrench,
    /// p~, m, world.
    pub position_error: Vector3<f32>,
    /// theta~, the modified Rodrigues parameters of the attitude error.
    pub mrp: Vector3<f32>,
    /// The thrust scale: delivered over commanded thrust, estimated; 1 without an estimate.
    pub thrust_scale: f32,
}

/// Governor, law and mixer, with what they hand from tick to tick.
#[derive(Debug, PartialEq)]
pub(super) struct Chain<'m> {
    governor: &'m mut Governor,
    law: Law,
    mixer: &'m mut Mixer,
    rotors: usize,
    /// The maximum horizontal speed of a reference, m/s.
    speed: f32,
    braking: Braking,
    /// The vehicle's mass, kg, and gravity, m/s^2.
    mass: f32,
    gravity: f32,
    /// The time between ticks, s.
    period: f32,
    /// The height of the take-off, m, world, and above where it began.
    rising_to: f32,
    rising_by: f32,
    /// The last tick's.
    reference: Reference,
    thrusts: Option<Thrusts>,
    flown: Option<Flown>,
    /// Whether the rotors deliver the commanded wrench.
    is_exact: bool,
    spool: Spool,
    sinking: Sinking,
    /// The time between ticks, and that for which ticks in a row have brought no new thrusts, us.
    tick: u64,
    refused: u64,
    lift_off: LiftOff,
    /// The rotor that was found to fail, in this flight or one before.
    lost: Option<LostRotor>,
    /// The wrench by the rotors' speeds at the last tick, and its mean since the one before.
    turned: Option<Wrench>,
    turned_mean: Option<Wrench>,
}

/// What `make` makes, moved in one piece: inlined, each of its fields would be moved for itself.
#[inline(never)]
fn apart<T>(make: impl FnOnce() -> T) -> T {
    make()
}

/// A reference at rest.
fn resting(position: &Vector3<f32>, heading: &Heading) -> Reference {
    Reference::resting(*position, heading.at_rest())
}

impl<'m> Chain<'m> {
    pub fn new(
        certified: &Certified,
        limits: &GovernorLimits,
        tick: u64,
        memory: &'m mut Memory,
    ) -> Result<Self, Grounded> {
        let period = tick as f32 * 1e-6;
        let configuration = certified.configuration();
        let rotors = configuration.rotors().ok_or(Grounded::NoRotors)?;
        let vehicle = configuration.vehicle();
        let Memory { governor, mixer } = memory;
        mixer.prepare(rotors);
        Ok(Self {
            governor: Governor::new(configuration.bounds(), limits, period, governor)?,
            law: apart(|| Law::new(certified, period))?,
            mixer,
            rotors: rotors.len(),
            speed: configuration.bounds().horizontal_speed,
            braking: Braking::within(configuration.bounds()),
            mass: vehicle.mass,
            gravity: vehicle.gravity,
            period,
            rising_to: 0.0,
            rising_by: 0.0,
            reference: resting(&Vector3::zeros(), &Heading::FORWARD),
            thrusts: None,
            flown: None,
            is_exact: true,
            spool: Spool::new(rotors.iter().map(|rotor| rotor.thrust_min).collect(), tick),
            sinking: Sinking::default(),
            tick,
            refused: 0,
            lift_off: LiftOff::DONE,
            lost: None,
            turned: None,
            turned_mean: None,
        })
    }

    /// How many rotors there are.
    pub fn rotors(&self) -> usize {
        self.rotors
    }

    /// Starts a flight where the vehicle stands: the reference at `position`, at rest; the law reset.
    ///
    /// # Errors
    /// The governor's; it goes on as before then.
    pub fn start(&mut self, position: &Vector3<f32>, heading: &Heading) -> Result<(), InputError> {
        self.governor.start(position, &Vector3::zeros(), heading)?;
        self.braking.end();
        self.law.reset();
        self.reference = resting(position, heading);
        self.thrusts = None;
        self.flown = None;
        self.is_exact = true;
        self.spool.restart();
        self.refused = 0;
        self.lift_off = LiftOff::from(position);
        Ok(())
    }

    /// Takes off to `height`, m, above the present place.
    ///
    /// # Errors
    /// Names the field the governor refuses.
    pub fn rise(&mut self, height: f32) -> Result<(), &'static str> {
        (self.rising_to, self.rising_by) = (self.reference.position.z + height, height);
        self.rise_on()
    }

    /// Whether it makes for a place `height` above the one that it was at, m, to the millimetre.
    pub fn takes_off_to(&self, height: f32) -> bool {
        (self.rising_by - height).abs() < 1e-3
    }

    fn rise_on(&mut self) -> Result<(), &'static str> {
        let mut position = self.reference.position;
        position.z = self.rising_to;
        self.accept(&Setpoint { motion: Motion::Position(position), turn: HeadingSetpoint::Keep }, 0.0)
    }

    /// Whether the reference has come to rest at the height of the take-off.
    pub fn has_risen(&self) -> bool {
        let Reference { position, velocity, .. } = &self.reference;
        (position.z - self.rising_to).abs() < TAKEN_OFF_DISTANCE_MAX_M
            && velocity.norm_squared() < TAKEN_OFF_SPEED_MAX_M_PER_S * TAKEN_OFF_SPEED_MAX_M_PER_S
    }

    /// Comes to rest across, but no longer than it `may_brake`, then goes down at `speed`, m/s; to be called each tick.
    /// Both at once would brake as slowly as the vertical bounds have it.
    pub fn descend(&mut self, speed: f32, may_brake: bool) {
        if may_brake && self.reference.velocity.xy().norm_squared() > REST_SPEED_MAX_M_PER_S * REST_SPEED_MAX_M_PER_S {
            return self.governor.stop();
        }
        let motion = Motion::Velocity(Vector3::new(0.0, 0.0, -speed));
        // A number within its range, as the settings have it; refused, the reference stops.
        let _ = self.governor.accept(&Setpoint { motion, turn: HeadingSetpoint::Keep });
    }

    /// Takes a setpoint that was true `late` seconds ago.
    ///
    /// # Errors
    /// Names the field the governor refuses.
    pub fn accept(&mut self, setpoint: &Setpoint, late: f32) -> Result<(), &'static str> {
        self.governor.accept_late(setpoint, late).map_err(|error| error.field())
    }

    /// How the stream that is sent is followed, if there is one.
    pub fn following(&self) -> Option<FollowingReport> {
        self.governor.following()
    }

    /// Whether the last thrusts have been held for long enough.
    pub fn is_refused(&self) -> bool {
        self.refused >= REFUSAL_MAX_US
    }

    /// Takes the rotors' speeds at this tick, rad/s: their mean wrench since the last one, for the law.
    pub fn take_speeds(&mut self, speeds: Option<&[Option<f32>]>) {
        let now = speeds.and_then(|speeds| self.law.wrench_at(speeds));
        let before = core::mem::replace(&mut self.turned, now);
        self.turned_mean = now.zip(before).map(|(now, before)| Wrench {
            thrust: 0.5 * (now.thrust + before.thrust),
            torque: (now.torque + before.torque) * 0.5,
        });
    }

    /// Takes the mean acceleration since the last tick, m/s^2, world, for the tick to come, with what the rotors'
    /// speeds have made, and the rotor that they show to fail.
    pub fn take_measured(&mut self, acceleration: Option<Vector3<f32>>, lost: Option<LostRotor>) {
        self.law.measured(&Measured { acceleration, wrench: self.turned_mean, lost });
    }

    /// One tick on the governor's reference.
    ///
    /// # Errors
    /// What the law or the allocation cannot use.
    pub fn fly(&mut self, state: &State) -> Result<Flown, InputError> {
        if self.spool.is_over() {
            self.reference = self.braking.advance(self.governor.tick(), self.period);
        }
        if self.lift_off.stands(state) {
            self.law.hold_estimates();
        }
        self.step(state)
    }

    /// One tick on what a policy aboard demands; who flies, if that is new.
    ///
    /// # Errors
    /// As [`Self::fly`].
    pub fn fly_policy(
        &mut self,
        policy: &mut impl Aboard,
        state: &State,
        handover: &mut Option<Handover>,
    ) -> Result<Flown, InputError> {
        self.step_with(state, |law, reference| {
            let shielded = policy.fly(law, state)?;
            (*reference, *handover) = (shielded.reference, shielded.handover);
            Ok(shielded.command)
        })
    }

    fn step(&mut self, state: &State) -> Result<Flown, InputError> {
        self.step_with(state, |law, reference| law.command(state, reference))
    }

    #[inline(always)] // without a policy there is one caller
    fn step_with(
        &mut self,
        state: &State,
        step: impl FnOnce(&mut Law, &mut Reference) -> Result<Command, InputError>,
    ) -> Result<Flown, InputError> {
        self.refused = self.refused.saturating_add(self.tick);
        let flown = self.command(state, step);
        if flown.is_err() {
            // The rotors keep their last thrusts for a tick that the law does not see.
            self.law.hold_estimates();
        }
        flown
    }

    #[inline(always)]
    fn command(
        &mut self,
        state: &State,
        step: impl FnOnce(&mut Law, &mut Reference) -> Result<Command, InputError>,
    ) -> Result<Flown, InputError> {
        let Command { wrench, mrp } = step(&mut self.law, &mut self.reference)?;
        let position_error = state.position - self.reference.position;
        let scale = self.law.thrust_scale();
        let (wrench, thrusts) = match (self.law.commands(), self.law.delivered()) {
            (Some(commands), Some(delivered)) => {
                self.is_exact = true;
                (*delivered, commands.clone())
            }
            _ => {
                let allocation = self.mixer.allocate(&wrench.scaled(1.0 / scale))?;
                self.is_exact = allocation.is_exact();
                (wrench, allocation.thrusts)
            }
        };
        if !self.is_exact {
            self.law.hold_estimates();
        }
        self.lost = self.law.lost().or(self.lost);
        self.refused = 0;
        self.thrusts = Some(self.spool.advance(thrusts));
        let flown =
            Flown { state: *state, reference: self.reference, wrench, position_error, mrp, thrust_scale: scale };
        self.flown = Some(flown);
        Ok(flown)
    }

    /// What was flown last; none before the first tick.
    pub fn flown(&self) -> Option<&Flown> {
        self.flown.as_ref()
    }

    /// Whether the rotors delivered the last commanded wrench.
    pub fn is_exact(&self) -> bool {
        self.is_exact
    }

    /// The rotor that was found to fail since the boot.
    pub fn lost(&self) -> Option<LostRotor> {
        self.lost
    }

    /// Whether the reference rests.
    pub fn rests(&self) -> bool {
        self.reference.velocity.norm_squared() < REST_SPEED_MAX_M_PER_S * REST_SPEED_MAX_M_PER_S
    }

    /// Whether the vehicle still stands where it started.
    pub fn is_standing(&self) -> bool {
        self.lift_off.is_standing()
    }

    /// Where the reference is.
    pub fn reference(&self) -> &Reference {
        &self.reference
    }

    /// This tick's thrusts, N, in the rotors' order; the last ones if it was refused, none before the first.
    pub fn thrusts(&self) -> Option<&Thrusts> {
        self.thrusts.as_ref()
    }
}

mod delivered;
mod levelling;
mod taking_over;
#[cfg(test)]
mod tests;
mod without_pose;
