use super::*;
use controller_core::allocation::QuadX;
use controller_core::allocation::Thrusts;

fn outputs() -> Outputs {
    let (thrust_coefficient, drag_coefficient) = (5.57e-6, 1.36e-7);
    let quad = QuadX { arm: 0.17, thrust_coefficient, drag_coefficient, speed_min: 100.0, speed_max: 800.0 };
    Outputs::new(&Rotors::quad_x(quad).unwrap(), Motor { linear: 0.0, idle: 0.055 }).unwrap()
}

#[test]
fn half_the_greatest_speed_is_half_a_command() {
    let thrusts = Thrusts::from_slice(&[5.57e-6 * 400.0 * 400.0; 4]).unwrap();
    let MotorCommand::Run(commands) = outputs().command(&Output::Thrusts(thrusts), 1.0) else { panic!() };
    assert!(commands.iter().all(|command| (command - 0.5).abs() < 1e-6), "{commands:?}");
}

#[test]
fn a_motor_test_turns_one_motor_and_a_stop_none() {
    let test = Output::Test { rotor: 2, level: 0.1 };
    assert_eq!(outputs().command(&test, 1.0), MotorCommand::One { motor: 2, level: 0.1 });
    assert_eq!(outputs().command(&Output::Stop, 1.0), MotorCommand::Stop);
    assert_eq!(outputs().command(&Output::Idle, 1.0), MotorCommand::Run([0.055; MOTOR_COUNT]));
}

#[test]
fn no_motor_that_turns_is_commanded_below_its_idle_with_any_battery_and_a_lost_one_stops() {
    let thrusts = Thrusts::from_slice(&[0.0, f32::MIN_POSITIVE, 5.57e-6 * 44.0 * 44.0, 1.0]).unwrap();
    for ratio in [0.8, 1.0, 4.0 / 3.0] {
        let command = outputs().command(&Output::Thrusts(thrusts.clone()), ratio);
        let MotorCommand::Run([lost, tiny, least, flying]) = command else { panic!() };
        assert_eq!([lost, tiny, least.max(0.055)], [0.0, 0.055, least], "{ratio}");
        assert!(flying > 0.4, "{ratio}: {flying}");
    }
}

#[test]
fn a_battery_that_sags_is_made_up_for_while_its_reading_is_recent_and_plausible() {
    let reading = |value, time| Some(Stamped { value, time });
    assert!((voltage_ratio(12.6, reading(10.5, 5), 100) - 1.2).abs() < 1e-6);
    for (nominal, voltage, now) in [
        (0.0, reading(10.5, 5), 100),
        (12.6, None, 100),
        (12.6, reading(10.5, 5), 2_000_000),
        (12.6, reading(f32::NAN, 5), 100),
        (12.6, reading(1.0, 5), 100),
    ] {
        assert_eq!(voltage_ratio(nominal, voltage, now), 1.0, "{nominal} {voltage:?}");
    }
    let thrusts = Thrusts::from_slice(&[1.0; 4]).unwrap();
    let at = |ratio| match outputs().command(&Output::Thrusts(thrusts.clone()), ratio) {
        MotorCommand::Run(commands) => commands[0],
        _ => panic!(),
    };
    assert!((at(1.2) / at(1.0) - 1.2).abs() < 1e-6);
}
