//! The rows of the budget.

use super::Random;
use crate::allocation::{MinimumNorm, QuadX, Rotors};
use crate::attitude::rotate_back;
use crate::extended::budget::{RATE_BEYOND, TorqueBudget, TurningBudget};
use crate::extended::defaults::NOTHING_GIVEN;
use crate::extended::parameters::ExtendedParameters;
use crate::extended::tests::example::{self, Craft};
use crate::extended::thrust_range::ThrustRange;
use crate::state::Wrench;
use nalgebra::Vector3;

/// Constants that take nothing of the budget beforehand.
fn nothing_fixed(scales: [f32; 2], floor_margin: f32) -> ExtendedParameters {
    let [scale_least, scale_greatest] = scales;
    let zero = ExtendedParameters::from_values([0.0; ExtendedParameters::COUNT]);
    ExtendedParameters { scale_least, scale_greatest, floor_margin, ..zero }
}

/// Whether a rotor would leave its range for `torque` with the thrust nearest to `thrust` that [`ThrustRange`] admits.
fn clips(rotors: &Rotors, range: &ThrustRange, thrust: f32, torque: &Vector3<f32>, scale: f32) -> bool {
    let thrust = range.admitted(thrust, torque, scale);
    let asked = Wrench { thrust: thrust / scale, torque: torque / scale };
    MinimumNorm::new(rotors).allocate(&asked).unwrap().clipped
}

#[test]
fn every_torque_in_the_rotors_row_leaves_each_rotor_in_its_range_at_some_thrust() {
    let mut random = Random(31);
    for _ in 0..300 {
        let craft = Craft::random(&mut random);
        let scales = [random.between(0.7, 1.0), random.between(1.0, 1.3)];
        let margin = 1e-3 * craft.vehicle.mass * craft.vehicle.gravity;
        let parameters = nothing_fixed(scales, margin);
        let budget = TorqueBudget::<f64>::new(&parameters, &craft.vehicle, &craft.limits, Some(&craft.rotors));
        let range = ThrustRange::new(Some(&craft.rotors), margin, craft.limits.thrust_max);
        let row = budget.rows[2];
        for _ in 0..300 {
            // The row spent to the last, in a random share for the tilt, in a random direction; a limit's row is not
            // asked.
            let share = f64::from(random.between(0.0, 1.0));
            let tilt = (share * row.room / row.tilt) as f32;
            let yaw = ((1.0 - share) * row.room / row.yaw) as f32 * random.signed().signum();
            let (sin, cos) = random.between(0.0, core::f32::consts::TAU).sin_cos();
            let torque = Vector3::new(tilt * cos, tilt * sin, yaw);
            let scale = random.between(scales[0], scales[1]);
            assert!(range.least(&torque, scale) <= range.greatest(&torque, scale), "{craft:?} {torque}");
            let thrust = random.between(-1.0, 1.0) * 2.0 * craft.limits.thrust_max;
            assert!(!clips(&craft.rotors, &range, thrust, &torque, scale), "{craft:?} {torque} {scale}");
        }
    }
}

#[test]
fn the_rotors_row_is_no_narrower_than_some_torque_needs() {
    let mut random = Random(32);
    for _ in 0..100 {
        let craft = Craft::random(&mut random);
        let budget =
            TorqueBudget::<f64>::new(&nothing_fixed([1.0; 2], 0.0), &craft.vehicle, &craft.limits, Some(&craft.rotors));
        let range = ThrustRange::new(Some(&craft.rotors), 0.0, f32::MAX);
        let row = budget.rows[2];
        // A hundredth more than the row allows, all of it tilt or all of it yaw: no thrust suits every rotor.
        let fails = |torque: Vector3<f32>| range.least(&torque, 1.0) > range.greatest(&torque, 1.0);
        let tilt = (1.01 * row.room / row.tilt) as f32;
        let mut tilted = (0..720).map(|degrees| (degrees as f32 * 0.5).to_radians().sin_cos());
        assert!(tilted.any(|(sin, cos)| fails(Vector3::new(cos, sin, 0.0) * tilt)), "{craft:?}");
        assert!(fails(Vector3::z() * (1.01 * row.room / row.yaw) as f32), "{craft:?}");
    }
}

#[test]
fn a_turn_within_the_budget_fits_every_row_with_all_that_is_fixed() {
    let mut random = Random(33);
    for _ in 0..200 {
        let craft = Craft::random(&mut random);
        let p = craft.constants(&NOTHING_GIVEN);
        let rotors = Some(&craft.rotors);
        let budget = TorqueBudget::new(&p, &craft.vehicle, &craft.limits, rotors);
        let turning = TurningBudget::new(&budget, craft.vehicle.mass, p.turn_acceleration);
        let range = ThrustRange::new(rotors, p.floor_margin, craft.limits.thrust_max);
        let (j, yaw_feedback) = (craft.vehicle.inertia, 0.5 * p.w * p.eta + p.m_omega_z);
        for _ in 0..200 {
            // R~, and the sine of the angle from b = R~ e3 to rho; one beyond a right angle.
            let error = random.attitude();
            let axis = rotate_back(&error.conjugate(), &Vector3::z());
            let sine = if axis.z < 0.0 { 1.0 } else { axis.xy().norm().min(1.0) };
            let feedback = p.m_all * random.between(0.0, 1.0);
            let alpha = turning.acceleration(random.between(1.0, 40.0), feedback, sine).max(p.turn_reserve);
            assert!(alpha <= p.turn_acceleration);
            // Vectors of these lengths in random directions, all at their greatest.
            let mut turned = |length: f32| {
                let (sin, cos) = random.between(0.0, core::f32::consts::TAU).sin_cos();
                Vector3::new(cos, sin, 0.0) * length
            };
            let (tilt, turn, rate) = (turned(feedback), turned(alpha), turned(p.turn_rate * RATE_BEYOND as f32));
            let mut side = || random.signed().signum();
            // omega_d and omega_d' in the body's axes: R~ mixes what tilts with what yaws.
            let rate = rotate_back(&error, &(rate + Vector3::z() * (p.yaw_rate * side())));
            let turn = rotate_back(&error, &(turn + Vector3::z() * (p.yaw_acceleration * side())));
            let yaw = Vector3::z() * (yaw_feedback * side());
            let bias = Vector3::new(p.torque_tilt * side(), p.torque_tilt * side(), p.torque_yaw * side());
            let torque = tilt + yaw + j.component_mul(&turn) - j.component_mul(&rate).cross(&rate) + bias;
            let scale = random.between(p.scale_least, p.scale_greatest);
            assert!(range.least(&torque, scale) <= range.greatest(&torque, scale), "{craft:?} {torque}");
            for (torque, limit) in torque.iter().zip(craft.limits.torque_max.iter()) {
                assert!(torque.abs() <= *limit * (1.0 + 1e-5), "{craft:?} {torque} of {limit}");
            }
        }
    }
}

#[test]
fn the_frame_turns_slower_where_feedback_or_tilt_or_little_thrust_take_the_budget() {
    // Drag torques a tenth of the example's, so that what leaks into yaw counts.
    let weak = QuadX { drag_coefficient: 0.1 * example::QUAD.drag_coefficient, ..example::QUAD };
    let craft = Craft { rotors: Rotors::quad_x(weak).unwrap(), ..Craft::example() };
    let p = craft.constants(&NOTHING_GIVEN);
    let budget = TorqueBudget::new(&p, &craft.vehicle, &craft.limits, Some(&craft.rotors));
    let turning = TurningBudget::new(&budget, craft.vehicle.mass, p.turn_acceleration);
    let free = turning.acceleration(40.0, 0.0, 0.0);
    assert_eq!(free, p.turn_acceleration);
    let spent = turning.acceleration(40.0, p.m_all, 0.0);
    let leaking = turning.acceleration(40.0, p.m_all, 1.0);
    assert!(spent < free && leaking < spent && leaking > 0.9 * p.turn_reserve, "{free} {spent} {leaking}");
    // The thrust floor meets the thrust where alpha is zero.
    let floor = (budget.floor / (0.95 * f64::from(craft.vehicle.mass))) as f32;
    assert!(turning.acceleration(floor, 0.0, 0.0).abs() < 1e-2 && turning.acceleration(0.0, 0.0, 0.0) < 0.0);
}
