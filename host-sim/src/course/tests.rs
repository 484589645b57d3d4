//! A course whose figures follow from arithmetic.

use super::*;

const HUMMINGBIRD: &str = include_str!("../../../vehicles/hummingbird-paper-law.toml");

fn course(seconds: f64, initial: &str, sections: &str, near: f64) -> Course {
    let (head, _) = HUMMINGBIRD.split_once("[initial]").unwrap();
    let head = head.replace("duration = 40.0", &format!("duration = {seconds:?}"));
    let reference = "[reference]\nkind = \"hover\"\nposition = [0.0, 0.0, 0.0]\n";
    let scenario = Scenario::parse(&format!("{head}{reference}[initial]\n{initial}\n{sections}"), "f").unwrap();
    Course::over(&scenario, Flight::new(&scenario).unwrap(), near).unwrap()
}

#[test]
fn a_flight_that_stands_still_has_nothing_to_tell() {
    let still = course(4.0, "position = [0.0, 0.0, 0.0]", "", 0.1);
    assert_eq!((still.settled, still.clipped), (Some(0.0), 0));
    assert!(still.height_lost < 1e-6 && still.rise.abs() < 1e-6 && still.excursion < 1e-6 && still.activity < 1e-6);
}

#[test]
fn a_fall_without_thrust_is_as_deep_as_gravity_makes_it() {
    let fallen = course(4.0, "position = [3.0, 0.0, 4.0]", "[truth]\nthrust_scale = 0.0", 0.1);
    // The last tick is at 3.99 s.
    let depth = 0.5 * 9.81 * 3.99 * 3.99;
    assert!((fallen.height_lost - depth).abs() < 1e-4, "{}", fallen.height_lost);
    assert_eq!((fallen.rise, fallen.settled), (0.0, None));
    let end = 9.0 + (depth - 4.0) * (depth - 4.0);
    assert!((fallen.end_error - end.sqrt()).abs() < 1e-4 && fallen.excursion == fallen.end_error);
    assert!(fallen.rms > 20.0 && fallen.rms < fallen.end_error);
}

#[test]
fn it_settles_when_it_comes_near_for_good() {
    let arrives = course(40.0, "velocity = [0.0, 0.0, 0.3]", "", 0.02);
    let settled = arrives.settled.unwrap();
    assert!(settled > 0.0 && settled < 39.0 && arrives.end_error <= 0.02, "{arrives:?}");
    assert!(arrives.rise > 0.02 && arrives.rise == arrives.excursion);
    // Noise keeps the rotors busy.
    let noisy = course(40.0, "velocity = [0.0, 0.0, 0.3]", "[sensors]\ngyro_noise = 0.01", 0.02);
    assert!(noisy.activity > 10.0 * arrives.activity, "{} {}", noisy.activity, arrives.activity);
}
