use super::*;

#[test]
fn what_is_left_to_brake_is_one_motion_and_its_derivatives_from_any_speed() {
    let stop = Stop { acceleration: 2.0, jerk: 4.0 };
    for speed in [0.01, 0.5, 0.99, 1.01, 7.0] {
        let (_, whole) = stop.course(speed);
        let after = |time: f64| stop.after(time as f32, speed).map(f64::from);
        let mut time = 0.01;
        while time < f64::from(whole) - 0.01 {
            let ([before, faster, _], [way, left, falls], [less, slower, _]) =
                (after(time - 0.01), after(time), after(time + 0.01));
            assert!(((before - less) / 0.02 - left).abs() < 2e-4, "{speed} m/s after {time} s: {left} m/s, {way} m");
            // Half of what the jerk makes of a hundredth, where it turns round.
            assert!(((faster - slower) / 0.02 - falls).abs() < 0.021, "{speed} m/s after {time} s: {falls} m/s^2");
            time += 0.007;
        }
        assert_eq!(stop.after(whole, speed), [0.0; 3]);
        assert!((stop.after(0.0, speed)[0] - stop.way(speed)).abs() < 1e-5);
    }
}
