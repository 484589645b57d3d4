//! What the analysis says about the paper's own gains at 100 Hz.

use crate::common::{IDEAL, TABLE_ONE, boundary, model, vehicle};
use controller_core::error::{ParameterError, Reason};
use controller_core::gains::Gains;
use host_sim::sampled_loop::{Axis, LoopModel, Timing};

fn stable(timing: Timing) -> bool {
    Axis::ALL.iter().all(|axis| model(TABLE_ONE, timing).spectral_radius(*axis) < 1.0)
}

#[test]
fn print_the_table() {
    for timing in [IDEAL, Timing { rotor_lag: 0.005, ..IDEAL }] {
        for r in model(TABLE_ONE, timing).reports() {
            println!("{timing:?} {r:?}");
        }
    }
    for axis in Axis::ALL {
        let s = |timing| model(TABLE_ONE, timing).spectral_radius(axis) < 1.0;
        println!(
            "{axis:?} lag limit {} delay limit {}",
            boundary(0.001, 5.0, |rotor_lag| s(Timing { rotor_lag, ..IDEAL })),
            boundary(0.0, 60.0, |delay_samples| s(Timing { delay_samples, ..IDEAL })),
        );
    }
    let n = 2000;
    let t = std::time::Instant::now();
    for i in 0..n {
        std::hint::black_box(model(TABLE_ONE, Timing { rotor_lag: 0.005 + 1e-9 * f64::from(i), ..IDEAL }).reports());
    }
    println!("{:?} per reports()", t.elapsed() / n);
}

#[test]
fn ideal_actuators_are_stable_and_the_attitude_loop_is_fast() {
    assert!(stable(IDEAL));
    let frequency = model(TABLE_ONE, IDEAL).attitude_frequency(0);
    assert!((frequency - 52.8).abs() < 0.1, "{frequency} rad/s");
}

#[test]
fn a_bad_timing_is_refused_by_name() {
    let vehicle = vehicle();
    let gains = Gains::new(TABLE_ONE, &vehicle).unwrap();
    for (timing, field, reason) in [
        (Timing { period: 0.0, ..IDEAL }, "control.period", Reason::NotPositive),
        (Timing { period: 0.2, ..IDEAL }, "control.period", Reason::NotBelow(0.1)),
        (Timing { period: f64::NAN, ..IDEAL }, "control.period", Reason::NotFinite),
        (Timing { rotor_lag: -1e-3, ..IDEAL }, "rotors.lag", Reason::Negative),
        (Timing { rotor_lag: f64::INFINITY, ..IDEAL }, "rotors.lag", Reason::NotFinite),
        (Timing { delay_samples: -0.5, ..IDEAL }, "sampling.delay", Reason::Negative),
        (Timing { delay_samples: 65.0, ..IDEAL }, "sampling.delay", Reason::NotBelow(64.0)),
    ] {
        assert_eq!(LoopModel::new(&vehicle, &gains, timing), Err(ParameterError { field, reason }));
    }
}
