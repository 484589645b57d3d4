use super::*;

#[test]
fn braking_by_the_law_takes_one_unit_a_tick_and_ends_on_the_point() {
    for start in 1..400 {
        let mut distance = 0.37 * start as f32;
        let mut speed = approach_speed(distance);
        let mut ticks = 0;
        while distance > 0.0 {
            let next = if distance <= 1.0 { distance } else { approach_speed(distance) };
            assert!(next <= speed + 1e-4 && next >= speed - 1.0 - 1e-4, "from {speed} to {next} at {distance}");
            assert!(next <= distance);
            speed = next;
            distance -= next;
            ticks += 1;
            assert!(ticks < 100);
        }
    }
}

#[test]
fn a_faster_approach_would_overrun() {
    for start in 1..400 {
        let distance = 0.37 * start as f32;
        let (mut speed, mut covered) = (approach_speed(distance) + 0.01, 0.0);
        while speed > 0.0 {
            covered += speed;
            speed -= 1.0;
        }
        assert!(covered > distance, "{covered} within {distance}");
    }
}
