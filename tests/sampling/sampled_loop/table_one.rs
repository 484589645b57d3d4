//! What the analysis says about the paper's own gains at 100 Hz.

use super::common::{IDEAL_TIMING, boundary, model, vehicle};
use controller_core::configuration::{LawParameters, PaperLaw};
use controller_core::error::{ParameterError, Reason};
use controller_core::gains::{GainParameters, Gains};
use scenario::sampled_loop::{Axis, LoopModel, Timing};

fn radius(axis: Axis, timing: Timing) -> f64 {
    model(GainParameters::TABLE_1, timing).spectral_radius(axis)
}

#[test]
fn ideal_actuators_are_stable_and_the_attitude_loop_is_fast() {
    for report in model(GainParameters::TABLE_1, IDEAL_TIMING).reports() {
        assert!(report.spectral_radius < 1.0, "{report:?}");
    }
    // Undamped, in continuous time: sqrt(k_theta / (16 J)).
    let frequency = f64::from(GainParameters::TABLE_1.k_theta / (16.0 * vehicle().inertia.x)).sqrt();
    assert!((frequency - 52.8).abs() < 0.05, "{frequency} rad/s");
    let crossover = model(GainParameters::TABLE_1, IDEAL_TIMING).report(Axis::Roll).margins.unwrap().crossover;
    assert!((crossover - 62.9).abs() < 0.05, "{crossover} rad/s");
}

#[test]
fn without_lag_and_delay_the_attitude_loop_is_the_held_double_integrator() {
    // z^2 - (2 - A/2 - B) z + 1 + A/2 - B with A = k_theta h^2 / 16 J, B = k_omega h / J: complex roots of modulus
    // sqrt(1 + A/2 - B); a gain of 2 / B puts one at -1.
    for (axis, inertia) in [(Axis::Roll, 2.24e-3), (Axis::Pitch, 2.9e-3), (Axis::Yaw, 5.3e-3)] {
        let (a, b) = (6.25e-4 / inertia, 1e-3 / inertia);
        let report = model(GainParameters::TABLE_1, IDEAL_TIMING).report(axis);
        // The gains and the inertia are in single precision.
        assert!((report.spectral_radius - f64::sqrt(1.0 + 0.5 * a - b)).abs() < 1e-7, "{report:?}");
        let gain_up = report.margins.unwrap().gain_up;
        assert!((gain_up * b / 2.0 - 1.0).abs() < 1e-6, "{report:?}");
    }
}

#[test]
fn rotor_lag_costs_the_roll_loop_its_stability_at_8_5_milliseconds() {
    let limits =
        [(Axis::Roll, 8.51), (Axis::Pitch, 9.06), (Axis::Yaw, 9.93), (Axis::LateralX, 9.06), (Axis::LateralY, 8.52)];
    for (axis, expected) in limits {
        let limit = boundary(0.0, 0.02, |rotor_lag| radius(axis, Timing { rotor_lag, ..IDEAL_TIMING }) < 1.0);
        assert!((1e3 * limit - expected).abs() < 0.005, "{axis:?}: {limit} s");
    }
    assert!(radius(Axis::Vertical, Timing { rotor_lag: 0.1, ..IDEAL_TIMING }) < 1.0);
}

#[test]
fn no_attitude_loop_survives_a_sample_of_delay() {
    for (axis, expected) in [(Axis::Roll, 0.754), (Axis::Pitch, 0.831), (Axis::Yaw, 0.955)] {
        let limit = boundary(0.0, 1.0, |delay_samples| radius(axis, Timing { delay_samples, ..IDEAL_TIMING }) < 1.0);
        assert!((limit - expected).abs() < 0.0005, "{axis:?}: {limit} samples");
        // The delay margin of the undelayed loop is that limit in seconds.
        let margin = model(GainParameters::TABLE_1, IDEAL_TIMING).report(axis).margins.unwrap().delay;
        assert!((margin - limit * IDEAL_TIMING.period).abs() < 1e-9, "{axis:?}: {margin} s");
    }
    assert!(radius(Axis::Vertical, Timing { delay_samples: 1.0, ..IDEAL_TIMING }) < 1.0);
}

#[test]
fn in_continuous_time_the_limit_on_the_lag_is_the_same_about_every_axis() {
    // Routh on lag J s^3 + J s^2 + k_omega s + k_theta / 16: lag < 16 k_omega / k_theta, whatever J; sampling takes
    // another half period or so.
    let timing = Timing { period: 1e-5, ..IDEAL_TIMING };
    for axis in [Axis::Roll, Axis::Pitch, Axis::Yaw] {
        let limit = boundary(0.0, 0.05, |rotor_lag| radius(axis, Timing { rotor_lag, ..timing }) < 1.0);
        assert!((limit - 0.016).abs() < 2e-5, "{axis:?}: {limit} s");
    }
}

#[test]
fn a_bad_timing_is_refused_by_name() {
    let vehicle = vehicle();
    let gains = Gains::new(GainParameters::TABLE_1, &vehicle).unwrap();
    let law = LawParameters::Paper(PaperLaw { gains, thrust_floor: None });
    for (timing, field, reason) in [
        (Timing { period: 0.0, ..IDEAL_TIMING }, "control.period", Reason::NotPositive),
        (Timing { period: 0.2, ..IDEAL_TIMING }, "control.period", Reason::Above(0.1)),
        (Timing { period: f64::NAN, ..IDEAL_TIMING }, "control.period", Reason::NotFinite),
        (Timing { rotor_lag: -1e-3, ..IDEAL_TIMING }, "rotors.lag", Reason::Negative),
        (Timing { rotor_lag: f64::INFINITY, ..IDEAL_TIMING }, "rotors.lag", Reason::NotFinite),
        (Timing { delay_samples: -0.5, ..IDEAL_TIMING }, "sampling.delay", Reason::Negative),
        (Timing { delay_samples: 65.0, ..IDEAL_TIMING }, "sampling.delay", Reason::Above(64.0)),
    ] {
        assert_eq!(LoopModel::new(&vehicle, &law, timing), Err(ParameterError { field, reason }));
    }
}
