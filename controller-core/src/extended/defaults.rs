//! Every constant from a vehicle's numbers, and the references that it can fly with them. The formulas of the constants
//! stand where these are declared, in [`super::parameters`].

use super::budget::TorqueBudget;
use super::fallback::Slowed;
use super::parameters::ExtendedParameters;
pub use super::quantities::{Airframe, Quantities};
use crate::math::{self, max_f64, min_f64};
use crate::reference::ReferenceBounds;

/// Constants that the file gives, in the table's order; the others follow from them.
pub type Given = [Option<f32>; ExtendedParameters::COUNT];

/// No constant given.
pub const NOTHING_GIVEN: Given = [None; ExtendedParameters::COUNT];

/// The constants for `airframe`; the `given` ones stay as they are.
pub fn constants(airframe: &Airframe, given: &Given) -> ExtendedParameters {
    let by_key = |key: &str| {
        let found = ExtendedParameters::TABLE.iter().zip(given).find(|(constant, _)| constant.key == key);
        found.and_then(|(_, value)| *value)
    };
    let mut values = ExtendedParameters::defaults(&Quantities::new(airframe, &by_key)).map(|value| value as f32);
    for ((value, given), constant) in values.iter_mut().zip(given).zip(&ExtendedParameters::TABLE) {
        *value = given.unwrap_or(value.clamp(constant.range.min, constant.range.max));
    }
    ExtendedParameters::from_values(values)
}

/// Bounds of the motions that `parameters` can fly on `airframe`: the governor's limits.
pub fn reference_bounds(airframe: &Airframe, parameters: &ExtendedParameters) -> ReferenceBounds {
    let p = parameters;
    let budget = TorqueBudget::<f64>::new(p.floor_margin, airframe.limits, airframe.rotors);
    let weakest = budget.held_acceleration(airframe.vehicle, airframe.limits, f64::from(p.scale_least));
    let [gravity, across, down, up, rate, reserve] =
        [airframe.vehicle.gravity, p.a_across, p.a_down, p.force_up, p.turn_rate, p.turn_reserve].map(f64::from);
    let held_beyond = weakest - gravity;
    let horizontal = min_f64(min_f64(3.0, 0.2 * across), math::sqrt_of_rounded(0.1 * gravity * held_beyond));
    let vertical = min_f64(min_f64(1.0, 0.15 * min_f64(down, across)), 0.2 * held_beyond);
    // The rest of Omega and alpha_0 beside the slowed law, at the least |u|.
    let slowed = Slowed::<f64>::new(p, airframe.vehicle.gravity);
    let [slow_jerk, slow_snap] = slowed.derivatives(p);
    let min = gravity - up - vertical - slowed.level;
    // A frame that is tilted turns about its thrust axis as well, by a part of how u turns: yaw has to follow.
    let yaw = f64::from(p.yaw_acceleration);
    let slope = (f64::from(p.force_heading) + horizontal) / (gravity - up);
    let turned = 0.6 * min_f64(rate, math::sqrt_f64(reserve));
    let jerk = min_f64(min_f64(8.0, turned * min - slow_jerk), min * math::sqrt_f64(0.2 * yaw / slope));
    let snap = min_f64(0.8 * ((reserve - turned * turned) * min - slow_snap), 0.4 * yaw * min / slope);
    let tilt = math::hypot(1.0, slope);
    let single = |value: f64| max_f64(value, 0.0) as f32;
    ReferenceBounds {
        horizontal_speed: 5.0,
        horizontal_acceleration: single(horizontal),
        vertical_acceleration: single(vertical),
        jerk: single(jerk),
        snap: single(min_f64(snap, 40.0)),
        heading_rate: single(0.3 * f64::from(p.yaw_rate) / tilt),
        heading_second_derivative: single(0.3 * f64::from(p.yaw_acceleration) / tilt),
    }
}
