//! The same loops written out in SI units: matrix exponentials, the law line by line, eigenvalues.
//!
//! The law here is checked against the flying one by differences about hover; the analysis is checked against this.

use super::common::{IDEAL_TIMING, body_axis, model, vehicle};
use crate::support::extended::{law as extended, paper_vehicle, without_estimates};
use controller_core::configuration::ExtendedLaw;
use controller_core::controller::{Controller, Memory};
use controller_core::gains::{GainParameters, Gains};
use controller_core::heading::Heading;
use controller_core::position::FilterState;
use controller_core::reference::Trajectory;
use controller_core::reference::hover::Hover;
use controller_core::state::{State, Wrench};
use nalgebra::{DMatrix, DVector, Quaternion, Vector3};
use scenario::sampled_loop::{Axis, LoopModel, Timing};

/// One axis: what is measured (position, velocity, tilt, rate; only those the axis has move) and remembered.
#[derive(Debug, Clone, Copy, Default)]
pub struct Motion {
    pub position: f64,
    pub velocity: f64,
    pub angle: f64,
    pub rate: f64,
    pub filtered: f64,
    pub intermediate: f64,
    pub smoothed: f64,
}

/// What stands still between two ticks: ubar, as under the paper's law, or x', as under the extended one, which has a
/// filter of bandwidth `k_d` before it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Held {
    Feedback,
    Drive { k_d: f64 },
}

/// What the paper's law makes of it: force command (torque, or thrust beyond hover) and ubar.
pub fn law(axis: Axis, gains: &GainParameters, x: Motion) -> (f64, f64) {
    law_with(Held::Feedback, axis, gains, x, 0.0)
}

/// The same in ticks of `period`, s: x goes towards the second, ubar or y at the next tick.
fn law_with(held: Held, axis: Axis, gains: &GainParameters, x: Motion, period: f64) -> (f64, f64) {
    let [k_p, k_v, k_f, k_s, k_theta, k_omega] =
        [gains.k_p, gains.k_v, gains.k_f, gains.k_s, gains.k_theta, gains.k_omega].map(f64::from);
    let [f, s] = [1.0 / k_f, 1.0 / k_s];
    let d = if let Held::Drive { k_d } = held { 1.0 / k_d } else { 0.0 };
    let at_once = axis == Axis::Vertical && held != Held::Feedback;
    let [f, s] = if at_once { [0.0; 2] } else { [f, s] };
    let z_1 = x.position + (f + s + d) * x.velocity + f * (s + d) * x.filtered + s * d * x.intermediate;
    let z_2 = x.velocity + f * x.filtered + s * x.intermediate + d * x.smoothed;
    let ubar = -(k_p * z_1 + k_v * z_2);
    let (towards, ahead) = match held {
        Held::Feedback => (k_s, ubar),
        Held::Drive { k_d } => (held_towards(k_s, period), ubar + (x.smoothed - ubar) * (-k_d * period).exp()),
    };
    if axis == Axis::Vertical {
        return (f64::from(vehicle().mass) * if at_once { ahead } else { x.filtered }, ahead);
    }
    let g = f64::from(vehicle().gravity);
    let filtered_rate = -k_f * (x.filtered - x.intermediate);
    let intermediate_rate = -towards * (x.intermediate - ahead);
    let follows = if matches!(axis, Axis::LateralX | Axis::LateralY) { 1.0 / g } else { 0.0 };
    let desired = x.filtered * follows;
    let desired_rate = filtered_rate * follows;
    let desired_acceleration = -k_f * (filtered_rate - intermediate_rate) * follows;
    let inertia = f64::from(vehicle().inertia[body_axis(axis).unwrap()]);
    let mrp = (x.angle - desired) / 4.0;
    (-0.25 * k_theta * mrp - k_omega * (x.rate - desired_rate) + inertia * desired_acceleration, ahead)
}

/// What brings x to where its filter would in a tick if it is held.
fn held_towards(k_s: f64, period: f64) -> f64 {
    (1.0 - (-k_s * period).exp()) / period
}

/// e^matrix: the series of matrix / 2^20, squared twenty times.
fn exponential(matrix: DMatrix<f64>) -> DMatrix<f64> {
    let n = matrix.nrows();
    let small = matrix / 1_048_576.0;
    let (mut sum, mut term) = (DMatrix::identity(n, n), DMatrix::identity(n, n));
    for k in 1..16 {
        term = term * &small / f64::from(k);
        sum += &term;
    }
    (0..20).fold(sum, |power, _| &power * &power)
}

/// The largest eigenvalue's magnitude under the paper's law, with the command scaled by `gain`.
pub fn spectral_radius(axis: Axis, gains: &GainParameters, timing: Timing, gain: f64) -> f64 {
    spectral_radius_with(Held::Feedback, axis, gains, timing, gain)
}

fn spectral_radius_with(held: Held, axis: Axis, gains: &GainParameters, timing: Timing, gain: f64) -> f64 {
    // Physical state (position, velocity, angle, rate, actual force), then the command.
    let mut rates = DMatrix::zeros(6, 6);
    rates[(0, 1)] = 1.0;
    match body_axis(axis) {
        Some(body) => {
            rates[(1, 2)] = f64::from(vehicle().gravity);
            rates[(2, 3)] = 1.0;
            rates[(3, 4)] = 1.0 / f64::from(vehicle().inertia[body]);
        }
        None => rates[(1, 4)] = 1.0 / f64::from(vehicle().mass),
    }
    let lagging = timing.rotor_lag > 0.0;
    if lagging {
        rates[(4, 4)] = -1.0 / timing.rotor_lag;
        rates[(4, 5)] = 1.0 / timing.rotor_lag;
    } else {
        // The actual force is the command: the command's column does its work.
        let acts_on = rates.column(4).into_owned();
        rates.set_column(5, &acts_on);
        rates.column_mut(4).fill(0.0);
    }
    let [k_f, k_s] = [gains.k_f, gains.k_s].map(f64::from);
    let (towards, of_x) = match held {
        Held::Feedback => (k_s, [-k_s, k_s]),
        Held::Drive { .. } => (held_towards(k_s, timing.period), [0.0, 1.0]),
    };
    let filter_rates = DMatrix::from_row_slice(3, 3, &[-k_f, k_f, 0.0, 0.0, of_x[0], of_x[1], 0.0, 0.0, 0.0]);
    let filter_step = exponential(filter_rates * timing.period);

    let whole = timing.delay_samples.floor();
    let early = (timing.delay_samples - whole) * timing.period;
    let (first, second) = (exponential(&rates * early), exponential(&rates * (timing.period - early)));
    let whole = whole as usize;

    // Order: physical (5), filters (3), then the commands of ticks k-1, k-2, ...
    let size = 8 + whole + 1;
    let step = |x: DVector<f64>| {
        let motion = Motion {
            position: x[0],
            velocity: x[1],
            angle: x[2],
            rate: x[3],
            filtered: x[5],
            intermediate: x[6],
            smoothed: x[7],
        };
        let (command, ahead) = law_with(held, axis, gains, motion, timing.period);
        let (input, smoothed) = match held {
            Held::Feedback => (ahead, 0.0),
            Held::Drive { .. } => (towards * (ahead - motion.intermediate), ahead),
        };
        let command_of = |age: usize| if age == 0 { gain * command } else { x[7 + age] };
        let mut physical = DVector::from_fn(6, |i, _| if i < 5 { x[i] } else { command_of(whole + 1) });
        physical = &first * physical;
        physical[5] = command_of(whole);
        physical = &second * physical;
        let filters = &filter_step * DVector::from_vec(vec![x[5], x[6], input]);
        DVector::from_fn(size, |i, _| match i {
            0..5 => physical[i],
            5..7 => filters[i - 5],
            7 => smoothed,
            _ => command_of(i - 8),
        })
    };
    let full = DMatrix::from_columns(
        &(0..size).map(|i| step(DVector::from_fn(size, |j, _| f64::from(u8::from(i == j))))).collect::<Vec<_>>(),
    );
    // Only what belongs to the axis: an attitude alone has no position, a vertical motion no angle.
    let kept: Vec<usize> = (0..size)
        .filter(|i| match axis {
            Axis::Roll | Axis::Pitch | Axis::Yaw => !matches!(i, 0 | 1 | 5..8),
            Axis::Vertical => !matches!(i, 2 | 3),
            Axis::LateralX | Axis::LateralY => true,
        })
        .filter(|i| lagging || *i != 4)
        .collect();
    let matrix = full.select_rows(&kept).select_columns(&kept);
    matrix.complex_eigenvalues().iter().map(|value| value.re.hypot(value.im)).fold(0.0, f64::max)
}

#[test]
fn the_law_here_is_the_slope_of_the_law_that_flies() {
    let gains = Gains::new(GainParameters::TABLE_1, &vehicle()).unwrap();
    let hover = Hover::new(Vector3::zeros(), Heading::FORWARD).unwrap().at(0);
    let fly = |axis: Axis, thrust_floor: Option<f32>, x: Motion| -> f64 {
        // A tilt forward turns about +y, a tilt to the left about -x.
        let (along, about, sense) = match axis {
            Axis::LateralX => (Vector3::x(), Vector3::y(), 1.0),
            Axis::LateralY => (Vector3::y(), Vector3::x(), -1.0),
            Axis::Vertical => (Vector3::z(), Vector3::zeros(), 0.0),
            Axis::Roll => (Vector3::zeros(), Vector3::x(), 1.0),
            Axis::Pitch => (Vector3::zeros(), Vector3::y(), 1.0),
            Axis::Yaw => (Vector3::zeros(), Vector3::z(), 1.0),
        };
        let (sin, cos) = (0.5 * sense * x.angle).sin_cos();
        let vector = (about * sin).cast::<f32>();
        let mut controller = Controller::uncertified(vehicle(), gains, thrust_floor, 0.01).unwrap();
        let filter =
            FilterState { filtered: (along * x.filtered).cast(), intermediate: (along * x.intermediate).cast() };
        controller.restore(Memory { filter, lift: None });
        let state = State {
            position: (along * x.position).cast(),
            velocity: (along * x.velocity).cast(),
            attitude: Quaternion::new(cos as f32, vector.x, vector.y, vector.z),
            angular_velocity: (about * (sense * x.rate)).cast(),
        };
        let (Wrench { thrust, torque }, _) = controller.step(&state, &hover).unwrap();
        if axis == Axis::Vertical { f64::from(thrust) } else { sense * torque.cast::<f64>().dot(&about) }
    };
    // Steps at which the saturations bend by less than 1e-3.
    let steps = [
        Motion { position: 4e-3, ..Motion::default() },
        Motion { velocity: 4e-3, ..Motion::default() },
        Motion { angle: 3e-4, ..Motion::default() },
        Motion { rate: 5e-3, ..Motion::default() },
        Motion { filtered: 3e-3, ..Motion::default() },
        Motion { intermediate: 3e-3, ..Motion::default() },
    ];
    for axis in Axis::ALL {
        for x in steps {
            let back = Motion {
                position: -x.position,
                velocity: -x.velocity,
                angle: -x.angle,
                rate: -x.rate,
                filtered: -x.filtered,
                intermediate: -x.intermediate,
                ..Motion::default()
            };
            let (expected, _) = law(axis, &GainParameters::TABLE_1, x);
            let moves = match body_axis(axis) {
                // Positions and filters do not belong to an attitude loop, nor angles to the vertical one.
                Some(_) if matches!(axis, Axis::Roll | Axis::Pitch | Axis::Yaw) => x.angle + x.rate != 0.0,
                Some(_) => true,
                None => x.filtered != 0.0,
            };
            if !moves {
                continue;
            }
            // The projection of the thrust is of second order.
            for thrust_floor in [None, Some(1.0)] {
                let flown = 0.5 * (fly(axis, thrust_floor, x) - fly(axis, thrust_floor, back));
                // The torque's own rounding, and the thrust's about 4.5 N, beside the bend.
                let rounding = if axis == Axis::Vertical { 5e-7 } else { 1e-8 };
                let tolerance = 1.5e-3 * expected.abs() + rounding;
                assert!((flown - expected).abs() < tolerance, "{axis:?} {x:?}: {flown:e} against {expected:e}");
            }
        }
    }
}

#[test]
fn spectral_radii_agree_with_eigenvalues_of_the_written_out_loop() {
    let other = GainParameters {
        k_p: 2.0,
        k_v: 3.0,
        k_f: 12.0,
        k_s: 11.0,
        k_theta: 3.0,
        k_omega: 0.03,
        ..GainParameters::TABLE_1
    };
    for gains in [GainParameters::TABLE_1, other] {
        for (period, rotor_lag, delay_samples) in [
            (0.01, 0.0, 0.0),
            (0.01, 0.005, 0.0),
            (0.01, 0.0, 0.4),
            (0.01, 0.0, 1.0),
            (0.01, 0.03, 1.0),
            (0.004, 0.02, 2.7),
            (0.002, 0.05, 6.25),
            (0.02, 0.001, 0.5),
        ] {
            let timing = Timing { period, rotor_lag, delay_samples };
            for axis in Axis::ALL {
                let found = model(gains, timing).spectral_radius(axis);
                let expected = spectral_radius(axis, &gains, timing, 1.0);
                // Eigenvalues that nearly coincide at one carry the root of double precision's error.
                assert!((found - expected).abs() < 1e-8, "{axis:?} {timing:?}: {found} against {expected}");
            }
        }
    }
}

#[test]
fn the_extended_law_without_estimates_is_the_papers_with_other_slopes_and_its_drive_held() {
    // The same vehicle.
    let configuration = without_estimates(&paper_vehicle().configuration);
    assert_eq!(*configuration.vehicle(), vehicle());
    let ExtendedLaw { parameters: p, .. } = extended(&configuration);
    let inertia = vehicle().inertia.z;
    let [tilt, yaw] = [[p.k_tilt / 4.0, p.k_omega_t], [inertia * p.c_1, inertia * p.c_2]];
    let timing = Timing { rotor_lag: 0.012, delay_samples: 0.7, ..IDEAL_TIMING };
    let model = LoopModel::new(&vehicle(), configuration.law(), timing).unwrap();
    for axis in Axis::ALL {
        let (across, vertical) = ([p.k_p_across, p.k_v_across], [p.k_p_vertical, p.k_v_vertical]);
        let [k_p, k_v] = if axis == Axis::Vertical { vertical } else { across };
        let [stiffness, k_omega] = if axis == Axis::Yaw { yaw } else { tilt };
        let k_theta = 16.0 * stiffness;
        let (k_f, k_s) = (p.k_f, p.k_s);
        let gains = GainParameters { k_p, k_v, k_f, k_s, k_theta, k_omega, ..GainParameters::TABLE_1 };
        let found = model.spectral_radius(axis);
        let held = Held::Drive { k_d: p.k_d.into() };
        let expected = spectral_radius_with(held, axis, &gains, timing, 1.0);
        // The slopes are in single precision here.
        assert!((found - expected).abs() < 1e-7, "{axis:?}: {found} against {expected}");
    }
}

#[test]
fn the_oracle_needs_no_lag_to_be_small() {
    let ideal = spectral_radius(Axis::Roll, &GainParameters::TABLE_1, IDEAL_TIMING, 1.0);
    let nearly = spectral_radius(Axis::Roll, &GainParameters::TABLE_1, Timing { rotor_lag: 1e-5, ..IDEAL_TIMING }, 1.0);
    assert!((ideal - nearly).abs() < 1e-3);
}
