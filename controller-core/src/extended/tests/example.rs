//! Vehicles and constants to test with: the Hummingbird, and any plausible one.

use super::Random;
use crate::allocation::{Rotor, Rotors, Spin, max_torques};
use crate::configuration::{Configuration, ExtendedLaw};
use crate::extended::actuators::ActuatorParameters;
use crate::extended::budget::TorqueBudget;
use crate::extended::defaults::{self, Airframe, Given, NOTHING_GIVEN};
use crate::extended::parameters::{Extended, ExtendedParameters};
use crate::reference::ReferenceBounds;
use crate::vehicle::{LimitParameters, Limits, Vehicle, VehicleParameters};
use nalgebra::Vector3;

pub(crate) use crate::hummingbird::{QUAD, REFERENCES, rotors, vehicle};

/// Everything known of a vehicle.
#[derive(Debug, Clone)]
pub(crate) struct Craft {
    pub vehicle: Vehicle,
    pub limits: Limits,
    pub rotors: Rotors,
    pub actuators: ActuatorParameters,
    pub period: f32,
    pub drag: f32,
}

impl Craft {
    /// The Hummingbird.
    pub fn example() -> Self {
        let limits = LimitParameters { thrust_max: 40.0, torque_max: Vector3::new(1.0, 1.0, 0.4) };
        Self {
            vehicle: vehicle(),
            limits: Limits::new(limits, &vehicle()).unwrap(),
            rotors: rotors(),
            actuators: ActuatorParameters { lag: 0.005, delay: 0.0 },
            period: 0.01,
            drag: 0.47,
        }
    }

    /// A plausible vehicle: 20 g to 5 kg, thrust of 1.6 to 10 weights, four, six or eight rotors (two on each arm),
    /// arms and moments of inertia as vehicles of its mass have them, lags up to 80 ms, delays up to three ticks.
    pub fn random(random: &mut Random) -> Self {
        let mass = random.logarithmic(0.02, 5.0);
        let arm = 0.19 * mass.cbrt() * random.between(0.7, 1.4);
        let gyration = arm * random.between(0.35, 0.6);
        let tilt = mass * gyration * gyration;
        let other = tilt * random.between(1.0, 1.3);
        let inertia = Vector3::new(tilt, other, (tilt + other) * random.between(0.65, 0.99));
        let vehicle = Vehicle::new(VehicleParameters { mass, inertia, gravity: 9.81 }).unwrap();
        let arms = [4_usize, 4, 6, 4][random.below(4)];
        let doubled = arms == 4 && random.below(3) == 0;
        let count = if doubled { 2 * arms } else { arms };
        let thrust_max = random.between(1.6, 10.0) * mass * 9.81 / count as f32;
        let [per_thrust, idle] = [random.between(0.005, 0.03), random.between(0.0, 0.15)];
        let turned = if random.below(2) == 0 { 0.5 } else { 0.0 };
        let rotor = |place: usize| {
            let angle = core::f32::consts::TAU * ((place % arms) as f32 + turned) / arms as f32;
            let (sin, cos) = angle.sin_cos();
            Rotor {
                position: Vector3::new(cos, sin, 0.0) * arm,
                spin: if (place + place / arms).is_multiple_of(2) { Spin::Clockwise } else { Spin::CounterClockwise },
                thrust_coefficient: 1e-6,
                drag_coefficient: 1e-6 * per_thrust,
                thrust_min: idle * idle * thrust_max,
                thrust_max,
            }
        };
        let all: [Rotor; 8] = core::array::from_fn(rotor);
        let rotors = Rotors::new(&all[..count]).unwrap();
        let limits = LimitParameters { thrust_max: count as f32 * thrust_max, torque_max: max_torques(&rotors) };
        let period = [0.001, 0.002, 0.004, 0.01][random.below(4)];
        Self {
            vehicle,
            limits: Limits::new(limits, &vehicle).unwrap(),
            rotors,
            actuators: ActuatorParameters { lag: random.between(0.0, 0.08), delay: random.between(0.0, 3.0) * period },
            period,
            drag: random.between(0.0, 0.5),
        }
    }

    pub fn airframe(&self) -> Airframe<'_> {
        Airframe {
            vehicle: &self.vehicle,
            limits: &self.limits,
            rotors: Some(&self.rotors),
            actuators: self.actuators,
            period: self.period,
            drag: self.drag,
        }
    }

    /// Every constant from its numbers, those that are `given` as they are.
    pub fn constants(&self, given: &Given) -> ExtendedParameters {
        defaults::constants(&self.airframe(), given)
    }

    pub fn law(&self, parameters: &ExtendedParameters) -> ExtendedLaw {
        ExtendedLaw { parameters: Extended::new(*parameters, &self.vehicle).unwrap(), actuators: self.actuators }
    }

    pub fn configuration(&self, parameters: &ExtendedParameters, bounds: ReferenceBounds) -> Configuration {
        let configuration = Configuration::extended(self.vehicle, self.limits, self.law(parameters), bounds);
        configuration.unwrap().with_rotors(self.rotors.clone()).unwrap()
    }
}

/// The example's constants: all from its numbers but A, which [`REFERENCES`] need.
pub(crate) fn parameters() -> ExtendedParameters {
    Craft::example().constants(&given("yaw_acceleration", 6.0))
}

/// The constant called `key` chosen, nothing else.
pub(crate) fn given(key: &str, value: f32) -> Given {
    let mut given = NOTHING_GIVEN;
    given[place(key)] = Some(value);
    given
}

/// Where the constant called `key` is in the table.
pub(crate) fn place(key: &str) -> usize {
    ExtendedParameters::TABLE.iter().position(|constant| constant.key == key).unwrap()
}

/// U where the rotors deliver the least thrust scale, and the most, m/s^2.
pub(crate) fn greatest_accelerations(craft: &Craft, p: &ExtendedParameters) -> [f32; 2] {
    let budget = TorqueBudget::<f64>::new(p.floor_margin, &craft.limits, Some(&craft.rotors));
    [p.scale_least, p.scale_greatest]
        .map(|scale| budget.held_acceleration(&craft.vehicle, &craft.limits, f64::from(scale)) as f32)
}
