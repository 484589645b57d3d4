//! q and -q are one rotation: the output and the memory do not depend on which is given, to the last bit.

use crate::support::random;
use controller_core::controller::Controller;
use rand::RngExt;

#[test]
fn output_and_memory_do_not_depend_on_the_sign_of_the_quaternion() {
    let mut rng = random::generator(50);
    for number in 0..200 {
        let vehicle = random::vehicle(&mut rng);
        let gains = random::gains(&mut rng, &vehicle);
        let mut one = Controller::uncertified(vehicle, gains, None, 0.01).unwrap();
        let mut other = one.clone();
        let mut reference = random::reference(&mut rng, &vehicle, &gains);
        let mut state = random::state_around(&mut rng, &reference);
        for tick in 0..200 {
            if rng.random_bool(0.05) {
                reference = random::reference(&mut rng, &vehicle, &gains);
            }
            // Mostly small turns, so that the memory matters; now and then anything, exact half turns among it.
            state.attitude = match rng.random_range(0..20) {
                0 => random::attitude(&mut rng),
                1 => nalgebra::Quaternion::from_imag(random::direction(&mut rng)),
                2 => nalgebra::Quaternion::new(0.0, 1.0, 0.0, 0.0),
                _ => {
                    let nudge = nalgebra::Quaternion::from_parts(1.0, random::vector(&mut rng, 0.1));
                    (state.attitude * nudge).normalize()
                }
            };
            let mut mirrored = state;
            mirrored.attitude = -state.attitude;
            let (wrench, diagnostics) = one.step(&state, &reference).unwrap();
            let (same, same_diagnostics) = other.step(&mirrored, &reference).unwrap();
            let bits =
                |w: &controller_core::state::Wrench| [w.thrust, w.torque.x, w.torque.y, w.torque.z].map(f32::to_bits);
            assert_eq!(bits(&wrench), bits(&same), "run {number}, tick {tick}: {state:?}");
            assert_eq!(diagnostics, same_diagnostics, "run {number}, tick {tick}");
            assert_eq!(one.memory(), other.memory(), "run {number}, tick {tick}");
        }
    }
}
