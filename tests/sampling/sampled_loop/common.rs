//! Table I, and how to put other numbers in its place.

use controller_core::configuration::{LawParameters, PaperLaw};
use controller_core::gains::{GainParameters, Gains};
use controller_core::vehicle::Vehicle;
use scenario::Scenario;
use scenario::sampled_loop::{Axis, LoopModel, Timing};
use std::sync::LazyLock;

/// 100 Hz, ideal rotors, no delay.
pub const IDEAL_TIMING: Timing = Timing { period: 0.01, rotor_lag: 0.0, delay_samples: 0.0 };

static PAPER: LazyLock<Scenario> = LazyLock::new(|| Scenario::paper().unwrap());

pub fn vehicle() -> Vehicle {
    *PAPER.configuration.vehicle()
}

pub fn model(gains: GainParameters, timing: Timing) -> LoopModel {
    let vehicle = vehicle();
    let gains = Gains::new(gains, &vehicle).unwrap();
    let law = LawParameters::Paper(PaperLaw { gains, thrust_floor: None });
    LoopModel::new(&vehicle, &law, timing).unwrap()
}

/// Where `stable` turns false between `low`, where it holds, and `high`, where it does not.
pub fn boundary(mut low: f64, mut high: f64, stable: impl Fn(f64) -> bool) -> f64 {
    assert!(stable(low) && !stable(high));
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if stable(middle) { low = middle } else { high = middle }
    }
    low
}

/// Body axis that `axis` turns about, if it does.
pub fn body_axis(axis: Axis) -> Option<usize> {
    match axis {
        Axis::Roll | Axis::LateralY => Some(0),
        Axis::Pitch | Axis::LateralX => Some(1),
        Axis::Yaw => Some(2),
        Axis::Vertical => None,
    }
}
