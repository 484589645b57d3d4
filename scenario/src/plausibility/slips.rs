//! Numbers that are probably in another unit than the file's, and the value that would be right.

use super::quantities::{Numbers, within};
use crate::number::Number;
use crate::section::Section;
use controller_core::allocation::Rotors;
use controller_core::vehicle::Vehicle;
use std::f64::consts::TAU;
use toml::Value;

/// (rad/s) / (revolution/minute).
const RAD_PER_S_PER_RPM: f64 = TAU / 60.0;

/// What a slip changes.
#[derive(Clone, Copy)]
enum Slipped {
    Mass,
    Moment,
    Arm,
    Thrust,
    Yaw,
    Speed,
    ThrustLimit,
    TorqueLimit,
}

/// A number in another unit than the file's.
struct Slip {
    field: &'static str,
    /// What the number may be instead.
    is: &'static str,
    /// By what it must then be multiplied.
    factor: f64,
    number: Slipped,
}

const fn slip(field: &'static str, is: &'static str, factor: f64, number: Slipped) -> Slip {
    Slip { field, is, factor, number }
}

/// What both coefficients of a rotor may be instead.
const PER_RPM: &str = "in N/rpm^2 (and drag_coefficient in N m/rpm^2)";

const UNIT_SLIPS: [Slip; 17] = [
    slip("vehicle.mass", "in g", 1e-3, Slipped::Mass),
    slip("vehicle.inertia", "in g m^2", 1e-3, Slipped::Moment),
    slip("vehicle.inertia", "in kg cm^2", 1e-4, Slipped::Moment),
    slip("vehicle.inertia", "in kg mm^2", 1e-6, Slipped::Moment),
    slip("vehicle.inertia", "in g cm^2", 1e-7, Slipped::Moment),
    slip("vehicle.inertia", "in g mm^2", 1e-9, Slipped::Moment),
    slip("limits.thrust_max", "in grams-force", 9.80665e-3, Slipped::ThrustLimit),
    slip("limits.torque_max", "in mN m", 1e-3, Slipped::TorqueLimit),
    slip("limits.torque_max", "in N cm", 1e-2, Slipped::TorqueLimit),
    slip("rotors.position", "in cm", 1e-2, Slipped::Arm),
    slip("rotors.position", "in mm", 1e-3, Slipped::Arm),
    slip("rotors.thrust_max", "in grams-force", 9.80665e-3, Slipped::Thrust),
    slip("rotors.thrust_max", "in kilograms-force", 9.80665, Slipped::Thrust),
    slip("rotors.torque_per_thrust", "in cm", 1e-2, Slipped::Yaw),
    slip("rotors.torque_per_thrust", "in mm", 1e-3, Slipped::Yaw),
    slip("rotors.speed", "in rpm", RAD_PER_S_PER_RPM, Slipped::Speed),
    slip("rotors.thrust_coefficient", PER_RPM, 1.0 / (RAD_PER_S_PER_RPM * RAD_PER_S_PER_RPM), Slipped::Thrust),
];

impl Numbers {
    fn corrected(mut self, slip: &Slip) -> Self {
        let factor = slip.factor;
        match (slip.number, &mut self.rotors) {
            (Slipped::Mass, _) => self.mass *= factor,
            (Slipped::Moment, _) => self.moment *= factor,
            (Slipped::ThrustLimit, None) => self.limits[0] = self.limits[0].map(|thrust| thrust * factor),
            (Slipped::TorqueLimit, None) => self.limits[1] = self.limits[1].map(|torque| torque * factor),
            (Slipped::Arm, Some(rotors)) => rotors.arm *= factor,
            (Slipped::Thrust, Some(rotors)) => rotors.thrust *= factor,
            (Slipped::Yaw, Some(rotors)) => rotors.yaw *= factor,
            (Slipped::Speed, Some(rotors)) => {
                rotors.thrust *= factor * factor;
                rotors.speed = rotors.speed.map(|speed| speed * factor);
            }
            (Slipped::ThrustLimit | Slipped::TorqueLimit, Some(_)) | (_, None) => {}
        }
        self
    }
}

/// The slip that would explain the numbers, with the value that would be right: the end of a sentence. Without one it
/// is empty.
#[must_use]
pub fn likely_slip(root: &Section, vehicle: &Vehicle, rotors: Option<&Rotors>) -> String {
    let numbers = Numbers::read(root, vehicle, rotors);
    let explains = |slip: &'static Slip| {
        let value = root.value(slip.field)?;
        let judged = numbers.corrected(slip).judged();
        let is_usual = judged.iter().all(|judged| within(judged.value, judged.range.usual));
        // Of several the one that makes the vehicle most like others.
        let unlike: f64 = judged.iter().map(|judged| (judged.value / judged.range.typical).ln().abs()).sum();
        is_usual.then_some((unlike, slip, value))
    };
    let found = UNIT_SLIPS.iter().filter_map(explains).min_by(|(one, ..), (other, ..)| one.total_cmp(other));
    found.map_or(String::new(), |(_, Slip { field, is, factor, .. }, value)| {
        format!("; if {field} is {is}, write {}", scaled(value, *factor))
    })
}

/// A number or list of the file, every number times `factor`.
fn scaled(value: &Value, factor: f64) -> String {
    let number = |number: f64| Number((number * factor) as f32).to_string();
    match value {
        Value::Float(float) => number(*float),
        Value::Integer(whole) => number(*whole as f64),
        Value::Array(elements) => {
            format!("[{}]", elements.iter().map(|element| scaled(element, factor)).collect::<Vec<_>>().join(", "))
        }
        other => other.to_string(),
    }
}
