use super::*;
use xorshift::Random;

#[path = "../../../../controller-core/tests/support/xorshift.rs"]
mod xorshift;

/// A standstill of noisy samples around what is given for each.
fn stand(mut at: impl FnMut(f32) -> (Vector3<f32>, Vector3<f32>)) -> Result<StandstillMeans, Moved> {
    let (mut standstill, mut random) = (Standstill::default(), Random::new(7));
    // The sum of four even numbers is nearly normal, with a deviation of 1.15.
    let mut noise =
        |deviation: f32| Vector3::from_fn(|_, _| (0..4).map(|_| random.signed()).sum::<f32>() * (deviation / 1.155));
    for n in 0..STANDSTILL_SAMPLES {
        let (rate, force) = at(f32::from(n) * 1e-3);
        let rest = standstill.take(&(rate + noise(3.3e-3)), &(force + noise(0.025)));
        assert_eq!(rest.is_some(), n + 1 == STANDSTILL_SAMPLES);
        if let Some(rest) = rest {
            assert_eq!(standstill, Standstill::default());
            return rest;
        }
    }
    panic!("no result")
}

const UP: Vector3<f32> = Vector3::new(0.3, -0.2, 9.8);
const BIAS: Vector3<f32> = Vector3::new(0.017, -0.01, 0.005);

#[test]
fn the_means_of_a_standstill_are_its_biases() {
    let rest = stand(|_| (BIAS, UP)).unwrap();
    // The deviation of a mean of 1000 is a thirtieth of a sample's.
    assert!((rest.angular_velocity - BIAS).norm() < 4e-4, "{rest:?}");
    assert!((rest.specific_force - UP).norm() < 3e-3, "{rest:?}");
}

#[test]
fn motion_is_no_standstill() {
    let shaken = |t: f32| (BIAS + Vector3::new(0.0, 0.03 * (30.0 * t).sin(), 0.0), UP);
    assert_eq!(stand(shaken), Err(Moved::Shaken));
    let pushed = |t: f32| (BIAS, UP + Vector3::new(0.2 * (50.0 * t).sin(), 0.0, 0.0));
    assert_eq!(stand(pushed), Err(Moved::Shaken));
    // One degree a second about a horizontal axis, as slow as a bias.
    let rolling = |t: f32| (BIAS + Vector3::new(0.0175, 0.0, 0.0), UP + Vector3::new(0.0, 9.81 * 0.0175 * t, 0.0));
    assert_eq!(stand(rolling), Err(Moved::Turning));
    let back = |t: f32| (BIAS - Vector3::new(0.0175, 0.0, 0.0), UP - Vector3::new(0.0, 9.81 * 0.0175 * t, 0.0));
    assert_eq!(stand(back), Err(Moved::Turning));
    for rate in [0.05, -0.05] {
        assert_eq!(stand(|_| (Vector3::new(0.0, 0.0, rate), UP)), Err(Moved::TooFast));
    }
    assert_eq!(stand(|_| (BIAS, UP * f32::NAN)), Err(Moved::Shaken));
}
