//! Flight without a pose, and what becomes of the references when there is one again.
//!
//! **Why levelling is within the certificate.** The certificate bounds thrust and torque for every state of the vehicle
//! and every reference inside Omega_r, as long as the filters started at zero: it follows what the filters can reach,
//! and takes the errors of position, velocity and attitude at their worst. So after a reset any state may follow, and
//! the reference may jump, as it does here from one in motion to a hover. On entry the law is reset. From then on its
//! position input is the reference, at rest across; the attitude law is the proven one, about the last heading. The
//! vertical speed is the accelerometer's, summed up since the pose was lost, and is brought to zero and then to that of
//! the descent; its lag behind the descent is summed up as well, so that the vehicle sinks in an updraft too. The
//! extended law keeps what it knows of the vehicle, its torque bias, its thrust scale and the vertical force, and
//! learns the first alone meanwhile, for which rates are enough.

use super::{Chain, Flown, resting};
use crate::rules::Mode;
use crate::sinking::Sinking;
use crate::tilt::heading;
use controller_core::error::InputError;
use controller_core::state::State;
use estimation::estimator::EstimatedState;
use nalgebra::{Vector2, Vector3};

/// The speed, m/s, at which a vehicle hardly sinks: less than a landing's.
const HARDLY: f32 = 0.3;

/// `velocity` with its horizontal part at most `speed` long.
pub(super) fn slowed(velocity: &Vector3<f32>, speed: f32) -> Vector3<f32> {
    let across: Vector2<f32> = velocity.xy();
    let share = (speed / across.norm().max(speed)).min(1.0);
    Vector3::new(across.x * share, across.y * share, velocity.z)
}

impl Chain<'_> {
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
        // Without a pose only rates and what is felt teach anything.
        self.law.hold_without_velocity();
        self.step(&State { position, velocity, attitude, angular_velocity })
    }

    /// Whether the vehicle has been levelled for a while, and goes down.
    pub fn sinks(&self) -> bool {
        self.reference.velocity.z < 0.0
    }

    /// Without a pose, the vehicle was stopped: it stands.
    pub fn stop_sinking(&mut self) {
        self.sinking.stop();
    }

    /// Whether the vehicle rises or sinks, without a pose, faster than an accelerometer's drift explains.
    pub fn moves(&self) -> bool {
        self.sinking.is_motion()
    }
}
