//! Flight without a pose.
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
use crate::sinking::Sinking;
use controller_core::error::InputError;
use controller_core::state::State;
use estimation::estimator::EstimatedState;
use nalgebra::Vector3;

impl Chain<'_> {
    /// Turns to levelling: a hover at the last heading, the law restarted, at the vertical speed `sinking`, m/s, or at
    /// the reference's if it is not known. Poses that have `lied` leave more to be made up for.
    pub fn level(&mut self, sinking: Option<f32>, lied: bool) {
        let sinking = sinking.unwrap_or(self.reference.velocity.z);
        self.reference = resting(&self.reference.position, &self.reference.heading);
        self.sinking = Sinking::at(sinking, lied);
        self.braking.end();
        self.law.restart();
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

    /// Whether the vehicle rises or sinks, without a pose, faster than an accelerometer's drift explains; or may, since
    /// its descent would not show: of one that is not known to have `touched` the ground.
    pub fn may_move(&self, touched: bool) -> bool {
        self.sinking.is_motion() || !touched && !self.sinking.shows()
    }
}
