use super::*;

const GRAVITY: f32 = 9.81;

fn at_rest(attitude: Quaternion<f32>) -> Nominal {
    let zero = Vector3::zeros();
    Nominal { position: zero, velocity: zero, attitude, gyro_bias: zero, accelerometer_bias: zero }
}

#[test]
fn a_body_at_rest_stays_where_it_is_whichever_way_is_up() {
    for attitude in [Quaternion::identity(), Quaternion::new(0.0, 1.0, 0.0, 0.0), Quaternion::new(0.5, -0.5, 0.5, 0.5)]
    {
        let mut nominal = at_rest(attitude);
        nominal.gyro_bias = Vector3::new(0.01, -0.02, 0.03);
        nominal.accelerometer_bias = Vector3::new(0.1, 0.2, -0.3);
        let up = UnitQuaternion::new_unchecked(attitude).inverse_transform_vector(&Vector3::new(0.0, 0.0, GRAVITY));
        for n in 0..200 {
            let (rate, force) = (nominal.gyro_bias, up + nominal.accelerometer_bias);
            nominal.advance(&Increment::steady(n * 5_000, (n + 1) * 5_000, &rate, &force), GRAVITY);
        }
        assert!(nominal.velocity.norm() < 1e-4 && nominal.position.norm() < 1e-4, "{nominal:?}");
        assert!(difference(&nominal.attitude, &attitude).norm() < 1e-5, "{nominal:?}");
    }
}

#[test]
fn a_turning_circle_closes() {
    // 1.5 m in radius, once in 4 s, nose along the path: constant rate and specific force in the body's axes.
    let omega = core::f64::consts::FRAC_PI_2;
    let (rate, force) =
        (Vector3::new(0.0, 0.0, omega as f32), Vector3::new(0.0, (1.5 * omega * omega) as f32, GRAVITY));
    let mut nominal = at_rest(Quaternion::identity());
    nominal.velocity = Vector3::new((1.5 * omega) as f32, 0.0, 0.0);
    for n in 0..800 {
        nominal.advance(&Increment::steady(n * 5_000, (n + 1) * 5_000, &rate, &force), GRAVITY);
    }
    assert!(nominal.position.norm() < 1e-3, "{:?}", nominal.position);
    assert!(difference(&nominal.attitude, &Quaternion::identity()).norm() < 1e-5, "{:?}", nominal.attitude);
}

#[test]
fn an_error_vector_is_the_rotation_between_two_attitudes() {
    let from = Quaternion::new(0.1_f32, -0.7, 0.5, 0.2).normalize();
    for angle in [1e-4_f32, 0.1, 1.0, 3.0] {
        let axis = Vector3::new(2.0_f32, -1.0, 0.5).normalize();
        let turn = UnitQuaternion::from_scaled_axis(axis * angle).into_inner();
        // Either sign is the same attitude.
        for to in [turn * from, -(turn * from)] {
            let theta = difference(&to, &from);
            assert!(
                (theta - axis * (4.0 * (angle / 4.0).tan())).norm() < 2e-6 * (1.0 + theta.norm()),
                "{angle}: {theta}"
            );
            let back = rotation(&theta) * from;
            assert!((back - to).norm().min((back + to).norm()) < 1e-6, "{angle}");
        }
    }
}
