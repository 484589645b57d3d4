use super::*;
use controller_core::governor::HeadingSetpoint;
use nalgebra::Vector3;

#[test]
fn a_moving_vehicle_times_out_and_a_resting_one_does_not() {
    let mut newest = NewestSetpoint::default();
    assert!(newest.has_ended(5) && newest.fresh(5).is_none());
    let zero = Vector3::zeros();
    let moving = Motion::PositionVelocityAcceleration { position: zero, velocity: zero, acceleration: zero };
    for (motion, ends) in [(Motion::Position(zero), false), (Motion::Velocity(zero), true), (moving, true)] {
        let setpoint = Setpoint { motion, turn: HeadingSetpoint::Keep };
        newest.keep(&setpoint, 7);
        assert_eq!(newest.fresh(6 + SETPOINT_AGE_MAX_US), Some(&setpoint));
        assert!(!newest.has_ended(6 + SETPOINT_AGE_MAX_US));
        assert_eq!((newest.fresh(7 + SETPOINT_AGE_MAX_US), newest.has_ended(7 + SETPOINT_AGE_MAX_US)), (None, ends));
    }
}
