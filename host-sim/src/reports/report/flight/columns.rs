//! Which columns the page keeps of a flight. They bear log.csv's names and are its numbers in single precision, but for
//! yaw, which is in degrees and without jumps, and for what is worked out here:
//!
//! - `tilt`: the angle between thrust axis and vertical, degrees;
//! - `filter_…`: |ubar_p|, |u_f|, |u_s|, m/s^2;
//! - `measured_…`: the error of the state that the law got, measured or estimated: m, m/s, degrees, rad/s.

use crate::flight::Tick;
use crate::reports::report::recorder::{Instant, Kept, Read};
use controller_core::controller::Diagnostics;
use controller_core::extended::memory::Estimates;
use controller_core::state::State;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use scenario::Scenario;
use scenario::body::BodyState;

type Columns = Vec<(String, Kept, Read)>;
/// The length of a vector that the law goes through.
type Norm = fn(&Diagnostics) -> f32;
/// The error of the state that the law got.
type Distance = fn(&State, &BodyState) -> f64;

/// The columns of a flight of `scenario`.
pub fn columns(scenario: &Scenario) -> Columns {
    let mut columns = Columns::new();
    samples(&mut columns);
    law(&mut columns);
    if scenario.configuration.paper().is_none() {
        estimates(&mut columns);
    }
    for rotor in 0..scenario.configuration.rotors().map_or(0, |rotors| rotors.len()) {
        let read = move |tick: &Tick| tick.rotors.get(rotor).copied().unwrap_or(f64::NAN);
        add(&mut columns, &format!("rotor_{}", rotor + 1), read);
    }
    let reality = &scenario.reality;
    if reality.wind.is_some() {
        three(&mut columns, ["wind_x", "wind_y", "wind_z"], |tick| tick.surroundings.wind.unwrap_or_default());
    }
    if reality.battery.is_some() {
        add(&mut columns, "voltage", |tick| tick.surroundings.battery.map_or(f64::NAN, |(voltage, _)| voltage));
        add(&mut columns, "current", |tick| tick.surroundings.battery.map_or(f64::NAN, |(_, current)| current));
    }
    if reality.sensors.is_some() || reality.estimator.is_some() {
        measured(&mut columns);
    }
    columns
}

/// Values of one instant: the vehicle's pose and its reference.
fn samples(columns: &mut Columns) {
    let from = columns.len();
    three(columns, ["px", "py", "pz"], |tick| tick.state.position);
    add(columns, "qw", |tick| tick.state.attitude.w);
    three(columns, ["qx", "qy", "qz"], |tick| tick.state.attitude.imag());
    three(columns, ["pdx", "pdy", "pdz"], |tick| tick.reference.position.cast());
    let angles: [(&str, Read); 2] = [
        ("yaw", Box::new(|instant: &Instant| instant.yaw)),
        ("yaw_d", Box::new(|instant: &Instant| instant.desired_yaw)),
    ];
    columns.extend(angles.map(|(name, read)| (name.to_owned(), Kept::Samples, read)));
    columns[from..].iter_mut().for_each(|column| column.1 = Kept::Samples);
}

/// Motion, commands, and what the law goes through.
fn law(columns: &mut Columns) {
    three(columns, ["vx", "vy", "vz"], |tick| tick.state.velocity);
    three(columns, ["wx", "wy", "wz"], |tick| tick.state.angular_velocity);
    add(columns, "thrust", |tick| tick.wrench.thrust.into());
    three(columns, ["tau_x", "tau_y", "tau_z"], |tick| tick.wrench.torque.cast());
    three(columns, ["mrp_x", "mrp_y", "mrp_z"], |tick| tick.diagnostics.mrp.cast());
    add(columns, "lift_sign", |tick| tick.diagnostics.lift_sign.into());
    add(columns, "clipped", |tick| f64::from(u8::from(tick.clipped)));
    let norms: [(&str, Norm); 7] = [
        ("position_error", |d| d.position_error.norm()),
        ("mrp_error", |d| d.mrp.norm()),
        ("s_theta", |d| d.attitude_feedback.norm()),
        ("s_omega", |d| d.rate_feedback.norm()),
        ("filter_input", |d| d.feedback.norm()),
        ("filter_first", |d| d.filtered.norm()),
        ("filter_second", |d| d.intermediate.norm()),
    ];
    for (name, norm) in norms {
        add(columns, name, move |tick| norm(&tick.diagnostics).into());
    }
    three(columns, ["uf_x", "uf_y", "uf_z"], |tick| tick.diagnostics.filtered.cast());
    three(columns, ["us_x", "us_y", "us_z"], |tick| tick.diagnostics.intermediate.cast());
    three(columns, ["wdx", "wdy", "wdz"], |tick| tick.diagnostics.desired_angular_velocity.cast());
    add(columns, "tilt", |tick| {
        let q = &tick.state.attitude;
        (1.0 - 2.0 * (q.i * q.i + q.j * q.j) / q.norm_squared()).clamp(-1.0, 1.0).acos().to_degrees()
    });
}

fn estimates(columns: &mut Columns) {
    let of = |tick: &Tick| tick.estimates.unwrap_or(Estimates::NONE);
    three(columns, ["d_x", "d_y", "d_z"], move |tick| of(tick).force.cast());
    three(columns, ["tau_d_x", "tau_d_y", "tau_d_z"], move |tick| of(tick).torque.cast());
    add(columns, "thrust_scale", move |tick| of(tick).scale.into());
}

/// The errors of the state that the law got.
fn measured(columns: &mut Columns) {
    let distances: [(&str, Distance); 4] = [
        ("measured_position", |measured, state| (measured.position.cast::<f64>() - state.position).norm()),
        ("measured_velocity", |measured, state| (measured.velocity.cast::<f64>() - state.velocity).norm()),
        ("measured_attitude", |measured, state| {
            let [one, other] = [double(&measured.attitude), state.attitude].map(UnitQuaternion::from_quaternion);
            one.angle_to(&other).to_degrees()
        }),
        ("measured_rate", |measured, state| (measured.angular_velocity.cast::<f64>() - state.angular_velocity).norm()),
    ];
    for (name, distance) in distances {
        add(columns, name, move |tick| {
            tick.measured.as_deref().map_or(f64::NAN, |measured| distance(measured, &tick.state))
        });
    }
}

fn double(q: &Quaternion<f32>) -> Quaternion<f64> {
    Quaternion::from(q.coords.map(f64::from))
}

fn add(columns: &mut Columns, name: &str, read: impl Fn(&Tick) -> f64 + 'static) {
    columns.push((name.to_owned(), Kept::Extremes, Box::new(move |instant| read(instant.tick))));
}

fn three(columns: &mut Columns, names: [&str; 3], read: impl Fn(&Tick) -> Vector3<f64> + Copy + 'static) {
    for (axis, name) in names.into_iter().enumerate() {
        add(columns, name, move |tick| read(tick)[axis]);
    }
}
