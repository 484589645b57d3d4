use super::*;
extern crate std;
use crate::extended::example;
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
    println!("{:#?}", bounds(&vehicle, &parameters, &references, Some(&rotors)).unwrap());
}
