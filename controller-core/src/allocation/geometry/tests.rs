use super::*;
use nalgebra::Matrix4;

fn hummingbird() -> QuadX {
    QuadX { arm: 0.17, thrust_coefficient: 5.57e-6, drag_coefficient: 1.36e-7, speed_min: 0.0, speed_max: 1500.0 }
}

fn refused(change: impl Fn(&mut [Rotor])) -> ParameterError {
    let mut rotors: Vec<Rotor, ROTORS_MAX> = Rotors::quad_x(hummingbird()).unwrap().iter().copied().collect();
    change(&mut rotors);
    Rotors::new(&rotors).unwrap_err()
}

#[test]
fn thrust_on_the_left_rolls_right_and_thrust_ahead_pitches_up() {
    let rotors = Rotors::quad_x(hummingbird()).unwrap();
    let front_left = rotors.effectiveness()[0];
    let side = 0.17 * core::f64::consts::FRAC_1_SQRT_2;
    let expected = Vector4::new(1.0, side, -side, 1.36e-7 / 5.57e-6);
    assert!((front_left - expected).amax() < 1e-8, "{front_left}");
    let force = Vector3::new(0.0, 0.0, 1.0);
    for (rotor, column) in rotors.iter().zip(rotors.effectiveness()) {
        let torque = rotor.position.cross(&force);
        assert!((column.y - f64::from(torque.x)).abs() < 1e-12 && (column.z - f64::from(torque.y)).abs() < 1e-12);
    }
}

#[test]
fn a_clockwise_rotor_turns_the_body_to_positive_yaw() {
    let rotors = Rotors::quad_x(hummingbird()).unwrap();
    for (rotor, column) in rotors.iter().zip(rotors.effectiveness()) {
        assert_eq!(column.w > 0.0, rotor.spin == Spin::Clockwise);
    }
}

#[test]
fn the_pseudo_inverse_is_a_right_inverse() {
    let rotors = Rotors::quad_x(hummingbird()).unwrap();
    let product: Matrix4<f64> =
        rotors.effectiveness().iter().zip(rotors.pseudo_inverse()).map(|(b, row)| b * row.transpose()).sum();
    assert!((product - Matrix4::identity()).amax() < 1e-12, "{product}");
}

#[test]
fn speed_and_thrust_are_inverse_to_each_other() {
    let rotors = Rotors::quad_x(hummingbird()).unwrap();
    for i in 0..1000 {
        let thrust = 12.5 * i as f32 / 1000.0;
        let back = rotors[0].thrust_at(rotors[0].speed_at(thrust));
        assert!((back - thrust).abs() <= 4.0 * f32::EPSILON * thrust);
    }
}

#[test]
fn every_bad_rotor_is_named() {
    let case = |field, reason| ParameterError { field, reason };
    assert_eq!(refused(|r| r[2].position.x = f32::NAN), case("rotors.position, rotor 3", Reason::NotFinite));
    assert_eq!(refused(|r| r[2].position.z = 1e3), case("rotors.position, rotor 3", Reason::NotBelow(100.0)));
    assert_eq!(
        refused(|r| r[0].thrust_coefficient = 0.0),
        case("rotors.thrust_coefficient, rotor 1", Reason::NotPositive)
    );
    assert_eq!(
        refused(|r| r[3].drag_coefficient = -1.0),
        case("rotors.drag_coefficient, rotor 4", Reason::NotPositive)
    );
    assert_eq!(refused(|r| r[1].thrust_min = -0.1), case("rotors.thrust_min, rotor 2", Reason::Negative));
    assert_eq!(refused(|r| r[1].thrust_max = f32::INFINITY), case("rotors.thrust_max, rotor 2", Reason::NotFinite));
    let equal = refused(|r| r[1].thrust_min = r[1].thrust_max);
    assert!(equal.field == "rotors.thrust_min, rotor 2" && matches!(equal.reason, Reason::NotBelow(_)));
}

#[test]
fn rotors_that_cannot_span_the_wrench_are_refused() {
    let cannot = ParameterError { field: "rotors", reason: Reason::DoesNotSpan };
    assert_eq!(refused(|r| r.iter_mut().for_each(|rotor| rotor.spin = Spin::Clockwise)), cannot);
    assert_eq!(refused(|r| r.iter_mut().for_each(|rotor| rotor.position.x = 0.0)), cannot);
    // Spins paired along one side: yaw is then a combination of roll and the rest.
    let spins = [Spin::Clockwise, Spin::Clockwise, Spin::CounterClockwise, Spin::CounterClockwise];
    assert_eq!(refused(|r| r.iter_mut().zip(spins).for_each(|(rotor, spin)| rotor.spin = spin)), cannot);
}

#[test]
fn fewer_than_four_or_more_than_eight_rotors_are_refused() {
    let quad = Rotors::quad_x(hummingbird()).unwrap();
    let nine: Vec<Rotor, 9> = quad.iter().cycle().take(9).copied().collect();
    assert_eq!(Rotors::new(&quad[..3]).unwrap_err().reason, Reason::TooFew(4));
    assert_eq!(Rotors::new(&nine).unwrap_err().reason, Reason::TooMany(8));
}

#[test]
fn a_rotor_too_far_away_on_either_side_is_refused_by_its_number() {
    for far in [100.0, -100.0] {
        let error = refused(|rotors| rotors[2].position.y = far);
        assert_eq!(error, ParameterError { field: "rotors.position, rotor 3", reason: Reason::NotBelow(100.0) });
    }
}

#[test]
fn rotors_hover_a_weight_between_their_least_and_greatest_thrust() {
    let rotors = Rotors::quad_x(QuadX { speed_min: 300.0, ..hummingbird() }).unwrap();
    let (min, max) = rotors.thrust_together();
    assert!((min - 2.0052).abs() < 1e-4 && (max - 50.13).abs() < 1e-3, "{min} {max}");
    let refused = |weight| rotors.check_hover(weight).unwrap_err();
    assert!(rotors.check_hover(0.5 * max).is_ok());
    assert_eq!(refused(max), ParameterError { field: "rotors.speed", reason: Reason::NotAbove(max) });
    assert_eq!(refused(min), ParameterError { field: "rotors.speed", reason: Reason::NotBelow(min) });
}

#[test]
fn the_wrench_of_rotors_by_their_speeds_is_that_of_their_thrusts() {
    let rotors = Rotors::quad_x(hummingbird()).unwrap();
    let thrusts = [1.5_f32, 2.0, 0.7, 1.1];
    let mut speeds = [None; 4];
    for ((speed, rotor), thrust) in speeds.iter_mut().zip(rotors.iter()).zip(thrusts) {
        *speed = Some(rotor.speed_at(thrust));
    }
    let wrench = rotors.wrench_at(&speeds).unwrap();
    let expected: Vector4<f64> =
        rotors.effectiveness().iter().zip(thrusts).map(|(column, thrust)| column * f64::from(thrust)).sum();
    let found = Vector4::new(wrench.thrust, wrench.torque.x, wrench.torque.y, wrench.torque.z);
    assert!((found.cast::<f64>() - expected).norm() < 1e-5, "{found} {expected}");
    // One that does not answer, too few, and speeds that nobody has measured.
    assert_eq!(rotors.wrench_at(&[speeds[0], None, speeds[2], speeds[3]]), None);
    assert_eq!(rotors.wrench_at(&speeds[..3]), None);
    assert!(rotors.of_nominal_speed().wrench_at(&speeds).is_none());
}
