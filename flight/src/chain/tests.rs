extern crate std;
use super::*;
use crate::PERIOD_US;
use crate::hummingbird;
use estimation::estimator::EstimatedState;
use nalgebra::Quaternion;
use std::boxed::Box;

pub(super) fn chain() -> Chain<'static> {
    let memory = Box::leak(Box::new(Memory::EMPTY));
    let mut chain = Chain::new(&hummingbird::certified(), &GovernorLimits::default(), PERIOD_US, memory).unwrap();
    chain.start(&Vector3::zeros(), &Heading::FORWARD).unwrap();
    chain
}

pub(super) fn at_rest() -> State {
    let (zero, attitude) = (Vector3::zeros(), Quaternion::new(1.0, 0.0, 0.0, 0.0));
    State { position: zero, velocity: zero, attitude, angular_velocity: zero }
}

#[test]
fn a_take_off_has_risen_where_its_reference_rests_at_its_height() {
    let mut chain = chain();
    chain.rise(1.5).unwrap();
    let mut still = 0;
    while !chain.has_risen() {
        let Reference { position, velocity, .. } = chain.fly(&at_rest()).unwrap().reference;
        still +=
            u32::from((position.z - 1.5).abs() < TAKEN_OFF_DISTANCE_MAX_M && velocity.z > TAKEN_OFF_SPEED_MAX_M_PER_S);
    }
    assert!(still > 0, "it never passes the last centimetre faster");
    assert!(
        (chain.reference().position.z - 1.5).abs() < TAKEN_OFF_DISTANCE_MAX_M
            && chain.reference().velocity.z <= TAKEN_OFF_SPEED_MAX_M_PER_S
    );
}

#[test]
fn only_what_points_up_of_a_thrust_carries() {
    let mut chain = chain();
    // 60 degrees: half of it.
    let tilted = State { attitude: Quaternion::new(0.75_f32.sqrt(), 0.5, 0.0, 0.0), ..at_rest() };
    let flown = chain.fly(&tilted).unwrap();
    let thrust = flown.wrench.thrust / 0.5;
    assert!((chain.commanded_acceleration(&flown) - (0.5 * thrust - 9.81)).abs() < 1e-4);
    // What the accelerometer says of it, and nothing else.
    let side = -thrust * 0.75_f32.sqrt();
    let acceleration = Vector3::new(0.0, side, 0.5 * thrust - 9.81);
    let unexpected = chain.unexpected(&flown, &EstimatedState { state: tilted, acceleration, jumps: 0, gained: 0.0 });
    assert!(unexpected.norm() < 1e-4, "{unexpected}");
}
