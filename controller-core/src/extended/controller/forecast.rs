//! Where a vehicle would come to rest if the law took it now: what a monitor judges.
//!
//! Behind its three filters the position is z_1 low-passed: z_1 = (1 + s / k_f) (1 + s / k_s) (1 + s / k_d) p for a
//! force that is known. z_1' = z_2 and z_2' = ubar + D are a double integrator without any lag. A first-order low-pass
//! never leaves an interval that its input stays in and that it started in. So p stays in a box for good if it, the two
//! stages between and the whole way of z_1 to its stop are in that box. `docs/shield.md` has the proof and what it
//! takes: nothing limited, a constant force that is known, ideal actuators. The limit on turning is allowed for by a
//! time for which z_2 goes on as it is.

use super::{Controller, thrust_axis};
use crate::extended::direction_limiter::PUSH_ACROSS_MAX_M_PER_S2;
use crate::extended::estimates::held;
use crate::extended::memory::Estimates;
use crate::extended::position::FeedbackLimits;
use crate::heading::Heading;
use crate::math;
use crate::reference::Reference;
use crate::state::{State, Wrench};
use nalgebra::Vector3;

/// The part of the torque that feedback is taken to use while the frame turns.
const FEEDBACK_SHARE: f32 = 0.5;

/// What has flown the vehicle so far, which says where its thrust points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FlownBy {
    /// The law, or a demand to it: thrust points near its command, and turns with it.
    Law,
    /// Rotor speeds in the law's place, by this wrench from now on: thrust points where the vehicle does, and turns as
    /// that does. The law's command is that direction cut to the envelope, which may be far from it.
    Rotors(Wrench),
}

/// What is ahead of a vehicle. World frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StoppingForecast {
    /// z_1, m, for a reference at rest at the origin.
    pub z_1: Vector3<f32>,
    /// z_2, m/s, for a reference at rest.
    pub z_2: Vector3<f32>,
    /// p, the stages between it and z_1, and where z_1 would come to rest, with and without the acceleration of now for
    /// as long as turning takes, m.
    pub places: [Vector3<f32>; 5],
    /// The cosine of the angle from the thrust axis to where it is wanted.
    pub alignment: f32,
    /// Whether an estimate is held or at its level, or the force more than thrust holds, or a rotor has failed.
    pub doubtful: bool,
}

impl Controller {
    /// What is ahead of a vehicle in `state`, if it is stopped with levels of at most `most`. Its velocity may be
    /// `late`, s: the acceleration of now has then changed it for so long.
    pub fn stopping_forecast(&self, state: &State, most: &FeedbackLimits, by: FlownBy, late: f32) -> StoppingForecast {
        let Estimates { force, torque, scale } = self.estimates();
        let filters = &self.memory.filters;
        let max = self.ceiling.at(scale, &torque);
        let origin = Reference::resting(Vector3::zeros(), Heading::FORWARD);
        let errors = self.position.errors(state, &origin, filters, &force);
        let (z_1, z_2) = (errors.z_1, errors.z_2);
        let acceleration = filters.intermediate + force;
        let present = State { velocity: state.velocity + acceleration * late, ..*state };
        let present = self.position.errors(&present, &origin, filters, &force);
        let mut command = filters.command;
        command.z += self.vehicle.gravity;
        let magnitude = math::sqrt(command.norm_squared());

        let axis = thrust_axis(&state.attitude);
        // First it comes to rest, then it turns from rest to rest.
        let (pointing, turns) = match &by {
            FlownBy::Law => {
                let moving = self.position.rate(filters);
                (command, math::sqrt(moving.cross(&command).norm_squared()) / command.norm_squared())
            }
            FlownBy::Rotors(wrench) => {
                let sped_up = wrench.torque.xy().component_div(&self.vehicle.inertia.xy()) * self.acting();
                (axis, math::sqrt((state.angular_velocity.xy() + sped_up).norm_squared()))
            }
        };
        let reaction = self.reaction(&z_2, (&pointing, turns), &force, max, most);
        let went_on = z_1 + z_2 * reaction;
        let sped_up = match &by {
            FlownBy::Law => acceleration * reaction,
            // What it pushes beyond the law's own command while it acts, and the command for as long as turning takes.
            FlownBy::Rotors(wrench) => {
                let push = axis * (wrench.thrust / self.vehicle.mass) - command;
                push * self.acting() + acceleration * reaction
            }
        };
        let push_velocity = self.pushed(&command, max);
        let stop = |at: Vector3<f32>, speed: Vector3<f32>| {
            let levels = self.position.stopping_levels(&speed, &force, max, most);
            at + self.position.stopping_way(&speed, &levels)
        };
        let [first, second] = self.position.stages(state, filters, &force);
        StoppingForecast {
            z_1,
            z_2,
            places: [
                state.position,
                first,
                second,
                stop(went_on, z_2),
                stop(
                    present.z_1 + present.z_2 * reaction + sped_up * (0.5 * reaction),
                    present.z_2 + sped_up + push_velocity,
                ),
            ],
            alignment: axis.dot(&command) / magnitude,
            doubtful: self.memory.held > 0
                || self.memory.without_velocity > 0
                || self.spinning.is_some()
                || self.is_at_a_level()
                || !self.is_held(&force, max),
        }
    }

    /// For how long a wrench acts beyond the tick that ends it, and in that tick, s.
    fn acting(&self) -> f32 {
        self.late + self.period
    }

    /// The velocity that thrust makes across while the thrust direction lags, m/s: section 1's n* beside n.
    fn pushed(&self, command: &Vector3<f32>, max: f32) -> Vector3<f32> {
        let across = math::sqrt(command.xy().norm_squared());
        let most = math::min(PUSH_ACROSS_MAX_M_PER_S2, max * across / math::max(command.z, f32::MIN_POSITIVE));
        let speed = most * self.position.lag() / math::max(across, f32::MIN_POSITIVE);
        Vector3::new(command.x * speed, command.y * speed, 0.0)
    }

    /// How much longer than the filters the thrust direction takes from where it is `pointing`, in a turn of so many
    /// rad/s, to where stopping has it, s.
    fn reaction(
        &self,
        z_2: &Vector3<f32>,
        (pointing, turns): (&Vector3<f32>, f32),
        force: &Vector3<f32>,
        max: f32,
        most: &FeedbackLimits,
    ) -> f32 {
        let mut stopping = self.position.stopping(z_2, force, max, most);
        stopping.z += self.vehicle.gravity;
        let angle = angle(pointing, &stopping);
        let parameters = &self.law.parameters;
        let left = (1.0 - FEEDBACK_SHARE) * self.budget.radius(self.thrust_scale());
        let inertia = math::max(self.vehicle.inertia.x, self.vehicle.inertia.y);
        let acceleration = math::max(left / inertia, parameters.turn_reserve);
        let rate = parameters.turn_rate;
        let stops = turns / acceleration;
        let angle = angle + 0.5 * turns * stops;
        let turning = if angle * acceleration > rate * rate {
            angle / rate + rate / acceleration
        } else {
            2.0 * math::sqrt(angle / acceleration)
        };
        let turning = stops + turning;
        math::max(turning - self.position.lag(), 0.0) + self.acting()
    }

    /// Whether the thrust holds all of the force.
    fn is_held(&self, force: &Vector3<f32>, max: f32) -> bool {
        let weight = Vector3::new(0.0, 0.0, self.vehicle.gravity);
        held(force, &weight, max) == *force
    }

    /// Whether force or thrust scale would be beyond a level that is not zero.
    fn is_at_a_level(&self) -> bool {
        let p = &self.law.parameters;
        let (average, believed) = (self.memory.averages.force, self.estimates().force);
        let scale = self.memory.averages.scale.scale;
        let of_force = (p.force_across > 0.0 && average.xy() != believed.xy())
            || (p.force_up > 0.0 && average.z > believed.z)
            || (p.force_down > 0.0 && average.z < believed.z);
        let learns = p.scale_rate > 0.0 && p.scale_least < p.scale_greatest;
        of_force || (learns && !(p.scale_least < scale && scale < p.scale_greatest))
    }
}

/// The angle between two vectors, rad, to 0.01: twice the one with the tangent |a x b| / (|a| |b| + a . b).
fn angle(a: &Vector3<f32>, b: &Vector3<f32>) -> f32 {
    const QUARTER_TURN_RAD: f32 = core::f32::consts::FRAC_PI_2;
    let across = math::sqrt(a.cross(b).norm_squared());
    let along = math::sqrt(a.norm_squared() * b.norm_squared()) + a.dot(b);
    let tangent = across / math::max(along, f32::MIN_POSITIVE);
    let half = if tangent > 1.0 {
        QUARTER_TURN_RAD - tangent / (tangent * tangent + 0.28)
    } else {
        tangent / (1.0 + 0.28 * tangent * tangent)
    };
    2.0 * half
}
