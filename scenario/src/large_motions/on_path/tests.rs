use super::*;
use crate::Scenario;
use crate::along::end_us;

const HUMMINGBIRD: &str = include_str!("../../../../vehicles/hummingbird.toml");

/// The Hummingbird on a circle of 3 m at 7 m/s, with a level of yaw, rad/s^2.
fn flown(yaw_acceleration: f64, tolerance: f64) -> Result<OnPath, NotArrived> {
    let (head, _) = HUMMINGBIRD.split_once("\n[reference]").unwrap();
    let head = head.replace("yaw_acceleration = 6.0 ", &format!("yaw_acceleration = {yaw_acceleration} "));
    let reference = "kind = \"harmonic\"\ncenter = [0.0, 0.0, 2.0]\namplitude = [3.0, 3.0, 0.0]\n\
                     frequency = [2.3333, 2.3333, 0.0]\nphase = [0.0, -1.57079633, 0.0]\n";
    let scenario = Scenario::parse(&format!("{head}\n[reference]\n{reference}"), "f").unwrap();
    let certified = Certified::new(scenario.configuration.clone()).unwrap();
    let path = Path { trajectory: &*scenario.trajectory, end_us: end_us(&scenario), repeats: true, tolerance };
    path.flown(&certified, &scenario.loop_timing()).unwrap()
}

#[test]
fn a_fast_circle_is_flown_within_centimetres_and_its_heading_nearly_held() {
    let on_path = flown(6.0, 0.5).unwrap();
    assert!(on_path.distance < 0.03 && on_path.turned < 0.1, "{on_path:?}");
    assert!(on_path.distance > 1e-4 && on_path.turned > 1e-3, "{on_path:?}");
}

#[test]
fn a_model_that_strays_farther_than_it_may_is_named_with_the_place() {
    let lost = flown(6.0, 1e-4).unwrap_err();
    assert!(lost.start == START_NAME && lost.time >= SETTLING_TIME_S && lost.distance > 1e-4, "{lost:?}");
    assert!(lost.to_string().starts_with("model flight from its own reference: "), "{lost}");
}
