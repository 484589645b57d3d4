//! The quantities of a vehicle that are judged, each with the values that it usually has, and can have.

use crate::section::Section;
use controller_core::allocation::Rotors;
use controller_core::vehicle::Vehicle;
use toml::Value;

/// Arm of a vehicle without rotors, per cube root of its mass.
const USUAL_ARM_M_PER_KG_THIRD: f64 = 0.2;

/// Values that a quantity usually has, and that it can have, each with both ends; and one amid the published vehicles'.
pub struct Range {
    pub typical: f64,
    pub usual: [f64; 2],
    pub possible: [f64; 2],
}

const ARM_RANGE: Range = Range { typical: 0.16, usual: [0.06, 0.6], possible: [0.02, 2.0] };
const GYRATION_RADIUS_RANGE: Range = Range { typical: 0.6, usual: [0.12, 1.25], possible: [0.03, 2.0] };
const GYRATION_RADIUS_RANGE_WITHOUT_ROTORS: Range = Range { typical: 0.6, usual: [0.12, 2.5], possible: [0.003, 20.0] };
const THRUST_RANGE: Range = Range { typical: 4.0, usual: [1.2, 20.0], possible: [1.0, 50.0] };
const YAW_TORQUE_RANGE: Range = Range { typical: 0.15, usual: [0.02, 0.8], possible: [0.001, 3.0] };
const THRUST_LIMIT_RANGE: Range = Range { typical: 4.0, usual: [0.0, 20.0], possible: [0.0, 50.0] };
const TORQUE_LIMIT_RANGE: Range = Range { typical: 100.0, usual: [0.5, 5e3], possible: [0.01, 5e4] };
const TIP_SPEED_RANGE: Range = Range { typical: 250.0, usual: [0.0, 750.0], possible: [0.0, f64::INFINITY] };

pub fn within(value: f64, [min, max]: [f64; 2]) -> bool {
    (min..=max).contains(&value)
}

/// The numbers of a vehicle that belong together, SI.
#[derive(Clone, Copy)]
pub struct Numbers {
    pub mass: f64,
    pub gravity: f64,
    /// The maximum moment of inertia.
    pub moment: f64,
    pub rotors: Option<RotorNumbers>,
    /// Of `[limits]`, where there are any: thrust, N, and the maximum torque, N m.
    pub limits: [Option<f64>; 2],
}

#[derive(Clone, Copy)]
pub struct RotorNumbers {
    /// The longest arm, m.
    pub arm: f64,
    /// All together, N.
    pub thrust: f64,
    /// Yaw torque per thrust, m.
    pub yaw: f64,
    /// The maximum speed, rad/s; none where the file has thrusts.
    pub speed: Option<f64>,
}

/// One quantity of the file, with a sentence about it that begins after the field.
pub struct Judged {
    pub field: &'static str,
    pub value: f64,
    pub range: Range,
    pub says: String,
}

impl Numbers {
    pub fn read(root: &Section, vehicle: &Vehicle, rotors: Option<&Rotors>) -> Self {
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
        let limits = ["limits.thrust_max", "limits.torque_max"].map(|path| number_max(root.value(path)?));
        Self { mass, gravity, moment, rotors, limits }
    }

    /// Every quantity, sizes first: what is wrong with the arms is wrong with the other quantities as well.
    pub fn judged(&self) -> Vec<Judged> {
        match &self.rotors {
            Some(rotors) => self.with_rotors(rotors),
            None => self.without_rotors(),
        }
    }

    /// The radius of gyration, m.
    fn radius(&self) -> f64 {
        (self.moment / self.mass).sqrt()
    }

    fn without_rotors(&self) -> Vec<Judged> {
        let arm = USUAL_ARM_M_PER_KG_THIRD * self.mass.cbrt();
        let says = format!(
            "makes a radius of gyration of {} m, and a vehicle of {} kg is some {} m wide",
            short(self.radius()),
            short(self.mass),
            short(2.0 * arm)
        );
        let value = self.radius() / arm;
        let inertia = Judged { field: "vehicle.inertia", value, range: GYRATION_RADIUS_RANGE_WITHOUT_ROTORS, says };
        let thrust = self.limits[0].map(|thrust| {
            let value = thrust / (self.mass * self.gravity);
            let says =
                format!("is {} times the weight, where at most {} times is usual", short(value), THRUST_RANGE.usual[1]);
            Judged { field: "limits.thrust_max", value, range: THRUST_LIMIT_RANGE, says }
        });
        let torque = self.limits[1].map(|torque| {
            let value = torque / self.moment;
            let [min, max] = TORQUE_LIMIT_RANGE.usual;
            let says = format!(
                "makes an angular acceleration of {} rad/s^2, where {min} to {max} rad/s^2 are usual",
                short(value)
            );
            Judged { field: "limits.torque_max", value, range: TORQUE_LIMIT_RANGE, says }
        });
        [Some(inertia), thrust, torque].into_iter().flatten().collect()
    }

    fn with_rotors(&self, RotorNumbers { arm, thrust, yaw, speed }: &RotorNumbers) -> Vec<Judged> {
        let size = self.mass.cbrt();
        let [min, max] = ARM_RANGE.usual.map(|arm| short(arm * size));
        let arms = format!(
            "makes arms of {} m on a vehicle of {} kg, where {min} to {max} m are usual",
            short(*arm),
            short(self.mass)
        );
        let [min, max] = GYRATION_RADIUS_RANGE.usual;
        let radius = format!(
            "makes a radius of gyration sqrt(J / m) of {} m beside arms of {} m, where {min} to {max} times the \
             arm is usual",
            short(self.radius()),
            short(*arm)
        );
        let weights = thrust / (self.mass * self.gravity);
        let [min, max] = THRUST_RANGE.usual;
        let together = format!(
            "makes a thrust of all rotors together of {} times the weight, where {min} to {max} times is usual",
            short(weights)
        );
        let [min, max] = YAW_TORQUE_RANGE.usual.map(|yaw| short(yaw * arm));
        let torque = format!(
            "makes a yaw torque of {} N m for each newton of thrust, where {min} to {max} are usual with arms \
             of {} m",
            short(*yaw),
            short(*arm)
        );
        let [thrust_field, yaw_field] = match speed {
            Some(_) => ["rotors.speed", "rotors.drag_coefficient"],
            None => ["rotors.thrust_max", "rotors.torque_per_thrust"],
        };
        let judge = |field, value, range, says| Judged { field, value, range, says };
        let mut all = vec![
            judge("rotors.position", arm / size, ARM_RANGE, arms),
            judge("vehicle.inertia", self.radius() / arm, GYRATION_RADIUS_RANGE, radius),
            judge(thrust_field, weights, THRUST_RANGE, together),
            judge(yaw_field, yaw / arm, YAW_TORQUE_RANGE, torque),
        ];
        if let Some(speed) = speed {
            let says = format!(
                "has {} rad/s, at which a propeller as long as the arm would reach {} m/s at its tip; if it is in rpm, \
                 so are both coefficients: turn all three into rad/s",
                short(*speed),
                short(speed * arm)
            );
            all.push(judge("rotors.speed", speed * arm, TIP_SPEED_RANGE, says));
        }
        all
    }
}

/// The maximum number of a value, if it has numbers alone, all above zero: other errors are others' to say.
fn number_max(value: &Value) -> Option<f64> {
    match value {
        Value::Integer(whole) => (*whole > 0).then_some(*whole as f64),
        Value::Float(float) => (float.is_finite() && *float > 0.0).then_some(*float),
        Value::Array(elements) => {
            let all: Option<Vec<f64>> = elements.iter().map(number_max).collect();
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
