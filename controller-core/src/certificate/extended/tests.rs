use super::*;
extern crate std;
use crate::extended::actuators::ActuatorParameters;
use crate::extended::example;
use crate::vehicle::{LimitParameters, Limits};
use nalgebra::Vector3;
use std::println;

#[test]
fn figures() {
    let vehicle = example::vehicle();
    let parameters = Extended::new(example::PARAMETERS, &vehicle).unwrap();
    let references = ReferenceBounds {
        horizontal_speed: 3.0,
        horizontal_acceleration: 2.4675,
        vertical_acceleration: 0.1755,
        jerk: 3.876,
        snap: 6.089,
        heading_rate: 1.316,
        heading_second_derivative: 1.7318,
    };
    let rotors = example::rotors();
    let limits = LimitParameters { thrust_max: 40.0, torque_max: Vector3::new(1.0, 1.0, 0.4) };
    let limits = Limits::new(limits, &vehicle).unwrap();
    let law = ExtendedLaw { parameters, actuators: ActuatorParameters { lag: 0.0, delay: 0.0 } };
    let configuration = Configuration::extended(vehicle, limits, law, references).unwrap().with_rotors(rotors).unwrap();
    println!("{:#?}", ExtendedCertificate::new(&configuration, &law).unwrap());
}
