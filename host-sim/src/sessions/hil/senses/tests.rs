//! Samples with their times, poses that come late, and sensors that are exact.

use super::*;
use nalgebra::Quaternion;

/// The study, with this said of its sensors.
fn scenario(sensors: &str) -> Scenario {
    let study = std::fs::read_to_string("../vehicles/study.toml").unwrap();
    Scenario::parse(&format!("{study}\n{sensors}\n"), "test.toml").unwrap()
}

/// A motion at this velocity, m/s, along x, seen at `instants` of a period; it begins `begin` seconds from the start.
fn motion(velocity: f64, begin: f64, instants: u64) -> Moved {
    let at = |instant: u64| BodyState {
        position: Vector3::x() * (velocity * (begin + 0.01 * instant as f64 / instants as f64)),
        velocity: Vector3::x() * velocity,
        attitude: Quaternion::identity(),
        angular_velocity: Vector3::new(0.0, 0.0, 0.5),
    };
    let specific_force = Vector3::new(0.0, 0.0, 9.81);
    let path = (1..=instants).map(at).collect();
    Moved { state: at(instants), path, specific_force, thrust: 0.0, speeds: Vec::new(), touchdown: None }
}

/// Command times that are not quite regular, us.
fn command(tick: u64) -> u64 {
    40_000 + 10_000 * tick + 7 * (tick % 3)
}

/// The answers to so many commands.
fn answers(sensors: &str, ticks: u64, velocity: f64) -> Vec<Answer> {
    let mut senses = Senses::new(&scenario(sensors));
    let instants = senses.instants();
    (0..ticks).map(|tick| senses.answer(command(tick), &motion(velocity, 0.01 * tick as f64, instants))).collect()
}

#[test]
fn without_a_section_one_exact_sample_and_pose_are_of_the_periods_end() {
    for (tick, answer) in (0..).zip(answers("", 3, 2.0)) {
        let [pose] = answer.poses[..] else { panic!("{answer:?}") };
        let [sample] = answer.samples[..] else { panic!("{answer:?}") };
        assert_eq!((pose.time, sample.time), (command(tick) + 10_000, command(tick) + 10_000));
        let along = 0.02 * (tick + 1) as f32;
        assert!((pose.value.position - Vector3::x() * along).norm() < 1e-7);
        assert_eq!(pose.value.motion, Some((Vector3::x() * 2.0, Vector3::new(0.0, 0.0, 0.5))));
        assert_eq!(sample.value.angular_velocity, Vector3::new(0.0, 0.0, 0.5));
        assert_eq!(sample.value.specific_force, Vector3::new(0.0, 0.0, 9.81));
    }
}

#[test]
fn with_an_estimator_ten_samples_carry_their_own_times() {
    for (tick, answer) in (0..).zip(answers("[estimator]", 5, 0.0)) {
        let times: Vec<_> = answer.samples.iter().map(|sample| sample.time).collect();
        let expected: Vec<_> = (1..=10).map(|sample| command(tick) + 1_000 * sample).collect();
        assert_eq!(times, expected);
    }
}

#[test]
fn a_pose_comes_late_with_the_time_at_which_it_was_true() {
    for (delay, ticks_late) in [(0.0, 0), (0.02, 2), (0.025, 3), (0.15, 15)] {
        let sensors = format!("[estimator]\npose_delay = {delay}\nposition_noise = 0.0\nattitude_noise_deg = 0.0");
        for (tick, answer) in (0..).zip(answers(&sensors, 30, 2.0)) {
            let expected = if tick < ticks_late { None } else { Some(tick - ticks_late) };
            assert_eq!(answer.poses.len(), usize::from(expected.is_some()), "{delay} s, tick {tick}");
            let (Some(seen), Some(pose)) = (expected, answer.poses.first()) else { continue };
            // The end of the period in which it was taken, by the commands of that period.
            assert_eq!(pose.time, command(seen) + 10_000);
            let along = 0.02 * (seen + 1) as f32;
            assert!((pose.value.position - Vector3::x() * along).norm() < 1e-6, "{delay} s, tick {tick}");
            assert_eq!((pose.value.motion, pose.value.deviations), (None, Some((1e-4, 1e-4))));
        }
    }
}

#[test]
fn poses_and_samples_have_the_noise_of_the_section_and_another_seed_has_other() {
    let answers_of = |seed: u32| answers(&format!("[estimator]\nseed = {seed}"), 2_000, 0.0);
    let (some, same, other) = (answers_of(1), answers_of(1), answers_of(2));
    assert_eq!(some, same);
    assert_ne!(some[0].samples, other[0].samples);
    let poses: Vec<_> = some.iter().flat_map(|answer| &answer.poses).collect();
    let deviation =
        (poses.iter().map(|pose| pose.value.position.norm_squared()).sum::<f32>() / (3 * poses.len()) as f32).sqrt();
    assert!((9.5e-4..1.05e-3).contains(&deviation), "{deviation} m");
    let turned = |pose: &Stamped<MeasuredPose>| 2.0 * pose.value.attitude.imag().norm();
    let deviation = (poses.iter().map(|pose| turned(pose).powi(2)).sum::<f32>() / (3 * poses.len()) as f32).sqrt();
    assert!((0.285..0.315).contains(&deviation.to_degrees()), "{} degrees", deviation.to_degrees());
    // From one sample to the next neither bias matters: twice the variance of white noise of the data sheet's density.
    let rates: Vec<_> =
        some.iter().flat_map(|answer| &answer.samples).map(|sample| sample.value.angular_velocity).collect();
    let squares: f32 = rates.windows(2).map(|pair| (pair[1] - pair[0]).norm_squared()).sum();
    let density = (squares / (6 * (rates.len() - 1)) as f32).sqrt() / 1000.0_f32.sqrt();
    assert!((2.34e-4..2.54e-4).contains(&density), "{density} rad/s/sqrt(Hz)");
}

#[test]
fn perfect_sensors_at_1_khz_feel_every_change_of_velocity() {
    let sensors = "[estimator]\nimu_noise = 0.0\nposition_noise = 0.0\nattitude_noise_deg = 0.0";
    let answers = answers(sensors, 3, 0.2);
    let samples: Vec<_> = answers.iter().flat_map(|answer| &answer.samples).collect();
    // From rest to 0.2 m/s within the first millisecond, and steadily on.
    assert!((samples[0].value.specific_force - Vector3::new(200.0, 0.0, 9.81)).norm() < 1e-3);
    for sample in &samples[1..] {
        assert!((sample.value.specific_force - Vector3::new(0.0, 0.0, 9.81)).norm() < 1e-5);
        assert_eq!(sample.value.angular_velocity, Vector3::new(0.0, 0.0, 0.5));
    }
}

#[test]
fn no_pose_arrives_during_an_outage_and_a_file_whose_steps_miss_milliseconds_is_refused() {
    let sensors = "[estimator]\noutage = { start = 0.095, duration = 0.1 }";
    let arrived: Vec<_> = answers(sensors, 40, 0.0).iter().map(|answer| answer.poses.len()).collect();
    assert_eq!(arrived[2..9], [1; 7]);
    assert_eq!(arrived[9..19], [0; 10]);
    assert_eq!(arrived[19..], [1; 21]);
    let study = std::fs::read_to_string("../vehicles/study.toml").unwrap().replace("step = 0.001", "step = 0.002");
    let Err(refused) = Scenario::parse(&format!("{study}\n[estimator]\n"), "test.toml") else { panic!("taken") };
    assert!(refused.to_string().contains("plant.step"), "{refused}");
}
