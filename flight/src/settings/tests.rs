use super::*;

#[test]
fn numbers_out_of_range_are_clamped_and_a_nan_becomes_the_default() {
    let wrong = FlightSettings {
        take_off_height: f32::NAN,
        landing_speed: -1.0,
        ground_station_timeout: f32::INFINITY,
        fence_radius: 0.0,
        fence_height: f32::NEG_INFINITY,
        tracking_error_max: 1e9,
    };
    let right = FlightSettings {
        take_off_height: 1.5,
        landing_speed: 0.1,
        ground_station_timeout: 600.0,
        fence_radius: 2.0,
        fence_height: 2.0,
        tracking_error_max: 100.0,
    };
    assert_eq!(wrong.within_range(), right);
    assert_eq!(FlightSettings::DEFAULT.within_range(), FlightSettings::DEFAULT);
}
