//! Whether a vehicle's numbers can be those of a multirotor: what is impossible is refused, what is unusual is said.
//!
//! No proof notices an inertia in g cm^2: the certificate holds for the vehicle that the file describes. But the
//! numbers of one vehicle belong together, whatever its size:
//!
//! | quantity | unit | usual | possible |
//! |---|---|---|---|
//! | longest arm, per cube root of the mass | m/kg^(1/3) | 0.06 to 0.6 | 0.02 to 2 |
//! | greatest radius of gyration sqrt(J / m), per longest arm | | 0.12 to 1.25 | 0.03 to 2 |
//! | the same without rotors, per 0.2 m/kg^(1/3) times the cube root of the mass | | 0.12 to 2.5 | 0.003 to 20 |
//! | without rotors: greatest thrust, per weight | | at most 20 | at most 50 |
//! | without rotors: greatest torque limit, per greatest moment of inertia | rad/s^2 | 0.5 to 5e3 | 0.01 to 5e4 |
//! | greatest thrust, per weight | | 1.2 to 20 | 1 to 50 |
//! | yaw torque per thrust, per longest arm | | 0.02 to 0.8 | 0.001 to 3 |
//! | greatest speed times longest arm | m/s | at most 750 | |
//! | lag | s | 0.001 to 0.15 | 0 to 1 |
//!
//! The published vehicles (`vehicles/published`) have arms of 0.11 to 0.21 m/kg^(1/3), radii of gyration of 0.3 to 1.07
//! arms, thrusts of 1.9 to 13 weights and yaw torques of 0.023 to 0.79 arms. A slip of units moves a number by 9.8 and
//! more. The one that makes all of them usual again is named with the value that would be right.

use crate::number::Number;
use crate::section::{FieldError, Section};
use controller_core::allocation::Rotors;
use controller_core::vehicle::Vehicle;
use std::f64::consts::TAU;
use toml::Value;

/// Arm of a vehicle without rotors, per cube root of its mass, m/kg^(1/3).
const USUAL_ARM_M_PER_KG_THIRD: f64 = 0.2;
/// Longest usual lag of rotors, s.
const USUAL_LAG_MAX_S: f64 = 0.15;
/// Shortest usual lag, s.
const USUAL_LAG_MIN_S: f64 = 0.001;
/// (rad/s) / (revolution/minute).
const RAD_PER_S_PER_RPM: f64 = TAU / 60.0;

/// Values that a quantity usually has, and that it can have, each with both ends; and one amid the published vehicles'.
struct Range {
    typical: f64,
    usual: [f64; 2],
    possible: [f64; 2],
}

const ARM_RANGE: Range = Range { typical: 0.16, usual: [0.06, 0.6], possible: [0.02, 2.0] };
const GYRATION_RADIUS_RANGE: Range = Range { typical: 0.6, usual: [0.12, 1.25], possible: [0.03, 2.0] };
const GYRATION_RADIUS_RANGE_WITHOUT_ROTORS: Range = Range { typical: 0.6, usual: [0.12, 2.5], possible: [0.003, 20.0] };
const THRUST_RANGE: Range = Range { typical: 4.0, usual: [1.2, 20.0], possible: [1.0, 50.0] };
const YAW_TORQUE_RANGE: Range = Range { typical: 0.15, usual: [0.02, 0.8], possible: [0.001, 3.0] };
const THRUST_LIMIT_RANGE: Range = Range { typical: 4.0, usual: [0.0, 20.0], possible: [0.0, 50.0] };
const TORQUE_LIMIT_RANGE: Range = Range { typical: 100.0, usual: [0.5, 5e3], possible: [0.01, 5e4] };
const TIP_SPEED_RANGE: Range = Range { typical: 250.0, usual: [0.0, 750.0], possible: [0.0, f64::INFINITY] };

fn within(value: f64, [least, greatest]: [f64; 2]) -> bool {
    (least..=greatest).contains(&value)
}

/// The numbers of a vehicle that belong together, SI.
#[derive(Clone, Copy)]
struct Numbers {
    mass: f64,
    gravity: f64,
    /// The greatest moment of inertia.
    moment: f64,
    rotors: Option<RotorNumbers>,
    /// Of `[limits]`, where there are any: thrust, N, and the greatest torque, N m.
    limits: [Option<f64>; 2],
}

#[derive(Clone, Copy)]
struct RotorNumbers {
    /// The longest arm, m.
    arm: f64,
    /// All together, N.
    thrust: f64,
    /// Yaw torque per thrust, m.
    yaw: f64,
    /// The greatest speed, rad/s; none where the file has thrusts.
    speed: Option<f64>,
}

/// One quantity: what the file makes of it, in words that name the field first.
struct Judged {
    field: &'static str,
    value: f64,
    range: Range,
    says: String,
}

impl Numbers {
    fn read(root: &Section, vehicle: &Vehicle, rotors: Option<&Rotors>) -> Self {
        let rotors = rotors.and_then(|rotors| {
            let one = rotors.first()?;
            let has_speeds = root.value("rotors.speed").is_some();
            let thrust_max = f64::from(one.thrust_max);
            Some(RotorNumbers {
                arm: f64::from(rotors.max_arm()),
                thrust: f64::from(rotors.thrust_together().1),
                yaw: f64::from(one.drag_coefficient) / f64::from(one.thrust_coefficient),
                speed: has_speeds.then(|| (thrust_max / f64::from(one.thrust_coefficient)).sqrt()),
            })
        });
        let [mass, gravity, moment] = [vehicle.mass, vehicle.gravity, vehicle.inertia.max()].map(f64::from);
        let limits = ["limits.thrust_max", "limits.torque_max"].map(|path| greatest(root.value(path)?));
        Self { mass, gravity, moment, rotors, limits }
    }

    /// Every quantity, sizes first: what is wrong with the arms is wrong with the other quantities as well.
    fn judged(&self) -> Vec<Judged> {
        let radius = (self.moment / self.mass).sqrt();
        let size = self.mass.cbrt();
        let Some(RotorNumbers { arm, thrust, yaw, speed }) = self.rotors else {
            let arm = USUAL_ARM_M_PER_KG_THIRD * size;
            let says = format!(
                "makes a radius of gyration of {} m, and a vehicle of {} kg is some {} m wide",
                short(radius),
                short(self.mass),
                short(2.0 * arm)
            );
            let range = GYRATION_RADIUS_RANGE_WITHOUT_ROTORS;
            let inertia = Judged { field: "vehicle.inertia", value: radius / arm, range, says };
            let [thrust, torque] = self.limits;
            let thrust = thrust.map(|thrust| {
                let value = thrust / (self.mass * self.gravity);
                let says = format!(
                    "is {} times the weight, where at most {} times is usual",
                    short(value),
                    THRUST_RANGE.usual[1]
                );
                Judged { field: "limits.thrust_max", value, range: THRUST_LIMIT_RANGE, says }
            });
            let torque = torque.map(|torque| {
                let value = torque / self.moment;
                let says = format!(
                    "makes an angular acceleration of {} rad/s^2, where {} to {} rad/s^2 are usual",
                    short(value),
                    TORQUE_LIMIT_RANGE.usual[0],
                    TORQUE_LIMIT_RANGE.usual[1]
                );
                Judged { field: "limits.torque_max", value, range: TORQUE_LIMIT_RANGE, says }
            });
            return [Some(inertia), thrust, torque].into_iter().flatten().collect();
        };
        let [least, greatest] = ARM_RANGE.usual.map(|arm| short(arm * size));
        let [thrust_field, yaw_field] = if speed.is_some() {
            ["rotors.speed", "rotors.drag_coefficient"]
        } else {
            ["rotors.thrust_max", "rotors.torque_per_thrust"]
        };
        let relative = thrust / (self.mass * self.gravity);
        let mut all = vec![
            Judged {
                field: "rotors.position",
                value: arm / size,
                range: ARM_RANGE,
                says: format!(
                    "makes arms of {} m on a vehicle of {} kg, where {least} to {greatest} m are usual",
                    short(arm),
                    short(self.mass)
                ),
            },
            Judged {
                field: "vehicle.inertia",
                value: radius / arm,
                range: GYRATION_RADIUS_RANGE,
                says: format!(
                    "makes a radius of gyration sqrt(J / m) of {} m beside arms of {} m, where {} to {} times the arm \
                     is usual",
                    short(radius),
                    short(arm),
                    GYRATION_RADIUS_RANGE.usual[0],
                    GYRATION_RADIUS_RANGE.usual[1]
                ),
            },
            Judged {
                field: thrust_field,
                value: relative,
                range: THRUST_RANGE,
                says: format!(
                    "makes a thrust of all rotors together of {} times the weight, where {} to {} times is usual",
                    short(relative),
                    THRUST_RANGE.usual[0],
                    THRUST_RANGE.usual[1]
                ),
            },
            Judged {
                field: yaw_field,
                value: yaw / arm,
                range: YAW_TORQUE_RANGE,
                says: format!(
                    "makes a yaw torque of {} N m for each newton of thrust, where {} to {} are usual with arms of \
                     {} m",
                    short(yaw),
                    short(YAW_TORQUE_RANGE.usual[0] * arm),
                    short(YAW_TORQUE_RANGE.usual[1] * arm),
                    short(arm)
                ),
            },
        ];
        if let Some(speed) = speed {
            let says = format!(
                "has {} rad/s, at which a propeller as long as the arm would reach {} m/s at its tip; if it is in rpm, \
                 so are both coefficients: turn all three into rad/s",
                short(speed),
                short(speed * arm)
            );
            all.push(Judged { field: "rotors.speed", value: speed * arm, range: TIP_SPEED_RANGE, says });
        }
        all
    }

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

/// Refuses numbers that no vehicle has, and returns those that few have, each in a sentence.
///
/// # Errors
/// Names the field, with the slip that would explain it.
pub fn check(root: &Section, vehicle: &Vehicle, rotors: Option<&Rotors>, lag: f64) -> Result<Vec<String>, FieldError> {
    let judged = Numbers::read(root, vehicle, rotors).judged();
    let beyond = |range: fn(&Range) -> [f64; 2]| judged.iter().filter(move |j| !within(j.value, range(&j.range)));
    if let Some(Judged { field, says, .. }) = beyond(|range| range.possible).next() {
        let problem = format!("{says}: no vehicle has this{}", likely_slip(root, vehicle, rotors));
        return Err(FieldError::new(*field, problem));
    }
    let mut unusual: Vec<String> =
        beyond(|range| range.usual).map(|Judged { field, says, .. }| format!("{field} {says}")).collect();
    if let Some(last) = unusual.last_mut() {
        *last += &likely_slip(root, vehicle, rotors);
    }
    if rotors.is_some() && lag < USUAL_LAG_MIN_S {
        unusual
            .push(format!("rotors.lag is {lag} s: rotors that respond at once are some simulators', and no real ones"));
    }
    if lag > USUAL_LAG_MAX_S {
        unusual.push(format!("rotors.lag is {lag} s, where 0.005 to {USUAL_LAG_MAX_S} s are usual"));
    }
    Ok(unusual)
}

/// The greatest number of a value, if it has numbers alone, all above zero: other errors are others' to say.
fn greatest(value: &Value) -> Option<f64> {
    match value {
        Value::Integer(whole) => (*whole > 0).then_some(*whole as f64),
        Value::Float(float) => (float.is_finite() && *float > 0.0).then_some(*float),
        Value::Array(elements) => {
            let all: Option<Vec<f64>> = elements.iter().map(greatest).collect();
            all?.into_iter().reduce(f64::max)
        }
        _ => None,
    }
}

/// Three digits.
fn short(number: f64) -> String {
    let text = format!("{number:.2e}");
    text.parse::<f64>().map_or(text, |rounded| rounded.to_string())
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

#[cfg(test)]
mod tests;
