use super::*;
use nalgebra::Quaternion;

fn at(height: f32, speed: f32) -> State {
    State {
        position: Vector3::new(3.0, 0.0, height),
        velocity: Vector3::new(speed, 0.0, 0.0),
        attitude: Quaternion::new(1.0, 0.0, 0.0, 0.0),
        angular_velocity: Vector3::zeros(),
    }
}

#[test]
fn it_stands_until_it_has_risen_or_moves_and_then_no_more() {
    for leaves in [at(7.06, 0.0), at(7.0, 0.25)] {
        let mut lift_off = LiftOff::from(&Vector3::new(0.0, 0.0, 7.0));
        assert!(lift_off.stands(&at(7.0, 0.0)) && lift_off.stands(&at(7.04, 0.1)));
        assert!(!lift_off.stands(&leaves));
        assert!(!lift_off.stands(&at(7.0, 0.0)), "back on the ground");
    }
    let mut displaced = LiftOff::from(&Vector3::zeros());
    displaced.displace(&Vector3::new(0.0, 0.0, 7.0));
    assert!(displaced.stands(&at(7.04, 0.0)) && !displaced.stands(&at(7.06, 0.0)));
    displaced.displace(&Vector3::zeros());
    assert!(!displaced.stands(&at(0.0, 0.0)), "it had left the ground");
    assert!(!LiftOff::DONE.clone().stands(&at(0.0, 0.0)));
}
