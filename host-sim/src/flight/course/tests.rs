//! A course whose figures follow from arithmetic.

use super::*;
use crate::studies::campaign::outcome::Outcome;
use controller_core::certificate::certified::Certified;

const HUMMINGBIRD: &str = include_str!("../../../../vehicles/hummingbird-paper-law.toml");

fn scenario(seconds: f64, initial: &str, sections: &str) -> Scenario {
    let (head, _) = HUMMINGBIRD.split_once("[initial]").unwrap();
    let head = head.replace("duration = 40.0", &format!("duration = {seconds:?}"));
    let reference = "[reference]\nkind = \"hover\"\nposition = [0.0, 0.0, 0.0]\n";
    Scenario::parse(&format!("{head}{reference}[initial]\n{initial}\n{sections}"), "f").unwrap()
}

fn course(seconds: f64, initial: &str, sections: &str, near: f64) -> Course {
    let scenario = scenario(seconds, initial, sections);
    Course::fly(&scenario, Flight::new(&scenario).unwrap(), near).unwrap()
}

#[test]
fn a_flight_that_stands_still_has_no_figures_but_zero() {
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

#[test]
fn rise_is_above_start_and_reference() {
    let from_below = course(40.0, "position = [0.0, 0.0, -1.0]\nvelocity = [0.0, 0.0, 0.5]", "", 0.1);
    assert!(from_below.rise.abs() < 0.1 && from_below.height_lost == 0.0, "{from_below:?}");
}

#[test]
fn the_last_half_is_judged_by_its_root_mean_squares() {
    let scenario = scenario(1.0, "velocity = [0.3, 0.0, 0.0]", "[sensors]\ngyro_noise = 0.01");
    let course = Course::fly(&scenario, Flight::new(&scenario).unwrap(), 0.1).unwrap();
    let mut flight = Flight::new(&scenario).unwrap();
    let ticks: Vec<Tick> = (0..100).map(|_| flight.tick().unwrap()).collect();
    let half = &ticks[50..];
    let squares: f64 = half.iter().map(|tick| tick.state.position.norm_squared()).sum();
    assert!((course.rms - (squares / 50.0).sqrt()).abs() < 1e-12);
    let change = |pair: &[Tick], rotor: usize| f64::from(pair[1].rotor_thrusts[rotor] - pair[0].rotor_thrusts[rotor]);
    let changes: Vec<f64> = half.windows(2).flat_map(|pair| (0..4).map(|rotor| change(pair, rotor))).collect();
    let activity = (changes.iter().map(|change| change * change).sum::<f64>() / changes.len() as f64).sqrt();
    assert!((course.activity - activity).abs() < 1e-12 && changes.len() == 196);
}

#[test]
fn what_stands_on_the_ground_has_not_arrived() {
    let heavy = "[ground]\nheight = 0.0\n[truth]\nmass = 5.0";
    let stands = course(4.0, "position = [0.0, 0.0, 0.0]", heavy, 0.1);
    assert_eq!((stands.settled, stands.end_error), (None, 0.0));
    let scenario = scenario(4.0, "position = [0.0, 0.0, 0.0]", heavy);
    let certified = Certified::new(scenario.configuration.clone()).unwrap();
    let outcome = Outcome::judge(&scenario, Flight::new(&scenario).unwrap(), certified.certificate());
    assert!(outcome.settled.is_none() && !outcome.tracks() && outcome.final_error == 0.0, "{outcome:?}");
}
