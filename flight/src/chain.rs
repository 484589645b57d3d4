//! The chain from setpoints to rotor thrusts, of a configuration that is certified: governor, law, allocation.
//!
//! **Why levelling is within the certificate.** The certificate bounds thrust and torque for every state of the vehicle
//! and every reference inside Omega_r, as long as the filters started at zero: it follows what the filters can reach,
//! and takes the errors of position, velocity and attitude at their worst. So after a reset any state may follow, and
//! the reference may jump, as it does here from one in motion to a hover. On entry the law is reset. From then on its
//! position input is the reference, at rest across; the attitude law is the proven one, about the last heading. The
//! vertical speed is the accelerometer's, summed up since the pose was lost, and is brought to zero and then to that of
//! the descent; its lag behind the descent is summed up as well, so that the vehicle sinks in an updraft too. The
//! extended law keeps what it knows of the vehicle, its torque bias, its thrust scale and the vertical force, and
//! learns nothing meanwhile.
//!
//! Starting on the ground, finding the pose again and a jump of the estimate all start the governor at a steady
//! velocity, with the heading at rest: nothing to fade out, so no bridge is needed, and such a start fits in a tick.

use super::lift_off::LiftOff;
use super::refusal::Grounded;
use super::rules::{Mode, REFUSALS_MAX};
use super::sinking::Sinking;
use super::spool::Spool;
use super::tilt::{heading, up};
use controller_core::allocation::{Mixer, Thrusts};
use controller_core::certificate::certified::Certified;
use controller_core::error::InputError;
use controller_core::governor::{self, Governor, GovernorLimits, Motion, Setpoint, Turn};
use controller_core::heading::Heading;
use controller_core::law::Command;
use controller_core::law::Law;
use controller_core::reference::Reference;
use controller_core::state::{State, Wrench};
use estimation::estimator::EstimatedState;
use nalgebra::{UnitQuaternion, Vector2, Vector3};

/// The speed across at which a vehicle may go down, m/s.
const AT_REST: f32 = 0.05;

/// The speed, m/s, at which a vehicle hardly sinks: less than a landing's.
const HARDLY: f32 = 0.3;

/// How near the height of its take-off the reference has to be, m, and how slow, m/s.
const RISEN: (f32, f32) = (0.01, 0.01);

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

/// What the law was given in a tick and what it made of it.
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
    /// The greatest horizontal speed of a reference, m/s, and its greatest vertical acceleration, m/s^2.
    speed: f32,
    brakes: f32,
    /// The vehicle's mass, kg, and gravity, m/s^2.
    mass: f32,
    gravity: f32,
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
    /// Ticks in a row without new thrusts.
    refusals: u32,
    lift_off: LiftOff,
}

/// What `make` makes, moved in one piece: inlined, each of its fields would be moved for itself.
#[inline(never)]
fn apart<T>(make: impl FnOnce() -> T) -> T {
    make()
}

/// A reference at rest.
fn resting(position: &Vector3<f32>, heading: &Heading) -> Reference {
    let zero = Vector3::zeros();
    let position = *position;
    Reference { position, velocity: zero, acceleration: zero, jerk: zero, snap: zero, heading: heading.at_rest() }
}

/// `velocity` with its horizontal part at most `speed` long.
fn slowed(velocity: &Vector3<f32>, speed: f32) -> Vector3<f32> {
    let across: Vector2<f32> = velocity.xy();
    let share = (speed / across.norm().max(speed)).min(1.0);
    Vector3::new(across.x * share, across.y * share, velocity.z)
}

impl<'m> Chain<'m> {
    pub fn new(
        certified: &Certified,
        limits: &GovernorLimits,
        period: f32,
        memory: &'m mut Memory,
    ) -> Result<Self, Grounded> {
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
            brakes: configuration.bounds().vertical_acceleration,
            mass: vehicle.mass,
            gravity: vehicle.gravity,
            period,
            rising_to: 0.0,
            rising_by: 0.0,
            reference: resting(&Vector3::zeros(), &Heading::FORWARD),
            thrusts: None,
            flown: None,
            is_exact: true,
            spool: Spool::new(rotors.iter().map(|rotor| rotor.thrust_min).collect()),
            sinking: Sinking::default(),
            refusals: 0,
            lift_off: LiftOff::DONE,
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
        self.law.reset();
        self.reference = resting(position, heading);
        self.thrusts = None;
        self.flown = None;
        self.is_exact = true;
        self.spool.restart();
        self.refusals = 0;
        self.lift_off = LiftOff::from(position);
        Ok(())
    }

    /// Makes for a place `height` above the one it is at, m.
    ///
    /// # Errors
    /// Names the field the governor refuses.
    pub fn rise(&mut self, height: f32) -> Result<(), &'static str> {
        (self.rising_to, self.rising_by) = (self.reference.position.z + height, height);
        self.rise_on()
    }

    /// Whether it makes for a place `height` above the one that it was at, m, to the millimetre.
    pub fn rises(&self, height: f32) -> bool {
        (self.rising_by - height).abs() < 1e-3
    }

    fn rise_on(&mut self) -> Result<(), &'static str> {
        let mut position = self.reference.position;
        position.z = self.rising_to;
        self.accept(&Setpoint { motion: Motion::Position(position), turn: Turn::Keep })
    }

    /// Whether the reference has come to rest at the height of the take-off.
    pub fn has_risen(&self) -> bool {
        let (near, slow) = RISEN;
        let Reference { position, velocity, .. } = &self.reference;
        (position.z - self.rising_to).abs() < near && velocity.norm_squared() < slow * slow
    }

    /// Comes to rest across, but no longer than it `may_brake`, then goes down at `speed`, m/s; to be said again each
    /// tick. Both at once would brake as slowly as the vertical bounds have it.
    pub fn come_down(&mut self, speed: f32, may_brake: bool) {
        if may_brake && self.reference.velocity.xy().norm_squared() > AT_REST * AT_REST {
            return self.governor.stop();
        }
        let motion = Motion::Velocity(Vector3::new(0.0, 0.0, -speed));
        // A number within its range, as the settings have it; refused, the reference stops.
        let _ = self.governor.accept(&Setpoint { motion, turn: Turn::Keep });
    }

    /// Turns to levelling: a hover at the last heading, the law restarted, at the vertical speed `sinking`, m/s, or at
    /// the reference's if it is not known. Poses that have `lied` leave more to be made up for.
    pub fn level(&mut self, sinking: Option<f32>, lied: bool) {
        let sinking = sinking.unwrap_or(self.reference.velocity.z);
        self.reference = resting(&self.reference.position, &self.reference.heading);
        self.sinking = Sinking::at(sinking, lied);
        self.law.restart();
    }

    /// Takes a flight up again where the vehicle is found, at its velocity as far as references may be as fast, with
    /// the heading that was held; then brakes to a stop. The law needs no restart: levelling has left its filters at
    /// zero.
    ///
    /// # Errors
    /// As [`Self::start`].
    pub fn regain(&mut self, state: &State) -> Result<(), InputError> {
        let velocity = slowed(&state.velocity, self.speed);
        self.governor.start(&state.position, &velocity, &self.reference.heading)?;
        if !self.spool.is_over() {
            // The governor's reference is not flown yet: this one waits at rest for the rotors, where the vehicle is.
            self.reference = resting(&state.position, &self.reference.heading);
        }
        Ok(())
    }

    /// Whether a reference that moves like `state` comes to rest within `height`, m, below it; one that hardly sinks
    /// does, wherever the ground is.
    pub fn stops_within(&self, height: f32, state: &State) -> bool {
        let down = state.velocity.z.min(0.0);
        down > -HARDLY || down * down < 2.0 * self.brakes * height
    }

    /// Goes along where the estimate has jumped to `state`: as [`Self::regain`], but with the vehicle's heading, which
    /// may have jumped too. The reference of a take-off goes as far up as the vehicle jumped; that of a landing stays
    /// as far below the vehicle as it was, and does not rise. Nothing is learnt from the jump. The certificate covers
    /// it as it covers any other jump of the reference.
    ///
    /// # Errors
    /// Names the field the governor refuses.
    pub fn jump(&mut self, before: &State, state: &State, mode: Mode) -> Result<(), &'static str> {
        if let Some(heading) = heading(&state.attitude) {
            self.reference.heading = heading;
        }
        self.law.hold_estimates();
        self.lift_off.displace(&state.position);
        let mut from = *state;
        if mode == Mode::Landing {
            from.position.z += (self.reference.position.z - before.position.z).min(0.0);
            from.velocity.z = self.reference.velocity.z.min(0.0);
        }
        self.regain(&from).map_err(|error| error.field())?;
        if mode == Mode::TakingOff {
            self.reference.position = state.position;
            self.rising_to += state.position.z - before.position.z;
            self.rise_on()?;
        }
        Ok(())
    }

    /// Brings the reference to rest.
    pub fn hold(&mut self) {
        self.governor.stop();
    }

    /// Takes a setpoint.
    ///
    /// # Errors
    /// Names the field the governor refuses.
    pub fn accept(&mut self, setpoint: &Setpoint) -> Result<(), &'static str> {
        self.governor.accept(setpoint).map_err(|error| error.field())
    }

    /// Whether the last thrusts have been held for long enough.
    pub fn is_refused(&self) -> bool {
        self.refusals >= REFUSALS_MAX
    }

    /// One tick on the governor's reference.
    ///
    /// # Errors
    /// What the law or the allocation cannot use.
    pub fn fly(&mut self, state: &State) -> Result<Flown, InputError> {
        if self.spool.is_over() {
            self.reference = self.governor.tick();
        }
        if self.lift_off.stands(state) {
            self.law.hold_estimates();
        }
        self.step(state)
    }

    /// One tick of levelling, after [`Self::level`], or of going down.
    ///
    /// # Errors
    /// As [`Self::fly`].
    pub fn fly_level(&mut self, estimated: &EstimatedState, descends: bool) -> Result<Flown, InputError> {
        let State { attitude, angular_velocity, .. } = estimated.state;
        let velocity = Vector3::new(0.0, 0.0, self.sinking.advance(estimated, self.period));
        self.reference.velocity.z = if descends { -self.sinking.descent() } else { 0.0 };
        let mut position = self.reference.position;
        position.z += self.sinking.behind(self.reference.velocity.z, self.period);
        // Without a pose there is nothing to learn from.
        self.law.hold_estimates();
        self.step(&State { position, velocity, attitude, angular_velocity })
    }

    fn step(&mut self, state: &State) -> Result<Flown, InputError> {
        self.refusals = self.refusals.saturating_add(1);
        let flown = self.command(state);
        if flown.is_err() {
            // The rotors keep their last thrusts for a tick that the law knows nothing of.
            self.law.hold_estimates();
        }
        flown
    }

    fn command(&mut self, state: &State) -> Result<Flown, InputError> {
        let Command { wrench, mrp } = self.law.command(state, &self.reference)?;
        let position_error = state.position - self.reference.position;
        let scale = self.law.thrust_scale();
        let allocation = self.mixer.allocate(&wrench.scaled(1.0 / scale))?;
        self.is_exact = allocation.is_exact();
        if !self.is_exact {
            self.law.hold_estimates();
        }
        self.refusals = 0;
        self.thrusts = Some(self.spool.advance(allocation.thrusts));
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

    /// Whether the vehicle still stands where it started.
    pub fn is_standing(&self) -> bool {
        self.lift_off.is_standing()
    }

    /// Where the reference is.
    pub fn reference(&self) -> &Reference {
        &self.reference
    }

    /// Whether the vehicle has been levelled for a while, and goes down.
    pub fn sinks(&self) -> bool {
        self.reference.velocity.z < 0.0
    }

    /// Without a pose, the vehicle has met what stops it: it stands.
    pub fn stop_sinking(&mut self) {
        self.sinking.stop();
    }

    /// Whether the vehicle rises or sinks, without a pose, faster than an accelerometer's drift explains.
    pub fn moves(&self) -> bool {
        self.sinking.is_motion()
    }

    /// The law's estimate of the vertical force per mass, m/s^2: mostly a lack of thrust.
    fn vertical_force(&self) -> f32 {
        self.law.estimates().map_or(0.0, |estimates| estimates.force.z)
    }

    /// The rotors' thrust over the commanded thrust, by what the law has learnt in steady flight; 1 if it learns
    /// nothing.
    ///
    /// A hover commands (g - d_z) m / s and delivers m g. The thrust scale s alone says little: the vertical force d_z
    /// takes up a steady lack of thrust.
    pub fn delivered_share(&self) -> f32 {
        self.law.thrust_scale() * self.gravity / (self.gravity - self.vertical_force())
    }

    /// The acceleration that neither the commanded thrust nor the estimated force explains, m/s^2, world.
    pub fn unexpected(&self, flown: &Flown, estimated: &EstimatedState) -> Vector3<f32> {
        let attitude = UnitQuaternion::new_unchecked(flown.state.attitude);
        let asked = attitude * Vector3::z() * (flown.wrench.thrust / self.mass);
        estimated.acceleration + Vector3::z() * (self.gravity - self.vertical_force()) - asked
    }

    /// The vertical acceleration that a thrust means with the force that the law knows of, m/s^2.
    pub fn asked_acceleration(&self, flown: &Flown) -> f32 {
        flown.wrench.thrust / self.mass * up(&flown.state.attitude) - self.gravity + self.vertical_force()
    }

    /// This tick's thrusts, N, in the rotors' order; the last ones if it was refused, none before the first.
    pub fn thrusts(&self) -> Option<&Thrusts> {
        self.thrusts.as_ref()
    }
}

#[cfg(test)]
mod tests;
