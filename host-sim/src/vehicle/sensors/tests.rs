//! The samples' statistics, the filter's poles, the delay to the tick.

use super::*;
use crate::flight::Flight;
use scenario::body::attitude_from_euler;

const HUMMINGBIRD: &str = include_str!("../../../../vehicles/hummingbird-paper-law.toml");

fn sensors(keys: &str) -> Sensors {
    Sensors::new(&Scenario::parse(&format!("{HUMMINGBIRD}\n[sensors]\n{keys}"), "f").unwrap()).unwrap()
}

fn somewhere() -> BodyState {
    BodyState {
        position: Vector3::new(1.0, 0.0, 1.5),
        velocity: Vector3::zeros(),
        attitude: attitude_from_euler(0.3, -0.2, 1.0),
        angular_velocity: Vector3::new(0.1, 0.2, -0.3),
    }
}

/// Mean and standard deviation of each component.
fn moments(samples: &[Vector3<f64>]) -> (Vector3<f64>, Vector3<f64>) {
    let n = samples.len() as f64;
    let mean = samples.iter().sum::<Vector3<f64>>() / n;
    let variance = samples.iter().map(|x| (x - mean).component_mul(&(x - mean))).sum::<Vector3<f64>>() / n;
    (mean, variance.map(f64::sqrt))
}

fn assert_normal(samples: &[Vector3<f64>], mean: Vector3<f64>, deviation: f64) {
    let found = moments(samples);
    let n = samples.len() as f64;
    // Five standard deviations of each estimate.
    assert!((found.0 - mean).amax() < 5.0 * deviation / n.sqrt() + 1e-7, "{found:?}");
    assert!((found.1 / deviation - Vector3::repeat(1.0)).amax() < 5.0 / (2.0 * n).sqrt(), "{found:?}");
    // White: neighbours are not related, nor are axes.
    let product = |a: &Vector3<f64>, b: &Vector3<f64>| (a - mean).component_mul(&(b - mean)) / (deviation * deviation);
    let neighbours = samples.windows(2).map(|pair| product(&pair[0], &pair[1])).sum::<Vector3<f64>>() / n;
    let axes = samples.iter().map(|x| product(x, &x.yzx())).sum::<Vector3<f64>>() / n;
    assert!(neighbours.amax() < 5.0 / n.sqrt() && axes.amax() < 5.0 / n.sqrt(), "{neighbours} {axes}");
}

#[test]
fn noise_and_bias_are_as_large_as_the_file_says() {
    let mut sensors = sensors(
        "gyro_noise = 0.01\ngyro_bias = [0.005, 0.0, -0.02]\nposition_noise = 0.002\nattitude_noise_deg = 0.2\nvelocity_noise = 0.05\nseed = 5",
    );
    let state = somewhere();
    let (mut rates, mut positions, mut attitudes, mut velocities) = (vec![], vec![], vec![], vec![]);
    for _ in 0..40_000 {
        let measured = sensors.measure(&state);
        rates.push(measured.angular_velocity.map(f64::from) - state.angular_velocity);
        positions.push(measured.position.map(f64::from) - state.position);
        velocities.push(measured.velocity.map(f64::from));
        let attitude = Quaternion::from(measured.attitude.coords.map(f64::from));
        let turned = UnitQuaternion::new_unchecked(state.attitude).inverse() * UnitQuaternion::new_normalize(attitude);
        attitudes.push(turned.scaled_axis());
    }
    assert_normal(&rates, Vector3::new(0.005, 0.0, -0.02), 0.01);
    assert_normal(&positions, Vector3::zeros(), 0.002);
    assert_normal(&attitudes, Vector3::zeros(), 0.2_f64.to_radians());
    assert_normal(&velocities, Vector3::zeros(), 0.05);
}

#[test]
fn perfect_sensors_change_no_bit_of_a_flight() {
    let perfect = format!("{HUMMINGBIRD}\n[sensors]\n");
    let mut with = Flight::new(&Scenario::parse(&perfect, "f").unwrap()).unwrap();
    let mut without = Flight::new(&Scenario::parse(HUMMINGBIRD, "f").unwrap()).unwrap();
    for _ in 0..300 {
        let (a, b) = (with.tick().unwrap(), without.tick().unwrap());
        assert_eq!((a.state, a.wrench), (b.state, b.wrench));
        assert_eq!(a.measured.as_deref(), Some(&b.state.measured()));
        assert!(b.measured.is_none());
    }
}

#[test]
fn everything_is_late_by_the_delay_and_no_more() {
    let mut sensors = sensors("delay = 0.03");
    let at = |tick: u32| BodyState { position: Vector3::new(f64::from(tick), 0.0, 0.0), ..somewhere() };
    let measured: Vec<f32> = (0..8).map(|tick| sensors.measure(&at(tick)).position.x).collect();
    assert_eq!(measured, [0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0]);
}

#[test]
fn between_poses_position_and_attitude_are_carried_on() {
    let mut sensors = sensors("pose_rate = 20.0");
    // Along a circle of constant body rate; a pose every fifth tick, exact.
    let rate = Vector3::new(0.5, -0.3, 0.8);
    let at = |tick: u32| {
        let time = f64::from(tick) * 0.01;
        let turned = UnitQuaternion::from_scaled_axis(rate * time).into_inner();
        BodyState {
            position: Vector3::new(1.0 + 2.0 * time, 0.0, 1.5),
            velocity: Vector3::x() * 2.0,
            attitude: turned,
            angular_velocity: rate,
        }
    };
    sensors.measure(&at(0));
    for tick in 1..50 {
        let measured = sensors.measure(&at(tick));
        let truth = at(tick).measured();
        assert!((measured.position - truth.position).norm() < 1e-6, "{tick}");
        assert!((measured.attitude - truth.attitude).norm() < 1e-6, "{tick}");
    }
    // A jump is not seen before the next pose.
    for tick in 50..60 {
        let far = Vector3::new(9.0, 9.0, 9.0);
        let state = if tick == 50 { at(tick) } else { BodyState { position: far, ..at(tick) } };
        assert_eq!(sensors.measure(&state).position.y, if tick < 55 { 0.0 } else { 9.0 }, "{tick}");
    }
}

#[test]
fn poses_drop_out_as_often_as_the_file_says() {
    let mut sensors = sensors("dropout = 0.3\nseed = 9");
    let mut lost = 0;
    for tick in 1..=20_000 {
        let state = BodyState { position: Vector3::new(f64::from(tick % 1000), 0.0, 0.0), ..somewhere() };
        let measured = sensors.measure(&state).position.x;
        lost += u32::from(f64::from(measured) != state.position.x);
    }
    // Five standard deviations of 20,000 throws.
    assert!((f64::from(lost) - 6000.0).abs() < 5.0 * (20_000.0_f64 * 0.21).sqrt(), "{lost}");
}

#[test]
fn the_alpha_beta_filter_forgets_with_its_double_pole() {
    let mut sensors = sensors("velocity = \"alpha-beta\"\nvelocity_bandwidth = 20.0");
    let state = somewhere();
    // It knows the start; the vehicle is suddenly 1 m further and stays there.
    let moved = BodyState { position: state.position + Vector3::x(), ..state };
    sensors.measure(&state);
    let pole = (-0.2_f64).exp();
    for k in 0..60 {
        let found = f64::from(sensors.measure(&moved).velocity.x);
        // v over p is (1 - rho)^2 / T z (z - 1) / (z - rho)^2; this is its step response.
        let expected = (1.0 - pole).powi(2) / 0.01 * f64::from(k + 1) * pole.powi(k);
        assert!((found - expected).abs() < 1e-4, "{k}: {found} {expected}");
    }
}

#[test]
fn an_observer_that_feels_the_acceleration_does_not_lag() {
    let worst = |velocity: &str| {
        let mut sensors = sensors(&format!("velocity = \"{velocity}\"\nvelocity_bandwidth = 10.0"));
        // A circle of 2 m/s and 4 m/s^2.
        let errors = (0..500).map(|tick| {
            let phase = 0.02 * f64::from(tick);
            let (sin, cos) = phase.sin_cos();
            let position = Vector3::new(cos, sin, 1.5);
            let state = BodyState { position, velocity: Vector3::new(-2.0 * sin, 2.0 * cos, 0.0), ..somewhere() };
            let state = BodyState { angular_velocity: Vector3::zeros(), ..state };
            (sensors.measure(&state).velocity.map(f64::from) - state.velocity).norm()
        });
        errors.skip(200).fold(0.0, f64::max)
    };
    let (without, with) = (worst("alpha-beta"), worst("observer"));
    // A lag of 2 / bandwidth would be 0.8 m/s; what the filter leaves of a ramp in v is T (1 + rho) / (1 - rho) about
    // that.
    assert!(without > 0.5 && with < 0.01, "{without} {with}");
}

#[test]
fn the_same_seed_gives_the_same_flight_and_another_another() {
    let measured = |seed: u32| {
        let mut sensors = sensors(&format!("position_noise = 0.01\nseed = {seed}"));
        [(); 5].map(|()| sensors.measure(&somewhere()))
    };
    assert_eq!(measured(1), measured(1));
    assert_ne!(measured(1), measured(2));
}

/// The sensors of a search's trials at this rate, Hz, without noise.
fn prompt_but_late(rate: f64) -> Sensors {
    let mut scenario = Scenario::parse(HUMMINGBIRD, "f").unwrap();
    scenario = crate::rivals::rate::at(&scenario, rate).unwrap();
    let noisy = crate::studies::tune::trials::noise(scenario.timing.period());
    let velocity = VelocitySource::Observer { bandwidth: 8.0, noise: 0.0, bias: Vector3::zeros() };
    scenario.reality.sensors =
        Some(sensors::Sensors { gyro_noise: 0.0, position_noise: 0.0, attitude_noise: 0.0, velocity, ..noisy });
    Sensors::new(&scenario).unwrap()
}

/// A body about a fixed axis at this time, s: rate 2 + 3 t, rad/s, acceleration (1, 2, 3) m/s^2.
fn turning(time: f64) -> BodyState {
    let start = somewhere();
    let acceleration = Vector3::new(1.0, 2.0, 3.0);
    let turned = UnitQuaternion::from_scaled_axis(Vector3::x() * (2.0 * time + 1.5 * time * time));
    BodyState {
        position: start.position + acceleration * (0.5 * time * time),
        velocity: acceleration * time,
        attitude: turned.into_inner(),
        angular_velocity: Vector3::x() * (2.0 + 3.0 * time),
    }
}

#[test]
fn poses_that_come_late_are_carried_on_and_the_gyro_is_late_by_its_filters() {
    for rate in [100.0, 250.0, 500.0] {
        let mut sensors = prompt_but_late(rate);
        sensors.attitude = PropagatedAttitude::new(turning(0.0).measured().attitude, Vector3::x() * 2.0, 0);
        sensors.velocity = Vector3::zeros();
        for tick in 0..200 {
            let time = f64::from(tick) / rate;
            let (truth, measured) = (turning(time), sensors.measure(&turning(time)));
            let late = f64::from(measured.angular_velocity.x) - (2.0 + 3.0 * time);
            let expected = -3.0 * time.min(0.003);
            assert!((late - expected).abs() < 1e-5, "{rate} Hz, {time}: {late}");
            assert!((measured.position.map(f64::from) - truth.position).norm() < 2e-3, "{rate} Hz, {time}");
            let attitude = Quaternion::from(measured.attitude.coords.map(f64::from));
            let error =
                UnitQuaternion::new_normalize(attitude).angle_to(&UnitQuaternion::new_normalize(truth.attitude));
            // Gyro samples that are 3 ms late carry it on over 20 ms and up to 12 ms more until the next pose.
            assert!(error < 3.0 * 0.003 * 0.033, "{rate} Hz, {time}: {error}");
        }
    }
}

#[test]
fn what_is_sensed_is_as_late_as_the_gyro() {
    let mut sensors = prompt_but_late(500.0);
    let at = |tick: f64| Sensed { specific_force: Vector3::repeat(tick), wrench: nalgebra::Vector4::repeat(-tick) };
    let last = (0..20).map(|tick| sensors.sense(&at(f64::from(tick)))).last().unwrap();
    assert!((last.specific_force - Vector3::repeat(17.5)).amax() < 1e-12, "{last:?}");
    assert!((last.wrench - nalgebra::Vector4::repeat(-17.5)).amax() < 1e-12, "{last:?}");
}
