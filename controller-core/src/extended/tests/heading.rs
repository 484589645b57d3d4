//! The heading generator.

use crate::attitude_reference::AngularMotion;
use crate::error::ParameterError;
use crate::extended::controller::Controller;
use crate::extended::heading::{self, HeadingLag, advanced, turning};
use crate::extended::parameters::ExtendedParameters;
use crate::extended::tests::example::{self, Craft};
use nalgebra::{Vector2, Vector3};

#[test]
fn the_heading_catches_up_and_never_turns_faster_than_it_may() {
    let parameters = example::parameters();
    for start in [0.1_f32, 1.0, 2.0, 3.0, -3.1] {
        let (sin, cos) = (0.5 * start).sin_cos();
        let mut lag = HeadingLag { half_angle: Vector2::new(cos, sin), rate: 0.0 };
        for tick in 0..1_000 {
            let psi = 0.01 * tick as f32;
            let motion = AngularMotion {
                velocity: Vector3::new(0.3, -0.2, 0.8 * psi.sin()),
                acceleration: Vector3::new(1.0, 2.0, 0.8 * psi.cos()),
            };
            let desired = turning(&lag, &motion, &parameters, 0.01);
            assert!(desired.acceleration.z.abs() <= parameters.yaw_acceleration * (1.0 + 1e-5));
            assert!(desired.velocity.z.abs() <= parameters.yaw_rate * (1.0 + 1e-5));
            assert!((desired.velocity.xy().norm() - motion.velocity.xy().norm()).abs() < 1e-6);
            lag = advanced(&lag, &desired, 0.01, f32::MAX);
        }
        assert!(lag.half_angle.y.abs() < 2e-3, "from {start}: {lag:?}");
    }
}

#[test]
fn where_the_frame_turns_fast_the_heading_turns_slower_and_catches_up_later() {
    let parameters = example::parameters();
    let still = AngularMotion { velocity: Vector3::zeros(), acceleration: Vector3::zeros() };
    let (sin, cos) = 1.0_f32.sin_cos();
    for rate in [2.0, -2.0] {
        let mut lag = HeadingLag { half_angle: Vector2::new(cos, sin), rate };
        for tick in 0..1_500 {
            let fastest = if tick < 300 { 0.2 } else { f32::MAX };
            let desired = turning(&lag, &still, &parameters, 0.01);
            lag = advanced(&lag, &desired, 0.01, fastest);
            assert!(lag.rate.abs() <= fastest);
        }
        assert!(lag.half_angle.y.abs() < 2e-3, "{lag:?}");
    }
}

#[test]
fn ticks_too_long_for_the_generator_are_refused_by_name() {
    let refused = |c_1: f32, c_2: f32| {
        let parameters = ExtendedParameters { c_1, c_2, ..example::parameters() };
        heading::check(&parameters, 0.01).map_err(|error: ParameterError| error.field)
    };
    assert_eq!(refused(9.0, 6.0), Ok(()));
    assert_eq!(refused(30.0, 0.15), Err("gains.c_1"));
    assert_eq!(refused(900.0, 6.0), Err("gains.c_1"));
    assert_eq!(refused(9.0, 250.0), Err("gains.c_2"));
    // All that are let through die out: the greatest root of their polynomial is inside the unit circle.
    for c_2 in [0.1_f32, 1.0, 10.0, 100.0] {
        for share in [0.001, 0.1, 1.0] {
            let c_1 = share * 0.5 * c_2 / 0.01;
            assert_eq!(refused(c_1, c_2), Ok(()));
            let (half, product) = (f64::from(1.0 - 0.005 * c_2), f64::from(1.0 - 0.01 * c_2 + 1e-4 * c_1));
            let square = half * half - product;
            let greatest = if square > 0.0 { half.abs() + square.sqrt() } else { product.sqrt() };
            assert!(greatest < 1.0, "{c_1} {c_2}: {greatest}");
        }
    }
    let craft = Craft::example();
    let law = craft.law(&ExtendedParameters { c_1: 30.0, c_2: 0.15, ..example::parameters() });
    let refused = Controller::build(&craft.vehicle, &craft.limits, &law, Some(&craft.rotors), 0.01).unwrap_err();
    assert_eq!(refused.field, "gains.c_1");
}
