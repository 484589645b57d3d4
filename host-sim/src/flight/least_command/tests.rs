use super::*;

const HUMMINGBIRD: &str = include_str!("../../../../vehicles/hummingbird.toml");
const FULL_THRUST_N: f32 = 5.57e-6 * 1500.0 * 1500.0;

#[test]
fn it_is_that_of_the_least_thrust_that_is_no_stop() {
    for (linear, expected) in [(0.0, 0.05), (1.0, 0.0025)] {
        let text = HUMMINGBIRD.replace("[rotors] ", &format!("[rotors]\nthrust_curve = {linear} "));
        let mut least = LeastCommand::before_flight(&Scenario::parse(&text, "f").unwrap());
        assert_eq!(least.least(), None);
        least.observe(&[FULL_THRUST_N, 0.0, 0.04 * FULL_THRUST_N, FULL_THRUST_N]);
        // Below idle as well, or it would never be seen.
        least.observe(&[0.0025 * FULL_THRUST_N; 4]);
        least.observe(&[FULL_THRUST_N; 4]);
        assert!((least.least().unwrap() - expected).abs() < 1e-6 && least.least().unwrap() < least.idle());
    }
}

#[test]
fn without_rotors_there_is_none() {
    let mut least = LeastCommand::before_flight(&Scenario::paper().unwrap());
    least.observe(&[]);
    assert_eq!(least.least(), None);
}
