//! The tick on one page: from what was measured to what the motors do, in the order of the data.
//!
//! ```text
//! increments, poses -> estimate -> detected ----> conditions -> mode -> governor -> law -> allocation -> output
//!                        jump -> reference         ^                      ^
//! request ------------------> answer --------------'                      |
//! setpoint, or a mission's item ------------------------------------------ '
//! ```

use super::{Pilot, TickOutput};
use crate::chain::Chain;
use crate::estimate::Estimate;
use crate::exchange::{Inputs, Outcome};
use crate::policy::Aboard;
use crate::rules::Mode;

impl<P: Aboard> Pilot<'_, P> {
    /// One tick: what has arrived since the last, in; what the motors do until the next, out.
    pub fn tick(&mut self, inputs: &Inputs) -> Outcome {
        let (armed, airborne, given_up) = (self.mode.is_armed(), self.is_airborne(), self.trust.is_given_up());
        self.estimation.may_stand(!airborne || self.mode == Mode::Landing && self.detectors.has_touched());
        let estimate = self.estimation.tick(inputs, armed, airborne, given_up);
        self.decide(inputs, &estimate)
    }

    /// The tick on an estimate.
    pub(super) fn decide(&mut self, inputs: &Inputs, estimate: &Estimate) -> Outcome {
        let now = inputs.now;
        // Estimate.
        let followed = self.follow_jump(estimate);
        let detected = self.detect(inputs, estimate);
        let had_lost = self.has_lost_a_rotor();
        let rotors = self.check_rotors(inputs);
        self.judge_poses(estimate, &detected, now);
        // Setpoints and requests.
        self.keep_setpoint(inputs);
        self.expire_setpoints_request(inputs);
        let answer = inputs.request.map(|request| self.answer(request, inputs, estimate, &detected));
        let mission = self.fly_mission(inputs, estimate);
        let ready = self.mode.may_arm().then(|| self.may_arm(inputs, estimate).map(|_| ()));
        // The rules.
        let conditions = self.conditions_from_request(inputs, estimate, answer, mission);
        let conditions = self.add_flight_conditions(conditions, inputs, estimate, &detected);
        let conditions = self.add_check_conditions(conditions, estimate, followed, ready);
        let transition = self.change_mode(conditions, inputs, estimate, &detected);
        // Governor, law and allocation.
        let setpoint = self.fly_setpoint(inputs, estimate);
        let TickOutput { output, flown, handover } = self.output(estimate, detected.touched, rotors.lost, now);
        let lean = self.lean(inputs);
        let levelling = lean.as_ref().and_then(|lean| self.chain.as_mut().ok()?.levelling(lean));
        let doubtful_thrust = self.thrust_check.tick(self.delivered_share(&flown), now);
        let streamed = self.stream_check.tick(self.following(), now);
        Outcome {
            output,
            mode: self.mode,
            transition,
            answer,
            ready,
            home: self.home(estimate),
            is_airborne: self.is_airborne(),
            may_fall: self.fall.may_fall(),
            setpoint,
            setpoints_requested: self.mode == Mode::Flying && !self.mission.is_flown && !self.flies_policy
                || self.setpoints_requested_since.is_some(),
            mission: (self.mission.next, self.flies_mission()),
            mission_step: mission,
            estimated: estimate.state,
            lean,
            levelling,
            health: estimate.health,
            pose: estimate.pose,
            flown,
            doubtful_thrust,
            rotor_fault: rotors.report,
            lost: if had_lost { None } else { self.chain.as_ref().ok().and_then(Chain::lost) },
            streamed,
            flies_policy: self.flies_policy,
            handover,
        }
    }
}
