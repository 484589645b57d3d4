//! What is estimated: force, torque bias, thrust scale.

use super::Random;
use crate::extended::estimates::{ForceObserver, ThrustScale, TorqueBias};
use crate::extended::memory::ScaleEstimate;
use crate::extended::parameters::ExtendedParameters;
use crate::extended::tests::example;
use nalgebra::Vector3;

#[test]
fn a_force_is_believed_up_to_its_levels_and_arrives_at_what_stays() {
    let p = example::parameters();
    let observer = ForceObserver::new(&p, 9.81, 0.01);
    let mut random = Random(2);
    let (mut average, mut nearest) = (Vector3::zeros(), [0.0_f32; 3]);
    for _ in 0..100_000 {
        let size = 10.0_f32.powf(random.signed() * 1.5 + 1.5);
        average = observer.filtered(&average, &random.vector(size));
        let believed = observer.estimate(&average);
        let shares = [believed.xy().norm() / p.force_across, believed.z / p.force_up, -believed.z / p.force_down];
        assert!(shares.iter().all(|share| *share <= 1.0 + 1e-6), "{believed}");
        assert!(average.xy().dot(&believed.xy()) >= average.xy().norm() * believed.xy().norm() * (1.0 - 1e-5));
        nearest.iter_mut().zip(shares).for_each(|(nearest, share)| *nearest = nearest.max(share));
    }
    assert!(nearest.iter().all(|share| *share > 0.999), "{nearest:?}");
    let steady = Vector3::new(1.0, -0.7, 0.3);
    for _ in 0..1_000 {
        average = observer.filtered(&average, &steady);
    }
    assert!((observer.estimate(&average) - steady).norm() < 1e-5, "{average}");
}

#[test]
fn a_vehicle_that_does_as_commanded_shows_no_force() {
    let p = example::parameters();
    let observer = ForceObserver::new(&p, 9.81, 0.01);
    let thrust = Vector3::new(0.6, 0.0, 0.8) * 15.0;
    let start = Vector3::new(2.0, -1.0, 0.5);
    let drag = p.drag_across * Vector3::new(start.x, start.y, 0.0);
    let end = start + (thrust - Vector3::new(0.0, 0.0, 9.81) - drag) * 0.01;
    // The drag of the mean velocity is not that at the start: 0.47 / s of half of 9 m/s^2 in a tick.
    assert!(
        (observer.driven_acceleration(observer.mean_acceleration([&start, &end]), [&start, &end]) - thrust).norm()
            < 0.03
    );
}

#[test]
fn a_bias_is_believed_up_to_its_level() {
    let p = example::parameters();
    let bias = TorqueBias::new(&p, &example::vehicle().inertia, 0.01);
    let mut average = Vector3::zeros();
    let torque = Vector3::new(0.5 * p.torque_tilt, -9.0, 2.0 * p.torque_yaw);
    for _ in 0..2_000 {
        average = bias.filtered(&average, &torque);
    }
    let expected = Vector3::new(torque.x, -p.torque_tilt, p.torque_yaw);
    assert!((bias.estimate(&average) - expected).norm() < 1e-6);
}

/// The learner, from its first interval on, under a constant `force`, with the thrust scale `truth`; `commanded` is a
/// tick's command. Returns the error of the scale at first, at last, and its greatest growth in an interval.
fn learnt(truth: f32, force: Vector3<f32>, ticks: u32, mut commanded: impl FnMut(u32) -> Vector3<f32>) -> [f32; 3] {
    let p = ExtendedParameters { scale_least: 0.5, scale_greatest: 2.0, ..example::parameters() };
    let scale = ThrustScale::new(&p, 0.01);
    let mut estimate = ScaleEstimate { slow: None, scale: 1.0 };
    let (first, mut worse) = ((1.0 - truth).abs(), 0.0_f32);
    for tick in 0..ticks {
        let f = commanded(tick);
        let before = (estimate.scale - truth).abs();
        estimate = scale.updated(&estimate, &(f * truth + force), &f);
        worse = worse.max((estimate.scale - truth).abs() - before);
    }
    [first, (estimate.scale - truth).abs(), worse]
}

#[test]
fn the_thrust_scale_never_gets_worse_under_a_constant_force_and_arrives_while_thrust_varies() {
    for truth in [0.8, 0.95, 1.1, 1.5] {
        for force in [Vector3::zeros(), Vector3::new(4.0, -3.0, 3.0), Vector3::new(0.0, 0.0, -5.0)] {
            let mut random = Random(9);
            let wild = |_| Vector3::new(0.0, 0.0, 12.0) + random.vector(12.0);
            let [first, last, worse] = learnt(truth, force, 20_000, wild);
            // One rounding of a number up to two.
            assert!(last < 0.02 * first && worse < 2.5e-7, "{truth} {force}: {last} of {first}, {worse}");
        }
    }
}

#[test]
fn the_thrust_scale_stands_still_in_hover_whatever_pulls() {
    for force in [Vector3::new(0.0, 0.0, 4.0), Vector3::new(3.0, 1.0, -4.0)] {
        let [first, last, _] = learnt(1.3, force, 60_000, |_| Vector3::new(0.0, 0.0, 9.81));
        assert!((first - last).abs() < 1e-5, "{first} {last}");
    }
}

#[test]
fn the_thrust_scale_stays_within_its_limits() {
    let p = example::parameters();
    let scale = ThrustScale::new(&p, 0.01);
    let mut random = Random(10);
    for truth in [0.1, 5.0] {
        let mut estimate = ScaleEstimate { slow: None, scale: 1.0 };
        for _ in 0..5_000 {
            let f = random.vector(20.0);
            estimate = scale.updated(&estimate, &(f * truth), &f);
            assert!(estimate.scale >= p.scale_least && estimate.scale <= p.scale_greatest);
        }
        assert_eq!(estimate.scale, truth.clamp(p.scale_least, p.scale_greatest));
    }
}
