//! The limit beside closed forms, and below what any law does.

use super::*;

const HUMMINGBIRD: &str = include_str!("../../../../../vehicles/hummingbird.toml");

fn read(text: &str) -> Scenario {
    Scenario::parse(text, "v.toml").unwrap()
}

/// The Hummingbird whose rotors follow at once and may stand still, without limits of its own.
fn prompt() -> Scenario {
    let text = HUMMINGBIRD.replace("torque_max = [1.0, 1.0, 0.4]", "torque_max = [9.0, 9.0, 9.0]");
    let text = text.replace("speed = [0.0, 1500.0]", "speed = [0.0, 1500.0]\nidle = 0.0");
    Scenario { rotor_lag: 0.0, ..read(&text.replace("thrust_max = 40.0", "thrust_max = 99.0")) }
}

#[test]
fn without_lag_a_turn_takes_as_long_as_the_closed_form_says() {
    let scenario = prompt();
    let greatest = 5.57e-6 * 1500.0 * 1500.0;
    let acceleration = 2.0 * greatest * 0.120208 / 3.65e-3;
    for angle in [0.3, 1.0, PI] {
        let time = Turning::new(&scenario, 0).by(angle).time;
        assert!((time - 2.0 * (angle / acceleration).sqrt()).abs() < 4.0 * INTEGRATION_STEP_S, "{angle}: {time}");
    }
}

#[test]
fn a_fall_is_the_turns_and_the_brakings() {
    let scenario = prompt();
    let limit = Limit::new(&scenario);
    let (gravity, up) = (9.81, 4.0 * 5.57e-6 * 1500.0 * 1500.0 / 0.5 - 9.81);
    let time = Turning::new(&scenario, 0).by(PI).time;
    let lost = 0.5 * gravity * time * time * (1.0 + gravity / up);
    assert!((limit.height_lost - lost).abs() < 0.01 * lost, "{limit:?} {lost}");
    assert!((limit.recovered - time * (1.0 + gravity / up)).abs() < 5.0 * INTEGRATION_STEP_S, "{limit:?} {time}");
}

#[test]
fn lag_and_a_limit_of_torque_cost_height_and_time() {
    let free = Limit::new(&prompt());
    let late = Limit::new(&Scenario { rotor_lag: 0.02, ..prompt() });
    let limited = Limit::new(&Scenario { rotor_lag: 0.0, ..read(HUMMINGBIRD) });
    for other in [late, limited] {
        assert!(other.height_lost > 1.2 * free.height_lost, "{other:?} {free:?}");
        assert!(other.recovered > free.recovered, "{other:?} {free:?}");
        assert!(other.steps.iter().zip(free.steps).all(|(one, other)| *one > other), "{other:?} {free:?}");
    }
}

#[test]
fn a_short_step_is_over_before_it_brakes_and_a_long_one_stops_within_reach() {
    // 10 m/s^2, turns of 0.1 s and 0.2 s. Of 1.1 m: v = sqrt(1 + 11) - 1.
    let speed = 12.0_f64.sqrt() - 1.0;
    let pushed = 0.05 * speed * speed;
    let coasted = 0.1 + speed / 10.0 + (0.9 - pushed) / speed;
    let braked = 0.1 + speed / 10.0 + 0.2 + (speed - 2.0) / 10.0;
    let expected = if 0.9 <= pushed + 0.2 * speed { coasted } else { braked };
    assert!((step_time(1.0, &[10.0, 0.1, 0.2]) - expected).abs() < 1e-12);
    // Without turns: 4 + 4 s for 160 m at 10 m/s^2, but for the last metre of the way.
    let whole = step_time(159.9, &[10.0, 0.0, 0.0]);
    assert!((whole - (8.0 - 0.2)).abs() < 1e-9, "{whole}");
}

#[test]
fn a_vehicle_without_rotors_has_its_file_as_its_limit() {
    let limit = Limit::new(&read(scenario::PAPER));
    assert!(limit.height_lost > 0.1 && limit.recovered > 0.1 && limit.steps[1] > limit.steps[0], "{limit:?}");
}
