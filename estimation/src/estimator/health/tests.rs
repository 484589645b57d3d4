use super::*;
use crate::estimator::filter::Biases;
use crate::estimator::{EstimatorParameters, PoseMeasurement};
use crate::measurement::{Pose, Velocity};
use nalgebra::{Quaternion, Vector3};

/// What is wrong with a filter that is certain and consistent but for these changes.
fn faults(change: impl FnOnce(&mut Filter, &mut Statistics)) -> Option<Fault> {
    let settings = Settings::new(&EstimatorParameters::BMI088).unwrap();
    let (zero, level) = (Vector3::zeros(), Quaternion::new(1.0, 0.0, 0.0, 0.0));
    let pose = PoseMeasurement::new(&Pose::new(zero, Velocity::World(zero), level).unwrap());
    let mut filter = Filter::start(0, &pose, &Biases::unknown(&settings), &settings);
    filter.covariance.vv = Matrix3::from_diagonal_element(1e-4);
    let mut statistics = Statistics { fused_at: 1, ..Statistics::NONE };
    change(&mut filter, &mut statistics);
    let health = Health::new(Some(&filter), &statistics, &settings, 0, COASTING_AFTER_US + 1);
    assert_eq!(health.is_good(), health.faults.worst().is_none());
    health.faults.worst()
}

#[test]
fn an_estimate_is_uncertain_by_its_position_its_velocity_or_its_attitude_alone() {
    assert_eq!(faults(|_, _| ()), None);
    let block = |deviation: f32| Matrix3::from_diagonal_element(deviation * deviation / 3.0);
    for (share, fault) in [(0.99, None), (1.01, Some(Fault::Uncertain)), (f32::NAN, Some(Fault::Uncertain))] {
        assert_eq!(faults(|filter, _| filter.covariance.pp = block(share * DEVIATIONS_MAX.0)), fault, "position");
        assert_eq!(faults(|filter, _| filter.covariance.vv = block(share * DEVIATIONS_MAX.1)), fault, "velocity");
        assert_eq!(faults(|filter, _| filter.covariance.tt = block(share * DEVIATIONS_MAX.2)), fault, "attitude");
        // Just now it was certain.
        let shocked = faults(|filter, statistics| {
            filter.covariance.vv = block(share * DEVIATIONS_MAX.1);
            statistics.certain_at = 1;
        });
        assert_eq!(shocked, None);
    }
}

#[test]
fn positions_or_attitudes_noisier_than_their_covariance_are_a_fault_each() {
    for noisy in [1.01 * NIS_MEAN_MAX, f32::NAN] {
        assert_eq!(faults(|_, statistics| statistics.nis.0 = noisy), Some(Fault::Inconsistent));
        assert_eq!(faults(|_, statistics| statistics.nis.1 = noisy), Some(Fault::Inconsistent));
    }
    assert_eq!(faults(|_, statistics| statistics.nis = (NIS_MEAN_MAX, NIS_MEAN_MAX)), None);
}

#[test]
fn a_bias_that_is_no_number_is_not_plausible() {
    assert_eq!(faults(|filter, _| filter.nominal.gyro_bias.y = f32::NAN), Some(Fault::GyroBias));
    assert_eq!(faults(|filter, _| filter.nominal.accelerometer_bias.y = f32::NAN), Some(Fault::AccelerometerBias));
}
