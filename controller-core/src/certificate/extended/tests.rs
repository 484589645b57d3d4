use super::*;
use crate::allocation::{QuadX, Rotors};
use crate::extended::actuators::ActuatorParameters;
use crate::extended::example;
use crate::vehicle::{LimitParameters, Limits};
use nalgebra::Vector3;

#[test]
fn every_rotor_has_a_row_and_weak_rotors_fail_theirs() {
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
    let certificate = ExtendedCertificate::new(&configuration, &law).unwrap();
    assert_eq!(certificate.inequalities.len(), WITHOUT_ROTORS + 4);
    assert_eq!(certificate.bounds.rotors.len(), 4);
    // Thrust beyond every rotor's is beyond the certificate: with a tenth of the speed nothing fits.
    let weak = Configuration::extended(vehicle, limits, law, references).unwrap();
    let quad =
        QuadX { arm: 0.17, thrust_coefficient: 5.57e-6, drag_coefficient: 1.36e-7, speed_min: 0.0, speed_max: 600.0 };
    let weak = weak.with_rotors(Rotors::quad_x(quad).unwrap()).unwrap();
    let failing = ExtendedCertificate::new(&weak, &law).unwrap();
    let rows = failing.inequalities.iter().filter(|row| row.name.starts_with('R'));
    assert_eq!(rows.filter(|row| !row.holds()).count(), 4);
}
