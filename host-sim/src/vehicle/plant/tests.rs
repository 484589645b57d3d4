//! The plant against physics (conservation laws), against a plain integrator, and against its own order.

use super::*;
use nalgebra::{Matrix3, SVector};
use scenario::Scenario;
use scenario::body::attitude_from_euler;
use std::sync::LazyLock;

static PAPER: LazyLock<Scenario> = LazyLock::new(|| Scenario::paper().unwrap());

fn vehicle() -> Vehicle {
    *PAPER.configuration.vehicle()
}

fn plant(step: f64, state: BodyState) -> Plant {
    Plant::new(PAPER.configuration.vehicle(), PAPER.configuration.limits(), step, state)
}

fn tumbling() -> BodyState {
    BodyState {
        position: Vector3::new(1.0, -2.0, 3.0),
        velocity: Vector3::new(0.4, 0.5, -0.6),
        attitude: attitude_from_euler(0.4, -0.9, 2.0),
        angular_velocity: Vector3::new(6.0, -4.0, 9.0),
    }
}

fn wrench(thrust: f32, torque: [f32; 3]) -> Wrench {
    Wrench { thrust, torque: Vector3::from(torque) }
}

fn rotation(q: &Quaternion<f64>) -> Matrix3<f64> {
    nalgebra::UnitQuaternion::from_quaternion(*q).to_rotation_matrix().into_inner()
}

/// p, v, the nine entries of R, omega: eq. (2) as printed, with a rotation matrix instead of a quaternion.
type Plain = SVector<f64, 18>;

fn plain_derivative(x: &Plain, thrust: f64, torque: &Vector3<f64>) -> Plain {
    let inertia = Matrix3::from_diagonal(&Vector3::from(vehicle().inertia.map(f64::from)));
    let r = Matrix3::from_column_slice(&x.as_slice()[6..15]);
    let w = Vector3::new(x[15], x[16], x[17]);
    let acceleration = r * Vector3::z() * (thrust / f64::from(vehicle().mass)) - Vector3::z() * f64::from(9.81_f32);
    let w_rate = inertia.try_inverse().unwrap() * ((inertia * w).cross(&w) + torque);
    let mut out = Plain::zeros();
    out.fixed_rows_mut::<3>(0).copy_from(&x.fixed_rows::<3>(3));
    out.fixed_rows_mut::<3>(3).copy_from(&acceleration);
    out.as_mut_slice()[6..15].copy_from_slice((r * w.cross_matrix()).as_slice());
    out.fixed_rows_mut::<3>(15).copy_from(&w_rate);
    out
}

/// The textbook method on the whole state at once, stepping ten times finer than the plant.
fn plain_flight(state: &BodyState, thrust: f64, torque: &Vector3<f64>, seconds: f64) -> Plain {
    let h = 1e-4;
    let mut x = Plain::zeros();
    x.fixed_rows_mut::<3>(0).copy_from(&state.position);
    x.fixed_rows_mut::<3>(3).copy_from(&state.velocity);
    x.as_mut_slice()[6..15].copy_from_slice(rotation(&state.attitude).as_slice());
    x.fixed_rows_mut::<3>(15).copy_from(&state.angular_velocity);
    let f = |x: &Plain| plain_derivative(x, thrust, torque);
    for _ in 0..(seconds / h).round() as u32 {
        let k_1 = f(&x);
        let k_2 = f(&(x + k_1 * (h / 2.0)));
        let k_3 = f(&(x + k_2 * (h / 2.0)));
        let k_4 = f(&(x + k_3 * h));
        x += (k_1 + k_2 * 2.0 + k_3 * 2.0 + k_4) * (h / 6.0);
    }
    x
}

#[test]
fn agrees_with_a_plain_integration_of_the_printed_equations() {
    let command = wrench(5.5, [0.02, -0.015, 0.01]);
    let mut plant = plant(1e-3, tumbling());
    plant.hold(&command, 2000).unwrap();
    let x = plain_flight(&tumbling(), f64::from(command.thrust), &command.torque.map(f64::from), 2.0);
    let state = plant.state();
    let position_gap = (state.position - x.fixed_rows::<3>(0)).norm();
    let velocity_gap = (state.velocity - x.fixed_rows::<3>(3)).norm();
    let attitude_gap = (rotation(&state.attitude) - Matrix3::from_column_slice(&x.as_slice()[6..15])).norm();
    let rate_gap = (state.angular_velocity - x.fixed_rows::<3>(15)).norm();
    // What the plant's own step leaves: the convergence test below finds about 1e-8 at this step.
    let worst = position_gap.max(velocity_gap).max(attitude_gap).max(rate_gap);
    assert!(worst < 2e-7, "{position_gap:e} {velocity_gap:e} {attitude_gap:e} {rate_gap:e}");
}

#[test]
fn halving_the_step_divides_the_error_by_sixteen() {
    let command = wrench(5.5, [0.02, -0.015, 0.01]);
    let flown = |steps: u32| {
        let mut plant = plant(1.0 / f64::from(steps), tumbling());
        plant.hold(&command, steps).unwrap();
        *plant.state()
    };
    let gap = |a: &BodyState, b: &BodyState| {
        (a.position - b.position).norm()
            + (a.attitude - b.attitude).norm()
            + (a.angular_velocity - b.angular_velocity).norm()
    };
    let exact = flown(6400);
    let (coarse, fine) = (gap(&flown(100), &exact), gap(&flown(200), &exact));
    let order = (coarse / fine).log2();
    assert!((3.7..4.5).contains(&order), "order {order}");
}

#[test]
fn free_rotation_keeps_its_energy_and_its_angular_momentum_in_the_world() {
    let inertia = vehicle().inertia.map(f64::from);
    let momentum = |s: &BodyState| rotation(&s.attitude) * inertia.component_mul(&s.angular_velocity);
    let energy = |s: &BodyState| 0.5 * s.angular_velocity.dot(&inertia.component_mul(&s.angular_velocity));
    let start = tumbling();
    let mut plant = plant(1e-3, start);
    plant.hold(&wrench(0.0, [0.0; 3]), 10_000).unwrap();
    let end = plant.state();
    assert!((energy(end) / energy(&start) - 1.0).abs() < 1e-7);
    assert!((momentum(end) - momentum(&start)).norm() / momentum(&start).norm() < 1e-6);
    assert!((end.attitude.norm() - 1.0).abs() < 1e-14);
}

#[test]
fn an_unpowered_body_falls_on_a_parabola() {
    let start = tumbling();
    let mut plant = plant(1e-3, start);
    plant.hold(&wrench(0.0, [0.0; 3]), 1500).unwrap();
    let g = f64::from(vehicle().gravity);
    let expected = start.position + start.velocity * 1.5 - Vector3::z() * (0.5 * g * 1.5 * 1.5);
    assert!((plant.state().position - expected).norm() < 1e-10);
}

#[test]
fn hover_thrust_holds_a_level_body_in_place() {
    let level = BodyState {
        position: Vector3::zeros(),
        velocity: Vector3::zeros(),
        attitude: attitude_from_euler(0.0, 0.0, 1.0),
        angular_velocity: Vector3::zeros(),
    };
    let mut plant = plant(1e-3, level);
    plant.hold(&wrench(vehicle().mass * vehicle().gravity, [0.0; 3]), 1000).unwrap();
    assert!(plant.state().position.norm() < 1e-6);
}

#[test]
fn commands_beyond_the_limits_are_clipped_and_reported() {
    let mut strong = plant(1e-3, tumbling());
    let mut limited = strong.clone();
    let clipped = strong.hold(&wrench(9.0, [0.1, -0.8, 0.0]), 10).unwrap();
    assert!(clipped);
    let unclipped = limited.hold(&wrench(7.0, [0.1, -0.5, 0.0]), 10).unwrap();
    assert!(!unclipped);
    assert_eq!(strong.state(), limited.state());
    assert!(strong.hold(&wrench(-1.0, [0.0; 3]), 1).unwrap());
}

#[test]
fn a_command_that_is_no_number_is_a_typed_error() {
    assert_eq!(plant(1e-3, tumbling()).hold(&wrench(f32::NAN, [0.0; 3]), 1), Err(Diverged));
    assert_eq!(plant(1e-3, tumbling()).hold(&wrench(1.0, [0.0, f32::NAN, 0.0]), 1), Err(Diverged));
}

#[test]
fn euler_angles_turn_roll_then_pitch_then_yaw() {
    let r = rotation(&attitude_from_euler(0.3, -0.5, 1.1));
    let about_x = nalgebra::Rotation3::from_axis_angle(&Vector3::x_axis(), 0.3).into_inner();
    let about_y = nalgebra::Rotation3::from_axis_angle(&Vector3::y_axis(), -0.5).into_inner();
    let about_z = nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), 1.1).into_inner();
    assert!((r - about_z * about_y * about_x).norm() < 1e-12);
    let state = BodyState { attitude: attitude_from_euler(0.3, -0.5, 1.1), ..tumbling() };
    assert!((state.yaw() - 1.1).abs() < 1e-12);
}
